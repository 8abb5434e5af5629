//! The logs that fuzzing with coverage kept, read again. `tests/fuzz/README.md` says how they came about.

use std::path::Path;

#[path = "../fuzz/crafted.rs"]
#[allow(dead_code, reason = "shared with other tests")]
mod crafted;
#[path = "../fuzz/script.rs"]
mod script;

/// What the fuzzer begins with: the first commits of every golden log, and the smaller ones as they are.
fn seeds() -> Vec<(String, Vec<u8>)> {
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("checkpoints/golden");
    let paths = std::fs::read_dir(golden).unwrap().map(|entry| entry.unwrap().path());
    let logs = paths.filter(|path| path.extension().is_some_and(|extension| extension == "mcap"));
    let scripts = logs.flat_map(|path| {
        let (name, log) = (path.file_stem().unwrap().display().to_string(), std::fs::read(&path).unwrap());
        let first = [1, 2, 5].map(|commits| (format!("{name}-{commits}"), script::script_of(&log, commits)));
        let whole = (log.len() < 28_000).then(|| (format!("{name}-as-it-is"), [&[255], &log[..]].concat()));
        first.into_iter().chain(whole)
    });
    scripts.collect()
}

#[test]
fn the_corpus_of_the_fuzzer_is_read() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus");
    let kept = std::fs::read_dir(corpus).unwrap().map(|entry| std::fs::read(entry.unwrap().path()).unwrap());
    let mut count = 0;
    for script in kept.chain(seeds().into_iter().map(|(_, script)| script)) {
        script::read(script::log_of(&script));
        count += 1;
    }
    println!("{count} logs");
}

/// Seeds are logs whose commits are good, to the last: what the fuzzer changes is met behind every seal.
#[test]
fn seeds_are_whole_logs() {
    // A thinned log lacks what its commits name; there the script is not the log.
    for (name, script) in seeds().iter().filter(|(name, _)| !name.ends_with("as-it-is") && !name.contains("thinned")) {
        let log = foldline::journal::Log::from_bytes(script::log_of(script)).unwrap();
        assert!(log.loss().is_none(), "{name}: {:?}", log.loss());
        assert!((0..log.commits()).all(|index| !log.keeps_state(index) || log.state(index).is_ok()), "{name}");
    }
}

/// Writes the seeds into the folder that `FOLDLINE_FUZZ_SEEDS` names.
#[test]
#[ignore = "writes files: the fuzzing needs it once"]
fn write_seeds() {
    let folder = std::env::var("FOLDLINE_FUZZ_SEEDS").unwrap();
    for (name, script) in seeds() {
        std::fs::write(Path::new(&folder).join(name), script).unwrap();
    }
}
