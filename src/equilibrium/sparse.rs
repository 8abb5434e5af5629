//! Sparse symmetric factorization: the only file that names faer.
//!
//! Supernodal L D Lᵀ without pivoting, in the natural order along the length (the mesh is long and narrow, so the
//! matrix is nearly banded). The signs of D give the inertia (Sylvester). Factor and solve with `Par::Seq`: other
//! settings may differ in bits between thread counts.
//!
//! With `SymmetricOrdering::Identity` the structure is analysed as it stands, which asks for the upper triangle, and the
//! numbers are taken as they stand, which asks for the lower one; an explicit identity permutation would copy the matrix
//! at each factorization (2 of 19 ms for 7400 unknowns). Supernodes are faer's own: fewer and larger ones (relaxed up
//! to 64, 96, 128 columns with half of them zeros) took 18, 20, 21 ms where these take 17, and smaller ones (32) 19.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltError;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

/// Why a matrix has no usable factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FactorError {
    /// A pivot is exactly zero or not a number.
    #[error("pivot {index} of {size} is zero or not a number")]
    BadPivot {
        /// Place in the order of elimination.
        index: usize,
        /// Size of the matrix.
        size: usize,
    },
    /// The structure could not be analysed (out of memory, or more than 2⁶³ entries).
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

/// Symbolic factor of one structure with room for the numeric one.
pub struct SparseSolver {
    symbolic: SymbolicCholesky<usize>,
    column_starts: Vec<usize>,
    rows: Vec<usize>,
    factor: Vec<f64>,
    scratch: MemBuffer,
}

impl std::fmt::Debug for SparseSolver {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "SparseSolver({} unknowns, {} numbers in the factor)",
            self.column_starts.len() - 1,
            self.factor.len()
        )
    }
}

impl SparseSolver {
    /// Analyses the lower triangle given by columns.
    ///
    /// # Errors
    /// Where the factor does not fit in memory.
    pub fn new(column_starts: Vec<usize>, rows: Vec<usize>) -> Result<Self, FactorError> {
        let size = column_starts.len() - 1;
        let too_large = FactorError::TooLarge { size, entries: rows.len() };
        let (upper_starts, upper_rows) = transposed(&column_starts, &rows);
        let upper = SymbolicSparseColMatRef::new_checked(size, size, &upper_starts, None, &upper_rows);
        let parameters = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic = factorize_symbolic_cholesky(upper, Side::Upper, SymmetricOrdering::Identity, parameters)
            .map_err(|_| too_large)?;
        let scratch = symbolic
            .factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let scratch = MemBuffer::try_new(scratch).map_err(|_| too_large)?;
        let factor = vec![0.0; symbolic.len_val()];
        Ok(Self { symbolic, column_starts, rows, factor, scratch })
    }

    /// Numeric L D Lᵀ; returns its negative pivots.
    ///
    /// # Errors
    /// Where a pivot is zero or not a number; the factor is then of no use.
    pub fn factorize(&mut self, values: &[f64]) -> Result<NegativePivots, FactorError> {
        let size = self.column_starts.len() - 1;
        let structure = SymbolicSparseColMatRef::new_checked(size, size, &self.column_starts, None, &self.rows);
        let matrix = SparseColMatRef::new(structure, values);
        self.symbolic
            .factorize_numeric_ldlt(
                &mut self.factor,
                matrix,
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut self.scratch),
                Default::default(),
            )
            .map_err(|LdltError::ZeroPivot { index }| FactorError::BadPivot { index, size })?;
        let mut negative = NegativePivots::default();
        let mut bad = None;
        self.for_each_pivot(|index, pivot| {
            if !pivot.is_finite() || *pivot == 0.0 {
                bad.get_or_insert(index);
            } else if *pivot < 0.0 {
                negative.count += 1;
                negative.largest = negative.largest.max(-*pivot);
            }
        });
        match bad {
            Some(index) => Err(FactorError::BadPivot { index, size }),
            None => Ok(negative),
        }
    }

    /// Replaces every pivot by its magnitude: the factor becomes that of a positive definite matrix, which differs from
    /// the original by a matrix of the rank of its negative part.
    pub fn make_positive(&mut self) {
        self.for_each_pivot(|_, pivot| *pivot = pivot.abs());
    }

    /// Solves in place with the last factor.
    pub fn solve(&mut self, right_hand_side: &mut [f64]) {
        let size = right_hand_side.len();
        LdltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(right_hand_side, size, 1),
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
    }

    /// Numbers in the factor.
    pub fn factor_len(&self) -> usize {
        self.factor.len()
    }

    /// Floating-point operations of a factorization: the sum of the squares of the column counts.
    pub fn flops(&self) -> f64 {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else { return 0.0 };
        let of_supernode = |s: usize| {
            let columns = symbolic.supernode_end()[s] - symbolic.supernode_begin()[s];
            let height = (symbolic.col_ptr_for_val()[s + 1] - symbolic.col_ptr_for_val()[s]) / columns;
            (0..columns).map(|column| ((height - column) as f64).powi(2)).sum::<f64>()
        };
        (0..symbolic.n_supernodes()).map(of_supernode).sum()
    }

    fn for_each_pivot(&mut self, mut visit: impl FnMut(usize, &mut f64)) {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else { return };
        for s in 0..symbolic.n_supernodes() {
            let (begin, end) = (symbolic.supernode_begin()[s], symbolic.supernode_end()[s]);
            let start = symbolic.col_ptr_for_val()[s];
            let height = (symbolic.col_ptr_for_val()[s + 1] - start) / (end - begin);
            for column in 0..end - begin {
                visit(begin + column, &mut self.factor[start + column * height + column]);
            }
        }
    }
}

/// Structure of the transpose of a square matrix; rows ascend in a column.
fn transposed(column_starts: &[usize], rows: &[usize]) -> (Vec<usize>, Vec<usize>) {
    let mut starts = vec![0; column_starts.len()];
    for row in rows {
        starts[row + 1] += 1;
    }
    for column in 1..starts.len() {
        starts[column] += starts[column - 1];
    }
    let mut next = starts.clone();
    let mut columns = vec![0; rows.len()];
    for column in 0..column_starts.len() - 1 {
        for row in &rows[column_starts[column]..column_starts[column + 1]] {
            columns[next[*row]] = column;
            next[*row] += 1;
        }
    }
    (starts, columns)
}

/// A dense product of two square matrices on one thread: what the processor can do at best.
pub struct DenseProduct {
    matrix: faer::Mat<f64>,
    product: faer::Mat<f64>,
}

impl DenseProduct {
    /// Matrices of this size, ready to be multiplied.
    pub fn new(size: usize) -> Self {
        let matrix = faer::Mat::from_fn(size, size, |i, j| ((i * 7 + j * 3) % 11) as f64);
        Self { matrix, product: faer::Mat::zeros(size, size) }
    }

    /// Multiplies; returns one number of the product.
    pub fn run(&mut self) -> f64 {
        let (factor, product) = (&self.matrix, self.product.as_mut());
        faer::linalg::matmul::matmul(product, faer::Accum::Replace, factor, factor, 1.0, Par::Seq);
        self.product[(0, 0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tridiagonal matrix with a given diagonal and −1 beside it.
    fn tridiagonal(diagonal: &[f64]) -> (Vec<usize>, Vec<usize>, Vec<f64>) {
        let size = diagonal.len();
        let mut starts = vec![0];
        let (mut rows, mut values) = (Vec::new(), Vec::new());
        for column in 0..size {
            rows.push(column);
            values.push(diagonal[column]);
            if column + 1 < size {
                rows.push(column + 1);
                values.push(-1.0);
            }
            starts.push(rows.len());
        }
        (starts, rows, values)
    }

    #[test]
    fn counts_negative_eigenvalues_and_solves() {
        // Eigenvalues of the tridiagonal matrix: d − 2 cos(k π / (n + 1)).
        let size = 40;
        // (1.0 would meet an exactly zero pivot, which the factorization does not survive: it does not pivot.)
        for shift in [2.5, 1.01, 0.3, -0.7] {
            let (starts, rows, values) = tridiagonal(&vec![shift; size]);
            let negative = (1..=size)
                .filter(|k| shift - 2.0 * (*k as f64 * std::f64::consts::PI / (size + 1) as f64).cos() < 0.0)
                .count();
            let mut solver = SparseSolver::new(starts, rows).unwrap();
            assert_eq!(solver.factorize(&values).unwrap().count, negative, "shift {shift}");
            let mut x = vec![1.0; size];
            solver.solve(&mut x);
            for i in 0..size {
                let left = if i > 0 { x[i - 1] } else { 0.0 };
                let right = if i + 1 < size { x[i + 1] } else { 0.0 };
                assert!((shift * x[i] - left - right - 1.0).abs() < 1e-9, "row {i}");
            }
        }
    }

    #[test]
    fn a_zero_matrix_is_refused() {
        let (starts, rows, _) = tridiagonal(&[1.0; 5]);
        let entries = rows.len();
        let mut solver = SparseSolver::new(starts, rows).unwrap();
        assert!(solver.factorize(&vec![0.0; entries]).is_err());
    }
}
