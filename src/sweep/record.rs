//! What is on record of a task that ended, and the row that it makes with the task.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::plan::Task;
use super::quantity::Quantity;
use crate::record::NUMERICS_REVISION;

/// How a task ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// Its run reached the target.
    Done,
    /// Its run stopped before.
    Failed,
    /// Its scene is wrong.
    Refused,
}

/// What is on record of a task that ended: the same wherever and however often it was interrupted, but for its costs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TaskRecord {
    /// The task's key.
    pub key: String,
    /// How it ended.
    pub ending: Ending,
    /// Why it did not reach its target.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// What was collected, by name; `None` where the run has no such thing.
    #[serde(default)]
    pub results: BTreeMap<String, Option<f64>>,
    /// Load steps.
    #[serde(default)]
    pub load_steps: u64,
    /// Free unknowns at the end.
    #[serde(default)]
    pub unknowns: usize,
    /// Wall time of its stages and of keeping them, seconds.
    #[serde(default)]
    pub wall_s: f64,
    /// Name of its log in the folder for logs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub log: Option<String>,
    /// Version of the program that ended it.
    pub program_version: String,
    /// Revision of its numerics.
    pub numerics: u32,
    /// Where it ended.
    pub host: String,
}

impl TaskRecord {
    /// Whether a sweep with these outputs need not do the task again: numbers of other numerics do not count, and what is newly
    /// asked for is read from the log.
    pub fn answers(&self, outputs: &[Quantity]) -> bool {
        let has = |output: &Quantity| self.results.contains_key(&output.to_string());
        self.numerics == NUMERICS_REVISION && (self.ending != Ending::Done || outputs.iter().all(has))
    }
}

/// A row of the table: a task and what is on record of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The task.
    pub task: Task,
    /// What is on record; `None` where it has not ended.
    pub record: Option<TaskRecord>,
}

impl Row {
    /// The word for how far it is.
    pub fn ending(&self) -> &'static str {
        match self.record.as_ref().map(|record| record.ending) {
            None => "to do",
            Some(Ending::Done) => "done",
            Some(Ending::Failed) => "failed",
            Some(Ending::Refused) => "refused",
        }
    }

    /// What was collected under a name.
    pub fn result(&self, name: &str) -> Option<f64> {
        self.record.as_ref()?.results.get(name).copied().flatten()
    }
}
