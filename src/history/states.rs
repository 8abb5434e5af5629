//! The states of a log, whether it holds them or not: what was thinned out is made again from the last state that was kept,
//! and has to come out with the hash that the log has for it.

use std::sync::Arc;

use crate::energy::TermSource;
use crate::history::logged_scene::{LoggedSceneError, logged_scene};
use crate::journal::{Log, LongLogError, Manifest, StateError};
use crate::model::ModelError;
use crate::pipeline::{StageError, Stages};
use crate::state::{Hash, State};

/// Why the state of a stage cannot be read or made again.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RemakeError {
    /// What the log holds cannot be used.
    #[error(transparent)]
    State(#[from] StateError),
    /// The part of a long log that holds it cannot be read.
    #[error(transparent)]
    Part(#[from] LongLogError),
    /// The scene of a stage that has to run again is lost.
    #[error("the state was thinned out, and cannot be made again")]
    Scene(#[from] LoggedSceneError),
    /// The scene's start cannot be built.
    #[error(transparent)]
    Start(#[from] ModelError),
    /// A stage that ran when the log was written fails now.
    #[error("the state was thinned out; made again from stage {from} on, stage {ordinal} fails{}", because(why))]
    Stage {
        /// Ordinal of the stage.
        ordinal: u64,
        /// Ordinal of the first stage that was run again.
        from: usize,
        /// What computes otherwise here than where the log was written.
        why: Option<String>,
        /// The error of the stage.
        #[source]
        source: Box<StageError>,
    },
    /// A stage comes out otherwise now.
    #[error(
        "the state was thinned out; made again from stage {from} on, stage {ordinal} comes out otherwise{}: only stages behind a kept \
         state can be asked for here",
        because(why)
    )]
    Otherwise {
        /// Ordinal of the stage.
        ordinal: u64,
        /// Ordinal of the first stage that was run again.
        from: usize,
        /// What computes otherwise here than where the log was written.
        why: Option<String>,
    },
}

fn because(why: &Option<String>) -> String {
    why.as_ref().map_or_else(String::new, |why| format!(" ({why})"))
}

/// The states of a log, read, or made again from the last kept one where the log was thinned.
#[derive(Debug)]
pub struct States<'l> {
    log: &'l Log,
    /// Terms of the caller's own that the run was made with.
    own: Vec<Arc<dyn TermSource>>,
    /// Stages of the scene of one stretch: identified by its first ordinal and the hash of the scene.
    stages: Option<((u64, Hash), Stages)>,
    /// The last state that was made again, behind so many stages.
    made: Option<(usize, State)>,
}

impl<'l> States<'l> {
    /// Creates access to the states of a log.
    pub fn of(log: &'l Log) -> Self {
        Self { log, own: Vec::new(), stages: None, made: None }
    }

    /// Runs stages again with these energy terms of the caller's own, which the run had.
    pub fn with_terms(self, own: &[Arc<dyn TermSource>]) -> Self {
        Self { own: own.to_vec(), ..self }
    }

    /// The energy terms of the caller's own that stages are run again with.
    pub fn own_terms(&self) -> &[Arc<dyn TermSource>] {
        &self.own
    }

    /// The log whose states these are.
    pub fn log(&self) -> &'l Log {
        self.log
    }

    /// Returns the state that stage `index` made.
    ///
    /// # Errors
    /// Where there is no such stage, what the log holds cannot be used, or what it does not hold comes out otherwise.
    pub fn at(&mut self, index: usize) -> Result<State, RemakeError> {
        if self.log.keeps_state(index) || self.log.entry(index).is_none() {
            return Ok(self.log.state(index)?);
        }
        self.make(index + 1)
    }

    /// Returns the state that stage `index` started from.
    ///
    /// # Errors
    /// As for [`Self::at`].
    pub fn before(&mut self, index: usize) -> Result<State, RemakeError> {
        match index.checked_sub(1) {
            Some(before) => self.at(before),
            None => Ok(self.stages_of(0)?.start()?),
        }
    }

    /// The state behind the first `count` stages, made again from the last one before it that there is.
    fn make(&mut self, count: usize) -> Result<State, RemakeError> {
        let kept = (0..count).rev().find(|before| self.log.keeps_state(*before)).map_or(0, |kept| kept + 1);
        let made = self.made.take().filter(|(made, _)| (kept.max(1)..=count).contains(made));
        let (from, mut state) = match made {
            Some(made) => made,
            None => (kept, self.before(kept)?),
        };
        for ordinal in from..count {
            let commit = self.log.entries()[ordinal - self.log.first()].record.commit;
            let outcome = self.stages_of(ordinal)?.run(commit.stage, &state, &mut |_| {});
            let why = || {
                let here = Manifest::here(std::path::Path::new(""), "", 0);
                self.log.manifests_of(ordinal).next().and_then(|manifest| here.rounds_otherwise(manifest))
            };
            let ordinal = commit.ordinal;
            state =
                outcome.map_err(|error| RemakeError::Stage { ordinal, from, why: why(), source: Box::new(error) })?.0;
            if state.hash() != commit.state_hash {
                return Err(RemakeError::Otherwise { ordinal, from, why: why() });
            }
        }
        self.made = Some((count, state.clone()));
        Ok(state)
    }

    /// Stages of the scene that stage `index` was run with.
    fn stages_of(&mut self, index: usize) -> Result<&mut Stages, RemakeError> {
        let stretch = self.log.manifests_of(index).next().map_or(0, |manifest| manifest.first_ordinal);
        let scene_hash =
            self.log.entry(index).map_or(Hash::from_bytes([0; 32]), |entry| entry.record.commit.scene_hash);
        let same = self.stages.take().filter(|(of, _)| *of == (stretch, scene_hash));
        let stages = match same {
            Some(same) => same,
            None => {
                let scene = logged_scene(self.log, index, &[], &self.own)?;
                ((stretch, scene_hash), Stages::with_terms(scene, self.own.clone()))
            }
        };
        Ok(&mut self.stages.insert(stages).1)
    }
}
