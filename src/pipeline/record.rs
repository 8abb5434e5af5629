//! What is said about a stage: its report (a function of model and state) and its place in the chain of hashes.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::Stage;
use crate::state::Hash;

/// What a stage reports beside the state that it made. Pure: holds no clock and no host.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Report {
    /// Load step, from 1.
    pub step: u64,
    /// The stage that ran.
    pub stage: Stage,
    /// Whether the stage did what it set out to do; a solve that was turned down leaves the state where it was.
    pub outcome: Outcome,
    /// Rotation of each end in the state, degrees.
    pub rotation_deg: f64,
    /// Rotation that the stage worked at; differs from `rotation_deg` where a solve was turned down, degrees.
    pub attempted_rotation_deg: f64,
    /// End moment, N·mm.
    pub moment_n_mm: f64,
    /// Strain energy of the whole shell, N·mm.
    pub strain_energy_n_mm: f64,
    /// Elements (along the length, along the arc) of the model.
    pub elements: [usize; 2],
    /// Free unknowns of the model.
    pub unknowns: usize,
    /// Newton iterations.
    pub iterations: usize,
    /// Numeric factorizations.
    pub factorizations: usize,
    /// Negative pivots of the tangent stiffness at the state; 0 where it is a stable equilibrium.
    pub negative_pivots: u64,
    /// |residual| / |reactions| at the end of the stage.
    pub residual: f64,
    /// Energy that a jump released in this stage, N·mm; 0 where nothing jumped.
    pub energy_released_n_mm: f64,
    /// Whether the shell jumped in this stage.
    pub jumped: bool,
    /// Knot spans marked each way (evaluate-indicators).
    pub marked: [usize; 2],
    /// Largest indicator max|κ|h each way (evaluate-indicators), dimensionless.
    pub largest_indicator: [f64; 2],
}

/// How a stage ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// The stage did its work.
    Done,
    /// Solve: the increment jumped and will be halved until the jump is located.
    RejectedJump,
    /// Solve: no equilibrium was found; the increment will be halved.
    RejectedNoEquilibrium,
}

/// A stage's place in the run. `chain_hash` binds it to everything before it.
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
    /// The commit that follows `previous` (or opens the run on the state that hashes to `parent_hash`).
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
    /// What the stage said.
    pub report: Report,
    /// Where it stands in the run.
    pub commit: Commit,
    /// Wall time of the stage, seconds; the only number here that differs between equal runs.
    pub wall_s: f64,
}
