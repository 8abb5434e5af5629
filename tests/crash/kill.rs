//! The real program, killed at random instants: each run continues without a hand, to the same end.
//!
//! By default as many kills as fit into about half a minute. `FOLDLINE_KILLS=200` asks for that many, however long it
//! takes; `FOLDLINE_SEED=0x…` repeats a seed that was printed.

use std::time::{Duration, Instant};

use foldline::journal::{Completeness, Log, ReadError};

use crate::flips::{Random, seed};
use crate::program::{Sandbox, Straight, assert_ends_with};

/// What the default test may take.
const BUDGET: Duration = Duration::from_secs(30);

/// The scenes that are run: a shell that snaps, and a structure.
const SCENES: [&str; 2] = ["small.toml", "structure.toml"];

/// Kills one run of a scene after another, most once, some again while they are resumed.
fn kill_and_resume(random: &mut Random, trial: usize, took: [Duration; 2], hits: &mut Vec<usize>) -> usize {
    let which = trial % 2;
    let (scene, took) = (SCENES[which], took[which]);
    let whole = [Straight::small, Straight::structure][which]();
    let straight = whole.log();
    let place = Sandbox::new();
    let mut kills = 0;
    loop {
        let threads = 1 + random.below(2);
        // The same command from the start and after every kill.
        let command = format!("run {scene} -o run.mcap --resume --quiet --threads {threads}");
        let mut child = place.command(&command).spawn().unwrap();
        // Every fourth in the first hundredth of a second, where the log is created or copied.
        let range = if random.below(4) == 0 { Duration::from_millis(10) } else { took.mul_f64(1.1) };
        let delay = Duration::from_micros(random.below(range.as_micros() as usize) as u64);
        std::thread::sleep(delay);
        child.kill().unwrap();
        let killed = !child.wait().unwrap().success();
        kills += usize::from(killed);
        let what = format!("trial {trial} of {scene}, killed after {delay:?}");
        let log = match Log::read(&place.file("run.mcap")) {
            Ok(log) => log,
            Err(ReadError::Io { .. }) => {
                assert!(!place.file("run.mcap").exists(), "{what}");
                hits.push(0);
                if random.below(3) == 0 {
                    continue;
                }
                place.foldline(&format!("run {scene} -o run.mcap --resume")).ends(0);
                assert_ends_with(&place.log("run.mcap"), whole.chain, &what);
                return kills;
            }
            Err(error) => panic!("{what}: {error}"),
        };
        assert!(!matches!(log.completeness(), Completeness::Damaged { .. }), "{what}");
        assert!(!log.manifests().is_empty(), "{what}: whatever is there can be resumed");
        for (entry, other) in log.entries().iter().zip(straight.entries()) {
            assert_eq!(entry.record.commit, other.record.commit, "{what}");
        }
        hits.push(log.entries().len());
        if random.below(3) == 0 && kills < 5 {
            continue;
        }
        place.foldline("resume run.mcap --quiet").ends(0);
        assert_ends_with(&place.log("run.mcap"), whole.chain, &what);
        // A copy that replaces a log has a hidden name for the microseconds between two calls of the system: no call replaces a
        // file by one without a name.
        let is_hidden = |name: &String| name.starts_with(".foldline-") && name.ends_with(".new");
        let left: Vec<String> = place.logs().into_iter().filter(|name| !is_hidden(name)).collect();
        assert_eq!(left, ["run.mcap"], "{what}: nothing else is left");
        return kills;
    }
}

#[test]
fn killed_at_random_instants() {
    let wanted = std::env::var("FOLDLINE_KILLS").ok().map(|text| text.parse::<usize>().unwrap());
    let began = Instant::now();
    Straight::small();
    Straight::structure();
    let place = Sandbox::new();
    let took = SCENES.map(|scene| {
        let start = Instant::now();
        place.foldline(&format!("run {scene} -o {scene}.mcap --quiet")).ends(0);
        start.elapsed()
    });
    let mut random = Random::new(seed());
    let (mut kills, mut trials, mut hits) = (0, 0, Vec::new());
    while wanted.map_or(kills < 200 && began.elapsed() < BUDGET, |wanted| kills < wanted) {
        kills += kill_and_resume(&mut random, trials, took, &mut hits);
        trials += 1;
    }
    let distinct: std::collections::BTreeSet<_> = hits.iter().collect();
    println!("{kills} kills of {trials} runs in {:?}; stages kept: {distinct:?}", began.elapsed());
    assert!(kills >= 10, "only {kills} kills");
}
