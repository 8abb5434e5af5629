//! Files that are whole or not there, and never in another's place.
//!
//! A file is written without a name where the system has such files (`O_TMPFILE`, Linux): a process that is killed
//! leaves nothing of it. Elsewhere it is written under a name that nobody can guess. It gets its name in one step, by a
//! link, which the system refuses where anything has that name already.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::TempPath;

use crate::platform;

/// A file that has no name yet. If it is dropped, nothing of it remains. Everything is written at its end.
#[derive(Debug)]
pub(crate) struct WholeFile {
    file: File,
    /// Temporary path of the file, on systems that have no files without names.
    grows_at: Option<TempPath>,
}

impl WholeFile {
    /// Creates an empty file in the folder of `target`.
    ///
    /// # Errors
    /// Where no file can be created there.
    pub(crate) fn beside(target: &Path) -> io::Result<Self> {
        let folder = folder_of(target);
        if let Ok(file) = without_name(folder) {
            return Ok(Self { file, grows_at: None });
        }
        let mut named = named_as_nobody_guesses();
        let (file, path) = platform::with_ordinary_permissions(named.append(true)).tempfile_in(folder)?.into_parts();
        Ok(Self { file, grows_at: Some(path) })
    }

    /// File to write to.
    pub(crate) fn file(&self) -> &File {
        &self.file
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// Where something has that name already ([`io::ErrorKind::AlreadyExists`]), or the name cannot be given.
    pub(crate) fn give_name(self, target: &Path) -> io::Result<()> {
        let Some(path) = self.grows_at else { return link(&self.file, target) };
        match path.persist_noclobber(target) {
            Ok(()) => Ok(()),
            Err(failed) if failed.error.kind() == io::ErrorKind::AlreadyExists => Err(failed.error),
            // A file system that can neither link nor rename without replacing.
            Err(_) if target.symlink_metadata().is_ok() => Err(io::ErrorKind::AlreadyExists.into()),
            Err(failed) => Ok(failed.path.persist(target)?),
        }
    }

    /// Replaces whatever has the name `target`, if anything has, by the file. A symbolic link of that name is replaced,
    /// not followed. A process that is killed between the two calls that this takes leaves the whole file under a hidden name
    /// (`.foldline-….new`): no call replaces a file by one without a name.
    ///
    /// # Errors
    /// Where this fails; what was there then stays.
    pub(crate) fn replace(self, target: &Path) -> io::Result<()> {
        let path = match self.grows_at {
            Some(path) => path,
            None => {
                named_as_nobody_guesses().make_in(folder_of(target), |name| link(&self.file, name))?.into_temp_path()
            }
        };
        Ok(path.persist(target)?)
    }

    /// Syncs the file to disk, gives it its name, and syncs the name as well.
    ///
    /// # Errors
    /// Those of [`Self::give_name`], and where the disk fails.
    pub(crate) fn keep_as(self, target: &Path) -> io::Result<()> {
        self.file.sync_all()?;
        self.give_name(target)?;
        sync_folder_of(target)
    }
}

/// Writes a file, whole or not at all, and over no other.
///
/// # Errors
/// Where something has that name already ([`io::ErrorKind::AlreadyExists`]), or the file cannot be written.
pub(crate) fn write_new(target: &Path, content: &[u8]) -> io::Result<()> {
    let whole = WholeFile::beside(target)?;
    whole.file().write_all(content)?;
    whole.keep_as(target)
}

/// Makes the names in a file's folder durable.
pub(crate) fn sync_folder_of(path: &Path) -> io::Result<()> {
    platform::sync_folder(folder_of(path))
}

/// Number of bytes that this user may still write on the disk of a future file.
pub(crate) fn room_for(path: &Path) -> Option<u64> {
    platform::room_in(folder_of(path))
}

/// Says how much space is missing, where that is known: a quota or a limit on the size of files does not show.
pub(crate) fn shortage(wanted: u64, room: Option<u64>) -> String {
    match room {
        Some(room) if room < wanted => format!(" ({wanted} bytes more, where there is room for {room})"),
        _ => String::new(),
    }
}

/// Appends a suffix to the whole file name of a path.
pub(crate) fn beside(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    PathBuf::from(name)
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn named_as_nobody_guesses() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".foldline-").suffix(".new").rand_bytes(16);
    builder
}

#[cfg(all(target_os = "linux", not(foldline_portable)))]
fn without_name(folder: &Path) -> io::Result<File> {
    use rustix::fs::{Mode, OFlags};
    let flags = OFlags::TMPFILE | OFlags::RDWR | OFlags::APPEND | OFlags::CLOEXEC;
    let file = File::from(rustix::fs::open(folder, flags, Mode::from_raw_mode(platform::ORDINARY))?);
    // Its name comes by way of /proc, which need not be there.
    path_of_open(&file).symlink_metadata()?;
    Ok(file)
}

#[cfg(any(not(target_os = "linux"), foldline_portable))]
fn without_name(_: &Path) -> io::Result<File> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Gives a file without a name a name that nothing has.
#[cfg(all(target_os = "linux", not(foldline_portable)))]
fn link(file: &File, name: &Path) -> io::Result<()> {
    use rustix::fs::{AtFlags, CWD, linkat};
    Ok(linkat(CWD, path_of_open(file), CWD, name, AtFlags::SYMLINK_FOLLOW)?)
}

#[cfg(any(not(target_os = "linux"), foldline_portable))]
fn link(_: &File, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

#[cfg(all(target_os = "linux", not(foldline_portable)))]
fn path_of_open(file: &File) -> PathBuf {
    use std::os::fd::AsRawFd;
    PathBuf::from(format!("/proc/self/fd/{}", file.as_raw_fd()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let names = std::fs::read_dir(folder).unwrap();
        names.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    /// The file as it grows on systems with files without names and on others.
    fn both_ways(target: &Path) -> [WholeFile; 2] {
        let (file, path) = named_as_nobody_guesses().append(true).tempfile_in(folder_of(target)).unwrap().into_parts();
        [WholeFile::beside(target).unwrap(), WholeFile { file, grows_at: Some(path) }]
    }

    #[test]
    fn a_file_is_whole_or_not_there_and_over_no_other() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("a");
        for whole in both_ways(&target) {
            whole.file().write_all(b"all of it").unwrap();
            assert!(!target.exists());
            whole.keep_as(&target).unwrap();
            assert_eq!(std::fs::read(&target).unwrap(), b"all of it");
            assert_eq!(write_new(&target, b"other").unwrap_err().kind(), io::ErrorKind::AlreadyExists);
            assert_eq!(std::fs::read(&target).unwrap(), b"all of it");
            std::fs::remove_file(&target).unwrap();
        }
        for whole in both_ways(&target) {
            whole.file().write_all(b"half").unwrap();
        }
        assert_eq!(names(folder.path()), Vec::<String>::new());
    }

    #[test]
    fn a_link_is_replaced_and_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let (target, other) = (folder.path().join("a"), folder.path().join("other"));
        std::fs::write(&other, "another's").unwrap();
        for whole in both_ways(&target) {
            std::os::unix::fs::symlink(&other, &target).unwrap();
            whole.file().write_all(b"new").unwrap();
            whole.replace(&target).unwrap();
            assert!(target.symlink_metadata().unwrap().is_file());
            assert_eq!(std::fs::read(&other).unwrap(), b"another's");
            std::fs::remove_file(&target).unwrap();
        }
        // Not even a link to nothing is written through.
        std::os::unix::fs::symlink(folder.path().join("nothing"), &target).unwrap();
        assert_eq!(write_new(&target, b"new").unwrap_err().kind(), io::ErrorKind::AlreadyExists);
    }
}
