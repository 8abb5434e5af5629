//! What a factorization takes and tells: which unknowns meet, why there is none, its negative pivots.

/// Why a matrix has no usable factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FactorError {
    /// A pivot is exactly zero or not a number.
    #[error("the pivot of unknown {index} of {size} is zero or not a number")]
    BadPivot {
        /// The unknown.
        index: usize,
        /// Size of the matrix.
        size: usize,
    },
    /// Out of memory, or 2³² entries and more.
    #[error("a matrix of {size} unknowns and {entries} entries is too large for this machine")]
    TooLarge {
        /// Size of the matrix.
        size: usize,
        /// Stored entries.
        entries: usize,
    },
}

/// The negative part of D.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NegativePivots {
    /// How many.
    pub count: usize,
    /// Largest magnitude among them; 0 where there are none.
    pub largest: f64,
}

impl NegativePivots {
    /// Takes one more pivot.
    pub(super) fn see(&mut self, pivot: f64) {
        if pivot < 0.0 {
            self.count += 1;
            self.largest = self.largest.max(-pivot);
        }
    }
}

/// Which unknowns meet in the matrix.
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

/// Zeros; `None` where memory does not hold so many.
pub(super) fn room(length: usize) -> Option<Vec<f64>> {
    let mut numbers = Vec::new();
    numbers.try_reserve_exact(length).ok()?;
    numbers.resize(length, 0.0);
    Some(numbers)
}
