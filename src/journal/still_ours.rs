//! Whether a log that is being written is still the file that its name leads to, and as long as it was left.

use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::time::{Duration, Instant};

use crate::platform;

/// How long what fails for reasons that may pass is tried again: a file server that is busy, too many open files.
const PATIENCE: Duration = Duration::from_secs(30);

/// Between the first two tries; doubled until it is as long as [`LONGEST_PAUSE`].
const FIRST_PAUSE: Duration = Duration::from_millis(10);

/// Between two tries at most.
const LONGEST_PAUSE: Duration = Duration::from_secs(1);

/// Why a log is no longer the file that this process wrote.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LogChanged {
    /// It was removed.
    #[error("was removed while it was written, and its {} with it", stages(*.commits))]
    Removed {
        /// Stages that were in it.
        commits: u64,
    },
    /// It was moved to another name.
    #[error("was moved elsewhere while it was written; there it holds {}, and can be resumed", stages(*.commits))]
    Moved {
        /// Stages that are in it.
        commits: u64,
    },
    /// Another file has its name.
    #[error(
        "is another file than the one that was written, which was moved away or removed; this one is left as it is"
    )]
    Replaced,
    /// Something else has written to it, or cut it.
    #[error(
        "has {found} bytes where {expected} were written: something else writes to it or has cut it. `foldline verify` reports what is left"
    )]
    Length {
        /// Present length, bytes.
        found: u64,
        /// Bytes that it had when it was last written.
        expected: u64,
    },
    /// It cannot be found out.
    #[error("can no longer be accessed")]
    Unknown {
        /// The error of the operating system.
        #[source]
        source: io::Error,
    },
}

fn stages(commits: u64) -> String {
    if commits == 1 { "1 stage".to_owned() } else { format!("{commits} stages") }
}

/// Checks that `path` still leads to `file`, which had `length` bytes when it was last written, and `commits` stages.
pub(super) fn still_ours(file: &File, path: &Path, length: u64, commits: u64) -> Result<(), LogChanged> {
    let unknown = |source| LogChanged::Unknown { source };
    let ours = patiently(|| file.metadata()).map_err(unknown)?;
    let named = match patiently(|| fs::metadata(path)) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Err(if platform::has_no_name(&ours) {
                LogChanged::Removed { commits }
            } else {
                LogChanged::Moved { commits }
            });
        }
        named => named.map_err(unknown)?,
    };
    if !platform::is_same(&ours, &named) {
        return Err(LogChanged::Replaced);
    }
    if ours.len() != length {
        return Err(LogChanged::Length { found: ours.len(), expected: length });
    }
    Ok(())
}

/// Tries again for a while what fails, except where there is nothing of that name.
pub(super) fn patiently<T>(mut attempt: impl FnMut() -> io::Result<T>) -> io::Result<T> {
    let began = Instant::now();
    let mut pause = FIRST_PAUSE;
    loop {
        match attempt() {
            Err(error) if error.kind() != io::ErrorKind::NotFound && began.elapsed() < PATIENCE => {
                std::thread::sleep(pause);
                pause = (2 * pause).min(LONGEST_PAUSE);
            }
            outcome => return outcome,
        }
    }
}
