//! Factorization of a long and narrow structure by strips of twelve rows, from both ends at once.
//!
//! The unknowns are cut into a head, a separator and a tail that has nothing to do with the head. The head is eliminated
//! in the order of the unknowns and the tail in the reverse order, each a [`Chain`] that ends with the rows of the
//! separator, on which both leave their share (nested dissection with one cut: George, *SIAM J. Numer. Anal.* 10, 1973,
//! p. 345); the separator comes last. Head and tail are independent, so that two threads take half the time, and all sums
//! have one order on any number of threads. A cut costs some b³ operations for a half-bandwidth b; where that does not
//! pay, all unknowns are head.
//!
//! Each chain holds its rows of the matrix, and of L, as strips; see [`super::strip_kernel`]. Entries of the matrix
//! between two unknowns of the separator are stored with the head.

use crate::energy::Build;
use crate::equilibrium::sparse::chain::{Chain, HEIGHT};
use crate::equilibrium::sparse::envelope::Envelope;
use crate::equilibrium::sparse::strip_kernel::{ChainData, Column, SolveData, backward, eliminate, forward};
use crate::equilibrium::sparse::structure::{Couplings, FactorError, NegativePivots, room};

/// Location of an unknown: the part of the structure that it belongs to, and its row there.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Location {
    Head(usize),
    Separator(usize),
    Tail(usize),
}

/// Solver for long and narrow structures, with room for one factor.
#[derive(Debug)]
pub struct StripSolver {
    /// Build whose instructions it computes with.
    build: Build,
    unknowns: usize,
    /// Unknowns of the separator.
    cut: std::ops::Range<usize>,
    head: Chain,
    tail: Chain,
    middle: Chain,
    flops: f64,
    /// Values of the matrix and then of its factor: head, tail and separator.
    numbers: Vec<f64>,
    inverses: [Vec<f64>; 3],
    scratch: [Vec<f64>; 2],
}

impl StripSolver {
    /// Chooses the cut, without allocating room for numbers.
    pub(super) fn structure(couplings: &Couplings, build: Build) -> Self {
        let envelope = Envelope::new(couplings);
        let count = couplings.unknowns;
        let cut = envelope.best_cut();
        let (begin, end) = (cut.start, cut.end);
        let head = Chain::new(begin, end - begin, |row| envelope.first[row]);
        let tail_own = count - end;
        let reversed = |unknown: usize| count - 1 - unknown;
        let tail = Chain::new(tail_own, end - begin, |row| match row < tail_own {
            true => reversed(envelope.last[reversed(row)]),
            false => match envelope.last[begin + row - tail_own] {
                last if last >= end => reversed(last),
                // A row that meets nothing of the tail begins with the separator.
                _ => tail_own,
            },
        });
        let middle = Chain::new(end - begin, 0, |_| 0);
        let flops = envelope.flops(&cut);
        Self {
            build,
            unknowns: count,
            cut,
            head,
            tail,
            middle,
            flops,
            numbers: Vec::new(),
            inverses: Default::default(),
            scratch: Default::default(),
        }
    }

    /// Allocates the room for numbers.
    pub(super) fn with_room(mut self) -> Result<Self, FactorError> {
        let entries = self.value_count();
        let too_large = FactorError::TooLarge { size: self.unknowns, entries };
        let room = |length: usize| room(length).ok_or(too_large);
        self.numbers = room(entries + HEIGHT * self.middle.columns())?;
        for (inverses, chain) in self.inverses.iter_mut().zip([&self.head, &self.tail, &self.middle]) {
            *inverses = room(HEIGHT * chain.own_strips)?;
        }
        let widest = self.head.widest().max(self.middle.widest());
        self.scratch = [room(HEIGHT * widest)?, room(HEIGHT * self.tail.widest())?];
        Ok(self)
    }

    /// Number of values that a matrix takes.
    pub(super) fn value_count(&self) -> usize {
        HEIGHT * (self.head.columns() + self.tail.columns())
    }

    /// Bound on the number of operations of a factorization.
    pub(super) fn flops(&self) -> f64 {
        self.flops
    }

    /// Number of values in the factor, including the zeros within the envelope.
    pub(super) fn factor_len(&self) -> usize {
        HEIGHT * (self.head.own_columns() + self.tail.own_columns() + self.middle.columns())
    }

    /// Largest number of threads that can share a factorization.
    pub(super) fn most_threads(&self) -> usize {
        1 + usize::from(self.tail.own > 0)
    }

    /// Unknowns of the separator.
    #[cfg(test)]
    pub(super) fn cut(&self) -> std::ops::Range<usize> {
        self.cut.clone()
    }

    fn locate(&self, unknown: usize) -> Location {
        if unknown < self.cut.start {
            Location::Head(unknown)
        } else if unknown < self.cut.end {
            Location::Separator(unknown - self.cut.start)
        } else {
            Location::Tail(self.unknowns - 1 - unknown)
        }
    }

    /// Offset among the values of an entry; `None` where head and tail do not meet.
    pub(super) fn offset_of(&self, a: usize, b: usize) -> Option<usize> {
        let in_head = |row: usize, column: usize| self.head.offset_of(row.max(column), row.min(column));
        let in_tail = |row: usize, column: usize| {
            let place = self.tail.offset_of(row.max(column), row.min(column))?;
            Some(HEIGHT * self.head.columns() + place)
        };
        let separator_in = |chain: &Chain, row: usize| HEIGHT * chain.own_strips + row;
        match (self.locate(a), self.locate(b)) {
            (Location::Head(a), Location::Head(b)) => in_head(a, b),
            (Location::Head(a), Location::Separator(b)) | (Location::Separator(b), Location::Head(a)) => {
                in_head(a, separator_in(&self.head, b))
            }
            (Location::Separator(a), Location::Separator(b)) => {
                in_head(separator_in(&self.head, a), separator_in(&self.head, b))
            }
            (Location::Tail(a), Location::Separator(b)) | (Location::Separator(b), Location::Tail(a)) => {
                in_tail(a, separator_in(&self.tail, b))
            }
            (Location::Tail(a), Location::Tail(b)) => in_tail(a, b),
            (Location::Head(_), Location::Tail(_)) | (Location::Tail(_), Location::Head(_)) => None,
        }
    }

    /// Distributes a vector over the rows of head and separator, and of tail and separator; the latter's rows are 0 on
    /// the tail.
    fn spread(&self, vector: &[f64]) -> [Vec<f64>; 2] {
        let mut parts = [vec![0.0; self.head.rows()], vec![0.0; self.tail.rows()]];
        parts[0][..self.cut.start].copy_from_slice(&vector[..self.cut.start]);
        parts[0][HEIGHT * self.head.own_strips..][..self.cut.len()].copy_from_slice(&vector[self.cut.clone()]);
        for (to, from) in parts[1].iter_mut().zip(vector[self.cut.end..].iter().rev()) {
            *to = *from;
        }
        parts
    }

    /// Multiplies the matrix with these values by a vector.
    pub(super) fn multiply(&self, values: &[f64], vector: &[f64]) -> Vec<f64> {
        let (of_head, of_tail) = columns(values).split_at(self.head.columns());
        let [head, mut tail] = self.spread(vector);
        let separator = |chain: &Chain| HEIGHT * chain.own_strips..HEIGHT * chain.own_strips + self.cut.len();
        tail[separator(&self.tail)].copy_from_slice(&vector[self.cut.clone()]);
        let head = multiply_chain(&self.head, of_head, &head);
        let tail = multiply_chain(&self.tail, of_tail, &tail);
        let mut product = vec![0.0; vector.len()];
        self.gather([&head, &tail], &mut product);
        for (sum, more) in product[self.cut.clone()].iter_mut().zip(&tail[separator(&self.tail)]) {
            *sum += more;
        }
        product
    }

    /// Collects a vector in the order of the unknowns; the separator's rows come from the head.
    fn gather(&self, [head, tail]: [&[f64]; 2], vector: &mut [f64]) {
        vector[..self.cut.start].copy_from_slice(&head[..self.cut.start]);
        vector[self.cut.clone()].copy_from_slice(&head[HEIGHT * self.head.own_strips..][..self.cut.len()]);
        for (to, from) in vector[self.cut.end..].iter_mut().rev().zip(tail) {
            *to = *from;
        }
    }

    /// Values of the matrix, to be filled in.
    pub(super) fn matrix_mut(&mut self) -> &mut [f64] {
        let entries = self.value_count();
        &mut self.numbers[..entries]
    }

    /// Replaces the matrix by its numeric factor L D Lᵀ; returns its negative pivots.
    pub(super) fn factorize(&mut self) -> Result<NegativePivots, FactorError> {
        let Self { build, head, tail, middle, numbers, inverses, scratch, .. } = self;
        let build = *build;
        let (of_head, rest) = columns_mut(numbers).split_at_mut(head.columns());
        let (of_tail, of_middle) = rest.split_at_mut(tail.columns());
        let [head_inverses, tail_inverses, middle_inverses] = inverses;
        let [row, other_row] = scratch.each_mut().map(|row| columns_mut(row));
        let (one, other) = rayon::join(
            || {
                let (factor, inverses) = (&mut *of_head, &mut head_inverses[..]);
                eliminate(build, head, &mut ChainData { factor, inverses, row: &mut *row })
            },
            || {
                let (factor, inverses) = (&mut *of_tail, &mut tail_inverses[..]);
                eliminate(build, tail, &mut ChainData { factor, inverses, row: other_row })
            },
        );
        let (size, mut negative) = (self.unknowns, NegativePivots::default());
        one.map_err(|place| FactorError::BadPivot { index: place, size })?;
        other.map_err(|place| FactorError::BadPivot { index: size - 1 - place, size })?;
        for strip in 0..middle.first.len() {
            let to = &mut of_middle[middle.start[strip]..middle.start[strip + 1]];
            let left = &of_head[head.start[head.own_strips + strip + 1] - to.len()..][..to.len()];
            let right = &of_tail[tail.start[tail.own_strips + strip + 1] - to.len()..][..to.len()];
            for (to, (a, b)) in
                to.as_flattened_mut().iter_mut().zip(left.as_flattened().iter().zip(right.as_flattened()))
            {
                for v in 0..a.len() {
                    to[v] = a[v] + b[v];
                }
            }
        }
        eliminate(build, middle, &mut ChainData { factor: of_middle, inverses: middle_inverses, row })
            .map_err(|place| FactorError::BadPivot { index: self.cut.start + place, size })?;
        self.inverses.iter().flatten().for_each(|inverse| negative.see(1.0 / inverse));
        Ok(negative)
    }

    /// Replaces every pivot by its magnitude.
    pub(super) fn make_positive(&mut self) {
        self.inverses.iter_mut().flatten().for_each(|inverse| *inverse = inverse.abs());
    }

    /// Solves in place with the last factor.
    pub(super) fn solve(&self, right_hand_side: &mut [f64]) {
        let Self { build, head, tail, middle, .. } = self;
        let build = *build;
        let (of_head, rest) = columns(&self.numbers).split_at(head.columns());
        let (of_tail, of_middle) = rest.split_at(tail.columns());
        let [head_inverses, tail_inverses, middle_inverses] = &self.inverses;
        let head_data = SolveData { factor: of_head, inverses: head_inverses };
        let tail_data = SolveData { factor: of_tail, inverses: tail_inverses };
        let middle_data = SolveData { factor: of_middle, inverses: middle_inverses };
        let [mut one, mut other] = self.spread(right_hand_side);
        rayon::join(|| forward(build, head, &head_data, &mut one), || forward(build, tail, &tail_data, &mut other));
        let (left, right) = (HEIGHT * head.own_strips, HEIGHT * tail.own_strips);
        let mut separator: Vec<f64> = one[left..].iter().zip(&other[right..]).map(|(a, b)| a + b).collect();
        forward(build, middle, &middle_data, &mut separator);
        backward(build, middle, &middle_data, &mut separator);
        one[left..].copy_from_slice(&separator);
        other[right..].copy_from_slice(&separator);
        rayon::join(|| backward(build, head, &head_data, &mut one), || backward(build, tail, &tail_data, &mut other));
        self.gather([&one, &other], right_hand_side);
    }
}

/// Multiplies a chain's rows of the matrix, with their transposes, by a vector.
fn multiply_chain(chain: &Chain, values: &[Column], vector: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; vector.len()];
    for strip in 0..chain.first.len() {
        let row = HEIGHT * strip;
        let stored = values[chain.start[strip]..chain.start[strip + 1]].iter();
        for (column, numbers) in (HEIGHT * chain.first[strip]..).zip(stored) {
            let numbers = numbers.as_flattened();
            let below = column.max(row) - row;
            for r in below..HEIGHT {
                product[row + r] += numbers[r] * vector[column];
            }
            let mirrored = if column < row { 0 } else { below + 1 };
            product[column] += (mirrored..HEIGHT).map(|r| numbers[r] * vector[row + r]).sum::<f64>();
        }
    }
    product
}

fn columns(numbers: &[f64]) -> &[Column] {
    numbers.as_chunks().0.as_chunks().0
}

fn columns_mut(numbers: &mut [f64]) -> &mut [Column] {
    numbers.as_chunks_mut().0.as_chunks_mut().0
}
