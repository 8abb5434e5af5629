//! The tangent stiffness on the free unknowns, and its factor.

use crate::equilibrium::assembly::Assembled;
use crate::equilibrium::gmres::gmres;
use crate::equilibrium::iterate::Effort;
use crate::equilibrium::pattern::{Pattern, couplings};
use crate::equilibrium::solve_error::SolveError;
use crate::equilibrium::sparse::{FactorError, NegativePivots, SparseSolver};
use crate::model::{Blocks, Discretization, Placement};

/// Residual of a solution where the tangent has a skew part, relative; Newton's convergence asks for no more.
const SKEW_TOLERANCE: f64 = 1e-9;
/// Iterations at most there: the skew part comes from free edges alone, so that its rank, in effect, is small.
const SKEW_ITERATIONS: usize = 100;

/// Where its entries come from, and the solver that holds them.
#[derive(Debug)]
pub(super) struct TangentStiffness {
    pattern: Pattern,
    pub(super) solver: SparseSolver,
    /// The symmetric part of the matrix, which its factor takes the place of; empty where there is no skew one.
    symmetric: Vec<f64>,
}

impl TangentStiffness {
    /// For a mesh.
    ///
    /// # Errors
    /// Where the factor does not fit in memory.
    pub(super) fn new(discretization: &Discretization) -> Result<Self, FactorError> {
        let solver = SparseSolver::new(&couplings(discretization))?;
        Ok(Self { pattern: Pattern::new(discretization, &solver), solver, symmetric: Vec::new() })
    }

    /// The matrix at a point, Tᵀ K T and what the curvature of the supports adds: its symmetric part where loads turn with
    /// the shell, and a copy of that is kept. What factor there was is lost.
    pub(super) fn form(&mut self, discretization: &Discretization, placement: &Placement, assembled: &Assembled) {
        self.pattern.fill(discretization, placement, &assembled.stiffness, self.solver.matrix_mut());
        self.solver.add(&placement.curvature(&assembled.forces()));
        self.symmetric = if assembled.has_skew() { self.solver.matrix_mut().to_vec() } else { Vec::new() };
    }

    /// Factors the matrix that was formed or filled in; not counted in the effort of a solve.
    pub(super) fn factorize_formed(&mut self) -> Result<NegativePivots, SolveError> {
        let factored = self.solver.factorize();
        factored.map_err(|cause| SolveError::Factor { cause, effort: Effort::default() })
    }

    /// A copy of the matrix that was formed: its factor takes the place of it.
    pub(super) fn matrix(&mut self) -> Vec<f64> {
        self.solver.matrix_mut().to_vec()
    }

    /// Forms the matrix at a point and factors it.
    ///
    /// # Errors
    /// Where a pivot is zero or not a number.
    pub(super) fn factorize(
        &mut self,
        discretization: &Discretization,
        placement: &Placement,
        assembled: &Assembled,
    ) -> Result<NegativePivots, FactorError> {
        self.form(discretization, placement, assembled);
        self.solver.factorize()
    }

    /// Solves the whole system at a point where the tangent has a skew part: the factor of the symmetric one is at hand.
    pub(super) fn solve_whole(
        &self,
        discretization: &Discretization,
        placement: &Placement,
        assembled: &Assembled,
        right_hand_side: &[f64],
    ) -> Vec<f64> {
        let whole = |x: &[f64]| {
            let mut product = self.solver.multiply(&self.symmetric, x);
            let moved = placement.velocity(x, &[]);
            let skew = placement.restrict(&assembled.multiply_skew(discretization, &moved));
            product.iter_mut().zip(skew).for_each(|(a, b)| *a += b);
            product
        };
        gmres(right_hand_side, whole, |x| self.solver.solve(x), SKEW_TOLERANCE, SKEW_ITERATIONS)
    }

    /// Tᵀ A T for blocks A, as the numbers of a matrix.
    pub(super) fn project(&self, discretization: &Discretization, placement: &Placement, blocks: &Blocks) -> Vec<f64> {
        let mut values = vec![0.0; self.solver.value_count()];
        self.pattern.fill(discretization, placement, blocks, &mut values);
        values
    }
}
