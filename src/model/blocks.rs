//! Values of the blocks of a matrix on the control points.

use rayon::prelude::*;

use crate::model::BlockPattern;

/// Number of values of a 3 × 3 block.
pub const BLOCK: usize = 9;

/// Number of values that a thread clears at a time.
const SHARE: usize = 1 << 14;

/// Values of the blocks of a [`BlockPattern`]; empty where the matrix is zero.
#[derive(Clone, Debug, Default)]
pub struct Blocks {
    /// Values, `values[block · 9 + 3 c + d]`.
    pub values: Vec<f64>,
}

impl Blocks {
    /// Creates a matrix of zeros.
    pub fn zeros(pattern: &BlockPattern) -> Self {
        Self { values: vec![0.0; pattern.blocks() * BLOCK] }
    }

    /// Sets all values to zero.
    pub fn clear(&mut self) {
        self.values.par_chunks_mut(SHARE).for_each(|share| share.fill(0.0));
    }

    /// Whether nothing of the matrix is stored, because it is zero.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Values of the block with this index in the pattern.
    pub fn block_mut(&mut self, block: usize) -> &mut [f64] {
        &mut self.values[block * BLOCK..][..BLOCK]
    }

    /// Blocks on the diagonal, of the control points with themselves.
    pub fn diagonal(&self, pattern: &BlockPattern) -> impl Iterator<Item = &[f64]> {
        (0..pattern.points()).map(|point| &self.values[pattern.start(point) * BLOCK..][..BLOCK])
    }

    /// Multiplies the matrix by a field on the control points; blocks that are not stored are the transposes of those
    /// that are, times `mirrored`: 1 where the matrix is symmetric, −1 where it is skew.
    pub fn multiply(&self, pattern: &BlockPattern, mirrored: f64, field: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut product = vec![[0.0; 3]; field.len()];
        for i in 0..pattern.points() {
            let blocks = self.values[pattern.start(i) * BLOCK..].chunks(BLOCK);
            for (j, block) in pattern.row(i).iter().copied().zip(blocks) {
                for c in 0..3 {
                    for d in 0..3 {
                        product[i][c] += block[3 * c + d] * field[j][d];
                        if j != i {
                            product[j][d] += mirrored * (block[3 * c + d] * field[i][c]);
                        }
                    }
                }
            }
        }
        product
    }
}
