//! Running a stage of a log again, from the state before it.

use crate::equilibrium::Iterate;
use crate::history::compare::{Comparison, Difference, compare};
use crate::history::states::{RemakeError, States};
use crate::journal::StateError;
use crate::pipeline::{StageError, Stages};
use crate::record::Report;
use crate::spline::Mesh;
use crate::state::State;

/// Number of bits to which two states must agree to count as the same up to the rounding of another processor or
/// kernel. The solver's default tolerance of 1e-7 leaves some 23 bits.
pub const TOLERATED_BITS: f64 = 20.0;

/// The result of running a stage of a log again.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Replayed {
    /// The state that it made now.
    pub state: State,
    /// The report of the second run.
    pub report: Report,
    /// Beside the state in the log.
    pub comparison: Comparison,
}

/// How a stage that was run again compares with the log.
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
#[non_exhaustive]
pub enum ReplayError {
    /// The state before it, or its own, is not available.
    #[error(transparent)]
    State(#[from] RemakeError),
    /// The stage failed.
    #[error("the stage fails when it is run again")]
    Stage(#[from] StageError),
}

/// Runs stage `index` of a log again with `stages`, whose scene may differ from the log's in settings; `observer` is
/// called with every iterate and its mesh. Only this stage is run with other settings.
///
/// # Errors
/// Where a state is not available or the stage fails.
pub fn replay_stage(
    states: &mut States,
    index: usize,
    stages: &mut Stages,
    observer: &mut dyn FnMut(&Mesh, &Iterate),
) -> Result<Replayed, ReplayError> {
    let before = states.before(index)?;
    let log = states.log();
    let Some(entry) = log.entry(index) else {
        return Err(RemakeError::from(StateError::NoSuchStage { index, len: log.commits() }).into());
    };
    let entry = &entry.record;
    let (state, report) = stages.run(entry.report.stage, &before, &mut |iterate| observer(&before.mesh, iterate))?;
    let comparison = match states.at(index) {
        Ok(logged) => compare(&logged, &state),
        // What was thinned out and comes out otherwise now is known by its hash alone.
        Err(RemakeError::Otherwise { .. } | RemakeError::Stage { .. }) if state.hash() == entry.commit.state_hash => {
            Comparison::Identical
        }
        Err(RemakeError::Otherwise { .. } | RemakeError::Stage { .. }) => Comparison::Structure(
            "it has another hash, and the log, which was thinned, holds no state to compare".into(),
        ),
        Err(error) => return Err(error.into()),
    };
    Ok(Replayed { state, report, comparison })
}

/// Judges a comparison of a replayed state with the log's.
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
