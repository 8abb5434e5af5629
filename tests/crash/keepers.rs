//! The log and its keepers: whether it is still the file that was written, and who may write it.

use std::process::Stdio;
use std::time::Duration;

use foldline::journal::{Completeness, Log};

use crate::program::{Said, Sandbox, Straight, assert_ends_with};
use crate::shim::with_faults;
use crate::signals::Under;

/// What the system calls the absence of locks.
const ENOLCK: &str = "37";
const EOPNOTSUPP: &str = "95";

/// A run of the small scene that stands still after a few stages.
fn standing_still(place: &Sandbox) -> Under {
    let run = Under::way(place.command("run small.toml -o run.mcap --json --threads 1"), 5);
    run.send("STOP");
    std::thread::sleep(Duration::from_millis(50));
    run
}

/// Whatever happens to the log of a run, the run stops at the next commit, says what it was, and harms nothing.
#[test]
fn a_log_in_other_hands_stops_the_run() {
    let whole = Straight::small();
    let place = Sandbox::new();
    let log = place.file("run.mcap");

    let run = standing_still(&place);
    let kept = place.read("run.mcap");
    std::fs::remove_file(&log).unwrap();
    run.send("CONT");
    let (said, reported) = run.end();
    said.ends(1).says(&["the run stopped\n", "run.mcap was removed while it was written, and its", "stages with it"]);
    assert!(reported < whole.stages, "not to the end");
    assert_eq!(place.logs(), Vec::<String>::new());

    let run = standing_still(&place);
    std::fs::rename(&log, place.file("moved.mcap")).unwrap();
    run.send("CONT");
    run.end().0.ends(1).says(&["run.mcap was moved elsewhere while it was written; there it holds"]);
    place.foldline("resume moved.mcap").ends(0);
    assert_ends_with(&place.log("moved.mcap"), whole.chain, "under its new name");

    let run = standing_still(&place);
    std::fs::rename(place.file("moved.mcap"), &log).unwrap();
    let other = place.read("run.mcap");
    run.send("CONT");
    run.end().0.ends(1).says(&["run.mcap is another file than the one that was written"]);
    assert_eq!(place.read("run.mcap"), other);
    std::fs::remove_file(&log).unwrap();

    for left in [0, kept.len() as u64 / 2] {
        let run = standing_still(&place);
        std::fs::OpenOptions::new().write(true).open(&log).unwrap().set_len(left).unwrap();
        run.send("CONT");
        run.end().0.ends(1).says(&[&format!("run.mcap has {left} bytes where"), "has cut it"]);
        assert_eq!(std::fs::metadata(&log).unwrap().len(), left, "nothing is added behind the cut");
        std::fs::remove_file(&log).unwrap();
    }
}

/// A rival that writes behind the last commit is not written into, nor cut off.
#[test]
fn what_a_rival_appends_stays() {
    let place = Sandbox::new();
    let run = standing_still(&place);
    let mut grown = place.read("run.mcap");
    grown.extend_from_slice(b"what a rival appends");
    std::fs::OpenOptions::new()
        .append(true)
        .open(place.file("run.mcap"))
        .map(|mut file| {
            std::io::Write::write_all(&mut file, b"what a rival appends").unwrap();
        })
        .unwrap();
    run.send("CONT");
    run.end().0.ends(1).says(&["something else writes to it"]);
    assert_eq!(place.read("run.mcap"), grown);
}

/// Trouble in reading the lease passes; it is not taken for a rival.
#[test]
fn a_lease_that_cannot_be_read_for_a_while_stops_nobody() {
    let whole = Straight::small();
    // EIO, EMFILE, ESTALE
    for errno in [5, 24, 116] {
        let place = Sandbox::new();
        let faults = format!("{errno} 4 8");
        let command = place.command("run small.toml -o run.mcap --quiet");
        let Some(mut command) = with_faults(command, &[("FAIL_LEASE", &faults)]) else { return };
        Said::new("run with a lease that cannot be read for a while", command.output().unwrap()).ends(0);
        assert_ends_with(&place.log("run.mcap"), whole.chain, "the lease could be read again");
        assert_eq!(place.logs(), ["run.mcap"]);
    }
}

/// Three start at once where there are no locks: one continues, and nothing is left that keeps the next one out.
#[test]
fn without_locks_one_of_three_goes_on() {
    let whole = Straight::small();
    for round in 0..50 {
        let place = Sandbox::new();
        let command = "run small.toml -o run.mcap --until 1 --quiet --threads 1";
        if round % 3 == 1 {
            // Left by a process that was killed.
            let mut dead = std::process::Command::new("true").spawn().unwrap();
            dead.wait().unwrap();
            let text = |path: &str| std::fs::read_to_string(path).unwrap().trim().to_owned();
            let space = std::fs::read_link("/proc/self/ns/pid").unwrap();
            let process = format!("{} {} {} 7", text("/proc/sys/kernel/random/boot_id"), space.display(), dead.id());
            place.write("run.mcap.lease", format!("a token\nprocess {} (here)\n{process}\n", dead.id()));
        }
        let errno = if round % 2 == 0 { ENOLCK } else { EOPNOTSUPP };
        let mut rivals = Vec::new();
        for _ in 0..3 {
            let Some(mut rival) = with_faults(place.command(command), &[("FAIL_FLOCK", errno)]) else { return };
            rivals.push(rival.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap());
        }
        let said = rivals.into_iter().map(|rival| Said::new(command, rival.wait_with_output().unwrap()));
        let (went_on, refused): (Vec<_>, Vec<_>) = said.partition(|said| said.code == Some(0));
        assert_eq!(went_on.len(), 1, "round {round}: {went_on:?} {refused:?}");
        for said in refused {
            let busy = said.err.contains("run.mcap is being written by process");
            assert!(busy || said.err.contains("run.mcap exists"), "round {round}: {said:?}");
        }
        assert_eq!(place.logs(), ["run.mcap"], "round {round}");
        assert_eq!(place.log("run.mcap").completeness(), Completeness::Unfinished, "round {round}");
        if round % 10 == 0 {
            place.foldline("resume run.mcap --quiet").ends(0);
            assert_ends_with(&place.log("run.mcap"), whole.chain, "resumed");
        }
    }
}

/// Several take a log up that holds nothing: none takes it from another.
#[test]
fn an_empty_log_is_begun_anew_by_one() {
    let whole = Straight::small();
    for round in 0..10 {
        let place = Sandbox::new();
        place.write("run.mcap", "");
        let command = "run small.toml -o run.mcap --resume --quiet --threads 1";
        let start = || place.command(command).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let rivals = [start(), start(), start()];
        let said = rivals.map(|rival| Said::new(command, rival.wait_with_output().unwrap()));
        assert!(said.iter().any(|said| said.code == Some(0)), "round {round}: {said:?}");
        assert!(said.iter().all(|said| !said.err.contains("the run stopped")), "round {round}: {said:?}");
        assert_ends_with(&Log::read(&place.file("run.mcap")).unwrap(), whole.chain, "the one");
        assert_eq!(place.logs(), ["run.mcap"], "round {round}");
    }
}

/// Where no thread can be made one does everything, and the chain is the same; some threads are no help without the rest.
#[test]
fn without_threads_one_does_everything() {
    let whole = Straight::small();
    for made in ["0", "1"] {
        let place = Sandbox::new();
        let run = |arguments: &str| {
            let command = with_faults(place.command(arguments), &[("FAIL_THREADS", made)])?;
            Some(Said::new(arguments, { command }.output().unwrap()))
        };
        let Some(said) = run("run small.toml -o run.mcap --threads 4 --until 6") else { return };
        said.ends(0).says(&["warning: threads cannot be made", "everything is done on one"]);
        assert!(run("resume run.mcap --threads 1").unwrap().ends(0).err.lines().all(|line| !line.contains("threads")));
        assert_ends_with(&place.log("run.mcap"), whole.chain, "on one thread");
        run("replay run.mcap --step 9").unwrap().ends(0);
        run("stability run.mcap --step 3").unwrap().ends(0);
        run("plot run.mcap").unwrap().ends(0);
    }
}

/// The same with the system's own limit on the processes of a user.
#[test]
fn a_limit_on_processes_is_no_panic() {
    let whole = Straight::small();
    let place = Sandbox::new();
    std::fs::set_permissions(place.path(), std::os::unix::fs::PermissionsExt::from_mode(0o777)).unwrap();
    let mut command = std::process::Command::new("setpriv");
    command.args(["--reuid=54321", "--regid=54321", "--clear-groups", "prlimit", "--nproc=1:1"]);
    command.arg(env!("CARGO_BIN_EXE_foldline")).args(["run", "small.toml", "-o", "run.mcap", "--threads", "4"]);
    let output = command.current_dir(place.path()).output();
    let Some(said) = output.ok().map(|output| Said::new("run as another user", output)) else {
        println!("not shown here: there is no setpriv");
        return;
    };
    if said.code == Some(127) || said.err.starts_with("setpriv:") || said.err.starts_with("prlimit:") {
        println!("not shown here: {}", said.err);
        return;
    }
    said.ends(0).says(&["everything is done on one"]);
    assert_ends_with(&place.log("run.mcap"), whole.chain, "on one thread");
}

/// A run that is resumed by root stays its owner's.
#[test]
fn the_owner_stays() {
    use std::os::unix::fs::MetadataExt;
    let whole = Straight::small();
    let place = Sandbox::new();
    place.write("run.mcap", whole.cut_after(25));
    if std::os::unix::fs::chown(place.file("run.mcap"), Some(54321), Some(54321)).is_err() {
        println!("not shown here: only root may give files away");
        return;
    }
    place.foldline("resume run.mcap --quiet").ends(0);
    let metadata = std::fs::metadata(place.file("run.mcap")).unwrap();
    assert_eq!((metadata.uid(), metadata.gid()), (54321, 54321));
    assert_ends_with(&place.log("run.mcap"), whole.chain, "another's");
}

/// Killed at any instant, `recover` leaves a whole copy or none, and a second try works.
#[test]
fn a_recovery_that_is_killed_leaves_all_or_nothing() {
    let place = Sandbox::new();
    // Long enough to be met in the middle.
    let run = crate::synthetic::run(40, 60);
    place.write("run.mcap", crate::support::finished_log(&run));
    let began = std::time::Instant::now();
    place.foldline("recover run.mcap -o copy.mcap").ends(0);
    let took = began.elapsed();
    let whole = place.read("copy.mcap");
    let mut copies = 0;
    for kill in 0..100_u32 {
        let _ = std::fs::remove_file(place.file("copy.mcap"));
        let mut child = place.command("recover run.mcap -o copy.mcap").stdout(Stdio::null()).spawn().unwrap();
        // The last ones after more than three times as long: a machine that is busy by then still comes to the end.
        std::thread::sleep(took * (kill * kill) / 2700);
        child.kill().unwrap();
        child.wait().unwrap();
        let there = place.file("copy.mcap").exists();
        copies += usize::from(there);
        if there {
            assert_eq!(place.read("copy.mcap"), whole, "kill {kill}");
            std::fs::remove_file(place.file("copy.mcap")).unwrap();
        }
        assert_eq!(place.logs(), ["run.mcap"], "kill {kill}: nothing is left");
        if kill % 10 == 0 {
            place.foldline("recover run.mcap -o copy.mcap").ends(0);
            assert_eq!(place.read("copy.mcap"), whole, "kill {kill}: a second try");
        }
    }
    assert!((1..100).contains(&copies), "{copies} of 100 kills came after the end");
}

/// A trace is written over nothing, logs above all, nor are pictures.
#[test]
fn nothing_is_written_over() {
    let whole = Straight::small();
    let place = Sandbox::new();
    place.write("run.mcap", &whole.bytes);
    for name in ["run", "run.mcap"] {
        let said = place.foldline(&format!("replay run.mcap --step 3 --trace {name}")).ends(2);
        said.says(&["run.mcap exists and is not overwritten"]);
    }
    place.write("trace.csv", "somebody's");
    place.foldline("replay run.mcap --step 3 --trace trace").ends(2).says(&["trace.csv exists"]);
    assert_eq!((place.read("run.mcap"), place.read("trace.csv")), (whole.bytes.clone(), b"somebody's".to_vec()));
    assert_eq!(place.logs(), ["run.mcap", "trace.csv"]);
    place.foldline("plot run.mcap").ends(0);
    place.foldline("plot run.mcap --step 3").ends(2).says(&["run/", "exists and is not overwritten"]);
    place.foldline("plot run.mcap --step 3 -o others").ends(0);
}

/// A kill may meet the last write, which ends the log and adds the summary for viewers: the next resume mends it.
#[test]
fn a_summary_that_was_cut_is_made_again() {
    let whole = Straight::small();
    let place = Sandbox::new();
    let last = whole.log().entries().last().unwrap().bytes.end as usize;
    for cut in (last..whole.bytes.len()).step_by((whole.bytes.len() - last) / 12) {
        place.write("run.mcap", &whole.bytes[..cut]);
        place.foldline("resume run.mcap --quiet").ends(0);
        let log = place.log("run.mcap");
        assert_ends_with(&log, whole.chain, &format!("cut at {cut} of {}", whole.bytes.len()));
        assert!(log.has_summary());
        assert_eq!(place.logs(), ["run.mcap"]);
    }
}
