//! Logs of any length, as the commands see them that ask for some stages.

use std::path::{Path, PathBuf};

use super::failure::Failure;
use super::log_file::{end_scene, older_scene, say_warnings, unreadable};
use crate::history::{RemakeError, stages_of_step};
use crate::journal::{AskedLog, LongLog, LongLogError};
use crate::record::{Outcome, Record};
use crate::scene::Scene;

/// A log, with the scene that its last stretch was run with.
pub(super) struct Asked {
    path: PathBuf,
    pub(super) log: AskedLog,
    pub(super) scene: Scene,
    scene_is_older: bool,
}

impl Asked {
    /// Opens a log, and reports what of it is lost.
    pub(super) fn open(path: &Path) -> Result<Self, Failure> {
        let log = AskedLog::open(path).map_err(unreadable(path))?;
        let (scene, scene_is_older) = end_scene(log.end(), path)?;
        say_warnings(log.end(), path);
        Ok(Self { path: path.to_path_buf(), log, scene, scene_is_older })
    }

    /// What is shown as the scene's where that is lost: a line that says so.
    pub(super) fn older_scene(&self) -> Option<String> {
        older_scene(self.log.end(), self.scene_is_older)
    }

    /// The stages of a load step, in their order.
    pub(super) fn stages_of_step(&self, step: u64) -> Result<Vec<Record>, Failure> {
        let found = match &self.log {
            AskedLog::Long(long) => {
                stages_of_step(long, step).or_else(|error| match LongLog::read_through(&self.path)? {
                    // The index did not fit.
                    Some(long) if long.commits() == self.log.commits() => stages_of_step(&long, step),
                    // The log is damaged.
                    _ => Err(error),
                })
            }
            AskedLog::Whole(log) => {
                let records = log.entries().iter().map(|entry| &entry.record);
                Ok(records.filter(|record| record.report.step == step).cloned().collect())
            }
        };
        let found = found.map_err(self.changed())?;
        if found.is_empty() {
            return Err(Failure::NoSuchStep { log: self.path.clone(), step, known: self.steps() });
        }
        Ok(found)
    }

    /// The last equilibrium of each load step.
    pub(super) fn ends(&self) -> Result<Ends, Failure> {
        let every: Vec<usize> = (0..self.log.commits()).collect();
        let mut ends = Ends::default();
        for part in self.log.parts(&every) {
            let (log, indices) = part.map_err(self.changed())?;
            indices.iter().filter_map(|index| log.entry(*index)).for_each(|entry| ends.take(&entry.record));
        }
        Ok(ends)
    }

    /// All stages.
    pub(super) fn records(&self) -> Result<Vec<Record>, Failure> {
        let every: Vec<usize> = (0..self.log.commits()).collect();
        let mut records = Vec::with_capacity(every.len());
        for part in self.log.parts(&every) {
            let (log, indices) = part.map_err(self.changed())?;
            records.extend(indices.iter().filter_map(|index| log.entry(*index)).map(|entry| entry.record.clone()));
        }
        Ok(records)
    }

    /// First and last load step.
    pub(super) fn steps(&self) -> Option<(u64, u64)> {
        let step_of = |ordinal: usize| self.log.record(ordinal).ok().map(|record| record.report.step);
        step_of(0).zip(step_of(self.log.commits().checked_sub(1)?))
    }

    /// The error for a state that can be neither read nor made again.
    pub(super) fn unusable(&self, source: RemakeError) -> Failure {
        Failure::WrongLog { log: self.path.clone(), source: Box::new(source) }
    }

    /// The error for a log that changed while it was read.
    pub(super) fn changed(&self) -> impl Fn(LongLogError) -> Failure {
        |source| Failure::WrongLog { log: self.path.clone(), source: Box::new(source) }
    }
}

/// The last equilibrium of each load step.
#[derive(Default)]
pub(super) struct Ends {
    pub(super) records: Vec<Record>,
}

impl Ends {
    /// Takes the stage that follows.
    pub(super) fn take(&mut self, record: &Record) {
        let Record { report, .. } = record;
        if report.outcome != Outcome::Done || !report.stage.finds_equilibrium() {
            return;
        }
        self.records.pop_if(|last| last.report.step == report.step);
        self.records.push(record.clone());
    }

    /// Ordinals of their stages.
    pub(super) fn stages(&self) -> Vec<usize> {
        self.records.iter().map(ordinal).collect()
    }
}

/// Ordinal of a stage in its log.
pub(super) fn ordinal(record: &Record) -> usize {
    record.commit.ordinal as usize
}
