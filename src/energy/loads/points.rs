//! Quadrature points of loads on lines and areas of the surface.

use crate::model::{PointCounts, Site, gauss_points};
use crate::scene::{Edge, ForceVector, LoadedArea, Scene};
use crate::shell::{add, cross, dot, norm, scaled, sub};
use crate::spline::{Patch, Spans, evaluate_surface, mid_surface_point};

/// A quadrature point of a load.
#[derive(Debug)]
pub(super) struct LoadPoint {
    /// Control points whose functions do not vanish there, in the order of the functions.
    pub controls: Vec<usize>,
    /// Values of the functions, and their derivatives ,1 and ,2.
    pub functions: [Vec<f64>; 3],
    /// Position of the point on the undeformed surface, with its tangents.
    pub site: Site,
    /// Load times quadrature weight at factor 1.
    pub weight: f64,
}

impl LoadPoint {
    /// Creates a point of the surface at some parameters.
    pub fn new(patch: &Patch, at: [f64; 2], weight: f64) -> Self {
        let (first, [value, one, two, ..]) = evaluate_surface(patch, at);
        let surface = mid_surface_point(patch, &[], at);
        let tangents = [surface.derivatives[0], surface.derivatives[1]];
        let site = Site { position: surface.position, tangents, edge: None };
        Self { controls: patch.window(first).collect(), functions: [value, one, two], site, weight }
    }

    /// Area per parameter area, of the surface or of its projection along a force.
    pub fn area(&self, per: LoadedArea, force: ForceVector) -> f64 {
        let normal = cross(self.site.tangents[0], self.site.tangents[1]);
        match (per, force) {
            (LoadedArea::Projected, ForceVector::Components(force)) if norm(force) > 0.0 => {
                (dot(normal, force) / norm(force)).abs()
            }
            _ => norm(normal),
        }
    }

    /// The point where the first control point of its patch has the number `first`.
    pub fn shifted(mut self, first: usize) -> Self {
        self.controls.iter_mut().for_each(|control| *control += first);
        self
    }

    /// Tangents a₁, a₂ of the deformed surface.
    pub fn deformed(&self, displacement: &[[f64; 3]]) -> [[f64; 3]; 2] {
        let mut tangents = self.site.tangents;
        for (a, control) in self.controls.iter().copied().enumerate() {
            for k in 0..2 {
                tangents[k] = add(tangents[k], scaled(self.functions[1 + k][a], displacement[control]));
            }
        }
        tangents
    }

    /// Motion of the surface at the point from one displacement to another, mm.
    pub fn motion(&self, from: &[[f64; 3]], to: &[[f64; 3]]) -> [f64; 3] {
        let shares = self.controls.iter().zip(&self.functions[0]);
        shares.fold([0.0; 3], |sum, (control, share)| add(sum, scaled(*share, sub(to[*control], from[*control]))))
    }
}

/// Finds the Gauss points of an edge; weights are undeformed lengths, mm.
pub(super) fn edge_points(patch: &Patch, edge: Edge, limits: [f64; 2]) -> Vec<LoadPoint> {
    let (direction, at_end) = edge.side();
    let mut points = line_points(patch, direction.index(), if at_end { 1.0 } else { 0.0 }, limits);
    points.iter_mut().for_each(|point| point.site.edge = Some(edge));
    points
}

/// Finds the Gauss points of the line on which the parameter of `direction` is `at`; weights are undeformed lengths,
/// mm.
pub(super) fn line_points(patch: &Patch, direction: usize, at: f64, limits: [f64; 2]) -> Vec<LoadPoint> {
    let running = 1 - direction;
    let mut points = Vec::new();
    if at >= limits[direction] {
        return points;
    }
    let spans = patch.element_counts()[running];
    for [parameter, weight] in load_points(patch, running, &vec![0; spans], limits[running]) {
        let place = if direction == 0 { [at, parameter] } else { [parameter, at] };
        let mut point = LoadPoint::new(patch, place, weight);
        point.weight *= norm(point.site.tangents[running]);
        points.push(point);
    }
    points
}

/// Finds the Gauss points of the surface, element by element; weights are parameter areas. In each direction there are
/// at least as many as stretching has: membrane forces carry a pressure, and where its forces are summed up less
/// exactly than theirs, bending takes the difference (at R/t = 3000, on eight cubic elements a quarter turn and p + 2
/// points for stretching, a pressure on p − 1 points inside is 32 % off).
pub(super) fn area_points(scene: &Scene, patch: &Patch, limits: [f64; 2]) -> Vec<LoadPoint> {
    let least = PointCounts::of(scene, patch);
    let [along, across] =
        [0, 1].map(|direction| load_points(patch, direction, &least.most()[direction], limits[direction]));
    let pairs = along.iter().flat_map(|one| across.iter().map(move |two| (one, two)));
    let mut points: Vec<_> = pairs.map(|([u, wu], [v, wv])| LoadPoint::new(patch, [*u, *v], wu * wv)).collect();
    points.sort_by_key(|point| point.controls[0]);
    points
}

/// Finds the Gauss points in every span, or in the part of it below `limit`, at least `least` in each. A pressure
/// integrates N x,₁ × x,₂, of degree 3p − 1 in each direction: so many points are exact where the weights are equal,
/// and only then is its tangent symmetric to rounding.
fn load_points(patch: &Patch, direction: usize, least: &[usize], limit: f64) -> Vec<[f64; 2]> {
    let count = (3 * patch.degree[direction]).div_ceil(2);
    let spans = Spans::of(&patch.knots[direction], patch.degree[direction]);
    let in_part = |([from, to], least): (&[f64; 2], &usize)| gauss_points([*from, to.min(limit)], count.max(*least));
    spans.bounds.iter().zip(least).filter(|([from, _], _)| *from < limit).flat_map(in_part).collect()
}
