//! A whole run with nothing logged, and the time that it took.

use std::time::Instant;

use crate::model::ModelError;
use crate::pipeline::{Run, RunError, Stages};
use crate::record::{Record, Sink, SinkError};
use crate::scene::Scene;
use crate::state::State;

/// Keeps what was reported, and no states.
#[derive(Default)]
struct Records(Vec<Record>);

impl Sink for Records {
    fn take(&mut self, _: &State, record: &Record) -> Result<(), SinkError> {
        self.0.push(record.clone());
        Ok(())
    }
}

/// Runs a scene to its end; what it reported, and the wall time in seconds.
///
/// # Errors
/// Where the scene cannot be made discrete, or the run stops before.
pub(super) fn timed_run<E: From<ModelError> + From<Box<RunError>>>(scene: &Scene) -> Result<(Vec<Record>, f64), E> {
    let mut stages = Stages::new(scene.clone());
    let start = stages.start()?;
    let mut records = Records::default();
    let begin = Instant::now();
    Run::new(stages, start, None).to_end(None, &|| false, &mut records).map_err(Box::new)?;
    Ok((records.0, begin.elapsed().as_secs_f64()))
}
