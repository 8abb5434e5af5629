//! Energy, gradient and Hessian of four points at once: the formulas of [`PointReference`], the slow path that this one is
//! compared with, with the products of the Hessian's blocks written out.
//!
//! With x_αi = ∂b_i/∂a_α (x_1i = a₂ × v_i, x_2i = v_i × a₁, v_i = (a_i − (a_i·n) n)/J, i over 11, 22, 12), D the bending
//! stiffness with its shear rows and columns doubled, z_m = Σ_i D_im v_i, m the moments (the last doubled), M = Σ m a_i,
//! f the membrane forces, C their stiffness, W_α as in [`crate::shell`]'s point, N_α = W_αᵀ n, P = W_αᵀ (M − 3/2 (M·n) n):
//!
//! H_lm = D_lm n nᵀ for second derivatives l, m; H_αm = y_αm nᵀ − m_m T_αᵀ with y_1m = a₂ × z_m, y_2m = z_m × a₁ and
//! T_α = (W_α − n N_αᵀ)/J; H_αβ = Σ_i x_αi y_βiᵀ + (P_α N_βᵀ + N_α P_βᵀ)/J² + (M·n)/J² W_αᵀ W_β + membrane terms, and
//! +[v×] for α ≠ β. W_1ᵀ W_1 = a₂·a₂ I − a₂ a₂ᵀ, W_1ᵀ W_2 = a₁ a₂ᵀ − a₁·a₂ I, W_2ᵀ W_2 = a₁·a₁ I − a₁ a₁ᵀ join the
//! membrane's C and f.

use super::batch::{
    BatchGradient, BatchHessian, Four, PointKernel, covariant, lanes_of, load3, put, splat3, stiffness_of, store3,
    stretch,
};
use super::free_strain::FreeStrain;
use super::lane_vector::{accumulate, add, combination, cross, dot, outer, scaled, sub};
use super::lanes::FourLanes;
use super::point::PointReference;

/// The undeformed shell at four quadrature points; where there are fewer, the last is repeated without stiffness.
#[derive(Clone, Debug)]
pub struct PointBatch {
    derivatives: [[Four; 3]; 5],
    cross: [Four; 3],
    area: Four,
    membrane: [[Four; 3]; 3],
    /// Bending stiffness with the shear row and column doubled: it acts on b₁₁, b₂₂, b₁₂.
    bending: [[Four; 3]; 3],
    /// Coupling stiffness with the shear column doubled; `None` where bending and stretching do not act on each other.
    coupling: Option<Box<[[Four; 3]; 3]>>,
}

impl PointBatch {
    /// Packs one to four points into a batch.
    pub fn new(points: &[PointReference]) -> Self {
        let gather = |number: &dyn Fn(&PointReference) -> f64| lanes_of(points, number);
        let stiffness = |number: &dyn Fn(&PointReference) -> f64| stiffness_of(points, number);
        let doubled = |i: usize| if i == 2 { 2.0 } else { 1.0 };
        let matrix = |number: &dyn Fn(&PointReference, usize, usize) -> f64| -> [[Four; 3]; 3] {
            std::array::from_fn(|i| std::array::from_fn(|j| stiffness(&|point| number(point, i, j))))
        };
        Self {
            derivatives: std::array::from_fn(|k| std::array::from_fn(|c| gather(&|point| point.derivatives[k][c]))),
            cross: std::array::from_fn(|c| gather(&|point| point.cross[c])),
            area: gather(&|point| point.area),
            membrane: matrix(&|point, i, j| point.membrane[i][j]),
            bending: matrix(&|point, i, j| doubled(i) * doubled(j) * point.bending[i][j]),
            coupling: points
                .iter()
                .any(|point| point.coupled)
                .then(|| Box::new(matrix(&|point, i, j| doubled(j) * point.coupling[i][j]))),
        }
    }

    #[inline(always)]
    fn deform<V: FourLanes>(&self, proof: V::Proof, u: &[[V; 3]; 5], free: Option<&FreeStrain>) -> Deformed<V> {
        let zero = V::splat(proof, 0.0);
        let mut reference = [[zero; 3]; 5];
        let mut a = reference;
        for k in 0..5 {
            for c in 0..3 {
                reference[k][c] = V::load(proof, &self.derivatives[k][c]);
                a[k][c] = reference[k][c] + u[k][c];
            }
        }
        let undeformed = load3(proof, &self.cross);
        let area = V::load(proof, &self.area);
        let change = add(add(cross(reference[0], u[1]), cross(u[0], reference[1])), cross(u[0], u[1]));
        let deformed = add(undeformed, change);
        let jacobian = dot(deformed, deformed).sqrt();
        let inverse = V::splat(proof, 1.0) / jacobian;
        let normal = scaled(inverse, deformed);
        // n − N = δw/J + W (1/J − 1/J₀), with J² − J₀² = (2W + δw)·δw.
        let squares = dot(add(add(undeformed, undeformed), change), change);
        let inverse_change = zero - squares / (jacobian * area * (jacobian + area));
        let turn = add(scaled(inverse, change), scaled(inverse_change, undeformed));
        let half = V::splat(proof, 0.5);
        let mut bending = [zero; 3];
        for k in 0..3 {
            bending[k] = zero - (dot(u[2 + k], normal) + dot(reference[2 + k], turn));
        }
        let mut membrane =
            [half * stretch(&reference, u, 0, 0), half * stretch(&reference, u, 1, 1), stretch(&reference, u, 0, 1)];
        if let Some(free) = free {
            let free = self.free_strains(proof, free);
            membrane = sub(membrane, free[0]);
            bending = sub(bending, free[1]);
        }
        Deformed { a, normal, inverse, membrane, bending }
    }

    /// ε₁₁, ε₂₂, 2ε₁₂ and κ₁₁, κ₂₂, κ₁₂ that have no energy, as in [`PointReference::under`].
    #[inline(always)]
    fn free_strains<V: FourLanes>(&self, proof: V::Proof, free: &FreeStrain) -> [[V; 3]; 2] {
        let mut reference = [[V::splat(proof, 0.0); 3]; 5];
        for k in 0..5 {
            reference[k] = load3(proof, &self.derivatives[k]);
        }
        let [a1, a2, a11, a22, a12] = reference;
        let area = V::load(proof, &self.area);
        let unit = scaled(V::splat(proof, 1.0) / area, load3(proof, &self.cross));
        let (half, two) = (V::splat(proof, 0.5), V::splat(proof, 2.0));
        let l = dot(a1, a1).sqrt();
        let (m, n) = (dot(a1, a2) / l, area / l);
        let c11 = dot(a11, unit) / (l * l);
        let c12 = (dot(a12, unit) - l * m * c11) / (l * n);
        let c22 = (dot(a22, unit) - m * m * c11 - two * m * n * c12) / (n * n);
        let membrane = splat3(proof, free.membrane);
        let mut bending = splat3(proof, free.bending);
        let [e11, e22, shear] = membrane;
        let tilt = half * shear;
        bending[0] = bending[0] - (e11 * c11 + tilt * c12);
        bending[1] = bending[1] - (e22 * c22 + tilt * c12);
        bending[2] = bending[2] - ((e11 + e22) * c12 + tilt * (c11 + c22));
        let mut bending = covariant([l, m, n], two, bending);
        bending[2] = half * bending[2];
        [covariant([l, m, n], two, membrane), bending]
    }

    #[inline(always)]
    fn resultants<V: FourLanes>(&self, proof: V::Proof, d: &Deformed<V>) -> Resultants<V> {
        let zero = V::splat(proof, 0.0);
        let mut forces = [zero; 3];
        let mut moments = [zero; 3];
        for i in 0..3 {
            forces[i] = dot(load3(proof, &self.membrane[i]), d.membrane);
            moments[i] = dot(load3(proof, &self.bending[i]), d.bending);
        }
        if let Some(coupling) = &self.coupling {
            for i in 0..3 {
                let row = load3(proof, &coupling[i]);
                forces[i] = forces[i] + dot(row, d.bending);
                for j in 0..3 {
                    moments[j] = moments[j] + row[j] * d.membrane[i];
                }
            }
        }
        let energy = V::splat(proof, 0.5) * (dot(forces, d.membrane) + dot(moments, d.bending));
        let sum = combination(moments, [d.a[2], d.a[3], d.a[4]]);
        Resultants { energy, forces, moments, sum, tilt: d.tangential(sum) }
    }

    #[inline(always)]
    fn hessian_of<V: FourLanes>(
        &self,
        proof: V::Proof,
        d: &Deformed<V>,
        r: &Resultants<V>,
        hessian: &mut BatchHessian<15>,
    ) {
        let zero = V::splat(proof, 0.0);
        let [a1, a2, ..] = d.a;
        let n = d.normal;
        let mut bending = [[zero; 3]; 3];
        let mut v = [[zero; 3]; 3];
        for i in 0..3 {
            bending[i] = load3(proof, &self.bending[i]);
            v[i] = d.tangential(d.a[2 + i]);
        }
        for l in 0..3 {
            for m in l..3 {
                put(hessian, 2 + l, 2 + m, &outer(scaled(bending[l][m], n), n));
            }
        }

        // N_α, and T_α by its columns: T_1 e = ((e × a₂) − n N_1·e)/J, T_2 e = ((a₁ × e) − n N_2·e)/J.
        let lean = [cross(a2, n), cross(n, a1)];
        let back = [zero - a1[0], zero - a1[1], zero - a1[2]];
        let mut turned = [[[zero; 3]; 3]; 2];
        for (alpha, arm) in [a2, back].into_iter().enumerate() {
            for e in 0..3 {
                // e × arm for the unit vector of component e.
                let (next, last) = ((e + 1) % 3, (e + 2) % 3);
                let mut image = [zero; 3];
                image[next] = zero - arm[last];
                image[last] = arm[next];
                turned[alpha][e] = scaled(d.inverse, sub(image, scaled(lean[alpha][e], n)));
            }
        }
        let mut x = [[[zero; 3]; 3]; 2];
        let mut y = x;
        for i in 0..3 {
            let z = combination(bending[i], v);
            x[0][i] = cross(a2, v[i]);
            x[1][i] = cross(v[i], a1);
            y[0][i] = cross(a2, z);
            y[1][i] = cross(z, a1);
            for alpha in 0..2 {
                let mut block = outer(y[alpha][i], n);
                for e in 0..3 {
                    block[e] = sub(block[e], scaled(r.moments[i], turned[alpha][e]));
                }
                put(hessian, alpha, 2 + i, &block);
            }
        }

        let along = dot(r.sum, n);
        let squared = d.inverse * d.inverse;
        let pull = scaled(squared, sub(r.sum, scaled(V::splat(proof, 1.5) * along, n)));
        let pulls = [cross(a2, pull), cross(pull, a1)];
        let curved = along * squared;
        let mut c = [[zero; 3]; 3];
        for i in 0..3 {
            c[i] = load3(proof, &self.membrane[i]);
        }
        let membrane = [
            [add(scaled(c[0][0], a1), scaled(c[0][2], a2)), add(scaled(c[0][2], a1), scaled(c[2][2] - curved, a2))],
            [add(scaled(c[0][1] + curved, a2), scaled(c[0][2], a1)), add(scaled(c[1][2], a2), scaled(c[2][2], a1))],
            [add(scaled(c[1][2], a2), scaled(c[2][2] - curved, a1)), add(scaled(c[1][1], a2), scaled(c[1][2], a1))],
        ];
        let isotropic = [
            r.forces[0] + curved * dot(a2, a2),
            r.forces[2] - curved * dot(a1, a2),
            r.forces[1] + curved * dot(a1, a1),
        ];
        for (pair, [alpha, beta]) in [[0, 0], [0, 1], [1, 1]].into_iter().enumerate() {
            let mut block = outer(a1, membrane[pair][0]);
            accumulate(&mut block, a2, membrane[pair][1]);
            for i in 0..3 {
                accumulate(&mut block, x[alpha][i], y[beta][i]);
            }
            accumulate(&mut block, pulls[alpha], lean[beta]);
            accumulate(&mut block, lean[alpha], pulls[beta]);
            for e in 0..3 {
                block[e][e] = block[e][e] + isotropic[pair];
            }
            if pair == 1 {
                // The term of ∂²w: −v·(x × y) for x = δa₁, y = δa₂.
                for e in 0..3 {
                    let (next, last) = ((e + 1) % 3, (e + 2) % 3);
                    block[e][next] = block[e][next] - r.tilt[last];
                    block[next][e] = block[next][e] + r.tilt[last];
                }
            }
            put(hessian, alpha, beta, &block);
        }
        if let Some(coupling) = &self.coupling {
            add_coupling(proof, d, coupling, &x, hessian);
        }
    }
}

impl PointKernel<5, 15> for PointBatch {
    #[inline(always)]
    fn energy<V: FourLanes>(&self, proof: V::Proof, u: &[[V; 3]; 5], free: Option<&FreeStrain>) -> V {
        let deformed = self.deform(proof, u, free);
        self.resultants(proof, &deformed).energy
    }

    #[inline(always)]
    fn gradient<V: FourLanes>(
        &self,
        proof: V::Proof,
        u: &[[V; 3]; 5],
        free: Option<&FreeStrain>,
        gradient: &mut BatchGradient<5>,
    ) -> V {
        let deformed = self.deform(proof, u, free);
        let resultants = self.resultants(proof, &deformed);
        gradient_of(proof, &deformed, &resultants, gradient);
        resultants.energy
    }

    #[inline(always)]
    fn hessian<V: FourLanes>(
        &self,
        proof: V::Proof,
        u: &[[V; 3]; 5],
        free: Option<&FreeStrain>,
        gradient: &mut BatchGradient<5>,
        hessian: &mut BatchHessian<15>,
    ) -> V {
        let deformed = self.deform(proof, u, free);
        let resultants = self.resultants(proof, &deformed);
        gradient_of(proof, &deformed, &resultants, gradient);
        self.hessian_of(proof, &deformed, &resultants, hessian);
        resultants.energy
    }
}

/// The deformed points.
struct Deformed<V> {
    a: [[V; 3]; 5],
    normal: [V; 3],
    /// 1 / J.
    inverse: V,
    /// ε₁₁, ε₂₂, 2ε₁₂, less those without energy.
    membrane: [V; 3],
    /// κ₁₁, κ₂₂, κ₁₂, less those without energy.
    bending: [V; 3],
}

impl<V: FourLanes> Deformed<V> {
    /// (x − (x·n) n) / J.
    #[inline(always)]
    fn tangential(&self, x: [V; 3]) -> [V; 3] {
        scaled(self.inverse, sub(x, scaled(dot(x, self.normal), self.normal)))
    }
}

/// Energy and its derivatives by the strains, times the areas of the points.
struct Resultants<V> {
    energy: V,
    /// Derivatives of the energy by ε₁₁, ε₂₂, 2ε₁₂.
    forces: [V; 3],
    /// Derivatives of the energy by κ₁₁, κ₂₂, κ₁₂.
    moments: [V; 3],
    /// M = Σ m a_αβ.
    sum: [V; 3],
    /// v = (M − (M·n) n) / J.
    tilt: [V; 3],
}

#[inline(always)]
fn gradient_of<V: FourLanes>(proof: V::Proof, d: &Deformed<V>, r: &Resultants<V>, gradient: &mut BatchGradient<5>) {
    let [a1, a2, ..] = d.a;
    let [f11, f22, f12] = r.forces;
    store3(sub(add(scaled(f11, a1), scaled(f12, a2)), cross(a2, r.tilt)), &mut gradient[0]);
    store3(sub(add(scaled(f22, a2), scaled(f12, a1)), cross(r.tilt, a1)), &mut gradient[1]);
    let zero = V::splat(proof, 0.0);
    for k in 0..3 {
        store3(scaled(zero - r.moments[k], d.normal), &mut gradient[2 + k]);
    }
}

/// Adds Σ ∂ε B ∂κ and its transpose, where ∂κ_j/∂a_α = −x_αj and ∂κ_j/∂a_j = −n.
#[inline(always)]
fn add_coupling<V: FourLanes>(
    proof: V::Proof,
    d: &Deformed<V>,
    coupling: &[[Four; 3]; 3],
    x: &[[[V; 3]; 3]; 2],
    hessian: &mut BatchHessian<15>,
) {
    let zero = V::splat(proof, 0.0);
    let [a1, a2, ..] = d.a;
    // ∂ε_i/∂a_α, negative, since the sign of ∂κ is left out.
    let none = [zero; 3];
    let (back1, back2) = (sub(none, a1), sub(none, a2));
    let strain = [[back1, none, back2], [none, back2, back1]];
    for j in 0..3 {
        let mut column = none;
        for i in 0..3 {
            column[i] = V::load(proof, &coupling[i][j]);
        }
        for alpha in 0..2 {
            let stress = combination(column, strain[alpha]);
            add_both(proof, hessian, alpha, 2 + j, &outer(stress, d.normal));
            for beta in 0..2 {
                add_both(proof, hessian, alpha, beta, &outer(stress, x[beta][j]));
            }
        }
    }
}

/// Adds a block and its transpose.
#[inline(always)]
fn add_both<V: FourLanes>(proof: V::Proof, hessian: &mut BatchHessian<15>, k: usize, l: usize, block: &[[V; 3]; 3]) {
    for c in 0..3 {
        for d in 0..3 {
            for [row, column] in [[3 * k + c, 3 * l + d], [3 * l + d, 3 * k + c]] {
                let number = &mut hessian[row][column];
                (V::load(proof, number) + block[c][d]).store(number);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shell::Hessian;
    use crate::shell::lanes::{Lanes, Portable};
    use crate::shell::point::tests::{free_strain, laminate, sample, sample_of};

    /// Four points, three and one, with and without coupling and free strain, each against the slow way.
    #[test]
    fn a_batch_is_its_points() {
        for (point, u) in [sample(), sample_of(&laminate())] {
            for count in [1, 3, 4] {
                check(&vec![point; count], u, None);
                check(&vec![point; count], u, Some(&free_strain()));
            }
        }
    }

    fn check(points: &[PointReference], u: [[f64; 3]; 5], free: Option<&FreeStrain>) {
        // A displacement of its own for each point.
        let of_lane = |lane: usize| u.map(|row| row.map(|x| x * (1.0 - 0.2 * lane as f64)));
        let lanes = std::array::from_fn(|k| {
            std::array::from_fn(|c| Portable::load((), &std::array::from_fn(|lane| of_lane(lane)[k][c])))
        });
        let batch = PointBatch::new(points);
        let (mut gradient, mut hessian) = ([[[0.0; 4]; 3]; 5], [[[0.0; 4]; 15]; 15]);
        let mut energies = [[0.0; 4]; 3];
        batch.hessian::<Portable>((), &lanes, free, &mut gradient, &mut hessian).store(&mut energies[0]);
        let mut alone = gradient;
        batch.gradient::<Portable>((), &lanes, free, &mut alone).store(&mut energies[1]);
        batch.energy::<Portable>((), &lanes, free).store(&mut energies[2]);
        assert_eq!(alone, gradient);
        assert_eq!([energies[1], energies[2]], [energies[0]; 2]);
        for lane in 0..4 {
            let Some(point) = points.get(lane).map(|point| free.map_or(*point, |free| point.under(free))) else {
                assert_eq!(energies[0][lane], 0.0);
                assert!(hessian.iter().flatten().all(|number| number[lane] == 0.0));
                continue;
            };
            let mut expected: Hessian = [[0.0; 16]; 15];
            let (energy, slope) = point.hessian(&of_lane(lane), &mut expected);
            assert!((energies[0][lane] - energy).abs() < 1e-13 * energy);
            for p in 0..15 {
                assert!((gradient[p / 3][p % 3][lane] - slope[p / 3][p % 3]).abs() < 1e-12 * energy);
                for q in 0..15 {
                    let (found, expected) = (hessian[p][q][lane], expected[p][q]);
                    assert!((found - expected).abs() < 1e-12 * energy, "{p} {q}: {found} {expected}");
                }
            }
        }
    }
}
