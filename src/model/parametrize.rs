//! Conversion of fractions of length and angle to NURBS parameters.
//!
//! A rational quadratic segment of sweep s reaches the angle s/2 + 2 atan((2t − 1) tan(s/4)) at its parameter t: with
//! the weights (1, cos(s/2), 1), the half-angle tangent about its middle is linear in t.

use crate::model::profile::{profile_knots, profile_segments};
use crate::scene::{Geometry, ProfilePiece, Region, Scene};
use crate::spline::{Patch, Spans, greville_points, segment_count};

/// Halvings of an interval after which it has no more digits.
const BISECTIONS: usize = 53;

/// Finds the parameters of a point at fractions of the length or the angle in u and v.
pub fn parameters_of(geometry: &Geometry, fractions: [f64; 2]) -> [f64; 2] {
    let [u, v] = fractions;
    match geometry {
        Geometry::Plate { .. } | Geometry::Nurbs(_) => [u, v],
        Geometry::TapeSpring { arc_deg, .. }
        | Geometry::CylinderPanel { arc_deg, .. }
        | Geometry::Annulus { arc_deg, .. } => [u, on_arc(*arc_deg, v)],
        Geometry::Profile { profile, .. } => [u, on_profile(profile, v)],
        Geometry::SphereZone { latitude_deg: [from, to], arc_deg, .. } => [on_arc(*arc_deg, u), on_arc(to - from, v)],
    }
}

/// Finds the fractions of the length or the angle in u and v of a point by its parameters: [`parameters_of`], which ascends, the other
/// way round.
pub fn fractions_of(geometry: &Geometry, parameters: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|direction| {
        let parameter = parameters[direction];
        let at = |fraction: f64| parameters_of(geometry, [fraction; 2])[direction];
        if at(parameter) == parameter {
            return parameter;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            *if at(middle) < parameter { &mut low } else { &mut high } = middle;
        }
        0.5 * (low + high)
    })
}

/// Finds the parameter at a fraction of the angle of an arc.
fn on_arc(arc_deg: f64, fraction: f64) -> f64 {
    let sweep = arc_deg.to_radians();
    let segments = segment_count(sweep) as f64;
    let segment = (fraction * segments).floor().clamp(0.0, segments - 1.0);
    let within = fraction * segments - segment;
    if within <= 0.0 || within >= 1.0 || within == 0.5 {
        return (segment + within) / segments;
    }
    (segment + in_segment(sweep / segments, within)) / segments
}

/// Parameter of one segment of a sweep (radians) at a fraction of its angle.
fn in_segment(sweep: f64, fraction: f64) -> f64 {
    0.5 + 0.5 * (0.5 * (fraction - 0.5) * sweep).tan() / (0.25 * sweep).tan()
}

/// Finds the parameter at a fraction of the length of a profile, whose knots are at fractions of it.
fn on_profile(profile: &[ProfilePiece], fraction: f64) -> f64 {
    let segments = profile_segments(profile);
    let ends = profile_knots(&segments);
    // The start and the ends of segments stay what they are.
    let Some(index) = ends.iter().position(|end| fraction < *end) else { return 1.0 };
    let from = if index == 0 { 0.0 } else { ends[index - 1] };
    let within = (fraction - from) / (ends[index] - from);
    let is_curved = segments[index].turn != 0.0 && within > 0.0 && within != 0.5;
    let t = if is_curved { in_segment(segments[index].turn.abs(), within) } else { within };
    from + (ends[index] - from) * t
}

/// Lists sample parameters of a direction: the ends and the middles of its spans.
pub(super) fn sample_parameters(patch: &Patch, direction: usize) -> Vec<f64> {
    let bounds = Spans::of(&patch.knots[direction], patch.degree[direction]).bounds;
    bounds.iter().flat_map(|[from, to]| [*from, 0.5 * (from + to)]).chain([1.0]).collect()
}

/// A line across the surface, or an edge, in parameters of a mesh.
#[derive(Clone, Copy, Debug)]
pub struct LinePlace {
    /// Direction (0 or 1) whose parameter is constant on it.
    pub direction: usize,
    /// Value of that parameter.
    pub parameter: f64,
    /// First control index in that direction whose function lies beyond the line.
    pub first_beyond: usize,
}

/// Finds where a line or an edge lies; `None` for other places.
pub fn line_place(scene: &Scene, patch: &Patch, on: Region) -> Option<LinePlace> {
    let Region::Line(direction, fraction) = on else { return None };
    let direction = direction.index();
    let parameter = parameters_of(&scene.geometry, [fraction; 2])[direction];
    let greville = greville_points(&patch.knots[direction], patch.degree[direction]);
    let first_beyond = greville.iter().position(|at| *at > parameter).unwrap_or(greville.len());
    Some(LinePlace { direction, parameter, first_beyond })
}
