//! What a residual is compared with: equilibrium has an absolute sense.
//!
//! Forces balance where what is left of their sum is small compared with the forces themselves. Which ones?
//!
//! - Reactions and loads, as long as there are any: what M, and every other reaction, is measured in. Forces of terms that store
//!   energy are internal, as the shell's: a plate that lies on a foundation balances the load on it though it carries nothing.
//! - A shell that is let go has neither, though it may be under stress (a cured laminate, a coiled tape on determinate
//!   supports): there it is the forces of its elements before they are summed. On control points these cancel but for
//!   reactions and loads, so they are much the larger, and count by a share alone.
//! - A shell that is unloaded keeps no force at all: there it is the largest of these that the run has met, by a share
//!   again, since a shell that has snapped carries a tenth of what it carried before and is to be found as precisely.
//! - Rounding is below all of it: displacements that are off by their last bit already exert ε |K| |u|. But where that is more
//!   than a thousandth of the loads, rounding hides them, and a solve continues until it meets its limits.
//!
//! All are Euclidean norms, over control points, and over the control points of each element: the sum Σ |f_e| of
//! magnitudes would grow with the number of elements for one and the same stress, which the norm of membrane forces does
//! not.

use crate::energy::Discretization;
use crate::equilibrium::assembly::{Assembled, subtract};
use crate::equilibrium::vector::length;

/// Factor by which the forces of the elements count.
const OF_ELEMENTS: f64 = 1e-3;

/// Factor by which the largest forces met before count.
const OF_FORCES_MET: f64 = 1e-3;

/// Number of roundings in the strain of a displacement, each of its last bit. A plate of 3 × 3 cubic elements that a
/// section carries off by 1 mm, without any strain, has a residual of two to three.
const ROUNDINGS: f64 = 8.0;

/// Share of known forces up to which a residual is taken for rounding. A strip of 100 mm and 1 µm has roundings above its
/// load, and did not move at all where they were taken for balance.
const OF_KNOWN: f64 = 1e-3;

/// Reactions below this many roundings count as none.
const CLEAR: f64 = 30.0;

/// Forces that the residual at a point is compared with, N.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ForceScale {
    /// Forces that act here, N: the largest of the norm of the internal forces on all control points (at equilibrium,
    /// the reactions), those of the loads and of the free strain, and a share of the elements' forces before they are
    /// summed.
    pub acting: f64,
    /// Largest forces at the equilibria of the run so far, N.
    pub met: f64,
    /// Forces that a rounding error of the displacement causes, N.
    pub rounding: f64,
    /// Residual below which only rounding is left, N: [`Self::rounding`], but never more than a small share of the
    /// forces that act.
    pub floor: f64,
}

impl ForceScale {
    /// Measures the forces at a displacement, at which forces and stiffness are assembled.
    pub(super) fn at(
        discretization: &Discretization,
        assembled: &Assembled,
        displacement: &[[f64; 3]],
        met: f64,
    ) -> Self {
        let own = assembled.stiffness.diagonal(&discretization.blocks).zip(displacement);
        let squares = own.flat_map(|(block, u)| [0, 1, 2].map(|c| (block[4 * c] * u[c]).powi(2)));
        let rounding = ROUNDINGS * f64::EPSILON * squares.sum::<f64>().sqrt();
        let Assembled { residual, external, internal, .. } = assembled;
        let [reactions, loads] = match internal.is_empty() {
            true => [length(residual), length(external)],
            false => [length(&subtract(residual, internal)), length(&subtract(external, internal))],
        };
        // Loads are known, and so are reactions that are clear of the rounding.
        let known = match loads > 0.0 {
            true => loads,
            false if reactions > CLEAR * rounding => reactions,
            false => f64::INFINITY,
        };
        Self {
            acting: reactions.max(loads).max(assembled.free_strain_forces).max(OF_ELEMENTS * assembled.element_forces),
            met,
            rounding,
            floor: rounding.min(OF_KNOWN * known),
        }
    }

    /// Force that a relative residual refers to, N.
    pub fn force(&self) -> f64 {
        self.acting.max(OF_FORCES_MET * self.met)
    }

    /// Whether a residual is negligible compared with the forces, to this tolerance.
    pub fn balances(&self, residual: f64, tolerance: f64) -> bool {
        residual <= (tolerance * self.force()).max(self.floor)
    }

    /// Residual relative to the forces; 0 where there are none.
    pub fn share(&self, residual: f64) -> f64 {
        if self.force() > 0.0 { residual / self.force() } else { 0.0 }
    }

    /// Largest forces of the run, including those of this point, N.
    pub fn met_here(&self) -> f64 {
        self.met.max(self.acting)
    }
}
