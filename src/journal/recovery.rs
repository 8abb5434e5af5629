//! Going on with a log, and copying what is good of one.
//!
//! MCAP cannot append: its summary at the end of the file lists every chunk, and viewers read nothing else. So the good
//! records of a log are put through a new writer, which then knows them all: same numbers, same times, same bytes. The
//! copy grows beside the log as `LOG.new`, is forced to disk while the run already goes on, and takes the log's place
//! before the first new commit is added. Until then, and if the process dies meanwhile, the log is as it was.
//!
//! What a log loses when it is resumed is kept beside it as `LOG.dropped-N` wherever it might still be worth something:
//! after damage always, after a cut only if whole commits lie behind it. The torn rest of the stage that was in flight
//! is worth nothing, and goes.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::backend::{Backend, FileBackend, beside, sync_folder_of};
use super::damage::Completeness;
use super::encoder::{EncodeError, Encoder, library};
use super::frame;
use super::lock::{LockError, LogLock};
use super::log::{Kept, Log};
use super::manifest::Manifest;
use super::reader::ReadError;
use super::writer::JournalWriter;
use crate::scene::SyncPolicy;

/// Bytes that are collected before they go to the new file.
const BATCH_BYTES: usize = 1 << 20;

/// Why a run cannot go on from a log.
#[derive(Debug, thiserror::Error)]
pub enum ResumeError {
    /// There is no such file.
    #[error("cannot resume {log}: there is no such file")]
    NoLog {
        /// The log.
        log: String,
        /// What the system says.
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
        /// Why not.
        #[source]
        source: ReadError,
    },
    /// The copy cannot be made.
    #[error("cannot resume {log}: {path} cannot be written. The log is as it was")]
    Copy {
        /// The log.
        log: String,
        /// The copy, or the part that is kept beside it.
        path: String,
        /// What the system says.
        #[source]
        source: io::Error,
    },
    /// The new stretch cannot be begun.
    #[error("cannot resume {log}. The log is as it was")]
    Begin {
        /// The log.
        log: String,
        /// Why not.
        #[source]
        source: EncodeError,
    },
}

/// A log that this process, and no other, may go on with.
#[derive(Debug)]
pub struct Resume {
    path: PathBuf,
    name: String,
    lock: LogLock,
    log: Log,
}

/// A log that is being gone on with.
#[derive(Debug)]
pub struct Resumed {
    /// Takes the stages that follow.
    pub writer: JournalWriter,
    /// The log as it was, for the state to go on from. Holds the whole file in memory; drop it once that is taken.
    pub log: Log,
    /// Where the part that was dropped is kept, if it might still be worth something.
    pub dropped: Option<PathBuf>,
}

impl Resume {
    /// Claims a log and reads it. Changes nothing.
    ///
    /// # Errors
    /// Where it is not there, not a log, or another process writes it.
    pub fn open(path: &Path) -> Result<Self, ResumeError> {
        let name = path.display().to_string();
        // Through links, so that the file they lead to is replaced and not the link.
        let path = path.canonicalize().map_err(|source| ResumeError::NoLog { log: name.clone(), source })?;
        let lock = LogLock::take(&path)?;
        let log = Log::read(&path).map_err(|source| ResumeError::Read { log: name.clone(), source })?;
        Ok(Self { path, name, lock, log })
    }

    /// What the log holds.
    pub fn log(&self) -> &Log {
        &self.log
    }

    /// Begins a new stretch behind the last good commit. That the run was finished, where it was, is not carried over.
    ///
    /// # Errors
    /// Where the copy cannot be made; the log is then as it was.
    pub fn start(self, manifest: &Manifest, sync: SyncPolicy) -> Result<Resumed, ResumeError> {
        let all = self.log.entries().len();
        self.start_after(all, manifest, sync)
    }

    /// The same behind the first `keep` commits; those after them go.
    ///
    /// # Errors
    /// Where the copy cannot be made; the log is then as it was.
    pub fn start_after(self, keep: usize, manifest: &Manifest, sync: SyncPolicy) -> Result<Resumed, ResumeError> {
        let Self { path, name, lock, log } = self;
        let begin = |source| ResumeError::Begin { log: name.clone(), source };
        let keep = keep.min(log.entries().len());
        let dropped = if keep < log.entries().len() { Some(keep_whole(&path)?) } else { keep_dropped(&path, &log)? };
        let new = beside(&path, ".new");
        let failed = |source| ResumeError::Copy { log: name.clone(), path: new.display().to_string(), source };
        // Left by a process that died while it did this; the lock says that it is nobody's.
        match fs::remove_file(&new) {
            Err(source) if source.kind() != io::ErrorKind::NotFound => return Err(failed(source)),
            _ => {}
        }
        let mut backend = FileBackend::create_new(&new).map_err(failed)?;
        let mut encoder = Encoder::new(&library()).map_err(|source| begin(source.into()))?;
        let manifest = Manifest { first_ordinal: keep as u64, ..manifest.clone() };
        let copied = copy(&log, Some(keep), &mut encoder, &mut backend).and_then(|length| {
            encoder.manifest(&manifest).map_err(EncodeError::Mcap)?;
            let bytes = encoder.take();
            backend.append(&bytes)?;
            if let Ok(metadata) = fs::metadata(&path) {
                let _ = fs::set_permissions(&new, metadata.permissions());
            }
            backend.replace(&path)?;
            Ok(length + bytes.len() as u64)
        });
        let length = copied.map_err(|error| {
            let _ = fs::remove_file(&new);
            match error {
                CopyError::Io(source) => failed(source),
                CopyError::Encode(source) => begin(source),
            }
        })?;
        let writer = JournalWriter {
            encoder,
            backend: Box::new(backend),
            lock: Some(lock),
            log: name,
            sync,
            viewer: None,
            known: log.entries()[..keep].iter().flat_map(|entry| [entry.mesh_hash, entry.displacement_hash]).collect(),
            last: keep.checked_sub(1).map(|last| log.entries()[last].record.commit),
            length,
            synced: Instant::now(),
            given_up: false,
        };
        Ok(Resumed { writer, log, dropped })
    }
}

impl JournalWriter {
    /// Goes on with a log: [`Resume::open`] and [`Resume::start`] in one, for callers who know the scene.
    ///
    /// # Errors
    /// Those of both.
    pub fn resume(path: &Path, manifest: &Manifest, sync: SyncPolicy) -> Result<Resumed, ResumeError> {
        Resume::open(path)?.start(manifest, sync)
    }
}

enum CopyError {
    Io(io::Error),
    Encode(EncodeError),
}

impl From<io::Error> for CopyError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<EncodeError> for CopyError {
    fn from(error: EncodeError) -> Self {
        Self::Encode(error)
    }
}

/// Puts the good records of a log through an encoder, all of them or those up to the first `keep` commits without the
/// record of the end; `emit` gets the bytes in pieces of about a mebibyte.
pub(super) fn again<E: From<EncodeError>>(
    log: &Log,
    keep: Option<usize>,
    encoder: &mut Encoder,
    mut emit: impl FnMut(Vec<u8>) -> Result<(), E>,
) -> Result<(), E> {
    let mut pending = 0;
    let mut commits = 0;
    for part in &log.parts {
        commits += usize::from(part.kept == Kept::Commit);
        match keep {
            Some(keep) if commits > keep => break,
            Some(_) if part.kept == Kept::Finished => continue,
            _ => {}
        }
        let Some(Ok(frame)) = frame::next(&log.bytes, part.at) else {
            continue;
        };
        encoder.again(&log.bytes, &frame).map_err(EncodeError::Mcap)?;
        pending += part.end - part.at;
        if pending >= BATCH_BYTES {
            emit(encoder.take())?;
            pending = 0;
        }
    }
    emit(encoder.take())
}

fn copy(log: &Log, keep: Option<usize>, encoder: &mut Encoder, backend: &mut dyn Backend) -> Result<u64, CopyError> {
    let mut length = 0;
    again(log, keep, encoder, |bytes| {
        length += bytes.len() as u64;
        Ok::<(), CopyError>(backend.append(&bytes)?)
    })?;
    Ok(length)
}

/// Keeps a log that goes on from an earlier stage than its last as `LOG.replaced-N`.
fn keep_whole(path: &Path) -> Result<PathBuf, ResumeError> {
    for number in 1_u32.. {
        let kept = beside(path, &format!(".replaced-{number}"));
        // The log itself is replaced by renaming, so another name for it is as good as a copy, and costs nothing.
        match fs::hard_link(path, &kept) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
            Err(_) => {
                let log = path.display().to_string();
                let failed = |source| ResumeError::Copy { log, path: kept.display().to_string(), source };
                return fs::copy(path, &kept).map(|_| kept.clone()).map_err(failed);
            }
            Ok(()) => return Ok(kept),
        }
    }
    Ok(path.to_path_buf())
}

/// Writes what a damaged log loses to `LOG.dropped-N`, if it might still be worth something.
fn keep_dropped(path: &Path, log: &Log) -> Result<Option<PathBuf>, ResumeError> {
    if !matches!(log.completeness(), Completeness::Damaged { .. }) {
        return Ok(None);
    }
    for number in 1_u32.. {
        let beside = beside(path, &format!(".dropped-{number}"));
        let written = match fs::OpenOptions::new().write(true).create_new(true).open(&beside) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
            Err(error) => Err(error),
            Ok(mut file) => {
                file.write_all(log.tail()).and_then(|()| file.sync_all()).and_then(|()| sync_folder_of(&beside))
            }
        };
        return match written {
            Ok(()) => Ok(Some(beside)),
            Err(source) => {
                let log = path.display().to_string();
                Err(ResumeError::Copy { log, path: beside.display().to_string(), source })
            }
        };
    }
    Ok(None)
}

/// What became of a log that was recovered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RecoverOutcome {
    /// Every commit that the log ever held is in the new one.
    Lossless {
        /// Stages in the new log.
        commits: u64,
    },
    /// The new log holds the run up to the first loss.
    Lossy {
        /// Stages in the new log.
        commits: u64,
        /// Bytes that were left behind.
        dropped: u64,
        /// Commits among them that are whole but have lost their predecessor.
        later_commits: u64,
        /// What was lost first.
        why: String,
    },
    /// Nothing could be kept, and nothing was written.
    Hopeless {
        /// Why.
        why: String,
    },
}

/// Why a log cannot be copied.
#[derive(Debug, thiserror::Error)]
pub enum RecoverError {
    /// The log cannot be read at all.
    #[error(transparent)]
    Read(ReadError),
    /// There is a file where the copy should go.
    #[error("{new} exists and is not overwritten: choose another name for the copy")]
    Exists {
        /// The copy.
        new: String,
    },
    /// Another process writes there.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// The copy cannot be written.
    #[error("cannot write {new}; the log itself is as it was")]
    Write {
        /// The copy.
        new: String,
        /// What the system says.
        #[source]
        source: io::Error,
    },
    /// MCAP refused a record of the log.
    #[error("cannot write {new} anew from the log, which is as it was")]
    Encode {
        /// The copy.
        new: String,
        /// Why not.
        #[source]
        source: EncodeError,
    },
}

/// Copies what is good of a log to a new file, with the summary that viewers look for.
///
/// # Errors
/// Where the log cannot be read at all, or the new file exists or cannot be written. That nothing is good of the log is
/// an outcome.
pub fn recover(path: &Path, new: &Path) -> Result<RecoverOutcome, RecoverError> {
    let log = match Log::read(path) {
        Ok(log) => log,
        Err(error @ ReadError::Io { .. }) => return Err(RecoverError::Read(error)),
        Err(error) => return Ok(RecoverOutcome::Hopeless { why: error.to_string() }),
    };
    let commits = log.entries().len() as u64;
    let finished = log.completeness() == Completeness::Finished;
    let lost_manifest = log.lost_manifests().first().map(ToString::to_string);
    let loss = log.loss().filter(|_| !finished).map(ToString::to_string);
    if let (0, Some(why)) = (commits, &loss) {
        return Ok(RecoverOutcome::Hopeless { why: why.clone() });
    }
    let name = new.display().to_string();
    let _lock = LogLock::take(new)?;
    let mut backend = FileBackend::create_new(new).map_err(|source| match source.kind() {
        io::ErrorKind::AlreadyExists => RecoverError::Exists { new: name.clone() },
        _ => RecoverError::Write { new: name.clone(), source },
    })?;
    let write = |backend: &mut FileBackend| {
        let mut encoder = Encoder::new(&log.library).map_err(EncodeError::Mcap)?;
        copy(&log, (!finished).then_some(log.entries().len()), &mut encoder, backend)?;
        encoder.close().map_err(EncodeError::Mcap)?;
        backend.append(&encoder.take())?;
        Ok(backend.sync()?)
    };
    if let Err(error) = write(&mut backend) {
        let _ = fs::remove_file(new);
        return Err(match error {
            CopyError::Io(source) => RecoverError::Write { new: name, source },
            CopyError::Encode(source) => RecoverError::Encode { new: name, source },
        });
    }
    let later_commits = log.later_commits().len() as u64;
    let dropped = log.file_len() - log.good_end();
    Ok(match loss.or(lost_manifest) {
        Some(why) => RecoverOutcome::Lossy { commits, dropped, later_commits, why },
        None => RecoverOutcome::Lossless { commits },
    })
}
