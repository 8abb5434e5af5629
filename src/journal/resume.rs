//! Continuing a log.
//!
//! A log that is as it was written is continued in place: what a killed process left half done, the summary and the record
//! of the end are cut off, that is made durable, and then the new stretch is added with its first commit, in one write. Before
//! that write nothing changes. A cut leaves every commit whole, and a write that does not get through leaves what a killed
//! process leaves, so a log is good up to its last commit whenever the process, or the power, goes.
//!
//! That asks for a lock which no other process can hold at once. Where the file system has none, where bytes before the last
//! commit are not as they were written, and where the run continues from an earlier commit, the good records are copied instead:
//! to a file without a name, or a hidden one where there are none, which is forced to disk while the run already continues, and takes the log's place before the first new commit
//! is added. A process that has lost the log only ever writes to the old file then.
//!
//! What a log loses when it is continued is kept next to it as `LOG.dropped-N` wherever it might still be worth something:
//! after damage always, after a cut only if whole commits lie behind it. The torn rest of the stage that was in flight is worth
//! nothing, and goes.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::backend::{Backend, FileBackend, beside};
use super::codec::EncodedField;
use super::damage::Completeness;
use super::encode_error::EncodeError;
use super::encoder::Encoder;
use super::format::library;
use super::frame;
use super::index::{Builder, Index};
use super::index_keeper::{IndexKeeper, is_index};
use super::ledger::Ledger;
use super::lock::{LockError, LogLock};
use super::log::Log;
use super::long::{LongLog, mark};
use super::manifest::Manifest;
use super::reader::ReadError;
use super::recovery::{CopyError, copy};
use super::writer::{JournalWriter, KnownPieces};
use crate::scene::SyncPolicy;
use crate::state::Hash;
use crate::whole_file::write_new;

/// Why a log cannot be continued.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ResumeError {
    /// There is no such file.
    #[error("cannot resume {log}: there is no such file")]
    NoLog {
        /// The log.
        log: String,
        /// The error of the operating system.
        #[source]
        source: io::Error,
    },
    /// Another process writes it.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// It is not a log.
    #[error("cannot resume {log}")]
    Read {
        /// The log.
        log: String,
        /// The error of the reader.
        #[source]
        source: ReadError,
    },
    /// The copy cannot be made.
    #[error("cannot resume {log}: {path} cannot be written. The log is as it was")]
    Copy {
        /// The log.
        log: String,
        /// The copy, or the part that is kept next to it.
        path: String,
        /// The error of the operating system.
        #[source]
        source: io::Error,
    },
    /// The new stretch cannot be begun.
    #[error("cannot resume {log}. The log is as it was")]
    Begin {
        /// The log.
        log: String,
        /// The error of the encoder.
        #[source]
        source: EncodeError,
    },
}

/// A log that this process alone may continue.
#[derive(Debug)]
pub struct Resume {
    path: PathBuf,
    name: String,
    lock: LogLock,
    log: Log,
    /// Of a long log, of which only the end was read.
    before: Option<Before>,
    copies: bool,
}

/// What is known of a long log before its end.
#[derive(Debug)]
struct Before {
    ledger: Ledger,
    index: Option<Index>,
    builder: Builder,
}

/// A log that is being continued, and its last good state.
#[derive(Debug)]
pub struct Resumed {
    /// Takes the stages that follow.
    pub writer: JournalWriter,
    /// The log as it was, for the state to continue from, or the end of it. Holds the file, or its end, in memory; drop it once
    /// that is taken.
    pub log: Log,
    /// Where the part that was dropped is kept, if it might still be worth something.
    pub dropped: Option<PathBuf>,
}

impl Resume {
    /// Acquires the right to write a log, and reads the log. Changes nothing.
    ///
    /// # Errors
    /// Where it is not there, not a log, or another process writes it.
    pub fn open(path: &Path) -> Result<Self, ResumeError> {
        let name = path.display().to_string();
        // Through links, so that the file they lead to is replaced and not the link.
        let path = path.canonicalize().map_err(|source| ResumeError::NoLog { log: name.clone(), source })?;
        let lock = LogLock::take(&path)?;
        let failed = |source| ResumeError::Read { log: name.clone(), source };
        let io = |source| failed(ReadError::Io { path: name.clone(), source });
        let (log, before) = match LongLog::open(&path).map_err(io)? {
            Some(LongLog { tail, ledger, index, builder, .. }) => (tail, Some(Before { ledger, index, builder })),
            None => (Log::read(&path).map_err(failed)?, None),
        };
        Ok(Self { path, name, lock, log, before, copies: false })
    }

    /// Reads the log again from its start, for what the end of a long log does not show.
    ///
    /// # Errors
    /// Where it cannot be read.
    pub fn whole(self) -> Result<Self, ResumeError> {
        if self.log.first() == 0 {
            return Ok(self);
        }
        let log = Log::read(&self.path).map_err(|source| ResumeError::Read { log: self.name.clone(), source })?;
        Ok(Self { log, before: None, ..self })
    }

    /// Continues in a copy that takes the log's place, as where there are no locks.
    pub fn in_a_copy(self) -> Self {
        Self { copies: true, ..self }
    }

    /// The log as far as it was read.
    pub fn log(&self) -> &Log {
        &self.log
    }

    /// Starts a new stretch behind the last good commit. A record that the run was finished is not carried over.
    ///
    /// # Errors
    /// Where the copy cannot be made; the log is then as it was.
    pub fn start(self, manifest: &Manifest, sync: SyncPolicy) -> Result<Resumed, ResumeError> {
        let all = self.log.commits();
        self.start_after(all, manifest, sync)
    }

    /// Starts a new stretch behind the first `keep` commits; those after them are dropped.
    ///
    /// # Errors
    /// Where the copy cannot be made; the log is then as it was.
    pub fn start_after(self, keep: usize, manifest: &Manifest, sync: SyncPolicy) -> Result<Resumed, ResumeError> {
        let all = self.log.commits();
        let keep = keep.min(all);
        let in_place = keep == all && !self.copies && self.log.is_clean() && self.lock.is_exclusive();
        let before = self.log.manifests().last().filter(|_| !self.log.last_manifest_is_lost());
        let same =
            |before: &Manifest| before.scene_text == manifest.scene_text && before.own_terms == manifest.own_terms;
        let same_scene = before.is_some_and(same);
        let manifest = Manifest { first_ordinal: keep as u64, same_scene, ..manifest.clone() };
        if in_place { self.in_place(&manifest, sync) } else { self.whole()?.copied(keep, &[manifest], sync) }
    }

    /// Puts back the scene of a lost manifest, which `manifest` holds, and behind it that of the last stretch, with
    /// which the log is continued as before. No stage is added.
    ///
    /// # Errors
    /// Where the copy cannot be made; the log is then as it was.
    pub fn put_back(self, manifest: &Manifest, sync: SyncPolicy) -> Result<Resumed, ResumeError> {
        let all = self.log.commits();
        let behind =
            |manifest: &Manifest| Manifest { first_ordinal: all as u64, same_scene: false, ..manifest.clone() };
        let manifests: Vec<Manifest> = [manifest].into_iter().chain(self.log.manifests().last()).map(behind).collect();
        self.whole()?.copied(all, &manifests, sync)
    }

    fn in_place(mut self, manifest: &Manifest, sync: SyncPolicy) -> Result<Resumed, ResumeError> {
        let begin = |name: &str, source| ResumeError::Begin { log: name.to_owned(), source };
        let ledger = self.before.as_mut().map(|before| std::mem::take(&mut before.ledger));
        let behind = encoder_behind(&self.log, ledger).map_err(|source| begin(&self.name, source.into()))?;
        let Some((mut encoder, length)) = behind else {
            let all = self.log.commits();
            return self.whole()?.copied(all, std::slice::from_ref(manifest), sync);
        };
        let Self { path, name, lock, log, before, .. } = self;
        let dropped = keep_dropped(&path, &log)?;
        let index_path = beside(&path, ".index");
        let mut index = match before {
            None => Some(IndexKeeper::new(index_path)),
            Some(Before { index, builder, .. }) => {
                index.and_then(|index| IndexKeeper::behind(index_path, &index, builder))
            }
        };
        for entry in log.entries() {
            let ledger = encoder.ledger();
            let place = ledger.chunks.get(entry.record.commit.ordinal as usize).copied();
            index = index.zip(place).and_then(|(index, place)| match index.wants(&entry.record) {
                true => index.take(place, &entry.record, || mark(&log, ledger, entry)),
                false => Some(index),
            });
        }
        if let Some(last) = log.entries().last() {
            let mesh = log.meshes.get_key_value(&last.mesh_hash);
            let fields = last.fields.iter().filter_map(|hash| log.fields.get_key_value(hash));
            for (hash, place) in mesh.into_iter().chain(fields) {
                if let Some(at) = log.place_of(place) {
                    encoder.know(*hash, [at, place.len() as u64]);
                }
            }
        }
        // Stands in front of the first commit, and reaches the log together with it.
        encoder.manifest(manifest).map_err(|source| begin(&name, source))?;
        let backend = FileBackend::behind(&path, length, log.file_len()).map_err(|source| ResumeError::Copy {
            log: name.clone(),
            path: path.display().to_string(),
            source,
        })?;
        let writer = JournalWriter {
            lock: Some(lock),
            index,
            known: known(&log, log.commits()),
            last: log.last_commit().copied(),
            length,
            ..JournalWriter::with(encoder, Box::new(backend), &name, sync)
        };
        Ok(Resumed { writer, log, dropped })
    }

    fn copied(self, keep: usize, manifests: &[Manifest], sync: SyncPolicy) -> Result<Resumed, ResumeError> {
        let Self { path, name, lock, log, .. } = self;
        let begin = |source| ResumeError::Begin { log: name.clone(), source };
        let dropped = if keep < log.entries().len() { Some(keep_whole(&path)?) } else { keep_dropped(&path, &log)? };
        let failed = |source| ResumeError::Copy { log: name.clone(), path: format!("a copy of {name}"), source };
        let mut backend = FileBackend::copy_of(&path).map_err(failed)?;
        let mut encoder = Encoder::new(&library()).map_err(|source| begin(source.into()))?;
        let copied = copy(&log, keep, &mut encoder, &mut backend).and_then(|length| {
            manifests.iter().try_for_each(|manifest| encoder.manifest(manifest))?;
            let bytes = encoder.take();
            backend.append(&bytes)?;
            backend.replace(log.file_len())?;
            Ok(length + bytes.len() as u64)
        });
        let length = copied.map_err(|error| match error {
            CopyError::Io(source) => failed(source),
            CopyError::Encode(source) => begin(source),
        })?;
        // It does not fit the copy.
        let index = beside(&path, ".index");
        if is_index(&index) {
            let _ = fs::remove_file(&index);
        }
        let writer = JournalWriter {
            lock: Some(lock),
            known: known(&log, keep),
            last: keep.checked_sub(1).map(|last| log.entries()[last].record.commit),
            length,
            ..JournalWriter::with(encoder, Box::new(backend), &name, sync)
        };
        Ok(Resumed { writer, log, dropped })
    }
}

impl JournalWriter {
    /// Continues a log: [`Resume::open`] and [`Resume::start`] in one, for callers who know the scene.
    ///
    /// # Errors
    /// Those of both.
    pub fn resume(path: &Path, manifest: &Manifest, sync: SyncPolicy) -> Result<Resumed, ResumeError> {
        Resume::open(path)?.start(manifest, sync)
    }
}

/// Keeps a log that continues from an earlier stage than its last as `LOG.replaced-N`.
fn keep_whole(path: &Path) -> Result<PathBuf, ResumeError> {
    for number in 1_u32.. {
        let kept = beside(path, &format!(".replaced-{number}"));
        // The log itself is replaced by renaming, so another name for it is as good as a copy, and costs nothing.
        match fs::hard_link(path, &kept) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
            Err(_) => {
                let log = path.display().to_string();
                let failed = |source| ResumeError::Copy { log, path: kept.display().to_string(), source };
                return fs::read(path).and_then(|log| write_new(&kept, &log)).map(|()| kept.clone()).map_err(failed);
            }
            Ok(()) => return Ok(kept),
        }
    }
    Ok(path.to_path_buf())
}

/// Writes what a damaged log loses to `LOG.dropped-N`, if it might still be worth something.
fn keep_dropped(path: &Path, log: &Log) -> Result<Option<PathBuf>, ResumeError> {
    if !matches!(log.completeness(), Completeness::Damaged { .. }) && log.unused_manifest().is_none() {
        return Ok(None);
    }
    for number in 1_u32.. {
        let beside = beside(path, &format!(".dropped-{number}"));
        let written = write_new(&beside, log.tail());
        return match written {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
            Ok(()) => Ok(Some(beside)),
            Err(source) => {
                let log = path.display().to_string();
                Err(ResumeError::Copy { log, path: beside.display().to_string(), source })
            }
        };
    }
    Ok(None)
}

/// An encoder behind the last commit or manifest of a log, and the length to which the log is cut. Message indexes that a writer
/// which was cut off did not get to go out in front of what comes next. `None` where the last commit's chunk has a byte, covered
/// by no hash, that would be written otherwise.
fn encoder_behind(log: &Log, ledger: Option<Ledger>) -> Result<Option<(Encoder, u64)>, mcap::McapError> {
    let end = log.base + log.stretch_end as u64;
    let Some(entry) = log.entries.last() else {
        let mut ledger = Ledger::default();
        ledger.enter(log.base, &log.bytes[..log.stretch_end]);
        return Ok(Some((Encoder::behind(ledger, end)?, end)));
    };
    let last = (entry.bytes.start - log.base) as usize;
    let ledger = ledger.unwrap_or_else(|| {
        let mut ledger = Ledger::default();
        ledger.enter(log.base, &log.bytes[..last]);
        ledger
    });
    let mut encoder = Encoder::behind(ledger, log.base + last as u64)?;
    let rest = log.parts.iter().filter(|part| part.at >= last && part.end <= log.stretch_end);
    for record in rest.filter_map(|part| frame::next(&log.bytes, part.at)?.ok()) {
        encoder.again(&log.bytes, &record)?;
    }
    let written = encoder.take();
    let there = &log.bytes[last..log.stretch_end];
    let same = written.iter().zip(there).take_while(|(written, there)| written == there).count();
    if (same as u64) < entry.bytes.end - entry.bytes.start {
        return Ok(None);
    }
    encoder.give_back(&written[same..]);
    Ok(Some((encoder, log.base + (last + same) as u64)))
}

/// The mesh and the fields of the last of the first `keep` stages.
fn known(log: &Log, keep: usize) -> KnownPieces {
    let Some(entry) = keep.checked_sub(1).and_then(|last| log.entry(last)) else { return KnownPieces::default() };
    let field = |hash: &Hash| Some(EncodedField { hash: *hash, bytes: log.field(hash)?.to_vec() });
    let mesh = log.meshes.contains_key(&entry.mesh_hash).then_some(entry.mesh_hash);
    KnownPieces { mesh, fields: entry.fields.iter().filter_map(field).collect() }
}
