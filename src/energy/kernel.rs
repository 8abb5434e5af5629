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
//!
//! Where stretching has points of its own, its energy depends on the first two derivatives alone, and H is 6 × 6: 18 products
//! for 45 at each point and pair of functions.

mod build;
mod contraction;

pub(crate) use build::Build;
use contraction::{BLOCK, Block, add_residual, contract};

use crate::model::{BATCH, LANES, PointTable, Tables};
use crate::shell::lanes::{FourLanes, Lanes, Portable};
#[cfg(target_arch = "x86_64")]
use crate::shell::lanes_x86::{Avx512, Fma, HasAvx512, HasFma};
use crate::shell::{BatchGradient, BatchHessian, FreeStrain, PointBatch, PointKernel, StretchingBatch};

/// Largest number of values P(l, d) for one (a, c), at `3 l + d`.
const HALF_LEN: usize = 15;

/// Arrays of one element, in its own numbering.
pub(super) struct ElementBuffers {
    /// Displacement of the control points, `displacement[c · padded + a]`.
    pub displacement: Vec<f64>,
    /// Gradient of the energy, `residual[c · padded + a]`.
    pub residual: Vec<f64>,
    /// Stiffness K(a c, b d) at `stiffness[((b · 3 + d) · 3 + c) · padded + a]`, for a ≤ b.
    pub stiffness: Vec<f64>,
    /// Strain that has no energy, where there is one.
    pub free: Option<FreeStrain>,
    /// Strain energy, N·mm.
    pub energy: f64,
    /// P for one vector of functions, at each point of a block.
    half: Vec<f64>,
    whole: Derivatives<5, 15>,
    stretching: Derivatives<2, 6>,
}

/// Gradients and Hessians of a block of points.
struct Derivatives<const ROWS: usize, const SIZE: usize> {
    gradients: [BatchGradient<ROWS>; BLOCK],
    hessians: Vec<BatchHessian<SIZE>>,
}

impl<const ROWS: usize, const SIZE: usize> Derivatives<ROWS, SIZE> {
    fn new() -> Self {
        Self { gradients: [[[[0.0; BATCH]; 3]; ROWS]; BLOCK], hessians: vec![[[[0.0; BATCH]; SIZE]; SIZE]; BLOCK] }
    }
}

impl ElementBuffers {
    /// Allocates buffers for elements of `padded` basis functions.
    pub fn new(padded: usize) -> Self {
        Self {
            displacement: vec![0.0; 3 * padded],
            residual: vec![0.0; 3 * padded],
            stiffness: vec![0.0; 9 * padded * padded],
            free: None,
            energy: 0.0,
            half: vec![0.0; BLOCK * BATCH * HALF_LEN * LANES],
            whole: Derivatives::new(),
            stretching: Derivatives::new(),
        }
    }
}

/// What an assembly computes: energy, residual, or stiffness as well.
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
    let points = ElementPoints::of(tables, element);
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
fn integrate_fma(proof: HasFma, points: &ElementPoints, want: Want, buffers: &mut ElementBuffers) {
    integrate::<Fma, Fma>(proof, proof, points, want, buffers);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx2,fma")]
fn integrate_avx512(proof: HasAvx512, points: &ElementPoints, want: Want, buffers: &mut ElementBuffers) {
    integrate::<Fma, Avx512>(proof.fma(), proof, points, want, buffers);
}

/// Quadrature points that an element is integrated over.
struct ElementPoints<'a> {
    /// Points of the energy: of all of it, or of bending.
    whole: Points<'a, PointBatch, 5>,
    /// Points of stretching, where it has its own.
    stretching: Option<Points<'a, StretchingBatch, 2>>,
    /// Number of basis functions, without the padding.
    used: usize,
    padded: usize,
}

/// Quadrature points of an element, and the first `ROWS` derivatives of its functions there.
struct Points<'a, Batch, const ROWS: usize> {
    /// Derivatives of the functions, ordered as in [`PointTable::functions`].
    functions: &'a [f64],
    batches: &'a [Batch],
}

impl<'a, Batch, const ROWS: usize> Points<'a, Batch, ROWS> {
    fn of(table: &'a PointTable<Batch, ROWS>, element: usize) -> Self {
        Self { functions: table.element_functions(element), batches: table.element_batches(element) }
    }
}

impl<'a> ElementPoints<'a> {
    fn of(tables: &'a Tables, element: usize) -> Self {
        Self {
            whole: Points::of(&tables.points, element),
            stretching: tables.stretching.as_ref().map(|table| Points::of(table, element)),
            used: tables.functions_per_element,
            padded: tables.padded,
        }
    }
}

/// Integrates an element, with lanes `V` for points and `W` for basis functions.
#[inline(always)]
fn integrate<V: FourLanes, W: Lanes>(
    points_proof: V::Proof,
    rows_proof: W::Proof,
    points: &ElementPoints,
    want: Want,
    buffers: &mut ElementBuffers,
) {
    let ElementBuffers { displacement, residual, stiffness, free, energy, half, whole, stretching } = buffers;
    let free = free.as_ref();
    let ElementPoints { used, padded, .. } = *points;
    let mut sums = Sums { used, padded, want, free, displacement, residual, stiffness, half, begun: false };
    let mut sum = sums.add::<V, W, _, 5, 15>(points_proof, rows_proof, &points.whole, whole);
    if let Some(points) = &points.stretching {
        sum = sum + sums.add::<V, W, _, 2, 6>(points_proof, rows_proof, points, stretching);
    }
    let mut energies = [0.0; BATCH];
    sum.store(&mut energies);
    *energy = (energies[0] + energies[1]) + (energies[2] + energies[3]);
}

/// Sums of an element while they are formed.
struct Sums<'a> {
    used: usize,
    padded: usize,
    want: Want,
    free: Option<&'a FreeStrain>,
    displacement: &'a [f64],
    residual: &'a mut [f64],
    stiffness: &'a mut [f64],
    half: &'a mut [f64],
    /// Whether residual and stiffness hold sums, and not what an element before left in them.
    begun: bool,
}

impl Sums<'_> {
    /// Adds points; returns their energies, in four lanes.
    #[inline(always)]
    fn add<V: FourLanes, W: Lanes, B: PointKernel<ROWS, SIZE>, const ROWS: usize, const SIZE: usize>(
        &mut self,
        points_proof: V::Proof,
        rows_proof: W::Proof,
        points: &Points<B, ROWS>,
        derivatives: &mut Derivatives<ROWS, SIZE>,
    ) -> V {
        let Derivatives { gradients, hessians } = derivatives;
        let (used, padded) = (self.used, self.padded);
        let mut sum = V::splat(points_proof, 0.0);
        let blocks = points.batches.chunks(BLOCK).zip(points.functions.chunks(BLOCK * BATCH * ROWS * padded));
        for (batches, functions) in blocks {
            let of_batch = functions.chunks(BATCH * ROWS * padded);
            for (i, (points, functions)) in batches.iter().zip(of_batch).enumerate() {
                let u = displacement_derivatives::<V, ROWS>(points_proof, functions, padded, used, self.displacement);
                let energies = match self.want {
                    Want::Energy => points.energy(points_proof, &u, self.free),
                    Want::Residual => points.gradient(points_proof, &u, self.free, &mut gradients[i]),
                    Want::Stiffness => points.hessian(points_proof, &u, self.free, &mut gradients[i], &mut hessians[i]),
                };
                sum = sum + energies;
            }
            if self.want == Want::Energy {
                continue;
            }
            let block = Block::<W, ROWS> { proof: rows_proof, functions, used, padded, first: !self.begun };
            self.begun = true;
            add_residual(&block, gradients, self.residual);
            if self.want == Want::Stiffness {
                contract(&block, hessians, W::chunks_mut(self.half).as_chunks_mut::<SIZE>().0, self.stiffness);
            }
        }
        sum
    }
}

/// The first `ROWS` of u,₁ u,₂ u,₁₁ u,₂₂ u,₁₂ at the points of a batch; zero where a batch has fewer than four.
#[inline(always)]
fn displacement_derivatives<V: FourLanes, const ROWS: usize>(
    proof: V::Proof,
    functions: &[f64],
    padded: usize,
    used: usize,
    displacement: &[f64],
) -> [[V; 3]; ROWS] {
    match functions.len() / (ROWS * padded) {
        1 => derivatives_of::<V, ROWS, 1>(proof, functions, padded, used, displacement),
        2 => derivatives_of::<V, ROWS, 2>(proof, functions, padded, used, displacement),
        3 => derivatives_of::<V, ROWS, 3>(proof, functions, padded, used, displacement),
        _ => derivatives_of::<V, ROWS, 4>(proof, functions, padded, used, displacement),
    }
}

#[inline(always)]
fn derivatives_of<V: FourLanes, const ROWS: usize, const COUNT: usize>(
    proof: V::Proof,
    functions: &[f64],
    padded: usize,
    used: usize,
    displacement: &[f64],
) -> [[V; 3]; ROWS] {
    let zero = V::splat(proof, 0.0);
    let vectors = used.div_ceil(V::WIDTH);
    let mut u = [[zero; 3]; ROWS];
    let x = &V::chunks(displacement)[..vectors];
    let y = &V::chunks(&displacement[padded..])[..vectors];
    let z = &V::chunks(&displacement[2 * padded..])[..vectors];
    for k in 0..ROWS {
        let mut rows = [V::chunks(&[]); COUNT];
        for (q, row) in rows.iter_mut().enumerate() {
            *row = &V::chunks(&functions[(q * ROWS + k) * padded..])[..vectors];
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
