//! The mesh that a scene starts from: an exact NURBS surface with the scene's elements.

use crate::model::shape::shape;
use crate::scene::Scene;
use crate::spline::{Mesh, Spans};

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
    /// A symmetric support that is neither on an edge nor on a line.
    #[error(
        "support \"{support}\" is a plane of symmetry, which only an edge or a line can lie in: write one of them in `on`"
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
    /// A plane of symmetry or a joint shares control points with a section that moves, from beside it.
    #[error(
        "{tie} and the rigid section \"{section}\", which moves, lie in one element: put more elements between them \
         (mesh.elements)"
    )]
    TiedToSection {
        /// What ties the control points.
        tie: String,
        /// Name of the section.
        section: String,
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
    /// A mesh of lower degree than the surface has.
    #[error(
        "the surface has degree {geometry}, and the mesh degree {mesh} cannot hold it: raise mesh.degree to {geometry}"
    )]
    DegreeTooLow {
        /// Degree of the geometry.
        geometry: usize,
        /// Degree of the mesh.
        mesh: usize,
    },
    /// The supports leave a rigid motion free.
    #[error("the supports do not hold the shell: {motion}; add a support, or hold more components")]
    FreeMotion {
        /// The motion, in words.
        motion: String,
    },
    /// A support that holds rigid motions where none is free.
    #[error(
        "support \"{support}\" holds rigid motions alone, and the other supports leave none free: take it out, or hold less in them"
    )]
    NoFreeMotion {
        /// Name of the support.
        support: String,
    },
    /// Loads push along a motion that only such a support holds.
    #[error(
        "the loads are not in balance, and support \"{support}\" holds rigid motions alone: {motion}, where they push by {share:.1e} of all \
         that acts at load factor {load_factor}; balance them (numbers of few digits leave that much), or hold the shell where its force goes"
    )]
    Unbalanced {
        /// Name of the support.
        support: String,
        /// The motion that they push along, in words.
        motion: String,
        /// Their work on it, of the sum of all forces at their arms.
        share: f64,
        /// Where.
        load_factor: f64,
    },
    /// The supports leave nothing free.
    #[error(
        "the supports hold every control point of {} × {} elements: nothing is left to solve for; write more in mesh.elements, or hold less",
        elements[0],
        elements[1]
    )]
    NothingFree {
        /// Elements each way of the model.
        elements: [usize; 2],
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

/// Builds the starting mesh.
///
/// # Errors
/// Where the ends of a tape spring leave no free control points between them, or the mesh is too large.
pub fn starting_mesh(scene: &Scene) -> Result<Mesh, ModelError> {
    let shape = shape(scene)?;
    if scene.end_rotation().is_some() {
        let (elements, degree) = (shape.elements[0], scene.mesh.degree[0]);
        let rows = elements + degree;
        if rows < 4 {
            return Err(ModelError::TooFewRows { elements, degree, rows, least: 4 - degree });
        }
    }
    let count = (shape.elements[0] + shape.mesh.degree[0]) * (shape.elements[1] + shape.mesh.degree[1]);
    if count > MOST_CONTROL_POINTS {
        return Err(ModelError::TooManyControlPoints { elements: shape.elements, count });
    }
    Ok(subdivide(shape.mesh, shape.elements))
}

/// Inserts uniform knots so that there are at least `elements` each way, the same number in each span of the mesh.
fn subdivide(mesh: Mesh, elements: [usize; 2]) -> Mesh {
    let new = [0, 1].map(|direction| {
        let bounds = Spans::of(&mesh.knots[direction], mesh.degree[direction]).bounds;
        let pieces = elements[direction].div_ceil(bounds.len());
        let total = (pieces * bounds.len()) as f64;
        let inside = |(span, [from, to]): (usize, &[f64; 2])| {
            let uniform = (bounds.len() as f64 * from - span as f64).abs() < 1e-12;
            let (from, to) = (*from, *to);
            // Uniform spans are divided as multiples of one number, so that equal meshes have equal bits.
            (1..pieces)
                .map(move |k| match uniform {
                    true => (span * pieces + k) as f64 / total,
                    false => from + (to - from) * k as f64 / pieces as f64,
                })
                .collect::<Vec<f64>>()
        };
        bounds.iter().enumerate().flat_map(inside).collect()
    });
    mesh.with_knots(&new)
}
