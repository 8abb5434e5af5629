//! Paths of equilibria, cut anywhere, in the middle of a bisection too: the chain of hashes is that of the straight run.

use std::sync::OnceLock;

use foldline::history::{States, Verdict, compare, replay_stage, verdict};
use foldline::journal::Log;
use foldline::pipeline::Stages;
use foldline::record::Outcome;
use foldline::scene::Stage;
use foldline::state::Course;

use crate::program::{Sandbox, Straight, assert_resumes_from_every_cut, scene};

/// A roof through its limit points, refined on the way.
const ROOF: &str = include_str!("path.toml");
/// A column that leaves the straight branch.
const COLUMN: &str = include_str!("column.toml");

fn roof() -> &'static Straight {
    static RUN: OnceLock<Straight> = OnceLock::new();
    RUN.get_or_init(|| Straight::run(ROOF, 2))
}

fn column() -> &'static Straight {
    static RUN: OnceLock<Straight> = OnceLock::new();
    RUN.get_or_init(|| Straight::run(COLUMN, 2))
}

/// A scene with other lines; each piece must stand in it.
fn with(scene: &str, changes: &[(&str, &str)]) -> String {
    changes.iter().fold(scene.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    })
}

/// Indices of the stages for which something holds.
fn stages_that(log: &Log, holds: impl Fn(usize) -> bool) -> Vec<usize> {
    (0..log.entries().len()).filter(|index| holds(*index)).collect()
}

/// The runs have all that a restart may stumble over.
#[test]
fn the_runs_are_eventful() {
    let log = roof().log();
    let report = |index: usize| &log.entries()[index].record.report;
    let limits = stages_that(&log, |index| report(index).critical_point.is_some_and(|critical| critical.limit_point));
    let [first, second] = limits[..] else { panic!("{limits:?}") };
    let refined = stages_that(&log, |index| report(index).stage == Stage::RefineKnots);
    assert!(refined.iter().any(|index| *index < first), "refined on the way to the limit point");
    assert!(report(first).parameter > report(second).parameter, "the load goes back");
    let bisected = stages_that(&log, |index| report(index).outcome == Outcome::RejectedCriticalPoint);
    assert!(bisected.iter().filter(|index| **index < first).count() >= 2, "{bisected:?}");
    // Both kinds of states in a bisection: rejected, and taken with the rest still ahead.
    let ahead = |index: usize| log.state(index).unwrap().drive.path().is_some_and(|path| path.critical_ahead.is_some());
    let done = |index: usize| report(index).outcome == Outcome::Done && report(index).stage == Stage::Solve;
    assert!(!stages_that(&log, |index| ahead(index) && done(index)).is_empty());
    assert!(stages_that(&log, ahead).len() > bisected.len());

    let log = column().log();
    let switched = stages_that(&log, |index| log.entries()[index].record.report.stage == Stage::SwitchBranch);
    assert_eq!(switched.len(), 1);
}

/// Run on so many threads, cut after every stage in turn.
fn every_cut(scene: &str, whole: &Straight, threads_before: usize, threads_after: usize) {
    let straight = Straight::run(scene, threads_before);
    assert_eq!(straight.chain, whole.chain, "threads change no state");
    assert_eq!(straight.stages, whole.stages);
    assert_resumes_from_every_cut(&straight, "a path", threads_before, threads_after);
}

#[test]
fn every_cut_of_a_path_from_one_thread_to_two() {
    every_cut(ROOF, roof(), 1, 2);
}

#[test]
fn every_cut_of_a_path_from_two_threads_to_one() {
    every_cut(ROOF, roof(), 2, 1);
}

#[test]
fn every_cut_of_a_run_that_switches_branches() {
    every_cut(COLUMN, column(), 1, 2);
}

/// State and report of every stage, with the stages in any order, so that nothing is carried from one to the next.
#[test]
fn every_stage_comes_out_again() {
    for (text, whole) in [(ROOF, roof()), (COLUMN, column())] {
        let log = whole.log();
        let mut stages = Stages::new(scene(text));
        for index in (0..log.entries().len()).rev() {
            let replayed = replay_stage(&mut States::of(&log), index, &mut stages, &mut |_, _| {}).unwrap();
            assert_eq!(verdict(&replayed.comparison), Verdict::BitIdentical, "stage {index}");
            let reports = [&replayed.report, &log.entries()[index].record.report];
            assert_eq!(format!("{:?}", reports[0]), format!("{:?}", reports[1]), "stage {index}");
        }
        let place = Sandbox::new();
        place.write("run.mcap", &whole.bytes);
        let said = place.foldline("replay run.mcap --from-scratch --threads 1").ends(0);
        assert_eq!(said.out.lines().filter(|line| line.ends_with("bit-identical")).count(), whole.stages);
    }
}

/// The last bit of every displacement and every rate before a stage, which another processor may round otherwise, is told
/// as rounding after it: no stage of a path comes out "different".
#[test]
fn rounding_on_a_path_is_called_rounding() {
    let jolt = |(index, value): (usize, &mut f64)| {
        if *value != 0.0 {
            *value = if index % 2 == 0 { value.next_up() } else { value.next_down() };
        }
    };
    for (text, whole) in [(ROOF, roof()), (COLUMN, column())] {
        let log = whole.log();
        let mut stages = Stages::new(scene(text));
        let mut rounded = 0;
        for index in 1..log.entries().len() {
            let mut before = log.state(index - 1).unwrap();
            before.displacement.as_flattened_mut().iter_mut().enumerate().for_each(jolt);
            if let Course::Path(path) = &mut before.drive.course {
                path.heading.as_flattened_mut().iter_mut().enumerate().for_each(jolt);
            }
            let report = &log.entries()[index].record.report;
            // Where branches meet the stiffness is singular: a way off it magnifies rounding without limit.
            if report.stage == Stage::SwitchBranch {
                continue;
            }
            let (state, _) = stages.run(report.stage, &before, &mut |_| {}).unwrap();
            let verdict = verdict(&compare(&log.state(index).unwrap(), &state));
            rounded += usize::from(matches!(verdict, Verdict::WithinTolerance(_)));
            assert!(!matches!(verdict, Verdict::Different(_)), "stage {index}, {}: {verdict:?}", report.stage);
        }
        assert!(2 * rounded > log.entries().len(), "{rounded} of {} stages round otherwise", log.entries().len());
    }
}

/// What steps are made with: complete steps stand, and the log says which scene made what.
#[test]
fn another_longest_step() {
    let whole = roof();
    let log = whole.log();
    let shorter = with(ROOF, &[("longest_step = 8.0", "longest_step = 2.0")]);
    let hashes = [scene(ROOF).hash(), scene(&shorter).hash()];
    // After a complete step, in the middle of one, and in the middle of a bisection.
    let bisecting =
        stages_that(&log, |index| log.entries()[index].record.report.outcome == Outcome::RejectedCriticalPoint);
    for stages in [2, 3, bisecting[1] + 1] {
        let place = Sandbox::new();
        place.write("run.mcap", whole.cut_after(stages));
        place.write("path.toml", &shorter);
        let said = place.foldline("run path.toml -o run.mcap --resume").ends(0);
        said.says(&["continuation.longest_step changed (8.0 → 2.0)", "are kept,", "on is new"]);
        let mixed = place.log("run.mcap");
        let keep = mixed.manifests()[1].first_ordinal as usize;
        assert!(keep <= stages && keep > 0, "{keep} of {stages} stages are kept");
        let last = mixed.state(keep - 1).unwrap();
        assert!(last.drive.control.rejection.is_none(), "what is kept ends with a complete step");
        let steps = |index: usize| log.entries()[index].record.report.step;
        assert!(steps(keep) > steps(keep - 1) && steps(keep) + 1 >= steps(stages), "no complete step is dropped");
        for (index, entry) in mixed.entries().iter().enumerate() {
            assert_eq!(entry.record.commit.scene_hash, hashes[usize::from(index >= keep)], "stage {index}");
            if index < keep {
                assert_eq!(entry.record, log.entries()[index].record, "stage {index}");
            }
        }
        place.foldline("replay run.mcap --from-scratch").ends(0);
    }
}

/// A run by load control continues by arc length where it stood.
#[test]
fn from_load_control_to_arc_length() {
    let by_load = with(ROOF, &[("[continuation]\ncontrol = \"arc-length\"\nlongest_step = 8.0\n", "")]);
    for until in [0.4, 0.9] {
        let place = Sandbox::new();
        place.write("path.toml", &by_load);
        place.foldline(&format!("run path.toml -o run.mcap --until {until}")).ends(0);
        let before = place.log("run.mcap");
        let last = before.state(before.entries().len() - 1).unwrap();
        place.write("path.toml", ROOF);
        let said = place.foldline("run path.toml -o run.mcap --resume").ends(0);
        said.says(&["continuation", &format!("steps 1 to {} are kept, {} on is new", last.step, last.step + 1)]);
        let after = place.log("run.mcap");
        for (old, new) in before.entries().iter().zip(after.entries()) {
            assert_eq!(old.record, new.record);
        }
        let limits = stages_that(&after, |index| after.entries()[index].record.report.critical_point.is_some());
        assert_eq!(limits.len(), 2, "and passes both limit points");
        let jumped = after.entries().iter().any(|entry| entry.record.report.jumped);
        assert!(!jumped, "without a jump");
        let first = &after.entries()[before.entries().len()].record.report;
        assert!(first.parameter > last.parameter && first.step == last.step + 1);
        place.foldline("replay run.mcap --from-scratch").ends(0);
    }
}

/// A path that may not have more steps stops with all of them kept, says what to do, and that is what to do.
#[test]
fn most_steps() {
    let whole = roof();
    let place = Sandbox::new();
    place.write("path.toml", with(ROOF, &[("longest_step = 8.0", "longest_step = 8.0\nmost_steps = 9")]));
    let said = place.foldline("run path.toml -o run.mcap --quiet").ends(1);
    said.says(&["load factor 1.6", "continuation.most_steps = 9", "raise most_steps", "--resume", "keeps every stage"]);
    let short = place.log("run.mcap");
    assert_eq!(short.entries().last().unwrap().record.report.step, 9);
    for (old, new) in short.entries().iter().zip(whole.log().entries()) {
        assert_eq!(old.record.commit.state_hash, new.record.commit.state_hash);
    }
    place.write("path.toml", with(ROOF, &[("longest_step = 8.0", "longest_step = 8.0\nmost_steps = 100")]));
    place.foldline("run path.toml -o run.mcap --resume --quiet").ends(0);
    let long = place.log("run.mcap");
    assert_eq!(long.entries().len(), whole.stages);
    let last = |log: &Log| log.entries().last().unwrap().record.commit.state_hash;
    assert_eq!(last(&long), last(&whole.log()), "as if there had been no limit");
}
