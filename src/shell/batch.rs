//! What all batches of four points share: moving the numbers of four points into vectors and back.

use super::free_strain::FreeStrain;
use super::lane_vector::dot;
use super::lanes::FourLanes;
use super::point::PointReference;

/// One number for each of the four points.
pub(crate) type Four = [f64; 4];

/// Gradients: `[k][c][point]`, k over the vectors that the energy depends on, c over x, y, z.
pub(crate) type BatchGradient<const ROWS: usize> = [[Four; 3]; ROWS];

/// Hessians: `[3 k + c][3 l + d][point]`, symmetric; `SIZE` is 3 `ROWS`.
pub(crate) type BatchHessian<const SIZE: usize> = [[Four; SIZE]; SIZE];

/// Four points whose energy depends on the first `ROWS` of u,₁ u,₂ u,₁₁ u,₂₂ u,₁₂; `SIZE` is 3 `ROWS`.
pub(crate) trait PointKernel<const ROWS: usize, const SIZE: usize> {
    /// Computes the energies for derivatives of the displacement, under a free strain if there is one.
    fn energy<V: FourLanes>(&self, proof: V::Proof, u: &[[V; 3]; ROWS], free: Option<&FreeStrain>) -> V;

    /// Computes the energies and their gradients.
    fn gradient<V: FourLanes>(
        &self,
        proof: V::Proof,
        u: &[[V; 3]; ROWS],
        free: Option<&FreeStrain>,
        gradient: &mut BatchGradient<ROWS>,
    ) -> V;

    /// Computes the energies, gradients and Hessians.
    fn hessian<V: FourLanes>(
        &self,
        proof: V::Proof,
        u: &[[V; 3]; ROWS],
        free: Option<&FreeStrain>,
        gradient: &mut BatchGradient<ROWS>,
        hessian: &mut BatchHessian<SIZE>,
    ) -> V;
}

/// Collects one number of each point; the last point is repeated for those that are missing.
pub(super) fn lanes_of(points: &[PointReference], number: impl Fn(&PointReference) -> f64) -> Four {
    std::array::from_fn(|lane| number(&points[lane.min(points.len() - 1)]))
}

/// Collects one stiffness of each point; it is 0 for those that are missing.
pub(super) fn stiffness_of(points: &[PointReference], number: impl Fn(&PointReference) -> f64) -> Four {
    std::array::from_fn(|lane| points.get(lane).map_or(0.0, &number))
}

/// Converts strains (11, 22, 12 with engineering shear) to those by A₁ = l e₁ and A₂ = m e₁ + n e₂ from those by e₁ and e₂.
#[inline(always)]
pub(super) fn covariant<V: FourLanes>([l, m, n]: [V; 3], two: V, [x, y, z]: [V; 3]) -> [V; 3] {
    [l * l * x, m * m * x + n * n * y + m * n * z, two * l * m * x + l * n * z]
}

/// Computes a_i·a_j − A_i·A_j.
#[inline(always)]
pub(super) fn stretch<V: FourLanes, const ROWS: usize>(
    reference: &[[V; 3]; ROWS],
    u: &[[V; 3]; ROWS],
    i: usize,
    j: usize,
) -> V {
    dot(reference[i], u[j]) + dot(u[i], reference[j]) + dot(u[i], u[j])
}

/// Stores a block and its transpose.
#[inline(always)]
pub(super) fn put<V: FourLanes, const SIZE: usize>(
    hessian: &mut BatchHessian<SIZE>,
    k: usize,
    l: usize,
    block: &[[V; 3]; 3],
) {
    for c in 0..3 {
        for d in 0..3 {
            block[c][d].store(&mut hessian[3 * k + c][3 * l + d]);
            if k != l {
                block[c][d].store(&mut hessian[3 * l + d][3 * k + c]);
            }
        }
    }
}

#[inline(always)]
pub(super) fn load3<V: FourLanes>(proof: V::Proof, from: &[Four; 3]) -> [V; 3] {
    [V::load(proof, &from[0]), V::load(proof, &from[1]), V::load(proof, &from[2])]
}

#[inline(always)]
pub(super) fn splat3<V: FourLanes>(proof: V::Proof, x: [f64; 3]) -> [V; 3] {
    [V::splat(proof, x[0]), V::splat(proof, x[1]), V::splat(proof, x[2])]
}

#[inline(always)]
pub(super) fn store3<V: FourLanes>(x: [V; 3], to: &mut [Four; 3]) {
    for c in 0..3 {
        x[c].store(&mut to[c]);
    }
}
