//! The mesh that a scene starts from: an exact NURBS surface with the scene's elements.

use crate::model::ModelError;
use crate::model::limits::MOST_CONTROL_POINTS;
use crate::model::mirror_check::check_mirror_images;
use crate::model::overhang::check_overhangs;
use crate::model::shape::shape;
use crate::model::subdivision::subdivide;
use crate::model::thinness::check_thinness;
use crate::scene::Scene;
use crate::spline::{Grid, Mesh};

/// Builds the starting mesh.
///
/// # Errors
/// Where the ends of a tape spring leave no free control points between them, the mesh is too large, the surface is none
/// that a shell can have, or too curved or small for its thickness or offset, something is not its own mirror image at a plane of symmetry, or a load by the projected area
/// meets both sides.
pub fn starting_mesh(scene: &Scene) -> Result<Mesh, ModelError> {
    let shape = shape(scene)?;
    if scene.end_rotation().is_some() {
        let (elements, degree) = (shape.elements[0], scene.mesh.degree[0]);
        let rows = elements + degree;
        if rows < 4 {
            return Err(ModelError::TooFewRows { elements, degree, rows, least: 4 - degree });
        }
    }
    let count = Grid::new([0, 1].map(|way| shape.elements[way] + shape.mesh.degree[way])).len();
    if count > MOST_CONTROL_POINTS {
        return Err(ModelError::TooManyControlPoints { elements: shape.elements, count });
    }
    let mesh = subdivide(shape.mesh, shape.elements)?;
    check_thinness(scene, &mesh)?;
    check_mirror_images(scene, &mesh)?;
    check_overhangs(scene, &mesh)?;
    Ok(mesh)
}
