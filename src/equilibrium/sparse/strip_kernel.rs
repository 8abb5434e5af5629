//! L D Lᵀ and solution of a chain of strips, with the vector instructions of the machine.
//!
//! A strip is twelve rows of the lower triangle, from the first column in which one of them has an entry to its own
//! diagonal block, column after column. Within that envelope all fill stays (George & Liu, *Computer Solution of Large
//! Sparse Positive Definite Systems*, section 4.2), so that there are no lists of indices, and every number of L is one
//! sum over two contiguous stretches: with N = −L D,
//!
//! −N(i, j) = A(i, j) + Σ_{k<j} N(i, k) L(j, k),   L(i, j) = −N(i, j) / d_j.
//!
//! Tiles of twelve rows and four columns stay in registers for the whole of that sum.

use super::chain::{Chain, HEIGHT};
use crate::energy::Build;
use crate::shell::lanes::{FourLanes, Portable};
#[cfg(target_arch = "x86_64")]
use crate::shell::lanes_x86::{Fma, HasFma};

/// Number of columns of a tile.
const WIDTH: usize = 4;
/// Number of tiles of a square block.
const TILES: usize = HEIGHT / WIDTH;
/// Number of columns that a sum takes before it continues to the next tile: those of both strips, 2 × 9 kB, stay in the
/// first cache (32 kB) for all three tiles. With the whole depth at once a factorization for 128 × 16 cubic elements
/// took 16 ms in place of 14.
const STRETCH: usize = 96;
/// One column of a strip.
pub(super) type Column = [[f64; WIDTH]; TILES];

/// Storage that a chain is factored in.
pub(super) struct ChainData<'a> {
    /// The matrix, which becomes L without the ones of its diagonal; on the separator, what is left of the matrix.
    pub factor: &'a mut [Column],
    /// Inverses of the pivots, 1/D, of the chain's own rows.
    pub inverses: &'a mut [f64],
    /// Buffer for N of one strip.
    pub row: &'a mut [Column],
}

/// A computation on a chain, written for whatever vectors the machine has.
trait ChainWork {
    type Output;

    fn run<V: FourLanes>(self, proof: V::Proof) -> Self::Output;
}

/// Runs a computation with the instructions of a build.
fn on<W: ChainWork>(build: Build, work: W) -> W::Output {
    match build {
        Build::Portable => work.run::<Portable>(()),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `proof` says that the processor has the instructions.
        Build::Fma(proof) => unsafe { on_fma(proof, work) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `proof` says that the processor has the instructions.
        Build::Avx512(proof) => unsafe { on_fma(proof.fma(), work) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn on_fma<W: ChainWork>(proof: HasFma, work: W) -> W::Output {
    work.run::<Fma>(proof)
}

/// Factors a chain; the error is the row of a pivot that has no inverse.
pub(super) fn eliminate(build: Build, chain: &Chain, data: &mut ChainData) -> Result<(), usize> {
    on(build, Eliminate { chain, data })
}

struct Eliminate<'a, 'd> {
    chain: &'a Chain,
    data: &'a mut ChainData<'d>,
}

impl ChainWork for Eliminate<'_, '_> {
    type Output = Result<(), usize>;

    #[inline(always)]
    fn run<V: FourLanes>(self, proof: V::Proof) -> Result<(), usize> {
        eliminate_with::<V>(proof, self.chain, self.data)
    }
}

#[inline(always)]
fn eliminate_with<V: FourLanes>(proof: V::Proof, chain: &Chain, data: &mut ChainData) -> Result<(), usize> {
    for strip in 0..chain.first.len() {
        let first = chain.first[strip];
        let (done, rest) = data.factor.split_at_mut(chain.start[strip]);
        for other in first..strip.min(chain.own_strips) {
            let common = first.max(chain.first[other]);
            let lower = &done[chain.start[other] + HEIGHT * (common - chain.first[other])..chain.start[other + 1]];
            let begin = HEIGHT * (common - first);
            let block = Block { begin, depth: HEIGHT * (other - common) };
            let inverses = &data.inverses[HEIGHT * other..];
            off_diagonal_block::<V>(proof, &block, lower, inverses, data.row, rest);
        }
        if strip < chain.own_strips {
            let used = chain.own - (HEIGHT * strip).min(chain.own);
            let inverses = &mut data.inverses[HEIGHT * strip..][..HEIGHT];
            let depth = HEIGHT * (strip - first);
            diagonal_block::<V>(proof, depth, used, inverses, data.row, rest).map_err(|row| HEIGHT * strip + row)?;
            continue;
        }
        for other in chain.own_strips..=strip {
            let common = first.max(chain.first[other]);
            let begin = HEIGHT * (common - first);
            let depth = HEIGHT * (chain.own_strips - common);
            let negative = &data.row[begin..][..depth];
            let lower = match other == strip {
                true => &rest[begin..],
                false => &done[chain.start[other] + HEIGHT * (common - chain.first[other])..],
            };
            let at = HEIGHT * (other - first);
            let block = sum::<V>(proof, &rest[at..], negative, lower);
            rest[at..][..HEIGHT].copy_from_slice(&block);
        }
    }
    Ok(())
}

/// The columns of a block's sum: where they begin in its strip, and how many lie before the block.
struct Block {
    begin: usize,
    depth: usize,
}

/// Adds Σ_k N(i, k) L(j, k), for the columns k before it, to a block of the matrix.
#[inline(always)]
fn sum<V: FourLanes>(proof: V::Proof, values: &[Column], negative: &[Column], lower: &[Column]) -> [Column; HEIGHT] {
    let mut block = [[[0.0; WIDTH]; TILES]; HEIGHT];
    block.copy_from_slice(&values[..HEIGHT]);
    for (negative, lower) in negative.chunks(STRETCH).zip(lower.chunks(STRETCH)) {
        for tile in 0..TILES {
            let block = &mut block[WIDTH * tile..][..WIDTH];
            let sums = extend::<V>(proof, load_tile(proof, block), negative, lower, tile);
            for t in 0..WIDTH {
                store(sums[t], &mut block[t]);
            }
        }
    }
    block
}

/// Adds to a tile, for each column of a stretch, twelve numbers of one strip times four of the other.
#[inline(always)]
fn extend<V: FourLanes>(
    proof: V::Proof,
    mut sums: [[V; TILES]; WIDTH],
    negative: &[Column],
    lower: &[Column],
    tile: usize,
) -> [[V; TILES]; WIDTH] {
    for (negative, lower) in negative.iter().zip(lower) {
        let n: [V; TILES] = load(proof, negative);
        for t in 0..WIDTH {
            let l = V::splat(proof, lower[tile][t]);
            for v in 0..TILES {
                sums[t][v] = n[v].mul_add(l, sums[t][v]);
            }
        }
    }
    sums
}

#[inline(always)]
fn load_tile<V: FourLanes>(proof: V::Proof, from: &[Column]) -> [[V; TILES]; WIDTH] {
    let mut vectors = [[V::splat(proof, 0.0); TILES]; WIDTH];
    for t in 0..WIDTH {
        vectors[t] = load(proof, &from[t]);
    }
    vectors
}

#[inline(always)]
fn load<V: FourLanes>(proof: V::Proof, from: &Column) -> [V; TILES] {
    [V::load(proof, &from[0]), V::load(proof, &from[1]), V::load(proof, &from[2])]
}

#[inline(always)]
fn store<V: FourLanes>(vectors: [V; TILES], to: &mut Column) {
    for v in 0..TILES {
        vectors[v].store(&mut to[v]);
    }
}

/// Computes a block left of the diagonal: `lower` are the rows of the other strip, from the first column that both
/// have.
#[inline(always)]
fn off_diagonal_block<V: FourLanes>(
    proof: V::Proof,
    block: &Block,
    lower: &[Column],
    inverses: &[f64],
    row: &mut [Column],
    factor: &mut [Column],
) {
    let minus = V::splat(proof, -1.0);
    let before = block.begin..block.begin + block.depth;
    let start = sum::<V>(proof, &factor[before.end..], &row[before], lower);
    for tile in 0..TILES {
        let depth = block.depth + WIDTH * tile;
        let at = block.begin + depth;
        let (negative, beside) = (&row[block.begin + block.depth..at], &lower[block.depth..]);
        let mut sums = extend::<V>(proof, load_tile(proof, &start[WIDTH * tile..]), negative, beside, tile);
        for s in 0..WIDTH {
            let (inverse, unit) = (V::splat(proof, inverses[WIDTH * tile + s]), &lower[depth + s][tile]);
            let mut negative = sums[s];
            for v in 0..TILES {
                negative[v] = minus * sums[s][v];
            }
            for t in s + 1..WIDTH {
                let l = V::splat(proof, unit[t]);
                for v in 0..TILES {
                    sums[t][v] = negative[v].mul_add(l, sums[t][v]);
                }
            }
            store(negative, &mut row[at + s]);
            for v in 0..TILES {
                sums[s][v] = sums[s][v] * inverse;
            }
            store(sums[s], &mut factor[at + s]);
        }
    }
}

/// Factors the block on the diagonal, `depth` columns after the first; rows from `used` on do not belong to the matrix,
/// and their pivots are 1.
#[inline(always)]
fn diagonal_block<V: FourLanes>(
    proof: V::Proof,
    depth: usize,
    used: usize,
    inverses: &mut [f64],
    row: &mut [Column],
    factor: &mut [Column],
) -> Result<(), usize> {
    let minus = V::splat(proof, -1.0);
    let start = sum::<V>(proof, &factor[depth..], &row[..depth], factor);
    for tile in 0..TILES {
        let at = depth + WIDTH * tile;
        let (negative, beside) = (&row[depth..at], &factor[depth..at]);
        let mut sums = extend::<V>(proof, load_tile(proof, &start[WIDTH * tile..]), negative, beside, tile);
        for s in 0..WIDTH {
            let place = WIDTH * tile + s;
            let mut numbers: Column = [[0.0; WIDTH]; TILES];
            store(sums[s], &mut numbers);
            let pivot = if place < used { numbers[tile][s] } else { 1.0 };
            inverses[place] = 1.0 / pivot;
            // The pivot must not be zero, too small to have an inverse, infinite or NaN.
            if !inverses[place].is_finite() || inverses[place] == 0.0 {
                return Err(place);
            }
            let inverse = V::splat(proof, inverses[place]);
            let mut negative = sums[s];
            for v in 0..TILES {
                negative[v] = minus * sums[s][v];
            }
            store(negative, &mut row[at + s]);
            for v in 0..TILES {
                sums[s][v] = sums[s][v] * inverse;
            }
            let unit = &mut factor[at + s];
            store(sums[s], unit);
            for t in s + 1..WIDTH {
                let l = V::splat(proof, unit[tile][t]);
                for v in 0..TILES {
                    sums[t][v] = negative[v].mul_add(l, sums[t][v]);
                }
            }
        }
    }
    Ok(())
}

/// Factor that a chain is solved with.
pub(super) struct SolveData<'a> {
    /// The factor L.
    pub factor: &'a [Column],
    /// Inverses of the pivots, 1/D.
    pub inverses: &'a [f64],
}

/// Substitutes forward: in the chain's own rows x becomes L⁻¹ x, whose contributions are subtracted from the
/// separator's rows.
pub(super) fn forward(build: Build, chain: &Chain, data: &SolveData, x: &mut [f64]) {
    on(build, Forward { chain, data, x })
}

struct Forward<'a, 'd> {
    chain: &'a Chain,
    data: &'a SolveData<'d>,
    x: &'a mut [f64],
}

impl ChainWork for Forward<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<V: FourLanes>(self, proof: V::Proof) {
        forward_with::<V>(proof, self.chain, self.data, self.x);
    }
}

#[inline(always)]
fn forward_with<V: FourLanes>(proof: V::Proof, chain: &Chain, data: &SolveData, x: &mut [f64]) {
    for strip in 0..chain.first.len() {
        let (known, here) = x.split_at_mut(HEIGHT * strip);
        let here = &mut here.as_chunks_mut::<WIDTH>().0[..TILES];
        let first = HEIGHT * chain.first[strip];
        let columns = &data.factor[chain.start[strip]..];
        let known = &known[first..(HEIGHT * chain.own_strips).min(HEIGHT * strip)];
        let mut sums = [V::splat(proof, 0.0); TILES];
        for (column, value) in columns.iter().zip(known) {
            let value = V::splat(proof, *value);
            let column: [V; TILES] = load(proof, column);
            for v in 0..TILES {
                sums[v] = column[v].mul_add(value, sums[v]);
            }
        }
        for v in 0..TILES {
            (V::load(proof, &here[v]) - sums[v]).store(&mut here[v]);
        }
        if strip < chain.own_strips {
            let block = &columns[known.len()..][..HEIGHT];
            let here = here.as_flattened_mut();
            for (k, column) in block.iter().enumerate() {
                for r in k + 1..HEIGHT {
                    here[r] -= column.as_flattened()[r] * here[k];
                }
            }
        }
    }
}

/// Substitutes backward: x becomes L⁻ᵀ D⁻¹ x in the chain's own rows; those of the separator are known.
pub(super) fn backward(build: Build, chain: &Chain, data: &SolveData, x: &mut [f64]) {
    on(build, Backward { chain, data, x })
}

struct Backward<'a, 'd> {
    chain: &'a Chain,
    data: &'a SolveData<'d>,
    x: &'a mut [f64],
}

impl ChainWork for Backward<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<V: FourLanes>(self, proof: V::Proof) {
        backward_with::<V>(proof, self.chain, self.data, self.x);
    }
}

#[inline(always)]
fn backward_with<V: FourLanes>(proof: V::Proof, chain: &Chain, data: &SolveData, x: &mut [f64]) {
    for (value, inverse) in x.iter_mut().zip(data.inverses) {
        *value *= inverse;
    }
    for strip in (0..chain.first.len()).rev() {
        let (before, here) = x.split_at_mut(HEIGHT * strip);
        let first = HEIGHT * chain.first[strip];
        let columns = &data.factor[chain.start[strip]..];
        let before = &mut before[first..(HEIGHT * chain.own_strips).min(HEIGHT * strip)];
        if strip < chain.own_strips {
            for (k, column) in columns[before.len()..][..HEIGHT].iter().enumerate().rev() {
                for r in k + 1..HEIGHT {
                    here[k] -= column.as_flattened()[r] * here[r];
                }
            }
        }
        let here: [V; TILES] = {
            let here = here.as_chunks::<WIDTH>().0;
            [V::load(proof, &here[0]), V::load(proof, &here[1]), V::load(proof, &here[2])]
        };
        for (columns, before) in columns.as_chunks::<WIDTH>().0.iter().zip(before.as_chunks_mut::<WIDTH>().0) {
            let mut products = [V::splat(proof, 0.0); WIDTH];
            for t in 0..WIDTH {
                let column: [V; TILES] = load(proof, &columns[t]);
                products[t] = column[2].mul_add(here[2], column[1].mul_add(here[1], column[0] * here[0]));
            }
            (V::load(proof, before) - V::sums(products)).store(before);
        }
    }
}
