//! Planes of symmetry through lines inside the shell.
//!
//! On the line ξ = ξ₀ a field that is even about the plane has no component across it, and the derivative ∂u/∂ξ has none
//! in it. With u = A/W, A = Σ N_i(ξ) M_j(η) w_ij u_ij and W alike, both are conditions on splines in η,
//!
//! A_⊥ = 0 and (A_,ξ − (W_,ξ/W) A)_∥ = 0,
//!
//! of which the second is one only where W_,ξ/W = c is the same all along the line. Then they hold on the whole line
//! exactly where they hold for each j, whether there is a knot at ξ₀ or not: Σ_i N_i w_ij u_ij,⊥ = 0 and Σ_i (N_i′ − c
//! N_i) w_ij u_ij,∥ = 0. The undeformed surface must meet them itself; then so does the deformed one, at any rotation.

use crate::model::expressions::{Sum, line_terms, nonzero, shares};
use crate::model::symmetry_plane::NoPlane;
use crate::shell::{add, scaled};
use crate::spline::Patch;

/// Difference of shares of weights along a line below which it is rounding.
const EVEN: f64 = 1e-9;

/// A line of a mesh that a plane of symmetry can hold.
pub(super) struct Line {
    /// Displacements of the line's control points as a curve, as weighted sums over control points of the mesh; weights
    /// sum to 1.
    pub places: Vec<Sum>,
    /// Derivatives of the displacement across the line, as such sums, relative to the largest weight.
    pub slopes: Vec<Sum>,
}

impl Line {
    /// Creates the line on which the parameter of `direction` has a value.
    ///
    /// # Errors
    /// Where no spline can keep its slope there.
    pub(super) fn new(patch: &Patch, direction: usize, parameter: f64) -> Result<Self, NoPlane> {
        let mut line = Self { places: Vec::new(), slopes: Vec::new() };
        let mut rate = None;
        for [value, slope] in line_terms(patch, direction, parameter) {
            let sum = |terms: &Sum| terms.iter().map(|(_, factor)| factor).sum::<f64>();
            let steepest = slope.iter().map(|(_, factor)| factor.abs()).fold(0.0, f64::max);
            let total = sum(&value);
            let rate = *rate.get_or_insert(sum(&slope) / total);
            if (sum(&slope) - rate * total).abs() > EVEN * steepest {
                return Err(NoPlane::UnevenWeights);
            }
            let even = |((point, slope), (_, value)): (&(usize, f64), &(usize, f64))| {
                (*point, (slope - rate * value) / steepest)
            };
            line.slopes.push(nonzero(slope.iter().zip(&value).map(even).collect()));
            line.places.push(shares(&value));
        }
        Ok(line)
    }

    /// Control points of the line as a curve, mm.
    pub(super) fn points(&self, patch: &Patch) -> Vec<[f64; 3]> {
        sums_of(patch, &self.places)
    }

    /// Steps across the line from each of its control points, relative to the largest weight.
    pub(super) fn steps(&self, patch: &Patch) -> Vec<[f64; 3]> {
        sums_of(patch, &self.slopes)
    }
}

/// Evaluates weighted sums of the control points, mm.
fn sums_of(patch: &Patch, sums: &[Sum]) -> Vec<[f64; 3]> {
    let of_sum = |sum: &Sum| {
        sum.iter().fold([0.0; 3], |to, (point, factor)| {
            let [x, y, z, w] = patch.control_points[*point];
            add(to, scaled(factor / w, [x, y, z]))
        })
    };
    sums.iter().map(of_sum).collect()
}
