//! Energies at points at which two surfaces meet, and their sums over control points.
//!
//! An energy at such a point is a function of the displacement u and the tangents a₁, a₂ of both surfaces, 18 numbers y: positions
//! are rounded by a share of the size of the structure, which the stiffness of a thin layer would make forces of. With
//! y = Y + Σ N u, where each of u, a₁, a₂ has functions of its own (values and first derivatives), forces are −Σ N ∂E/∂y and the
//! tangent −Σ N ∂²E/∂y² N. Points of one pair of elements are summed up together; sums over groups are formed in one order, whatever
//! the number of threads.

use std::fmt::Debug;
use std::ops::Range;

use rayon::prelude::*;

use crate::energy::{At, Tangent, Term};
use crate::shell::{add, dot, scaled};
use crate::spline::{Patch, evaluate_surface, mid_surface_point};

/// Displacement and tangents of a surface at a point.
pub(super) type Local = [[f64; 3]; 3];

/// Number of components of [`Local`].
pub(super) const LOCAL: usize = 9;
/// First of them that belongs to a tangent.
pub(super) const FIRST_TANGENT: usize = 3;

/// Gradient and Hessian of an energy with respect to the components of both surfaces, those of the first one first.
pub(super) struct Derivatives {
    pub gradient: [f64; 2 * LOCAL],
    pub hessian: [[f64; 2 * LOCAL]; 2 * LOCAL],
}

impl Derivatives {
    /// Derivatives of an energy that is zero.
    pub fn zero() -> Self {
        Self { gradient: [0.0; 2 * LOCAL], hessian: [[0.0; 2 * LOCAL]; 2 * LOCAL] }
    }
}

/// An energy at a point at which two surfaces meet.
pub(super) trait PointLaw: Debug + Send + Sync {
    /// Computes the energy, N·mm.
    fn energy(&self, sides: &[Local; 2]) -> f64;

    /// Adds the derivatives of the energy.
    fn add_derivatives(&self, sides: &[Local; 2], sums: &mut Derivatives);

    /// Returns the law with the forces on it that rates of both surfaces cause, in the same geometry.
    fn stressed(&self, sides: &[Local; 2], rates: &[Local; 2]) -> Self
    where
        Self: Sized;
}

/// Share of the rates along which laws differentiate what strains them.
const SLIGHTLY: f64 = 1e-4;

/// Both surfaces after a small motion at these rates, forwards and backwards, and its length.
pub(super) fn moved(sides: &[Local; 2], rates: &[Local; 2]) -> ([Local; 2], [Local; 2], f64) {
    let tangents =
        |local: &[Local; 2]| local.iter().flat_map(|side| &side[1..]).map(|a| dot(*a, *a)).sum::<f64>().sqrt();
    let step = SLIGHTLY * tangents(sides) / tangents(rates).max(f64::MIN_POSITIVE);
    let at = |step: f64| [0, 1].map(|side| [0, 1, 2].map(|k| add(sides[side][k], scaled(step, rates[side][k]))));
    (at(step), at(-step), 2.0 * step)
}

/// A point of one surface.
#[derive(Clone, Debug)]
pub(super) struct SurfaceSide {
    /// Its parameters (u, v).
    pub at: [f64; 2],
    /// Control points, numbered as in the structure.
    pub controls: Vec<usize>,
    /// Functions of u, a₁ and a₂.
    pub functions: [Vec<f64>; 3],
    /// Where it is undeformed, mm.
    pub position: [f64; 3],
    /// No displacement, and a₁ and a₂ of the undeformed surface.
    pub undeformed: Local,
}

impl SurfaceSide {
    /// The point of a patch at some parameters, where the first control point of the patch has the number `first`.
    pub fn new(patch: &Patch, first: usize, at: [f64; 2]) -> Self {
        let (window, [value, one, two, ..]) = evaluate_surface(patch, at);
        let surface = mid_surface_point(patch, &[], at);
        Self {
            at,
            controls: patch.window(window).map(|point| first + point).collect(),
            functions: [value, one, two],
            position: surface.position,
            undeformed: [[0.0; 3], surface.derivatives[0], surface.derivatives[1]],
        }
    }

    /// u, a₁ and a₂ at a displacement of the control points.
    pub fn deformed(&self, displacement: &[[f64; 3]]) -> Local {
        let rates = self.rates(displacement);
        [0, 1, 2].map(|k| add(self.undeformed[k], rates[k]))
    }

    /// Rates of u, a₁ and a₂ at rates of the control points.
    fn rates(&self, displacement: &[[f64; 3]]) -> Local {
        let mut local = [[0.0; 3]; 3];
        for (a, control) in self.controls.iter().enumerate() {
            for k in 0..3 {
                local[k] = add(local[k], scaled(self.functions[k][a], displacement[*control]));
            }
        }
        local
    }
}

/// A point at which two surfaces meet.
#[derive(Debug)]
pub(super) struct CoupledPoint<L> {
    pub sides: [SurfaceSide; 2],
    pub law: L,
}

impl<L> CoupledPoint<L> {
    /// u, a₁ and a₂ of both surfaces at a displacement of the control points.
    pub fn deformed(&self, displacement: &[[f64; 3]]) -> [Local; 2] {
        self.sides.each_ref().map(|side| side.deformed(displacement))
    }

    fn controls(&self) -> impl Iterator<Item = usize> {
        self.sides.iter().flat_map(|side| side.controls.iter().copied())
    }

    fn is_beside(&self, other: &Self) -> bool {
        (0..2).all(|k| self.sides[k].controls == other.sides[k].controls)
    }
}

/// The sum of an energy over points.
#[derive(Debug)]
pub(super) struct Coupling<L> {
    pub points: Vec<CoupledPoint<L>>,
    /// Points of one pair of elements.
    groups: Vec<Range<usize>>,
}

impl<L: PointLaw> Coupling<L> {
    /// Creates the sum; points of one pair of elements that follow each other are taken together.
    pub fn new(points: Vec<CoupledPoint<L>>) -> Self {
        let mut first = 0;
        let group = |group: &[CoupledPoint<L>]| {
            first += group.len();
            first - group.len()..first
        };
        let groups = points.chunk_by(CoupledPoint::is_beside).map(group).collect();
        Self { points, groups }
    }

    /// Computes what `of` makes of each group, in their order.
    fn of_groups<T: Send>(&self, of: impl Fn(&[CoupledPoint<L>]) -> T + Sync) -> Vec<T> {
        self.groups.par_iter().map(|group| of(&self.points[group.clone()])).collect()
    }
}

impl<L: PointLaw> Term for Coupling<L> {
    fn pairs(&self) -> Vec<[usize; 2]> {
        let of_group = |group: &Range<usize>| {
            let [one, other] = &self.points[group.start].sides;
            one.controls.iter().flat_map(|i| other.controls.iter().map(|j| [*i, *j])).collect::<Vec<_>>()
        };
        self.groups.iter().flat_map(of_group).collect()
    }

    fn energy(&self, at: At) -> f64 {
        let of_group = |points: &[CoupledPoint<L>]| -> f64 {
            points.iter().map(|point| point.law.energy(&point.deformed(at.displacement))).sum()
        };
        self.of_groups(of_group).iter().sum::<f64>() + 0.0
    }

    fn add_forces(&self, at: At, forces: &mut [[f64; 3]]) {
        let sums = self.of_groups(|points| group_forces(points, at.displacement));
        for (group, sums) in self.groups.iter().zip(sums) {
            for (control, force) in self.points[group.start].controls().zip(sums) {
                forces[control] = add(forces[control], force);
            }
        }
    }

    fn has_tangent(&self) -> bool {
        true
    }

    fn add_tangent(&self, at: At, tangent: &mut Tangent) {
        let add = |point: &CoupledPoint<L>, sums: &mut Derivatives| {
            point.law.add_derivatives(&point.deformed(at.displacement), sums);
        };
        self.add_groups(&add, tangent);
    }

    fn add_stress_stiffness(&self, at: At, rates: &[[f64; 3]], tangent: &mut Tangent) {
        let add = |point: &CoupledPoint<L>, sums: &mut Derivatives| {
            let sides = point.deformed(at.displacement);
            let of_rates = point.sides.each_ref().map(|side| side.rates(rates));
            // A law is quadratic in what stresses it: the difference of both senses leaves what is linear.
            let [with, against] = [1.0, -1.0].map(|sign| {
                let mut sums = Derivatives::zero();
                let rates = of_rates.map(|side| side.map(|rate| scaled(sign, rate)));
                point.law.stressed(&sides, &rates).add_derivatives(&sides, &mut sums);
                sums.hessian
            });
            let both = with.as_flattened().iter().zip(against.as_flattened());
            sums.hessian.as_flattened_mut().iter_mut().zip(both).for_each(|(sum, (a, b))| *sum += 0.5 * (a - b));
        };
        self.add_groups(&add, tangent);
    }
}

impl<L: PointLaw> Coupling<L> {
    /// Adds the derivatives of all points to a tangent.
    fn add_groups(&self, add: &(dyn Fn(&CoupledPoint<L>, &mut Derivatives) + Sync), tangent: &mut Tangent) {
        let sums = self.of_groups(|points| GroupTangent::of(points, add));
        for (group, sums) in self.groups.iter().zip(sums) {
            let controls: Vec<usize> = self.points[group.start].controls().collect();
            for (a, i) in controls.iter().enumerate() {
                for (b, j) in controls.iter().enumerate().skip(a) {
                    tangent.add_symmetric([*i, *j], sums.slope(a, b));
                }
            }
        }
    }
}

/// Forces on the control points of a group, N.
fn group_forces<L: PointLaw>(points: &[CoupledPoint<L>], displacement: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let count = points.first().map_or(0, |point| point.controls().count());
    let mut forces = vec![[0.0; 3]; count];
    for point in points {
        let mut sums = Derivatives::zero();
        point.law.add_derivatives(&point.deformed(displacement), &mut sums);
        let mut rest = &mut forces[..];
        for (side, gradient) in point.sides.iter().zip(sums.gradient.chunks(LOCAL)) {
            let (own, others) = rest.split_at_mut(side.controls.len());
            rest = others;
            for (a, force) in own.iter_mut().enumerate() {
                for k in 0..3 {
                    (0..3).for_each(|c| force[c] -= side.functions[k][a] * gradient[3 * k + c]);
                }
            }
        }
    }
    forces
}

/// Derivatives of the forces of a group by the displacements of its control points.
struct GroupTangent {
    controls: usize,
    /// Of the forces c on a by the displacements d of b: `numbers[((b · 3 + d) · 3 + c) · controls + a]`, N/mm.
    numbers: Vec<f64>,
}

impl GroupTangent {
    fn of<L: PointLaw>(points: &[CoupledPoint<L>], add: &dyn Fn(&CoupledPoint<L>, &mut Derivatives)) -> Self {
        let controls = points.first().map_or(0, |point| point.controls().count());
        let mut tangent = Self { controls, numbers: vec![0.0; 9 * controls * controls] };
        for point in points {
            let mut sums = Derivatives::zero();
            add(point, &mut sums);
            let mut b = 0;
            for (side, of_side) in point.sides.iter().enumerate() {
                for index in 0..of_side.controls.len() {
                    let functions = [0, 1, 2].map(|l| of_side.functions[l][index]);
                    tangent.add_column(point, b, &half(&sums.hessian, side, functions));
                    b += 1;
                }
            }
        }
        tangent
    }

    /// Subtracts Σ_k N_k(a) (H N_b)_{kc,d} for every control point a.
    fn add_column<L>(&mut self, point: &CoupledPoint<L>, b: usize, half: &[[f64; 3]; 2 * LOCAL]) {
        let mut first = 0;
        for (side, of_side) in point.sides.iter().enumerate() {
            let length = of_side.controls.len();
            for k in 0..3 {
                for c in 0..3 {
                    for d in 0..3 {
                        let share = half[side * LOCAL + 3 * k + c][d];
                        let from = ((b * 3 + d) * 3 + c) * self.controls + first;
                        let sums = &mut self.numbers[from..from + length];
                        sums.iter_mut().zip(&of_side.functions[k]).for_each(|(sum, n)| *sum -= share * n);
                    }
                }
            }
            first += length;
        }
    }

    fn slope(&self, a: usize, b: usize) -> [[f64; 3]; 3] {
        [0, 1, 2].map(|c| [0, 1, 2].map(|d| self.numbers[((b * 3 + d) * 3 + c) * self.controls + a]))
    }
}

/// Multiplies a Hessian by the functions of one control point.
fn half(hessian: &[[f64; 2 * LOCAL]; 2 * LOCAL], side: usize, functions: [f64; 3]) -> [[f64; 3]; 2 * LOCAL] {
    let mut half = [[0.0; 3]; 2 * LOCAL];
    for (row, half) in hessian.iter().zip(&mut half) {
        for l in 0..3 {
            (0..3).for_each(|d| half[d] += row[side * LOCAL + 3 * l + d] * functions[l]);
        }
    }
    half
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Checks gradient and Hessian of a law by finite differences.
    pub fn check(law: &impl PointLaw, sides: &[Local; 2], size: f64) {
        let step = 1e-6;
        let moved = |p: usize, by: f64| {
            let mut moved = *sides;
            moved[p / LOCAL][p % LOCAL / 3][p % 3] += by;
            moved
        };
        let derivatives = |sides: &[Local; 2]| {
            let mut sums = Derivatives::zero();
            law.add_derivatives(sides, &mut sums);
            sums
        };
        let here = derivatives(sides);
        for p in 0..2 * LOCAL {
            let slope = (law.energy(&moved(p, step)) - law.energy(&moved(p, -step))) / (2.0 * step);
            assert!((slope - here.gradient[p]).abs() < 1e-7 * size, "{p}: {slope} {}", here.gradient[p]);
            let (after, before) = (derivatives(&moved(p, step)), derivatives(&moved(p, -step)));
            for q in 0..2 * LOCAL {
                let bend = (after.gradient[q] - before.gradient[q]) / (2.0 * step);
                assert!((bend - here.hessian[p][q]).abs() < 1e-6 * size, "{p} {q}: {bend} {}", here.hessian[p][q]);
            }
        }
    }
}
