//! Where finished stages go: the loop calls a [`Sink`] after every stage and knows nothing else of files or screens.

use crate::record::Record;
use crate::state::State;

/// Why a sink could not accept a stage; `context` describes what happened and what to do about it.
#[derive(Debug, thiserror::Error)]
#[error("{context}")]
pub struct SinkError {
    /// What could not be done, with what, in words.
    pub context: String,
    /// The cause below, where there is one.
    #[source]
    pub source: Option<Box<dyn std::error::Error + Send + Sync>>,
}

/// A receiver of every finished stage of a run, in order.
pub trait Sink {
    /// Takes a stage, whose commit names the hash of this very state; when this returns, the stage is as safe as this sink makes
    /// it.
    ///
    /// # Errors
    /// Where the stage could not be kept; the loop stops, and the stages taken before are kept.
    fn take(&mut self, state: &State, record: &Record) -> Result<(), SinkError>;
}

/// A sink that keeps every stage in memory.
#[derive(Debug, Default)]
pub struct MemorySink {
    /// States and records in the order of the run.
    pub stages: Vec<(State, Record)>,
}

impl Sink for MemorySink {
    fn take(&mut self, state: &State, record: &Record) -> Result<(), SinkError> {
        self.stages.push((state.clone(), record.clone()));
        Ok(())
    }
}
