//! The mesh that a scene starts from: an exact NURBS surface with the scene's elements.

use crate::model::ModelError;
use crate::model::edge::side;
use crate::model::edge_pair::pass_on;
use crate::model::limits::MOST_CONTROL_POINTS;
use crate::model::mirror_check::check_mirror_images;
use crate::model::overhang::check_overhangs;
use crate::model::shape::{Shape, shape};
use crate::model::subdivision::subdivide;
use crate::model::thinness::check_thinness;
use crate::scene::{Hold, Pose, Region, Scene};
use crate::spline::{Grid, Mesh, Patch, cartesian};

/// Builds the starting mesh: a patch for each shell.
///
/// # Errors
/// As for [`starting_patch`], and where all shells together have too many control points.
pub fn starting_mesh(scene: &Scene) -> Result<Mesh, ModelError> {
    let patch = |index: usize| starting_patch(&scene.of_shell(index));
    let mesh = Mesh { patches: (0..scene.shell_count()).map(patch).collect::<Result<_, _>>()? };
    let passed_on = pass_on(scene, &mesh, mesh.no_knots())?;
    let mesh = if passed_on.iter().flatten().all(Vec::is_empty) { mesh } else { mesh.with_knots(&passed_on) };
    if mesh.point_count() > MOST_CONTROL_POINTS {
        return Err(ModelError::TooManyControlPoints { elements: mesh.elements(), count: mesh.point_count() });
    }
    Ok(mesh)
}

/// Builds the starting patch of one shell.
///
/// # Errors
/// Where the ends of a tape spring leave no free control points between them, the mesh is too large, the surface is not
/// one that a shell can have or too curved or small for its thickness or offset, something is not its own mirror image
/// at a plane of symmetry, or a load by the projected area meets both sides.
pub fn starting_patch(scene: &Scene) -> Result<Patch, ModelError> {
    let shape = shape(scene)?;
    if scene.end_rotation().is_some() {
        let (elements, degree) = (shape.elements[0], scene.mesh.degree[0]);
        let rows = elements + degree;
        if rows < 4 {
            return Err(ModelError::TooFewRows { along: "the length", elements, degree, rows, least: 4 - degree });
        }
    }
    check_rows(scene, &shape)?;
    let count = Grid::new([0, 1].map(|direction| shape.elements[direction] + shape.mesh.degree[direction])).len();
    if count > MOST_CONTROL_POINTS {
        return Err(ModelError::TooManyControlPoints { elements: shape.elements.into(), count });
    }
    let mesh = placed(subdivide(shape.mesh, shape.elements)?, &scene.pose);
    check_thinness(scene, &mesh)?;
    check_mirror_images(scene, &mesh)?;
    check_overhangs(scene, &mesh)?;
    Ok(mesh)
}

/// Moves a patch from the shell's own axes to where they lie.
fn placed(mut patch: Patch, pose: &Pose) -> Patch {
    if !pose.is_none() {
        for point in &mut patch.control_points {
            let weight = point[3];
            let [x, y, z] = pose.placed(cartesian(*point));
            *point = [x * weight, y * weight, z * weight, weight];
        }
    }
    patch
}

/// Refuses meshes with too few rows of control points. An edge that a section holds, turning the normal with it, takes
/// two rows; where the opposite edge takes two of three as well, one of the sections loses its hold.
fn check_rows(scene: &Scene, shape: &Shape) -> Result<(), ModelError> {
    let is_held = |direction: usize, at_end: bool| {
        scene.supports.iter().any(|support| {
            let turns = matches!(support.hold, Hold::Rigid { normals_turn: true, .. });
            turns && matches!(support.on, Region::Edge(edge) if side(edge) == (direction, at_end))
        })
    };
    for direction in 0..2 {
        let (elements, degree) = (shape.elements[direction], scene.mesh.degree[direction]);
        let rows = elements + degree;
        if rows < 4 && is_held(direction, false) && is_held(direction, true) {
            let along = ["u", "v"][direction];
            return Err(ModelError::TooFewRows { along, elements, degree, rows, least: 4 - degree });
        }
    }
    Ok(())
}
