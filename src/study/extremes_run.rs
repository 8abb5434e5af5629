//! A run of a scene, how it ended, and whether what was kept of it is a run.

use std::error::Error;
use std::time::{Duration, Instant};

use serde::{Serialize, Serializer};

use crate::journal::{Log, StateError};
use crate::pipeline::{RunError, StageError, Stages};
use crate::record::{Commit, Record};
use crate::scene::{ExpectedOutcome, Scene};
use crate::state::State;
use crate::study::archive::{Archive, Purpose, TaskError};
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
    pub stages: Vec<(State, Record)>,
    /// Wall time, seconds.
    pub wall_s: f64,
}

impl Done {
    /// Runs a scene in a log of an archive, or reads the run that is there; after `limit` the run ends at its next stage.
    pub fn of(scene: &Scene, limit: Duration, archive: &Archive) -> Self {
        let begin = Instant::now();
        let start = Stages::new(scene.clone()).start().ok();
        let done = archive.done(scene, Purpose::Results, &|| begin.elapsed() > limit);
        let (end, wall_s) = match done {
            Ok(done) => (ExtremeEnd::Finished, done.wall_s),
            Err(error) => (stop(&error), begin.elapsed().as_secs_f64()),
        };
        let stages = match (&start, Log::read(&archive.log_of(scene))) {
            (Some(_), Ok(log)) => states(&log),
            _ => Ok(Vec::new()),
        };
        match stages {
            Ok(stages) => Self { end, start, stages, wall_s },
            Err(error) => {
                let end = ExtremeEnd::Broken { message: error.to_string() };
                Self { end, start, stages: Vec::new(), wall_s }
            }
        }
    }

    /// The records of the stages that were kept.
    pub fn records(&self) -> impl Iterator<Item = &Record> {
        self.stages.iter().map(|(_, record)| record)
    }

    /// Checks that the stages that were kept are a run: each follows on the one before it, the first on the start of the scene.
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
        None
    }
}

/// Every stage of a log with the state that it made.
fn states(log: &Log) -> Result<Vec<(State, Record)>, StateError> {
    let entries = log.entries().iter().enumerate();
    entries.map(|(index, entry)| Ok((log.state(index)?, entry.record.clone()))).collect()
}

/// How a run that did not reach its target ended.
fn stop(error: &TaskError) -> ExtremeEnd {
    let message = error.source().map_or_else(|| error.to_string(), ToString::to_string);
    let stage = match error {
        TaskError::Model(_) => return ExtremeEnd::Stopped { outcome: ExpectedOutcome::Refused, message },
        TaskError::Interrupted => return ExtremeEnd::OutOfTime,
        TaskError::Panicked { message } => return ExtremeEnd::Panicked { message: message.clone() },
        TaskError::Run { source, .. } => match &**source {
            RunError::Stage(stage) => stage,
            RunError::Sink(_) => return ExtremeEnd::Broken { message },
        },
        _ => return ExtremeEnd::Broken { message },
    };
    let outcome = match stage {
        StageError::NoEquilibrium { .. } => ExpectedOutcome::NoEquilibrium,
        StageError::JumpNotFollowed { .. } => ExpectedOutcome::JumpNotFollowed,
        StageError::NotReEquilibrated { .. } => ExpectedOutcome::NotReEquilibrated,
        StageError::RefinedTooFar { .. } => ExpectedOutcome::RefinedTooFar,
        StageError::PathLost { .. } => ExpectedOutcome::PathLost,
        StageError::PathTooLong { .. } => ExpectedOutcome::PathTooLong,
        _ => return ExtremeEnd::Broken { message },
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
        let folder = tempfile::tempdir().unwrap();
        let archive = Archive::open(folder.path(), 1).unwrap();
        let whole = || Done::of(&scene, Duration::from_secs(60), &archive);
        assert_eq!(whole().lost(), None);
        let mut changed = whole();
        changed.stages[1].0.displacement[20][0] += 1e-15;
        assert_eq!(changed.lost(), Some(ExtremeFault::Lost { ordinal: 1 }));
        let mut gap = whole();
        gap.stages.remove(1);
        assert_eq!(gap.lost(), Some(ExtremeFault::Lost { ordinal: 1 }));
    }
}
