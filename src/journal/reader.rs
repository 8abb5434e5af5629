//! A log read front to back: every record walked, every chunk opened, every commit compared with the one before it.
//!
//! A commit is good where its seal holds, its messages have the hashes that it names, and its chain hash follows from
//! the good commit before it. Whatever is not as it was written is listed as a problem. One that costs no commit (in an
//! index, or in a manifest) leaves the chain whole, and reading continues past it. One that costs a commit breaks the
//! chain: what follows is searched only to report what was lost.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::checkpoint::Checkpoint;
use super::format::{FORMAT_VERSION, PROFILE, VIEWERS_PROFILE};
use super::log::Log;
use super::scan::Scan;

/// Why a file is refused as a log.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file cannot be read.
    #[error("cannot read the log {path}")]
    Io {
        /// The file.
        path: String,
        /// The error of the operating system.
        #[source]
        source: std::io::Error,
    },
    /// Not even the header is there.
    #[error("the log has {bytes} bytes and no header to read: no stage is in it. Delete it and start the run again")]
    TooShort {
        /// Length of the file.
        bytes: u64,
    },
    /// The file is not an MCAP file.
    #[error("this is not a log: it does not begin like an MCAP file, and no commit of a run is in it")]
    NotMcap,
    /// An MCAP file of another program.
    #[error("this is a file for viewers, without states: the commands read the log that `foldline export` made it of")]
    ForViewers,
    /// An MCAP file of another program.
    #[error("this MCAP file was not written by foldline: its profile is {profile:?}, and no commit of a run is in it")]
    NotFoldline {
        /// Profile in its header.
        profile: String,
    },
    /// Written in a later layout.
    #[error("the log has layout {found}, and this program reads up to {FORMAT_VERSION}: use the version that wrote it")]
    NewerFormat {
        /// Version of its layout.
        found: u32,
    },
}

impl Log {
    /// Reads the log in a file. Takes the length of the file in memory, and a chunk more while reading.
    ///
    /// # Errors
    /// Where the file cannot be read or is not a log. A damaged log is no error: the good part of it is returned, and
    /// [`Log::completeness`] reports what is not.
    pub fn read(path: &Path) -> Result<Log, ReadError> {
        let mut bytes = Vec::new();
        let read = open_regular(path).and_then(|file| {
            let length = usize::try_from(file.metadata()?.len()).unwrap_or(usize::MAX);
            read_at(&file, 0, length, &mut bytes)
        });
        read.map_err(|source| ReadError::Io { path: path.display().to_string(), source })?;
        Log::from_bytes(bytes)
    }

    /// Reads a log from bytes in memory; see [`Log::read`].
    ///
    /// # Errors
    /// Where they are not a log.
    pub fn from_bytes(bytes: Vec<u8>) -> Result<Log, ReadError> {
        let mut scan = Scan::default();
        scan.run(&bytes, false);
        if let Some(found) = scan.newer_format {
            return Err(ReadError::NewerFormat { found });
        }
        let known = !scan.entries.is_empty() || scan.manifest_seen || !scan.later.is_empty();
        match &scan.header {
            _ if known => {}
            None if mcap::MAGIC.starts_with(&bytes[..bytes.len().min(mcap::MAGIC.len())]) => {
                return Err(ReadError::TooShort { bytes: bytes.len() as u64 });
            }
            Some((profile, _)) if profile == PROFILE => {}
            Some((profile, _)) if profile == VIEWERS_PROFILE => return Err(ReadError::ForViewers),
            Some((profile, _)) if bytes.starts_with(mcap::MAGIC) => {
                return Err(ReadError::NotFoldline { profile: profile.clone() });
            }
            _ => return Err(ReadError::NotMcap),
        }
        let file_len = bytes.len() as u64;
        Ok(Log { walked: bytes.len(), bytes, file_len, ..Log::of(scan) })
    }

    /// Reads `at_most` bytes of the first `file_len` of a log, from a commit in its middle on or from its start.
    pub(super) fn read_on(
        file: &File,
        file_len: u64,
        from: Option<&Checkpoint>,
        at_most: usize,
    ) -> std::io::Result<Log> {
        let base = from.map_or(0, |from| from.at);
        let mut bytes = Vec::new();
        read_at(
            file,
            base,
            at_most.min(usize::try_from(file_len.saturating_sub(base)).unwrap_or(usize::MAX)),
            &mut bytes,
        )?;
        let walked = bytes.len();
        let mut scan = from.map_or_else(Scan::default, Scan::from);
        let mut pieces = Vec::new();
        if let Some(from) = from {
            for (places, stored) in [(&mut scan.meshes, from.mesh.as_slice()), (&mut scan.fields, &from.fields)] {
                for (hash, at, piece) in stored {
                    places.insert(*hash, bytes.len()..bytes.len() + piece.len());
                    pieces.push((bytes.len(), *at));
                    bytes.extend_from_slice(piece);
                }
            }
        }
        scan.run(&bytes[..walked], base + (walked as u64) < file_len);
        let first = from.map_or(0, |from| from.ordinal as usize);
        let kept_before = from.and_then(|from| from.kept_before);
        Ok(Log { base, first, kept_before, walked, pieces, bytes, file_len, ..Log::of(scan) })
    }

    fn of(scan: Scan) -> Log {
        Log {
            base: 0,
            first: 0,
            kept_before: None,
            file_len: 0,
            walked: 0,
            pieces: Vec::new(),
            library: scan.header.map(|(_, library)| library).unwrap_or_default(),
            thinned: scan.thinned,
            stretches: scan.stretches,
            entries: scan.entries,
            meshes: scan.meshes,
            fields: scan.fields,
            parts: scan.parts,
            finished: scan.finished.is_some(),
            closed: scan.closed,
            good_end: scan.good_end,
            stretch_end: scan.stretch_end,
            problems: scan.problems,
            later: scan.later,
            notes: scan.notes,
            last_mesh: Default::default(),
            scenes: Default::default(),
            bytes: Vec::new(),
        }
    }
}

/// Opens a regular file: a pipe would hang, and a device never end.
pub(super) fn open_regular(path: &Path) -> std::io::Result<File> {
    if std::fs::metadata(path)?.is_file() {
        File::open(path)
    } else {
        Err(std::io::Error::new(std::io::ErrorKind::InvalidInput, "it is no regular file"))
    }
}

/// Appends `length` bytes of a file from `at` on to a buffer; fewer where the file ends before.
pub(super) fn read_at(file: &File, at: u64, length: usize, into: &mut Vec<u8>) -> std::io::Result<()> {
    use std::io::{Seek, SeekFrom};
    let mut file = file;
    file.seek(SeekFrom::Start(at))?;
    into.try_reserve_exact(length)?;
    file.take(length as u64).read_to_end(into).map(drop)
}
