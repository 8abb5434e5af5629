//! Gauss points in the parameters of a mesh.

use crate::shell::gauss_legendre;
use crate::spline::{Patch, Spans};

/// Parameters and weights of `count` Gauss points on an interval.
pub fn gauss_points([from, to]: [f64; 2], count: usize) -> impl Iterator<Item = [f64; 2]> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    gauss_legendre(count).into_iter().map(move |[node, weight]| [middle + half * node, half * weight])
}

/// Parameters and weights of the Gauss points of all spans in a direction, `count` on each.
pub fn span_points(patch: &Patch, direction: usize, count: usize) -> Vec<[f64; 2]> {
    let spans = Spans::of(&patch.knots[direction], patch.degree[direction]).bounds;
    spans.into_iter().flat_map(|span| gauss_points(span, count)).collect()
}
