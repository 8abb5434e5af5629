//! Sparse symmetric matrices on the free unknowns: storage, L D Lᵀ without pivoting, solution.
//!
//! The signs of D give the inertia (Sylvester). Two storages, of which the structure decides: [`strips`] for what is long
//! and narrow in the order of the unknowns, as a tape spring is, and [`supernodal`] for the rest. Factor and solve give
//! the same bits on any number of threads.
//!
//! | file | what |
//! |---|---|
//! | `structure` | which unknowns meet; what a factorization returns |
//! | `envelope` | how far rows reach, and where to cut |
//! | `chain`, `strips`, `strip_kernel` | rows in strips: their arrangement, the solver, its loops |
//! | `graph`, `separator`, `dissection` | an order of elimination for any structure, by nested dissection |
//! | `fronts`, `supernodal`, `dense` | any structure: its dense blocks, the solver, its products |

mod chain;
mod dense;
mod dissection;
mod envelope;
mod fronts;
mod graph;
mod separator;
mod strip_kernel;
mod strips;
mod structure;
mod supernodal;

pub use dense::DenseProduct;
pub use structure::{Couplings, FactorError, NegativePivots};

use crate::energy::Build;
use strips::StripSolver;
use supernodal::SupernodalSolver;

/// Number of operations from which on it pays to analyse whether another order of elimination takes fewer: 1e9 of them
/// take as long as the analysis (some 40 ms).
const WORTH_ASKING_FLOPS: f64 = 1e9;
/// Ratio of the speeds of strips and of fronts, in operations: on 128 × 64 cubic elements strips take 9.7e9 and 0.70 s on one
/// thread, fronts 8.1e9 and 0.76 s. On 128 × 16 elements strips take a third of the operations of fronts.
const STRIPS_PAY: f64 = 1.3;

/// Solver for symmetric matrices of one structure, with room for one matrix, which its factor replaces.
/// [`Self::offset_of`] gives the index of each entry among the [`Self::value_count`] numbers of a matrix.
#[derive(Debug)]
pub enum SparseSolver {
    /// Stores rows of the envelope in strips, eliminated from both ends.
    Strips(StripSolver),
    /// Stores a factor in dense blocks of columns, for any structure.
    Supernodal(SupernodalSolver),
}

impl SparseSolver {
    /// Chooses the storage and analyses the structure.
    ///
    /// # Errors
    /// Where the factor does not fit in memory.
    pub fn new(couplings: &Couplings) -> Result<Self, FactorError> {
        let strips = StripSolver::structure(couplings, Build::detect());
        let size = couplings.unknowns;
        let solver = match strips.flops() < WORTH_ASKING_FLOPS {
            true => Self::Strips(strips.with_room()?),
            false => match SupernodalSolver::structure(couplings) {
                other if strips.flops() > STRIPS_PAY * other.flops() => Self::Supernodal(other.with_room()?),
                _ => Self::Strips(strips.with_room()?),
            },
        };
        match u32::try_from(solver.value_count()) {
            Ok(_) => Ok(solver),
            Err(_) => Err(FactorError::TooLarge { size, entries: solver.value_count() }),
        }
    }

    /// Creates the solver for any structure, whatever this one would be best served by.
    ///
    /// # Errors
    /// Where the factor does not fit in memory.
    pub fn supernodal(couplings: &Couplings) -> Result<Self, FactorError> {
        SupernodalSolver::structure(couplings).with_room().map(Self::Supernodal)
    }

    /// Number of values that a matrix takes: fewer than 2³².
    pub fn value_count(&self) -> usize {
        match self {
            Self::Strips(solver) => solver.value_count(),
            Self::Supernodal(solver) => solver.value_count(),
        }
    }

    /// Offset among the values of the entry of two unknowns, in either order. For unknowns that do not meet but lie
    /// within the envelope, it is an offset that nothing else uses.
    ///
    /// # Panics
    /// Where there is no such entry: what is filled in and the structure come from one pattern, and nothing is left out
    /// in silence.
    pub fn offset_of(&self, a: usize, b: usize) -> usize {
        let place = match self {
            Self::Strips(solver) => solver.offset_of(a, b),
            Self::Supernodal(solver) => solver.offset_of(a, b),
        };
        place.unwrap_or_else(|| unreachable!("unknowns {a} and {b} do not meet in the matrix"))
    }

    /// Adds terms (unknown, unknown, value) to the matrix, each pair in one order only.
    pub fn add(&mut self, terms: &[(usize, usize, f64)]) {
        for (a, b, value) in terms {
            let place = self.offset_of(*a, *b);
            self.matrix_mut()[place] += value;
        }
    }

    /// Multiplies the matrix with these values by a vector.
    pub fn multiply(&self, values: &[f64], vector: &[f64]) -> Vec<f64> {
        match self {
            Self::Strips(solver) => solver.multiply(values, vector),
            Self::Supernodal(solver) => solver.multiply(values, vector),
        }
    }

    /// Values of the matrix, to be filled in before [`Self::factorize`]; what they hold before is of no use.
    pub fn matrix_mut(&mut self) -> &mut [f64] {
        match self {
            Self::Strips(solver) => solver.matrix_mut(),
            Self::Supernodal(solver) => solver.matrix_mut(),
        }
    }

    /// Computes the numeric factor L D Lᵀ of the matrix that was filled in, which is lost; returns its negative pivots.
    ///
    /// # Errors
    /// Where a pivot is zero or not a number; the factor is then of no use.
    pub fn factorize(&mut self) -> Result<NegativePivots, FactorError> {
        match self {
            Self::Strips(solver) => solver.factorize(),
            Self::Supernodal(solver) => solver.factorize(),
        }
    }

    /// Replaces every pivot by its magnitude: the factor becomes that of a positive definite matrix, which differs from
    /// the original by a matrix of the rank of its negative part.
    pub fn make_positive(&mut self) {
        match self {
            Self::Strips(solver) => solver.make_positive(),
            Self::Supernodal(solver) => solver.make_positive(),
        }
    }

    /// Solves in place with the last factor.
    pub fn solve(&self, right_hand_side: &mut [f64]) {
        match self {
            Self::Strips(solver) => solver.solve(right_hand_side),
            Self::Supernodal(solver) => solver.solve(right_hand_side),
        }
    }

    /// Number of values in the factor.
    pub fn factor_len(&self) -> usize {
        match self {
            Self::Strips(solver) => solver.factor_len(),
            Self::Supernodal(solver) => solver.factor_len(),
        }
    }

    /// Largest number of threads that can share a factorization.
    pub fn most_threads(&self) -> usize {
        match self {
            Self::Strips(solver) => solver.most_threads(),
            Self::Supernodal(solver) => solver.most_threads(),
        }
    }

    /// Number of floating-point operations of a factorization: the sum of the squares of the column counts, or a bound
    /// near it.
    pub fn flops(&self) -> f64 {
        match self {
            Self::Strips(solver) => solver.flops(),
            Self::Supernodal(solver) => solver.flops(),
        }
    }
}

#[cfg(test)]
mod tests;
