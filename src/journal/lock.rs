//! One writer at a time, in two layers.
//!
//! The operating system's lock on `LOG.lock` goes with the process, however it ends: a stale lock cannot be. Where a
//! file system does not honour such locks, the lease in `LOG.lease` stands in: whoever comes writes a random token,
//! and a writer looks before every commit whether the token is still its own. The one that has lost it stops. It could
//! not do harm even between the look and the write: where there is only the lease, whoever takes a log over copies it to a new
//! file, and the loser only ever writes to the old one. Under the system's lock a log is gone on with in place.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::hash::{BuildHasher, RandomState};
use std::io;
use std::path::{Path, PathBuf};

use super::backend::{beside, is_at};

/// Why a log cannot be written, or no longer.
#[derive(Debug, thiserror::Error)]
pub enum LockError {
    /// Another process writes this log.
    #[error("{log} is being written by {holder}: wait for it or stop it. Nothing was changed")]
    Busy {
        /// The log.
        log: String,
        /// Who has the lease.
        holder: String,
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
    /// The lease is not there any more.
    #[error(
        "{lease} is gone, which says that this run may write {log}: its folder was moved or removed, or another run took the log over \
         and is done. This run stops; put the folder back, then `foldline resume {log}`"
    )]
    Gone {
        /// The log.
        log: String,
        /// The lease.
        lease: String,
    },
    /// The lock or the lease cannot be made.
    #[error("cannot make {path}, which keeps two runs from writing one log")]
    Io {
        /// The file.
        path: String,
        /// What the system says.
        #[source]
        source: io::Error,
    },
}

/// The right to write one log, held until it is dropped.
#[derive(Debug)]
pub struct LogLock {
    log: PathBuf,
    lease: PathBuf,
    token: String,
    lock_path: PathBuf,
    /// Holds the lock as long as it is open.
    lock: File,
    /// Whether the system keeps others out, and not the lease alone.
    is_exclusive: bool,
}

impl LogLock {
    /// Takes the right to write `log`, which need not exist.
    ///
    /// # Errors
    /// Where another process has it, or the files beside the log cannot be made.
    pub fn take(log: &Path) -> Result<Self, LockError> {
        let (lock_path, lease) = (beside(log, ".lock"), beside(log, ".lease"));
        let failed = |path: &Path, source| LockError::Io { path: path.display().to_string(), source };
        let (lock, is_exclusive) = loop {
            let mut is_exclusive = true;
            let lock = OpenOptions::new().write(true).create(true).truncate(false).open(&lock_path);
            let lock = lock.map_err(|source| failed(&lock_path, source))?;
            match lock.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    return Err(LockError::Busy { log: log.display().to_string(), holder: holder(&lease) });
                }
                // A file system without locks: the lease alone has to do.
                Err(TryLockError::Error(source)) if source.kind() == io::ErrorKind::Unsupported => is_exclusive = false,
                Err(TryLockError::Error(source)) => return Err(failed(&lock_path, source)),
            }
            if is_at(&lock, &lock_path) {
                break (lock, is_exclusive);
            }
        };
        let random = || RandomState::new().hash_one(std::process::id());
        let token = format!("{:016x}{:016x}", random(), random());
        let text = format!("{token}\nprocess {} ({})\n", std::process::id(), super::manifest::host());
        fs::write(&lease, text).map_err(|source| failed(&lease, source))?;
        Ok(Self { log: log.to_owned(), lease, token, lock_path, lock, is_exclusive })
    }

    /// Whether no other process can have the right at the same time.
    pub fn is_exclusive(&self) -> bool {
        self.is_exclusive
    }

    /// Looks whether the right is still held.
    ///
    /// # Errors
    /// Where it is not.
    pub fn check(&self) -> Result<(), LockError> {
        if self.holds() {
            return Ok(());
        }
        let log = self.log.display().to_string();
        if !self.lease.exists() {
            return Err(LockError::Gone { log, lease: self.lease.display().to_string() });
        }
        Err(LockError::Lost { log, holder: holder(&self.lease) })
    }

    fn holds(&self) -> bool {
        fs::read_to_string(&self.lease).is_ok_and(|text| text.lines().next() == Some(self.token.as_str()))
    }
}

impl Drop for LogLock {
    fn drop(&mut self) {
        if self.holds() && is_at(&self.lock, &self.lock_path) {
            let _ = fs::remove_file(&self.lease);
            // Only where the next one can tell that the file it locked has gone.
            if cfg!(unix) {
                let _ = fs::remove_file(&self.lock_path);
            }
        }
    }
}

/// Who has the lease, in words.
fn holder(lease: &Path) -> String {
    let text = fs::read_to_string(lease).unwrap_or_default();
    text.lines().nth(1).map_or_else(|| "another process".to_owned(), str::to_owned)
}
