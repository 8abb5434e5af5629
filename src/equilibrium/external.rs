//! Loads in the equations: forces beside the internal ones, and their tangent.
//!
//! The symmetric part of the tangent goes into the assembled stiffness; the skew part, where loads turn with the shell,
//! is kept beside it.

use crate::equilibrium::assembly::Assembled;
use crate::equilibrium::blocks::Blocks;
use crate::equilibrium::gmres::gmres;
use crate::equilibrium::sparse::SparseSolver;
use crate::model::{Discretization, Loads, Placement};

/// Residual of a solution where the tangent has a skew part, relative; Newton's convergence asks for no more.
const SKEW_TOLERANCE: f64 = 1e-9;
/// Iterations at most there: the skew part comes from free edges alone, so that its rank, in effect, is small.
const SKEW_ITERATIONS: usize = 100;

/// Forces of the loads at a displacement.
#[derive(Debug, Default)]
pub(super) struct External {
    /// On the control points, N; empty where nothing acts.
    pub forces: Vec<[f64; 3]>,
    /// −½ (∂f/∂u − ∂f/∂uᵀ); empty where nothing turns with the shell.
    skew: Blocks,
    /// The symmetric part of the matrix on the unknowns; empty where there is no skew one.
    symmetric: Vec<f64>,
}

impl External {
    /// Forces alone.
    pub fn forces_at(discretization: &Discretization, displacement: &[[f64; 3]], parameter: f64) -> Vec<[f64; 3]> {
        match discretization.loads.is_empty() {
            true => Vec::new(),
            false => discretization.loads.forces(&discretization.mesh, displacement, parameter),
        }
    }

    /// Forces where no load follows the shell.
    pub fn dead(discretization: &Discretization, displacement: &[[f64; 3]], parameter: f64) -> Self {
        Self { forces: Self::forces_at(discretization, displacement, parameter), ..Self::default() }
    }

    /// Forces and tangent; the symmetric part of the tangent is added to the stiffness in `assembled`.
    pub fn new(
        discretization: &Discretization,
        displacement: &[[f64; 3]],
        parameter: f64,
        assembled: &mut Assembled,
    ) -> Self {
        let forces = Self::forces_at(discretization, displacement, parameter);
        let mut external = Self { forces, skew: Blocks::default(), symmetric: Vec::new() };
        if discretization.loads.follow() {
            external.skew = Blocks::zeros(&discretization.blocks);
            external.add_tangent(&discretization.loads, discretization, displacement, parameter, assembled);
        }
        external
    }

    fn add_tangent(
        &mut self,
        loads: &Loads,
        discretization: &Discretization,
        displacement: &[[f64; 3]],
        parameter: f64,
        assembled: &mut Assembled,
    ) {
        loads.tangent(&discretization.mesh, displacement, parameter, |part| {
            let [i, j] = part.points;
            let Some(block) = discretization.blocks.block(i.min(j), i.max(j)) else {
                unreachable!("a load couples control points {i} and {j}, which share no element")
            };
            let stiffness = assembled.stiffness.block_mut(block);
            let skew = self.skew.block_mut(block);
            for c in 0..3 {
                for d in 0..3 {
                    let half = 0.5 * part.block[c][d];
                    if i <= j {
                        stiffness[3 * c + d] -= half;
                        skew[3 * c + d] -= half;
                    }
                    if j <= i {
                        stiffness[3 * d + c] -= half;
                        skew[3 * d + c] += half;
                    }
                }
            }
        });
    }

    /// g − f.
    pub fn subtract_from(&self, internal: &[[f64; 3]]) -> Vec<[f64; 3]> {
        subtract(internal, &self.forces)
    }

    /// Keeps the symmetric part of the matrix on the unknowns, which a factorization takes the place of.
    pub fn keep(&mut self, symmetric: &[f64]) {
        self.symmetric = symmetric.to_vec();
    }

    /// Whether there is a skew part.
    pub fn has_skew(&self) -> bool {
        !self.skew.is_empty()
    }

    /// The skew part times a field on the control points.
    pub fn multiply_skew(&self, discretization: &Discretization, field: &[[f64; 3]]) -> Vec<[f64; 3]> {
        match self.has_skew() {
            true => self.skew.multiply(&discretization.blocks, -1.0, field),
            false => vec![[0.0; 3]; field.len()],
        }
    }
}

impl External {
    /// Solves the whole system, the symmetric part of which is factored in `solver` and stands in the matrix.
    pub fn solve(
        &self,
        discretization: &Discretization,
        placement: &Placement,
        solver: &SparseSolver,
        right_hand_side: &[f64],
    ) -> Vec<f64> {
        let whole = |x: &[f64]| {
            let mut product = solver.multiply(&self.symmetric, x);
            let moved = placement.velocity(x, &[]);
            let skew = placement.restrict(&self.multiply_skew(discretization, &moved));
            product.iter_mut().zip(skew).for_each(|(a, b)| *a += b);
            product
        };
        gmres(right_hand_side, whole, |x| solver.solve(x), SKEW_TOLERANCE, SKEW_ITERATIONS)
    }
}

/// g − f; `external` may be empty.
pub(super) fn subtract(internal: &[[f64; 3]], external: &[[f64; 3]]) -> Vec<[f64; 3]> {
    if external.is_empty() {
        return internal.to_vec();
    }
    internal.iter().zip(external).map(|(g, f)| [0, 1, 2].map(|c| g[c] - f[c])).collect()
}
