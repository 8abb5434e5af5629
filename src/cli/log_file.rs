//! Logs, as the commands that read them see them.

use std::path::Path;

use super::failure::Failure;
use super::output::say;
use super::scene_file::checked;
use crate::journal::{Completeness, Log};
use crate::pipeline::Record;
use crate::scene::Scene;

/// A log as far as it can be trusted, with the scene that its last stretch was run with.
pub(super) struct ReadLog {
    pub(super) log: Log,
    pub(super) scene: Scene,
}

impl ReadLog {
    /// Every stage whose hashes hold.
    pub(super) fn records(&self) -> Vec<Record> {
        self.log.entries().iter().map(|entry| entry.record.clone()).collect()
    }

    /// Whether the run came to its end.
    pub(super) fn is_finished(&self) -> bool {
        self.log.completeness() == Completeness::Finished
    }

    /// First and last load step.
    pub(super) fn steps(&self) -> Option<(u64, u64)> {
        let steps = || self.log.entries().iter().map(|entry| entry.record.report.step);
        steps().min().zip(steps().max())
    }

    /// What was lost of a log, a line each.
    pub(super) fn warnings_of(log: &Log) -> Vec<String> {
        match log.completeness() {
            Completeness::Finished | Completeness::Unfinished => Vec::new(),
            Completeness::Truncated { at, dropped } => {
                vec![format!(
                    "cut off: good up to byte {at}; {dropped} bytes beyond are part of a stage and are not used"
                )]
            }
            Completeness::Damaged { at, dropped, later_commits } => vec![format!(
                "damaged at byte {at}: {dropped} bytes beyond, with {later_commits} stages that have lost what they follow \
                 on, are not used; `foldline verify` tells more"
            )],
        }
    }
}

/// Reads a log and the scene in it; says what of it is lost.
pub(super) fn read_log(path: &Path) -> Result<ReadLog, Failure> {
    let wrong =
        |source: Box<dyn std::error::Error + Send + Sync>| Failure::WrongLog { log: path.to_path_buf(), source };
    let log = Log::read(path).map_err(|source| wrong(Box::new(source)))?;
    let scene = scene_of(&log, path, &[])?;
    for warning in ReadLog::warnings_of(&log) {
        say(&format!("foldline: {}: {warning}", path.display()));
    }
    Ok(ReadLog { log, scene })
}

/// The scene of a log's last stretch, with settings laid over it.
pub(super) fn scene_of(log: &Log, path: &Path, settings: &[String]) -> Result<Scene, Failure> {
    scene_at(log, path, u64::MAX, settings)
}

/// The scene that a stage of a log was run with: a run may have gone on with a changed one.
pub(super) fn scene_at(log: &Log, path: &Path, ordinal: u64, settings: &[String]) -> Result<Scene, Failure> {
    let manifest = log.manifest_at(ordinal).ok_or_else(|| Failure::NoScene { log: path.to_path_buf() })?;
    checked(&manifest.scene_text, &format!("scene in {}", path.display()), settings)
}
