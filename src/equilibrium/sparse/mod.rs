//! Sparse symmetric matrices on the free unknowns: storage, L D Lᵀ without pivoting, solution.
//!
//! The signs of D give the inertia (Sylvester). Two storages, of which the structure decides: [`strips`] for what is long
//! and narrow in the order of the unknowns, as a tape spring is, and [`supernodal`] for the rest. Factor and solve give
//! the same bits on any number of threads.
//!
//! | file | what |
//! |---|---|
//! | `structure` | which unknowns meet; what a factorization tells |
//! | `envelope` | how far rows reach, and where to cut |
//! | `chain`, `strips`, `strip_kernel` | rows in strips: where they stand, the solver, its loops |
//! | `supernodal` | any structure |

mod chain;
mod envelope;
mod strip_kernel;
mod strips;
mod structure;
mod supernodal;

pub use structure::{Couplings, FactorError, NegativePivots};
pub use supernodal::DenseProduct;

use crate::energy::Build;
use strips::StripSolver;
use supernodal::SupernodalSolver;

/// Operations beyond which it is worth while to ask whether another order of elimination takes fewer: 1e9 of them take
/// as long as the question (some 40 ms).
const WORTH_ASKING_FLOPS: f64 = 1e9;
/// How many times faster than faer's supernodes strips do an operation, on one thread: on 128 × 16 cubic elements the
/// strips take 14 ms and the supernodes 20.
const STRIPS_PAY: f64 = 1.5;

/// A matrix structure with room for one matrix, in place of which comes its factor. [`Self::place`] says where among the
/// [`Self::value_count`] numbers of a matrix each entry is.
#[derive(Debug)]
pub enum SparseSolver {
    /// Rows of the envelope, from both ends.
    Strips(StripSolver),
    /// Any structure.
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
                Ok(other) if strips.flops() > STRIPS_PAY * other.flops() => Self::Supernodal(other.with_room()?),
                // Where the question itself does not fit in memory, strips may.
                _ => Self::Strips(strips.with_room()?),
            },
        };
        match u32::try_from(solver.value_count()) {
            Ok(_) => Ok(solver),
            Err(_) => Err(FactorError::TooLarge { size, entries: solver.value_count() }),
        }
    }

    /// The storage for any structure, whatever the structure.
    #[cfg(test)]
    pub fn supernodal(couplings: &Couplings) -> Result<Self, FactorError> {
        SupernodalSolver::structure(couplings)?.with_room().map(Self::Supernodal)
    }

    /// Numbers that the values of a matrix take: fewer than 2³².
    pub fn value_count(&self) -> usize {
        match self {
            Self::Strips(solver) => solver.value_count(),
            Self::Supernodal(solver) => solver.value_count(),
        }
    }

    /// Where the values hold the entry of two unknowns, which is the same both ways round. Of unknowns that do not meet, but lie
    /// within the envelope, it is a place that nothing else uses.
    ///
    /// # Panics
    /// Where there is no such place: what is filled in and the structure come from one pattern, and nothing is left out in silence.
    pub fn place(&self, a: usize, b: usize) -> usize {
        let place = match self {
            Self::Strips(solver) => solver.place(a, b),
            Self::Supernodal(solver) => solver.place(a, b),
        };
        place.unwrap_or_else(|| unreachable!("unknowns {a} and {b} do not meet in the matrix"))
    }

    /// Adds terms (unknown, unknown, value) to the matrix, each pair one way round.
    pub fn add(&mut self, terms: &[(usize, usize, f64)]) {
        for (a, b, value) in terms {
            let place = self.place(*a, *b);
            self.matrix_mut()[place] += value;
        }
    }

    /// The matrix with these values times a vector.
    pub fn multiply(&self, values: &[f64], vector: &[f64]) -> Vec<f64> {
        match self {
            Self::Strips(solver) => solver.multiply(values, vector),
            Self::Supernodal(solver) => solver.multiply(values, vector),
        }
    }

    /// The matrix, to be filled before [`Self::factorize`]; what stands there is of no use.
    pub fn matrix_mut(&mut self) -> &mut [f64] {
        match self {
            Self::Strips(solver) => solver.matrix_mut(),
            Self::Supernodal(solver) => solver.matrix_mut(),
        }
    }

    /// Numeric L D Lᵀ of the matrix that was filled in, which is lost; returns its negative pivots.
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

    /// Numbers in the factor.
    pub fn factor_len(&self) -> usize {
        match self {
            Self::Strips(solver) => solver.factor_len(),
            Self::Supernodal(solver) => solver.factor_len(),
        }
    }

    /// Threads that can share a factorization.
    pub fn most_threads(&self) -> usize {
        match self {
            Self::Strips(solver) => solver.most_threads(),
            Self::Supernodal(_) => 1,
        }
    }

    /// Floating-point operations of a factorization: the sum of the squares of the column counts, or a bound near it.
    pub fn flops(&self) -> f64 {
        match self {
            Self::Strips(solver) => solver.flops(),
            Self::Supernodal(solver) => solver.flops(),
        }
    }
}

#[cfg(test)]
mod tests;
