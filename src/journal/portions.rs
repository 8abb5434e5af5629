//! A log read from front to back, however long, of which only a portion is in memory.

use std::fs::File;
use std::path::Path;

use super::checkpoint::Checkpoint;
use super::format::FORMAT_VERSION;
use super::index_keeper::LONG_BYTES;
use super::ledger::Ledger;
use super::log::{Entry, Log, Part};
use super::parts::{PART_BYTES, read_part};
use super::reader::{ReadError, open_regular};

/// A reader that goes through a log in portions, in their order; a short log is one portion. From the first damage on,
/// all of the rest is the last portion, so that later commits are found. What a running program adds meanwhile is not
/// read.
#[derive(Debug)]
pub struct Portions {
    file: File,
    name: String,
    length: u64,
    from: Option<Checkpoint>,
    ledger: Ledger,
}

/// A run of successive stages of a log.
#[derive(Debug)]
pub struct Portion {
    log: Log,
    /// Entries of it: the one behind them is the first of the next portion.
    own: usize,
}

impl Portions {
    /// Opens the log in a file to be read in portions.
    ///
    /// # Errors
    /// Where the file cannot be opened.
    pub fn of(path: &Path) -> Result<Self, ReadError> {
        let name = path.display().to_string();
        let opened = open_regular(path).and_then(|file| file.metadata().map(|metadata| (file, metadata.len())));
        let (file, length) = opened.map_err(|source| ReadError::Io { path: name.clone(), source })?;
        Ok(Self { file, name, length, from: None, ledger: Ledger::default() })
    }

    /// Reads the next portion; after the last one reading starts again at the first.
    ///
    /// # Errors
    /// Where the file cannot be read or is not a log.
    pub fn read(&mut self) -> Result<Portion, ReadError> {
        let at_most = if self.length < LONG_BYTES { &[usize::MAX][..] } else { &[PART_BYTES, usize::MAX] };
        let from = self.from.take();
        if from.is_none() {
            self.ledger = Ledger::default();
        }
        let (log, next) =
            read_part(&self.file, self.length, from.as_ref(), &mut self.ledger, at_most, Log::reaches_end)
                .map_err(|source| ReadError::Io { path: self.name.clone(), source })?;
        if let Some(newer) = log.manifests().iter().find(|manifest| manifest.format_version > FORMAT_VERSION) {
            return Err(ReadError::NewerFormat { found: newer.format_version });
        }
        // No log at all, or one that holds nothing.
        let log = if from.is_none() && log.entries.is_empty() { Log::from_bytes(log.bytes)? } else { log };
        let own = log.entries.len() - usize::from(next.is_some());
        self.from = next;
        Ok(Portion { log, own })
    }
}

impl Portion {
    /// The stages of the portion.
    pub fn entries(&self) -> &[Entry] {
        &self.log.entries[..self.own]
    }

    /// The log as far as it is read: its stages are those of the portion and the one behind them. The completeness of
    /// the last portion is that of the whole log.
    pub fn log(&self) -> &Log {
        &self.log
    }

    /// The log at its end, if this is the last portion.
    pub fn into_end(self) -> Option<Log> {
        (self.own == self.log.entries.len()).then_some(self.log)
    }

    /// The good parts of the portion.
    pub(super) fn parts(&self) -> &[Part] {
        let end = self.log.entries.get(self.own).map(|next| (next.bytes.start - self.log.base) as usize);
        let parts = &self.log.parts;
        &parts[..end.map_or(parts.len(), |end| parts.partition_point(|part| part.at < end))]
    }
}
