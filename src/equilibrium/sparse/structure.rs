//! What a factorization takes and returns: which unknowns meet, its negative pivots, or why there is no factor.

/// Reasons why a matrix has no usable factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FactorError {
    /// A pivot is exactly zero or not a number.
    #[error("the pivot of unknown {index} of {size} is zero or not a number")]
    BadPivot {
        /// Index of the unknown.
        index: usize,
        /// Number of unknowns of the matrix.
        size: usize,
    },
    /// The matrix does not fit in memory, or has 2³² entries or more.
    #[error("a matrix of {size} unknowns and {entries} entries is too large for this machine")]
    TooLarge {
        /// Number of unknowns of the matrix.
        size: usize,
        /// Number of stored entries.
        entries: usize,
    },
}

/// Negative pivots of a factor L D Lᵀ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NegativePivots {
    /// Number of negative pivots.
    pub count: usize,
    /// Largest magnitude of a negative pivot; 0 where there are none.
    pub largest: f64,
}

impl NegativePivots {
    /// Takes one more pivot into account.
    pub(super) fn see(&mut self, pivot: f64) {
        if pivot < 0.0 {
            self.count += 1;
            self.largest = self.largest.max(-pivot);
        }
    }
}

/// Structure of a matrix: which unknowns meet in it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Couplings {
    /// Number of unknowns.
    pub unknowns: usize,
    /// Unknowns of each group, such as those of a control point; they meet each other.
    pub groups: Vec<Vec<usize>>,
    /// Groups whose unknowns meet; a group with itself need not be listed.
    pub pairs: Vec<[usize; 2]>,
}

impl Couplings {
    /// Groups whose unknowns meet, each with itself too.
    pub(super) fn meetings(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        self.pairs.iter().copied().chain((0..self.groups.len()).map(|group| [group, group]))
    }
}

/// Allocates zeros; `None` where memory does not hold so many.
pub(super) fn room(length: usize) -> Option<Vec<f64>> {
    let mut numbers = Vec::new();
    numbers.try_reserve_exact(length).ok()?;
    numbers.resize(length, 0.0);
    Some(numbers)
}
