//! A log read front to back: every record walked, every chunk opened, every commit held against the one before it.
//!
//! A commit is good where its seal holds, its messages have the hashes that it names, and its chain hash follows from
//! the good commit before it. Whatever is not as it was written is listed as a problem. One that costs no commit (in an
//! index, or in a manifest) leaves the chain whole, and reading goes on past it. One that costs a commit breaks the
//! chain: what stands behind it is looked through only to say what was lost.

use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::path::Path;

use mcap::records::Record as McapRecord;

use super::chunk::{self, Channels, CommitContent, Content};
use super::damage::{Damage, LaterCommit, Problem};
use super::format::{FORMAT_VERSION, MANIFEST, PROFILE};
use super::frame::{self, Cut, Frame, PREFIX_LEN, op};
use super::log::{Entry, Kept, Log, Note, Part};
use super::manifest::Manifest;
use super::message::FinishedMessage;
use super::stretch::Stretches;
use crate::pipeline::{Commit, Record};
use crate::state::Hash;

/// Problems that are listed one by one; a file of another kind under a log's name could have any number.
const PROBLEMS_LIMIT: usize = 1000;

/// Why a file is refused as a log.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file cannot be read.
    #[error("cannot read the log {path}")]
    Io {
        /// The file.
        path: String,
        /// What the system says.
        #[source]
        source: std::io::Error,
    },
    /// Not even the header is there.
    #[error("the log has {bytes} bytes and no header to read: no stage is in it. Delete it and start the run again")]
    TooShort {
        /// Length of the file.
        bytes: u64,
    },
    /// Not an MCAP file.
    #[error("this is not a log: it does not begin like an MCAP file, and no commit of a run is in it")]
    NotMcap,
    /// An MCAP file of another program.
    #[error("this MCAP file was not written by foldline: its profile is {profile:?}, and no commit of a run is in it")]
    NotFoldline {
        /// Profile in its header.
        profile: String,
    },
    /// Written in a later layout.
    #[error("the log has layout {found}, and this program reads up to {FORMAT_VERSION}: use the version that wrote it")]
    NewerFormat {
        /// Version of its layout.
        found: u32,
    },
}

impl Log {
    /// Reads the log in a file. Takes the length of the file in memory, and a chunk more while reading.
    ///
    /// # Errors
    /// Where the file cannot be read or is not a log. A damaged log is no error: what is good of it is returned, and
    /// [`Log::completeness`] says what is not.
    pub fn read(path: &Path) -> Result<Log, ReadError> {
        let bytes = std::fs::read(path).map_err(|source| ReadError::Io { path: path.display().to_string(), source })?;
        Log::from_bytes(bytes)
    }

    /// Reads the log that the bytes hold; see [`Log::read`].
    ///
    /// # Errors
    /// Where they are not a log.
    pub fn from_bytes(bytes: Vec<u8>) -> Result<Log, ReadError> {
        let mut scan = Scan::default();
        scan.run(&bytes);
        if let Some(found) = scan.newer_format {
            return Err(ReadError::NewerFormat { found });
        }
        let known = !scan.entries.is_empty() || scan.manifest_seen || !scan.later.is_empty();
        match &scan.header {
            _ if known => {}
            None if mcap::MAGIC.starts_with(&bytes[..bytes.len().min(mcap::MAGIC.len())]) => {
                return Err(ReadError::TooShort { bytes: bytes.len() as u64 });
            }
            Some((profile, _)) if profile == PROFILE => {}
            Some((profile, _)) if bytes.starts_with(mcap::MAGIC) => {
                return Err(ReadError::NotFoldline { profile: profile.clone() });
            }
            _ => return Err(ReadError::NotMcap),
        }
        Ok(Log {
            library: scan.header.map(|(_, library)| library).unwrap_or_default(),
            stretches: scan.stretches,
            entries: scan.entries,
            meshes: scan.meshes,
            displacements: scan.displacements,
            parts: scan.parts,
            finished: scan.finished.is_some(),
            closed: scan.closed,
            good_end: scan.good_end,
            problems: scan.problems,
            later: scan.later,
            notes: scan.notes,
            last_mesh: Default::default(),
            bytes,
        })
    }
}

/// Reading under way.
#[derive(Default)]
struct Scan {
    channels: Channels,
    header: Option<(String, String)>,
    stretches: Stretches,
    manifest_seen: bool,
    entries: Vec<Entry>,
    meshes: HashMap<Hash, Range<usize>>,
    displacements: HashMap<Hash, Range<usize>>,
    parts: Vec<Part>,
    finished: Option<FinishedMessage>,
    closed: bool,
    good_end: usize,
    problems: Vec<Problem>,
    later: Vec<LaterCommit>,
    later_seen: HashSet<u64>,
    notes: Vec<Note>,
    newer_format: Option<u32>,
}

impl Scan {
    fn run(&mut self, bytes: &[u8]) {
        if !bytes.starts_with(mcap::MAGIC) {
            self.notes.push(Note { at: 0, text: Damage::Magic.to_string() });
        }
        let mut at = mcap::MAGIC.len();
        self.good_end = at.min(bytes.len());
        while let Some(next) = frame::next(bytes, at) {
            let outcome = match &next {
                Ok(frame) => self.frame(bytes, frame),
                Err(Cut { claim: None, left }) => Err(Damage::CutPrefix { left: *left as u64 }),
                Err(Cut { claim: Some((opcode, claims)), left }) => {
                    let left = left.saturating_sub(PREFIX_LEN) as u64;
                    Err(Damage::CutRecord { opcode: *opcode, claims: *claims, left })
                }
            };
            let following = match (outcome, next) {
                (Ok(()), Ok(frame)) => {
                    if !self.has_lost() {
                        self.good_end = frame.body.end;
                    }
                    if self.closed { frame::find(bytes, frame.body.end) } else { Some(frame.body.end) }
                }
                (Err(damage), next) => {
                    let only_zeros = bytes[at..].iter().all(|byte| *byte == 0);
                    self.problem(
                        at,
                        if only_zeros { Damage::Zeros { left: (bytes.len() - at) as u64 } } else { damage },
                    );
                    // A chunk keeps its place even where its content is damaged; all else may have lost the step.
                    match next {
                        Ok(frame) if frame::chunk_records(bytes, &frame).is_some() => Some(frame.body.end),
                        found => {
                            let following = frame::find(bytes, at + 1);
                            if !only_zeros && !self.closed {
                                self.stretches.gap(at, &bytes[at..following.unwrap_or(bytes.len())], &found);
                            }
                            following
                        }
                    }
                }
                (Ok(()), Err(_)) => None,
            };
            match following {
                Some(following) => at = following,
                None => break,
            }
        }
        let good = self.entries.len() as u64;
        self.stretches.end(good);
        self.later.retain(|commit| commit.ordinal >= good);
    }

    /// Whether something behind the last good record is not as it was written.
    fn has_lost(&self) -> bool {
        self.problems.last().is_some_and(|problem| problem.at >= self.good_end as u64)
    }

    fn problem(&mut self, at: usize, damage: Damage) {
        // Beyond the limit the newest takes the place of the one before it, so that the last one is always there.
        self.problems.truncate(PROBLEMS_LIMIT - 1);
        self.problems.push(Problem { at: at as u64, damage });
    }

    fn frame(&mut self, bytes: &[u8], frame: &Frame) -> Result<(), Damage> {
        let body = &bytes[frame.body.clone()];
        let misplaced = || Err(Damage::Misplaced { opcode: frame.opcode, bytes: body.len() as u64 });
        let parse = || {
            let unreadable = |cause| Damage::Unreadable { opcode: frame.opcode, cause };
            frame::parse(frame.opcode, body).map_err(unreadable)
        };
        match frame.opcode {
            op::HEADER if frame.at == mcap::MAGIC.len() => {
                if let McapRecord::Header(header) = parse()? {
                    self.header = Some((header.profile, header.library));
                }
                Ok(())
            }
            op::METADATA => {
                if let McapRecord::Metadata(record) = parse()? {
                    self.metadata(frame, &record);
                }
                Ok(())
            }
            op::CHUNK => self.chunk(bytes, frame),
            op::MESSAGE_INDEX => match parse()? {
                McapRecord::MessageIndex(index) if body.len() == 2 + 4 + 16 * index.records.len() => Ok(()),
                _ => misplaced(),
            },
            op::DATA_END if body.len() == 4 => {
                self.closed = true;
                Ok(())
            }
            _ => misplaced(),
        }
    }

    fn metadata(&mut self, frame: &Frame, record: &mcap::records::Metadata) {
        match Manifest::from_record(record) {
            Ok((manifest, hash)) => {
                if manifest.format_version > FORMAT_VERSION {
                    self.newer_format = Some(manifest.format_version);
                }
                self.manifest_seen = true;
                // Behind a loss it speaks of commits that are not used.
                if manifest.first_ordinal == self.entries.len() as u64 {
                    self.parts.push(Part { at: frame.at, end: frame.body.end, kept: Kept::Manifest });
                    self.stretches.begin(manifest, hash);
                } else {
                    self.stretches.begin_later(frame.at, manifest, hash);
                }
            }
            Err(error) if record.name == MANIFEST => {
                self.stretches.suspect(frame.at);
                self.notes.push(Note { at: frame.at as u64, text: format!("{error}; it is left out") });
            }
            Err(_) => {
                let text = format!("metadata {:?} is not foldline's; it is left out", record.name);
                self.notes.push(Note { at: frame.at as u64, text });
            }
        }
    }

    /// Takes a chunk if it follows from what was taken before, whatever lies in between.
    fn chunk(&mut self, bytes: &[u8], frame: &Frame) -> Result<(), Damage> {
        let kept = match chunk::open(bytes, frame, &mut self.channels)? {
            Content::Commit(content) => {
                let (ordinal, stage, step) = (content.commit.ordinal, content.commit.stage, content.commit.step);
                let manifest = content.commit.manifest_hash.map(|hash| hash.0);
                if let Err(damage) = self.commit(frame, *content) {
                    self.stretches.of_later_commit(frame.at, manifest);
                    if self.later_seen.insert(ordinal) {
                        self.later.push(LaterCommit { at: frame.at as u64, ordinal, stage, step });
                    }
                    // Behind a loss it goes without saying that the chain is broken.
                    return if self.has_lost() { Ok(()) } else { Err(damage) };
                }
                Kept::Commit
            }
            Content::Finished(finished) => {
                let last = self.entries.last().map(|entry| entry.record.commit.chain_hash);
                let found = self.entries.len() as u64;
                if finished.commits != found || Some(finished.chain_hash.0) != last {
                    let damage = Damage::OtherEnd { claims: finished.commits, found };
                    return if self.has_lost() { Ok(()) } else { Err(damage) };
                }
                self.stretches.of_commit(frame.at, found, finished.manifest_hash.map(|hash| hash.0));
                self.finished = Some(finished);
                Kept::Finished
            }
        };
        self.good_end = frame.body.end;
        self.parts.push(Part { at: frame.at, end: frame.body.end, kept });
        Ok(())
    }

    /// Holds a commit against the one before it, and keeps it.
    fn commit(&mut self, frame: &Frame, content: CommitContent) -> Result<(), Damage> {
        if self.finished.is_some() {
            return Err(Damage::AfterEnd);
        }
        let previous = self.entries.last().map(|entry| entry.record.commit);
        let commit = content.commit.commit();
        let ordinal = commit.ordinal;
        let expected = previous.map_or(0, |previous| previous.ordinal + 1);
        if ordinal != expected {
            return Err(Damage::OutOfOrder { expected, found: ordinal });
        }
        let parent = previous.map_or(commit.parent_hash, |previous| previous.state_hash);
        if commit.parent_hash != parent {
            return Err(Damage::OtherParent { ordinal, expected: parent, found: commit.parent_hash });
        }
        let (stage, step, scene) = (commit.stage, commit.step, commit.scene_hash);
        let expected = Commit::next(previous.as_ref(), stage, step, scene, parent, commit.state_hash).chain_hash;
        if commit.chain_hash != expected {
            return Err(Damage::BrokenChain { ordinal, expected, found: commit.chain_hash });
        }
        let (mesh_hash, displacement) = (content.commit.mesh_hash.0, content.commit.displacement_hash.0);
        if content.mesh.is_none() && !self.meshes.contains_key(&mesh_hash) {
            return Err(Damage::UnknownMesh { mesh: mesh_hash });
        }
        if content.displacement.is_none() && !self.displacements.contains_key(&displacement) {
            return Err(Damage::UnknownDisplacement { displacement });
        }
        self.meshes.extend(content.mesh.map(|place| (mesh_hash, place)));
        self.displacements.extend(content.displacement.map(|place| (displacement, place)));
        let stretch = self.stretches.of_commit(frame.at, ordinal, content.commit.manifest_hash.map(|hash| hash.0));
        let names_stretch = content.commit.manifest_hash.is_some();
        let record = Record { wall_s: content.report.wall_s, report: content.report.report, commit };
        let bytes = frame.at as u64..frame.body.end as u64;
        self.entries.push(Entry {
            record,
            mesh_hash,
            displacement_hash: displacement,
            bytes,
            state: content.state,
            stretch,
            names_stretch,
        });
        Ok(())
    }
}
