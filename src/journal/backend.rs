//! Where the bytes of a log go: a file, or what a test puts in its place.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;

/// Takes the bytes of a log, whole commits at a time.
pub trait Backend: Send {
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

    /// Takes off what a failed append may have left behind `length` bytes.
    ///
    /// # Errors
    /// Where it cannot; the reader then does it.
    fn cut(&mut self, length: u64) -> io::Result<()>;
}

/// A log in a file.
#[derive(Debug)]
pub struct FileBackend {
    file: File,
    path: PathBuf,
    /// The name that the file comes to with its first bytes.
    publish_as: Option<PathBuf>,
    /// The log that this file takes the place of, before the first byte is added to what was copied.
    replaces: Option<Replacement>,
    folder_synced: bool,
    /// Length that the file is cut to before the first byte is added.
    cut_first: Option<u64>,
}

/// A file on its way to taking another's place.
#[derive(Debug)]
struct Replacement {
    target: PathBuf,
    /// Forces the copy to disk while the run already goes on; a 40 MB log takes 70 ms and more for that.
    synced: Option<JoinHandle<io::Result<()>>>,
}

impl FileBackend {
    /// A new, empty file.
    ///
    /// # Errors
    /// Where there is one already ([`io::ErrorKind::AlreadyExists`]), or none can be made.
    pub fn create_new(path: &Path) -> io::Result<Self> {
        let file = OpenOptions::new().append(true).create_new(true).open(path)?;
        Ok(Self {
            file,
            path: path.to_owned(),
            publish_as: None,
            replaces: None,
            folder_synced: false,
            cut_first: None,
        })
    }

    /// A log that is gone on with in place: what lies behind its first `length` bytes is cut off before the first byte is
    /// added.
    ///
    /// # Errors
    /// Where the file cannot be opened.
    pub(super) fn behind(path: &Path, length: u64) -> io::Result<Self> {
        let file = OpenOptions::new().append(true).open(path)?;
        let path = path.to_owned();
        Ok(Self { file, path, publish_as: None, replaces: None, folder_synced: true, cut_first: Some(length) })
    }

    /// Cuts off what is not gone on with. That is durable before anything takes its place: half of the one and half of the other
    /// would be neither.
    fn cut_first(&mut self) -> io::Result<()> {
        let Some(length) = self.cut_first else { return Ok(()) };
        if self.file.metadata()?.len() != length {
            self.file.set_len(length)?;
            self.file.sync_all()?;
        }
        self.cut_first = None;
        Ok(())
    }

    /// The same, but the file has this name only from its first bytes on, so that no log is ever there without its
    /// manifest. A file of that name that comes to be meanwhile is not overwritten.
    pub(super) fn publish_as(mut self, target: &Path) -> Self {
        self.publish_as = Some(target.to_owned());
        self
    }

    fn publish(&mut self) -> io::Result<()> {
        let Some(target) = self.publish_as.take() else { return Ok(()) };
        match std::fs::hard_link(&self.path, &target) {
            Ok(()) => std::fs::remove_file(&self.path)?,
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => return Err(error),
            // A file system without links; the lock keeps others away.
            Err(_) => std::fs::rename(&self.path, &target)?,
        }
        self.path = target;
        Ok(())
    }

    /// Lets this file, once all of it is on disk, take the place of `target`, which lies in the same folder. Until
    /// then `target` stays as it is; that moment comes at the latest before the next byte is added.
    ///
    /// # Errors
    /// Where the file cannot be opened a second time.
    pub(super) fn replace(&mut self, target: &Path) -> io::Result<()> {
        let copy = self.file.try_clone()?;
        let synced = Some(std::thread::spawn(move || copy.sync_all()));
        self.replaces = Some(Replacement { target: target.to_owned(), synced });
        Ok(())
    }

    fn settle(&mut self) -> io::Result<()> {
        let Some(replacement) = &mut self.replaces else { return Ok(()) };
        if let Some(synced) = replacement.synced.take() {
            synced.join().unwrap_or_else(|_| Err(io::Error::other("the thread that synced the log died")))?;
        }
        // Where locks do not work, a rival may have put a copy of its own under this name.
        if !is_at(&self.file, &self.path) {
            return Err(io::Error::other(format!("{} is another's now", self.path.display())));
        }
        std::fs::rename(&self.path, &replacement.target)?;
        self.path = replacement.target.clone();
        self.replaces = None;
        self.sync_folder()
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
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.settle()?;
        self.cut_first()?;
        self.file.write_all(bytes)?;
        self.publish()
    }

    fn sync(&mut self) -> io::Result<()> {
        self.settle()?;
        self.file.sync_data()?;
        self.sync_folder()
    }

    fn cut(&mut self, length: u64) -> io::Result<()> {
        self.file.set_len(length)
    }
}

impl Drop for FileBackend {
    fn drop(&mut self) {
        if let Some(mut replacement) = self.replaces.take() {
            // Nothing was added: the log that was to be replaced has all that this copy has.
            if let Some(synced) = replacement.synced.take() {
                let _ = synced.join();
            }
            if is_at(&self.file, &self.path) {
                let _ = std::fs::remove_file(&self.path);
            }
        }
    }
}

/// Makes the names in a file's folder durable.
pub(super) fn sync_folder_of(path: &Path) -> io::Result<()> {
    // Only Unix lets a folder be opened and synced.
    #[cfg(unix)]
    {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        File::open(folder)?.sync_all()?;
    }
    let _ = path;
    Ok(())
}

/// Whether the open file is still the one that the path names; where that cannot be told, it is taken to be.
pub(super) fn is_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let (Ok(open), Ok(named)) = (file.metadata(), std::fs::metadata(path)) else { return false };
        (open.dev(), open.ino()) == (named.dev(), named.ino())
    }
    #[cfg(not(unix))]
    {
        let _ = (file, path);
        true
    }
}

/// A file under a temporary name in the folder of `path`, with the permissions of an ordinary new file.
pub(super) fn new_beside(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// The path with a suffix behind the whole file name.
pub(super) fn beside(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    PathBuf::from(name)
}
