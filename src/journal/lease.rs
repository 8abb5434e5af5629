//! The lease on a log: a small file that names the process that may write it.
//!
//! It holds a random token, the process in words, and what distinguishes this process from all others of the machine: its boot,
//! its name space, its number and when it started. Leases appear whole, by a link or by renaming, so that no reader
//! meets half of one, and none is ever written through a link of that name.

use std::fs::{self, File, OpenOptions};
use std::hash::{BuildHasher, RandomState};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::manifest::host;
use super::still_ours::patiently;
use crate::platform::open_itself;
use crate::whole_file::{WholeFile, beside};

/// Room for a lease, bytes: it is read with every commit.
const USUAL: usize = 512;

/// A lease is far shorter, though it takes a block of this size on a disk; whatever is there instead is not read whole.
pub(super) const LONGEST: u64 = 4096;

/// Hexadecimal digits of a token.
const TOKEN: usize = 32;

/// A process that takes longer to clear a lease away was killed while doing so.
const LONGEST_CLEARING: Duration = Duration::from_secs(5);

/// Between two looks whether it is through.
const BETWEEN_LOOKS: Duration = Duration::from_millis(20);

/// There is a file of a lock's or lease's name that no run has put there.
pub(super) fn not_ours() -> io::Error {
    io::Error::other(
        "there is something else of that name, which is left alone: move it away, or write elsewhere with `-o OTHER`",
    )
}

/// A lease that this process wrote.
#[derive(Debug)]
pub(super) struct Lease {
    path: PathBuf,
    token: String,
}

/// Who has a lease.
#[derive(Debug)]
pub(super) struct Holder {
    token: String,
    /// The process, in words.
    pub(super) words: String,
    process: Option<String>,
}

impl Lease {
    /// Takes the lease from whoever has it: for the one who holds the system's lock, which shows that nobody else has it.
    pub(super) fn put(path: &Path) -> io::Result<Self> {
        let (lease, whole) = Self::new(path)?;
        if !may_be_replaced(path)? {
            return Err(not_ours());
        }
        whole.replace(path)?;
        Ok(lease)
    }

    /// Takes the lease if it is nobody's, or if its process is gone; of several who try at once, one gets it. For file systems
    /// without locks.
    pub(super) fn claim(path: &Path) -> io::Result<Result<Self, Holder>> {
        loop {
            let (lease, whole) = Self::new(path)?;
            match whole.give_name(path) {
                Ok(()) => return Ok(Ok(lease)),
                Err(error) if error.kind() != io::ErrorKind::AlreadyExists => return Err(error),
                Err(_) => {}
            }
            match holder(path)? {
                Some(holder) if holder.is_gone() => Self::clear(path, &holder)?,
                Some(holder) => return Ok(Err(holder)),
                None => {}
            }
        }
    }

    fn new(path: &Path) -> io::Result<(Self, WholeFile)> {
        let random = || RandomState::new().hash_one(std::process::id());
        let token = format!("{:016x}{:016x}", random(), random());
        let id = std::process::id();
        let process = process(id).unwrap_or_default();
        let whole = WholeFile::beside(path)?;
        whole.file().write_all(format!("{token}\nprocess {id} ({})\n{process}\n", host()).as_bytes())?;
        Ok((Self { path: path.to_owned(), token }, whole))
    }

    /// Takes the lease of a process that is gone out of the way. One process at a time does so, and looks again before: what a
    /// other process may have put there meanwhile stays.
    fn clear(path: &Path, gone: &Holder) -> io::Result<()> {
        let clearing = beside(path, ".clearing");
        let began = Instant::now();
        while let Err(error) = WholeFile::beside(path)?.give_name(&clearing) {
            if error.kind() != io::ErrorKind::AlreadyExists {
                return Err(error);
            }
            if began.elapsed() > LONGEST_CLEARING {
                let _ = fs::remove_file(&clearing);
            }
            std::thread::sleep(BETWEEN_LOOKS);
        }
        let cleared = match holder(path) {
            Ok(Some(holder)) if holder.token == gone.token => fs::remove_file(path),
            looked => looked.map(|_| ()),
        };
        let _ = fs::remove_file(&clearing);
        cleared
    }

    /// Path of the lease.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Who has the lease now, if it is another than this process; nobody where it is not there. What cannot be read is tried
    /// again for a while.
    pub(super) fn rival(&self) -> io::Result<Result<(), Option<Holder>>> {
        let holder = patiently(|| holder(&self.path))?;
        Ok(if holder.as_ref().is_some_and(|holder| holder.token == self.token) { Ok(()) } else { Err(holder) })
    }

    /// Whether it is there and this process's, at one look.
    pub(super) fn is_ours(&self) -> bool {
        holder(&self.path).is_ok_and(|holder| holder.is_some_and(|holder| holder.token == self.token))
    }
}

impl Holder {
    /// Whether its process is known to have ended. Of other machines nothing is known.
    fn is_gone(&self) -> bool {
        match (self.id_here(), &self.process) {
            (Some(id), then) => process(id) != *then,
            (None, Some(_)) => false,
            // What a power cut may leave.
            (None, None) => self.token.is_empty(),
        }
    }

    /// Whether its process is, or was, one of this machine's, so that its end can be known.
    pub(super) fn is_known_here(&self) -> bool {
        self.id_here().is_some()
    }

    /// The number of its process, where that means something here.
    fn id_here(&self) -> Option<u32> {
        let (boot, space) = machine()?;
        let [its_boot, its_space, id, _] = self.process.as_ref()?.split(' ').collect::<Vec<_>>()[..] else {
            return None;
        };
        (its_boot == boot && its_space == space).then(|| id.parse().ok())?
    }
}

/// Whether there is nothing of a lease's name, a lease, a link (which is replaced and not followed), or the empty file that a
/// power cut may leave of one.
fn may_be_replaced(path: &Path) -> io::Result<bool> {
    let metadata = match path.symlink_metadata() {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(true),
        metadata => metadata?,
    };
    if metadata.is_symlink() || metadata.is_file() && metadata.len() == 0 {
        return Ok(true);
    }
    let is_token = |token: &str| token.len() == TOKEN && token.bytes().all(|byte| byte.is_ascii_hexdigit());
    Ok(metadata.is_file() && holder(path)?.is_some_and(|holder| is_token(&holder.token)))
}

/// Who has a lease; `None` where there is none.
pub(super) fn holder(path: &Path) -> io::Result<Option<Holder>> {
    let file = match open_itself(OpenOptions::new().read(true), path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        file => file?,
    };
    let mut text = Vec::with_capacity(USUAL);
    File::take(file, LONGEST).read_to_end(&mut text)?;
    let text = String::from_utf8_lossy(&text);
    let mut lines = text.lines().map(str::to_owned);
    let token = lines.next().unwrap_or_default();
    let words = lines.next().unwrap_or_else(|| "another process".to_owned());
    Ok(Some(Holder { token, words, process: lines.next().filter(|line| !line.is_empty()) }))
}

/// The boot of this machine, and the space in which its processes are numbered; Linux only.
fn machine() -> Option<(String, String)> {
    let boot = fs::read_to_string("/proc/sys/kernel/random/boot_id").ok()?;
    let space = fs::read_link("/proc/self/ns/pid").ok()?;
    Some((boot.trim().to_owned(), space.display().to_string()))
}

/// What distinguishes a process that runs now from all others, ever; Linux only.
fn process(id: u32) -> Option<String> {
    let (boot, space) = machine()?;
    let status = fs::read_to_string(format!("/proc/{id}/stat")).ok()?;
    // The name of the program, in brackets, may hold anything; see proc_pid_stat(5).
    let mut fields = status.rsplit_once(')')?.1.split_whitespace();
    let state = fields.next()?;
    let start = fields.nth(18)?;
    (!matches!(state, "Z" | "X")).then(|| format!("{boot} {space} {id} {start}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lease_is_claimed_once_and_again_when_its_process_is_gone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lease");
        let first = Lease::claim(&path).unwrap().unwrap();
        let holder = Lease::claim(&path).unwrap().unwrap_err();
        assert!(holder.words.starts_with(&format!("process {}", std::process::id())), "{holder:?}");
        assert!(first.is_ours() && matches!(first.rival(), Ok(Ok(()))));

        let mut child = std::process::Command::new("true").spawn().unwrap();
        let id = child.id();
        let (boot, space) = machine().unwrap();
        child.wait().unwrap();
        for gone in [format!("{boot} {space} {id} 1"), format!("{boot} {space} {} 1", std::process::id())] {
            fs::write(&path, format!("token\nprocess {id} (here)\n{gone}\n")).unwrap();
            let second = Lease::claim(&path).unwrap().unwrap();
            assert!(matches!(first.rival(), Ok(Err(Some(_)))) && second.is_ours());
        }
        fs::write(&path, "").unwrap();
        assert!(Lease::claim(&path).unwrap().is_ok(), "an empty lease is nobody's");
        fs::write(&path, format!("token\nprocess {id} (there)\nanother-boot {space} {id} 1\n")).unwrap();
        assert_eq!(Lease::claim(&path).unwrap().unwrap_err().words, format!("process {id} (there)"));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left beside it");
    }
}
