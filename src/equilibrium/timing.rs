//! The pieces of a Newton iteration one by one, for timing.

use crate::equilibrium::assembly::Want;
use crate::equilibrium::external::External;
use crate::equilibrium::newton::{Standing, Workspace};
use crate::equilibrium::solve_error::SolveError;

/// What the pieces have to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KernelCost {
    /// Floating-point operations of Σ Fᵀ H F, upper half.
    pub assembly_flops: f64,
    /// Bytes of the tables that an assembly reads: functions and undeformed points.
    pub table_bytes: f64,
    /// Floating-point operations of L D Lᵀ.
    pub factor_flops: f64,
    /// Bytes of the factor.
    pub factor_bytes: f64,
}

/// The pieces at one state; each call does the same work.
#[derive(Debug)]
pub struct KernelRun<'a> {
    work: &'a mut Workspace,
    at: Standing<'a>,
}

impl<'a> KernelRun<'a> {
    /// At a state whose stiffness has a factor.
    ///
    /// # Errors
    /// Where it has none.
    pub fn new(work: &'a mut Workspace, at: Standing<'a>) -> Result<Self, SolveError> {
        work.factorize_at(at)?;
        Ok(Self { work, at })
    }

    /// Cost of the pieces.
    pub fn cost(&self) -> KernelCost {
        let tables = &self.work.discretization.tables;
        let [p1, p2] = self.work.discretization.mesh.degree;
        let functions = (p1 + 1) * (p2 + 1);
        let points = tables.points.len() as f64;
        let per_point: f64 = (0..functions).map(|a| 2.0 * (225.0 + 45.0 * (functions - a) as f64)).sum();
        KernelCost {
            assembly_flops: points * per_point,
            table_bytes: (size_of_val(&tables.functions[..]) + size_of_val(&tables.batches[..])) as f64,
            factor_flops: self.work.tangent.solver.flops(),
            factor_bytes: 8.0 * self.work.tangent.solver.factor_len() as f64,
        }
    }

    /// Stiffness and residual on the control points.
    pub fn assemble(&mut self) {
        self.work.assembled.assemble(&self.work.discretization, self.at.displacement, Want::Stiffness);
    }

    /// Residual alone.
    pub fn residual(&mut self) {
        self.work.assembled.assemble(&self.work.discretization, self.at.displacement, Want::Residual);
    }

    /// Matrix on the unknowns and its factor.
    pub fn factor(&mut self) {
        let Workspace { discretization, tangent, assembled, .. } = &mut *self.work;
        let free = discretization.unknowns.of_displacement(self.at.displacement, self.at.turns, self.at.parameter);
        let placement = discretization.unknowns.place(&free, self.at.parameter);
        let mut external = External::dead(discretization, self.at.displacement, self.at.parameter);
        // It had a factor in `new`, and the matrix is the same.
        let _ = tangent.factorize(discretization, &placement, assembled, &mut external);
    }

    /// One right-hand side.
    pub fn solve(&mut self) {
        let unknowns = &self.work.discretization.unknowns;
        let free = unknowns.of_displacement(self.at.displacement, self.at.turns, self.at.parameter);
        let placement = unknowns.place(&free, self.at.parameter);
        let mut right_hand_side = placement.restrict(&self.work.assembled.residual);
        self.work.tangent.solver.solve(&mut right_hand_side);
    }

    /// All of it.
    pub fn newton_iteration(&mut self) {
        self.assemble();
        self.factor();
        self.solve();
    }
}
