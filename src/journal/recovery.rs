//! Copying what is good of a log.
//!
//! The good records are put through a new writer, which then knows them all: same numbers, same times, same bytes.

use std::io::{self, Write};
use std::path::Path;

use super::backend::Backend;
use super::damage::Completeness;
use super::encode_error::EncodeError;
use super::encoder::Encoder;
use super::frame;
use super::log::{Kept, Log};
use super::reader::ReadError;
use crate::whole_file::WholeFile;

/// Bytes that are collected before they go to the new file.
const BATCH_BYTES: usize = 1 << 20;

pub(super) enum CopyError {
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
fn again<E: From<EncodeError>>(
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
        let Some(Ok(frame)) = frame::next(&log.bytes, part.at) else { continue };
        encoder.again(&log.bytes, &frame).map_err(EncodeError::Mcap)?;
        pending += part.end - part.at;
        if pending >= BATCH_BYTES {
            emit(encoder.take())?;
            pending = 0;
        }
    }
    emit(encoder.take())
}

/// Puts the good records of a log through an encoder to a file; gives back how many bytes they take.
pub(super) fn copy(
    log: &Log,
    keep: Option<usize>,
    encoder: &mut Encoder,
    backend: &mut dyn Backend,
) -> Result<u64, CopyError> {
    let mut length = 0;
    again(log, keep, encoder, |bytes| {
        length += bytes.len() as u64;
        Ok::<(), CopyError>(backend.append(&bytes)?)
    })?;
    Ok(length)
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
    recover_mended(path, new, |_| None)
}

/// The same; of a log in which whole commits have lost what they follow on `mend` may give back one in which they have not.
///
/// # Errors
/// Those of [`recover`].
pub fn recover_mended(
    path: &Path,
    new: &Path,
    mend: impl FnOnce(&Log) -> Option<Log>,
) -> Result<RecoverOutcome, RecoverError> {
    let log = match Log::read(path) {
        Ok(log) => log,
        Err(error @ ReadError::Io { .. }) => return Err(RecoverError::Read(error)),
        Err(error) => return Ok(RecoverOutcome::Hopeless { why: error.to_string() }),
    };
    let mended = if log.later_commits().is_empty() { None } else { mend(&log) };
    let log = mended.unwrap_or(log);
    let commits = log.entries().len() as u64;
    let finished = log.completeness() == Completeness::Finished;
    let lost_manifest = log.missed_manifests().next().map(ToString::to_string);
    let lost_manifest = lost_manifest.or(log.unused_manifest().map(|note| note.text.clone()));
    let loss = log.loss().filter(|_| !finished).map(ToString::to_string);
    if let (0, Some(why)) = (commits, &loss) {
        return Ok(RecoverOutcome::Hopeless { why: why.clone() });
    }
    write_good(&log, finished, new).map_err(|error| {
        let new = new.display().to_string();
        match error {
            CopyError::Io(source) if source.kind() == io::ErrorKind::AlreadyExists => RecoverError::Exists { new },
            CopyError::Io(source) => RecoverError::Write { new, source },
            CopyError::Encode(source) => RecoverError::Encode { new, source },
        }
    })?;
    let later_commits = log.later_commits().len() as u64;
    let dropped = log.file_len() - log.good_end();
    Ok(match loss.or(lost_manifest) {
        Some(why) => RecoverOutcome::Lossy { commits, dropped, later_commits, why },
        None => RecoverOutcome::Lossless { commits },
    })
}

/// What is good of a log as a file of its own, which is whole or not there.
fn write_good(log: &Log, finished: bool, new: &Path) -> Result<(), CopyError> {
    // Asked again when it comes to its name; here it spares the work.
    if new.symlink_metadata().is_ok() {
        return Err(CopyError::Io(io::ErrorKind::AlreadyExists.into()));
    }
    let whole = WholeFile::beside(new)?;
    let mut encoder = Encoder::new(&log.library).map_err(EncodeError::Mcap)?;
    let keep = (!finished).then_some(log.entries().len());
    again(log, keep, &mut encoder, |bytes| Ok::<(), CopyError>(whole.file().write_all(&bytes)?))?;
    encoder.close(log.commits() as u64, |piece| whole.file().write_all(&piece))?;
    Ok(whole.keep_as(new)?)
}
