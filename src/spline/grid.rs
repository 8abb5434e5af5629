//! Numbering of what is arranged in rows and columns: the control points and the elements of a tensor-product surface.

/// A grid that is numbered with the second direction fastest: place (i₁, i₂) has the number i₁ n₂ + i₂.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Number of places in each direction.
    pub counts: [usize; 2],
}

impl Grid {
    /// Creates a grid of these counts.
    pub fn new(counts: [usize; 2]) -> Self {
        Self { counts }
    }

    /// Number of places.
    pub fn len(self) -> usize {
        self.counts[0] * self.counts[1]
    }

    /// Whether there are no places.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Number of the place (i₁, i₂).
    pub fn index(self, [i1, i2]: [usize; 2]) -> usize {
        i1 * self.counts[1] + i2
    }

    /// Place (i₁, i₂) that has a number.
    pub fn place(self, index: usize) -> [usize; 2] {
        [index / self.counts[1], index % self.counts[1]]
    }

    /// Number of the place with index `along` in `direction` and `across` in the other one.
    pub fn index_along(self, direction: usize, along: usize, across: usize) -> usize {
        self.index(if direction == 0 { [along, across] } else { [across, along] })
    }

    /// Numbers of all places with index `along` in `direction`, in the order of the other direction.
    pub fn line(self, direction: usize, along: usize) -> impl DoubleEndedIterator<Item = usize> + ExactSizeIterator {
        (0..self.counts[1 - direction]).map(move |across| self.index_along(direction, along, across))
    }

    /// Numbers of the block of `size` places that begins at `first`, with the second direction fastest.
    pub fn window(self, first: [usize; 2], size: [usize; 2]) -> impl Iterator<Item = usize> {
        let inner = Self::new(size);
        (0..inner.len()).map(move |k| {
            let [i1, i2] = inner.place(k);
            self.index([first[0] + i1, first[1] + i2])
        })
    }

    /// All numbers, ordered with the first direction fastest.
    pub fn first_fastest(self) -> impl Iterator<Item = usize> {
        (0..self.counts[1]).flat_map(move |i2| self.line(1, i2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_places_belong_together() {
        let grid = Grid::new([3, 5]);
        assert!((0..grid.len()).all(|index| grid.index(grid.place(index)) == index));
        assert_eq!(grid.line(0, 1).collect::<Vec<_>>(), [5, 6, 7, 8, 9]);
        assert_eq!(grid.line(1, 1).collect::<Vec<_>>(), [1, 6, 11]);
        assert_eq!(grid.window([1, 2], [2, 2]).collect::<Vec<_>>(), [7, 8, 12, 13]);
        assert_eq!(Grid::new([2, 3]).first_fastest().collect::<Vec<_>>(), [0, 3, 1, 4, 2, 5]);
    }
}
