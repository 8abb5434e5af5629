//! Where the bytes of a log go: a file, or what a test puts in its place.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;

use super::still_ours::{LogChanged, still_ours};
use crate::platform;
pub(super) use crate::whole_file::beside;
use crate::whole_file::{WholeFile, sync_folder_of};

/// A place to which the bytes of a log are written, whole commits at a time.
pub trait Backend: Send {
    /// Looks whether what was appended, `length` bytes with `commits` stages, is still where it went. Asked before
    /// every append; a place that nobody else can reach need not look.
    ///
    /// # Errors
    /// Where it is not: nothing must be appended then.
    fn check(&self, length: u64, commits: u64) -> Result<(), LogChanged> {
        let _ = (length, commits);
        Ok(())
    }

    /// Adds bytes at the end. Once this returns they outlive the process, though not a power cut.
    ///
    /// # Errors
    /// Where not all of them could be added; some of them may have been.
    fn append(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Forces what was appended to durable storage.
    ///
    /// # Errors
    /// Where it is not certain that all of it is there.
    fn sync(&mut self) -> io::Result<()>;

    /// Begins to force what was appended to durable storage, and continues meanwhile: it takes as long as several commits.
    ///
    /// # Errors
    /// Where that cannot be begun, or the one before has failed.
    fn sync_meanwhile(&mut self) -> io::Result<()> {
        self.sync()
    }

    /// Takes off what a failed append may have left behind `length` bytes.
    ///
    /// # Errors
    /// Where it cannot; the reader then does it.
    fn cut(&mut self, length: u64) -> io::Result<()>;
}

/// A backend that writes a log to a file.
#[derive(Debug)]
pub struct FileBackend {
    file: File,
    path: PathBuf,
    coming: Coming,
    folder_synced: bool,
    cut_first: Option<Cut>,
    /// Forces what was appended to disk.
    syncing: Option<Syncing>,
}

/// A thread that forces a file to disk.
type Syncing = JoinHandle<io::Result<()>>;

/// What goes before the first byte is added.
#[derive(Clone, Copy, Debug)]
struct Cut {
    /// Bytes that stay.
    length: u64,
    /// Bytes that the file had when it was read.
    found: u64,
}

/// How a file gets its name.
#[derive(Debug)]
enum Coming {
    /// It has its name.
    Named,
    /// With its first bytes, so that no log is ever there without its manifest.
    New(WholeFile),
    /// It is being copied from the log whose place it takes.
    Copy(WholeFile),
    /// It takes the place of a log before the first byte is added to what was copied.
    Replacing {
        copy: WholeFile,
        original: File,
        original_len: u64,
        /// Forces the copy to disk while the run already continues; a 40 MB log takes 70 ms and more for that.
        synced: Option<Syncing>,
    },
}

impl FileBackend {
    /// Creates an empty file, which takes the name `path` only with its first bytes. A file that appears under that
    /// name meanwhile is not overwritten.
    ///
    /// # Errors
    /// Where none can be made in that folder.
    pub fn create_new(path: &Path) -> io::Result<Self> {
        let whole = WholeFile::beside(path)?;
        let file = whole.file().try_clone()?;
        Ok(Self {
            file,
            path: path.to_owned(),
            coming: Coming::New(whole),
            folder_synced: false,
            cut_first: None,
            syncing: None,
        })
    }

    /// A log that is continued in place. Of the `found` bytes that it has, those behind the first `length` are cut off before
    /// the first byte is added.
    ///
    /// # Errors
    /// Where the file cannot be opened.
    pub(super) fn behind(path: &Path, length: u64, found: u64) -> io::Result<Self> {
        let file = OpenOptions::new().append(true).open(path)?;
        let cut_first = Some(Cut { length, found });
        Ok(Self { file, path: path.to_owned(), coming: Coming::Named, folder_synced: true, cut_first, syncing: None })
    }

    /// Cuts off what is not continued. That is durable before anything takes its place: half of the one and half of the other
    /// would be neither.
    fn cut_first(&mut self) -> io::Result<()> {
        if let Some(Cut { length, .. }) = self.cut_first.filter(|cut| cut.found != cut.length) {
            self.file.set_len(length)?;
            self.file.sync_all()?;
        }
        self.cut_first = None;
        Ok(())
    }

    /// A new, empty file in the folder of a log, for a copy of it that takes its place with [`Self::replace`].
    ///
    /// # Errors
    /// Where none can be made there.
    pub(super) fn copy_of(log: &Path) -> io::Result<Self> {
        let copy = WholeFile::beside(log)?;
        let file = copy.file().try_clone()?;
        Ok(Self {
            file,
            path: log.to_owned(),
            coming: Coming::Copy(copy),
            folder_synced: false,
            cut_first: None,
            syncing: None,
        })
    }

    /// Lets this copy, once all of it is on disk, take the place of the log, of whose `original_len` bytes it was made. Until then
    /// the log stays as it is; that moment comes at the latest before the next byte is added. The copy belongs to whom
    /// the log belongs to.
    ///
    /// # Errors
    /// Where the log or the copy cannot be opened a second time.
    pub(super) fn replace(&mut self, original_len: u64) -> io::Result<()> {
        let original = File::open(&self.path)?;
        let metadata = original.metadata()?;
        // Where only root could, the one who resumes has it from here on, as with any file that is written again.
        platform::give_to_owner_of(&self.file, &metadata);
        let _ = self.file.set_permissions(metadata.permissions());
        let file = self.file.try_clone()?;
        let synced = std::thread::Builder::new().spawn(move || file.sync_all());
        // Where no thread can be made, now.
        let synced = match synced {
            Ok(thread) => Some(thread),
            Err(_) => self.file.sync_all().map(|()| None)?,
        };
        self.coming = match std::mem::replace(&mut self.coming, Coming::Named) {
            Coming::New(copy) | Coming::Copy(copy) => Coming::Replacing { copy, original, original_len, synced },
            other => other,
        };
        Ok(())
    }

    fn settle(&mut self) -> io::Result<()> {
        if !matches!(self.coming, Coming::Replacing { .. }) {
            return Ok(());
        }
        if let Coming::Replacing { copy, synced, .. } = std::mem::replace(&mut self.coming, Coming::Named) {
            ended(synced)?;
            copy.replace(&self.path)?;
        }
        self.sync_folder()
    }

    fn publish(&mut self) -> io::Result<()> {
        if !matches!(self.coming, Coming::New(_)) {
            return Ok(());
        }
        match std::mem::replace(&mut self.coming, Coming::Named) {
            Coming::New(whole) => whole.give_name(&self.path),
            _ => Ok(()),
        }
    }

    /// Makes the file's name durable.
    fn sync_folder(&mut self) -> io::Result<()> {
        if !self.folder_synced {
            sync_folder_of(&self.path)?;
            self.folder_synced = true;
        }
        Ok(())
    }
}

impl Backend for FileBackend {
    fn check(&self, length: u64, commits: u64) -> Result<(), LogChanged> {
        match &self.coming {
            Coming::Named => {
                let length = self.cut_first.map_or(length, |cut| cut.found);
                still_ours(&self.file, &self.path, length, commits)
            }
            Coming::Replacing { original, original_len, .. } => {
                still_ours(original, &self.path, *original_len, commits)
            }
            // Nobody else can reach a file without a name.
            Coming::New(_) | Coming::Copy(_) => Ok(()),
        }
    }

    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.settle()?;
        self.cut_first()?;
        self.file.write_all(bytes)?;
        self.publish()
    }

    fn sync(&mut self) -> io::Result<()> {
        self.settle()?;
        ended(self.syncing.take())?;
        self.file.sync_data()?;
        self.sync_folder()
    }

    fn sync_meanwhile(&mut self) -> io::Result<()> {
        self.settle()?;
        ended(self.syncing.take())?;
        self.sync_folder()?;
        let file = self.file.try_clone()?;
        match std::thread::Builder::new().spawn(move || file.sync_data()) {
            Ok(thread) => self.syncing = Some(thread),
            Err(_) => self.file.sync_data()?,
        }
        Ok(())
    }

    fn cut(&mut self, length: u64) -> io::Result<()> {
        self.file.set_len(length)
    }
}

impl Drop for FileBackend {
    fn drop(&mut self) {
        let _ = ended(self.syncing.take());
        // Nothing was added: the log that was to be replaced has all that the copy has.
        if let Coming::Replacing { synced: Some(synced), .. } = std::mem::replace(&mut self.coming, Coming::Named) {
            let _ = synced.join();
        }
    }
}

/// How a sync ended.
fn ended(syncing: Option<Syncing>) -> io::Result<()> {
    let died = |_| Err(io::Error::other("the thread that synced the log died"));
    syncing.map_or(Ok(()), |thread| thread.join().unwrap_or_else(died))
}

/// Whether the open file is still the one that the path names; where that is not known, it is not.
pub(super) fn is_at(file: &File, path: &Path) -> bool {
    let (Ok(open), Ok(named)) = (file.metadata(), std::fs::symlink_metadata(path)) else { return false };
    platform::is_same(&open, &named)
}
