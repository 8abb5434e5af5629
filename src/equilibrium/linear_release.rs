//! The energy that a state out of balance releases on its way to equilibrium, to first order.

use crate::equilibrium::descent::product;
use crate::equilibrium::newton::{Standing, Workspace};
use crate::equilibrium::solve_error::SolveError;

impl Workspace {
    /// ½ rᵀK⁻¹r of the model with the residual r on the free unknowns and the stiffness K at a state, N·mm; negative where K
    /// is not positive definite and r mostly in its negative part.
    ///
    /// # Errors
    /// Where the stiffness has no factor.
    pub fn linear_release(&mut self, at: Standing) -> Result<f64, SolveError> {
        self.factorize_at(at)?;
        let forces = self.forces(at);
        let unknowns = &self.discretization.unknowns;
        let free = unknowns.of_displacement(at.displacement, at.turns, at.parameter);
        let residual = unknowns.place(&free, at.parameter).restrict(&forces);
        let mut step = residual.clone();
        self.tangent.solver.solve(&mut step);
        Ok(0.5 * product(&residual, &step))
    }
}
