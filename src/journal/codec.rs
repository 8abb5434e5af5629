//! States and meshes as bytes: a version byte, then bincode (little endian, fixed-width integers, no maps).
//!
//! Each version has structs of its own, so that a change of [`State`] cannot change how old logs are read. Mesh and
//! displacements lie apart from the state and are named in it: the mesh by its content hash, the displacements by the
//! hash of their bytes. Nothing decoded leaves this file before its content
//! hash is what the commit says and [`soundness`](super::soundness) has passed it.

use std::borrow::Cow;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::format::CHUNK_BYTES_LIMIT;
use super::soundness::{Flaw, check_mesh, check_on_mesh, check_state};
use crate::digest::extend_with_numbers;
use crate::scene::Stage;
use crate::state::{
    Course, CriticalAhead, DriveMemory, Hash, Mesh, PathMemory, Previous, Refinement, Rejection, State, StepControl,
};

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

#[derive(Serialize, Deserialize)]
struct MeshV1<'a> {
    degree: [u64; 2],
    knots: [Cow<'a, [f64]>; 2],
    control_points: Cow<'a, [[f64; 4]]>,
}

impl<'a> MeshV1<'a> {
    fn of(mesh: &'a Mesh) -> Self {
        Self {
            degree: mesh.degree.map(|degree| degree as u64),
            knots: [0, 1].map(|way| Cow::from(&mesh.knots[way])),
            control_points: Cow::from(&mesh.control_points),
        }
    }

    fn into_mesh(self) -> Mesh {
        Mesh {
            degree: self.degree.map(|degree| usize::try_from(degree).unwrap_or(usize::MAX)),
            knots: self.knots.map(Cow::into_owned),
            control_points: self.control_points.into_owned(),
        }
    }
}

#[derive(Serialize, Deserialize)]
struct DisplacementV1<'a>(Cow<'a, [[f64; 3]]>);

#[derive(Serialize, Deserialize)]
struct StateV1<'a> {
    mesh: [u8; 32],
    displacement: [u8; 32],
    marked: [Cow<'a, [f64]>; 2],
    refined: Option<MeshV1<'a>>,
    step: u64,
    stage: Option<StageV1>,
    parameter: f64,
    moment_n_mm: f64,
    strain_energy_n_mm: f64,
    negative_pivots: u64,
    /// 0 where the increment has grown instead.
    halvings: u32,
    jump_seen_at_deg: Option<f64>,
    rejection: Option<RejectionV1>,
}

/// Version 2: rigid sections that turn freely. Written only where there are any.
#[derive(Serialize, Deserialize)]
struct StateV2<'a> {
    base: StateV1<'a>,
    turns: Cow<'a, [[f64; 3]]>,
}

/// Version 3: continuation by arc length, and what came with it. Written only where there is any of that.
#[derive(Serialize, Deserialize)]
struct StateV3<'a> {
    base: StateV1<'a>,
    turns: Cow<'a, [[f64; 3]]>,
    path: Option<PathV3<'a>>,
}

/// Version 4: the equilibrium before. Its displacements stand behind the state's own, so that stages that change neither
/// write neither again.
#[derive(Serialize, Deserialize)]
struct StateV4<'a> {
    after: StateV3<'a>,
    previous_parameter: f64,
}

/// Version 5: an increment that has grown. Written only where it has.
#[derive(Serialize, Deserialize)]
struct StateV5<'a> {
    after: StateV3<'a>,
    previous_parameter: Option<f64>,
    doublings: u32,
}

/// Version 6: the largest force met, and what the last refinement changed. Every state of an equilibrium has the first.
#[derive(Serialize, Deserialize)]
struct StateV6<'a> {
    after: StateV5<'a>,
    largest_force_n: f64,
    refinement: Option<RefinementV6>,
}

#[derive(Serialize, Deserialize)]
struct RefinementV6 {
    changed_n_mm: f64,
    growth: f64,
    expected_n_mm: Option<f64>,
    ripple_n_mm: f64,
}

impl RefinementV6 {
    fn of(Refinement { changed_n_mm, growth, expected_n_mm, ripple_n_mm }: Refinement) -> Self {
        Self { changed_n_mm, growth, expected_n_mm, ripple_n_mm }
    }

    fn into_memory(self) -> Refinement {
        let Self { changed_n_mm, growth, expected_n_mm, ripple_n_mm } = self;
        Refinement { changed_n_mm, growth, expected_n_mm, ripple_n_mm }
    }
}

#[derive(Serialize, Deserialize)]
struct PathV3<'a> {
    heading: Cow<'a, [[f64; 3]]>,
    parameter_rate: f64,
    first_mm: f64,
    next_mm: f64,
    travelled_mm: f64,
    /// Length and rate.
    critical_ahead: Option<[f64; 2]>,
    at_bifurcation: bool,
}

impl<'a> PathV3<'a> {
    fn of(path: &'a PathMemory) -> Self {
        let PathMemory { heading, parameter_rate, first_mm, next_mm, travelled_mm, critical_ahead, at_bifurcation } =
            path;
        Self {
            heading: Cow::from(heading),
            parameter_rate: *parameter_rate,
            first_mm: *first_mm,
            next_mm: *next_mm,
            travelled_mm: *travelled_mm,
            critical_ahead: critical_ahead.map(|CriticalAhead { within_mm, rate_beyond }| [within_mm, rate_beyond]),
            at_bifurcation: *at_bifurcation,
        }
    }

    fn into_memory(self) -> PathMemory {
        PathMemory {
            heading: self.heading.into_owned(),
            parameter_rate: self.parameter_rate,
            first_mm: self.first_mm,
            next_mm: self.next_mm,
            travelled_mm: self.travelled_mm,
            critical_ahead: self
                .critical_ahead
                .map(|[within_mm, rate_beyond]| CriticalAhead { within_mm, rate_beyond }),
            at_bifurcation: self.at_bifurcation,
        }
    }
}

#[derive(Serialize, Deserialize)]
enum StageV1 {
    Solve,
    EvaluateIndicators,
    RefineKnots,
    ProjectDisplacements,
    ReEquilibrate,
    /// From version 3 on.
    SwitchBranch,
}

#[derive(Serialize, Deserialize)]
enum RejectionV1 {
    NoEquilibrium,
    Jump,
    /// From version 3 on.
    CriticalPoint,
    /// From version 3 on.
    SharpTurn,
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
