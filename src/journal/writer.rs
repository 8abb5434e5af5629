//! The sink that keeps a run: every stage a commit, every commit one write.

use std::fmt;
use std::io;
use std::path::Path;
use std::time::{Duration, Instant};

use super::backend::{Backend, FileBackend, beside};
use super::codec::{EncodedField, EncodedState, encode_mesh, encode_state_on};
use super::encode_error::EncodeError;
use super::encoder::{Encoder, Parts};
use super::format::library;
use super::index_keeper::IndexKeeper;
use super::lock::LogLock;
use super::log::Log;
use super::manifest::Manifest;
use super::reader::{ReadError, open_regular};
use super::still_ours::LogChanged;
use super::topics::ViewerMessage;
use super::write_error::WriteError;
use crate::record::{Commit, Record, Sink, SinkError};
use crate::scene::SyncPolicy;
use crate::state::{Hash, MeshHash, State};
use crate::whole_file::room_for;

/// How often [`SyncPolicy::EachSecond`] forces the log to disk at most.
const SYNC_INTERVAL: Duration = Duration::from_secs(1);

/// A source of messages for viewers, made from each stage. They are stored in the stage's commit, but enter no hash of
/// a state or of the chain.
pub trait ViewerTopics: Send {
    /// The messages about this stage; none where it changed nothing to look at.
    fn messages(&mut self, state: &State, record: &Record) -> Vec<ViewerMessage>;
}

/// What a log has of a state.
#[derive(Debug, Default)]
pub(super) struct KnownPieces {
    pub mesh: Option<Hash>,
    pub fields: Vec<EncodedField>,
}

/// A writer of a run to a log, one commit for each stage. Dropped without [`JournalWriter::finish`] or
/// [`JournalWriter::close`] it leaves what a killed process leaves: every commit, and no summary.
pub struct JournalWriter {
    pub(super) encoder: Encoder,
    pub(super) backend: Box<dyn Backend>,
    /// Below the backend, so that it is given back only when that is through with the files.
    pub(super) lock: Option<LogLock>,
    /// The log's name in messages.
    pub(super) log: String,
    pub(super) sync: SyncPolicy,
    pub(super) viewer: Option<Box<dyn ViewerTopics>>,
    /// The index of a log that is or becomes long.
    pub(super) index: Option<IndexKeeper>,
    /// The mesh and the fields of the last state: what a stage does not change is not written again.
    pub(super) known: KnownPieces,
    pub(super) mesh_hash: MeshHash,
    pub(super) last: Option<Commit>,
    /// Bytes of the log that are good.
    pub(super) length: u64,
    pub(super) synced: Instant,
    pub(super) given_up: bool,
}

impl fmt::Debug for JournalWriter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("JournalWriter").field("log", &self.log).field("last", &self.last).finish_non_exhaustive()
    }
}

impl JournalWriter {
    /// Creates a log. An existing file is never touched.
    ///
    /// # Errors
    /// Where there is one, where another process writes it, or where it cannot be written.
    pub fn create(path: &Path, manifest: &Manifest, sync: SyncPolicy) -> Result<Self, WriteError> {
        let log = path.display().to_string();
        if path.symlink_metadata().is_ok() {
            return Err(if is_log(path) { WriteError::Exists { log } } else { WriteError::InTheWay { log } });
        }
        if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.is_dir()) {
            return Err(WriteError::NoFolder { folder: folder.display().to_string(), log });
        }
        let lock = LogLock::take(path)?;
        Self::begin(path, lock, manifest, sync)
    }

    /// Creates a log in place of a file that holds nothing, not even a header, as a power cut may leave it. Whether it
    /// does is checked again under the lock.
    ///
    /// # Errors
    /// As for [`Self::create`]; a file that holds more is left alone.
    pub fn create_over_empty(path: &Path, manifest: &Manifest, sync: SyncPolicy) -> Result<Self, WriteError> {
        let log = path.display().to_string();
        let begin = |source| WriteError::Io { action: "start", log: log.clone(), commits: 0, source };
        // Through links, as it was found to hold nothing.
        let path = path.canonicalize().map_err(begin)?;
        let lock = LogLock::take(&path)?;
        if !matches!(Log::read(&path), Err(ReadError::TooShort { .. })) {
            return Err(WriteError::Exists { log });
        }
        std::fs::remove_file(&path).map_err(begin)?;
        Self::begin(&path, lock, manifest, sync)
    }

    fn begin(path: &Path, lock: LogLock, manifest: &Manifest, sync: SyncPolicy) -> Result<Self, WriteError> {
        let log = path.display().to_string();
        let not_begun = |source| WriteError::NotBegun { log: log.clone(), source };
        let backend = FileBackend::create_new(path).map_err(not_begun)?;
        match Self::on(Box::new(backend), &log, manifest, sync) {
            Ok(writer) => {
                let index = Some(IndexKeeper::new(beside(path, ".index")));
                Ok(Self { lock: Some(lock), index, ..writer })
            }
            Err(WriteError::Io { source, .. }) if source.kind() == io::ErrorKind::AlreadyExists => {
                Err(WriteError::Exists { log })
            }
            Err(WriteError::DiskFull { wanted, room, source, .. }) => {
                Err(WriteError::NoRoom { log, wanted, room, source })
            }
            Err(WriteError::Io { source, .. }) => Err(not_begun(source)),
            Err(error) => Err(error),
        }
    }

    /// Creates a log on an empty backend; `log` is its name in messages. Takes no lock.
    ///
    /// # Errors
    /// Where the backend cannot be written.
    pub fn on(backend: Box<dyn Backend>, log: &str, manifest: &Manifest, sync: SyncPolicy) -> Result<Self, WriteError> {
        let encode = |source| WriteError::Encode { ordinal: 0, log: log.to_owned(), source };
        let encoder = Encoder::new(&library()).map_err(|source| encode(source.into()))?;
        let mut writer = Self::with(encoder, backend, log, sync);
        writer.encoder.manifest(manifest).map_err(encode)?;
        writer.append()?;
        Ok(writer)
    }

    /// A writer that has appended nothing, and holds no lock.
    pub(super) fn with(encoder: Encoder, backend: Box<dyn Backend>, log: &str, sync: SyncPolicy) -> Self {
        Self {
            encoder,
            backend,
            lock: None,
            log: log.to_owned(),
            sync,
            viewer: None,
            index: None,
            known: KnownPieces::default(),
            mesh_hash: MeshHash::default(),
            last: None,
            length: 0,
            synced: Instant::now(),
            given_up: false,
        }
    }

    /// Adds messages for viewers to every commit from here on.
    pub fn with_viewer(self, topics: Box<dyn ViewerTopics>) -> Self {
        Self { viewer: Some(topics), ..self }
    }

    /// The last commit in the log.
    pub fn last_commit(&self) -> Option<&Commit> {
        self.last.as_ref()
    }

    /// Length of the log so far, bytes.
    pub fn len(&self) -> u64 {
        self.length
    }

    /// Whether the log holds no commit.
    pub fn is_empty(&self) -> bool {
        self.last.is_none()
    }

    /// Whether the log is still the file that was written, as this writer left it.
    pub fn is_still_there(&self) -> bool {
        self.backend.check(self.length, self.commits()).is_ok()
    }

    /// Writes a stage: one commit, one write, and a sync where the policy demands it. The state is compared with the
    /// hash that the commit names.
    ///
    /// # Errors
    /// Where it could not be written. The log is good up to the last commit, and accepts no more stages.
    pub fn commit(&mut self, state: &State, record: &Record) -> Result<(), WriteError> {
        let found = state.hash_on(self.mesh_hash.of(&state.mesh));
        self.keep(state, record, found)
    }

    /// Ends the log of a run that reached its end with a record of that, MCAP's summary, and a sync. A log without
    /// commits gets no such record.
    ///
    /// # Errors
    /// Where it could not be written; the commits are kept.
    pub fn finish(mut self) -> Result<(), WriteError> {
        if let Some(last) = self.last {
            self.encoder.finished(&last).map_err(|source| self.encode_error(last.ordinal, source))?;
        }
        self.close()
    }

    /// Ends the log of a run that was stopped with MCAP's summary, so that viewers open it at once, and a sync. It can
    /// be resumed.
    ///
    /// # Errors
    /// Where it could not be written; the commits are kept.
    pub fn close(mut self) -> Result<(), WriteError> {
        if self.given_up {
            return Err(WriteError::GivenUp { log: self.log.clone(), commits: self.commits() });
        }
        // The record of the end, and the manifest of a stretch that has no stage.
        self.append()?;
        let (commits, length) = (self.commits(), self.length);
        let closed = self.encoder.close(commits, |piece| {
            self.length += piece.len() as u64;
            self.backend.append(&piece)
        });
        if let Err(source) = closed {
            let appended = self.length - length;
            self.length = length;
            self.take_back(appended);
            return Err(self.io_error("write", appended, source));
        }
        self.backend.sync().map_err(|source| self.io_error("sync", 0, source))?;
        self.check()
    }

    fn commits(&self) -> u64 {
        self.last.map_or(0, |last| last.ordinal + 1)
    }

    /// Keeps a stage whose state has this hash.
    fn keep(&mut self, state: &State, record: &Record, state_hash: Hash) -> Result<(), WriteError> {
        if self.given_up {
            return Err(WriteError::GivenUp { log: self.log.clone(), commits: self.commits() });
        }
        let kept = self.write(state, record, state_hash);
        self.given_up = kept.is_err();
        kept
    }

    fn write(&mut self, state: &State, record: &Record, state_hash: Hash) -> Result<(), WriteError> {
        let commit = &record.commit;
        let ordinal = commit.ordinal;
        let parent = self.last.map_or(commit.parent_hash, |last| last.state_hash);
        let (stage, step, scene) = (commit.stage, commit.step, commit.scene_hash);
        if *commit != Commit::next(self.last.as_ref(), stage, step, scene, parent, commit.state_hash) {
            return Err(WriteError::NotNext { found: ordinal, commits: self.commits(), log: self.log.clone() });
        }
        if state_hash != commit.state_hash {
            return Err(WriteError::StateHash { ordinal, expected: commit.state_hash, found: state_hash });
        }
        let mesh_hash = self.mesh_hash.of(&state.mesh);
        let viewer = self.viewer.as_mut().map(|topics| topics.messages(state, record)).unwrap_or_default();
        let encoded = (|| {
            let mesh = if self.known.mesh == Some(mesh_hash) { None } else { Some(encode_mesh(&state.mesh)?) };
            let known = &self.known.fields;
            let EncodedState { state, fields } = encode_state_on(state, mesh_hash, known)?;
            let (state, viewer) = (&state, &viewer);
            self.encoder.commit(&Parts { record, mesh_hash, mesh, state, fields: &fields, known, viewer })?;
            Ok(fields)
        })();
        let fields = encoded.map_err(|source| self.encode_error(ordinal, source))?;
        self.append()?;
        self.known = KnownPieces { mesh: Some(mesh_hash), fields };
        self.last = Some(*commit);
        let (encoder, place) = (&self.encoder, self.encoder.last_chunk());
        let mark = || encoder.mark(commit, mesh_hash, &self.known.fields);
        self.index = self.index.take().zip(place).and_then(|(index, place)| index.take(place, record, mark));
        match self.sync {
            SyncPolicy::EachStage => self.backend.sync(),
            SyncPolicy::EachSecond if self.synced.elapsed() >= SYNC_INTERVAL => {
                self.synced = Instant::now();
                self.backend.sync_meanwhile()
            }
            SyncPolicy::EachSecond | SyncPolicy::AtEnd => Ok(()),
        }
        .map_err(|source| self.io_error("sync", 0, source))
    }

    /// Hands on what the encoder has made, if the log is still ours.
    pub(super) fn append(&mut self) -> Result<(), WriteError> {
        self.check()?;
        let bytes = self.encoder.take();
        if let Err(source) = self.backend.append(&bytes) {
            self.take_back(bytes.len() as u64);
            return Err(self.io_error("write", bytes.len() as u64, source));
        }
        self.length += bytes.len() as u64;
        Ok(())
    }

    /// Looks whether the right to write is still held, and the log still the file that was written, as it was left.
    fn check(&self) -> Result<(), WriteError> {
        if let Some(lock) = &self.lock {
            lock.check()?;
        }
        let estranged = |estranged| WriteError::LogChanged { log: self.log.clone(), estranged };
        self.backend.check(self.length, self.commits()).map_err(estranged)
    }

    /// Takes off what a failed append left behind, which would only be dropped by the next reader; but nothing of another process
    /// that has come in meanwhile.
    fn take_back(&mut self, appended: u64) {
        let ours = match self.check() {
            Ok(()) => true,
            Err(WriteError::LogChanged { estranged: LogChanged::Length { found, .. }, .. }) => {
                (self.length..=self.length + appended).contains(&found)
            }
            Err(_) => false,
        };
        if ours {
            let _ = self.backend.cut(self.length);
        }
    }

    fn encode_error(&self, ordinal: u64, source: EncodeError) -> WriteError {
        WriteError::Encode { ordinal, log: self.log.clone(), source }
    }

    fn io_error(&self, action: &'static str, wanted: u64, source: io::Error) -> WriteError {
        let (log, commits) = (self.log.clone(), self.commits());
        match source.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                let room = room_for(Path::new(&log));
                WriteError::DiskFull { action, log, commits, wanted, room, source }
            }
            _ => WriteError::Io { action, log, commits, source },
        }
    }
}

impl Sink for JournalWriter {
    fn take(&mut self, state: &State, record: &Record) -> Result<(), SinkError> {
        // The loop has just hashed the state to make the commit: hashing it again would be a quarter of all that this costs.
        Ok(self.keep(state, record, record.commit.state_hash)?)
    }
}

/// Whether a file begins as MCAP files do.
fn is_log(path: &Path) -> bool {
    let mut head = [0; mcap::MAGIC.len()];
    let read = open_regular(path).and_then(|mut file| std::io::Read::read_exact(&mut file, &mut head));
    read.is_ok() && head == *mcap::MAGIC
}
