//! A run of a scene in memory, how it ended, and whether what was kept of it is the run.

use std::time::{Duration, Instant};

use serde::{Serialize, Serializer};

use crate::pipeline::{Ending, Run, RunError, StageError, Stages};
use crate::record::{Commit, MemorySink, Record};
use crate::scene::{ExpectedOutcome, Scene};
use crate::state::State;
use crate::study::extremes_fault::ExtremeFault;

/// How the run of a scene ended.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ExtremeEnd {
    /// The run reached its target.
    Finished,
    /// The run stopped before its target, in a way that a scene can expect.
    Stopped {
        /// The outcome that a scene can expect.
        outcome: ExpectedOutcome,
        /// The message of the error.
        message: String,
    },
    /// The run stopped before its target, in a way that no scene can expect.
    Broken {
        /// The message of the error.
        message: String,
    },
    /// The time for a scene ran out.
    OutOfTime,
    /// The run panicked.
    Panicked {
        /// The message of the error.
        message: String,
    },
}

impl ExtremeEnd {
    /// Name of the end, in one word.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Finished => ExpectedOutcome::Finished.name(),
            Self::Stopped { outcome, .. } => outcome.name(),
            Self::Broken { .. } => "broken",
            Self::OutOfTime => "out-of-time",
            Self::Panicked { .. } => "panicked",
        }
    }

    /// The message of the error that ended the run, if one did.
    pub fn message(&self) -> Option<&str> {
        match self {
            Self::Finished | Self::OutOfTime => None,
            Self::Stopped { message, .. } | Self::Broken { message } | Self::Panicked { message } => Some(message),
        }
    }

    /// Whether it is what a scene expects.
    pub(super) fn is(&self, expected: ExpectedOutcome) -> bool {
        match self {
            Self::Finished => expected == ExpectedOutcome::Finished,
            Self::Stopped { outcome, .. } => *outcome == expected,
            _ => false,
        }
    }
}

impl Serialize for ExtremeEnd {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// A run that came to an end.
pub(super) struct Done {
    pub end: ExtremeEnd,
    start: Option<State>,
    /// The state that the run was left with.
    last: Option<State>,
    pub stages: Vec<(State, Record)>,
    /// Wall time, seconds.
    pub wall_s: f64,
}

impl Done {
    /// Runs a scene; after `limit` the run ends at its next stage.
    pub fn of(scene: &Scene, limit: Duration) -> Self {
        let begin = Instant::now();
        let mut stages = Stages::new(scene.clone());
        let start = match stages.start() {
            Ok(start) => start,
            Err(error) => {
                let end = ExtremeEnd::Stopped { outcome: ExpectedOutcome::Refused, message: error.to_string() };
                return Self { end, start: None, last: None, stages: vec![], wall_s: begin.elapsed().as_secs_f64() };
            }
        };
        let mut sink = MemorySink::default();
        let mut run = Run::new(stages, start.clone(), None);
        let end = match run.to_end(None, &|| begin.elapsed() > limit, &mut sink) {
            Ok(Ending::Finished | Ending::Until) => ExtremeEnd::Finished,
            Ok(Ending::Interrupted) => ExtremeEnd::OutOfTime,
            Err(error) => stop(&error),
        };
        let (last, wall_s) = (Some(run.state().clone()), begin.elapsed().as_secs_f64());
        Self { end, start: Some(start), last, stages: sink.stages, wall_s }
    }

    /// The records of the stages that were kept.
    pub fn records(&self) -> impl Iterator<Item = &Record> {
        self.stages.iter().map(|(_, record)| record)
    }

    /// Checks that the stages that were kept are the run: each follows on the one before it, and the last one made the
    /// state at the end of the run.
    pub fn lost(&self) -> Option<ExtremeFault> {
        let mut previous: Option<Commit> = None;
        let mut hash = self.start.as_ref()?.hash();
        for (state, record) in &self.stages {
            let commit = record.commit;
            let next = Commit::next(
                previous.as_ref(),
                record.report.stage,
                record.report.step,
                commit.scene_hash,
                hash,
                state.hash(),
            );
            if commit != next {
                return Some(ExtremeFault::Lost { ordinal: next.ordinal });
            }
            (previous, hash) = (Some(commit), commit.state_hash);
        }
        let left = self.last.as_ref().map(State::hash);
        (left != Some(hash)).then_some(ExtremeFault::Lost { ordinal: self.stages.len() as u64 })
    }
}

fn stop(error: &RunError) -> ExtremeEnd {
    let message = error.to_string();
    let outcome = match error {
        RunError::Stage(StageError::NoEquilibrium { .. }) => ExpectedOutcome::NoEquilibrium,
        RunError::Stage(StageError::JumpNotFollowed { .. }) => ExpectedOutcome::JumpNotFollowed,
        RunError::Stage(StageError::NotReEquilibrated { .. }) => ExpectedOutcome::NotReEquilibrated,
        RunError::Stage(StageError::RefinedTooFar { .. }) => ExpectedOutcome::RefinedTooFar,
        RunError::Stage(StageError::PathLost { .. }) => ExpectedOutcome::PathLost,
        RunError::Stage(StageError::PathTooLong { .. }) => ExpectedOutcome::PathTooLong,
        RunError::Stage(_) | RunError::Sink(_) => return ExtremeEnd::Broken { message },
    };
    ExtremeEnd::Stopped { outcome, message }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::parse;

    #[test]
    fn a_stage_that_was_not_kept_as_it_was_made_is_missed() {
        let text = include_str!("../../pipelines/baseline-quarter.toml");
        let mut scene = parse(text, "baseline-quarter.toml").unwrap();
        scene.load.set_target(0.8);
        let whole = || Done::of(&scene, Duration::from_secs(60));
        assert_eq!(whole().lost(), None);
        let mut changed = whole();
        changed.stages[1].0.displacement[20][0] += 1e-15;
        assert_eq!(changed.lost(), Some(ExtremeFault::Lost { ordinal: 1 }));
        let mut short = whole();
        short.stages.pop();
        assert!(short.lost().is_some());
        let mut gap = whole();
        gap.stages.remove(1);
        assert_eq!(gap.lost(), Some(ExtremeFault::Lost { ordinal: 1 }));
    }
}
