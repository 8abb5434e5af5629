//! What can be wrong with a sweep, in words.

use std::io;
use std::path::PathBuf;

/// Why a sweep cannot be planned, run or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// The file is no sweep.
    #[error("{file} is no sweep: {}", why.to_string().trim_end())]
    Syntax {
        /// The sweep.
        file: String,
        /// Where and why.
        why: Box<toml::de::Error>,
    },
    /// What is asked for cannot be.
    #[error("{file}: {problem}")]
    Wrong {
        /// The sweep.
        file: String,
        /// What is wrong, and what to write.
        problem: String,
    },
    /// Not one of the scenes can be run.
    #[error("{file}: not one of its {tasks} scenes can be run; the first is wrong:\n{reason}")]
    AllRefused {
        /// The sweep.
        file: String,
        /// Number of tasks.
        tasks: usize,
        /// What is wrong with the first.
        reason: String,
    },
    /// A file of the sweep's folder cannot be read.
    #[error("cannot read {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file of the sweep's folder is not what it should be.
    #[error("{} is no {what} of a sweep: {problem}; `foldline sweep run SWEEP.toml` plans again, and keeps what is done", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What it should be.
        what: &'static str,
        /// What is wrong.
        problem: String,
    },
    /// A file of the sweep's folder cannot be written.
    #[error("cannot write {}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The folder holds something else.
    #[error("{} has a `{name}` and holds no sweep: nothing there is written over; choose another folder with --folder", folder.display())]
    InTheWay {
        /// The folder.
        folder: PathBuf,
        /// What is there.
        name: &'static str,
    },
    /// The folder holds another sweep.
    #[error("{} holds the sweep `{title}` of {file}: choose another folder with --folder", folder.display())]
    OtherSweep {
        /// The folder.
        folder: PathBuf,
        /// Title of the sweep that is there.
        title: String,
        /// Its file.
        file: String,
    },
    /// There is no such task.
    #[error("{} has tasks 1 to {count}, and no {number}", folder.display())]
    NoSuchTask {
        /// The folder.
        folder: PathBuf,
        /// Number of tasks.
        count: usize,
        /// What was asked for.
        number: usize,
    },
}
