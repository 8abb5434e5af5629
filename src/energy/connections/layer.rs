//! The layer of glue of a bond: where the faces of its two shells lie together, and how stiff it is there.

use std::borrow::Cow;

use super::coupled::{CoupledPoint, SurfaceSide};
use super::glue::Glue;
use crate::model::moduli_mpa;
use crate::scene::{Bond, Material};
use crate::shell::{add, cross, dot, norm, scaled, shell_stiffness, sub, unit_normal};
use crate::spline::{Patch, Spans, SurfacePoint, find_span, mid_surface_point};

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

/// One of the shells that a bond glues.
#[derive(Clone, Debug)]
pub(super) struct Side<'a> {
    pub patch: &'a Patch,
    /// Its perfect surface, on which is seen what is glued: an imperfection parts no faces, and brings none together.
    pub perfect: Cow<'a, Patch>,
    /// Number of its first control point.
    pub first: usize,
    pub material: &'a Material,
}

/// The layer of a bond.
#[derive(Debug)]
pub(super) struct Layer<'a> {
    sides: [Side<'a>; 2],
    thickness: [f64; 2],
    /// Where the middle of each thickness lies along the normal, off the surface, mm.
    middle: [f64; 2],
    /// Largest distance of faces that are glued, mm.
    pub tolerance: f64,
    /// k, N/mm³.
    pub stiffness: f64,
    /// 1/(1/A₁ + 1/A₂) of the stiffnesses of both shells against stretching, N/mm, and the like against bending, N mm.
    both: [f64; 2],
    searched: [Searched<'a>; 2],
}

/// Points of both shells whose faces look at each other.
#[derive(Debug)]
pub(super) struct Faces {
    /// Parameters of both.
    pub at: [[f64; 2]; 2],
    /// The sides on which the faces lie, as seen along the normals.
    signs: [f64; 2],
    /// Distance of the faces, mm; below 0 where the shells cross each other.
    pub gap: f64,
}

impl<'a> Layer<'a> {
    pub fn new(bond: &Bond, sides: [Side<'a>; 2]) -> Self {
        let thickness = sides.each_ref().map(|side| side.material.thickness_mm());
        let middle = sides.each_ref().map(|side| -side.material.offset_mm());
        let mean = 0.5 * (thickness[0] + thickness[1]);
        let [one, other] = sides.each_ref().map(|side| moduli_mpa(side.material)[1]);
        let of_shells = sides.each_ref().map(|side| {
            let stiffness = shell_stiffness(side.material, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
            [stiffness.membrane, stiffness.bending].map(|matrix| matrix[0][0].max(matrix[1][1]))
        });
        let both = [0, 1].map(|k| of_shells[0][k] * of_shells[1][k] / (of_shells[0][k] + of_shells[1][k]));
        let searched = sides.each_ref().map(|side| Searched::new(side.perfect.clone()));
        Self {
            sides,
            thickness,
            middle,
            tolerance: bond.gap_mm.unwrap_or(TOGETHER * mean),
            stiffness: bond.stiffness * one.max(other) / mean,
            both,
            searched,
        }
    }

    /// The perfect first (0) or second (1) shell.
    pub fn perfect(&self, side: usize) -> &Patch {
        &self.sides[side].perfect
    }

    /// Looks at the faces at a point of one side and the nearest point of the other one, whose parameters `guess` holds after it;
    /// `None` where they do not face each other.
    pub fn faces_at(&self, side: usize, at: [f64; 2], guess: &mut Option<[f64; 2]>) -> Option<Faces> {
        let here = mid_surface_point(&self.sides[side].perfect, &[], at);
        let found = self.searched[1 - side].nearest(here.position, *guess);
        *guess = Some(found);
        self.faces(if side == 0 { [at, found] } else { [found, at] })
    }

    /// Whether faces lie together.
    pub fn is_glued(&self, faces: &Faces) -> bool {
        faces.gap <= self.tolerance
    }

    fn faces(&self, at: [[f64; 2]; 2]) -> Option<Faces> {
        let mean = 0.5 * (self.thickness[0] + self.thickness[1]);
        let points = [0, 1].map(|k| mid_surface_point(&self.sides[k].perfect, &[], at[k]));
        let normals = points.each_ref().map(|SurfacePoint { derivatives: [a1, a2, ..], .. }| unit_normal([*a1, *a2]));
        let positions = points.map(|SurfacePoint { position, .. }| position);
        let apart = sub(positions[1], positions[0]);
        let along = dot(apart, normals[0]);
        let beside = norm(sub(apart, scaled(along, normals[0])));
        let aligned = dot(normals[0], normals[1]);
        if beside > BESIDE * mean || aligned.abs() < PARALLEL {
            return None;
        }
        // From the middle of the one thickness to that of the other.
        let apart = along + aligned.signum() * self.middle[1] - self.middle[0];
        let sign = apart.signum();
        Some(Faces { at, signs: [sign, -sign * aligned.signum()], gap: apart.abs() - mean })
    }

    /// Area of one side to that in its parameters, mm².
    pub fn area_at(&self, side: usize, at: [f64; 2]) -> f64 {
        let [a1, a2, ..] = mid_surface_point(&self.sides[side].perfect, &[], at).derivatives;
        norm(cross(a1, a2))
    }

    /// The parts of the stiffness against slip and opening that are summed up between Greville points, or all of it, N/mm³
    /// ([`super::bonded`]).
    pub fn between(&self, at: [[f64; 2]; 2]) -> [f64; 2] {
        let longest = [0, 1].map(|k| longest_of_element(&self.sides[k].perfect, at[k]));
        let wave = std::f64::consts::PI / longest[0].max(longest[1]);
        [self.both[0] * wave.powi(2), self.both[1] * wave.powi(4)].map(|part| part.min(self.stiffness))
    }

    /// The layer between two faces, over an area in mm², with the stiffnesses of its energy in N/mm³.
    pub fn glued(&self, Faces { at, signs, .. }: &Faces, area: f64, stiffness: [f64; 2]) -> CoupledPoint<Glue> {
        let surfaces = [0, 1].map(|k| SurfaceSide::new(self.sides[k].patch, self.sides[k].first, at[k]));
        let undeformed = surfaces.each_ref().map(|side| side.undeformed);
        let to_faces = [0, 1].map(|k| self.middle[k] + 0.5 * signs[k] * self.thickness[k]);
        let (stiffness, per_area) = (stiffness.map(|k| k * area), self.stiffness);
        let flat = Glue { stiffness, per_area, to_faces, outward: signs[0], gap: [0.0; 3], at_rest: [0.0; 3] };
        let gap = add(sub(surfaces[0].position, surfaces[1].position), flat.across(&undeformed));
        // Components of the gap on a₁, a₂ and a₃.
        let [_, a1, a2] = undeformed[0];
        let normal = cross(a1, a2);
        let square = dot(normal, normal);
        let components = [
            dot(gap, cross(a2, normal)) / square,
            dot(gap, cross(normal, a1)) / square,
            dot(gap, normal) / square.sqrt(),
        ];
        let law = Glue { gap: components, ..flat };
        CoupledPoint { sides: surfaces, law: Glue { at_rest: law.across(&undeformed), ..law } }
    }
}

/// Length of the longer side of an element, mm.
fn longest_of_element(patch: &Patch, at: [f64; 2]) -> f64 {
    let [a1, a2, ..] = mid_surface_point(patch, &[], at).derivatives;
    let length = |direction: usize, tangent| {
        let (knots, degree) = (&patch.knots[direction], patch.degree[direction]);
        let span = find_span(knots, degree, at[direction]);
        (knots[span + 1] - knots[span]) * norm(tangent)
    };
    length(0, a1).max(length(1, a2))
}

/// A patch on which nearest points are searched.
#[derive(Debug)]
struct Searched<'a> {
    patch: Cow<'a, Patch>,
    samples: Vec<([f64; 2], [f64; 3])>,
}

impl<'a> Searched<'a> {
    fn new(patch: Cow<'a, Patch>) -> Self {
        let [us, vs] = [0, 1].map(|k| Spans::of(&patch.knots[k], patch.degree[k]).samples(STARTS));
        let all = us.iter().flat_map(|u| vs.iter().map(move |v| [*u, *v]));
        let samples = all.map(|at| (at, mid_surface_point(&patch, &[], at).position)).collect();
        Self { patch, samples }
    }

    /// Finds the parameters of the point nearest to another one, from a guess that is likely near.
    fn nearest(&self, point: [f64; 3], guess: Option<[f64; 2]>) -> [f64; 2] {
        let away = |at: [f64; 2]| {
            let apart = sub(mid_surface_point(&self.patch, &[], at).position, point);
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
            let surface = mid_surface_point(&self.patch, &[], at);
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
