//! Energy, residual and stiffness of one element.
//!
//! With F_k(a) the k-th derivative of basis function a at a quadrature point, g the gradient (5 × 3) and H the Hessian
//! (15 × 15) of the point's energy: r(a, c) = Σ_k F_k(a) g(k, c) and K(a c, b d) = Σ_kl F_k(a) H(k c, l d) F_l(b),
//! formed as P(l, d) = Σ_k F_k(a) H(k c, l d) with a lane for each a, and then Σ_l P(l, d) F_l(b). Only blocks a ≤ b
//! (a rounded down to a whole vector) are formed.
//!
//! Energies and Hessians are formed for four points at a time, with a lane for each. A tile of K (one vector of a, three
//! d, four b: twelve registers) takes the terms of all points of a block, 80 for each number, before it is stored; with
//! a store after every point the whole took twice as long. Every number is summed over the points and over l in one
//! order, whatever the width of the vectors: builds that round alike agree bit for bit.
//!
//! The structure of H (rank one in the second derivatives) saves nothing: 66 products for 75 in P, and as many in K.

mod build;
mod contraction;

pub(crate) use build::Build;
use contraction::{Block, add_residual, contract};

use crate::model::{BATCH, LANES, Tables};
use crate::shell::lanes::{FourLanes, Lanes, Portable};
#[cfg(target_arch = "x86_64")]
use crate::shell::lanes_x86::{Avx512, Fma, HasAvx512, HasFma};
use crate::shell::{BatchGradient, BatchHessian, PointBatch};

/// Batches of points that the stiffness takes before it is stored: 16 points, all of a cubic element.
const BLOCK: usize = 4;
/// Numbers of P(l, d) for one (a, c): `3 l + d`.
const HALF_LEN: usize = 15;

/// Local arrays of one element.
pub(super) struct ElementBuffers {
    /// `displacement[c · padded + a]`.
    pub displacement: Vec<f64>,
    /// `residual[c · padded + a]`.
    pub residual: Vec<f64>,
    /// K(a c, b d) at `stiffness[((b · 3 + d) · 3 + c) · padded + a]`, for a ≤ b.
    pub stiffness: Vec<f64>,
    /// Strain energy.
    pub energy: f64,
    /// P of a vector of functions at each point of a block.
    half: Vec<f64>,
    gradients: [BatchGradient; BLOCK],
    hessians: Vec<BatchHessian>,
}

impl ElementBuffers {
    /// Buffers for `padded` basis functions.
    pub fn new(padded: usize) -> Self {
        Self {
            displacement: vec![0.0; 3 * padded],
            residual: vec![0.0; 3 * padded],
            stiffness: vec![0.0; 9 * padded * padded],
            energy: 0.0,
            half: vec![0.0; BLOCK * BATCH * HALF_LEN * LANES],
            gradients: [[[[0.0; BATCH]; 3]; 5]; BLOCK],
            hessians: vec![[[[0.0; BATCH]; 15]; 15]; BLOCK],
        }
    }
}

/// How much of an element is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Want {
    /// Energy only.
    Energy,
    /// Energy and residual.
    Residual,
    /// Energy, residual and stiffness.
    Stiffness,
}

/// Integrates an element into its buffers.
pub(super) fn integrate_element(
    tables: &Tables,
    element: usize,
    want: Want,
    build: Build,
    buffers: &mut ElementBuffers,
) {
    let points = Points::of(tables, element);
    match build {
        Build::Portable => integrate::<Portable, Portable>((), (), &points, want, buffers),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `proof` says that the processor has the instructions.
        Build::Fma(proof) => unsafe { integrate_fma(proof, &points, want, buffers) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `proof` says that the processor has the instructions.
        Build::Avx512(proof) => unsafe { integrate_avx512(proof, &points, want, buffers) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn integrate_fma(proof: HasFma, points: &Points, want: Want, buffers: &mut ElementBuffers) {
    integrate::<Fma, Fma>(proof, proof, points, want, buffers);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx2,fma")]
fn integrate_avx512(proof: HasAvx512, points: &Points, want: Want, buffers: &mut ElementBuffers) {
    integrate::<Fma, Avx512>(proof.fma(), proof, points, want, buffers);
}

/// What an element is integrated over.
struct Points<'a> {
    /// As in [`Tables::functions`].
    functions: &'a [f64],
    batches: &'a [PointBatch],
    /// Basis functions without the padding.
    used: usize,
    padded: usize,
}

impl<'a> Points<'a> {
    fn of(tables: &'a Tables, element: usize) -> Self {
        Self {
            functions: tables.element_functions(element),
            batches: tables.element_batches(element),
            used: tables.functions_per_element,
            padded: tables.padded,
        }
    }
}

/// `V` has a lane for each point, `W` one for each basis function.
#[inline(always)]
fn integrate<V: FourLanes, W: Lanes>(
    points_proof: V::Proof,
    rows_proof: W::Proof,
    points: &Points,
    want: Want,
    buffers: &mut ElementBuffers,
) {
    let ElementBuffers { displacement, residual, stiffness, energy, half, gradients, hessians } = buffers;
    let Points { used, padded, .. } = *points;
    let mut sum = V::splat(points_proof, 0.0);
    let blocks = points.batches.chunks(BLOCK).zip(points.functions.chunks(BLOCK * BATCH * 5 * padded));
    for (block, (batches, functions)) in blocks.enumerate() {
        let of_batch = functions.chunks(BATCH * 5 * padded);
        for (i, (points, functions)) in batches.iter().zip(of_batch).enumerate() {
            let u = displacement_derivatives::<V>(points_proof, functions, padded, used, displacement);
            let energies = match want {
                Want::Energy => points.energy(points_proof, &u),
                Want::Residual => points.gradient(points_proof, &u, &mut gradients[i]),
                Want::Stiffness => points.hessian(points_proof, &u, &mut gradients[i], &mut hessians[i]),
            };
            sum = sum + energies;
        }
        if want == Want::Energy {
            continue;
        }
        let block = Block::<W> { proof: rows_proof, functions, used, padded, first: block == 0 };
        add_residual(&block, gradients, residual);
        if want == Want::Stiffness {
            contract(&block, hessians, W::chunks_mut(half).as_chunks_mut().0, stiffness);
        }
    }
    let mut energies = [0.0; BATCH];
    sum.store(&mut energies);
    *energy = (energies[0] + energies[1]) + (energies[2] + energies[3]);
}

/// u,₁ u,₂ u,₁₁ u,₂₂ u,₁₂ at the points of a batch; zero where a batch has fewer than four.
#[inline(always)]
fn displacement_derivatives<V: FourLanes>(
    proof: V::Proof,
    functions: &[f64],
    padded: usize,
    used: usize,
    displacement: &[f64],
) -> [[V; 3]; 5] {
    match functions.len() / (5 * padded) {
        1 => derivatives_of::<V, 1>(proof, functions, padded, used, displacement),
        2 => derivatives_of::<V, 2>(proof, functions, padded, used, displacement),
        3 => derivatives_of::<V, 3>(proof, functions, padded, used, displacement),
        _ => derivatives_of::<V, 4>(proof, functions, padded, used, displacement),
    }
}

#[inline(always)]
fn derivatives_of<V: FourLanes, const COUNT: usize>(
    proof: V::Proof,
    functions: &[f64],
    padded: usize,
    used: usize,
    displacement: &[f64],
) -> [[V; 3]; 5] {
    let zero = V::splat(proof, 0.0);
    let vectors = used.div_ceil(V::WIDTH);
    let mut u = [[zero; 3]; 5];
    let x = &V::chunks(displacement)[..vectors];
    let y = &V::chunks(&displacement[padded..])[..vectors];
    let z = &V::chunks(&displacement[2 * padded..])[..vectors];
    for k in 0..5 {
        let mut rows = [V::chunks(&[]); COUNT];
        for (q, row) in rows.iter_mut().enumerate() {
            *row = &V::chunks(&functions[(q * 5 + k) * padded..])[..vectors];
        }
        let mut sums = [[zero; 4]; 3];
        for m in 0..vectors {
            let [x, y, z] = [V::load(proof, &x[m]), V::load(proof, &y[m]), V::load(proof, &z[m])];
            for q in 0..COUNT {
                let f = V::load(proof, &rows[q][m]);
                sums[0][q] = f.mul_add(x, sums[0][q]);
                sums[1][q] = f.mul_add(y, sums[1][q]);
                sums[2][q] = f.mul_add(z, sums[2][q]);
            }
        }
        for c in 0..3 {
            u[k][c] = V::sums(sums[c]);
        }
    }
    u
}

#[cfg(test)]
mod tests;
