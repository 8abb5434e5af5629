//! Keeps the index of a log that is being written, once it is long. Whatever goes wrong with the index ends the index, not the
//! run.

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use super::index::{Builder, Head, INDEX_MAGIC, Index, Mark};
use super::ledger::ChunkPlace;
use super::reader::open_regular;
use crate::record::Record;
use crate::whole_file::WholeFile;

/// Commits, or bytes, from which on a log has an index: shorter ones are read whole in no time.
const LONG_COMMITS: u64 = 4096;
pub(super) const LONG_BYTES: u64 = 64 << 20;

/// Takes the commits of a log, and writes a block of its index where they fill one.
#[derive(Debug)]
pub(super) struct IndexKeeper {
    path: PathBuf,
    builder: Builder,
    /// Blocks of a log that is not long yet.
    waiting: Vec<u8>,
    file: Option<File>,
}

impl IndexKeeper {
    /// Creates a keeper for a new log.
    pub fn new(path: PathBuf) -> Self {
        Self { path, builder: Builder::at(0), waiting: Vec::new(), file: None }
    }

    /// Creates a keeper for a log that is continued and has an index.
    pub fn behind(path: PathBuf, index: &Index, builder: Builder) -> Option<Self> {
        if !is_index(&path) {
            return None;
        }
        let file = OpenOptions::new().append(true).open(&path).ok()?;
        file.set_len(index.length).ok()?;
        Some(Self { path, builder, waiting: Vec::new(), file: Some(file) })
    }

    /// Whether a commit is the next that the index lacks.
    pub fn wants(&self, record: &Record) -> bool {
        self.builder.next() == record.commit.ordinal
    }

    /// Adds a commit to the index; returns `None` where the index can no longer be kept.
    pub fn take(mut self, place: ChunkPlace, record: &Record, mark: impl FnOnce() -> Option<Mark>) -> Option<Self> {
        // What is missing of a log that is continued is indexed by whoever reads it next.
        if self.builder.next() != record.commit.ordinal {
            return None;
        }
        let Some((_, block)) = self.builder.push(place, record, mark) else { return Some(self) };
        self.waiting.extend(block);
        if self.file.is_none() && record.commit.ordinal < LONG_COMMITS && place.at < LONG_BYTES {
            return Some(self);
        }
        let mut file = self.file.take().or_else(|| begin(&self.path))?;
        file.write_all(&self.waiting).ok()?;
        self.waiting.clear();
        Some(Self { file: Some(file), ..self })
    }
}

/// Creates an empty file for an index; never in place of a file that is not an index.
fn begin(path: &Path) -> Option<File> {
    if path.symlink_metadata().is_ok() {
        if !is_index(path) {
            return None;
        }
        std::fs::remove_file(path).ok()?;
    }
    OpenOptions::new().append(true).create_new(true).open(path).ok()
}

/// Whether a file is an index, or a beginning of one.
pub(super) fn is_index(path: &Path) -> bool {
    let mut start = [0; INDEX_MAGIC.len()];
    path.symlink_metadata().is_ok_and(|metadata| metadata.is_file())
        && open_regular(path).and_then(|mut file| file.read_exact(&mut start)).is_ok()
        && start == *INDEX_MAGIC
}

/// An index that is written again or made longer: under a temporary name until it is whole.
#[derive(Debug)]
pub(super) struct Rewritten {
    file: WholeFile,
    pub index: Index,
}

impl Rewritten {
    /// Starts a new index file with the blocks of the old index.
    pub fn of(path: &Path, old: Option<&Index>) -> Option<Self> {
        let file = WholeFile::beside(path).ok()?;
        let mut index = Index::empty(file.file().try_clone().ok()?);
        if let Some(old) = old {
            std::io::copy(&mut File::open(path).ok()?.take(old.length), &mut file.file()).ok()?;
            index.heads.clone_from(&old.heads);
            index.length = old.length;
        }
        Some(Self { file, index })
    }

    /// Writes a block behind the others.
    pub fn add(&mut self, head: Head, block: &[u8]) -> Option<()> {
        self.file.file().write_all(block).ok()?;
        self.index.add(head, block.len());
        Some(())
    }

    /// Renames the file to its final name, unless a file there is no index, or the index is too short to be worth one.
    pub fn done(self, path: &Path) -> Index {
        let Self { file, index } = self;
        if index.commits() >= LONG_COMMITS && (path.symlink_metadata().is_err() || is_index(path)) {
            // Only a cache: without it the log is read again.
            let _ = file.replace(path);
        }
        index
    }
}
