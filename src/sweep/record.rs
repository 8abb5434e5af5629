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
    /// Why it did not reach its target, or has no error against its reference.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Key of the reference that it was compared with.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<String>,
    /// What was collected, by name; `None` where the run has no such thing.
    #[serde(default)]
    pub results: BTreeMap<String, Option<f64>>,
    /// Load steps of a finished run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load_steps: Option<u64>,
    /// Free unknowns at its end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unknowns: Option<usize>,
    /// Wall time of its stages and of keeping them, seconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wall_s: Option<f64>,
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
    /// Whether a sweep with these outputs need not do the task again. Numbers of other numerics do not count, nor what another version of
    /// the program refused, nor errors against another reference; what is newly asked for is read from the log.
    pub fn answers(&self, task: &Task, outputs: &[Quantity]) -> bool {
        let has = |output: &Quantity| self.results.contains_key(&output.to_string());
        let is_compared =
            task.is_reference || self.reference == task.reference || !outputs.iter().any(Quantity::needs_reference);
        self.numerics == NUMERICS_REVISION
            && match self.ending {
                Ending::Done => is_compared && outputs.iter().all(has),
                Ending::Failed => true,
                Ending::Refused => self.program_version == env!("CARGO_PKG_VERSION"),
            }
    }

    /// Whether the task may come to more where it is done again.
    pub fn is_short(&self) -> bool {
        self.ending == Ending::Failed || self.reason.is_some() && self.ending == Ending::Done
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
