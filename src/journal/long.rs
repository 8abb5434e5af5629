//! A long log, of which only the end is read: its index gives the place of the rest.

use std::fs::File;
use std::io;
use std::ops::Range;
use std::path::Path;

use super::backend::beside;
use super::chunk::{self, Content};
use super::index::{Builder, Head, Index, Mark, Piece, record_at};
use super::index_keeper::{LONG_BYTES, Rewritten};
use super::ledger::{ChunkPlace, Ledger};
use super::log::{Entry, Log};
use super::message::HexHash;
use super::parts::read_in_parts;
use super::reader::open_regular;
use crate::record::Record;

/// Why stages of a long log cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LongLogError {
    /// The log or its index cannot be read.
    #[error("the log or its index cannot be read")]
    Io(#[from] io::Error),
    /// The run has no such stage.
    #[error("there is no stage {ordinal} in this log: it holds {commits}, counted from 0")]
    NoSuchStage {
        /// The number that was requested.
        ordinal: usize,
        /// Number of stages of the run.
        commits: usize,
    },
    /// A commit that is not what the index lists: damaged, or of another log.
    #[error(
        "commit {ordinal} at byte {at} is not what it was when the index was written: `foldline verify` reports more"
    )]
    Changed {
        /// Ordinal of the commit.
        ordinal: u64,
        /// First byte of its chunk.
        at: u64,
    },
}

/// A long log that was opened by its index; only its end is held in memory.
#[derive(Debug)]
pub struct LongLog {
    file: File,
    pub(super) index: Option<Index>,
    pub(super) tail: Log,
    /// All chunks before the last commit that was read.
    pub(super) ledger: Ledger,
    /// Behind the blocks of the index.
    pub(super) builder: Builder,
}

impl LongLog {
    /// Opens a log that is long enough to have an index; `None` for a shorter one, and for one that is damaged before
    /// its end, which has to be read whole. Where the index is missing or does not fit, the log is read through, part
    /// by part.
    ///
    /// # Errors
    /// Where the log cannot be read.
    pub fn open(path: &Path) -> io::Result<Option<Self>> {
        let file = open_regular(path)?;
        let index_path = beside(path, ".index");
        let index = Index::read(&index_path);
        if index.is_none() && file.metadata()?.len() < LONG_BYTES {
            return Ok(None);
        }
        if let Some(index) = index
            && let Ok(Some(opened)) = Self::read(path, &index_path, Some(index))
        {
            return Ok(Some(opened));
        }
        Self::read_through(path)
    }

    /// Opens a log whose index does not fit by reading all of it part by part, and writes a new index.
    ///
    /// # Errors
    /// Where the log cannot be read.
    pub fn read_through(path: &Path) -> io::Result<Option<Self>> {
        Self::read(path, &beside(path, ".index"), None)
    }

    fn read(path: &Path, index_path: &Path, index: Option<Index>) -> io::Result<Option<Self>> {
        let file = open_regular(path)?;
        let (from, mut ledger) = match &index {
            Some(index) => match index.checkpoint(&file)? {
                Some((from, ledger)) => (Some(from), ledger),
                None => return Ok(None),
            },
            None => (None, Ledger::default()),
        };
        let mut builder = Builder::at(index.as_ref().map_or(0, Index::commits));
        let (mut rewritten, mut is_written): (Option<Rewritten>, bool) = (None, true);
        let mut tail = read_in_parts(&file, from, &mut ledger, |log, ledger| {
            for entry in log.entries().iter().skip((builder.next() as usize).saturating_sub(log.first())) {
                let Some(place) = ledger.chunks.get(builder.next() as usize) else { break };
                if let Some((head, block)) = builder.push(*place, &entry.record, || mark(log, ledger, entry))
                    && is_written
                {
                    let growing = rewritten.take().or_else(|| Rewritten::of(index_path, index.as_ref()));
                    rewritten = growing.and_then(|mut growing| growing.add(head, &block).map(|()| growing));
                    is_written = rewritten.is_some();
                }
            }
            Ok(())
        })?;
        // Without room for an index there is nothing to ask.
        if !is_written || tail.entries.is_empty() || !(tail.closed || tail.reaches_end()) || !tail.is_clean() {
            return Ok(None);
        }
        let index = rewritten.map_or(index, |rewritten| Some(rewritten.done(index_path)));
        let covered = index.as_ref().map_or(0, Index::commits) as usize;
        if tail.first() > covered {
            // What lies between the last block and the last part that was read belongs to the end as well.
            let from = index.as_ref().map(|index| index.last_checkpoint(&file)).transpose()?.flatten();
            let length = file.metadata()?.len();
            tail = Log::read_on(&file, length, from.as_ref(), usize::MAX)?;
        }
        Ok(Some(Self { file, index, tail, ledger, builder }))
    }

    /// The end of the log, as far as it was read.
    pub fn tail(&self) -> &Log {
        &self.tail
    }

    /// Number of stages of the run.
    pub fn commits(&self) -> usize {
        self.tail.commits()
    }

    /// Reads the record of stage `ordinal`, and checks its seal and the hashes of its messages.
    ///
    /// # Errors
    /// Where it cannot be read or is not what it was.
    pub fn record(&self, ordinal: usize) -> Result<Record, LongLogError> {
        if let Some(entry) = self.tail.entry(ordinal) {
            return Ok(entry.record.clone());
        }
        let at = self.ledger.chunks.get(ordinal).map_or(0, |place| place.at);
        let changed = || self.changed(ordinal);
        let (bytes, record) = record_at(&self.file, at)?.ok_or_else(changed)?;
        let mut channels = self.ledger.channels_described();
        match chunk::open(&bytes, &record, &mut channels) {
            Ok((Content::Commit(content), _)) if content.commit.ordinal == ordinal as u64 => {
                let commit = content.commit.commit();
                Ok(content.report.into_record(commit))
            }
            _ => Err(changed()),
        }
    }

    /// Reads the part of the log with these stages and the one before them. It begins at the last commit before them
    /// that the index marks, and that has its state or follows on one that has: a thinned log may have few.
    ///
    /// # Errors
    /// Where it cannot be read, or they are not what they were.
    pub fn part(&self, stages: Range<usize>) -> Result<Log, LongLogError> {
        let first = stages.start.saturating_sub(1);
        let end = self.ledger.chunks.get(stages.end).map(ChunkPlace::start);
        let end = end.unwrap_or(self.tail.base + self.tail.walked as u64);
        let mut from = first;
        let log = loop {
            let index = self.index.as_ref();
            let checkpoint = index.map(|index| index.checkpoint_before(&self.file, from)).transpose()?.flatten();
            let log = Log::read_on(&self.file, end, checkpoint.as_ref(), usize::MAX)?;
            match log.kept_before(first + 1) {
                kept if kept.unwrap_or(0) < log.first() => from = kept.unwrap_or(0),
                _ => break log,
            }
        };
        match (first..stages.end).find(|ordinal| log.entry(*ordinal).is_none()) {
            None => Ok(log),
            Some(ordinal) if ordinal >= self.commits() => {
                Err(LongLogError::NoSuchStage { ordinal, commits: self.commits() })
            }
            Some(ordinal) => Err(self.changed(ordinal)),
        }
    }

    fn changed(&self, ordinal: usize) -> LongLogError {
        let at = self.ledger.chunks.get(ordinal).map_or(0, |place| place.at);
        LongLogError::Changed { ordinal: ordinal as u64, at }
    }

    /// Finds the first stage from `from` on, among those before the end that was read, whose report has values of
    /// `fields` for which `holds` is true; each value comes as eight bytes.
    ///
    /// # Errors
    /// Where the index cannot be read or has changed.
    pub fn search(&self, from: usize, fields: &[&str], holds: impl Fn(&[u64]) -> bool) -> io::Result<Option<usize>> {
        let Some(index) = &self.index else { return Ok(None) };
        let behind = |head: &&Head| (head.first + head.commits) as usize > from;
        for head in index.heads.iter().filter(behind) {
            let columns = fields.iter().map(|name| index.column(head, name)).collect::<io::Result<Vec<_>>>()?;
            let mut numbers = vec![0; fields.len()];
            for row in from.saturating_sub(head.first as usize)..head.commits as usize {
                numbers.iter_mut().zip(&columns).for_each(|(number, column)| *number = column[row]);
                let ordinal = head.first as usize + row;
                if ordinal < self.tail.first() && holds(&numbers) {
                    return Ok(Some(ordinal));
                }
            }
        }
        Ok(None)
    }
}

/// The mark of the last commit of a block.
pub(super) fn mark(log: &Log, ledger: &Ledger, entry: &Entry) -> Option<Mark> {
    let at = entry.bytes.start;
    let piece = |places: &std::collections::HashMap<_, Range<usize>>, hash| {
        let place = places.get(&hash)?;
        Some(Piece { hash: HexHash(hash), place: [log.place_of(place)?, place.len() as u64] })
    };
    let mesh = piece(&log.meshes, entry.mesh_hash);
    let fields: Vec<Piece> = entry.fields.iter().filter_map(|hash| piece(&log.fields, *hash)).collect();
    if entry.state.is_some() && (mesh.is_none() || fields.len() < entry.fields.len()) {
        return None;
    }
    Some(Mark {
        chain_hash: HexHash(entry.record.commit.chain_hash),
        patterns: ledger.patterns.clone(),
        metadata: ledger.metadata.iter().filter(|(place, ..)| *place < at).cloned().collect(),
        described_at: ledger.described_at.iter().copied().filter(|place| *place <= at).collect(),
        mesh,
        fields,
        kept_before: log.kept_before(entry.record.commit.ordinal as usize).map(|ordinal| ordinal as u64),
    })
}
