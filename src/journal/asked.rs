//! A log of any length of which some stages are needed: of a long one only those are read.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use super::log::Log;
use super::long::{LongLog, LongLogError};
use super::reader::ReadError;
use crate::record::Record;

/// Stages of a long log that are read together where all of them are needed.
const STAGES_AT_ONCE: usize = 512;

/// A log of any length, of which single stages are read.
#[derive(Debug)]
pub enum AskedLog {
    /// One that was read whole: it is short, or damaged before its end.
    Whole(Arc<Log>),
    /// One of which only the end was read, and where the rest lies.
    Long(Box<LongLog>),
}

impl AskedLog {
    /// Opens a log: a long one by its index, any other by reading all of it.
    ///
    /// # Errors
    /// Where it cannot be read or is not a log.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let long = LongLog::open(path).map_err(|source| ReadError::Io { path: path.display().to_string(), source })?;
        match long {
            Some(long) => Ok(Self::Long(Box::new(long))),
            None => Ok(Self::Whole(Arc::new(Log::read(path)?))),
        }
    }

    /// The end of the log, as far as it was read. It has all manifests, and its completeness is that of the whole log.
    pub fn end(&self) -> &Log {
        match self {
            Self::Whole(log) => log,
            Self::Long(long) => long.tail(),
        }
    }

    /// Number of stages of the run.
    pub fn commits(&self) -> usize {
        self.end().commits()
    }

    /// Reads the record of stage `ordinal`.
    ///
    /// # Errors
    /// Where there is no such stage, or it is not what it was.
    pub fn record(&self, ordinal: usize) -> Result<Record, LongLogError> {
        match (self, self.end().entry(ordinal)) {
            (_, Some(entry)) => Ok(entry.record.clone()),
            (Self::Long(long), None) => long.record(ordinal),
            (Self::Whole(_), None) => Err(LongLogError::NoSuchStage { ordinal, commits: self.commits() }),
        }
    }

    /// Reads the part of the log with these stages and the one before them, so that they can be run again.
    ///
    /// # Errors
    /// Where there are no such stages, or they have changed.
    pub fn part(&self, stages: Range<usize>) -> Result<Arc<Log>, LongLogError> {
        match self {
            Self::Whole(log) => Ok(log.clone()),
            Self::Long(long) => long.part(stages).map(Arc::new),
        }
    }

    /// Reads the parts of the log with these stages, which must ascend; each part comes with those of the stages that
    /// it holds.
    pub fn parts<'s>(
        &'s self,
        stages: &'s [usize],
    ) -> impl Iterator<Item = Result<(Arc<Log>, &'s [usize]), LongLogError>> + 's {
        let at_once = match self {
            Self::Whole(_) => usize::MAX,
            Self::Long(_) => STAGES_AT_ONCE,
        };
        stages.chunk_by(move |a, b| a / at_once == b / at_once).map(|group| {
            let (first, last) = (group.first().copied().unwrap_or(0), group.last().copied().unwrap_or(0));
            Ok((self.part(first..last + 1)?, group))
        })
    }
}
