//! States and meshes as bytes: a version byte, then bincode (little endian, fixed-width integers, no maps).
//!
//! Each version has structs of its own, so that a change of [`State`] cannot change how old logs are read. Mesh and
//! displacements lie apart from the state and are named in it: the mesh by its content hash, the displacements by the
//! hash of their bytes. Nothing decoded leaves this file before its content
//! hash is what the commit says and [`soundness`](super::soundness) has passed it.

mod versions;

use std::borrow::Cow;
use std::sync::Arc;

use self::versions::{
    DisplacementV1, MeshV1, PathV3, RefinementV6, RejectionV1, StageV1, StateV1, StateV2, StateV3, StateV4, StateV5,
    StateV6,
};
use super::format::CHUNK_BYTES_LIMIT;
use super::soundness::{Flaw, check_mesh, check_on_mesh, check_state};
use crate::digest::extend_with_numbers;
use crate::scene::Stage;
use crate::state::{Course, DriveMemory, Hash, Mesh, Previous, Rejection, State, StepControl};
use serde::{Deserialize, Serialize};

/// The newest version that is written, in front of every state and mesh. A state is written in the oldest version that
/// holds it.
pub const CODEC_VERSION: u8 = 6;

/// Why bytes are not a state or a mesh that can be used.
#[derive(Debug, thiserror::Error)]
pub enum CodecError {
    /// No bytes at all.
    #[error("the message is empty")]
    Empty,
    /// Written by a later version of the program.
    #[error("the message has encoding version {found}, and this program reads up to {CODEC_VERSION}: use a newer one")]
    Version {
        /// Version in the message.
        found: u8,
    },
    /// A version that such messages never had.
    #[error("the message has encoding version {found}, and messages of its kind have {expected}")]
    OtherVersion {
        /// Version in the message.
        found: u8,
        /// Version of its kind.
        expected: u8,
    },
    /// Not what the encoding says.
    #[error("the message does not decode")]
    Decode(#[from] bincode::error::DecodeError),
    /// Too large, or a failure of the encoder.
    #[error("the state cannot be encoded")]
    Encode(#[from] bincode::error::EncodeError),
    /// Bytes left over after decoding.
    #[error("the message holds {total} bytes of which only {used} were used")]
    LeftOver {
        /// Bytes that decoding used.
        used: usize,
        /// Bytes of the message.
        total: usize,
    },
    /// The state names another mesh than the commit.
    #[error("the state stands on mesh {found}, and its commit says {expected}")]
    OtherMesh {
        /// Mesh that the commit names.
        expected: Hash,
        /// Mesh that the state names.
        found: Hash,
    },
    /// The state names displacements that the log does not hold.
    #[error("the state has displacements {hash}, which the log does not hold")]
    NoDisplacement {
        /// Hash of their bytes.
        hash: Hash,
    },
    /// Decoded, but not the content that was committed.
    #[error("the {what} hashes to {found}, and its commit says {expected}")]
    ContentHash {
        /// "state" or "mesh".
        what: &'static str,
        /// Hash in the commit.
        expected: Hash,
        /// Hash of what was decoded.
        found: Hash,
    },
    /// The content that was committed, but nothing that a run could go on from.
    #[error("the content is unusable")]
    Unsound(#[from] Flaw),
}

fn config() -> impl bincode::config::Config {
    bincode::config::standard().with_little_endian().with_fixed_int_encoding().with_limit::<CHUNK_BYTES_LIMIT>()
}

fn encode(version: u8, value: &impl Serialize) -> Result<Vec<u8>, CodecError> {
    let mut bytes = vec![version];
    bincode::serde::encode_into_std_write(value, &mut bytes, config())?;
    Ok(bytes)
}

/// What the bytes of a message of this version hold.
fn decode<T: for<'de> Deserialize<'de>>(version: u8, bytes: &[u8]) -> Result<T, CodecError> {
    match bytes {
        [] => Err(CodecError::Empty),
        [found, body @ ..] if *found == version => {
            let (value, used) = bincode::serde::decode_from_slice(body, config())?;
            if used == body.len() {
                Ok(value)
            } else {
                Err(CodecError::LeftOver { used: used + 1, total: bytes.len() })
            }
        }
        [found @ 1..=CODEC_VERSION, ..] => Err(CodecError::OtherVersion { found: *found, expected: version }),
        [found, ..] => Err(CodecError::Version { found: *found }),
    }
}

/// What [`encode`] makes of [`DisplacementV1`], in a tenth of the time: they are nearly all of most logs.
fn encode_displacements(displacements: [&[[f64; 3]]; 2]) -> Vec<u8> {
    let count: usize = displacements.iter().map(|vectors| vectors.len()).sum();
    let mut bytes = Vec::with_capacity(1 + 8 + size_of::<[f64; 3]>() * count);
    bytes.push(1);
    bytes.extend((count as u64).to_le_bytes());
    displacements.iter().for_each(|vectors| extend_with_numbers(&mut bytes, vectors.as_flattened()));
    bytes
}

/// A mesh as bytes.
///
/// # Errors
/// Where the mesh is unsound or larger than a log can hold.
pub fn encode_mesh(mesh: &Mesh) -> Result<Vec<u8>, CodecError> {
    check_mesh(mesh)?;
    encode(1, &MeshV1::of(mesh))
}

/// The mesh that the bytes hold, if its content hash is `expected` and it is sound.
///
/// # Errors
/// Where the bytes are anything else.
pub fn decode_mesh(bytes: &[u8], expected: Hash) -> Result<Mesh, CodecError> {
    let stored: MeshV1 = decode(1, bytes)?;
    let mesh = stored.into_mesh();
    let found = mesh.hash();
    if found != expected {
        return Err(CodecError::ContentHash { what: "mesh", expected, found });
    }
    check_mesh(&mesh)?;
    Ok(mesh)
}

/// A state as bytes, in two messages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EncodedState {
    /// The state, which names its mesh and its displacements by hash.
    pub state: Vec<u8>,
    /// The displacements.
    pub displacement: Vec<u8>,
    /// Hash of the bytes of the displacements.
    pub displacement_hash: Hash,
}

/// A state as bytes, without its mesh.
///
/// # Errors
/// Where the state is unsound or larger than a log can hold.
pub fn encode_state(state: &State) -> Result<EncodedState, CodecError> {
    check_mesh(&state.mesh)?;
    encode_state_on(state, state.mesh.hash())
}

/// The same where the hash of its mesh is known, and the mesh is sound.
pub(super) fn encode_state_on(state: &State, mesh: Hash) -> Result<EncodedState, CodecError> {
    check_on_mesh(state)?;
    let State {
        mesh: _,
        displacement,
        marked,
        refined,
        step,
        stage,
        parameter,
        turns,
        moment_n_mm,
        strain_energy_n_mm,
        negative_pivots,
        drive: DriveMemory { control: StepControl { halvings, jump_seen_at_deg, rejection }, course },
        largest_force_n,
        refinement,
    } = state;
    let (path, previous) = match course {
        Course::Unknown => (None, None),
        Course::Load(previous) => (None, Some(previous)),
        Course::Path(path) => (Some(path), None),
    };
    let (previous_displacement, previous_parameter) =
        previous.map(|Previous { displacement, parameter }| (&displacement[..], *parameter)).unzip();
    let displacement = encode_displacements([displacement, previous_displacement.unwrap_or(&[])]);
    let displacement_hash = blake3::hash(&displacement);
    let base = StateV1 {
        mesh: *mesh.as_bytes(),
        displacement: *displacement_hash.as_bytes(),
        marked: marked.each_ref().map(Cow::from),
        refined: refined.as_deref().map(MeshV1::of),
        step: *step,
        stage: stage.map(|stage| match stage {
            Stage::Solve => StageV1::Solve,
            Stage::EvaluateIndicators => StageV1::EvaluateIndicators,
            Stage::RefineKnots => StageV1::RefineKnots,
            Stage::ProjectDisplacements => StageV1::ProjectDisplacements,
            Stage::ReEquilibrate => StageV1::ReEquilibrate,
            Stage::SwitchBranch => StageV1::SwitchBranch,
        }),
        parameter: *parameter,
        moment_n_mm: *moment_n_mm,
        strain_energy_n_mm: *strain_energy_n_mm,
        negative_pivots: *negative_pivots,
        halvings: halvings.max(&0).unsigned_abs(),
        jump_seen_at_deg: *jump_seen_at_deg,
        rejection: rejection.map(|rejection| match rejection {
            Rejection::NoEquilibrium => RejectionV1::NoEquilibrium,
            Rejection::Jump => RejectionV1::Jump,
            Rejection::CriticalPoint => RejectionV1::CriticalPoint,
            Rejection::SharpTurn => RejectionV1::SharpTurn,
        }),
    };
    let has_path = path.is_some();
    let after = StateV3 { base, turns: Cow::from(turns), path: path.map(PathV3::of) };
    let doublings = halvings.min(&0).unsigned_abs();
    let state = if *largest_force_n != 0.0 || refinement.is_some() {
        let refinement = refinement.map(RefinementV6::of);
        let after = StateV5 { after, previous_parameter, doublings };
        encode(6, &StateV6 { after, largest_force_n: *largest_force_n, refinement })?
    } else if doublings > 0 {
        encode(5, &StateV5 { after, previous_parameter, doublings })?
    } else if let Some(previous_parameter) = previous_parameter {
        encode(4, &StateV4 { after, previous_parameter })?
    } else if has_path || *stage == Some(Stage::SwitchBranch) {
        encode(3, &after)?
    } else if !turns.is_empty() {
        encode(2, &StateV2 { base: after.base, turns: after.turns })?
    } else {
        encode(1, &after.base)?
    };
    Ok(EncodedState { state, displacement, displacement_hash })
}

/// The state that the bytes hold, if it stands on `mesh` (whose content hash is `mesh_hash`), its content hash is
/// `expected` and it is sound. `displacement` finds the bytes of displacements by their hash.
///
/// # Errors
/// Where the bytes are anything else.
pub fn decode_state<'a>(
    bytes: &[u8],
    displacement: impl FnOnce(Hash) -> Option<&'a [u8]>,
    mesh: Arc<Mesh>,
    mesh_hash: Hash,
    expected: Hash,
) -> Result<State, CodecError> {
    let fifth = |after| StateV6 { after, largest_force_n: 0.0, refinement: None };
    let third = |after| fifth(StateV5 { after, previous_parameter: None, doublings: 0 });
    let stored = match bytes.first() {
        Some(6) => decode(6, bytes)?,
        Some(5) => fifth(decode(5, bytes)?),
        Some(4) => {
            let StateV4 { after, previous_parameter } = decode(4, bytes)?;
            fifth(StateV5 { after, previous_parameter: Some(previous_parameter), doublings: 0 })
        }
        Some(3) => third(decode(3, bytes)?),
        Some(2) => {
            let StateV2 { base, turns } = decode(2, bytes)?;
            third(StateV3 { base, turns, path: None })
        }
        _ => third(StateV3 { base: decode(1, bytes)?, turns: Cow::default(), path: None }),
    };
    let StateV6 { after: StateV5 { after, previous_parameter, doublings }, largest_force_n, refinement } = stored;
    let StateV3 { base: stored, turns, path } = after;
    let found = Hash::from_bytes(stored.mesh);
    if found != mesh_hash {
        return Err(CodecError::OtherMesh { expected: mesh_hash, found });
    }
    let hash = Hash::from_bytes(stored.displacement);
    let DisplacementV1(displacement) = decode(1, displacement(hash).ok_or(CodecError::NoDisplacement { hash })?)?;
    let mut displacement = displacement.into_owned();
    let previous = previous_parameter.map(|parameter| {
        let own = displacement.len() / 2;
        Previous { displacement: displacement.split_off(own), parameter }
    });
    let course = match (path, previous) {
        (None, None) => Course::Unknown,
        (None, Some(previous)) => Course::Load(previous),
        (Some(path), None) => Course::Path(path.into_memory()),
        (Some(_), Some(_)) => return Err(Flaw::TwoCourses.into()),
    };
    let control = StepControl {
        // One of the two is 0; where a changed byte makes it another number, the hash sees it.
        halvings: stored.halvings.wrapping_sub(doublings).cast_signed(),
        jump_seen_at_deg: stored.jump_seen_at_deg,
        rejection: stored.rejection.map(|rejection| match rejection {
            RejectionV1::NoEquilibrium => Rejection::NoEquilibrium,
            RejectionV1::Jump => Rejection::Jump,
            RejectionV1::CriticalPoint => Rejection::CriticalPoint,
            RejectionV1::SharpTurn => Rejection::SharpTurn,
        }),
    };
    let state = State {
        mesh,
        displacement,
        marked: stored.marked.map(Cow::into_owned),
        refined: stored.refined.map(|mesh| Arc::new(mesh.into_mesh())),
        step: stored.step,
        stage: stored.stage.map(|stage| match stage {
            StageV1::Solve => Stage::Solve,
            StageV1::EvaluateIndicators => Stage::EvaluateIndicators,
            StageV1::RefineKnots => Stage::RefineKnots,
            StageV1::ProjectDisplacements => Stage::ProjectDisplacements,
            StageV1::ReEquilibrate => Stage::ReEquilibrate,
            StageV1::SwitchBranch => Stage::SwitchBranch,
        }),
        parameter: stored.parameter,
        turns: turns.into_owned(),
        moment_n_mm: stored.moment_n_mm,
        strain_energy_n_mm: stored.strain_energy_n_mm,
        negative_pivots: stored.negative_pivots,
        drive: DriveMemory { control, course },
        largest_force_n,
        refinement: refinement.map(RefinementV6::into_memory),
    };
    let found = state.hash();
    if found != expected {
        return Err(CodecError::ContentHash { what: "state", expected, found });
    }
    check_state(&state)?;
    Ok(state)
}

#[cfg(test)]
mod tests;
