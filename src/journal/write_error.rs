//! Why a stage could not be kept.

use std::io;

use super::encode_error::EncodeError;
use super::lock::LockError;
use super::still_ours::LogChanged;
use crate::printable::word;
use crate::record::SinkError;
use crate::state::Hash;
use crate::whole_file::shortage;

/// Why a stage could not be written to a log, or a log could not be started.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// There is a file of that name.
    #[error(
        "{log} exists and is not overwritten: `foldline resume {}` continues it, `-o OTHER` writes elsewhere",
        word(log)
    )]
    Exists {
        /// The log.
        log: String,
    },
    /// There is something of that name that is no log.
    #[error("{log} exists and is no log; it is not overwritten: write elsewhere with `-o OTHER`")]
    InTheWay {
        /// Where the log was to go.
        log: String,
    },
    /// The folder that the log should lie in is not there.
    #[error("there is no folder {folder} for {log}: make it, or choose another place with `-o OTHER`")]
    NoFolder {
        /// The folder.
        folder: String,
        /// The log.
        log: String,
    },
    /// The right to write is another's.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// The disk is full before anything is written.
    #[error("no space left to begin {log}{}, and it is not there. Make space, then start the run again", shortage(*.wanted, *.room))]
    NoRoom {
        /// The log.
        log: String,
        /// Bytes that it begins with.
        wanted: u64,
        /// Bytes that the disk has room for, where that is known.
        room: Option<u64>,
        /// The error of the operating system.
        #[source]
        source: io::Error,
    },
    /// The system would not even let it begin.
    #[error("cannot begin {log}, and it is not there: nothing was run. Once that is mended, start the run again")]
    NotBegun {
        /// The log.
        log: String,
        /// The error of the operating system.
        #[source]
        source: io::Error,
    },
    /// The log is no longer the file that was written, or not as it was left.
    #[error("{log} {estranged}. This run stops, and adds nothing to it")]
    LogChanged {
        /// The log.
        log: String,
        /// What happened to it.
        estranged: LogChanged,
    },
    /// The disk is full.
    #[error(
        "no space left to {action} {log}{}; it holds {commits} stages, all good. Make space, then `foldline resume {}`",
        shortage(*.wanted, *.room), word(log)
    )]
    DiskFull {
        /// "write" or "sync".
        action: &'static str,
        /// The log.
        log: String,
        /// Stages that are in the log.
        commits: u64,
        /// Bytes that were to be added.
        wanted: u64,
        /// Bytes that the disk has room for, where that is known.
        room: Option<u64>,
        /// The error of the operating system.
        #[source]
        source: io::Error,
    },
    /// The operating system refused.
    #[error(
        "cannot {action} {log}; it holds {commits} stages. `foldline resume {}` continues after the last good one",
        word(log)
    )]
    Io {
        /// "write", "sync" or "start".
        action: &'static str,
        /// The log.
        log: String,
        /// Stages that are in the log.
        commits: u64,
        /// The error of the operating system.
        #[source]
        source: io::Error,
    },
    /// The stage cannot be put into a log.
    #[error("stage {ordinal} cannot be written to {log}, which holds all before it")]
    Encode {
        /// Ordinal of the stage.
        ordinal: u64,
        /// The log.
        log: String,
        /// The error of the encoder.
        #[source]
        source: EncodeError,
    },
    /// A stage that does not follow from the last one in the log.
    #[error("commit {found} does not follow on the {commits} that {log} holds: it was not made from its last state")]
    NotNext {
        /// Ordinal of the stage.
        found: u64,
        /// Stages that are in the log.
        commits: u64,
        /// The log.
        log: String,
    },
    /// A state that is not the one its commit names.
    #[error("the state of commit {ordinal} hashes to {found}, and the commit has {expected}")]
    StateHash {
        /// Ordinal of the stage.
        ordinal: u64,
        /// Hash in the commit.
        expected: Hash,
        /// Hash of the state.
        found: Hash,
    },
    /// A stage after one that failed.
    #[error(
        "{log} was given up after an earlier error; `foldline resume {}` continues after its {commits} stages",
        word(log)
    )]
    GivenUp {
        /// The log.
        log: String,
        /// Stages that are in the log.
        commits: u64,
    },
}

impl From<WriteError> for SinkError {
    fn from(error: WriteError) -> Self {
        let context = error.to_string();
        // The error itself is the context; what is below it is the cause.
        let source: Option<Box<dyn std::error::Error + Send + Sync>> = match error {
            WriteError::DiskFull { source, .. }
            | WriteError::NoRoom { source, .. }
            | WriteError::NotBegun { source, .. }
            | WriteError::Io { source, .. }
            | WriteError::LogChanged { estranged: LogChanged::Unknown { source }, .. }
            | WriteError::Lock(LockError::Io { source, .. } | LockError::Unreadable { source, .. }) => {
                Some(Box::new(source))
            }
            WriteError::Encode { source, .. } => Some(Box::new(source)),
            _ => None,
        };
        SinkError { context, source }
    }
}
