//! From a log to the state that a run continues from, and what a changed scene does to it.

use std::cmp::Ordering;

use crate::journal::{Log, StateError};
use crate::model::ModelError;
use crate::pipeline::{Stages, next_attempt, next_stage};
use crate::record::{Commit, Outcome, Report};
use crate::scene::{Difference, Drive, Reach, Scene, Stage};
use crate::state::State;

/// The key of the rotation at which a run stops.
const TARGETS: [&str; 2] = ["load.rotation_deg", "load.factor"];

/// Targets that differ by less than this, relatively, are one.
const TARGET_ROUNDING: f64 = 1e-12;

/// The state that a run continues from, and the last commit before it.
#[derive(Clone, Debug)]
pub struct Basis {
    /// The state that the run continues from.
    pub state: State,
    /// The commit that made it; `None` for the scene's start.
    pub commit: Option<Commit>,
}

/// Why a log gives no state to continue from.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BasisError {
    /// The log's own state cannot be used.
    #[error(transparent)]
    State(#[from] StateError),
    /// The scene's start cannot be built.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// Reads the state after the first `keep` stages of a log, or makes the start state where `keep` is 0.
///
/// # Errors
/// Where the state cannot be read, or, for `keep` = 0, the scene cannot be made discrete.
pub fn basis(log: &Log, keep: usize, stages: &mut Stages) -> Result<Basis, BasisError> {
    match keep.checked_sub(1) {
        None => Ok(Basis { state: stages.start()?, commit: None }),
        Some(last) => Ok(Basis { state: log.state(last)?, commit: log.entry(last).map(|entry| entry.record.commit) }),
    }
}

/// How much of a log a changed scene can continue from.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ResumePlan {
    /// Stages that are kept, counted from the start of the log.
    pub keep: usize,
    /// What changed and what that means, a line each; empty where the scene is the same.
    pub changes: Vec<String>,
}

/// The changes of a scene for which no stage of a log can be kept.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}: nothing can be kept; write to another log with -o", changes.join("\n  "))]
pub struct NothingKept {
    /// A line for each: key of the scene file, value in the log, and value now.
    pub changes: Vec<String>,
}

/// Decides how many stages of a log written for `old` are kept when it is continued with `new`.
///
/// Output, probes, strengths and names may change freely. The target may: what was cut short at the old target goes, and what lies
/// beyond a nearer one. A change of what steps are made with keeps every complete step and drops a step in hand; one of a history keeps what
/// lies before the load where it sets in. A change of geometry, material, mesh, symmetry or sense keeps nothing.
///
/// # Errors
/// [`NothingKept`] in the last case; [`StateError`] where a state that decides it cannot be read.
pub fn plan(log: &Log, old: &Scene, new: &Scene) -> Result<Result<ResumePlan, NothingKept>, StateError> {
    let differences = old.differences(new);
    let has = |reach: Reach| differences.iter().any(|difference| difference.reach == reach);
    let mut keep = match has(Reach::LaterLoads) {
        true => before_histories_part(log, old, new),
        false => log.commits(),
    };
    let fatal = differences.iter().filter(|difference| match difference.reach {
        Reach::Everything => true,
        Reach::LaterLoads => keep == 0,
        Reach::Free | Reach::Steps | Reach::Names => false,
    });
    let fatal: Vec<String> = fatal.map(|difference| why_nothing_stands(difference, old, new)).collect();
    if !fatal.is_empty() {
        return Ok(Err(NothingKept { changes: fatal }));
    }
    if old.load.target() != new.load.target() {
        keep = keep.min(before_clipped_step(log, old, new)?);
    }
    if has(Reach::Steps) {
        keep = complete_steps(log, keep, old)?;
    }
    if keep > 0 && !log.keeps_state(keep - 1) {
        keep = log.kept_before(keep - 1).map_or(0, |kept| kept + 1);
    }
    let changes = differences.iter().map(|difference| {
        let [from, to] = difference.values();
        format!("{} changed ({from} → {to}): {}", difference.path, what_stands(log, keep, difference))
    });
    Ok(Ok(ResumePlan { keep, changes: changes.collect() }))
}

/// What a change leaves of a log of which the first `keep` stages are kept.
fn what_stands(log: &Log, keep: usize, difference: &Difference) -> String {
    let Difference { path, reach, .. } = difference;
    let changes_stages = match reach {
        Reach::Free => TARGETS.contains(&path.as_str()),
        Reach::Names => false,
        Reach::Steps | Reach::LaterLoads | Reach::Everything => true,
    };
    // What is written beside the states is as it was up to here.
    if path == "output.mesh_history" || path.starts_with("probe") {
        return format!("every stage is kept, and the {keep} in the log keep what they were written with");
    }
    if !changes_stages || (keep == log.commits() && *reach != Reach::Steps) {
        return "every stage is kept".to_owned();
    }
    let kept = log.entries().iter().take(keep.saturating_sub(log.first()));
    let done = kept.map(|entry| &entry.record.report).filter(|it| it.outcome == Outcome::Done);
    match done.map(|report| report.step).max().unwrap_or(0) {
        0 => "no complete step is kept".to_owned(),
        last => {
            let mixed = if *reach == Reach::Steps { ": the log is mixed from there on" } else { "" };
            format!("steps 1 to {last} are kept, {} on is new{mixed}", last + 1)
        }
    }
}

/// A change that no state survives.
fn why_nothing_stands(difference: &Difference, old: &Scene, new: &Scene) -> String {
    let [from, to] = difference.values();
    let why = match (difference.reach, old.same_histories_up_to(new)) {
        (Reach::LaterLoads, _) if Drive::of(old).follows_path() => {
            ": a step by arc length looks beyond the load at which it ends".to_owned()
        }
        (Reach::LaterLoads, at) if at.is_finite() => format!(": the histories part at load factor {at}"),
        (Reach::LaterLoads, _) => ": the histories do not begin with the same points".to_owned(),
        _ => String::new(),
    };
    format!("{} changed ({from} in the log, {to} now){why}", difference.path)
}

/// Number of stages before the first that may have looked at loads where the histories of two scenes differ. At the load where
/// they part they differ by their rates, which only a run along an unstable path asks for.
fn before_histories_part(log: &Log, old: &Scene, new: &Scene) -> usize {
    if Drive::of(old).follows_path() {
        return 0;
    }
    let part_at = old.same_histories_up_to(new);
    let reports: Vec<&Report> = log.entries().iter().map(|entry| &entry.record.report).collect();
    let asks_for_rates = |index: usize| {
        let ends_stable = |report: &&Report| report.outcome == Outcome::Done && report.negative_pivots == 0;
        !reports[index.saturating_sub(1)..=index].iter().all(ends_stable)
    };
    let looks_beyond = |index: &usize| match reports[*index].attempted_parameter.partial_cmp(&part_at) {
        Some(Ordering::Less) => false,
        Some(Ordering::Equal) => asks_for_rates(*index),
        _ => true,
    };
    (0..reports.len()).find(looks_beyond).unwrap_or(log.commits())
}

/// Number of stages before the first solve that the new target would not try: the old one cut it short, or the new one
/// does, or it lies beyond the new one.
fn before_clipped_step(log: &Log, old: &Scene, new: &Scene) -> Result<usize, StateError> {
    let nearer = old.load.target().min(new.load.target());
    for (index, entry) in log.entries().iter().enumerate().skip(1) {
        let report = &entry.record.report;
        if report.stage == Stage::Solve && is_beyond(old, report.attempted_parameter, nearer) {
            // Whether it was cut short is not known of a stage whose start was thinned out.
            if !log.keeps_state(index - 1) {
                return Ok(index);
            }
            let parent = log.state(index - 1)?;
            // A step along the path is as long as its memory gives, but where it ends on the target.
            if parent.drive.path().is_some() || next_attempt(old, &parent) != next_attempt(new, &parent) {
                return Ok(index);
            }
        }
    }
    Ok(log.entries().len())
}

/// Whether a parameter is at a target or beyond.
fn is_beyond(scene: &Scene, parameter: f64, target: f64) -> bool {
    Drive::of(scene).progress(parameter) >= target * (1.0 - TARGET_ROUNDING)
}

/// Number of stages, of the first `keep`, up to the last one that ends a load step.
fn complete_steps(log: &Log, keep: usize, scene: &Scene) -> Result<usize, StateError> {
    for index in (0..keep).rev() {
        if !log.keeps_state(index) {
            continue;
        }
        let state = log.state(index)?;
        let ends_step =
            state.drive.control.rejection.is_none() && matches!(next_stage(scene, &state), None | Some(Stage::Solve));
        if ends_step {
            return Ok(index + 1);
        }
    }
    Ok(0)
}

/// Returns the scene of a log's last stretch where the log has lost it and the scene of `stages`, which with their
/// terms decides the same states, takes its place. Its target is no longer known; the attempted parameters show
/// which steps it may have cut short.
pub fn restored_scene(log: &Log, stages: &Stages) -> Option<Scene> {
    let last = log.last_commit()?;
    let attempts = log.entries().iter().map(|entry| entry.record.report.attempted_parameter);
    let mut restored = stages.scene().clone();
    restored.load.set_target(attempts.fold(f64::MIN, |most, attempt| most.max(attempt.abs())));
    (last.scene_hash == stages.hash()).then_some(restored)
}
