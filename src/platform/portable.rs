//! Systems that are no Unix: what only Unix has is left out, and nothing relies on it.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

/// Opens what has a name; a link of that name is refused.
pub(crate) fn open_itself(options: &OpenOptions, path: &Path) -> io::Result<File> {
    if path.symlink_metadata().is_ok_and(|metadata| metadata.is_symlink()) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is a link"));
    }
    options.open(path)
}

/// Whether an open file is the one that a name leads to, as far as their times of creation tell.
pub(crate) fn is_same(open: &Metadata, named: &Metadata) -> bool {
    open.created().ok() == named.created().ok()
}

/// Whether no name leads to an open file any more, which is not known here.
pub(crate) fn has_no_name(_: &Metadata) -> bool {
    false
}

/// Gives a file to whom another belongs: it belongs to whoever makes it here.
pub(crate) fn give_to_owner_of(_: &File, _: &Metadata) {}

/// A new file's permissions are those of its folder.
pub(crate) fn with_ordinary_permissions<'b, 'p, 's>(
    builder: &'b mut tempfile::Builder<'p, 's>,
) -> &'b mut tempfile::Builder<'p, 's> {
    builder
}

/// Number of bytes that this user may still write in a folder, which is not known here.
pub(crate) fn room_in(_: &Path) -> Option<u64> {
    None
}

/// Bytes of memory that are free for this process, which is not known here.
pub(crate) fn free_memory() -> Option<u64> {
    None
}

/// Makes the names in a folder durable, which the file system does by itself.
pub(crate) fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}

/// Fills a buffer with the bytes of a file from a place on.
pub(crate) fn read_exact_at(mut file: &File, buffer: &mut [u8], at: u64) -> io::Result<()> {
    file.seek(SeekFrom::Start(at))?;
    file.read_exact(buffer)
}

/// Whether a file system has no locks.
pub(crate) fn has_no_locks(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::Unsupported
}

/// Signals that ask for an end, of which a second one ends the process at once, and others that ask for it.
#[cfg(feature = "cli")]
pub(crate) mod signals {
    use signal_hook::consts::{SIGINT, SIGTERM};

    pub(crate) const STOP: &[i32] = &[SIGINT, SIGTERM];
    pub(crate) const STOP_BY_HAND: &[i32] = &[SIGINT];
    pub(crate) const ALSO_STOP: &[i32] = &[];
    pub(crate) const HANG_UP: Option<i32> = None;
    pub(crate) const FILE_TOO_LARGE: Option<i32> = None;
}
