//! Points of the area over which two shells are glued: where their faces lie together.

use super::coupled::{CoupledPoint, SurfaceSide};
use super::glue::Glue;
use crate::model::{Member, ModelError, gauss_points, moduli_mpa};
use crate::scene::Bond;
use crate::shell::{add, cross, dot, norm, scaled, sub};
use crate::spline::{Patch, Spans, SurfacePoint, mid_surface_point};
use crate::units::place;

/// Distance of faces that lie together, relative to the mean thickness.
const TOGETHER: f64 = 1e-3;
/// Cosine of the angle between faces from which on they lie together.
const PARALLEL: f64 = 0.99;
/// Distance along the surface by which the nearest point may miss the normal, relative to the thickness.
const BESIDE: f64 = 1e-3;
/// Samples of each span from which nearest points are searched.
const STARTS: usize = 2;
/// Largest number of steps to a nearest point.
const STEPS: usize = 30;

/// Finds the points at which two shells are glued, where their perfect surfaces lie together; the layer keeps the gap that the shells
/// have.
///
/// # Errors
/// Where their faces do not lie together anywhere, or the shells cross each other.
pub(super) fn glued_points(
    bond: &Bond,
    members: &[Member],
    perfect: &[Member],
) -> Result<Vec<CoupledPoint<Glue>>, ModelError> {
    let [sides, searched] = [members, perfect].map(|members| bond.shells.map(|shell| &members[shell]));
    let thickness = sides.map(|side| side.scene.material.thickness_mm());
    let mean = 0.5 * (thickness[0] + thickness[1]);
    let tolerance = bond.gap_mm.unwrap_or(TOGETHER * mean);
    let [one, other] = sides.map(|side| moduli_mpa(&side.scene.material)[1]);
    let stiffness = bond.stiffness * one.max(other) / mean;
    let other = Searched::new(searched[1].patch);
    let (mut points, mut nearest) = (Vec::new(), (f64::INFINITY, [0.0; 3]));
    let mut guess = None;
    for (at, weight) in points_of(searched[0].patch, other.patch) {
        let here = mid_surface_point(searched[0].patch, &[], at);
        let found = other.nearest(here.position, guess);
        guess = Some(found);
        let there = mid_surface_point(other.patch, &[], found);
        let Some((sign, gap)) = facing(&here, &there, mean) else { continue };
        if gap < nearest.0 {
            nearest = (gap, here.position);
        }
        if gap < -tolerance {
            return Err(ModelError::ShellsCross { bond: bond.name.clone(), by: -gap, at: place(here.position) });
        }
        if gap > tolerance {
            continue;
        }
        let area = weight * norm(cross(here.derivatives[0], here.derivatives[1]));
        points.push(glued(sides, [at, found], sign, stiffness * area, thickness));
    }
    match points.is_empty() {
        true => Err(ModelError::NothingGlued {
            bond: bond.name.clone(),
            gap: nearest.0.is_finite().then_some(nearest.0),
            at: place(nearest.1),
            most: tolerance,
        }),
        false => Ok(points),
    }
}

/// The signs of the sides on which the faces lie that look at each other, as seen along the normals, and their distance; `None` where
/// the shells do not face each other.
fn facing(here: &SurfacePoint, there: &SurfacePoint, mean: f64) -> Option<([f64; 2], f64)> {
    let normal = |point: &SurfacePoint| {
        let normal = cross(point.derivatives[0], point.derivatives[1]);
        scaled(1.0 / norm(normal), normal)
    };
    let (own, others) = (normal(here), normal(there));
    let apart = sub(there.position, here.position);
    let along = dot(apart, own);
    let beside = norm(sub(apart, scaled(along, own)));
    let aligned = dot(own, others);
    if beside > BESIDE * mean || aligned.abs() < PARALLEL {
        return None;
    }
    let sign = along.signum();
    Some(([sign, -sign * aligned.signum()], along.abs() - mean))
}

fn glued(
    sides: [&Member; 2],
    at: [[f64; 2]; 2],
    signs: [f64; 2],
    stiffness: f64,
    thickness: [f64; 2],
) -> CoupledPoint<Glue> {
    let [here, there] = [0, 1].map(|k| mid_surface_point(sides[k].patch, &[], at[k]).position);
    let surfaces = [0, 1].map(|k| SurfaceSide::new(sides[k].patch, sides[k].points.start, at[k]));
    let undeformed = surfaces.each_ref().map(|side| side.undeformed);
    let to_faces = [0, 1].map(|k| 0.5 * signs[k] * thickness[k]);
    let flat = Glue { stiffness, to_faces, gap: [0.0; 3], at_rest: [0.0; 3] };
    let apart = sub(here, there);
    let gap = add(apart, flat.across(&undeformed));
    // Components of the gap on a₁, a₂ and a₃.
    let [_, a1, a2] = undeformed[0];
    let normal = cross(a1, a2);
    let square = dot(normal, normal);
    let components =
        [dot(gap, cross(a2, normal)) / square, dot(gap, cross(normal, a1)) / square, dot(gap, normal) / square.sqrt()];
    let law = Glue { gap: components, ..flat };
    CoupledPoint { sides: surfaces, law: Glue { at_rest: law.across(&undeformed), ..law } }
}

/// Quadrature points of a patch with their weights in the parameters: as many as the degree in each direction of each element, and more
/// where elements of the other patch are shorter.
fn points_of(patch: &Patch, other: &Patch) -> Vec<([f64; 2], f64)> {
    let finest = |patch: &Patch, direction: usize| {
        let spans = Spans::of(&patch.knots[direction], patch.degree[direction]).bounds;
        let length = |[from, to]: &[f64; 2]| (to - from) * norm(tangent_at(patch, direction, 0.5 * (from + to)));
        spans.iter().map(length).fold(f64::INFINITY, f64::min)
    };
    let [along, across] = [0, 1].map(|direction| {
        // Elements of the other patch in the direction that runs alike.
        let own = tangent_at(patch, direction, 0.5);
        let alike = |other_direction: usize| {
            let tangent = tangent_at(other, other_direction, 0.5);
            dot(own, tangent).abs() / norm(tangent)
        };
        let shortest = finest(other, if alike(0) >= alike(1) { 0 } else { 1 });
        let parts = (finest(patch, direction) / shortest - 1e-9).ceil().clamp(1.0, 4.0) as usize;
        let spans = Spans::of(&patch.knots[direction], patch.degree[direction]).bounds;
        let pieces = move |[from, to]: [f64; 2]| {
            (0..parts).map(move |k| [k, k + 1].map(|k| from + (to - from) * k as f64 / parts as f64))
        };
        let count = patch.degree[direction];
        spans
            .into_iter()
            .map(|span| pieces(span).flat_map(|piece| gauss_points(piece, count)).collect::<Vec<_>>())
            .collect::<Vec<_>>()
    });
    // Element by element, so that points of one element follow each other.
    let mut points = Vec::new();
    for one in &along {
        for two in &across {
            for [u, du] in one {
                points.extend(two.iter().map(|[v, dv]| ([*u, *v], du * dv)));
            }
        }
    }
    points
}

/// The tangent of a patch in a direction, in the middle of the other one.
fn tangent_at(patch: &Patch, direction: usize, at: f64) -> [f64; 3] {
    mid_surface_point(patch, &[], if direction == 0 { [at, 0.5] } else { [0.5, at] }).derivatives[direction]
}

/// A patch on which nearest points are searched.
struct Searched<'a> {
    patch: &'a Patch,
    samples: Vec<([f64; 2], [f64; 3])>,
}

impl<'a> Searched<'a> {
    fn new(patch: &'a Patch) -> Self {
        let [us, vs] = [0, 1].map(|direction| {
            let spans = Spans::of(&patch.knots[direction], patch.degree[direction]).bounds;
            let within = |[from, to]: [f64; 2]| (0..STARTS).map(move |k| from + (to - from) * k as f64 / STARTS as f64);
            spans.into_iter().flat_map(within).chain([1.0]).collect::<Vec<f64>>()
        });
        let all = us.iter().flat_map(|u| vs.iter().map(move |v| [*u, *v]));
        Self { patch, samples: all.map(|at| (at, mid_surface_point(patch, &[], at).position)).collect() }
    }

    /// Finds the parameters of the point nearest to another one, from a guess that is likely near.
    fn nearest(&self, point: [f64; 3], guess: Option<[f64; 2]>) -> [f64; 2] {
        let away = |at: [f64; 2]| {
            let apart = sub(mid_surface_point(self.patch, &[], at).position, point);
            dot(apart, apart)
        };
        let near = |(_, position): &([f64; 2], [f64; 3])| {
            let apart = sub(*position, point);
            dot(apart, apart)
        };
        let start = self
            .samples
            .iter()
            .min_by(|one, other| near(one).total_cmp(&near(other)))
            .map_or([0.5; 2], |found| found.0);
        let tried = [Some(start), guess].into_iter().flatten().map(|start| self.descend(point, start));
        tried.min_by(|one, other| away(*one).total_cmp(&away(*other))).unwrap_or(start)
    }

    /// Newton's method without the curvature, within the parameters.
    fn descend(&self, point: [f64; 3], mut at: [f64; 2]) -> [f64; 2] {
        for _ in 0..STEPS {
            let surface = mid_surface_point(self.patch, &[], at);
            let [a1, a2, ..] = surface.derivatives;
            let gap = sub(point, surface.position);
            let (g11, g12, g22) = (dot(a1, a1), dot(a1, a2), dot(a2, a2));
            let (b1, b2) = (dot(gap, a1), dot(gap, a2));
            let determinant = g11 * g22 - g12 * g12;
            let step = [(g22 * b1 - g12 * b2) / determinant, (g11 * b2 - g12 * b1) / determinant];
            let next = [0, 1].map(|k| (at[k] + step[k]).clamp(0.0, 1.0));
            let moved = (next[0] - at[0]).abs().max((next[1] - at[1]).abs());
            at = next;
            if moved < 1e-14 {
                break;
            }
        }
        at
    }
}
