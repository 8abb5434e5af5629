//! The probes of a scene on the states of a log that was written without them.

use crate::journal::{Log, StateError};
use crate::pipeline::{Outcome, Record, StageError, Stages};

/// Why a probe cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ProbeError {
    /// The state cannot be had.
    #[error(transparent)]
    State(#[from] StateError),
    /// The scene cannot be made discrete on its mesh.
    #[error("the probes cannot be read on the states of the log")]
    Stage(#[from] StageError),
}

/// Reads the probes of the scene of `stages` at every equilibrium of the first stages of a log, and puts the readings
/// into their records, of which there is one for each of these stages. The log itself keeps what it has.
///
/// # Errors
/// Where a state cannot be read.
pub fn read_probes(log: &Log, stages: &mut Stages, records: &mut [Record]) -> Result<(), ProbeError> {
    for (index, Record { report, .. }) in records.iter_mut().enumerate() {
        if report.outcome == Outcome::Done && report.stage.finds_equilibrium() {
            report.probes = stages.read_probes(&log.state(index)?)?;
        }
    }
    Ok(())
}
