//! The tangent stiffness on the free unknowns, and its factor.

use crate::equilibrium::assembly::Assembled;
use crate::equilibrium::blocks::Blocks;
use crate::equilibrium::external::External;
use crate::equilibrium::pattern::{Pattern, couplings};
use crate::equilibrium::sparse::{FactorError, NegativePivots, SparseSolver};
use crate::model::{Discretization, Placement};

/// Where its entries come from, and the solver that holds them.
#[derive(Debug)]
pub(super) struct TangentStiffness {
    pattern: Pattern,
    pub(super) solver: SparseSolver,
}

impl TangentStiffness {
    /// For a mesh.
    ///
    /// # Errors
    /// Where the factor does not fit in memory.
    pub(super) fn new(discretization: &Discretization) -> Result<Self, FactorError> {
        let solver = SparseSolver::new(&couplings(discretization))?;
        Ok(Self { pattern: Pattern::new(discretization, &solver), solver })
    }

    /// The matrix at a point, Tᵀ K T and what the curvature of the supports adds: its symmetric part where loads turn with
    /// the shell. What factor there was is lost.
    pub(super) fn form(
        &mut self,
        discretization: &Discretization,
        placement: &Placement,
        assembled: &Assembled,
        external: &External,
    ) -> &[f64] {
        self.pattern.fill(discretization, placement, &assembled.stiffness, self.solver.matrix_mut());
        self.solver.add(&placement.curvature(&external.subtract_from(&assembled.residual)));
        self.solver.matrix_mut()
    }

    /// Forms the matrix at a point and factors it; where loads turn with the shell, they keep a copy of it.
    ///
    /// # Errors
    /// Where a pivot is zero or not a number.
    pub(super) fn factorize(
        &mut self,
        discretization: &Discretization,
        placement: &Placement,
        assembled: &Assembled,
        external: &mut External,
    ) -> Result<NegativePivots, FactorError> {
        let matrix = self.form(discretization, placement, assembled, external);
        if external.has_skew() {
            external.keep(matrix);
        }
        self.solver.factorize()
    }

    /// Tᵀ A T for blocks A, as the numbers of a matrix.
    pub(super) fn project(&self, discretization: &Discretization, placement: &Placement, blocks: &Blocks) -> Vec<f64> {
        let mut values = vec![0.0; self.solver.value_count()];
        self.pattern.fill(discretization, placement, blocks, &mut values);
        values
    }
}
