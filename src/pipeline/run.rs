//! The loop: stage after stage until the target, with every finished stage handed to a sink.

use std::time::Instant;

use crate::digest::Hash;
use crate::pipeline::step_control::{has_reached, next_stage};
use crate::pipeline::{StageError, Stages};
use crate::record::{Commit, Record, Sink, SinkError};
use crate::scene::Stage;
use crate::state::{MeshHash, State};

/// Reasons why a run stopped before its target. All stages that the sink took remain valid.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// A stage failed.
    #[error(transparent)]
    Stage(#[from] StageError),
    /// A stage was run but could not be kept.
    #[error(transparent)]
    Sink(#[from] SinkError),
}

/// The reason why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Ending {
    /// The scene's target is reached.
    Finished,
    /// The value of the parameter that the caller asked for is reached.
    Until,
    /// The caller asked to stop; the current stage was finished.
    Interrupted,
}

/// A run: the loop over stages, paused between two of them.
#[derive(Debug)]
pub struct Run {
    stages: Stages,
    state: State,
    state_hash: Hash,
    scene_hash: Hash,
    mesh_hash: MeshHash,
    last: Option<Commit>,
    /// Wall time that it took the sink to keep the last stage, seconds.
    kept_s: f64,
}

impl Run {
    /// Creates a run that continues from `state`, which the stage of `last` made (`None`: the scene's start).
    pub fn new(stages: Stages, state: State, last: Option<Commit>) -> Self {
        let scene_hash = stages.hash();
        let mut mesh_hash = MeshHash::default();
        let state_hash = state.hash_on(mesh_hash.of(&state.mesh));
        Self { state_hash, mesh_hash, scene_hash, stages, state, last, kept_s: 0.0 }
    }

    /// Current state of the run.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Stage that comes next; `None` at the target.
    pub fn next_stage(&self) -> Option<Stage> {
        next_stage(self.stages.scene(), &self.state)
    }

    /// Runs the next stage and hands it to the sink; `None` at the target.
    ///
    /// # Errors
    /// Where the stage fails or the sink cannot keep it; the run is then where it was before.
    pub fn advance(&mut self, sink: &mut dyn Sink) -> Result<Option<Record>, RunError> {
        let Some(stage) = self.next_stage() else { return Ok(None) };
        let begin = Instant::now();
        let (state, report) = self.stages.run(stage, &self.state, &mut |_| {})?;
        let wall_s = begin.elapsed().as_secs_f64();
        let state_hash = state.hash_on(self.mesh_hash.of(&state.mesh));
        let commit = Commit::next(self.last.as_ref(), stage, report.step, self.scene_hash, self.state_hash, state_hash);
        let record = Record { report, commit, wall_s, kept_s: std::mem::take(&mut self.kept_s) };
        let begin = Instant::now();
        sink.take(&state, &record)?;
        self.kept_s = begin.elapsed().as_secs_f64();
        (self.state, self.state_hash, self.last) = (state, state_hash, Some(commit));
        Ok(Some(record))
    }

    /// Runs to the scene's target, to `until` (the first completed step at or beyond it), or until `interrupted`.
    ///
    /// # Errors
    /// As for [`Self::advance`].
    pub fn to_end(
        &mut self,
        until: Option<f64>,
        interrupted: &dyn Fn() -> bool,
        sink: &mut dyn Sink,
    ) -> Result<Ending, RunError> {
        loop {
            let next = self.next_stage();
            let Some(stage) = next else { return Ok(Ending::Finished) };
            if stage == Stage::Solve && until.is_some_and(|until| has_reached(self.stages.scene(), &self.state, until))
            {
                return Ok(Ending::Until);
            }
            if interrupted() {
                return Ok(Ending::Interrupted);
            }
            self.advance(sink)?;
        }
    }
}
