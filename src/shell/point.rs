//! Strain energy of a point of the shell, its gradient and Hessian with respect to five vectors.
//!
//! Kirchhoff–Love, St. Venant–Kirchhoff, after Kiendl, *Isogeometric Analysis and Shape Optimal Design of Shell
//! Structures* (TU München, 2011), section 3: the energy depends on the derivatives a₁, a₂, a₁₁, a₂₂, a₁₂ of the
//! deformed mid-surface only. With w = a₁ × a₂, J = |w|, n = w / J:
//!
//! ε_αβ = ½(a_α·a_β − A_α·A_β),  κ_αβ = B_αβ − b_αβ,  b_αβ = a_αβ·n.
//!
//! Strains are formed from the derivatives of the *displacement*, u,α and u,αβ, so that nothing cancels when they are
//! small: ε_αβ = ½(A_α·u,β + u,α·A_β + u,α·u,β) and κ_αβ = −(u,αβ·n + A_αβ·(n − N)) with n − N from w − W.
//!
//! For a constant vector M, f = M·n(a₁, a₂) has, with v = ∂f/∂w = (M − (M·n) n) / J and
//! F = ∂²f/∂w² = −(n Mᵀ + M nᵀ + (M·n)(I − 3 n nᵀ)) / J²:
//! ∂f/∂a₁ = a₂ × v, ∂f/∂a₂ = v × a₁, ∂²f = Wᵢᵀ F Wⱼ (+ the term of ∂²w), W₁ x = x × a₂, W₂ x = a₁ × x.

use crate::scene::Material;
use crate::shell::{FreeStrain, add, cross, dot, norm, scaled, shell_stiffness, sub};

/// Gradient of the energy: `[k][c]`, k over (a₁, a₂, a₁₁, a₂₂, a₁₂), c over x, y, z.
pub type Gradient = [[f64; 3]; 5];

/// Hessian of the energy: `[3 k + c][3 l + d]`, symmetric; a last column of zeros makes rows whole vectors.
pub type Hessian = [[f64; 16]; 15];

/// The undeformed shell at a quadrature point.
#[derive(Clone, Copy, Debug)]
pub struct PointReference {
    /// Derivatives A₁, A₂, A₁₁, A₂₂, A₁₂ of the undeformed surface.
    pub(super) derivatives: [[f64; 3]; 5],
    /// Cross product A₁ × A₂.
    pub(super) cross: [f64; 3],
    /// Area per parameter area, |A₁ × A₂|.
    pub(super) area: f64,
    /// Membrane stiffness times the area of the point.
    pub(super) membrane: [[f64; 3]; 3],
    /// Bending stiffness times the area of the point.
    pub(super) bending: [[f64; 3]; 3],
    /// Coupling stiffness times the area of the point; zero unless `coupled`.
    pub(super) coupling: [[f64; 3]; 3],
    /// Whether the layers are not symmetric, so that membrane and bending strains act on each other.
    pub(super) coupled: bool,
    /// Strains that have no energy.
    pub(super) free: Strains,
}

/// Strains at a point in the parameter basis, order (11, 22, 12), engineering shear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strains {
    /// Membrane strains ε₁₁, ε₂₂, 2ε₁₂.
    pub membrane: [f64; 3],
    /// Changes of curvature κ₁₁, κ₂₂, 2κ₁₂.
    pub bending: [f64; 3],
}

/// The deformed point: what energy, gradient and Hessian share.
struct Deformed {
    a: [[f64; 3]; 5],
    normal: [f64; 3],
    jacobian: f64,
    strains: Strains,
}

impl PointReference {
    /// Creates a point from the derivatives A₁, A₂, A₁₁, A₂₂, A₁₂; `weight` is the quadrature weight in parameter area.
    pub fn new(derivatives: [[f64; 3]; 5], material: &Material, weight: f64) -> Self {
        let stiffness = shell_stiffness(material, [derivatives[0], derivatives[1]]);
        let normal = cross(derivatives[0], derivatives[1]);
        let area = norm(normal);
        let times = |matrix: [[f64; 3]; 3]| matrix.map(|row| row.map(|value| value * weight * area));
        Self {
            derivatives,
            cross: normal,
            area,
            membrane: times(stiffness.membrane),
            bending: times(stiffness.bending),
            coupling: times(stiffness.coupling.unwrap_or_default()),
            coupled: stiffness.coupling.is_some(),
            free: Strains { membrane: [0.0; 3], bending: [0.0; 3] },
        }
    }

    /// Returns the point of a shell that has a free strain; the energy that layers lock in each other is left out.
    pub fn under(self, free: &FreeStrain) -> Self {
        let [a1, a2, ..] = self.derivatives;
        let unit = scaled(1.0 / self.area, self.cross);
        let [b11, b22, b12] = [2, 3, 4].map(|k| dot(self.derivatives[k], unit));
        // A₁ = l e₁ and A₂ = m e₁ + n e₂.
        let l = norm(a1);
        let (m, n) = (dot(a1, a2) / l, self.area / l);
        // The curvature of the surface in e₁, e₂.
        let c11 = b11 / (l * l);
        let c12 = (b12 - l * m * c11) / (l * n);
        let c22 = (b22 - m * m * c11 - 2.0 * m * n * c12) / (n * n);
        let [e11, e22, shear] = free.membrane;
        let half = 0.5 * shear;
        let [k11, k22, twist] = free.bending;
        let bending = [
            k11 - (e11 * c11 + half * c12),
            k22 - (e22 * c22 + half * c12),
            twist - ((e11 + e22) * c12 + half * (c11 + c22)),
        ];
        let covariant =
            |[x, y, z]: [f64; 3]| [l * l * x, m * m * x + n * n * y + m * n * z, 2.0 * l * m * x + l * n * z];
        Self { free: Strains { membrane: covariant(free.membrane), bending: covariant(bending) }, ..self }
    }

    /// Returns the point with the stresses of further strains on it, in the same geometry: its stress-free strains are smaller by them.
    pub(crate) fn stressed(self, strains: &Strains) -> Self {
        let less = |free: [f64; 3], strains: [f64; 3]| [0, 1, 2].map(|i| free[i] - strains[i]);
        let Strains { membrane, bending } = self.free;
        let free = Strains { membrane: less(membrane, strains.membrane), bending: less(bending, strains.bending) };
        Self { free, ..self }
    }

    /// Difference of the strains at two displacements over a step.
    pub(crate) fn strain_rates(&self, after: &[[f64; 3]; 5], before: &[[f64; 3]; 5], step: f64) -> Strains {
        let (after, before) = (self.strains(after), self.strains(before));
        let rate = |after: [f64; 3], before: [f64; 3]| [0, 1, 2].map(|i| (after[i] - before[i]) / step);
        Strains { membrane: rate(after.membrane, before.membrane), bending: rate(after.bending, before.bending) }
    }

    /// Returns the point without its stiffness against stretching.
    pub fn bending_alone(self) -> Self {
        Self { membrane: [[0.0; 3]; 3], ..self }
    }

    /// Returns the point without its stiffness against bending.
    pub fn stretching_alone(self) -> Self {
        Self { bending: [[0.0; 3]; 3], ..self }
    }

    /// Lengths per parameter, |A₁| and |A₂|.
    pub fn tangent_lengths(&self) -> [f64; 2] {
        [norm(self.derivatives[0]), norm(self.derivatives[1])]
    }

    /// Magnitude of the larger principal curvature of the undeformed surface, 1/mm.
    pub fn largest_curvature(&self) -> f64 {
        let [a1, a2, a11, a22, a12] = self.derivatives;
        let unit = scaled(1.0 / self.area, self.cross);
        let [b11, b22, b12] = [a11, a22, a12].map(|second| dot(second, unit));
        let determinant = self.area * self.area;
        let mean = 0.5 * (b11 * dot(a2, a2) - 2.0 * b12 * dot(a1, a2) + b22 * dot(a1, a1)) / determinant;
        let gauss = (b11 * b22 - b12 * b12) / determinant;
        mean.abs() + (mean * mean - gauss).max(0.0).sqrt()
    }

    /// Computes the strains for derivatives u,₁ u,₂ u,₁₁ u,₂₂ u,₁₂ of the displacement.
    pub fn strains(&self, u: &[[f64; 3]; 5]) -> Strains {
        self.deform(u).strains
    }

    /// Computes the strain energy of the point, N·mm.
    pub fn energy(&self, u: &[[f64; 3]; 5]) -> f64 {
        let (energy, _, _) = self.resultants(&self.deform(u).strains);
        energy
    }

    /// Computes the strain energy of the point and its gradient.
    pub fn gradient(&self, u: &[[f64; 3]; 5]) -> (f64, Gradient) {
        let deformed = self.deform(u);
        let (energy, forces, moments) = self.resultants(&deformed.strains);
        (energy, gradient_of(&deformed, forces, moments))
    }

    /// Computes the strain energy of the point and its gradient, and writes the Hessian into `hessian`.
    pub fn hessian(&self, u: &[[f64; 3]; 5], hessian: &mut Hessian) -> (f64, Gradient) {
        let deformed = self.deform(u);
        let (energy, forces, moments) = self.resultants(&deformed.strains);
        material_part(&deformed, self, hessian);
        geometric_part(&deformed, forces, moments, hessian);
        (energy, gradient_of(&deformed, forces, moments))
    }

    fn deform(&self, u: &[[f64; 3]; 5]) -> Deformed {
        let reference = &self.derivatives;
        let a = [0, 1, 2, 3, 4].map(|k| add(reference[k], u[k]));
        let change = add(add(cross(reference[0], u[1]), cross(u[0], reference[1])), cross(u[0], u[1]));
        let deformed_cross = add(self.cross, change);
        let jacobian = norm(deformed_cross);
        let normal = scaled(1.0 / jacobian, deformed_cross);
        // n − N = δw/J + W (1/J − 1/J₀), with J² − J₀² = (2W + δw)·δw.
        let squares = dot(add(scaled(2.0, self.cross), change), change);
        let inverse_change = -squares / (jacobian * self.area * (jacobian + self.area));
        let turn = add(scaled(1.0 / jacobian, change), scaled(inverse_change, self.cross));
        let stretch = |i: usize, j: usize| dot(reference[i], u[j]) + dot(u[i], reference[j]) + dot(u[i], u[j]);
        let bend = |k: usize| -(dot(u[k], normal) + dot(reference[k], turn));
        let strains = Strains {
            membrane: [0.5 * stretch(0, 0), 0.5 * stretch(1, 1), stretch(0, 1)],
            bending: [bend(2), bend(3), 2.0 * bend(4)],
        };
        Deformed { a, normal, jacobian, strains }
    }

    /// Energy, membrane forces and bending moments, all times the point's area.
    fn resultants(&self, strains: &Strains) -> (f64, [f64; 3], [f64; 3]) {
        let membrane = sub(strains.membrane, self.free.membrane);
        let bending = sub(strains.bending, self.free.bending);
        let mut forces = self.membrane.map(|row| dot(row, membrane));
        let mut moments = self.bending.map(|row| dot(row, bending));
        if self.coupled {
            for i in 0..3 {
                for j in 0..3 {
                    forces[i] += self.coupling[i][j] * bending[j];
                    moments[i] += self.coupling[j][i] * membrane[j];
                }
            }
        }
        (0.5 * (dot(forces, membrane) + dot(moments, bending)), forces, moments)
    }
}

/// Moments as they multiply b in Σ m b: (m₁₁, m₂₂, 2 m₁₂).
fn weighted_moments(moments: [f64; 3]) -> [f64; 3] {
    [moments[0], moments[1], 2.0 * moments[2]]
}

/// M = Σ m a_αβ, and v = (M − (M·n) n) / J.
fn moment_vector(d: &Deformed, moments: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    let m = weighted_moments(moments);
    let sum = add(add(scaled(m[0], d.a[2]), scaled(m[1], d.a[3])), scaled(m[2], d.a[4]));
    (sum, tangential(d, sum))
}

/// (x − (x·n) n) / J.
fn tangential(d: &Deformed, x: [f64; 3]) -> [f64; 3] {
    scaled(1.0 / d.jacobian, sub(x, scaled(dot(x, d.normal), d.normal)))
}

fn gradient_of(d: &Deformed, forces: [f64; 3], moments: [f64; 3]) -> Gradient {
    let [a1, a2, ..] = d.a;
    let m = weighted_moments(moments);
    let (_, v) = moment_vector(d, moments);
    [
        sub(add(scaled(forces[0], a1), scaled(forces[2], a2)), cross(a2, v)),
        sub(add(scaled(forces[1], a2), scaled(forces[2], a1)), cross(v, a1)),
        scaled(-m[0], d.normal),
        scaled(-m[1], d.normal),
        scaled(-m[2], d.normal),
    ]
}

/// Σ ∂ε C ∂ε + ∂κ D ∂κ.
fn material_part(d: &Deformed, point: &PointReference, hessian: &mut Hessian) {
    let PointReference { membrane, bending, coupling, coupled, .. } = point;
    let [a1, a2, ..] = d.a;
    let zero = [0.0; 3];
    let strain_rows = [[a1, zero], [zero, a2], [a2, a1]];
    let bend_row = |k: usize, factor: f64| {
        let v = tangential(d, d.a[k]);
        [scaled(-factor, cross(a2, v)), scaled(-factor, cross(v, a1)), scaled(-factor, d.normal)]
    };
    // Row i of ∂κ: with respect to a₁, a₂ and its own a_αβ.
    let bend_rows = [bend_row(2, 1.0), bend_row(3, 1.0), bend_row(4, 2.0)];
    let mut strain_flat = [[0.0; 6]; 3];
    let mut bend_flat = [[0.0; 15]; 3];
    for i in 0..3 {
        for c in 0..3 {
            strain_flat[i][c] = strain_rows[i][0][c];
            strain_flat[i][3 + c] = strain_rows[i][1][c];
            bend_flat[i][c] = bend_rows[i][0][c];
            bend_flat[i][3 + c] = bend_rows[i][1][c];
            bend_flat[i][6 + 3 * i + c] = bend_rows[i][2][c];
        }
    }
    let mut stiff_bend = [[0.0; 15]; 3];
    let mut stiff_strain = [[0.0; 6]; 3];
    for i in 0..3 {
        for j in 0..3 {
            for q in 0..15 {
                stiff_bend[i][q] += bending[i][j] * bend_flat[j][q];
            }
            for q in 0..6 {
                stiff_strain[i][q] += membrane[i][j] * strain_flat[j][q];
            }
        }
    }
    for p in 0..15 {
        for q in 0..15 {
            hessian[p][q] = bend_flat[0][p] * stiff_bend[0][q]
                + bend_flat[1][p] * stiff_bend[1][q]
                + bend_flat[2][p] * stiff_bend[2][q];
        }
    }
    for p in 0..6 {
        for q in 0..6 {
            hessian[p][q] += strain_flat[0][p] * stiff_strain[0][q]
                + strain_flat[1][p] * stiff_strain[1][q]
                + strain_flat[2][p] * stiff_strain[2][q];
        }
    }
    if *coupled {
        for p in 0..6 {
            for q in 0..15 {
                let mut value = 0.0;
                for i in 0..3 {
                    for j in 0..3 {
                        value += strain_flat[i][p] * coupling[i][j] * bend_flat[j][q];
                    }
                }
                hessian[p][q] += value;
                hessian[q][p] += value;
            }
        }
    }
}

/// Σ n ∂²ε + m ∂²κ.
fn geometric_part(d: &Deformed, forces: [f64; 3], moments: [f64; 3], hessian: &mut Hessian) {
    let [a1, a2, ..] = d.a;
    for c in 0..3 {
        hessian[c][c] += forces[0];
        hessian[3 + c][3 + c] += forces[1];
        hessian[c][3 + c] += forces[2];
        hessian[3 + c][c] += forces[2];
    }
    let (moment, v) = moment_vector(d, moments);
    let m = weighted_moments(moments);
    let n = d.normal;
    let inverse = 1.0 / (d.jacobian * d.jacobian);
    let along = dot(moment, n);
    // Column x of W₁, W₂ for the unit vector of component c.
    let columns = [0, 1, 2].map(|c| {
        let mut unit = [0.0; 3];
        unit[c] = 1.0;
        [cross(unit, a2), cross(a1, unit)]
    });
    let apply = |x: [f64; 3]| {
        let tilt = dot(n, x);
        let lean = dot(moment, x);
        scaled(-inverse, add(add(scaled(lean - 3.0 * along * tilt, n), scaled(tilt, moment)), scaled(along, x)))
    };
    for beta in 0..2 {
        for e in 0..3 {
            let image = apply(columns[e][beta]);
            let turned = tangential(d, columns[e][beta]);
            for alpha in 0..2 {
                for c in 0..3 {
                    hessian[3 * alpha + c][3 * beta + e] -= dot(columns[c][alpha], image);
                }
            }
            for i in 0..3 {
                for c in 0..3 {
                    let value = m[i] * turned[c];
                    hessian[6 + 3 * i + c][3 * beta + e] -= value;
                    hessian[3 * beta + e][6 + 3 * i + c] -= value;
                }
            }
        }
    }
    // The term of ∂²w: v·(x × y) for x = δa₁, y = δa₂.
    for (c, e, sign) in [(0, 1, 1.0), (1, 2, 1.0), (2, 0, 1.0), (1, 0, -1.0), (2, 1, -1.0), (0, 2, -1.0)] {
        let value = sign * v[3 - c - e];
        hessian[c][3 + e] -= value;
        hessian[3 + e][c] -= value;
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::shell::thermal_strain;

    pub(in crate::shell) fn sample() -> (PointReference, [[f64; 3]; 5]) {
        sample_of(&Material::Isotropic {
            youngs_modulus_mpa: 100.0,
            poissons_ratio: 0.3,
            thickness_mm: 0.5,
            density_kg_m3: None,
            offset_mm: 0.0,
            thermal_expansion_per_k: None,
        })
    }

    pub(in crate::shell) fn laminate() -> Material {
        let law = |youngs_modulus_1_mpa: f64| crate::scene::OrthotropicLaw {
            youngs_modulus_1_mpa,
            youngs_modulus_2_mpa: 20.0,
            poissons_ratio_12: 0.3,
            shear_modulus_12_mpa: 15.0,
            thermal_expansion_1_per_k: None,
            thermal_expansion_2_per_k: None,
            strengths: None,
        };
        let ply = |angle_deg: f64, modulus: f64| crate::scene::Ply {
            thickness_mm: 0.3,
            angle_deg,
            law: law(modulus),
            density_kg_m3: None,
        };
        Material::Laminate { plies: vec![ply(10.0, 100.0), ply(-60.0, 40.0)], offset_mm: 0.0 }
    }

    pub(in crate::shell) fn free_strain() -> FreeStrain {
        FreeStrain { membrane: [0.1, -0.2, 0.15], bending: [0.3, 0.1, -0.2] }
    }

    pub(in crate::shell) fn sample_of(material: &Material) -> (PointReference, [[f64; 3]; 5]) {
        let reference = [[1.0, 0.1, 0.0], [0.2, 1.3, -0.1], [0.1, 0.0, 0.4], [0.0, 0.2, -0.7], [0.05, -0.1, 0.3]];
        let u = [[0.1, -0.2, 0.3], [-0.15, 0.05, 0.2], [0.3, 0.1, -0.2], [0.2, 0.4, 0.1], [-0.3, 0.2, 0.25]];
        (PointReference::new(reference, material, 0.8), u)
    }

    #[test]
    fn gradient_is_the_derivative_of_the_energy_and_hessian_that_of_the_gradient() {
        for (point, u) in [sample(), sample_of(&laminate())] {
            check_derivatives(&point, u);
            check_derivatives(&point.under(&free_strain()), u);
        }
    }

    fn check_derivatives(point: &PointReference, u: [[f64; 3]; 5]) {
        let mut hessian = [[0.0; 16]; 15];
        let (energy, gradient) = point.hessian(&u, &mut hessian);
        assert_eq!(energy, point.energy(&u));
        let step = 1e-5;
        for p in 0..15 {
            let moved = |sign: f64| {
                let mut other = u;
                other[p / 3][p % 3] += sign * step;
                other
            };
            let (plus, minus) = (moved(1.0), moved(-1.0));
            let slope = (point.energy(&plus) - point.energy(&minus)) / (2.0 * step);
            assert!((slope - gradient[p / 3][p % 3]).abs() < 1e-6 * energy, "gradient {p}: {slope}");
            let (up, down) = (point.gradient(&plus).1, point.gradient(&minus).1);
            for q in 0..15 {
                let slope = (up[q / 3][q % 3] - down[q / 3][q % 3]) / (2.0 * step);
                assert!((slope - hessian[p][q]).abs() < 1e-6 * energy, "Hessian {p} {q}: {slope} {}", hessian[p][q]);
                assert!((hessian[p][q] - hessian[q][p]).abs() < 1e-12 * energy);
            }
        }
    }

    #[test]
    fn strains_agree_with_their_definition() {
        let (point, u) = sample();
        let a = [0, 1, 2, 3, 4].map(|k| add(point.derivatives[k], u[k]));
        let unit = |x: [f64; 3]| scaled(1.0 / norm(x), x);
        let (n, big_n) = (unit(cross(a[0], a[1])), unit(point.cross));
        let strains = point.strains(&u);
        let stretch = |i: usize, j: usize| 0.5 * (dot(a[i], a[j]) - dot(point.derivatives[i], point.derivatives[j]));
        let bend = |k: usize| dot(point.derivatives[k], big_n) - dot(a[k], n);
        let expected = [stretch(0, 0), stretch(1, 1), 2.0 * stretch(0, 1), bend(2), bend(3), 2.0 * bend(4)];
        for (value, exact) in strains.membrane.iter().chain(&strains.bending).zip(expected) {
            assert!((value - exact).abs() < 1e-14, "{value} {exact}");
        }
    }

    /// Strains that are free in the surface's axes are those of a motion that has them.
    #[test]
    fn a_shell_that_grows_evenly_is_free_of_stress() {
        let material = Material::Isotropic {
            youngs_modulus_mpa: 100.0,
            poissons_ratio: 0.3,
            thickness_mm: 0.5,
            offset_mm: 0.2,
            thermal_expansion_per_k: Some(1e-8),
            density_kg_m3: None,
        };
        let (point, _) = sample_of(&material);
        let u = point.derivatives.map(|x| scaled(1e-8, x));
        let (strain, _) = thermal_strain(&material).unwrap();
        let [free, held] = [point.under(&strain), point].map(|point| point.energy(&u));
        assert!(free < 1e-12 * held, "{free} {held}");
    }

    #[test]
    fn a_rigid_turn_gives_no_strain() {
        let (point, _) = sample();
        let (sin, cos) = 2.0_f64.sin_cos();
        let turn = |x: [f64; 3]| [cos * x[0] - sin * x[1], sin * x[0] + cos * x[1], x[2]];
        let u = point.derivatives.map(|x| sub(turn(x), x));
        let strains = point.strains(&u);
        for value in strains.membrane.iter().chain(&strains.bending) {
            assert!(value.abs() < 1e-12, "{value}");
        }
    }
}
