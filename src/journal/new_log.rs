//! A log that is made of another: whole or not there.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use mcap::records::Metadata;

use super::encode_error::EncodeError;
use super::encoder::Encoder;
use super::frame;
use super::log::{Log, Part};
use super::reader::ReadError;
use crate::platform;
use crate::whole_file::WholeFile;

/// Bytes that are collected before they go to the new file.
pub(super) const BATCH_BYTES: usize = 1 << 20;

/// Why a new log cannot be made from another.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NewLogError {
    /// There is a file where it should go.
    #[error("{new} exists and is not overwritten: choose another name")]
    Exists {
        /// The new log.
        new: String,
    },
    /// It cannot be written.
    #[error("cannot write {new}; the log itself is as it was")]
    Write {
        /// The new log.
        new: String,
        /// The error of the operating system.
        #[source]
        source: io::Error,
    },
    /// MCAP refused a record of the log.
    #[error("cannot write {new} from the log, which is as it was")]
    Encode {
        /// The new log.
        new: String,
        /// The error of the encoder.
        #[source]
        source: EncodeError,
    },
}

/// A log that is being made. Dropped, it is as if it had never been.
pub(super) struct NewLog {
    target: PathBuf,
    file: WholeFile,
    encoder: Encoder,
    pending: usize,
}

impl NewLog {
    /// Creates a new log without commits, whose header names `library`.
    pub fn begin(target: &Path, library: &str) -> Result<Self, NewLogError> {
        // Asked again when it comes to its name; here it spares the work.
        if target.symlink_metadata().is_ok() {
            return Err(not_written(target)(io::ErrorKind::AlreadyExists.into()));
        }
        let file = WholeFile::beside(target).map_err(not_written(target))?;
        let encoder = Encoder::new(library).map_err(|source| refused(target)(source.into()))?;
        Ok(Self { target: target.to_owned(), file, encoder, pending: 0 })
    }

    /// Adds a part of the other log, except for messages whose data begins at an offset that `keeps` rejects.
    pub fn add(&mut self, log: &Log, part: &Part, keeps: impl Fn(usize) -> bool) -> Result<(), NewLogError> {
        let Some(Ok(record)) = frame::next(&log.bytes, part.at) else { return Ok(()) };
        let added = self.encoder.again_if(&log.bytes, &record, keeps);
        added.map_err(|source| refused(&self.target)(source.into()))?;
        self.pending += part.end - part.at;
        if self.pending >= BATCH_BYTES { self.write() } else { Ok(()) }
    }

    /// Adds a metadata record.
    pub fn metadata(&mut self, record: &Metadata) -> Result<(), NewLogError> {
        self.encoder.metadata(record).map_err(|source| refused(&self.target)(source.into()))
    }

    /// Ends the log with the summary that viewers need, gives it its name, and returns its length, bytes.
    pub fn finish(self, commits: usize) -> Result<u64, NewLogError> {
        self.close(commits)?.keep()
    }

    /// Ends the log with the summary that viewers need.
    pub fn close(mut self, commits: usize) -> Result<ClosedLog, NewLogError> {
        self.write()?;
        let Self { target, file, encoder, .. } = self;
        let closed = encoder.close(commits as u64, |piece| file.file().write_all(&piece));
        match closed {
            Ok(()) => Ok(ClosedLog { target, file }),
            Err(error) => Err(not_written(&target)(error)),
        }
    }

    fn write(&mut self) -> Result<(), NewLogError> {
        self.pending = 0;
        self.file.file().write_all(&self.encoder.take()).map_err(not_written(&self.target))
    }
}

/// A log that is made to its end and has no name yet. Dropped, it is as if it had never been.
pub(super) struct ClosedLog {
    target: PathBuf,
    file: WholeFile,
}

impl ClosedLog {
    /// Reads the new log back to check it.
    pub fn read(&self) -> Result<Log, ReadError> {
        let io = |source| ReadError::Io { path: self.target.display().to_string(), source };
        let file = self.file.file();
        let mut bytes = vec![0; file.metadata().map_err(io)?.len() as usize];
        platform::read_exact_at(file, &mut bytes, 0).map_err(io)?;
        Log::from_bytes(bytes)
    }

    /// Gives the new log its name and returns its length, bytes.
    pub fn keep(self) -> Result<u64, NewLogError> {
        let Self { target, file } = self;
        let kept = file.file().metadata().and_then(|metadata| file.keep_as(&target).map(|()| metadata.len()));
        kept.map_err(not_written(&target))
    }
}

fn not_written(target: &Path) -> impl Fn(io::Error) -> NewLogError {
    let new = target.display().to_string();
    move |source| match source.kind() {
        io::ErrorKind::AlreadyExists => NewLogError::Exists { new: new.clone() },
        _ => NewLogError::Write { new: new.clone(), source },
    }
}

fn refused(target: &Path) -> impl Fn(EncodeError) -> NewLogError {
    let new = target.display().to_string();
    move |source| NewLogError::Encode { new: new.clone(), source }
}
