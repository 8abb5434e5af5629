//! C⁰ knot lines across which the shell must stay smooth: joints of arc segments, and the seam of a full turn.
//!
//! With A = Σ N w u and W = Σ N w, u = A/W has the one-sided derivatives (p/Δ₋)(w₋/w)(u − u₋) and (p/Δ₊)(w₊/w)(u₊ − u) at
//! such a line: equal derivatives put u on the line between its neighbours, in shares of the weights over the spans. The
//! geometry itself says whether it is smooth there.

use crate::model::ModelError;
use crate::shell::{norm, sub};
use crate::spline::Mesh;

/// Three neighbouring lines of control points of which the middle one follows from the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// Index of the middle line.
    pub index: usize,
    /// Index of the line before it.
    pub before: usize,
    /// Index of the line after it.
    pub after: usize,
    /// Share of the line before, times the sum of both.
    pub before_weight: f64,
    /// Share of the line after, times the sum of both.
    pub after_weight: f64,
}

/// A distance, relative to the segments beside it, above which the geometry has a kink.
const KINK: f64 = 1e-9;

/// Joints in a direction: interior knots of full multiplicity.
///
/// # Errors
/// Where the geometry has a kink there.
pub fn joints(mesh: &Mesh, direction: usize) -> Result<Vec<Joint>, ModelError> {
    let degree = mesh.degree[direction];
    let knots = &mesh.knots[direction];
    let count = mesh.control_counts()[direction];
    (degree + 1..count)
        .filter(|k| knots[*k] < knots[k + 1] && knots[k + 1 - degree] == knots[*k])
        .map(|last| {
            // Knots last − p + 1 ..= last coincide: function last − p is 1 there.
            let index = last - degree;
            let (before, after) = (index - 1, index + 1);
            let spans = [knots[last] - knots[last - degree], knots[last + 1] - knots[last]];
            smooth(mesh, direction, Joint { index, before, after, before_weight: 0.0, after_weight: 0.0 }, spans)
        })
        .collect()
}

/// The seam where the last line of control points meets the first.
///
/// # Errors
/// Where the edges do not coincide, or the geometry has a kink there.
pub fn seam(mesh: &Mesh, direction: usize) -> Result<Joint, ModelError> {
    let degree = mesh.degree[direction];
    let knots = &mesh.knots[direction];
    let last = mesh.control_counts()[direction] - 1;
    let spans = [knots[last + 1] - knots[last], knots[degree + 1] - knots[degree]];
    let joint = Joint { index: 0, before: last - 1, after: 1, before_weight: 0.0, after_weight: 0.0 };
    smooth(mesh, direction, joint, spans)
}

/// Weights of a joint, held against the geometry on every line across it.
fn smooth(mesh: &Mesh, direction: usize, joint: Joint, spans: [f64; 2]) -> Result<Joint, ModelError> {
    let counts = mesh.control_counts();
    let control = |along: usize, across: usize| match direction {
        0 => mesh.control_points[along * counts[1] + across],
        _ => mesh.control_points[across * counts[1] + along],
    };
    let place = |[x, y, z, w]: [f64; 4]| [x / w, y / w, z / w];
    let before_weight = control(joint.before, 0)[3] / spans[0];
    let after_weight = control(joint.after, 0)[3] / spans[1];
    for across in 0..counts[1 - direction] {
        let [before, middle, after] = [joint.before, joint.index, joint.after].map(|k| place(control(k, across)));
        let total = before_weight + after_weight;
        let expected = [0, 1, 2].map(|c| (before_weight * before[c] + after_weight * after[c]) / total);
        if norm(sub(expected, middle)) > KINK * norm(sub(after, before)) {
            let at = middle.map(crate::units::rounded);
            return Err(ModelError::Kink { x: at[0].clone(), y: at[1].clone(), z: at[2].clone() });
        }
    }
    Ok(Joint { before_weight, after_weight, ..joint })
}
