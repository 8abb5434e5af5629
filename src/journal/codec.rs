//! States and meshes as bytes: a version byte, then bincode (little endian, fixed-width integers, no maps).
//!
//! Each version has structs of its own, so that a change of [`State`] cannot change how old logs are read. The mesh and the
//! fields (vectors at the control points: displacements, those of the equilibrium before, the heading of a path) lie apart from
//! the state and are named in it: the mesh by its content hash, a field by the hash of its bytes. So a solve writes its
//! displacements, and those of the equilibrium before are there already. Nothing decoded leaves this file before its content
//! hash is that of the commit and [`soundness`](super::soundness) has passed it.

mod bytes;
mod older;
mod versions;

use std::borrow::Cow;
use std::sync::Arc;

pub use self::bytes::{CODEC_VERSION, CodecError};
use self::bytes::{ONE_PATCH_VERSION, decode, encode};
use self::older::{Older, decode_older};
use self::versions::{
    CourseV7, EstimateV8, FieldV1, MeshV1, MeshV2, RefinementV6, RejectionV1, StageV1, StateV7, StateV8, StateV9,
    borrowed, owned,
};
use super::format::FIELDS_LIMIT;
use super::soundness::{check_mesh, check_on_mesh, check_state};
use crate::digest::extend_with_numbers;
use crate::scene::Stage;
use crate::state::{DriveMemory, Hash, Mesh, Rejection, State, StepControl};

/// What [`encode`] makes of [`FieldV1`], in a tenth of the time: fields are nearly all of most logs.
fn encode_field(vectors: &[[f64; 3]]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(1 + 8 + size_of_val(vectors));
    bytes.push(1);
    bytes.extend((vectors.len() as u64).to_le_bytes());
    extend_with_numbers(&mut bytes, vectors.as_flattened());
    bytes
}

/// Encodes a mesh as bytes.
///
/// # Errors
/// Where the mesh is unsound or larger than a log can hold.
pub fn encode_mesh(mesh: &Mesh) -> Result<Vec<u8>, CodecError> {
    check_mesh(mesh)?;
    match &mesh.patches[..] {
        [patch] => encode(1, &MeshV1::of(patch)),
        _ => encode(2, &MeshV2::of(mesh)),
    }
}

/// Decodes a mesh, and checks that it is sound and that its content hash is `expected`.
///
/// # Errors
/// Where the bytes are anything else.
pub fn decode_mesh(bytes: &[u8], expected: Hash) -> Result<Mesh, CodecError> {
    let mesh = match bytes.first() {
        Some(2) => decode::<MeshV2>(2, bytes)?.into_mesh(),
        _ => decode::<MeshV1>(1, bytes)?.into_patch().into(),
    };
    let found = mesh.hash();
    if found != expected {
        return Err(CodecError::ContentHash { what: "mesh", expected, found });
    }
    check_mesh(&mesh)?;
    Ok(mesh)
}

/// The vectors of a field on the control points, as bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EncodedField {
    /// Hash of the bytes.
    pub hash: Hash,
    /// The encoded field.
    pub bytes: Vec<u8>,
}

impl EncodedField {
    /// The field as bytes. Those that are known already need not be hashed again, which takes longer than to compare them.
    fn of(vectors: &[[f64; 3]], known: &[EncodedField]) -> Self {
        let bytes = encode_field(vectors);
        let known = known.iter().find(|known| known.bytes == bytes);
        Self { hash: known.map_or_else(|| blake3::hash(&bytes), |known| known.hash), bytes }
    }
}

/// The encoded parts of a state, each of which is a message of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EncodedState {
    /// The state, which names its mesh and its fields by hash.
    pub state: Vec<u8>,
    /// Its displacements, and what its course has: those of the equilibrium before, or the heading of the path.
    pub fields: Vec<EncodedField>,
}

/// Encodes a state, without its mesh, as bytes.
///
/// # Errors
/// Where the state is unsound or larger than a log can hold.
pub fn encode_state(state: &State) -> Result<EncodedState, CodecError> {
    check_mesh(&state.mesh)?;
    encode_state_on(state, state.mesh.hash(), &[])
}

/// The same where the hash of its mesh is known, and the mesh is sound; fields are likely to be among those that are `known`.
pub(super) fn encode_state_on(state: &State, mesh: Hash, known: &[EncodedField]) -> Result<EncodedState, CodecError> {
    check_on_mesh(state)?;
    let State {
        mesh: _,
        displacement,
        marked,
        superfluous,
        refined,
        step,
        stage,
        parameter,
        turns,
        moment_n_mm,
        strain_energy_n_mm,
        negative_pivots,
        drive: DriveMemory { control: StepControl { halvings, jump_beyond, rejection }, course },
        largest_force_n,
        refinement,
        estimate,
    } = state;
    let is_one_patch = state.mesh.patches.len() == 1;
    let (course, field) = CourseV7::of(course);
    let fields = [Some(&displacement[..]), field].into_iter().flatten();
    let fields: Vec<EncodedField> = fields.map(|vectors| EncodedField::of(vectors, known)).collect();
    let base = StateV7 {
        mesh: *mesh.as_bytes(),
        fields: fields.iter().map(|field| *field.hash.as_bytes()).collect(),
        marked: marked[0].each_ref().map(Cow::from),
        refined: refined.as_deref().filter(|_| is_one_patch).map(|mesh| MeshV1::of(&mesh.patches[0])),
        step: *step,
        stage: stage.map(|stage| match stage {
            Stage::Solve => StageV1::Solve,
            Stage::EvaluateIndicators => StageV1::EvaluateIndicators,
            Stage::RefineKnots => StageV1::RefineKnots,
            Stage::ProjectDisplacements => StageV1::ProjectDisplacements,
            Stage::ReEquilibrate => StageV1::ReEquilibrate,
            Stage::SwitchBranch => StageV1::SwitchBranch,
            Stage::CoarsenKnots => StageV1::CoarsenKnots,
        }),
        parameter: *parameter,
        turns: Cow::from(turns),
        moment_n_mm: *moment_n_mm,
        strain_energy_n_mm: *strain_energy_n_mm,
        negative_pivots: *negative_pivots,
        halvings: *halvings,
        jump_beyond: *jump_beyond,
        rejection: rejection.map(|rejection| match rejection {
            Rejection::NoEquilibrium => RejectionV1::NoEquilibrium,
            Rejection::Jump => RejectionV1::Jump,
            Rejection::CriticalPoint => RejectionV1::CriticalPoint,
            Rejection::SharpTurn => RejectionV1::SharpTurn,
        }),
        course,
        largest_force_n: *largest_force_n,
        refinement: refinement.map(RefinementV6::of),
    };
    let first = superfluous[0].each_ref().map(Cow::from);
    let base = StateV8 { base, superfluous: first, estimate: estimate.map(EstimateV8::of) };
    let state = match is_one_patch {
        true => encode(ONE_PATCH_VERSION, &base)?,
        false => {
            let (marked, superfluous) = (borrowed(&marked[1..]), borrowed(&superfluous[1..]));
            let refined = refined.as_deref().map(MeshV2::of);
            encode(CODEC_VERSION, &StateV9 { base, marked, superfluous, refined })?
        }
    };
    Ok(EncodedState { state, fields })
}

/// Decodes a state on `mesh` (whose content hash is `mesh_hash`), and checks that it is sound and that its content hash
/// is `expected`. `field` finds the bytes of fields by their hash.
///
/// # Errors
/// Where the bytes are anything else.
pub fn decode_state<'a>(
    bytes: &[u8],
    field: impl Fn(Hash) -> Option<&'a [u8]>,
    mesh: Arc<Mesh>,
    mesh_hash: Hash,
    expected: Hash,
) -> Result<State, CodecError> {
    let (Older { state, heading }, more) = match bytes.first() {
        Some(&CODEC_VERSION) => {
            let StateV9 { base, marked, superfluous, refined } = decode(CODEC_VERSION, bytes)?;
            (Older { state: base, heading: None }, Some((marked, superfluous, refined)))
        }
        Some(&ONE_PATCH_VERSION) => (Older { state: decode(ONE_PATCH_VERSION, bytes)?, heading: None }, None),
        _ => (decode_older(bytes)?, None),
    };
    let StateV8 { base: stored, superfluous, estimate } = state;
    let is_of_one_patch = more.is_none();
    let (more_marked, more_superfluous, finer) = more.unwrap_or_default();
    let found = Hash::from_bytes(stored.mesh);
    if found != mesh_hash {
        return Err(CodecError::OtherMesh { expected: mesh_hash, found });
    }
    if stored.fields.is_empty() || stored.fields.len() > FIELDS_LIMIT {
        return Err(CodecError::FieldCount { found: stored.fields.len() });
    }
    let fields = stored.fields.iter().map(|hash| {
        let hash = Hash::from_bytes(*hash);
        let FieldV1(vectors) = decode(1, field(hash).ok_or(CodecError::NoField { hash })?)?;
        Ok(vectors.into_owned())
    });
    let mut fields = fields.collect::<Result<Vec<Vec<[f64; 3]>>, CodecError>>()?.into_iter();
    let mut displacement = fields.next().unwrap_or_default();
    let field = match (&stored.course, bytes.first()) {
        (CourseV7::Load { .. }, Some(..7)) => Some(displacement.split_off(displacement.len() / 2)),
        _ => heading.or_else(|| fields.next()),
    };
    let course = stored.course.with(field).filter(|_| fields.next().is_none());
    let state = State {
        mesh,
        displacement,
        marked: owned(stored.marked, more_marked),
        superfluous: owned(superfluous, more_superfluous),
        refined: match is_of_one_patch {
            true => stored.refined.map(|mesh| Arc::new(mesh.into_patch().into())),
            false => finer.map(|mesh| Arc::new(mesh.into_mesh())),
        },
        step: stored.step,
        stage: stored.stage.map(|stage| match stage {
            StageV1::Solve => Stage::Solve,
            StageV1::EvaluateIndicators => Stage::EvaluateIndicators,
            StageV1::RefineKnots => Stage::RefineKnots,
            StageV1::ProjectDisplacements => Stage::ProjectDisplacements,
            StageV1::ReEquilibrate => Stage::ReEquilibrate,
            StageV1::SwitchBranch => Stage::SwitchBranch,
            StageV1::CoarsenKnots => Stage::CoarsenKnots,
        }),
        parameter: stored.parameter,
        turns: stored.turns.into_owned(),
        moment_n_mm: stored.moment_n_mm,
        strain_energy_n_mm: stored.strain_energy_n_mm,
        negative_pivots: stored.negative_pivots,
        drive: DriveMemory {
            control: StepControl {
                halvings: stored.halvings,
                jump_beyond: stored.jump_beyond,
                rejection: stored.rejection.map(|rejection| match rejection {
                    RejectionV1::NoEquilibrium => Rejection::NoEquilibrium,
                    RejectionV1::Jump => Rejection::Jump,
                    RejectionV1::CriticalPoint => Rejection::CriticalPoint,
                    RejectionV1::SharpTurn => Rejection::SharpTurn,
                }),
            },
            course: course.ok_or(CodecError::FieldCount { found: stored.fields.len() })?,
        },
        largest_force_n: stored.largest_force_n,
        refinement: stored.refinement.map(RefinementV6::into_memory),
        estimate: estimate.map(EstimateV8::into_memory),
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
