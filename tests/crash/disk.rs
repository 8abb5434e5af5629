//! Disks that are full, folders that are read-only or gone, with the real program.

use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Command, Stdio};

use foldline::journal::Completeness;

use crate::program::{SMALL, Said, Sandbox, Straight, assert_ends_with};
use crate::signals::Under;

fn is_root() -> bool {
    std::fs::metadata("/proc/self").is_ok_and(|metadata| std::os::unix::fs::MetadataExt::uid(&metadata) == 0)
}

/// A limit on the size of files, which the system holds the program to as it does at the end of a disk.
#[test]
fn no_room_for_the_log() {
    let whole = Straight::small();
    for kibibytes in [20, 60, 100] {
        let place = Sandbox::new();
        // Blocks of 512 bytes.
        let script = format!("ulimit -f {}; exec \"$0\" \"$@\"", 2 * kibibytes);
        let limited = |arguments: &str| {
            let mut command = Command::new("sh");
            command.args(["-c", &script, env!("CARGO_BIN_EXE_foldline")]).args(arguments.split_whitespace());
            Said::new(arguments, command.current_dir(place.path()).stdin(Stdio::null()).output().unwrap())
        };
        let said = limited("run small.toml -o run.mcap");
        let log = place.log("run.mcap");
        let stages = log.entries().len();
        assert!(stages > 0 && stages < whole.stages, "{stages} stages in {kibibytes} KiB");
        let holds = format!("cannot write run.mcap; it holds {stages} stages");
        said.ends(1).says(&[&holds, "foldline resume run.mcap", "File too large"]);
        assert_eq!(log.completeness(), Completeness::Unfinished, "half of a stage is not left behind");
        // No more room than before: refused, and the log stands.
        let before = place.read("run.mcap");
        let said = limited("resume run.mcap").ends(1);
        said.says(&["run.mcap"]);
        assert!(place.log("run.mcap").entries().len() >= stages, "{kibibytes} KiB");
        assert!(place.read("run.mcap").starts_with(&before[..1000]));
        place.foldline("resume run.mcap").ends(0);
        assert_ends_with(&place.log("run.mcap"), whole.chain, "with room again");
        assert_eq!(place.logs(), ["run.mcap"]);
    }
}

/// A limit on the size of files is an error that names the file, in every command that writes one, and nothing of the
/// file is left.
#[test]
fn no_room_for_other_files() {
    let whole = Straight::small();
    let place = Sandbox::new();
    place.write("run.mcap", &whole.bytes);
    let commands = [
        ("recover run.mcap -o copy.mcap", "cannot write copy.mcap"),
        ("plot run.mcap -o pictures", "cannot write pictures/"),
        ("replay run.mcap --step 9 --trace trace", "cannot write trace."),
    ];
    for (arguments, names) in commands {
        let mut command = Command::new("sh");
        command.args(["-c", "ulimit -f 2; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_foldline")]);
        command.args(arguments.split_whitespace()).current_dir(place.path());
        Said::new(arguments, command.output().unwrap()).ends(1).says(&[names, "File too large"]);
    }
    assert_eq!(place.logs(), ["run.mcap"]);
    assert_eq!(place.read("run.mcap"), whole.bytes);
}

/// A file system that a test makes and unmounts.
struct Mounted<'a>(&'a Path);

impl<'a> Mounted<'a> {
    /// `None` where this process may not.
    fn new(folder: &'a Path, options: &str) -> Option<Self> {
        std::fs::create_dir(folder).unwrap();
        mount(&["-t", "tmpfs", "-o", options, "tmpfs"], folder).then_some(Self(folder))
    }
}

impl Drop for Mounted<'_> {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0).status();
    }
}

fn mount(arguments: &[&str], folder: &Path) -> bool {
    let status = Command::new("mount").args(arguments).arg(folder).stderr(Stdio::null()).status();
    status.is_ok_and(|status| status.success())
}

/// A disk that is full in earnest, and a disk that becomes read-only. Needs the right to mount; elsewhere the limit
/// above stands in.
#[test]
fn a_full_disk_and_a_read_only_one() {
    let whole = Straight::small();
    let place = Sandbox::new();
    let folder = place.file("disk");
    let Some(_mounted) = is_root().then(|| Mounted::new(&folder, "size=100k")).flatten() else {
        println!("not shown here: mounting is not allowed");
        return;
    };
    let said = place.foldline("run small.toml -o disk/run.mcap").ends(1);
    let log = place.log("disk/run.mcap");
    let stages = log.entries().len();
    assert!(stages > 3 && stages < whole.stages, "{stages} stages");
    assert_eq!(log.completeness(), Completeness::Unfinished);
    let holds = format!("; it holds {stages} stages, all good. Make space, then");
    let because = "because: No space left on device";
    said.says(&["no space left to write disk/run.mcap (", "bytes more, where there is room for", &holds, because]);
    let before = place.read("disk/run.mcap");

    // Still full.
    place.foldline("resume disk/run.mcap").ends(1).says(&["disk/run.mcap", "No space left on device"]);
    assert_eq!(place.read("disk/run.mcap"), before);
    assert!(!place.file("disk/run.mcap.new").exists());

    assert!(mount(&["-o", "remount,size=10m,ro"], &folder));
    place.foldline("resume disk/run.mcap").ends(1).says(&["disk/run.mcap.lock", "Read-only file system"]);
    place.foldline("inspect disk/run.mcap").ends(0);
    assert_eq!(place.read("disk/run.mcap"), before);

    assert!(mount(&["-o", "remount,size=10m,rw"], &folder));
    place.foldline("resume disk/run.mcap").ends(0);
    assert_ends_with(&place.log("disk/run.mcap"), whole.chain, "with room again");
}

/// Limits under which a log cannot even be begun: none is named as if it were there.
#[test]
fn a_log_that_cannot_be_begun() {
    let mut refused = 0;
    for limit in ["-f 0", "-f 1", "-f 2", "-n 4", "-n 5", "-n 6", "-n 7"] {
        let place = Sandbox::new();
        let mut command = Command::new("sh");
        command.args(["-c", &format!("ulimit {limit}; exec \"$0\" \"$@\""), env!("CARGO_BIN_EXE_foldline")]);
        command.args(["run", "small.toml", "-o", "run.mcap", "--quiet"]).current_dir(place.path());
        let said = Said::new(limit, command.stdin(Stdio::null()).output().unwrap());
        if said.code == Some(2) {
            refused += 1;
            assert!(!said.err.contains("foldline resume"), "{limit}: {}", said.err);
            assert_eq!(place.logs(), Vec::<String>::new(), "{limit}");
        }
    }
    assert!(refused >= 3, "{refused} refused");
}

/// A disk that is full before the run begins: no log is named that is not there, and what is missing is said.
#[test]
fn a_disk_that_is_full_at_the_start() {
    let place = Sandbox::new();
    let folder = place.file("disk");
    let Some(_mounted) = is_root().then(|| Mounted::new(&folder, "size=64k")).flatten() else {
        println!("not shown here: mounting is not allowed");
        return;
    };
    // Room for nothing, for the lease, and for the lease and half of the manifest.
    for free in [0, 4 << 10] {
        place.write("disk/filler", vec![1; (64 << 10) - free]);
        let said = place.foldline("run small.toml -o disk/run.mcap").ends(2);
        let said =
            said.says(&["no space left", "where there is room for", "Make space, then", "No space left on device"]);
        assert!(!said.err.contains("foldline resume"), "{}", said.err);
        std::fs::remove_file(place.file("disk/filler")).unwrap();
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0, "nothing is left, {free} bytes free");
    }
}

/// A folder that this user may not write to.
#[test]
fn a_read_only_folder() {
    let whole = Straight::small();
    let place = Sandbox::new();
    let as_nobody = |arguments: &str| {
        let mut command = place.command(arguments);
        if is_root() {
            command.uid(65534).gid(65534);
        }
        command
    };
    place.write("run.mcap", whole.cut_after(25));
    let mode = |mode| std::fs::set_permissions(place.path(), std::fs::Permissions::from_mode(mode)).unwrap();
    mode(0o555);
    if as_nobody("--version").output().is_err() {
        println!("not shown here: another user may not start the program");
        mode(0o755);
        return;
    }
    let run = |arguments: &str| Said::new(arguments, as_nobody(arguments).output().unwrap());
    run("resume run.mcap").ends(1).says(&["run.mcap.lock", "Permission denied"]);
    run("run small.toml -o new.mcap").ends(2).says(&["new.mcap.lock", "Permission denied"]);
    run("recover run.mcap -o new.mcap").ends(1).says(&["new.mcap", "Permission denied"]);
    run("verify run.mcap").ends(0);
    run("replay run.mcap --step 3").ends(0);
    mode(0o755);
    assert_eq!(place.read("run.mcap"), whole.cut_after(25));
    assert_eq!(place.logs(), ["run.mcap"]);
    place.foldline("resume run.mcap").ends(0);
    assert_ends_with(&place.log("run.mcap"), whole.chain, "with the right to write");
}

/// A folder that goes while the run writes in it: moved away, or removed.
#[test]
fn a_folder_that_vanishes() {
    let whole = Straight::small();
    let place = Sandbox::new();
    let started = || {
        std::fs::create_dir_all(place.file("logs")).unwrap();
        let run = Under::way(place.command("run small.toml -o logs/run.mcap --json --threads 1"), 8);
        run.send("STOP");
        std::thread::sleep(std::time::Duration::from_millis(50));
        run
    };
    let run = started();
    std::fs::rename(place.file("logs"), place.file("moved")).unwrap();
    run.send("CONT");
    let said = run.end().0.ends(1);
    assert!(
        ["its folder was moved or removed", "run.mcap was moved"].iter().any(|it| said.err.contains(it)),
        "{said:?}"
    );
    assert!(!place.file("logs").exists());
    let log = place.log("moved/run.mcap");
    assert!((8..whole.stages).contains(&log.entries().len()));
    place.foldline("verify moved/run.mcap").ends(0);
    std::fs::rename(place.file("moved"), place.file("logs")).unwrap();
    place.foldline("resume logs/run.mcap").ends(0);
    assert_ends_with(&place.log("logs/run.mcap"), whole.chain, "with its folder back");

    std::fs::remove_dir_all(place.file("logs")).unwrap();
    let run = started();
    std::fs::remove_dir_all(place.file("logs")).unwrap();
    run.send("CONT");
    // Whichever it looks at first.
    let said = run.end().0.ends(1);
    assert!(
        ["logs/run.mcap.lease is gone", "logs/run.mcap was removed"].iter().any(|it| said.err.contains(it)),
        "{said:?}"
    );
    assert_eq!(place.logs(), Vec::<String>::new());
    place.foldline("resume logs/run.mcap").ends(2).says(&["cannot read logs/run.mcap"]);
    place.foldline("run small.toml -o logs/run.mcap").ends(2).says(&["there is no folder logs for logs/run.mcap"]);
    assert_eq!(String::from_utf8(place.read("small.toml")).unwrap(), SMALL);
}

/// What a power cut may leave of a log that had just begun.
#[test]
fn an_empty_log_is_started_again() {
    let whole = Straight::small();
    for left in [0, 5] {
        let place = Sandbox::new();
        place.write("run.mcap", &whole.bytes[..left]);
        place.foldline("resume run.mcap").ends(1).says(&["no stage is in it. Delete it and start the run again"]);
        place.foldline("run small.toml -o run.mcap --resume").ends(0).says(&["run.mcap holds nothing: started again"]);
        assert_ends_with(&place.log("run.mcap"), whole.chain, "started again");
    }
    let place = Sandbox::new();
    place.write("run.mcap", "a diary");
    place.foldline("run small.toml -o run.mcap --resume").ends(1).says(&["this is not a log"]);
    assert_eq!(place.read("run.mcap"), b"a diary");
}
