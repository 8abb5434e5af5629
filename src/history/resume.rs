//! From a log to the state that a run goes on from, and what a changed scene does to it.

use crate::journal::{Log, StateError};
use crate::model::ModelError;
use crate::pipeline::{Commit, Outcome, Stages, next_attempt, next_stage};
use crate::scene::{Difference, Drive, Reach, Scene, Stage};
use crate::state::State;

/// The key of the rotation at which a run stops.
const TARGETS: [&str; 2] = ["load.rotation_deg", "load.factor"];

/// Keys of what a log holds beside its states.
const STARTS_HERE: [&str; 2] = ["probes", "output.mesh_history"];

/// Targets that differ by less than this, relatively, are one.
const TARGET_ROUNDING: f64 = 1e-12;

/// What a run goes on from.
#[derive(Clone, Debug)]
pub struct Basis {
    /// The state.
    pub state: State,
    /// The commit that made it; `None` for the scene's start.
    pub commit: Option<Commit>,
}

/// Why there is nothing to go on from.
#[derive(Debug, thiserror::Error)]
pub enum BasisError {
    /// The log's own state cannot be used.
    #[error(transparent)]
    State(#[from] StateError),
    /// The scene's start cannot be built.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// The state after the first `keep` stages of a log.
///
/// # Errors
/// Where the state cannot be read, or, for `keep` = 0, the scene cannot be made discrete.
pub fn basis(log: &Log, keep: usize, stages: &mut Stages) -> Result<Basis, BasisError> {
    match keep.checked_sub(1) {
        None => Ok(Basis { state: stages.start()?, commit: None }),
        Some(last) => Ok(Basis { state: log.state(last)?, commit: log.entry(last).map(|entry| entry.record.commit) }),
    }
}

/// How much of a log a scene can go on from.
#[derive(Clone, Debug, PartialEq)]
pub struct ResumePlan {
    /// Stages that stand, counted from the start of the log.
    pub keep: usize,
    /// What changed and what that means, a line each; empty where the scene is the same.
    pub changes: Vec<String>,
}

/// Changes of the scene that no state of the log survives.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}: nothing can be kept; write to another log with -o", changes.join("\n  "))]
pub struct NothingStands {
    /// A line for each: key of the scene file, value in the log, and value now.
    pub changes: Vec<String>,
}

/// What stands of a log written for `old` when it goes on with `new`.
///
/// Output may change freely. The target may: what was cut short at the old target goes, and what lies beyond a nearer
/// one. A change of what steps are made with keeps every complete step and drops a step in hand. A change of geometry,
/// material, mesh, symmetry or sense keeps nothing.
///
/// # Errors
/// [`NothingStands`] in the last case; [`StateError`] where a state that decides it cannot be read.
pub fn plan(log: &Log, old: &Scene, new: &Scene) -> Result<Result<ResumePlan, NothingStands>, StateError> {
    let differences = old.differences(new);
    let shown = |difference: &Difference| {
        let [from, to] = difference.values();
        format!("{} changed ({from} → {to})", difference.path)
    };
    let fatal = differences.iter().filter(|difference| difference.reach == Reach::Everything).map(|difference| {
        let [from, to] = difference.values();
        format!("{} changed ({from} in the log, {to} now)", difference.path)
    });
    let fatal: Vec<String> = fatal.collect();
    if !fatal.is_empty() {
        return Ok(Err(NothingStands { changes: fatal }));
    }
    let mut keep = log.commits();
    let mut changes = Vec::new();
    if old.load.target() != new.load.target() {
        keep = keep.min(before_clipped_step(log, old, new)?);
    }
    let steps: Vec<&Difference> = differences.iter().filter(|difference| difference.reach == Reach::Steps).collect();
    if !steps.is_empty() {
        keep = complete_steps(log, keep, old)?;
    }
    while keep > 0 && !log.keeps_state(keep - 1) {
        keep -= 1;
    }
    let kept = log.entries().iter().take(keep.saturating_sub(log.first()));
    let done = kept.map(|entry| &entry.record.report).filter(|it| it.outcome == Outcome::Done);
    let last_step = done.map(|report| report.step).max().unwrap_or(0);
    for difference in &differences {
        let what = shown(difference);
        changes.push(match difference.reach {
            // What is written beside the states is as it was up to here.
            Reach::Free if STARTS_HERE.contains(&difference.path.as_str()) => {
                format!("{what}: every stage stands, and the {keep} in the log keep what they were written with")
            }
            Reach::Free if keep == log.commits() || !TARGETS.contains(&difference.path.as_str()) => {
                format!("{what}: every stage stands")
            }
            _ if last_step == 0 => format!("{what}: no complete step stands"),
            Reach::Steps => {
                let next = last_step + 1;
                format!("{what}: steps 1 to {last_step} stand, {next} on is new: the log is mixed from there on")
            }
            _ => format!("{what}: steps 1 to {last_step} stand, {} on is new", last_step + 1),
        });
    }
    Ok(Ok(ResumePlan { keep, changes }))
}

/// Number of stages before the first solve that the new target would not try: the old one cut it short, or the new one
/// does, or it lies beyond the new one.
fn before_clipped_step(log: &Log, old: &Scene, new: &Scene) -> Result<usize, StateError> {
    let nearer = old.load.target().min(new.load.target());
    for (index, entry) in log.entries().iter().enumerate().skip(1) {
        let report = &entry.record.report;
        if report.stage == Stage::Solve && is_beyond(old, report.attempted_parameter, nearer) {
            // Whether it was cut short cannot be told of a stage whose start was thinned out.
            if !log.keeps_state(index - 1) {
                return Ok(index);
            }
            let parent = log.state(index - 1)?;
            // A step along the path is as long as its memory says, but where it ends on the target.
            if parent.drive.path().is_some() || next_attempt(old, &parent) != next_attempt(new, &parent) {
                return Ok(index);
            }
        }
    }
    Ok(log.entries().len())
}

/// Whether a parameter is at a target or beyond.
fn is_beyond(scene: &Scene, parameter: f64, target: f64) -> bool {
    Drive::of(scene).way_of(parameter) >= target * (1.0 - TARGET_ROUNDING)
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

/// The scene of a log's last stretch where the log has lost it and the scene of `stages`, which with their terms decides the
/// same states, takes its place. Its target is not known any more; what was attempted says which steps it may have cut short.
pub fn restored_scene(log: &Log, stages: &Stages) -> Option<Scene> {
    let last = log.last_commit()?;
    let attempts = log.entries().iter().map(|entry| entry.record.report.attempted_parameter);
    let mut restored = stages.scene().clone();
    restored.load.set_target(attempts.fold(f64::MIN, |most, attempt| most.max(attempt.abs())));
    (last.scene_hash == stages.hash()).then_some(restored)
}
