//! Energies of the pose of a rigid section as terms: sums over its control points.

use std::fmt::Debug;

use super::frame::{POSE, SectionFrame};
use crate::energy::term::pairs_among;
use crate::energy::{At, Tangent, Term};
use crate::shell::{FrameVector, TANGENTS, add, dot, scaled};
use crate::spline::Mesh;

/// Gradient and Hessian of an energy with respect to the mean displacement of the control points, p and q.
#[derive(Clone, Copy, Debug)]
pub(super) struct Derivatives {
    pub gradient: [f64; POSE],
    pub hessian: [[f64; POSE]; POSE],
}

impl Derivatives {
    /// Derivatives of an energy that is zero.
    pub const ZERO: Self = Self { gradient: [0.0; POSE], hessian: [[0.0; POSE]; POSE] };

    /// Adds those of an energy whose derivative by a vector d of the pose is `force`, and by d twice the diagonal `stiffness`. d moves
    /// with the mean displacement where `is_place`.
    pub fn add(&mut self, d: &FrameVector, is_place: bool, force: [f64; 3], stiffness: [f64; 3]) {
        let slope = |k: usize| -> [f64; 3] {
            match k.checked_sub(3) {
                Some(p) => d.first[p],
                None if is_place => crate::shell::basis_vector(k),
                None => [0.0; 3],
            }
        };
        for k in 0..POSE {
            let of_k = slope(k);
            self.gradient[k] += dot(force, of_k);
            let stiff = [0, 1, 2].map(|c| stiffness[c] * of_k[c]);
            for l in 0..POSE {
                self.hessian[k][l] += dot(stiff, slope(l));
            }
        }
        for p in 0..TANGENTS {
            for q in 0..TANGENTS {
                self.hessian[3 + p][3 + q] += dot(force, d.second[p][q]);
            }
        }
    }
}

/// An energy, or the work of a load, as a function of the pose of a section.
pub(super) trait PoseLaw: Debug + Send + Sync {
    /// Computes the energy that is stored, N·mm; 0 for a load.
    fn energy(&self, frame: &SectionFrame, at: At) -> f64;

    /// Computes the derivatives of the energy less the work.
    fn derivatives(&self, frame: &SectionFrame, at: At) -> Derivatives;

    /// Computes what changes in the second derivatives per unit of the parameter, where the control points move at these rates by linear
    /// theory and keep their geometry.
    fn stressed(&self, frame: &SectionFrame, at: At, rates: &[[f64; 3]]) -> Derivatives;

    /// Computes the rates of the gradient with the parameter where nothing moves.
    fn gradient_rates(&self, frame: &SectionFrame, at: At) -> [f64; POSE];

    /// Computes the work of a load over a motion at factor 1; `None` where energy is stored.
    fn stroke(&self, frame: &SectionFrame, from: &[[f64; 3]], to: &[[f64; 3]]) -> Option<f64>;

    /// The factor of a load.
    fn factor(&self, parameter: f64) -> Option<f64>;
}

/// An energy of the pose of a section.
#[derive(Debug)]
pub(super) struct Hung<L> {
    pub frame: SectionFrame,
    pub law: L,
}

impl<L: PoseLaw> Hung<L> {
    fn spread(&self, gradient: &[f64; POSE], factor: f64, forces: &mut [[f64; 3]]) {
        for (point, shares) in &self.frame.points {
            for k in 0..3 {
                let part = [gradient[3 * k], gradient[3 * k + 1], gradient[3 * k + 2]];
                forces[*point] = add(forces[*point], scaled(factor * shares[k], part));
            }
        }
    }

    fn add_hessian(&self, hessian: &[[f64; POSE]; POSE], tangent: &mut Tangent) {
        for (i, shares_i) in &self.frame.points {
            for (j, shares_j) in &self.frame.points {
                let mut slope = [[0.0; 3]; 3];
                for k in 0..3 {
                    for l in 0..3 {
                        let share = shares_i[k] * shares_j[l];
                        for c in 0..3 {
                            for d in 0..3 {
                                slope[c][d] -= share * hessian[3 * k + c][3 * l + d];
                            }
                        }
                    }
                }
                tangent.add([*i, *j], slope);
            }
        }
    }
}

impl<L: PoseLaw> Term for Hung<L> {
    fn pairs(&self) -> Vec<[usize; 2]> {
        pairs_among(self.frame.points.iter().map(|(point, _)| *point))
    }

    fn energy(&self, at: At) -> f64 {
        self.law.energy(&self.frame, at)
    }

    fn add_forces(&self, at: At, forces: &mut [[f64; 3]]) {
        self.spread(&self.law.derivatives(&self.frame, at).gradient, -1.0, forces);
    }

    fn has_tangent(&self) -> bool {
        true
    }

    fn add_tangent(&self, at: At, tangent: &mut Tangent) {
        self.add_hessian(&self.law.derivatives(&self.frame, at).hessian, tangent);
    }

    fn add_stress_stiffness(&self, at: At, rates: &[[f64; 3]], tangent: &mut Tangent) {
        self.add_hessian(&self.law.stressed(&self.frame, at, rates).hessian, tangent);
    }

    fn add_rates(&self, at: At, rates: &mut [[f64; 3]]) {
        self.spread(&self.law.gradient_rates(&self.frame, at), -1.0, rates);
    }

    fn strokes(&self, _: &Mesh, from: &[[f64; 3]], to: &[[f64; 3]]) -> Vec<f64> {
        self.law.stroke(&self.frame, from, to).into_iter().collect()
    }

    fn factors(&self, parameter: f64) -> Vec<f64> {
        self.law.factor(parameter).into_iter().collect()
    }
}
