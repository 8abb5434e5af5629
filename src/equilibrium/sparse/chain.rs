//! The arrangement in strips of rows that are eliminated one after the other.

/// Number of rows of a strip.
pub(super) const HEIGHT: usize = 12;

/// Rows in the order in which they are eliminated: the chain's own, and then those of the separator.
#[derive(Debug, Default)]
pub(super) struct Chain {
    /// Number of own unknowns.
    pub own: usize,
    /// Number of strips of the own unknowns.
    pub own_strips: usize,
    /// First block of columns of each strip; of the separator's, at most `own_strips`.
    pub first: Vec<usize>,
    /// First column of each strip in the storage, and the end of the last one.
    pub start: Vec<usize>,
}

impl Chain {
    /// Builds a chain from the first column of each row, own rows first.
    pub fn new(own: usize, separator: usize, first_of: impl Fn(usize) -> usize) -> Self {
        let own_strips = own.div_ceil(HEIGHT);
        let strips = own_strips + separator.div_ceil(HEIGHT);
        let place = |row: usize| if row < own { row } else { own_strips * HEIGHT + (row - own) };
        let mut first: Vec<usize> = (0..strips).map(|strip| strip.min(own_strips)).collect();
        for row in 0..own + separator {
            let strip = place(row) / HEIGHT;
            first[strip] = first[strip].min(place(first_of(row)) / HEIGHT);
        }
        let mut start = vec![0];
        for (strip, first) in first.iter().enumerate() {
            start.push(start[strip] + HEIGHT * (strip + 1 - first));
        }
        Self { own, own_strips, first, start }
    }

    /// Number of rows, with the padding.
    pub fn rows(&self) -> usize {
        HEIGHT * self.first.len()
    }

    /// Number of columns of all strips.
    pub fn columns(&self) -> usize {
        self.start.last().copied().unwrap_or(0)
    }

    /// Number of columns of all strips that lie in the chain's own.
    pub fn own_columns(&self) -> usize {
        let separator = self.first.len() - self.own_strips;
        self.columns() - HEIGHT * separator * (separator + 1) / 2
    }

    /// Number of columns of the widest strip.
    pub fn widest(&self) -> usize {
        self.start.windows(2).map(|pair| pair[1] - pair[0]).max().unwrap_or(0)
    }

    /// Offset in the storage of an entry of the lower triangle; `None` outside the strips.
    pub fn offset_of(&self, row: usize, column: usize) -> Option<usize> {
        let strip = row / HEIGHT;
        let from_first = column.checked_sub(HEIGHT * self.first[strip])?;
        Some((self.start[strip] + from_first) * HEIGHT + row % HEIGHT)
    }
}
