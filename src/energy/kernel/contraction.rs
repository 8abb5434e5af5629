//! Sums over the points of a block: F g into the residual, Fᵀ H F into the stiffness of an element. See
//! [`super`] for the order of the sums.
//!
//! Loops over arrays, not `map`: a closure is a function of its own without the vector instructions, and where it is not
//! inlined its vectors go through memory (the residual took twice as long).

use crate::model::BATCH;
use crate::shell::lanes::Lanes;
use crate::shell::{BatchGradient, BatchHessian};

/// Number of batches of points that the stiffness sums before it is stored: 16 points, all of a cubic element.
pub(super) const BLOCK: usize = 4;

/// A block of points, which adds to the sums of an element; `ROWS` derivatives of the functions at each.
pub(super) struct Block<'a, W: Lanes, const ROWS: usize> {
    /// Proof that the processor has the vector instructions.
    pub proof: W::Proof,
    /// Derivatives of the functions at the points of the block.
    pub functions: &'a [f64],
    /// Number of functions of the element.
    pub used: usize,
    /// Number of functions of the element, with the padding.
    pub padded: usize,
    /// Whether the sums begin with this block.
    pub first: bool,
}

impl<W: Lanes, const ROWS: usize> Block<'_, W, ROWS> {
    /// Number of whole vectors in a row of the table.
    #[inline(always)]
    fn stride(&self) -> usize {
        self.padded / W::WIDTH
    }

    /// Derivatives of the functions at each point: `ROWS` rows of `padded` numbers.
    #[inline(always)]
    fn points(&self) -> std::slice::ChunksExact<'_, f64> {
        self.functions.chunks_exact(ROWS * self.padded)
    }
}

/// Adds Σ F g over the points of a block.
#[inline(always)]
pub(super) fn add_residual<W: Lanes, const ROWS: usize>(
    block: &Block<W, ROWS>,
    gradients: &[BatchGradient<ROWS>; BLOCK],
    residual: &mut [f64],
) {
    let vectors = block.used.div_ceil(W::WIDTH);
    let mut m = 0;
    while m < vectors {
        match vectors - m {
            1 => residual_tile::<W, ROWS, 1>(block, m, gradients, residual),
            2 => residual_tile::<W, ROWS, 2>(block, m, gradients, residual),
            3 => residual_tile::<W, ROWS, 3>(block, m, gradients, residual),
            _ => residual_tile::<W, ROWS, 4>(block, m, gradients, residual),
        }
        m += 4;
    }
}

/// Adds to the residual of `WIDTH` vectors of functions, from vector `m` on.
#[inline(always)]
fn residual_tile<W: Lanes, const ROWS: usize, const WIDTH: usize>(
    block: &Block<W, ROWS>,
    m: usize,
    gradients: &[BatchGradient<ROWS>; BLOCK],
    residual: &mut [f64],
) {
    let (proof, stride) = (block.proof, block.stride());
    let residual = W::chunks_mut(residual);
    let mut sums = [[W::splat(proof, 0.0); WIDTH]; 3];
    if !block.first {
        for c in 0..3 {
            let from = &residual[c * stride + m..][..WIDTH];
            for t in 0..WIDTH {
                sums[c][t] = W::load(proof, &from[t]);
            }
        }
    }
    for (q, rows) in block.points().enumerate() {
        let gradient = &gradients[q / BATCH];
        for k in 0..ROWS {
            let from = &W::chunks(rows)[k * stride + m..][..WIDTH];
            let mut g = [W::splat(proof, 0.0); 3];
            for c in 0..3 {
                g[c] = W::splat(proof, gradient[k][c][q % BATCH]);
            }
            for t in 0..WIDTH {
                let f = W::load(proof, &from[t]);
                for c in 0..3 {
                    sums[c][t] = g[c].mul_add(f, sums[c][t]);
                }
            }
        }
    }
    for c in 0..3 {
        let to = &mut residual[c * stride + m..][..WIDTH];
        for t in 0..WIDTH {
            sums[c][t].store(&mut to[t]);
        }
    }
}

/// Adds Σ Fᵀ H F over the points of a block.
#[inline(always)]
pub(super) fn contract<W: Lanes, const ROWS: usize, const SIZE: usize>(
    block: &Block<W, ROWS>,
    hessians: &[BatchHessian<SIZE>],
    half: &mut [[W::Array; SIZE]],
    stiffness: &mut [f64],
) {
    for c in 0..3 {
        for group in 0..block.used.div_ceil(W::WIDTH) {
            for ((q, rows), half) in block.points().enumerate().zip(half.iter_mut()) {
                half_product(block, W::chunks(rows), group, &hessians[q / BATCH], [c, q % BATCH], half);
            }
            let mut b = group * W::WIDTH;
            while b < block.used {
                match block.used - b {
                    1 => stiffness_tile::<W, ROWS, SIZE, 1>(block, half, [group, c, b], stiffness),
                    2 => stiffness_tile::<W, ROWS, SIZE, 2>(block, half, [group, c, b], stiffness),
                    3 => stiffness_tile::<W, ROWS, SIZE, 3>(block, half, [group, c, b], stiffness),
                    _ => stiffness_tile::<W, ROWS, SIZE, 4>(block, half, [group, c, b], stiffness),
                }
                b += 4;
            }
        }
    }
}

/// Adds to the rows (b, d) of `WIDTH` functions from b on and the columns (a, c) of one vector of functions.
#[inline(always)]
fn stiffness_tile<W: Lanes, const ROWS: usize, const SIZE: usize, const WIDTH: usize>(
    block: &Block<W, ROWS>,
    half: &[[W::Array; SIZE]],
    [group, c, b]: [usize; 3],
    stiffness: &mut [f64],
) {
    let proof = block.proof;
    let mut sums = [[W::splat(proof, 0.0); 3]; WIDTH];
    let place = |t: usize, d: usize| (((b + t) * 3 + d) * 3 + c) * block.stride() + group;
    let stiffness = W::chunks_mut(stiffness);
    if !block.first {
        for t in 0..WIDTH {
            for d in 0..3 {
                sums[t][d] = W::load(proof, &stiffness[place(t, d)]);
            }
        }
    }
    for (rows, half) in block.points().zip(half) {
        for l in 0..ROWS {
            let mut p = [W::splat(proof, 0.0); 3];
            for d in 0..3 {
                p[d] = W::load(proof, &half[3 * l + d]);
            }
            let functions = &rows[l * block.padded + b..][..WIDTH];
            for t in 0..WIDTH {
                let f = W::splat(proof, functions[t]);
                for d in 0..3 {
                    sums[t][d] = f.mul_add(p[d], sums[t][d]);
                }
            }
        }
    }
    for t in 0..WIDTH {
        for d in 0..3 {
            sums[t][d].store(&mut stiffness[place(t, d)]);
        }
    }
}

/// Computes P for one vector of functions, component c and one lane of the Hessians.
#[inline(always)]
fn half_product<W: Lanes, const ROWS: usize, const SIZE: usize>(
    block: &Block<W, ROWS>,
    functions: &[W::Array],
    group: usize,
    hessian: &BatchHessian<SIZE>,
    [c, lane]: [usize; 2],
    half: &mut [W::Array; SIZE],
) {
    let mut f = [W::splat(block.proof, 0.0); ROWS];
    for k in 0..ROWS {
        f[k] = W::load(block.proof, &functions[k * block.stride() + group]);
    }
    for column in 0..SIZE {
        let mut sum = f[0] * W::splat(block.proof, hessian[c][column][lane]);
        for k in 1..ROWS {
            sum = f[k].mul_add(W::splat(block.proof, hessian[3 * k + c][column][lane]), sum);
        }
        sum.store(&mut half[column]);
    }
}
