//! The mesh that a scene starts from: an exact NURBS surface with the scene's elements.

use crate::scene::{Geometry, Scene};
use crate::spline::{HomogeneousCurve, Mesh, circular_arc, segment_count, straight_line};

/// A scene that cannot be made discrete.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// Two rows of control points at each end are taken by its support.
    #[error(
        "{elements} element(s) of degree {degree} along the length have {rows} rows of control points, but the supports \
         at both ends take 2 each: write at least {least} elements along the length of the model (mesh.elements)"
    )]
    TooFewRows {
        /// Elements along the length of the model.
        elements: usize,
        /// Degree along the length.
        degree: usize,
        /// Rows of control points.
        rows: usize,
        /// Elements along the length that suffice.
        least: usize,
    },
    /// A symmetric support that is not on an edge.
    #[error(
        "support \"{support}\" is a plane of symmetry, which only an edge can lie in: write one of the edges in `on`"
    )]
    NotAnEdge {
        /// Name of the support.
        support: String,
    },
    /// A force per length that is on a point.
    #[error(
        "action \"{action}\" is a force per length, and a point has no length: write an edge or a line in `on`, or use kind = \"force\""
    )]
    NotALine {
        /// Name of the action.
        action: String,
    },
    /// An edge that cannot lie in a plane of symmetry.
    #[error("support \"{support}\" is no plane of symmetry: {reason}")]
    NotASymmetryPlane {
        /// Name of the support.
        support: String,
        /// Why.
        reason: String,
    },
    /// Two supports hold a control point of a section that moves.
    #[error(
        "supports \"{support}\" and \"{other}\" meet, and \"{other}\" is a rigid section that moves: hold the one or the other \
         there, or give the section's motions so that it stays in place"
    )]
    SectionShared {
        /// Name of the support.
        support: String,
        /// Name of the section.
        other: String,
    },
    /// Two supports give different motions to the same control points.
    #[error("support \"{support}\" gives a displacement that {} does not allow: hold that component in one of them only", other.as_ref().map_or("another support".into(), |name| format!("\"{name}\"")))]
    Contradiction {
        /// Name of the support.
        support: String,
        /// Name of the other, if it is known.
        other: Option<String>,
    },
    /// The surface folds at an interior line.
    #[error(
        "the surface has a kink at ({x}, {y}, {z}) mm, and one patch must be smooth: give the knots there a lower multiplicity, or smooth the control points"
    )]
    Kink {
        /// x, mm.
        x: String,
        /// y, mm.
        y: String,
        /// z, mm.
        z: String,
    },
    /// The surface has no normal at a point.
    #[error(
        "the surface has no normal at ({x}, {y}, {z}) mm: an edge collapses there, or control points coincide; leave a small hole"
    )]
    Collapsed {
        /// x, mm.
        x: String,
        /// y, mm.
        y: String,
        /// z, mm.
        z: String,
    },
    /// The supports leave a rigid motion free.
    #[error("the supports do not hold the shell: {motion}; add a support, or hold more components")]
    FreeMotion {
        /// The motion, in words.
        motion: String,
    },
    /// More than memory holds.
    #[error(
        "{} × {} elements have {count} control points, and the most that this program takes on is {MOST_CONTROL_POINTS}: write fewer in \
         mesh.elements, and let the mesh refine itself where it has to",
        elements[0],
        elements[1]
    )]
    TooManyControlPoints {
        /// Elements each way of the model.
        elements: [usize; 2],
        /// Control points.
        count: usize,
    },
}

/// Control points of a mesh at most: tables and matrix of more would not fit in the memory of a large workstation.
pub const MOST_CONTROL_POINTS: usize = 500_000;

/// Builds the starting mesh. The whole shell spans x in [0, L] and the arc angle φ in [−α/2, α/2] from the apex; a
/// half-length model spans x in [0, L/2], a half-arc model φ in [0, α/2]. Where the arc needs several segments, the
/// elements along it are rounded up to a multiple of them.
///
/// # Errors
/// Where the ends leave no free control points between them.
pub fn starting_mesh(scene: &Scene) -> Result<Mesh, ModelError> {
    let Geometry::TapeSpring { length_mm, radius_mm, arc_deg } = scene.geometry else { todo!() };
    let [degree, arc_degree] = scene.mesh.degree;
    let [half_length, half_arc] = scene.symmetry.cuts();
    let length = if half_length { length_mm / 2.0 } else { length_mm };
    let half = arc_deg.to_radians() / 2.0;
    let from = if half_arc { 0.0 } else { -half };
    let along = straight_line(length, degree);
    let across = circular_arc(radius_mm, from, half, arc_degree);

    let divide = |whole: usize, halved: bool| if halved { whole.div_ceil(2) } else { whole };
    let elements = [divide(scene.mesh.elements[0], half_length), divide(scene.mesh.elements[1], half_arc)];
    let rows = elements[0] + degree;
    if rows < 4 {
        return Err(ModelError::TooFewRows { elements: elements[0], degree, rows, least: 4 - degree });
    }
    let count = rows * (elements[1] + arc_degree);
    if count > MOST_CONTROL_POINTS {
        return Err(ModelError::TooManyControlPoints { elements, count });
    }
    let mesh = tensor_product(&along, &across);
    Ok(subdivide(mesh, [1, segment_count(half - from)], elements))
}

/// Cylinder over `across` (in the y–z plane) along `along` (x).
fn tensor_product(along: &HomogeneousCurve, across: &HomogeneousCurve) -> Mesh {
    let control_points = along
        .points
        .iter()
        .flat_map(|[x, _, _]| across.points.iter().map(move |[y, z, w]| [x * w, *y, *z, *w]))
        .collect();
    Mesh { degree: [along.degree, across.degree], knots: [along.knots.clone(), across.knots.clone()], control_points }
}

/// Inserts uniform knots so that there are at least `elements` each way, the same number in each segment.
fn subdivide(mesh: Mesh, segments: [usize; 2], elements: [usize; 2]) -> Mesh {
    let new = [0, 1].map(|direction| {
        let pieces = elements[direction].div_ceil(segments[direction]);
        let total = pieces * segments[direction];
        (1..total).filter(|k| k % pieces != 0).map(|k| k as f64 / total as f64).collect()
    });
    mesh.with_knots(&new)
}
