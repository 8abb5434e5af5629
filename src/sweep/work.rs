//! One task, done: its run in a log of its own, and what is put on record of it.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

use super::plan::{Head, Task};
use super::quantity::{Finished, Quantity};
use super::record::{Ending, TaskRecord};
use crate::journal::Manifest;
use crate::record::NUMERICS_REVISION;
use crate::scene::Scene;
use crate::study::{AccuracyError, Archive, Done, Measured, Purpose, Summary, TaskError};

/// Does tasks of one sweep.
#[derive(Debug)]
pub struct Work<'w> {
    /// What the tasks share.
    pub head: &'w Head,
    /// The scene that is varied.
    pub scene_text: &'w str,
    /// Where logs lie.
    pub archive: &'w Archive,
}

impl Work<'_> {
    /// Does a task to its end, from wherever its log stands, and says what is to be put on record.
    ///
    /// # Errors
    /// Where its run stops; see [`Self::record`].
    pub fn of(&self, task: &Task, interrupted: &dyn Fn() -> bool) -> Result<TaskRecord, TaskError> {
        match self.head.scene_of(self.scene_text, task) {
            Err(why) => Ok(self.ended(task, Ending::Refused, Some(why))),
            Ok(scene) => {
                let done = self.archive.done(&scene, Purpose::Results, interrupted)?;
                self.measured(task, &scene, &done, interrupted)
            }
        }
    }

    /// What is to be put on record of a task that ended so: that its scene is wrong or its run stops is on record, too.
    ///
    /// # Errors
    /// What has nothing to do with the task: an interruption, a log that another process writes, a disk that is full.
    pub fn record(&self, task: &Task, ended: Result<TaskRecord, TaskError>) -> Result<TaskRecord, TaskError> {
        let error = match ended {
            Err(error) if error.is_of_scene() => error,
            ended => return ended,
        };
        let ending = if matches!(error, TaskError::Model(_)) { Ending::Refused } else { Ending::Failed };
        let scene = self.head.scene_of(self.scene_text, task).ok();
        let log = scene.and_then(|scene| self.log_of(&scene));
        Ok(TaskRecord { log, ..self.ended(task, ending, Some(in_full(&error))) })
    }

    fn measured(
        &self,
        task: &Task,
        scene: &Scene,
        done: &Done,
        interrupted: &dyn Fn() -> bool,
    ) -> Result<TaskRecord, TaskError> {
        let compares = self.head.outputs.iter().any(Quantity::needs_reference) && !task.is_reference;
        let compared = if compares { self.compared(task, scene, done, interrupted)? } else { Ok([None; 2]) };
        let (errors, reason) = match compared {
            Ok(errors) => (errors, None),
            Err(why) => ([None; 2], Some(why)),
        };
        let summary = Summary::new(scene, &done.records);
        let run = Finished { scene, records: &done.records, summary: &summary, errors };
        let results = self.head.outputs.iter().map(|output| (output.to_string(), output.of(&run)));
        let results: BTreeMap<String, Option<f64>> = results.collect();
        let last = done.records.last().map(|record| &record.report);
        Ok(TaskRecord {
            results,
            reason,
            load_steps: last.map_or(0, |report| report.step),
            unknowns: last.map_or(0, |report| report.unknowns),
            wall_s: done.wall_s,
            log: self.log_of(scene),
            ..self.ended(task, Ending::Done, None)
        })
    }

    /// Errors against the task's reference, or why there are none.
    fn compared(
        &self,
        task: &Task,
        scene: &Scene,
        done: &Done,
        interrupted: &dyn Fn() -> bool,
    ) -> Result<Result<[Option<f64>; 2], String>, TaskError> {
        let of_reference = Task { is_reference: true, refused: None, ..task.clone() };
        let other = match self.head.scene_of(self.scene_text, &of_reference) {
            Ok(other) => other,
            Err(why) => return Ok(Err(format!("its reference is wrong: {why}"))),
        };
        let reference = match self.archive.done(&other, Purpose::Results, interrupted) {
            Err(error) if error.is_of_scene() => return Ok(Err(format!("its reference: {}", in_full(&error)))),
            reference => reference?,
        };
        let errors = || -> Result<[Option<f64>; 2], AccuracyError> {
            let expected = Measured::of(&other, &reference.records, reference.wall_s)?;
            let row = Measured::of(scene, &done.records, done.wall_s)?.against(&expected)?;
            Ok([row.error_before, row.error_after])
        };
        Ok(errors().map_err(|error| in_full(&error)))
    }

    fn log_of(&self, scene: &Scene) -> Option<String> {
        let log = self.archive.log_of(scene);
        log.is_file().then(|| log.file_name().map(|name| name.to_string_lossy().into_owned()))?
    }

    fn ended(&self, task: &Task, ending: Ending, reason: Option<String>) -> TaskRecord {
        let Manifest { program_version, host, .. } = Manifest::here(Path::new("sweep"), "", 1);
        TaskRecord {
            key: task.key.clone(),
            ending,
            reason,
            results: BTreeMap::new(),
            load_steps: 0,
            unknowns: 0,
            wall_s: 0.0,
            log: None,
            program_version,
            numerics: NUMERICS_REVISION,
            host,
        }
    }
}

/// An error with what is below it, in one line.
pub fn in_full(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let below = error.to_string();
        if !text.ends_with(&below) {
            text = format!("{text}: {below}");
        }
        cause = error.source();
    }
    text
}
