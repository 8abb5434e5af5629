//! Which manifest every commit belongs to, and which manifests are lost.
//!
//! A log may lose a manifest and none of its commits: a manifest is a record of its own, outside the chunks. Commits from
//! version 2 on name theirs by its hash, so that its loss is known, and so that what cannot be read between two commits of
//! one stretch is known to have been none. In version 1, and behind the last commit, what cannot be read is taken for a
//! manifest where it holds a piece of one or has been zeroed.

use super::frame::op;
use super::manifest::{MANIFEST_LEN_AT_LEAST, Manifest, begins_with_same_scene, has_piece_of_manifest};
use crate::state::Hash;

/// A manifest that a log should hold and does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LostManifest {
    /// Where it was, or where its loss shows, bytes.
    pub at: u64,
    /// Ordinal of the first commit that it would describe.
    pub ordinal: u64,
    /// Manifests before it that are there.
    pub(super) before: usize,
}

/// The stretches of a log, as it is read front to back.
#[derive(Clone, Debug, Default)]
pub(super) struct Stretches {
    pub manifests: Vec<Manifest>,
    hashes: Vec<Hash>,
    pub lost: Vec<LostManifest>,
    /// Whether the manifest of the stretch that is being read is lost.
    pub last_is_lost: bool,
    /// A manifest that cannot be read and that the log ends in: no stage was run under it.
    pub unused: Option<u64>,
    /// Something that may have been a manifest, since the last one that was read.
    suspect: Option<u64>,
    /// Whether that was a manifest and nothing more: whole but for its content, or torn.
    suspect_is_alone: bool,
    /// Manifests that lie behind a loss of commits: whole, and about commits that are not used.
    later: Vec<(u64, Hash, String)>,
}

impl Stretches {
    /// Adds a manifest that follows on the commits before it.
    pub fn begin(&mut self, manifest: Manifest, hash: Hash) {
        self.manifests.push(manifest);
        self.hashes.push(hash);
        self.last_is_lost = false;
        self.suspect = None;
    }

    /// Hash of the manifest of the stretch that was read last.
    pub fn last_hash(&self) -> Option<Hash> {
        self.hashes.last().copied()
    }

    /// Adds a manifest before which commits are lost.
    pub fn begin_later(&mut self, at: u64, manifest: Manifest, hash: Hash) {
        self.later.push((at, hash, manifest.scene_text));
    }

    /// Notes that at `at`, a manifest may have been lost, together with other records.
    pub fn suspect(&mut self, at: u64) {
        self.suspect_is_alone = false;
        self.suspect.get_or_insert(at);
    }

    /// Notes that a damaged record at `at` was a manifest, and nothing else is lost with it.
    pub fn suspect_alone(&mut self, at: u64) {
        self.suspect_is_alone = self.suspect.is_none();
        self.suspect.get_or_insert(at);
    }

    /// Notes unreadable bytes from `at` on, between two records or up to the end of the file (`is_cut`), which may have
    /// been a manifest. A torn manifest of the scene that the run had before is none that is missed.
    pub fn gap(&mut self, at: u64, gap: &[u8], is_cut: bool) {
        let opcode = gap.first().copied();
        let torn = is_cut && opcode == Some(op::METADATA);
        if torn && begins_with_same_scene(gap) {
            return;
        }
        let large = gap.len() >= MANIFEST_LEN_AT_LEAST;
        let zeroed = || opcode != Some(op::CHUNK) && gap.windows(ZEROED).any(|window| window == [0; ZEROED]);
        if !torn && !(large && (has_piece_of_manifest(gap) || zeroed())) {
            return;
        }
        if zeroed() || has_piece_of_commit(gap) {
            self.suspect(at);
        } else {
            self.suspect_alone(at);
        }
    }

    /// Finds the stretch of a commit that names its manifest by `hash`, as from version 2 on; `None` where the manifest
    /// is lost.
    pub fn of_commit(&mut self, at: u64, ordinal: u64, hash: Option<Hash>) -> Option<usize> {
        let is_last = match hash {
            Some(hash) => self.hashes.last() == Some(&hash),
            None => self.suspect.is_none() && !self.last_is_lost,
        };
        match is_last {
            true => self.last_is_lost = false,
            false => self.lose(self.suspect.unwrap_or(at), ordinal),
        }
        self.suspect = None;
        self.manifests.len().checked_sub(1).filter(|_| is_last)
    }

    /// Adds a commit that follows a loss.
    pub fn of_later_commit(&mut self, at: u64, hash: Option<Hash>) {
        let known = |hash| self.hashes.last() == Some(&hash) || self.later.iter().any(|(_, later, _)| *later == hash);
        match hash {
            Some(hash) if known(hash) => self.suspect = None,
            Some(_) => self.suspect(at),
            None => {}
        }
    }

    /// Ends the stretches behind `commits` commits and the last damage. The log may end in the manifest of a stretch
    /// that has no stage.
    pub fn end(&mut self, commits: u64, last_problem: Option<u64>) {
        let ends_in_it = self.suspect.is_some_and(|at| last_problem.is_none_or(|last| last <= at));
        if ends_in_it && self.suspect_is_alone && self.later.is_empty() && !self.manifests.is_empty() {
            self.unused = self.suspect.take();
        }
        let scene = self.manifests.last().map(|manifest| &manifest.scene_text);
        let other = self.later.iter().find(|(_, _, text)| Some(text) != scene).map(|(at, _, _)| *at);
        if let Some(at) = self.suspect.take().or(other) {
            self.lose(at, commits);
        }
    }

    /// The stretches of the commits up to this one, in a log that has lost no manifest.
    pub fn up_to(&self, ordinal: u64) -> Self {
        let count = self.manifests.iter().take_while(|manifest| manifest.first_ordinal <= ordinal).count();
        let (manifests, hashes) = (self.manifests[..count].to_vec(), self.hashes[..count].to_vec());
        Self { manifests, hashes, ..Self::default() }
    }

    fn lose(&mut self, at: u64, ordinal: u64) {
        if !self.last_is_lost {
            self.lost.push(LostManifest { at, ordinal, before: self.manifests.len() });
        }
        self.last_is_lost = true;
    }
}

/// Whether bytes that cannot be read hold a piece of a commit or of a report, other than of their schemas.
fn has_piece_of_commit(bytes: &[u8]) -> bool {
    const ENTRY: &[u8] = b"\"chain_hash\":\"";
    bytes.windows(ENTRY.len()).any(|window| window == ENTRY)
}

/// Zeros in a row that may have been a manifest: a quarter of the smallest piece of a disk that is lost at once.
const ZEROED: usize = 128;
