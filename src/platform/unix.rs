//! Unix: files are known by device and number.

use std::fs::{File, Metadata, OpenOptions, Permissions};
use std::io;
use std::os::unix::fs::{FileExt, MetadataExt, OpenOptionsExt, PermissionsExt};
use std::path::Path;

use rustix::fs::OFlags;
use rustix::io::Errno;

/// Permissions of a new file before the umask: those of any file rather than of a secret one.
pub(crate) const ORDINARY: u32 = 0o666;

/// Opens what has a name itself, not what a link of that name leads to, and without waiting for a pipe.
pub(crate) fn open_itself(options: &OpenOptions, path: &Path) -> io::Result<File> {
    let flags = (OFlags::NOFOLLOW | OFlags::NONBLOCK).bits();
    options.clone().custom_flags(flags.cast_signed()).open(path)
}

/// Whether an open file is the one that a name leads to.
pub(crate) fn is_same(open: &Metadata, named: &Metadata) -> bool {
    (open.dev(), open.ino()) == (named.dev(), named.ino())
}

/// Whether no name leads to an open file any more.
pub(crate) fn has_no_name(open: &Metadata) -> bool {
    open.nlink() == 0
}

/// Gives a file to whom another belongs, as far as this user may.
pub(crate) fn give_to_owner_of(file: &File, other: &Metadata) {
    let _ = std::os::unix::fs::fchown(file, Some(other.uid()), Some(other.gid()));
}

/// A new file's permissions, where they can be chosen.
pub(crate) fn with_ordinary_permissions<'b, 'p, 's>(
    builder: &'b mut tempfile::Builder<'p, 's>,
) -> &'b mut tempfile::Builder<'p, 's> {
    builder.permissions(Permissions::from_mode(ORDINARY))
}

/// Number of bytes that this user may still write in a folder, where that is known.
pub(crate) fn room_in(folder: &Path) -> Option<u64> {
    let disk = rustix::fs::statvfs(folder).ok()?;
    Some(disk.f_bavail.saturating_mul(disk.f_frsize))
}

/// Bytes of memory that are free for this process, where that is known: what the machine has, or the limit of the group that it
/// belongs to leaves.
pub(crate) fn free_memory() -> Option<u64> {
    let known = std::fs::read_to_string("/proc/meminfo").ok()?;
    let available = known.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let of_machine = 1024 * available.trim().trim_end_matches("kB").trim().parse::<u64>().ok()?;
    Some(left_to_group().map_or(of_machine, |left| left.min(of_machine)))
}

/// What the limit of this process's control group (version 2) leaves, where it has one.
fn left_to_group() -> Option<u64> {
    let groups = std::fs::read_to_string("/proc/self/cgroup").ok()?;
    let group = groups.lines().find_map(|line| line.strip_prefix("0::"))?;
    let number = |file: &str| {
        let path = Path::new("/sys/fs/cgroup").join(group.trim_start_matches('/')).join(file);
        std::fs::read_to_string(path).ok()?.trim().parse::<u64>().ok()
    };
    Some(number("memory.max")?.saturating_sub(number("memory.current")?))
}

/// Makes the names in a folder durable.
pub(crate) fn sync_folder(folder: &Path) -> io::Result<()> {
    File::open(folder)?.sync_all()
}

/// Fills a buffer with the bytes of a file from a place on.
pub(crate) fn read_exact_at(file: &File, buffer: &mut [u8], at: u64) -> io::Result<()> {
    file.read_exact_at(buffer, at)
}

/// Whether a file system, or the server behind it, has no locks, as network ones may.
pub(crate) fn has_no_locks(error: &io::Error) -> bool {
    let errno = Errno::from_io_error(error);
    [Errno::NOTSUP, Errno::OPNOTSUPP, Errno::NOSYS, Errno::NOLCK].iter().any(|it| errno == Some(*it))
}

/// Signals that ask for an end, of which a second one ends the process at once, and others that ask for it.
#[cfg(feature = "cli")]
pub(crate) mod signals {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGXCPU, SIGXFSZ};

    pub(crate) const STOP: &[i32] = &[SIGINT, SIGTERM];
    /// The one of them that a hand at a keyboard sends.
    pub(crate) const STOP_BY_HAND: &[i32] = &[SIGINT];
    pub(crate) const ALSO_STOP: &[i32] = &[SIGHUP, SIGUSR1, SIGXCPU];
    /// The signal of a terminal that is closed, which `nohup` has a process ignore.
    pub(crate) const HANG_UP: Option<i32> = Some(SIGHUP);
    /// The signal of a file that grows beyond a limit.
    pub(crate) const FILE_TOO_LARGE: Option<i32> = Some(SIGXFSZ);
}
