//! A log that was read: its stages, and their states when they are asked for.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use super::codec::{CodecError, decode_mesh, decode_state};
use super::damage::{Completeness, LaterCommit, Problem};
use super::manifest::Manifest;
use super::stretch::{LostManifest, Stretches};
use crate::pipeline::{Commit, Record};
use crate::state::{Hash, Mesh, State};

/// A stage in a log. Its bytes have the hashes that its commit names, and its commit follows from the one before it.
#[derive(Clone, Debug)]
pub struct Entry {
    /// What the stage said, where it stands, and how long it took.
    pub record: Record,
    /// Content hash of the mesh that its state stands on.
    pub mesh_hash: Hash,
    /// Content hash of the displacements that its state holds.
    pub(super) displacement_hash: Hash,
    /// Where its chunk lies in the log, bytes.
    pub bytes: Range<u64>,
    pub(super) state: Range<usize>,
    /// Place of its manifest among those of the log, where that is there.
    pub(super) stretch: Option<usize>,
    /// Whether its commit names the manifest, as from version 2 on.
    pub(super) names_stretch: bool,
}

/// Something worth telling that costs no commit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Where it is, bytes.
    pub at: u64,
    /// What it is.
    pub text: String,
}

/// Why a state of a log cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum StateError {
    /// No such stage.
    #[error("there is no stage {index} in this log: it holds {len}, counted from 0")]
    NoSuchStage {
        /// What was asked for.
        index: usize,
        /// Stages in the log.
        len: usize,
    },
    /// The bytes are as written, but what they hold is not what was committed.
    #[error("the state of commit {index} cannot be used")]
    Content {
        /// Ordinal of the commit.
        index: usize,
        /// Why.
        #[source]
        source: CodecError,
    },
}

/// What a good part of a log is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kept {
    Manifest,
    Commit,
    Finished,
}

/// A good part of a log: where it lies and what it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub at: usize,
    pub end: usize,
    pub kept: Kept,
}

/// What is good of a log. Holds the file in memory; states are decoded, and held against their hashes, when asked for.
#[derive(Debug)]
pub struct Log {
    pub(super) library: String,
    pub(super) stretches: Stretches,
    pub(super) entries: Vec<Entry>,
    pub(super) meshes: HashMap<Hash, Range<usize>>,
    pub(super) displacements: HashMap<Hash, Range<usize>>,
    pub(super) parts: Vec<Part>,
    pub(super) finished: bool,
    pub(super) closed: bool,
    pub(super) good_end: usize,
    pub(super) problems: Vec<Problem>,
    pub(super) later: Vec<LaterCommit>,
    pub(super) notes: Vec<Note>,
    pub(super) last_mesh: Mutex<Option<(Hash, Arc<Mesh>)>>,
    pub(super) bytes: Vec<u8>,
}

impl Log {
    /// The manifests of the run's stretches, in order; one that is damaged is not among them.
    pub fn manifests(&self) -> &[Manifest] {
        &self.stretches.manifests
    }

    /// The manifests that stage `index` may have been made under, likeliest first: the one that its commit names, if the log
    /// has it. Commits of version 1 name none.
    pub fn manifests_of(&self, index: usize) -> impl Iterator<Item = &Manifest> {
        let entry = self.entries.get(index);
        let named = entry.filter(|entry| entry.names_stretch).map(|entry| entry.stretch);
        let may = move |place: usize, manifest: &Manifest| match named {
            Some(stretch) => stretch == Some(place),
            None => manifest.first_ordinal <= index as u64,
        };
        let manifests = self.manifests().iter().enumerate().rev();
        manifests.filter(move |(place, manifest)| may(*place, manifest)).map(|(_, manifest)| manifest)
    }

    /// Manifests that are lost, in the order of the file.
    pub fn lost_manifests(&self) -> &[LostManifest] {
        &self.stretches.lost
    }

    /// Whether the last of them is behind the last good one: what the run last went on with is not known.
    pub fn last_manifest_is_lost(&self) -> bool {
        self.stretches.last_is_lost
    }

    /// The stages, in the order of the run; entry k has ordinal k.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The last good commit.
    pub fn last_commit(&self) -> Option<&Commit> {
        self.entries.last().map(|entry| &entry.record.commit)
    }

    /// What the log is worth.
    pub fn completeness(&self) -> Completeness {
        let at = self.good_end as u64;
        let dropped = self.bytes.len() as u64 - at;
        match self.loss() {
            _ if self.finished && self.later.is_empty() => Completeness::Finished,
            None => Completeness::Unfinished,
            Some(loss) if loss.damage.is_cut() && self.later.is_empty() => Completeness::Truncated { at, dropped },
            Some(_) => Completeness::Damaged { at, dropped, later_commits: self.later.len() as u64 },
        }
    }

    /// The problem that ends the good part; `None` where nothing behind it is lost. Problems that the chain of commits
    /// reaches across cost nothing.
    pub fn loss(&self) -> Option<&Problem> {
        self.problems.iter().find(|problem| problem.at >= self.good_end as u64)
    }

    /// All that is not as it was written, in the order of the file.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// Commits behind a loss: whole, and not used, because what they follow on is lost.
    pub fn later_commits(&self) -> &[LaterCommit] {
        &self.later
    }

    /// What is worth telling and costs no commit.
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// Where the good bytes end.
    pub fn good_end(&self) -> u64 {
        self.good_end as u64
    }

    /// Length of the file, bytes.
    pub fn file_len(&self) -> u64 {
        self.bytes.len() as u64
    }

    /// Bytes behind the good part that may be worth keeping; empty where they are only MCAP's summary.
    pub(super) fn tail(&self) -> &[u8] {
        if self.loss().is_some() { &self.bytes[self.good_end..] } else { &[] }
    }

    /// The state that stage `index` made. The mesh is shared with the state that was asked for before, where it is
    /// the same.
    ///
    /// # Errors
    /// Where there is no such stage, or where what the log holds is not what was committed.
    pub fn state(&self, index: usize) -> Result<State, StateError> {
        let Some(entry) = self.entries.get(index) else {
            return Err(StateError::NoSuchStage { index, len: self.entries.len() });
        };
        let mesh = self.mesh(index)?;
        let bytes = &self.bytes[entry.state.clone()];
        let displacement = |hash: Hash| self.displacements.get(&hash).map(|place| &self.bytes[place.clone()]);
        decode_state(bytes, displacement, mesh, entry.mesh_hash, entry.record.commit.state_hash)
            .map_err(|source| StateError::Content { index, source })
    }

    /// The mesh that the state of stage `index` stands on.
    ///
    /// # Errors
    /// Where there is no such stage, or where what the log holds is not what was committed.
    pub fn mesh(&self, index: usize) -> Result<Arc<Mesh>, StateError> {
        let len = self.entries.len();
        let hash = self.entries.get(index).ok_or(StateError::NoSuchStage { index, len })?.mesh_hash;
        let mut last = self.last_mesh.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((known, mesh)) = &*last
            && *known == hash
        {
            return Ok(mesh.clone());
        }
        let bytes = self.meshes.get(&hash).map_or(&[][..], |place| &self.bytes[place.clone()]);
        let mesh = decode_mesh(bytes, hash).map_err(|source| StateError::Content { index, source })?;
        let mesh = Arc::new(mesh);
        *last = Some((hash, mesh.clone()));
        Ok(mesh)
    }
}
