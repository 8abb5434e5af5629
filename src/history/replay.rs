//! Running a stage of a log again, from the state before it.

use crate::equilibrium::Iterate;
use crate::history::compare::{Comparison, Difference, compare};
use crate::history::resume::{BasisError, basis};
use crate::journal::{Log, StateError};
use crate::pipeline::{Report, StageError, Stages};
use crate::spline::Mesh;
use crate::state::State;

/// States that agree to this many bits are the same within what another processor or another kernel may do to
/// rounding. The solver's default tolerance of 1e-7 leaves some 23 bits.
pub const TOLERATED_BITS: f64 = 20.0;

/// A stage that ran again.
#[derive(Clone, Debug)]
pub struct Replayed {
    /// The state that it made now.
    pub state: State,
    /// What it said now.
    pub report: Report,
    /// Beside the state in the log.
    pub comparison: Comparison,
}

/// What a replay showed.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Every bit is the same.
    BitIdentical,
    /// Numbers differ by no more than rounding can explain; the largest difference.
    WithinTolerance(Difference),
    /// Something else came out, in words.
    Different(String),
}

/// Why a stage could not be run again.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The state before it cannot be had.
    #[error("the state before the stage cannot be had")]
    Before(#[from] BasisError),
    /// The state that the log holds cannot be had.
    #[error("the stage's own state cannot be had")]
    Logged(#[from] StateError),
    /// The log was thinned, and a state between comes out otherwise now.
    #[error(
        "the state before it was thinned out; made again from stage {from} on, stage {ordinal} comes out otherwise: with another revision \
         of the numerics, kernel or scene only stages behind a kept state can be run again"
    )]
    Remade {
        /// Ordinal of the stage that comes out otherwise.
        ordinal: u64,
        /// Ordinal of the first stage that was run again.
        from: usize,
    },
    /// The stage failed.
    #[error("the stage fails when it is run again")]
    Stage(#[from] StageError),
}

/// Runs stage `index` of a log again with `stages`, whose scene may differ from the log's in settings; `observer` is handed every
/// iterate with the mesh that it lies on.
///
/// # Errors
/// Where a state cannot be read or the stage fails.
pub fn replay_stage(
    log: &Log,
    index: usize,
    stages: &mut Stages,
    observer: &mut dyn FnMut(&Mesh, &Iterate),
) -> Result<Replayed, ReplayError> {
    let before = state_before(log, index, stages)?;
    let entry = &log.entries()[index].record;
    let (state, report) = stages.run(entry.report.stage, &before, &mut |iterate| observer(&before.mesh, iterate))?;
    let comparison = match log.keeps_state(index) {
        true => compare(&log.state(index)?, &state),
        false if state.hash() == entry.commit.state_hash => Comparison::Identical,
        false => Comparison::Structure(
            "it has another hash, and the log, which was thinned, holds no state to compare".into(),
        ),
    };
    Ok(Replayed { state, report, comparison })
}

/// The state before stage `index`. Of a log that was thinned it is made again from the last state that is there, and has to
/// come out with the hash that the log has for it.
fn state_before(log: &Log, index: usize, stages: &mut Stages) -> Result<State, ReplayError> {
    let kept = (0..index).rev().find(|before| log.keeps_state(*before));
    let start = kept.map_or(0, |kept| kept + 1);
    let mut state = basis(log, start, stages)?.state;
    for entry in &log.entries()[start..index] {
        let commit = &entry.record.commit;
        state = stages.run(commit.stage, &state, &mut |_| {})?.0;
        if state.hash() != commit.state_hash {
            return Err(ReplayError::Remade { ordinal: commit.ordinal, from: start });
        }
    }
    Ok(state)
}

/// What a comparison means.
pub fn verdict(comparison: &Comparison) -> Verdict {
    match comparison {
        Comparison::Identical => Verdict::BitIdentical,
        Comparison::Structure(what) => Verdict::Different(what.clone()),
        Comparison::Numbers(differences) => match differences.first() {
            Some(worst) if worst.agreeing_bits >= TOLERATED_BITS => Verdict::WithinTolerance(worst.clone()),
            Some(worst) => {
                let [a, b] = worst.values;
                let more = differences.iter().skip(1).take_while(|it| it.agreeing_bits < TOLERATED_BITS);
                let more: String = more.map(|it| format!(", {}: {:.1}", it.field, it.agreeing_bits)).collect();
                Verdict::Different(format!(
                    "{}: {a} in the log, {b} now ({:.1} bits agree{more})",
                    worst.field, worst.agreeing_bits
                ))
            }
            None => Verdict::BitIdentical,
        },
    }
}
