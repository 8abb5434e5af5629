//! Copying what is good of a log.
//!
//! The good records are put through a new writer, which then knows them all: same numbers, same times, same bytes.

use std::io;
use std::path::Path;

use super::backend::Backend;
use super::damage::Completeness;
use super::encode_error::EncodeError;
use super::encoder::Encoder;
use super::frame;
use super::log::{Kept, Log};
use super::new_log::{BATCH_BYTES, ClosedLog, NewLog, NewLogError};
use super::portions::Portions;
use super::reader::ReadError;

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

/// Puts the good records of a log up to the first `keep` commits, without the record of the end, through an encoder to a file;
/// gives back how many bytes they take.
pub(super) fn copy(log: &Log, keep: usize, encoder: &mut Encoder, backend: &mut dyn Backend) -> Result<u64, CopyError> {
    let (mut length, mut pending, mut commits) = (0, 0, 0);
    let mut emit = |bytes: Vec<u8>| {
        length += bytes.len() as u64;
        backend.append(&bytes)
    };
    for part in log.parts.iter().filter(|part| part.kept != Kept::Finished) {
        commits += usize::from(part.kept == Kept::Commit);
        if commits > keep {
            break;
        }
        let Some(Ok(frame)) = frame::next(&log.bytes, part.at) else { continue };
        encoder.again(&log.bytes, &frame).map_err(EncodeError::Mcap)?;
        pending += part.end - part.at;
        if pending >= BATCH_BYTES {
            emit(encoder.take())?;
            pending = 0;
        }
    }
    emit(encoder.take())?;
    Ok(length)
}

/// The outcome of recovering a log.
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
        /// The first loss.
        why: String,
    },
    /// Nothing could be kept, and nothing was written.
    Hopeless {
        /// Why nothing can be recovered.
        why: String,
        /// Commits that are whole but have lost their predecessor.
        later_commits: u64,
    },
}

/// Why a log cannot be recovered.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecoverError {
    /// The log cannot be read at all.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The copy cannot be made.
    #[error(transparent)]
    New(#[from] NewLogError),
}

/// Copies the good part of a log to a new file, with the summary that viewers need.
///
/// # Errors
/// Where the log cannot be read at all, or the new file exists or cannot be written. That nothing is good of the log is
/// an outcome.
pub fn recover(path: &Path, new: &Path) -> Result<RecoverOutcome, RecoverError> {
    recover_with(path, new, None)
}

/// Recovers a log as [`recover`] does, but lets `mend` put lost stages back where whole commits follow on them.
///
/// # Errors
/// Those of [`recover`].
pub fn recover_mended(
    path: &Path,
    new: &Path,
    mut mend: impl FnMut(&Log) -> Option<Log>,
) -> Result<RecoverOutcome, RecoverError> {
    recover_with(path, new, Some(&mut mend))
}

type Mend<'m> = &'m mut dyn FnMut(&Log) -> Option<Log>;

fn recover_with(path: &Path, new: &Path, mut mend: Option<Mend>) -> Result<RecoverOutcome, RecoverError> {
    let mut portions = Portions::of(path)?;
    let (mut copy, mut pictures): (Option<NewLog>, Option<String>) = (None, None);
    loop {
        let portion = match portions.read() {
            Ok(portion) => portion,
            Err(error @ ReadError::Io { .. }) => return Err(error.into()),
            Err(error) => return Ok(RecoverOutcome::Hopeless { why: error.to_string(), later_commits: 0 }),
        };
        if let Some(mend) = mend.as_mut().filter(|_| !portion.log().later_commits().is_empty())
            && let Some(mended) = mend(&Log::read(path)?)
            && let Some((copy, mended)) = copy_mended(mended, mend, new)?
        {
            copy.keep()?;
            return Ok(outcome(&mended, pictures));
        }
        let log = portion.log();
        pictures = pictures.or(log.lost_pictures());
        let finished = log.completeness() == Completeness::Finished;
        let loss = log.loss().filter(|_| !finished).map(ToString::to_string);
        let mut good = match (copy, loss) {
            (Some(copy), _) => copy,
            (None, Some(why)) if log.commits() == 0 => {
                let later_commits = log.later_commits().len() as u64;
                return Ok(RecoverOutcome::Hopeless { why, later_commits });
            }
            (None, _) => NewLog::begin(new, &log.library)?,
        };
        for part in portion.parts().iter().filter(|part| finished || part.kept != Kept::Finished) {
            good.add(log, part, |_| true)?;
        }
        match portion.into_end() {
            Some(log) => {
                good.finish(log.commits())?;
                return Ok(outcome(&log, pictures));
            }
            None => copy = Some(good),
        }
    }
}

/// Times that a log is mended: the first time may put back what is needed to read more.
const MOST_MENDS: usize = 4;

/// A copy of a mended log with that log; `None` where no copy reads as its log does. What a copy lacks that was not described
/// when it was made is mended again.
fn copy_mended(mut mended: Log, mend: Mend, new: &Path) -> Result<Option<(ClosedLog, Log)>, NewLogError> {
    for _ in 0..MOST_MENDS {
        let Some(copy) = copy_whole(&mended, new)? else { return Ok(None) };
        let Ok(read) = copy.read() else { return Ok(None) };
        let is_whole = read.commits() == mended.commits() && read.last_commit() == mended.last_commit();
        if is_whole && read.problems().is_empty() {
            return Ok(Some((copy, mended)));
        }
        let Some(again) = mend(&read) else { return Ok(None) };
        mended = again;
    }
    Ok(None)
}

/// A copy of a log; `None` where MCAP takes no such log.
fn copy_whole(log: &Log, new: &Path) -> Result<Option<ClosedLog>, NewLogError> {
    let finished = log.completeness() == Completeness::Finished;
    let mut good = NewLog::begin(new, &log.library)?;
    for part in log.parts.iter().filter(|part| finished || part.kept != Kept::Finished) {
        match good.add(log, part, |_| true) {
            Err(NewLogError::Encode { .. }) => return Ok(None),
            added => added?,
        }
    }
    good.close(log.commits()).map(Some)
}

/// What a copy of a log lacks, which was read to its end; `pictures` were lost before its last portion.
fn outcome(log: &Log, pictures: Option<String>) -> RecoverOutcome {
    let (commits, later_commits) = (log.commits() as u64, log.later_commits().len() as u64);
    let finished = log.completeness() == Completeness::Finished;
    let loss = log.loss().filter(|_| !finished).map(ToString::to_string);
    let dropped = loss.as_ref().map_or(0, |_| log.file_len() - log.good_end());
    let lost_manifest = log.missed_manifests().next().map(|lost| log.lost_in_words(lost));
    let lost_manifest = lost_manifest.or(log.unused_manifest().map(|note| note.text.clone()));
    match loss.or(lost_manifest).or(pictures).or(log.lost_pictures()) {
        Some(why) => RecoverOutcome::Lossy { commits, dropped, later_commits, why },
        None => RecoverOutcome::Lossless { commits },
    }
}
