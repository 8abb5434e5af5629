//! Faults that no test can bring about from outside: a library in front of the system's, which fails on demand.

use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;

/// Calls that fail, by what the environment asks for.
const SOURCE: &str = r#"
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* FAIL_FLOCK=errno: there are no locks. */
int flock(int fd, int operation) {
    const char *wanted = getenv("FAIL_FLOCK");
    if (wanted) { errno = atoi(wanted); return -1; }
    int (*next)(int, int) = dlsym(RTLD_NEXT, "flock");
    return next(fd, operation);
}

/* FAIL_LEASE="errno first last": a lease cannot be opened for reading, from one time to another. */
int open64(const char *path, int flags, ...) {
    static atomic_int times;
    va_list rest;
    va_start(rest, flags);
    int mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, int) : 0;
    va_end(rest);
    const char *wanted = getenv("FAIL_LEASE");
    size_t length = strlen(path);
    if (wanted && length > 6 && !strcmp(path + length - 6, ".lease") && (flags & O_ACCMODE) == O_RDONLY) {
        int error, first, last, now = atomic_fetch_add(&times, 1);
        sscanf(wanted, "%d %d %d", &error, &first, &last);
        if (first <= now && now <= last) { errno = error; return -1; }
    }
    int (*next)(const char *, int, ...) = dlsym(RTLD_NEXT, "open64");
    return next(path, flags, mode);
}

/* FAIL_THREADS=n: after n threads there are no more. */
int pthread_create(pthread_t *thread, const pthread_attr_t *how, void *(*start)(void *), void *with) {
    static atomic_int made;
    const char *wanted = getenv("FAIL_THREADS");
    if (wanted && atomic_fetch_add(&made, 1) >= atoi(wanted)) return EAGAIN;
    int (*next)(pthread_t *, const pthread_attr_t *, void *(*)(void *), void *) = dlsym(RTLD_NEXT, "pthread_create");
    return next(thread, how, start, with);
}
"#;

/// The library, compiled once; `None` where there is no C compiler.
fn library() -> Option<&'static PathBuf> {
    static BUILT: OnceLock<Option<PathBuf>> = OnceLock::new();
    let build = || {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
        let (source, library) = (folder.join("shim.c"), folder.join(format!("shim-{}.so", std::process::id())));
        std::fs::write(&source, SOURCE).unwrap();
        let built = Command::new("cc").args(["-shared", "-fPIC", "-o"]).args([&library, &source]).status().ok()?;
        assert!(built.success(), "the shim does not compile");
        Some(library)
    };
    BUILT.get_or_init(build).as_ref()
}

/// The command with faults; `None` where they cannot be shown.
pub fn with_faults(mut command: Command, faults: &[(&str, &str)]) -> Option<Command> {
    let Some(library) = library() else {
        println!("not shown here: there is no C compiler");
        return None;
    };
    command.env("LD_PRELOAD", library).envs(faults.iter().copied());
    Some(command)
}
