//! Factorization of any symmetric structure by faer's supernodes: the only file that names faer.
//!
//! Unknowns are eliminated in the order that faer finds (approximate minimum degree). Factor and solve use `Par::Seq`:
//! other settings may differ in bits between thread counts.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::ldlt::factor::LdltError;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use crate::equilibrium::sparse::structure::{Couplings, FactorError, NegativePivots, room};

/// Solver for any structure: its symbolic factor with room for the numeric one.
pub struct SupernodalSolver {
    symbolic: SymbolicCholesky<usize>,
    column_starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
    factor: Vec<f64>,
    scratch: MemBuffer,
}

impl std::fmt::Debug for SupernodalSolver {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "SupernodalSolver({} unknowns, {} numbers in the factor)",
            self.column_starts.len() - 1,
            self.factor.len()
        )
    }
}

impl SupernodalSolver {
    /// Analyses the structure, without allocating room for numbers.
    ///
    /// # Errors
    /// Where the analysis does not fit in memory.
    pub(super) fn structure(couplings: &Couplings) -> Result<Self, FactorError> {
        let (column_starts, rows) = lower_triangle(couplings);
        let size = couplings.unknowns;
        let too_large = FactorError::TooLarge { size, entries: rows.len() };
        let structure = SymbolicSparseColMatRef::new_checked(size, size, &column_starts, None, &rows);
        let parameters = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic = factorize_symbolic_cholesky(structure, Side::Lower, SymmetricOrdering::Amd, parameters)
            .map_err(|_| too_large)?;
        let scratch = MemBuffer::new(StackReq::EMPTY);
        Ok(Self { symbolic, column_starts, rows, values: Vec::new(), factor: Vec::new(), scratch })
    }

    /// Allocates the room for numbers.
    ///
    /// # Errors
    /// Where the factor does not fit in it.
    pub(super) fn with_room(mut self) -> Result<Self, FactorError> {
        let too_large = FactorError::TooLarge { size: self.column_starts.len() - 1, entries: self.rows.len() };
        let scratch = self.symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default());
        self.scratch = MemBuffer::try_new(scratch).map_err(|_| too_large)?;
        self.factor = room(self.symbolic.len_val()).ok_or(too_large)?;
        self.values = room(self.rows.len()).ok_or(too_large)?;
        Ok(self)
    }

    /// Number of values that a matrix takes.
    pub(super) fn value_count(&self) -> usize {
        self.rows.len()
    }

    /// Values of the matrix, to be filled in.
    pub(super) fn matrix_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Offset among the values of an entry; `None` where there is none.
    pub(super) fn offset_of(&self, a: usize, b: usize) -> Option<usize> {
        let (column, row) = (a.min(b), a.max(b));
        let start = self.column_starts[column];
        self.rows[start..self.column_starts[column + 1]].binary_search(&row).ok().map(|offset| start + offset)
    }

    /// Multiplies the matrix with these values by a vector.
    pub(super) fn multiply(&self, values: &[f64], vector: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; vector.len()];
        for column in 0..vector.len() {
            for entry in self.column_starts[column]..self.column_starts[column + 1] {
                let row = self.rows[entry];
                product[row] += values[entry] * vector[column];
                if row != column {
                    product[column] += values[entry] * vector[row];
                }
            }
        }
        product
    }

    /// Computes the numeric factor L D Lᵀ; returns its negative pivots.
    ///
    /// # Errors
    /// Where a pivot is zero or not a number; the factor is then of no use.
    pub(super) fn factorize(&mut self) -> Result<NegativePivots, FactorError> {
        let size = self.column_starts.len() - 1;
        let structure = SymbolicSparseColMatRef::new_checked(size, size, &self.column_starts, None, &self.rows);
        let matrix = SparseColMatRef::new(structure, &self.values);
        let done = self.symbolic.factorize_numeric_ldlt(
            &mut self.factor,
            matrix,
            Side::Lower,
            Default::default(),
            Par::Seq,
            MemStack::new(&mut self.scratch),
            Default::default(),
        );
        if let Some(LdltError::ZeroPivot { index }) = done.err() {
            // faer counts pivots from one.
            return Err(FactorError::BadPivot { index: self.unknown(index.saturating_sub(1)), size });
        }
        let mut negative = NegativePivots::default();
        let mut bad = None;
        self.for_each_pivot(|index, pivot| {
            if !pivot.is_finite() || *pivot == 0.0 {
                bad.get_or_insert(index);
            } else {
                negative.see(*pivot);
            }
        });
        match bad {
            Some(index) => Err(FactorError::BadPivot { index: self.unknown(index), size }),
            None => Ok(negative),
        }
    }

    /// Replaces every pivot by its magnitude: the factor becomes that of a positive definite matrix, which differs from
    /// the original by a matrix of the rank of its negative part.
    pub(super) fn make_positive(&mut self) {
        self.for_each_pivot(|_, pivot| *pivot = pivot.abs());
    }

    /// Solves in place with the last factor.
    pub(super) fn solve(&self, right_hand_side: &mut [f64]) {
        let size = right_hand_side.len();
        let mut scratch = MemBuffer::new(self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        LdltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(right_hand_side, size, 1),
            Par::Seq,
            MemStack::new(&mut scratch),
        );
    }

    /// Number of values in the factor.
    pub(super) fn factor_len(&self) -> usize {
        self.factor.len()
    }

    /// Number of floating-point operations of a factorization: the sum of the squares of the column counts.
    pub(super) fn flops(&self) -> f64 {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else { return 0.0 };
        let of_supernode = |s: usize| {
            let columns = symbolic.supernode_end()[s] - symbolic.supernode_begin()[s];
            let height = (symbolic.col_ptr_for_val()[s + 1] - symbolic.col_ptr_for_val()[s]) / columns;
            (0..columns).map(|column| ((height - column) as f64).powi(2)).sum::<f64>()
        };
        (0..symbolic.n_supernodes()).map(of_supernode).sum()
    }

    /// The unknown at a place in the order of elimination.
    fn unknown(&self, place: usize) -> usize {
        self.symbolic.perm().map_or(place, |order| order.arrays().0[place])
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

/// Lists the lower triangle by columns: starts, and ascending rows.
fn lower_triangle(couplings: &Couplings) -> (Vec<usize>, Vec<usize>) {
    let mut columns: Vec<Vec<usize>> = (0..couplings.unknowns).map(|unknown| vec![unknown]).collect();
    for [i, j] in couplings.meetings() {
        for a in &couplings.groups[i] {
            for b in &couplings.groups[j] {
                columns[*a.min(b)].push(*a.max(b));
            }
        }
    }
    let mut column_starts = vec![0];
    let mut rows = Vec::new();
    for column in &mut columns {
        column.sort_unstable();
        column.dedup();
        rows.extend_from_slice(column);
        column_starts.push(rows.len());
    }
    (column_starts, rows)
}

/// A dense product of two square matrices on one thread, as a measure of what the processor can do at best.
pub struct DenseProduct {
    matrix: faer::Mat<f64>,
    product: faer::Mat<f64>,
}

impl DenseProduct {
    /// Creates matrices of this size, ready to be multiplied.
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
