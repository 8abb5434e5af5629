//! A log that was read: its stages, and their states when they are needed.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::codec::{CodecError, decode_mesh, decode_state};
use super::damage::{Completeness, Damage, LaterCommit, Problem};
use super::manifest::Manifest;
use super::soundness::check_made_by;
use super::stretch::{LostManifest, Stretches};
use crate::record::{Commit, Record};
use crate::scene::{Difference, Scene};
use crate::state::{Hash, Mesh, State};
use crate::units::count;

/// A stage of a log, with the place of its messages in the file. Their hashes are those that its commit names, and the
/// commit follows from the one before it.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The report of the stage, its place in the run, and how long it took.
    pub record: Record,
    /// Content hash of the mesh of its state.
    pub mesh_hash: Hash,
    /// Hashes of the bytes of its state's fields.
    pub(super) fields: Box<[Hash]>,
    /// Where its chunk lies in the log, bytes, with the packed one in front of it.
    pub bytes: Range<u64>,
    /// Where its state lies, if that was not thinned out.
    pub(super) state: Option<Range<usize>>,
    /// Place of its manifest among those of the log, where that is there.
    pub(super) stretch: Option<usize>,
    /// Whether its commit names the manifest, as from version 2 on.
    pub(super) names_stretch: bool,
}

/// A remark about something unusual in a log for which no commit is lost.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Offset in the file, bytes.
    pub at: u64,
    /// The remark.
    pub text: String,
}

/// Why a state of a log cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StateError {
    /// The run has no such stage.
    #[error("there is no stage {index} in this log: it holds {len}, counted from 0")]
    NoSuchStage {
        /// The number that was requested.
        index: usize,
        /// Number of stages of the run.
        len: usize,
    },
    /// The log was thinned and does not hold the state.
    #[error("the state of commit {index} is not in the log, which was thinned; {}", kept_before(*before))]
    NotKept {
        /// Ordinal of the commit.
        index: usize,
        /// The last commit before it that has its state.
        before: Option<usize>,
    },
    /// The bytes are as written, but what they hold is not what was committed.
    #[error("the state of commit {index} cannot be used")]
    Content {
        /// Ordinal of the commit.
        index: usize,
        /// The error of the decoder.
        #[source]
        source: CodecError,
    },
}

fn kept_before(before: Option<usize>) -> String {
    match before {
        Some(before) => format!("the last one before it is that of commit {before}, from which `foldline replay` goes"),
        None => "none before it is".to_owned(),
    }
}

/// What a good part of a log is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kept {
    Manifest,
    /// That the log was thinned.
    Marker,
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

/// The good part of a log, or the last stretch of it, held in memory. States are decoded, and compared with their
/// hashes, when they are read.
#[derive(Debug)]
pub struct Log {
    /// Place in the file of the first byte in memory.
    pub(super) base: u64,
    /// Stages before the first that was read.
    pub(super) first: usize,
    /// The last of those that has its state.
    pub(super) kept_before: Option<usize>,
    pub(super) file_len: u64,
    /// Bytes of the file in memory; what lies behind them are a mesh and fields from before.
    pub(super) walked: usize,
    /// Where those begin, in memory and in the file.
    pub(super) pieces: Vec<(usize, u64)>,
    pub(super) library: String,
    pub(super) thinned: Option<String>,
    pub(super) stretches: Stretches,
    pub(super) entries: Vec<Entry>,
    pub(super) meshes: HashMap<Hash, Range<usize>>,
    pub(super) fields: HashMap<Hash, Range<usize>>,
    pub(super) parts: Vec<Part>,
    pub(super) finished: bool,
    pub(super) closed: bool,
    pub(super) good_end: usize,
    pub(super) stretch_end: usize,
    pub(super) problems: Vec<Problem>,
    pub(super) later: Vec<LaterCommit>,
    pub(super) notes: Vec<Note>,
    pub(super) last_mesh: Mutex<Option<(Hash, Arc<Mesh>)>>,
    /// The scenes of the manifests, once a state was compared with them; `None` for one that does not read.
    pub(super) scenes: OnceLock<Vec<Option<Scene>>>,
    pub(super) bytes: Vec<u8>,
}

impl Log {
    /// The manifests of the run's stretches, in order; damaged ones are left out.
    pub fn manifests(&self) -> &[Manifest] {
        &self.stretches.manifests
    }

    /// The manifests that stage `index` may have been made under, likeliest first: the one that its commit names, if
    /// the log has it. Commits of version 1 name none.
    pub fn manifests_of(&self, index: usize) -> impl Iterator<Item = &Manifest> {
        let entry = self.entry(index);
        let named = entry.filter(|entry| entry.names_stretch).map(|entry| entry.stretch);
        let lost = self.lost_manifests().iter().rfind(|lost| lost.ordinal <= index as u64);
        let may = move |place: usize, manifest: &Manifest| match named {
            Some(Some(stretch)) => stretch == place,
            // One that was given again once it was lost.
            Some(None) => lost.is_some_and(|lost| place >= lost.before),
            None => manifest.first_ordinal <= index as u64,
        };
        let manifests = self.manifests().iter().enumerate().rev();
        manifests.filter(move |(place, manifest)| may(*place, manifest)).map(|(_, manifest)| manifest)
    }

    /// The changes of the scene between stretches: ordinal of the first stage of the later stretch, and every key that
    /// differs.
    pub fn scene_changes(&self) -> Vec<(u64, Vec<Difference>)> {
        let manifests = self.manifests();
        let ends = manifests.iter().skip(1).map(|next| next.first_ordinal).chain([u64::MAX]);
        // Those under which no stage was run changed nothing.
        let stretches = manifests.iter().zip(ends).filter(|(manifest, end)| manifest.first_ordinal < *end);
        let stretches: Vec<&Manifest> = stretches.map(|(manifest, _)| manifest).collect();
        let pairs = stretches.windows(2).filter(|pair| pair[0].scene_text != pair[1].scene_text);
        let changes = pairs.filter_map(|pair| {
            let [was, is] = [pair[0], pair[1]].map(|manifest| manifest.scene(&[]).ok());
            Some((pair[1].first_ordinal, was?.differences(&is?)))
        });
        changes.collect()
    }

    /// The manifests that are lost, in the order of the file.
    pub fn lost_manifests(&self) -> &[LostManifest] {
        &self.stretches.lost
    }

    /// The lost manifests that no later one makes up for: behind them the run was not continued with a scene that makes
    /// the same states.
    pub fn missed_manifests(&self) -> impl Iterator<Item = &LostManifest> {
        self.lost_manifests().iter().filter(|lost| {
            let behind = &self.manifests()[lost.before..];
            let end = behind.first().map_or(self.commits() as u64, |next| next.first_ordinal);
            // What is not in memory is not known to have the scene of another manifest.
            let is_known = lost.ordinal >= end || self.entry(lost.ordinal as usize).is_some();
            behind.is_empty() || !is_known || !self.stages_without_scene(lost).is_empty()
        })
    }

    /// A manifest that the log ends in, that cannot be read, and under which no stage was run.
    pub(super) fn unused_manifest(&self) -> Option<&Note> {
        let at = self.stretches.unused?;
        self.notes.iter().rfind(|note| note.at == at)
    }

    /// Whether the last lost manifest lies behind the last good one, so that the scene that the run was last continued
    /// with is not known.
    pub fn last_manifest_is_lost(&self) -> bool {
        self.stretches.last_is_lost
    }

    /// The stages that were read, in the order of the run; entry k has ordinal [`Log::first`] + k.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Ordinal of the first stage that was read: 0, unless only the last part of a long log was.
    pub fn first(&self) -> usize {
        self.first
    }

    /// Number of stages of the run, whether they were read or not.
    pub fn commits(&self) -> usize {
        self.first + self.entries.len()
    }

    /// The entry of stage `index` of the run, if it was read.
    pub fn entry(&self, index: usize) -> Option<&Entry> {
        self.entries.get(index.checked_sub(self.first)?)
    }

    /// The last good commit of the log.
    pub fn last_commit(&self) -> Option<&Commit> {
        self.entries.last().map(|entry| &entry.record.commit)
    }

    /// How complete the log is.
    pub fn completeness(&self) -> Completeness {
        let at = self.good_end();
        let dropped = self.file_len - at;
        match self.loss() {
            _ if self.finished && self.later.is_empty() => Completeness::Finished,
            None => Completeness::Unfinished,
            Some(loss) if loss.damage.is_cut() && self.later.is_empty() => Completeness::Truncated { at, dropped },
            Some(_) => Completeness::Damaged { at, dropped, later_commits: self.later.len() as u64 },
        }
    }

    /// The problem that ends the good part; `None` where nothing behind it is lost. Problems that the chain of commits
    /// reaches across lose nothing.
    pub fn loss(&self) -> Option<&Problem> {
        self.problems.iter().find(|problem| problem.at >= self.good_end())
    }

    /// All places where the file is not as it was written, in the order of the file.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// Stages of which viewers are no longer shown what they were, in words; `None` where none is known.
    pub fn lost_pictures(&self) -> Option<String> {
        let lost = self.problems.iter().filter(|problem| matches!(problem.damage, Damage::LoosePacked)).count();
        (lost > 0).then(|| {
            format!(
                "what viewers are shown of {} is damaged and left out; the states are there: `foldline export LOG --to mcap` draws them again",
                count(lost, "stage")
            )
        })
    }

    /// The whole commits behind a loss, which are not used because the commits before them are lost.
    pub fn later_commits(&self) -> &[LaterCommit] {
        &self.later
    }

    /// The remarks about things in the log that lose no commit.
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// Where bytes in memory lie in the file.
    pub(super) fn place_of(&self, place: &Range<usize>) -> Option<u64> {
        if place.end <= self.walked {
            return Some(self.base + place.start as u64);
        }
        self.pieces.iter().find(|(start, _)| *start == place.start).map(|(_, at)| *at)
    }

    /// Offset at which the good part of the file ends, bytes.
    pub fn good_end(&self) -> u64 {
        self.base + self.good_end as u64
    }

    /// Length of the file, bytes.
    pub fn file_len(&self) -> u64 {
        self.file_len
    }

    /// Whether the last byte of the file was read.
    pub(super) fn reaches_end(&self) -> bool {
        self.base + self.walked as u64 >= self.file_len
    }

    /// Whether every byte up to the end of the good part is as it was written, and no manifest is lost: a run may continue right
    /// behind it.
    pub(super) fn is_clean(&self) -> bool {
        let good_end = self.good_end();
        self.problems.iter().all(|problem| problem.at >= good_end)
            && self.notes.is_empty()
            && self.lost_manifests().is_empty()
    }

    /// Whether MCAP's summary, which viewers need, is complete: a process may be killed while it writes the summary.
    pub fn has_summary(&self) -> bool {
        self.closed && self.bytes.ends_with(mcap::MAGIC)
    }

    /// Bytes behind the good part that may be worth keeping; empty where they are only MCAP's summary.
    pub(super) fn tail(&self) -> &[u8] {
        let unused = self.stretches.unused.map(|at| (at - self.base) as usize);
        match unused.or(self.loss().map(|_| self.good_end)) {
            Some(from) => &self.bytes[from.min(self.good_end)..self.walked],
            None => &[],
        }
    }

    /// Whether the log holds the state that stage `index` made; a thinned log lacks some.
    pub fn keeps_state(&self, index: usize) -> bool {
        self.entry(index).is_some_and(|entry| entry.state.is_some())
    }

    /// The last stage before stage `index` whose state the log holds.
    pub fn kept_before(&self, index: usize) -> Option<usize> {
        (self.first..index).rev().find(|before| self.keeps_state(*before)).or(self.kept_before)
    }

    /// Which states a thinned log holds, in the words with which it was thinned; `None` for any other log.
    pub fn thinned(&self) -> Option<&str> {
        self.thinned.as_deref()
    }

    /// Reads the state that stage `index` made. The mesh is shared with the state that was read before, where it is the
    /// same.
    ///
    /// # Errors
    /// Where there is no such stage, or where what the log holds is not what was committed.
    pub fn state(&self, index: usize) -> Result<State, StateError> {
        let Some(entry) = self.entry(index) else {
            return Err(StateError::NoSuchStage { index, len: self.commits() });
        };
        let Some(place) = entry.state.clone() else {
            return Err(StateError::NotKept { index, before: self.kept_before(index) });
        };
        let mesh = self.mesh(index)?;
        let bytes = &self.bytes[place];
        let field = |hash: Hash| self.field(&hash);
        let state = decode_state(bytes, field, mesh, entry.mesh_hash, entry.record.commit.state_hash);
        let unusable = |source| StateError::Content { index, source };
        let state = state.map_err(unusable)?;
        check_made_by(&state, &self.scenes_up_to(entry.stretch)).map_err(|flaw| unusable(flaw.into()))?;
        Ok(state)
    }

    /// The bytes of a field.
    pub(super) fn field(&self, hash: &Hash) -> Option<&[u8]> {
        self.fields.get(hash).map(|place| &self.bytes[place.clone()])
    }

    /// The scenes of the stretches up to this one; none where its own is not known.
    fn scenes_up_to(&self, stretch: Option<usize>) -> Vec<&Scene> {
        let scenes = self.scenes.get_or_init(|| self.manifests().iter().map(|it| it.scene(&[]).ok()).collect());
        match stretch.and_then(|stretch| scenes.get(..=stretch)) {
            Some([before @ .., Some(own)]) => before.iter().flatten().chain([own]).collect(),
            _ => Vec::new(),
        }
    }

    /// Reads the mesh of the state that stage `index` made.
    ///
    /// # Errors
    /// Where there is no such stage, or where what the log holds is not what was committed.
    pub fn mesh(&self, index: usize) -> Result<Arc<Mesh>, StateError> {
        let len = self.commits();
        let hash = self.entry(index).ok_or(StateError::NoSuchStage { index, len })?.mesh_hash;
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
