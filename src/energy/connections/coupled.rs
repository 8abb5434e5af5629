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
use crate::shell::{add, scaled};
use crate::spline::{Patch, evaluate_surface, mid_surface_point};

/// Displacement and tangents of a surface at a point.
pub(super) type Local = [[f64; 3]; 3];

/// Number of components of [`Local`].
pub(super) const LOCAL: usize = 9;

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
}

/// A point of one surface.
#[derive(Clone, Debug)]
pub(super) struct SurfaceSide {
    /// Control points, numbered as in the structure.
    pub controls: Vec<usize>,
    /// Functions of u, a₁ and a₂.
    functions: [Vec<f64>; 3],
    /// No displacement, and a₁ and a₂ of the undeformed surface.
    pub undeformed: Local,
}

impl SurfaceSide {
    /// The point of a patch at some parameters, where the first control point of the patch has the number `first`.
    pub fn new(patch: &Patch, first: usize, at: [f64; 2]) -> Self {
        let (window, [value, one, two, ..]) = evaluate_surface(patch, at);
        let surface = mid_surface_point(patch, &[], at);
        Self {
            controls: patch.window(window).map(|point| first + point).collect(),
            functions: [value, one, two],
            undeformed: [[0.0; 3], surface.derivatives[0], surface.derivatives[1]],
        }
    }

    /// u, a₁ and a₂ at a displacement of the control points.
    pub fn deformed(&self, displacement: &[[f64; 3]]) -> Local {
        let mut local = self.undeformed;
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
        let sums = self.of_groups(|points| group_tangent(points, at.displacement));
        for (group, slopes) in self.groups.iter().zip(sums) {
            let controls: Vec<usize> = self.points[group.start].controls().collect();
            for (i, row) in controls.iter().zip(slopes.chunks(controls.len())) {
                for (j, slope) in controls.iter().zip(row) {
                    tangent.add([*i, *j], *slope);
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

/// Derivatives of the forces of a group, `slopes[a · controls + b][c][d]`, N/mm.
fn group_tangent<L: PointLaw>(points: &[CoupledPoint<L>], displacement: &[[f64; 3]]) -> Vec<[[f64; 3]; 3]> {
    let count = points.first().map_or(0, |point| point.controls().count());
    let mut slopes = vec![[[0.0; 3]; 3]; count * count];
    for point in points {
        let mut sums = Derivatives::zero();
        point.law.add_derivatives(&point.deformed(displacement), &mut sums);
        let functions: Vec<(usize, [f64; 3])> = point
            .sides
            .iter()
            .enumerate()
            .flat_map(|(side, of)| (0..of.controls.len()).map(move |a| (side, [0, 1, 2].map(|k| of.functions[k][a]))))
            .collect();
        for (b, (side, of_b)) in functions.iter().enumerate() {
            // H N_b: 18 × 3.
            let mut half = [[0.0; 3]; 2 * LOCAL];
            for (row, half) in sums.hessian.iter().zip(&mut half) {
                for l in 0..3 {
                    (0..3).for_each(|d| half[d] += row[side * LOCAL + 3 * l + d] * of_b[l]);
                }
            }
            for (a, (side, of_a)) in functions.iter().enumerate() {
                let slope = &mut slopes[a * count + b];
                for k in 0..3 {
                    for c in 0..3 {
                        let row = &half[side * LOCAL + 3 * k + c];
                        (0..3).for_each(|d| slope[c][d] -= of_a[k] * row[d]);
                    }
                }
            }
        }
    }
    slopes
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Checks gradient and Hessian of a law by finite differences, and that a rigid motion of both surfaces costs nothing.
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
