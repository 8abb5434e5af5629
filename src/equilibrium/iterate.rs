//! The iterates of a solve, and its effort.

use crate::equilibrium::force_scale::ForceScale;
use crate::equilibrium::vector::largest;
use crate::model::Unknowns;

/// State of a solve after an iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Iterate {
    /// Number of Newton steps taken.
    pub iteration: usize,
    /// Energy that the model stores, N·mm: strain energy and that of other terms.
    pub energy: f64,
    /// Norm of the residual on the free unknowns, |Tᵀ (g − f)|, N.
    pub residual: f64,
    /// Forces that the residual is compared with.
    pub forces: ForceScale,
    /// Number of negative pivots of the last factored stiffness.
    pub negative_pivots: usize,
    /// Step length along the last direction; 1 is a full Newton step.
    pub step_length: f64,
    /// Twice the largest magnitude of a negative pivot, N/mm, which is what making it positive adds; 0 where there is
    /// none.
    pub shift: f64,
    /// Control point with the largest residual.
    pub worst_point: usize,
    /// Energy that has left the balance of the model since the start of a descent, if reactions stay what they were,
    /// N·mm.
    pub released: f64,
}

impl Iterate {
    /// Creates the iterate of a point with this gradient on the free unknowns, whose stiffness is not factored yet.
    pub(super) fn at(unknowns: &Unknowns, energy: f64, forces: ForceScale, gradient: &[f64], effort: Effort) -> Self {
        Self {
            iteration: effort.iterations,
            energy,
            residual: gradient.iter().map(|g| g * g).sum::<f64>().sqrt(),
            forces,
            negative_pivots: 0,
            step_length: 1.0,
            shift: 0.0,
            worst_point: unknowns.home_of(largest(gradient)),
            released: 0.0,
        }
    }

    /// Whether energy and residual are numbers.
    pub fn is_finite(&self) -> bool {
        self.energy.is_finite() && self.residual.is_finite()
    }

    /// Norm of the residual divided by the forces that it is compared with.
    pub fn relative_residual(&self) -> f64 {
        self.forces.share(self.residual)
    }

    /// Whether forces balance to this tolerance.
    pub fn is_equilibrium(&self, tolerance: f64) -> bool {
        self.forces.balances(self.residual, tolerance)
    }
}

/// Iterations and factorizations that a solve spent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Effort {
    /// Number of Newton iterations.
    pub iterations: usize,
    /// Number of numeric factorizations.
    pub factorizations: usize,
}

impl Effort {
    /// Adds the effort of another solve.
    pub fn and(self, other: Self) -> Self {
        Self {
            iterations: self.iterations + other.iterations,
            factorizations: self.factorizations + other.factorizations,
        }
    }
}

/// Callback that sees every iterate; returning `true` stops the solve.
pub type Observer<'o> = &'o mut dyn FnMut(&Iterate) -> bool;
