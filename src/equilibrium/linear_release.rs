//! The energy that a state out of balance releases on its way to equilibrium, to first order.

use crate::equilibrium::configuration::{Configuration, Coordinates};
use crate::equilibrium::solve_error::SolveError;
use crate::equilibrium::vector::product;
use crate::equilibrium::workspace::Workspace;
use crate::shell::norm;

/// First-order estimate of the motion to equilibrium and its energy, with the residual r on the free unknowns and the
/// stiffness K.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LinearRelease {
    /// Energy that the model releases, ½ rᵀK⁻¹r, N·mm; negative where K is not positive definite and r lies mostly in
    /// its negative part.
    pub energy: f64,
    /// Largest motion of a control point in K⁻¹r, mm.
    pub motion_mm: f64,
    /// Displacement of the control points after the motion K⁻¹r, mm.
    pub displacement: Vec<[f64; 3]>,
    /// Rotation vectors of the rigid sections after that motion, radians, where one of them turns freely.
    pub turns: Vec<[f64; 3]>,
}

impl Workspace {
    /// Estimates the energy that a state out of balance releases.
    ///
    /// # Errors
    /// Where the stiffness has no factor.
    pub fn linear_release(&mut self, at: Configuration) -> Result<LinearRelease, SolveError> {
        self.factorize_at(at)?;
        let forces = self.forces(at);
        let unknowns = &self.discretization.unknowns;
        let Coordinates { free, placement, .. } = Coordinates::of(unknowns, at);
        let residual = placement.restrict(&forces);
        let mut step = residual.clone();
        self.tangent.solver.solve(&mut step);
        let motion_mm = placement.velocity(&step, &[]).iter().map(|motion| norm(*motion)).fold(0.0, f64::max);
        let moved: Vec<f64> = free.iter().zip(&step).map(|(value, change)| value + change).collect();
        let relaxed = Coordinates::at(unknowns, moved, at.parameter);
        let energy = 0.5 * product(&residual, &step);
        let turns = relaxed.placement.turns();
        Ok(LinearRelease { energy, motion_mm, displacement: relaxed.displacement, turns })
    }
}
