//! Stages, the loop that runs them, step control, and the sinks that see every stage.

mod record;
mod sink;

pub use record::{Commit, Outcome, Record, Report};
pub use sink::{MemorySink, Sink, SinkError};
