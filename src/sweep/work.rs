//! One task, done: its run in a log of its own, and what is put on record of it.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, PoisonError};

use super::plan::{Head, Task};
use super::quantity::{Finished, Quantity};
use super::record::{Ending, TaskRecord};
use crate::journal::host;
use crate::printable::in_full;
use crate::record::NUMERICS_REVISION;
use crate::scene::Scene;
use crate::study::{Archive, Done, Measured, Purpose, Summary, TaskError, run_name};

/// Does tasks of one sweep.
#[derive(Debug)]
pub struct Work<'w> {
    head: &'w Head,
    scene_text: &'w str,
    archive: &'w Archive,
    /// References that were read, or why they give nothing, by their keys.
    references: Mutex<HashMap<String, Arc<Reference>>>,
}

/// What a task is compared with.
type Reference = Result<Measured, String>;

impl<'w> Work<'w> {
    /// Prepares for tasks of the plan with this head and this scene, with logs in an archive.
    pub fn new(head: &'w Head, scene_text: &'w str, archive: &'w Archive) -> Self {
        Self { head, scene_text, archive, references: Mutex::default() }
    }

    /// What the tasks share.
    pub fn head(&self) -> &Head {
        self.head
    }

    /// The scene of a task.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn scene_of(&self, task: &Task) -> Result<Scene, String> {
        self.head.scene_of(self.scene_text, task)
    }

    /// Does a task to its end, from wherever its log stands, and says what is to be put on record.
    ///
    /// # Errors
    /// Where its run stops; see [`Self::record`].
    pub fn of(&self, task: &Task, interrupted: &dyn Fn() -> bool) -> Result<TaskRecord, TaskError> {
        match self.scene_of(task) {
            Err(why) => Ok(self.ended(task, Ending::Refused, Some(why))),
            // As a kill while another plan was written may leave it.
            Ok(scene) if run_name(&scene) != task.key => Err(TaskError::OtherPlan { key: task.key.clone() }),
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
        let scene = self.scene_of(task).ok();
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
        let reference = if compares { Some(self.reference(task, interrupted)?) } else { None };
        let (errors, reason) = match reference.map(|reference| compared(scene, done, &reference)) {
            None => ([None; 2], None),
            Some(Ok(errors)) => (errors, None),
            Some(Err(why)) => ([None; 2], Some(format!("not compared with its reference: {why}"))),
        };
        let summary = Summary::new(scene, &done.records);
        let run = Finished { scene, records: &done.records, summary: &summary, errors };
        let results = self.head.outputs.iter().map(|output| (output.to_string(), output.of(&run)));
        let results: BTreeMap<String, Option<f64>> = results.collect();
        let last = done.records.last().map(|record| &record.report);
        Ok(TaskRecord {
            results,
            reason,
            reference: task.reference.clone(),
            load_steps: last.map(|report| report.step),
            unknowns: last.map(|report| report.unknowns),
            wall_s: Some(summary.wall_s()),
            log: self.log_of(scene),
            warnings: summary.warnings.iter().map(|warning| warning.first.in_words()).collect(),
            ..self.ended(task, Ending::Done, None)
        })
    }

    /// The run that a task is compared with, done where it is not yet and read once.
    fn reference(&self, task: &Task, interrupted: &dyn Fn() -> bool) -> Result<Arc<Reference>, TaskError> {
        let key = task.reference.clone().unwrap_or_default();
        let known = || self.references.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(reference) = known().get(&key) {
            return Ok(reference.clone());
        }
        let of_reference = Task { is_reference: true, refused: None, ..task.clone() };
        let reference = match self.scene_of(&of_reference) {
            Err(why) => Err(why),
            Ok(scene) => match self.archive.done(&scene, Purpose::Results, interrupted) {
                Err(error) if error.is_of_scene() => Err(in_full(&error)),
                Err(error) => return Err(error),
                Ok(done) => Measured::of(&scene, &done.records, done.wall_s).map_err(|error| in_full(&error)),
            },
        };
        Ok(known().entry(key).or_insert_with(|| Arc::new(reference)).clone())
    }

    fn log_of(&self, scene: &Scene) -> Option<String> {
        let log = self.archive.log_of(scene);
        log.is_file().then(|| log.file_name().map(|name| name.to_string_lossy().into_owned()))?
    }

    fn ended(&self, task: &Task, ending: Ending, reason: Option<String>) -> TaskRecord {
        TaskRecord {
            key: task.key.clone(),
            ending,
            reason,
            results: BTreeMap::new(),
            reference: None,
            load_steps: None,
            unknowns: None,
            wall_s: None,
            log: None,
            program_version: env!("CARGO_PKG_VERSION").to_owned(),
            numerics: NUMERICS_REVISION,
            host: host(),
            warnings: Vec::new(),
            hash: String::new(),
        }
    }
}

/// Errors before the first snap and behind it.
fn compared(scene: &Scene, done: &Done, reference: &Reference) -> Result<[Option<f64>; 2], String> {
    let expected = reference.as_ref().map_err(Clone::clone)?;
    let row = Measured::of(scene, &done.records, done.wall_s).and_then(|found| found.against(expected));
    row.map(|row| [row.error_before, row.error_after]).map_err(|error| in_full(&error))
}
