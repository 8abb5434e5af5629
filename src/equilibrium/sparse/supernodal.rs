//! Factorization of any symmetric structure by fronts (multifrontal: Duff & Reid 1983), in an order of nested dissection.
//!
//! Each front is filled with its entries of the matrix, takes what the fronts below left, and eliminates its pivots by dense
//! products ([`super::dense`]). Subtrees, and shares of large fronts, go to threads of their own. Every sum has one order:
//! fronts below are taken in their order, and shares do not depend on the number of threads.

use crate::equilibrium::sparse::dense::eliminate;
use crate::equilibrium::sparse::fronts::{ALIGNED, Front, Fronts};
use crate::equilibrium::sparse::structure::{Couplings, FactorError, NegativePivots, room};

/// Solver for any structure: its fronts, with room for the matrix and for its factor.
pub struct SupernodalSolver {
    fronts: Fronts,
    /// The lower triangle in the order of elimination, by columns: starts, and ascending rows.
    column_starts: Vec<usize>,
    rows: Vec<u32>,
    values: Vec<f64>,
    factor: Vec<f64>,
    /// What eliminated fronts leave to those above.
    rest: Vec<f64>,
}

impl std::fmt::Debug for SupernodalSolver {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (unknowns, fronts) = (self.column_starts.len() - 1, self.fronts.fronts.len());
        write!(f, "SupernodalSolver({unknowns} unknowns, {fronts} fronts, {} numbers in the factor)", self.factor_len())
    }
}

impl SupernodalSolver {
    /// Analyses the structure, without allocating room for numbers.
    pub(super) fn structure(couplings: &Couplings) -> Self {
        let fronts = Fronts::new(couplings);
        let (column_starts, rows) = lower_triangle(couplings, &fronts.places);
        let (values, factor, rest) = Default::default();
        Self { fronts, column_starts, rows, values, factor, rest }
    }

    /// Allocates the room for numbers.
    ///
    /// # Errors
    /// Where the factor does not fit in it.
    pub(super) fn with_room(mut self) -> Result<Self, FactorError> {
        let too_large = FactorError::TooLarge { size: self.column_starts.len() - 1, entries: self.rows.len() };
        let tops = || self.fronts.tops.iter().map(|top| &self.fronts.fronts[*top]);
        let rest = tops().map(|top| top.rest_len).max().unwrap_or(0);
        self.factor = room(self.factor_len() + ALIGNED).ok_or(too_large)?;
        self.rest = room(rest + ALIGNED).ok_or(too_large)?;
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
        let (a, b) = (self.fronts.places[a], self.fronts.places[b]);
        let (column, row) = (a.min(b) as usize, a.max(b));
        let start = self.column_starts[column];
        self.rows[start..self.column_starts[column + 1]].binary_search(&row).ok().map(|offset| start + offset)
    }

    /// Multiplies the matrix with these values by a vector.
    pub(super) fn multiply(&self, values: &[f64], vector: &[f64]) -> Vec<f64> {
        let vector = self.placed(vector);
        let mut product = vec![0.0; vector.len()];
        for column in 0..vector.len() {
            for entry in self.column_starts[column]..self.column_starts[column + 1] {
                let row = self.rows[entry] as usize;
                product[row] += values[entry] * vector[column];
                if row != column {
                    product[column] += values[entry] * vector[row];
                }
            }
        }
        self.fronts.places.iter().map(|place| product[*place as usize]).collect()
    }

    /// A vector in the order of elimination.
    fn placed(&self, vector: &[f64]) -> Vec<f64> {
        self.fronts.order.iter().map(|unknown| vector[*unknown as usize]).collect()
    }

    /// Computes the numeric factor L D Lᵀ; returns its negative pivots.
    ///
    /// # Errors
    /// Where a pivot is zero or not a number; the factor is then of no use.
    pub(super) fn factorize(&mut self) -> Result<NegativePivots, FactorError> {
        let size = self.column_starts.len() - 1;
        let Self { fronts, column_starts, rows, values, factor, rest } = self;
        let elimination = Elimination { fronts: &fronts.fronts, column_starts, rows, values };
        let (mut factor, rest) = (aligned_mut(factor), aligned_mut(rest));
        for top in &fronts.tops {
            let (own, others) = factor.split_at_mut(fronts.fronts[*top].factor_len);
            factor = others;
            elimination
                .subtree(*top, own, rest)
                .map_err(|place| FactorError::BadPivot { index: fronts.order[place] as usize, size })?;
        }
        let mut negative = NegativePivots::default();
        self.for_each_pivot(|pivot| negative.see(*pivot));
        Ok(negative)
    }

    /// Replaces every pivot by its magnitude: the factor becomes that of a positive definite matrix, which differs from
    /// the original by a matrix of the rank of its negative part.
    pub(super) fn make_positive(&mut self) {
        self.for_each_pivot(|pivot| *pivot = pivot.abs());
    }

    fn for_each_pivot(&mut self, mut visit: impl FnMut(&mut f64)) {
        let mut factor = aligned_mut(&mut self.factor);
        for front in &self.fronts.fronts {
            let (own, others) = factor.split_at_mut(front.own_len());
            factor = others;
            own.iter_mut().step_by(front.stride + 1).for_each(&mut visit);
        }
    }

    /// Solves in place with the last factor.
    pub(super) fn solve(&self, right_hand_side: &mut [f64]) {
        let mut x = self.placed(right_hand_side);
        let fronts = &self.fronts.fronts;
        let mut work = vec![0.0; fronts.iter().map(Front::height).max().unwrap_or(0)];
        let factor = aligned(&self.factor);
        let mut start = 0;
        for front in fronts {
            forward(front, &factor[start..start + front.own_len()], &mut x, &mut work);
            start += front.own_len();
        }
        for front in fronts.iter().rev() {
            let end = start;
            start -= front.own_len();
            backward(front, &factor[start..end], &mut x, &mut work);
        }
        for (x, unknown) in x.iter().zip(&self.fronts.order) {
            right_hand_side[*unknown as usize] = *x;
        }
    }

    /// Number of values in the factor, including the zeros within its fronts.
    pub(super) fn factor_len(&self) -> usize {
        self.fronts.tops.iter().map(|top| self.fronts.fronts[*top].factor_len).sum()
    }

    /// Number of floating-point operations of a factorization: the sum of the squares of the column counts.
    pub(super) fn flops(&self) -> f64 {
        self.fronts.tops.iter().map(|top| self.fronts.fronts[*top].flops).sum()
    }

    /// Largest number of threads that can share a factorization: all operations over those of the longest way through it.
    pub(super) fn most_threads(&self) -> usize {
        let longest = self.fronts.tops.iter().map(|top| self.fronts.fronts[*top].longest).sum::<f64>();
        if longest > 0.0 { ((self.flops() / longest) as usize).max(1) } else { 1 }
    }
}

/// What all threads of a factorization read.
struct Elimination<'a> {
    fronts: &'a [Front],
    column_starts: &'a [usize],
    rows: &'a [u32],
    values: &'a [f64],
}

impl Elimination<'_> {
    /// Eliminates a front and all below it; what is left on its rows is at the begin of `rest`.
    ///
    /// # Errors
    /// The place of a pivot that is zero or not a number.
    fn subtree(&self, index: usize, factor: &mut [f64], rest: &mut [f64]) -> Result<(), usize> {
        let front = &self.fronts[index];
        let (of_below, own) = factor.split_at_mut(front.factor_len - front.own_len());
        let (left, rest) = rest.split_at_mut(front.left_len());
        if front.shared {
            self.at_once(&front.below, of_below, rest)?;
        } else {
            self.one_by_one(&front.below, of_below, rest)?;
        }
        own.fill(0.0);
        left.fill(0.0);
        self.fill(front, own);
        let mut start = 0;
        for below in &front.below {
            let below = &self.fronts[*below];
            add_left(below, &rest[start..], front, own, left);
            start += if front.shared { below.rest_len } else { below.left_len() };
        }
        let sizes = [front.width, front.height(), front.stride];
        eliminate(own, sizes, left, front.rest_stride, rest).map_err(|place| front.begin + place)
    }

    /// Eliminates subtrees in their order; what is left of each follows on what is left of the one before.
    fn one_by_one(&self, tops: &[usize], mut factor: &mut [f64], mut rest: &mut [f64]) -> Result<(), usize> {
        for top in tops {
            let (own, others) = factor.split_at_mut(self.fronts[*top].factor_len);
            self.subtree(*top, own, rest)?;
            (factor, rest) = (others, rest.split_at_mut(self.fronts[*top].left_len()).1);
        }
        Ok(())
    }

    /// Eliminates subtrees at the same time, each with room of its own.
    fn at_once(&self, tops: &[usize], factor: &mut [f64], rest: &mut [f64]) -> Result<(), usize> {
        if let [top] = tops {
            return self.subtree(*top, factor, &mut rest[..self.fronts[*top].rest_len]);
        }
        let (some, others) = tops.split_at(tops.len() / 2);
        let sum = |of: fn(&Front) -> usize| some.iter().map(|top| of(&self.fronts[*top])).sum::<usize>();
        let (factor, other_factor) = factor.split_at_mut(sum(|front| front.factor_len));
        let (rest, other_rest) = rest.split_at_mut(sum(|front| front.rest_len));
        let (one, other) =
            rayon::join(|| self.at_once(some, factor, rest), || self.at_once(others, other_factor, other_rest));
        one.and(other)
    }

    /// Fills in a front's entries of the matrix.
    fn fill(&self, front: &Front, own: &mut [f64]) {
        for (k, column) in own.chunks_exact_mut(front.stride.max(1)).enumerate() {
            let entries = self.column_starts[front.begin + k]..self.column_starts[front.begin + k + 1];
            let mut passed = 0;
            for (row, value) in self.rows[entries.clone()].iter().zip(&self.values[entries]) {
                let own_row = *row as usize - front.begin;
                let place = if own_row < front.width {
                    own_row
                } else {
                    if front.rows[passed] != *row {
                        passed += front.rows[passed..].partition_point(|other| other < row);
                    }
                    passed += 1;
                    front.width + passed - 1
                };
                column[place] = *value;
            }
        }
    }
}

/// Adds what a front left to the front above.
fn add_left(below: &Front, from: &[f64], above: &Front, own: &mut [f64], left: &mut [f64]) {
    for (r, run) in below.runs.iter().enumerate() {
        for k in 0..run.length {
            let (from_column, to_column) = ((run.from + k) as usize, (run.to + k) as usize);
            let from = &from[from_column * below.rest_stride..];
            let (to, skipped) = match to_column.checked_sub(above.width) {
                None => (&mut own[to_column * above.stride..], 0),
                Some(column) => (&mut left[column * above.rest_stride..], above.width),
            };
            let mut add = |from_row: u32, to_row: u32, length: u32| {
                let from = &from[from_row as usize..][..length as usize];
                let to = &mut to[to_row as usize - skipped..][..length as usize];
                to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
            };
            add(run.from + k, run.to + k, run.length - k);
            below.runs[r + 1..].iter().for_each(|run| add(run.from, run.to, run.length));
        }
    }
}

/// Solves with L of a front, and subtracts from later unknowns.
fn forward(front: &Front, own: &[f64], x: &mut [f64], work: &mut [f64]) {
    let work = &mut work[..front.height()];
    work[..front.width].copy_from_slice(&x[front.begin..][..front.width]);
    work[front.width..].fill(0.0);
    for (k, column) in own.chunks_exact(front.stride.max(1)).enumerate() {
        let pivot = work[k];
        work[k + 1..].iter_mut().zip(&column[k + 1..]).for_each(|(to, l)| *to -= l * pivot);
    }
    x[front.begin..][..front.width].copy_from_slice(&work[..front.width]);
    for (row, change) in front.rows.iter().zip(&work[front.width..]) {
        x[*row as usize] += change;
    }
}

/// Solves with D and Lᵀ of a front.
fn backward(front: &Front, own: &[f64], x: &mut [f64], work: &mut [f64]) {
    let work = &mut work[..front.height()];
    for (k, column) in own.chunks_exact(front.stride.max(1)).enumerate() {
        work[k] = x[front.begin + k] / column[k];
    }
    for (to, row) in work[front.width..].iter_mut().zip(&front.rows) {
        *to = x[*row as usize];
    }
    for (k, column) in own.chunks_exact(front.stride.max(1)).enumerate().rev() {
        let sum = product(&column[k + 1..front.height()], &work[k + 1..]);
        work[k] -= sum;
    }
    x[front.begin..][..front.width].copy_from_slice(&work[..front.width]);
}

/// A scalar product in eight sums, which vector instructions take at once.
fn product(a: &[f64], b: &[f64]) -> f64 {
    let (a, a_end) = a.as_chunks::<8>();
    let (b, b_end) = b.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for k in 0..8 {
            sums[k] += a[k] * b[k];
        }
    }
    sums.iter().sum::<f64>() + a_end.iter().zip(b_end).map(|(a, b)| a * b).sum::<f64>()
}

/// The numbers from the first that begins a cache line.
fn aligned_mut(numbers: &mut [f64]) -> &mut [f64] {
    let first = numbers.as_ptr().align_offset(8 * ALIGNED).min(numbers.len());
    &mut numbers[first..]
}

/// As [`aligned_mut`].
fn aligned(numbers: &[f64]) -> &[f64] {
    &numbers[numbers.as_ptr().align_offset(8 * ALIGNED).min(numbers.len())..]
}

/// Lists the lower triangle, in the order of elimination, by columns: starts, and ascending rows.
fn lower_triangle(couplings: &Couplings, places: &[u32]) -> (Vec<usize>, Vec<u32>) {
    let mut columns: Vec<Vec<u32>> = (0..couplings.unknowns as u32).map(|place| vec![place]).collect();
    for [i, j] in couplings.meetings() {
        for a in &couplings.groups[i] {
            for b in &couplings.groups[j] {
                let (a, b) = (places[*a], places[*b]);
                columns[a.min(b) as usize].push(a.max(b));
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
