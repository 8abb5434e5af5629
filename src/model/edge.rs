//! Edges of a mesh as supports see them: two rows of control points, normals, centroid.

use crate::model::ModelError;
use crate::model::gauss::span_points;
use crate::scene::Edge;
use crate::shell::{add, cross, dot, norm, scaled, sub};
use crate::spline::{Patch, SurfacePoint, mid_surface_point};

/// Control points of an edge and of the row next to it, in the order of the growing parameter along it.
#[derive(Clone, Debug)]
pub struct EdgeRows {
    /// Control points of the edge.
    pub outer: Vec<usize>,
    /// Control points of the row next to the edge.
    pub inner: Vec<usize>,
    /// Unit normal of the shell for each of them, at the point of the edge that is nearest to the inner control point
    /// as seen along the surface's own lines.
    pub normals: Vec<[f64; 3]>,
    /// Centroid of the undeformed edge, mm.
    pub centroid: [f64; 3],
    /// Length of the undeformed edge, mm.
    pub length: f64,
}

impl EdgeRows {
    /// Renumbers control points as those of a structure in which the first of the patch has the number `first`.
    pub fn shifted(mut self, first: usize) -> Self {
        self.outer.iter_mut().chain(&mut self.inner).for_each(|point| *point += first);
        self
    }

    /// Puts the rows of the edges of one section together; `None` where there is no edge.
    ///
    /// # Errors
    /// The first among them.
    pub fn joined(all: impl IntoIterator<Item = Result<Self, ModelError>>) -> Result<Option<Self>, ModelError> {
        let mut all = all.into_iter();
        let Some(first) = all.next().transpose()? else { return Ok(None) };
        all.try_fold(first, |rows, other| Ok(rows.and(other?))).map(Some)
    }

    fn and(mut self, other: Self) -> Self {
        let length = self.length + other.length;
        let share = other.length / length;
        self.centroid = add(scaled(1.0 - share, self.centroid), scaled(share, other.centroid));
        self.length = length;
        self.outer.extend(other.outer);
        self.inner.extend(other.inner);
        self.normals.extend(other.normals);
        self
    }
}

/// Largest number of Newton steps to the nearest point; they converge quadratically from a start within the span.
const NEWTON_STEPS: usize = 30;
/// Number of Gauss points of a span for the centroid.
const CENTROID_POINTS: usize = 8;

/// Finds the rows of control points of an edge, with their normals.
///
/// # Errors
/// Where the surface has no normal on the edge.
pub fn edge_rows(patch: &Patch, edge: Edge) -> Result<EdgeRows, ModelError> {
    let [outer, inner] = rows_of(patch, edge);
    let normals = inner.iter().enumerate().map(|(j, control)| normal_beside(patch, edge, j, *control));
    let (centroid, length) = centroid_and_length(patch, edge);
    Ok(EdgeRows { normals: normals.collect::<Result<_, _>>()?, centroid, length, outer, inner })
}

/// Control points of an edge, and of the row next to it.
pub fn rows_of(patch: &Patch, edge: Edge) -> [Vec<usize>; 2] {
    let (direction, at_end) = side(edge);
    let count = patch.control_counts()[direction];
    [0, 1].map(|k| {
        let along = if at_end { count - 1 - k } else { k };
        patch.grid().line(direction, along).collect()
    })
}

/// Direction (0 or 1) that is constant along an edge, and whether the edge is at its end.
pub fn side(edge: Edge) -> (usize, bool) {
    let (direction, at_end) = edge.side();
    (direction.index(), at_end)
}

/// Parameters (u, v) at a parameter along an edge.
pub fn edge_parameters(edge: Edge, parameter: f64) -> [f64; 2] {
    let (direction, at_end) = side(edge);
    let end = if at_end { 1.0 } else { 0.0 };
    if direction == 0 { [end, parameter] } else { [parameter, end] }
}

/// Evaluates the point of an edge at a parameter along it.
pub fn on_edge(patch: &Patch, edge: Edge, parameter: f64) -> SurfacePoint {
    mid_surface_point(patch, &[], edge_parameters(edge, parameter))
}

/// Finds the normal at the point of the edge from which the inner control point lies at right angles to the edge.
fn normal_beside(patch: &Patch, edge: Edge, j: usize, control: usize) -> Result<[f64; 3], ModelError> {
    let (direction, _) = side(edge);
    let running = 1 - direction;
    let target = patch.point(control);
    let degree = patch.degree[running];
    let mut parameter = patch.knots[running][j + 1..j + 1 + degree].iter().sum::<f64>() / degree as f64;
    for _ in 0..NEWTON_STEPS {
        let point = on_edge(patch, edge, parameter);
        let (tangent, second) = (point.derivatives[running], point.derivatives[2 + running]);
        let gap = sub(point.position, target);
        let slope = dot(tangent, tangent) + dot(gap, second);
        let step = dot(gap, tangent) / if slope > 0.0 { slope } else { dot(tangent, tangent) };
        parameter = (parameter - step).clamp(0.0, 1.0);
        if step.abs() < 1e-16 {
            break;
        }
    }
    let point = on_edge(patch, edge, parameter);
    let normal = cross(point.derivatives[0], point.derivatives[1]);
    let scale = norm(point.derivatives[0]) * norm(point.derivatives[1]);
    if norm(normal) <= 1e-12 * scale || scale == 0.0 {
        return Err(ModelError::Collapsed { at: crate::units::place(point.position) });
    }
    Ok(scaled(1.0 / norm(normal), normal))
}

/// Computes the centroid of an edge and its length, mm.
pub(super) fn centroid_and_length(patch: &Patch, edge: Edge) -> ([f64; 3], f64) {
    let (direction, _) = side(edge);
    let running = 1 - direction;
    let (mut length, mut moment) = (0.0, [0.0; 3]);
    for [parameter, weight] in span_points(patch, running, CENTROID_POINTS) {
        let point = on_edge(patch, edge, parameter);
        let share = weight * norm(point.derivatives[running]);
        length += share;
        (0..3).for_each(|c| moment[c] += share * point.position[c]);
    }
    (scaled(1.0 / length, moment), length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::starting_patch;
    use crate::scene::parse;

    #[test]
    fn the_end_of_a_tape_spring_has_radial_normals_and_the_centroid_of_an_arc() {
        let scene = parse(include_str!("../../pipelines/baseline.toml"), "baseline.toml").unwrap();
        let patch = starting_patch(&scene).unwrap();
        let rows = edge_rows(&patch, Edge::UStart).unwrap();
        for (control, normal) in rows.inner.iter().zip(&rows.normals) {
            let [_, y, z, _] = patch.control_points[*control];
            let radius = y.hypot(z);
            assert!(
                normal[0].abs() < 1e-12
                    && (normal[1] - y / radius).abs() < 1e-12
                    && (normal[2] - z / radius).abs() < 1e-12
            );
        }
        let half = 55.0_f64.to_radians();
        assert!((rows.centroid[2] - 10.0 * half.sin() / half).abs() < 1e-12);
    }
}
