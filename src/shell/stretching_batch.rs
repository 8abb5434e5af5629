//! Energy of stretching alone, of four points at once, with gradient and Hessian with respect to a₁ and a₂: the membrane part
//! of [`super::PointBatch`], for the points that only stretching has.
//!
//! With f the membrane forces and C their stiffness: ∂w/∂a_α = f^{αβ} a_β and H_αβ = f^{αβ} I + Σ C^{αγβδ} a_γ a_δᵀ.

use super::batch::{Four, PointKernel, covariant, lanes_of, load3, put, splat3, stiffness_of, store3, stretch};
use super::free_strain::FreeStrain;
use super::lane_vector::{accumulate, add, cross, dot, outer, scaled, sub};
use super::lanes::FourLanes;
use super::point::PointReference;

/// The undeformed shell at four quadrature points; where there are fewer, the last is repeated without stiffness.
#[derive(Clone, Debug)]
pub struct StretchingBatch {
    tangents: [[Four; 3]; 2],
    membrane: [[Four; 3]; 3],
}

impl StretchingBatch {
    /// Packs one to four points into a batch.
    pub fn new(points: &[PointReference]) -> Self {
        Self {
            tangents: std::array::from_fn(|k| {
                std::array::from_fn(|c| lanes_of(points, |point| point.derivatives[k][c]))
            }),
            membrane: std::array::from_fn(|i| {
                std::array::from_fn(|j| stiffness_of(points, |point| point.membrane[i][j]))
            }),
        }
    }

    #[inline(always)]
    fn deform<V: FourLanes>(&self, proof: V::Proof, u: &[[V; 3]; 2], free: Option<&FreeStrain>) -> Stretched<V> {
        let reference = [load3(proof, &self.tangents[0]), load3(proof, &self.tangents[1])];
        let half = V::splat(proof, 0.5);
        let mut strains =
            [half * stretch(&reference, u, 0, 0), half * stretch(&reference, u, 1, 1), stretch(&reference, u, 0, 1)];
        if let Some(free) = free {
            let [a1, a2] = reference;
            let (l, normal) = (dot(a1, a1).sqrt(), cross(a1, a2));
            let frame = [l, dot(a1, a2) / l, dot(normal, normal).sqrt() / l];
            strains = sub(strains, covariant(frame, V::splat(proof, 2.0), splat3(proof, free.membrane)));
        }
        let mut forces = strains;
        for i in 0..3 {
            forces[i] = dot(load3(proof, &self.membrane[i]), strains);
        }
        let tangents = [add(reference[0], u[0]), add(reference[1], u[1])];
        Stretched { tangents, forces, energy: half * dot(forces, strains) }
    }
}

/// The deformed points.
struct Stretched<V> {
    /// Tangents a₁, a₂ of the deformed surface.
    tangents: [[V; 3]; 2],
    /// Derivatives of the energy by ε₁₁, ε₂₂, 2ε₁₂.
    forces: [V; 3],
    energy: V,
}

impl<V: FourLanes> Stretched<V> {
    #[inline(always)]
    fn store_gradient(&self, gradient: &mut [[Four; 3]; 2]) {
        let ([a1, a2], [f11, f22, f12]) = (self.tangents, self.forces);
        store3(add(scaled(f11, a1), scaled(f12, a2)), &mut gradient[0]);
        store3(add(scaled(f22, a2), scaled(f12, a1)), &mut gradient[1]);
    }
}

impl PointKernel<2, 6> for StretchingBatch {
    #[inline(always)]
    fn energy<V: FourLanes>(&self, proof: V::Proof, u: &[[V; 3]; 2], free: Option<&FreeStrain>) -> V {
        self.deform(proof, u, free).energy
    }

    #[inline(always)]
    fn gradient<V: FourLanes>(
        &self,
        proof: V::Proof,
        u: &[[V; 3]; 2],
        free: Option<&FreeStrain>,
        gradient: &mut [[Four; 3]; 2],
    ) -> V {
        let stretched = self.deform(proof, u, free);
        stretched.store_gradient(gradient);
        stretched.energy
    }

    #[inline(always)]
    fn hessian<V: FourLanes>(
        &self,
        proof: V::Proof,
        u: &[[V; 3]; 2],
        free: Option<&FreeStrain>,
        gradient: &mut [[Four; 3]; 2],
        hessian: &mut [[Four; 6]; 6],
    ) -> V {
        let stretched = self.deform(proof, u, free);
        stretched.store_gradient(gradient);
        let ([a1, a2], [f11, f22, f12]) = (stretched.tangents, stretched.forces);
        let c = [load3(proof, &self.membrane[0]), load3(proof, &self.membrane[1]), load3(proof, &self.membrane[2])];
        let blocks = [
            (0, 0, add(scaled(c[0][0], a1), scaled(c[0][2], a2)), add(scaled(c[0][2], a1), scaled(c[2][2], a2)), f11),
            (0, 1, add(scaled(c[0][1], a2), scaled(c[0][2], a1)), add(scaled(c[1][2], a2), scaled(c[2][2], a1)), f12),
            (1, 1, add(scaled(c[1][2], a2), scaled(c[2][2], a1)), add(scaled(c[1][1], a2), scaled(c[1][2], a1)), f22),
        ];
        for (alpha, beta, with_a1, with_a2, force) in blocks {
            let mut block = outer(a1, with_a1);
            accumulate(&mut block, a2, with_a2);
            for e in 0..3 {
                block[e][e] = block[e][e] + force;
            }
            put(hessian, alpha, beta, &block);
        }
        stretched.energy
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shell::Hessian;
    use crate::shell::lanes::{Lanes, Portable};
    use crate::shell::point::tests::{free_strain, sample};

    /// Three points against the slow way, whose bending is taken away, with and without free strain.
    #[test]
    fn a_batch_is_the_stretching_of_its_points() {
        check(None);
        check(Some(&free_strain()));
    }

    fn check(free: Option<&FreeStrain>) {
        let (whole, u) = sample();
        let point = whole.stretching_alone();
        let batch = StretchingBatch::new(&[point; 3]);
        let mut hessian: Hessian = [[0.0; 16]; 15];
        let (energy, gradient) = free.map_or(point, |free| point.under(free)).hessian(&u, &mut hessian);
        let lanes = [0, 1].map(|k| u[k].map(|value| Portable::splat((), value)));
        let (mut found_gradient, mut found) = ([[[0.0; 4]; 3]; 2], [[[0.0; 4]; 6]; 6]);
        let mut energies = [0.0; 4];
        batch.hessian((), &lanes, free, &mut found_gradient, &mut found).store(&mut energies);
        for lane in 0..3 {
            assert!((energies[lane] / energy - 1.0).abs() < 1e-13);
            for i in 0..6 {
                assert!((found_gradient[i / 3][i % 3][lane] - gradient[i / 3][i % 3]).abs() < 1e-12 * energy);
                for j in 0..6 {
                    assert!((found[i][j][lane] - hessian[i][j]).abs() < 1e-12 * energy, "{i} {j}");
                }
            }
        }
        assert_eq!(energies[3], 0.0);
    }
}
