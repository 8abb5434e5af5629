//! Imperfect surfaces: the perfect ones with their control points moved, free of stress.
//!
//! The moved surface is the reference of everything: lengths, normals, angles of joints, gaps of bonds are those that it has, and so it
//! rests without load. What connects the shells is found on the perfect surfaces: which points of two faces are glued, and
//! which edges lie in a plane of symmetry. The moves of control points keep all ties between them (joints, seams, lines inside across
//! which the surface is smooth), so that an imperfect surface is as continuous as the perfect one.

use std::borrow::Cow;

use crate::model::edge_pair::edge_pairs;
use crate::model::imperfection_error::ImperfectionError;
use crate::model::largest_offset::{Offset, largest_of_patch, largest_offset};
use crate::model::member::members;
use crate::model::overhang::check_overhangs;
use crate::model::scene_supports::supports_of;
use crate::model::soundness::check_normals;
use crate::model::start::starting_mesh;
use crate::model::thinness::{Extent, check_thinness};
use crate::model::{ModelError, Unknowns};
use crate::scene::{Hold, Load, LoadSteps, Scene, Support, Symmetry};
use crate::shell::sub;
use crate::spline::{KnotLists, Mesh, Patch};
use crate::units::place;

/// Share of the largest offset by which an imperfection may be off one that keeps planes and joints, and is made to keep them: what
/// the interpolation of a field by the spline is off.
const NEARLY_KEPT: f64 = 0.01;

/// The thickness of the thinnest shell, in which imperfections are counted, mm.
pub fn thinnest_mm(scene: &Scene) -> f64 {
    let own = scene.shells.iter().map(|shell| shell.material.thickness_mm());
    own.fold(scene.material.thickness_mm(), f64::min)
}

/// Returns the perfect surfaces of a scene in the spline space of a mesh of theirs: the mesh itself where nothing is imperfect.
///
/// # Errors
/// As for [`starting_mesh`].
pub fn perfect_on<'m>(scene: &Scene, mesh: &'m Mesh) -> Result<Cow<'m, Mesh>, ModelError> {
    if scene.imperfections.is_empty() {
        return Ok(Cow::Borrowed(mesh));
    }
    let start = starting_mesh(scene)?;
    let lacking = |(start, patch): (&Patch, &Patch)| [0, 1].map(|k| knots_beyond(&patch.knots[k], &start.knots[k]));
    let knots: KnotLists = start.patches.iter().zip(&mesh.patches).map(lacking).collect();
    Ok(Cow::Owned(start.with_knots(&knots)))
}

/// Knots of a list that another, a part of it, does not have.
fn knots_beyond(all: &[f64], part: &[f64]) -> Vec<f64> {
    let mut rest = part.iter().peekable();
    all.iter().copied().filter(|knot| rest.next_if(|other| *other == knot).is_none()).collect()
}

/// Finds the moves of the control points that are nearest to some moves, keep all ties of the surfaces, and keep the planes of symmetry.
/// `is_free` says that the ties may take more than rounding away: of a field that is smooth itself.
///
/// # Errors
/// Where the imperfection leaves a plane of symmetry, or parts what is joined.
pub fn kept_together(
    scene: &Scene,
    perfect: &Mesh,
    name: &str,
    moves: Vec<[f64; 3]>,
    is_free: bool,
) -> Result<Vec<[f64; 3]>, ModelError> {
    let largest_mm = largest_offset(scene, perfect, &moves).mm;
    let off = |kept: &[[f64; 3]], moves: &[[f64; 3]]| {
        let differences: Vec<[f64; 3]> = kept.iter().zip(moves).map(|(one, other)| sub(*one, *other)).collect();
        largest_offset(scene, perfect, &differences)
    };
    let mut moves = moves;
    let tied = held_by(scene, perfect, &moves, Vec::new())?;
    let Offset { mm: off_mm, at } = off(&tied, &moves);
    if !is_free && off_mm > NEARLY_KEPT * largest_mm {
        let imperfection = name.to_owned();
        return Err(ImperfectionError::Parts { imperfection, off_mm, largest_mm, at: place(at) }.into());
    }
    moves = tied;
    let planes = supports_of(scene).into_iter().filter(|support| support.hold == Hold::Symmetric);
    for plane in planes.collect::<Vec<_>>() {
        let support = plane.name.clone();
        let kept = held_by(scene, perfect, &moves, vec![plane])?;
        let Offset { mm: off_mm, at } = off(&kept, &moves);
        if off_mm > NEARLY_KEPT * largest_mm {
            let imperfection = name.to_owned();
            return Err(ImperfectionError::OffPlane { imperfection, support, off_mm, largest_mm, at: place(at) }.into());
        }
        moves = kept;
    }
    Ok(moves)
}

/// The moves with all that depends on others put right: as displacements of the scene with these supports alone.
fn held_by(
    scene: &Scene,
    perfect: &Mesh,
    moves: &[[f64; 3]],
    supports: Vec<Support>,
) -> Result<Vec<[f64; 3]>, ModelError> {
    let load =
        LoadSteps { factor: 1.0, increment: 1.0, longest_increment: None, least_increment: 1.0, snap_tolerance: 1.0 };
    let (load, symmetry) = (Load::Steps(load), Symmetry::None);
    let bare = Scene { supports, actions: Vec::new(), load, symmetry, ..scene.perfect().into_owned() };
    let unknowns = Unknowns::new(&bare, perfect)?;
    let free = unknowns.of_displacement(moves, &[], 0.0);
    Ok(unknowns.configure(&free, 0.0).displacement())
}

/// Moves the control points of the perfect surfaces.
///
/// # Errors
/// Where the moves are as large as the shell is curved or wide, or the surface is none that a shell can have.
pub fn moved(scene: &Scene, perfect: &Mesh, moves: &[[f64; 3]]) -> Result<Mesh, ModelError> {
    let mut mesh = perfect.clone();
    let points = mesh.patches.iter_mut().flat_map(|patch| &mut patch.control_points);
    for (point, shift) in points.zip(moves) {
        (0..3).for_each(|c| point[c] += point[3] * shift[c]);
    }
    for member in members(scene, perfect) {
        let Offset { mm: offset_mm, at } = largest_of_patch(member.patch, &moves[member.points.clone()]);
        let Extent { radius_mm, side_mm, .. } = Extent::of(member.patch, &member.scene.material);
        let lengths =
            [("the smallest radius of curvature of the perfect one", radius_mm), ("its shorter side", side_mm)];
        if let Some((what, limit_mm)) = lengths.into_iter().find(|(_, length)| offset_mm >= *length) {
            return Err(ImperfectionError::TooLarge { offset_mm, at: place(at), what, limit_mm }.into());
        }
    }
    sound(scene, &mesh).map_err(|fault| {
        let Offset { mm: offset_mm, at } = largest_offset(scene, perfect, moves);
        ImperfectionError::NoShell { offset_mm, at: place(at), fault: fault.to_string() }
    })?;
    Ok(mesh)
}

/// Refuses surfaces that no shells can have.
fn sound(scene: &Scene, mesh: &Mesh) -> Result<(), ModelError> {
    let members = members(scene, mesh);
    for member in &members {
        check_normals(member.patch)?;
        check_thinness(&member.scene, member.patch)?;
        check_overhangs(&member.scene, member.patch)?;
    }
    edge_pairs(scene, &members).map(|_| ())
}
