//! The parts of a Newton iteration one by one, for timing.

use crate::energy::Want;
use crate::equilibrium::configuration::Configuration;
use crate::equilibrium::solve_error::SolveError;
use crate::equilibrium::workspace::Workspace;
use crate::model::{PointTable, Tables};

/// Operations and bytes of the parts of a Newton iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct KernelCost {
    /// Floating-point operations of Σ Fᵀ H F, of which the upper half is formed.
    pub assembly_flops: f64,
    /// Bytes of the tables that an assembly reads: functions and undeformed points.
    pub table_bytes: f64,
    /// Floating-point operations of L D Lᵀ.
    pub factor_flops: f64,
    /// Bytes of the factor.
    pub factor_bytes: f64,
    /// Largest number of threads that can share factor and solution.
    pub factor_threads: usize,
}

/// The parts of a Newton iteration at one state; each call of one does the same work.
#[derive(Debug)]
pub struct KernelRun<'a> {
    work: &'a mut Workspace,
    at: Configuration<'a>,
    free: Vec<f64>,
    right_hand_side: Vec<f64>,
}

impl<'a> KernelRun<'a> {
    /// Prepares the parts at a state whose stiffness has a factor.
    ///
    /// # Errors
    /// Where the stiffness has no factor.
    pub fn new(work: &'a mut Workspace, at: Configuration<'a>) -> Result<Self, SolveError> {
        let free = at.free(&work.discretization.unknowns);
        let right_hand_side = (0..free.len()).map(|i| 1.0 + (i % 7) as f64).collect();
        let mut run = Self { work, at, free, right_hand_side };
        run.newton_iteration()?;
        Ok(run)
    }

    /// Counts the operations and bytes of the parts.
    pub fn cost(&self) -> KernelCost {
        let all: Vec<&Tables> = self.work.discretization.shells.iter().map(|shell| &shell.tables).collect();
        // For each function a, with r derivatives: 9 r² products for P, and 9 r with each function b ≥ a.
        let flops = |functions: usize, points: usize, rows: usize| -> f64 {
            let of_function = |a: usize| 18 * rows * (rows + functions - a);
            (points * (0..functions).map(of_function).sum::<usize>()) as f64
        };
        let assembly_flops = |tables: &&Tables| {
            let (functions, stretching) = (tables.functions_per_element, tables.stretching.as_ref());
            flops(functions, tables.points.references.len(), 5)
                + stretching.map_or(0.0, |table| flops(functions, table.references.len(), 2))
        };
        let bytes = |tables: &&Tables| tables.points.bytes() + tables.stretching.as_ref().map_or(0, PointTable::bytes);
        KernelCost {
            assembly_flops: all.iter().map(assembly_flops).sum(),
            table_bytes: all.iter().map(bytes).sum::<usize>() as f64,
            factor_flops: self.work.tangent.solver.flops(),
            factor_bytes: 8.0 * self.work.tangent.solver.factor_len() as f64,
            factor_threads: self.work.tangent.solver.most_threads(),
        }
    }

    /// Assembles stiffness and residual on the control points.
    pub fn assemble(&mut self) {
        self.work.assembled.assemble(
            &self.work.discretization,
            self.at.displacement,
            self.at.parameter,
            Want::Stiffness,
        );
    }

    /// Assembles the residual alone.
    pub fn residual(&mut self) {
        self.work.assembled.assemble(
            &self.work.discretization,
            self.at.displacement,
            self.at.parameter,
            Want::Residual,
        );
    }

    /// Forms the matrix on the unknowns from what was assembled last.
    pub fn form(&mut self) {
        let Workspace { discretization, tangent, assembled, .. } = &mut *self.work;
        let placement = discretization.unknowns.configure(&self.free, self.at.parameter);
        tangent.form(discretization, &placement, assembled);
    }

    /// Factorizes the formed matrix in place.
    ///
    /// # Errors
    /// Where the stiffness has no factor.
    pub fn factor(&mut self) -> Result<(), SolveError> {
        self.work.tangent.factorize_formed().map(|_| ())
    }

    /// Solves for one right-hand side.
    pub fn solve(&mut self) {
        let mut right_hand_side = self.right_hand_side.clone();
        self.work.tangent.solver.solve(&mut right_hand_side);
    }

    /// Runs a whole Newton iteration.
    ///
    /// # Errors
    /// As for [`Self::factor`].
    pub fn newton_iteration(&mut self) -> Result<(), SolveError> {
        self.assemble();
        self.form();
        self.factor()?;
        self.solve();
        Ok(())
    }
}
