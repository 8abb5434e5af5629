//! Signals, and two processes on one log, with the real program.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use foldline::journal::Completeness;

use crate::program::{SMALL, Said, Sandbox, Straight, assert_ends_with};

/// A run under way, which has reported so many stages as JSON lines.
pub struct Under {
    child: Child,
    out: BufReader<std::io::PipeReader>,
    seen: usize,
}

impl Under {
    pub fn way(mut command: Command, stages: usize) -> Self {
        // Room for a few lines: the run waits for its reader, and is still under way when a signal comes late.
        let (out, into) = std::io::pipe().unwrap();
        rustix::pipe::fcntl_setpipe_size(&into, 4096).unwrap();
        let child = command.stdout(into).stderr(Stdio::piped()).spawn().unwrap();
        // The command has the other end as well, at which the pipe would not end.
        drop(command);
        let mut out = BufReader::new(out);
        let mut line = String::new();
        for _ in 0..stages {
            assert!(out.read_line(&mut line).unwrap() > 0, "the run ended early");
        }
        Self { child, out, seen: stages }
    }

    pub fn send(&self, signal: &str) {
        let pid = self.child.id().to_string();
        assert!(Command::new("kill").args([&format!("-{signal}"), &pid]).status().unwrap().success());
    }

    /// Waits for its end. Gives what it said and how many stages it reported.
    pub fn end(mut self) -> (Said, usize) {
        let more = self.out.by_ref_lines();
        let output: Output = self.child.wait_with_output().unwrap();
        (Said::new("a run under way", output), self.seen + more)
    }
}

trait Lines {
    fn by_ref_lines(&mut self) -> usize;
}

impl<R: std::io::Read> Lines for BufReader<R> {
    fn by_ref_lines(&mut self) -> usize {
        self.lines().map(Result::unwrap).count()
    }
}

/// Everything that was reported is committed, the log is closed in good order, and a resume ends as a straight run.
#[test]
fn the_first_signal_ends_after_the_stage_in_hand() {
    let whole = Straight::small();
    for (signal, stages) in [("INT", 3), ("TERM", 12), ("INT", 33), ("HUP", 5), ("USR1", 7), ("XCPU", 9)] {
        let place = Sandbox::new();
        let run = Under::way(place.command("run small.toml -o run.mcap --json --threads 1"), stages);
        run.send(signal);
        let (said, reported) = run.end();
        said.ends(75).says(&["interrupted; continue with: foldline resume run.mcap"]);
        let log = place.log("run.mcap");
        assert_eq!(log.completeness(), Completeness::Unfinished);
        assert_eq!(log.entries().len(), reported);
        assert!(reported < whole.stages, "stopped before its end");
        assert_eq!(place.logs(), ["run.mcap"]);
        place.foldline("verify run.mcap").ends(0);

        // Again while it is resumed.
        let run = Under::way(place.command("resume run.mcap --json --threads 2"), 2);
        run.send(signal);
        let (said, more) = run.end();
        said.ends(75);
        assert_eq!(place.log("run.mcap").entries().len(), reported + more);
        place.foldline("resume run.mcap").ends(0);
        assert_ends_with(&place.log("run.mcap"), whole.chain, signal);
    }
}

/// The signals that come more than once for one cause end a run at a stage however often they come, and `nohup` is heeded.
#[test]
fn signals_that_come_again_and_one_that_is_ignored() {
    let place = Sandbox::new();
    let run = Under::way(place.command("run small.toml -o run.mcap --json --threads 1"), 5);
    (0..5).for_each(|_| run.send("HUP"));
    let (said, reported) = run.end();
    said.ends(75).says(&["interrupted; continue with: foldline resume run.mcap"]);
    assert_eq!(place.log("run.mcap").entries().len(), reported);

    let whole = Straight::small();
    let mut nohup = Command::new("nohup");
    nohup.arg(env!("CARGO_BIN_EXE_foldline")).args(["resume", "run.mcap", "--json", "--threads", "1"]);
    nohup.current_dir(place.path()).stdin(Stdio::null());
    let run = Under::way(nohup, 5);
    run.send("HUP");
    run.end().0.ends(0);
    assert_ends_with(&place.log("run.mcap"), whole.chain, "the terminal is closed and nohup was asked for");
}

/// Processor time that a process has taken, of hundredths of seconds.
fn on_cpu(process: u32) -> Duration {
    let told = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    let after_name = told.rsplit(')').next().unwrap_or_default();
    let ticks = after_name.split_whitespace().skip(11).take(2).filter_map(|ticks| ticks.parse::<u64>().ok());
    Duration::from_millis(10 * ticks.sum::<u64>())
}

/// A stage that takes minutes: the first signal waits for it, the second does not.
#[test]
fn the_second_signal_ends_at_once() {
    let place = Sandbox::new();
    let large =
        SMALL.replace("elements = [4, 4]", "elements = [256, 128]").replace("part = \"quarter\"", "part = \"none\"");
    place.write("large.toml", large);
    let run = Under::way(place.command("run large.toml -o run.mcap --json --threads 1"), 0);
    let began = Instant::now();
    while !place.file("run.mcap").exists() {
        assert!(began.elapsed() < Duration::from_secs(20), "no log");
        std::thread::sleep(Duration::from_millis(5));
    }
    // In the middle of the first stage, however slow the machine is.
    while on_cpu(run.child.id()) < Duration::from_secs(1) {
        std::thread::sleep(Duration::from_millis(5));
    }
    run.send("TERM");
    std::thread::sleep(Duration::from_millis(300));
    let mut run = run;
    assert_eq!(run.child.try_wait().unwrap(), None, "waits for the stage in hand");
    let second = Instant::now();
    run.send("TERM");
    let (said, reported) = run.end();
    // The stage in hand would take far longer.
    assert!(second.elapsed() < Duration::from_secs(5), "{:?}", second.elapsed());
    said.ends(75);
    assert_eq!(reported, 0);
    let log = place.log("run.mcap");
    assert_eq!((log.entries().len(), log.completeness()), (0, Completeness::Unfinished));
    // What is left beside the log keeps nobody out.
    place.write("large.toml", SMALL);
    place.foldline("run large.toml -o run.mcap --resume").ends(1).says(&["mesh.elements changed"]);
}

/// One process writes; every other is told who does, and harms nothing.
#[test]
fn a_second_process_is_refused() {
    let whole = Straight::small();
    let place = Sandbox::new();
    let run = Under::way(place.command("run small.toml -o run.mcap --json --threads 1"), 8);
    run.send("STOP");
    std::thread::sleep(Duration::from_millis(50));
    let before = place.read("run.mcap");
    let busy = format!("run.mcap is being written by process {}", run.child.id());
    for command in ["resume run.mcap", "run small.toml -o run.mcap --resume"] {
        place.foldline(command).ends(1).says(&[&busy, "wait for it or stop it. Nothing was changed"]);
    }
    place.foldline("run small.toml -o run.mcap").ends(2).says(&["run.mcap exists and is not overwritten"]);
    // Reading is free.
    place.foldline("inspect run.mcap").ends(0).says(&["unfinished"]);
    place.foldline("verify run.mcap").ends(0);
    place.foldline("recover run.mcap -o copy.mcap").ends(0);
    place.foldline("replay run.mcap --step 1").ends(0);
    assert_eq!(place.read("run.mcap"), before);
    run.send("CONT");
    run.end().0.ends(0);
    assert_ends_with(&place.log("run.mcap"), whole.chain, "the first");
    assert_eq!(place.logs(), ["copy.mcap", "run.mcap"]);
}

/// Where locks do not work another machine may take the log over: the one that lost it stops, and the other ends as if
/// alone.
#[test]
fn the_one_that_lost_the_lease_stops() {
    let whole = Straight::small();
    let place = Sandbox::new();
    let run = Under::way(place.command("run small.toml -o run.mcap --json --threads 1"), 8);
    run.send("STOP");
    std::thread::sleep(Duration::from_millis(50));
    // A lock that the other does not see.
    std::fs::remove_file(place.file("run.mcap.lock")).unwrap();
    place.foldline("resume run.mcap --until 8").ends(0);
    let after = place.read("run.mcap");
    place.write("run.mcap.lease", "00112233445566778899aabbccddeeff\nprocess 1 (elsewhere)\n");
    run.send("CONT");
    let (said, reported) = run.end();
    said.ends(1).says(&["run.mcap was taken over by process 1 (elsewhere): this run stops and adds nothing to it"]);
    assert!(reported < whole.stages);
    assert_eq!(place.read("run.mcap"), after, "the loser adds nothing");
    place.foldline("resume run.mcap").ends(0);
    assert_ends_with(&place.log("run.mcap"), whole.chain, "the other");
}

/// A log that is removed while it is written is missed at the end, not passed over in silence.
#[test]
fn a_log_that_is_removed_is_missed() {
    let place = Sandbox::new();
    let run = Under::way(place.command("run small.toml -o run.mcap --json --threads 1"), 3);
    std::fs::remove_file(place.file("run.mcap")).unwrap();
    run.end().0.ends(1).says(&["run.mcap was removed while it was written"]);
}
