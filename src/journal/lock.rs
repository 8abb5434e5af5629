//! One writer at a time, in two layers.
//!
//! The operating system's lock on `LOG.lock` goes with the process, however it ends: a stale lock cannot be. Where a
//! file system has no such locks, the lease in `LOG.lease` stands in: of several who claim it one gets it, and keeps it
//! while its process lives. Where locks seem to work and another machine does not see them, whoever comes takes the
//! lease over: a writer looks before every commit whether it is still its own, and stops where it is not, or where the file is
//! no longer the one of the length that it left. Under the system's lock a log is continued in place, and else in a copy
//! that takes its place.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use super::backend::{beside, is_at};
use super::lease::{LONGEST, Lease, holder, not_ours};
use crate::platform::{has_no_locks, open_itself};
use crate::printable::word;
use crate::whole_file::{room_for, shortage};

/// Why a process may not write a log, or may no longer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LockError {
    /// Another process writes this log.
    #[error("{log} is being written by {holder}: wait for it or stop it. Nothing was changed")]
    Busy {
        /// The log.
        log: String,
        /// Who has the lease.
        holder: String,
    },
    /// Another process may write this log; whether it still runs is not known here.
    #[error(
        "{log} is leased to {holder}, and nothing here shows whether that still runs: wait for it or stop it, or, if it is gone, \
         delete {lease}. Nothing was changed"
    )]
    Leased {
        /// The log.
        log: String,
        /// Who has the lease.
        holder: String,
        /// The lease.
        lease: String,
    },
    /// Another process has taken the log over.
    #[error(
        "{log} was taken over by {holder}: this run stops and adds nothing to it. What it had added before is kept, \
         unless the other began from an earlier stage"
    )]
    Lost {
        /// The log.
        log: String,
        /// Who has the lease now.
        holder: String,
    },
    /// The lease is gone.
    #[error(
        "{lease} is gone, which shows that this run may write {log}: its folder was moved or removed, or another run took the log over \
         and is done. This run stops; put the folder back, then `foldline resume {}`",
        word(log)
    )]
    Gone {
        /// The log.
        log: String,
        /// The lease.
        lease: String,
    },
    /// The lease can no longer be read.
    #[error(
        "{lease} can no longer be read, which shows whether this run may still write {log}: this run stops. When it can be read \
         again, `foldline resume {}`",
        word(log)
    )]
    Unreadable {
        /// The log.
        log: String,
        /// The lease.
        lease: String,
        /// The error of the operating system.
        #[source]
        source: io::Error,
    },
    /// The disk has no room for the lock or the lease.
    #[error("no space left for {path}{}, which keeps two runs from writing one log. Make space, then try again", shortage(LONGEST, *.room))]
    NoRoom {
        /// The file.
        path: String,
        /// Bytes that the disk has room for, where that is known.
        room: Option<u64>,
        /// The error of the operating system.
        #[source]
        source: io::Error,
    },
    /// The lock or the lease cannot be made.
    #[error("cannot make {path}, which keeps two runs from writing one log")]
    Io {
        /// The file.
        path: String,
        /// The error of the operating system.
        #[source]
        source: io::Error,
    },
}

/// The right to write one log, held until it is dropped.
#[derive(Debug)]
pub struct LogLock {
    log: PathBuf,
    lease: Lease,
    lock_path: PathBuf,
    /// Holds the lock as long as it is open.
    lock: File,
    /// Whether the system keeps others out, and not the lease alone.
    is_exclusive: bool,
}

impl LogLock {
    /// Acquires the right to write `log`, which need not exist.
    ///
    /// # Errors
    /// Where another process has it, or the files next to the log cannot be made.
    pub fn take(log: &Path) -> Result<Self, LockError> {
        let (lock_path, lease_path) = (beside(log, ".lock"), beside(log, ".lease"));
        let name = || log.display().to_string();
        let failed = |path: &Path, source: io::Error| match source.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                LockError::NoRoom { path: path.display().to_string(), room: room_for(path), source }
            }
            _ => LockError::Io { path: path.display().to_string(), source },
        };
        let (lock, is_locked) = loop {
            let lock = open_lock(&lock_path).map_err(|source| failed(&lock_path, source))?;
            let is_locked = match lock.try_lock() {
                Ok(()) => true,
                Err(TryLockError::WouldBlock) => {
                    let holder = holder(&lease_path).ok().flatten();
                    let holder = holder.map_or_else(|| "another process".to_owned(), |holder| holder.words);
                    return Err(LockError::Busy { log: name(), holder });
                }
                Err(TryLockError::Error(source)) if has_no_locks(&source) => false,
                Err(TryLockError::Error(source)) => return Err(failed(&lock_path, source)),
            };
            // The one before may have removed it between the opening and the locking.
            if is_at(&lock, &lock_path) {
                break (lock, is_locked);
            }
        };
        let lease = match is_locked {
            true => Lease::put(&lease_path).map(Ok),
            false => Lease::claim(&lease_path),
        };
        if lease.is_err() && is_locked {
            let _ = fs::remove_file(&lock_path);
        }
        let lease = match lease.map_err(|source| failed(&lease_path, source))? {
            Ok(lease) => lease,
            Err(holder) if holder.is_known_here() => {
                return Err(LockError::Busy { log: name(), holder: holder.words });
            }
            Err(holder) => {
                let lease = lease_path.display().to_string();
                return Err(LockError::Leased { log: name(), holder: holder.words, lease });
            }
        };
        Ok(Self { log: log.to_owned(), lease, lock_path, lock, is_exclusive: is_locked })
    }

    /// Whether the file system's lock keeps other processes out, and not the lease alone.
    pub fn is_exclusive(&self) -> bool {
        self.is_exclusive
    }

    /// Checks that the right is still held. A lease that cannot be read is tried again for a while.
    ///
    /// # Errors
    /// Where it is not.
    pub fn check(&self) -> Result<(), LockError> {
        let (log, lease) = (self.log.display().to_string(), self.lease.path().display().to_string());
        match self.lease.rival() {
            Ok(Ok(())) => Ok(()),
            Ok(Err(Some(rival))) => Err(LockError::Lost { log, holder: rival.words }),
            Ok(Err(None)) => Err(LockError::Gone { log, lease }),
            Err(source) => Err(LockError::Unreadable { log, lease, source }),
        }
    }
}

impl Drop for LogLock {
    fn drop(&mut self) {
        if !self.lease.is_ours() {
            return;
        }
        let _ = fs::remove_file(self.lease.path());
        if is_at(&self.lock, &self.lock_path) {
            let _ = fs::remove_file(&self.lock_path);
        }
    }
}

/// Opens the file that is locked; not through a link of that name, and without waiting for a pipe.
fn open_lock(path: &Path) -> io::Result<File> {
    let lock = open_itself(OpenOptions::new().write(true).create(true).truncate(false), path)?;
    let metadata = lock.metadata()?;
    // It is removed in the end, and somebody's file must not be.
    if !metadata.is_file() || metadata.len() > 0 {
        return Err(not_ours());
    }
    Ok(lock)
}
