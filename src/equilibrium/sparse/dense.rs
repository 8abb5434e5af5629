//! Dense blocks: the only file that names faer.
//!
//! Every product is faer's on one thread; threads take columns or rows of their own. Which ones does not depend on how
//! many threads there are, so that neither does any bit.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::{LdltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Number of pivots that are eliminated at once.
const PIVOTS: usize = 192;
/// Number of columns, and of rows, that a thread takes at a time.
const SHARE: usize = 192;

/// Room for what [`eliminate`] computes on the way, in numbers: the rows below a block of pivots, multiplied by them.
pub(super) fn scratch_len(width: usize, height: usize) -> usize {
    width.min(PIVOTS) * height
}

/// Number of threads that can share a front, about: half the number of shares, since they differ in length.
pub(super) fn shares(height: usize) -> f64 {
    (0.5 * height as f64 / SHARE as f64).max(1.0)
}

/// Eliminates `width` pivots of a front of `height` rows: L D Lᵀ of its columns in place, and what is left on the other
/// rows, of which the lower triangle is used.
///
/// Columns of the front lie `stride` numbers apart, and those of the rest `rest_stride`.
///
/// # Errors
/// The first pivot that is zero or not a number.
pub(super) fn eliminate(
    columns: &mut [f64],
    [width, height, stride]: [usize; 3],
    rest: &mut [f64],
    rest_stride: usize,
    scratch: &mut [f64],
) -> Result<(), usize> {
    for begin in (0..width).step_by(PIVOTS) {
        let count = PIVOTS.min(width - begin);
        let below = height - begin - count;
        let (block, later) = columns[begin * stride..].split_at_mut(count * stride);
        let view = MatMut::from_column_major_slice_with_stride_mut(&mut block[begin..], height - begin, count, stride);
        let (mut pivots, mut lower) = view.split_at_row_mut(count);
        factor_block(pivots.rb_mut()).map_err(|place| begin + place)?;
        let mut products = MatMut::from_column_major_slice_with_stride_mut(scratch, below, count, below.max(1));
        divide(pivots.rb(), lower.rb_mut(), products.rb_mut());
        let (lower, products) = (lower.rb(), products.rb());
        let in_front = width - begin - count;
        // A share is some columns from their diagonal on; the first of all has its diagonal at `above` in its storage and at
        // `skipped` among the rows below the pivots.
        let subtract = |(share, numbers): (usize, &mut [f64]), above: usize, skipped: usize, stride: usize| {
            let here = numbers.len() / stride;
            let start = skipped + share * SHARE;
            let rows = below - start;
            let numbers = &mut numbers[above + share * SHARE..];
            let to = MatMut::from_column_major_slice_with_stride_mut(numbers, rows, here, stride);
            let (top, bottom) = to.split_at_row_mut(here);
            let right = products.subrows(start, here).transpose();
            triangular::matmul(
                top,
                BlockStructure::TriangularLower,
                Accum::Add,
                lower.subrows(start, here),
                BlockStructure::Rectangular,
                right,
                BlockStructure::Rectangular,
                -1.0,
                Par::Seq,
            );
            matmul(bottom, Accum::Add, lower.subrows(start + here, rows - here), right, -1.0, Par::Seq);
        };
        if in_front > 0 {
            let shares = later[..in_front * stride].par_chunks_mut(SHARE * stride).enumerate();
            shares.for_each(|share| subtract(share, begin + count, 0, stride));
        }
        if rest_stride > 0 {
            let shares = rest.par_chunks_mut(SHARE * rest_stride).enumerate();
            shares.for_each(|share| subtract(share, 0, in_front, rest_stride));
        }
    }
    Ok(())
}

/// L D Lᵀ of a block of pivots, in place.
fn factor_block(mut pivots: MatMut<'_, f64>) -> Result<(), usize> {
    let size = pivots.nrows();
    let parameters = Default::default();
    let mut memory = MemBuffer::new(cholesky_in_place_scratch::<f64>(size, Par::Seq, parameters));
    let stack = MemStack::new(&mut memory);
    // A zero pivot ends it, which the pivots show.
    let _ = cholesky_in_place(pivots.rb_mut(), LdltRegularization::default(), Par::Seq, stack, parameters);
    match (0..size).find(|place| !pivots[(*place, *place)].is_finite() || pivots[(*place, *place)] == 0.0) {
        Some(bad) => Err(bad),
        None => Ok(()),
    }
}

/// Turns the rows below a block of pivots into those of L, and stores them multiplied by the pivots, too.
fn divide(pivots: MatRef<'_, f64>, mut lower: MatMut<'_, f64>, mut products: MatMut<'_, f64>) {
    let rows = lower.nrows();
    if rows > SHARE {
        let half = (rows / 2).next_multiple_of(8);
        let (top, bottom) = lower.split_at_row_mut(half);
        let (top_products, bottom_products) = products.split_at_row_mut(half);
        rayon::join(|| divide(pivots, top, top_products), || divide(pivots, bottom, bottom_products));
        return;
    }
    solve_unit_lower_triangular_in_place(pivots, lower.rb_mut().transpose_mut(), Par::Seq);
    for column in 0..pivots.ncols() {
        let inverse = 1.0 / pivots[(column, column)];
        let lower = lower.rb_mut().col_mut(column).try_as_col_major_mut();
        let products = products.rb_mut().col_mut(column).try_as_col_major_mut();
        let (Some(lower), Some(products)) = (lower, products) else { unreachable!("columns are contiguous") };
        for (l, product) in lower.as_slice_mut().iter_mut().zip(products.as_slice_mut()) {
            *product = *l;
            *l *= inverse;
        }
    }
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
        matmul(product, Accum::Replace, factor, factor, 1.0, Par::Seq);
        self.product[(0, 0)]
    }
}
