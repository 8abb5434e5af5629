//! A stage's place in the chain of hashes, and all that is kept of it.

use crate::record::Report;
use crate::scene::Stage;
use crate::state::Hash;

/// The place of a stage in the run, and the hashes that bind it there; `chain_hash` depends on all commits before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Commit {
    /// 0 for the first stage of the run.
    pub ordinal: u64,
    /// The stage that ran.
    pub stage: Stage,
    /// Load step.
    pub step: u64,
    /// Hash of the state that the stage started from.
    pub parent_hash: Hash,
    /// Hash of the state that the stage made.
    pub state_hash: Hash,
    /// Hash of the parts of the scene that decide states.
    pub scene_hash: Hash,
    /// Hash of (chain so far, scene hash, stage, state hash).
    pub chain_hash: Hash,
}

impl Commit {
    /// Creates the commit that follows `previous`, or the first one of a run whose start state has the hash
    /// `parent_hash`.
    pub fn next(
        previous: Option<&Commit>,
        stage: Stage,
        step: u64,
        scene_hash: Hash,
        parent_hash: Hash,
        state_hash: Hash,
    ) -> Self {
        let mut hasher = blake3::Hasher::new();
        hasher.update(b"foldline chain");
        hasher.update(previous.map_or(parent_hash, |commit| commit.chain_hash).as_bytes());
        hasher.update(scene_hash.as_bytes());
        hasher.update(stage.name().as_bytes());
        hasher.update(state_hash.as_bytes());
        Self {
            ordinal: previous.map_or(0, |commit| commit.ordinal + 1),
            stage,
            step,
            parent_hash,
            state_hash,
            scene_hash,
            chain_hash: hasher.finalize(),
        }
    }
}

/// A finished stage as the loop hands it to sinks, and as `--json` prints it.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// The report of the stage.
    pub report: Report,
    /// Its place in the run.
    pub commit: Commit,
    /// Wall time of the stage, seconds; with the next the only number here that differs between equal runs.
    pub wall_s: f64,
    /// Wall time that it took the sink to keep the stage before, seconds; 0 for the first one of a process.
    pub kept_s: f64,
}
