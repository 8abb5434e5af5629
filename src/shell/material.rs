//! The constitutive law of the shell: from a material to the energy per area as a quadratic form of the strains.

use crate::scene::{Material, OrthotropicLaw, Ply};
use crate::shell::{cross, dot};

/// Stiffness of a unit of reference area in the local parameter basis, order (11, 22, 12) with engineering shear
/// (2ε₁₂, 2κ₁₂): w = ½ ε·membrane·ε + ½ κ·bending·κ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShellStiffness {
    /// Membrane stiffness, N/mm times parameter units.
    pub membrane: [[f64; 3]; 3],
    /// Bending stiffness, N·mm times parameter units.
    pub bending: [[f64; 3]; 3],
    /// Stiffness that couples both, by the energy ε·coupling·κ, N times parameter units; `None` where the layers are
    /// symmetric.
    pub coupling: Option<[[f64; 3]; 3]>,
}

/// Computes the stiffness of a material at a point with reference tangents A₁, A₂.
pub fn shell_stiffness(material: &Material, tangents: [[f64; 3]; 2]) -> ShellStiffness {
    match material {
        Material::Isotropic { youngs_modulus_mpa, poissons_ratio, thickness_mm, offset_mm, .. } => {
            isotropic(*youngs_modulus_mpa, *poissons_ratio, *thickness_mm, tangents).seen_from(*offset_mm)
        }
        Material::Orthotropic { law, angle_deg, thickness_mm, offset_mm, .. } => {
            let ply = Ply { thickness_mm: *thickness_mm, angle_deg: *angle_deg, law: *law, density_kg_m3: None };
            layered(&[ply], *offset_mm, tangents)
        }
        Material::Laminate { plies, offset_mm } => layered(plies, *offset_mm, tangents),
    }
}

impl ShellStiffness {
    /// Refers the stiffness of a shell without coupling to a surface at an offset from the one that it was formed for, at
    /// which the strain is ε − offset κ.
    fn seen_from(self, offset: f64) -> Self {
        if offset == 0.0 {
            return self;
        }
        let [mut coupling, mut bending] = [self.membrane, self.bending];
        for i in 0..3 {
            for j in 0..3 {
                coupling[i][j] *= -offset;
                bending[i][j] += offset * offset * self.membrane[i][j];
            }
        }
        Self { bending, coupling: Some(coupling), ..self }
    }
}

/// Heights of the bottom and the top of each ply along the normal of the surface, which lies `offset` above the middle
/// of them all.
pub(super) fn heights(plies: &[Ply], offset: f64) -> impl Iterator<Item = [f64; 2]> {
    let total: f64 = plies.iter().map(|ply| ply.thickness_mm).sum();
    plies.iter().scan(-0.5 * total - offset, |height, ply| {
        let bottom = *height;
        *height += ply.thickness_mm;
        Some([bottom, *height])
    })
}

/// A = Σ Q h, B = Σ Q (z₁² − z₀²)/2 and D = Σ Q (z₁³ − z₀³)/3 over plies from z₀ to z₁ (classical lamination theory;
/// Reddy, *Mechanics of Laminated Composite Plates and Shells*, 2nd ed., section 3.3). At height z along the normal the
/// strain is ε + z κ: with x + z n, half the change of the metric is ε − z (b − B) to first order in z, and κ = B − b.
fn layered(plies: &[Ply], offset: f64, tangents: [[f64; 3]; 2]) -> ShellStiffness {
    let total: f64 = plies.iter().map(|ply| ply.thickness_mm).sum();
    let [mut membrane, mut coupling, mut bending] = [[[0.0; 3]; 3]; 3];
    let mut largest = 0.0_f64;
    for (ply, [bottom, top]) in plies.iter().zip(heights(plies, offset)) {
        let stiffness = ply_stiffness(ply);
        let first = 0.5 * (top * top - bottom * bottom);
        let second = (top.powi(3) - bottom.powi(3)) / 3.0;
        for i in 0..3 {
            for j in 0..3 {
                membrane[i][j] += stiffness[i][j] * ply.thickness_mm;
                coupling[i][j] += stiffness[i][j] * first;
                bending[i][j] += stiffness[i][j] * second;
            }
        }
        largest = largest.max(stiffness[0][0].max(stiffness[1][1]));
    }
    let map = cartesian_strains(tangents);
    // The couplings of symmetric layers cancel, up to rounding.
    let coupled = coupling.iter().flatten().any(|value| value.abs() > 1e-12 * largest * total * total);
    ShellStiffness {
        membrane: turned(&membrane, &map),
        bending: turned(&bending, &map),
        coupling: coupled.then(|| turned(&coupling, &map)),
    }
}

/// Plane-stress stiffness of a ply in axes (e₁ along A₁, e₂ = n × e₁), order (11, 22, 12) with engineering shear (Reddy,
/// eq. 2.4.8 and 2.3.17).
pub(super) fn ply_stiffness(ply: &Ply) -> [[f64; 3]; 3] {
    // Strains in the material axes from those in the surface's axes.
    let (s, c) = ply.angle_deg.to_radians().sin_cos();
    let map = [[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2.0 * c * s, 2.0 * c * s, c * c - s * s]];
    turned(&plane_stress_stiffness(&ply.law), &map)
}

/// The same in the axes of the material.
pub(super) fn plane_stress_stiffness(law: &OrthotropicLaw) -> [[f64; 3]; 3] {
    let OrthotropicLaw {
        youngs_modulus_1_mpa: e1,
        youngs_modulus_2_mpa: e2,
        poissons_ratio_12: nu,
        shear_modulus_12_mpa: g,
        ..
    } = *law;
    let scale = 1.0 / (1.0 - nu * nu * e2 / e1);
    [[scale * e1, scale * nu * e2, 0.0], [scale * nu * e2, scale * e2, 0.0], [0.0, 0.0, g]]
}

/// (ε₁₁, ε₂₂, 2ε₁₂) in the axes e₁, e₂ from the covariant components, with ε_ij = ε_αβ (A^α·e_i)(A^β·e_j).
pub(super) fn cartesian_strains(tangents: [[f64; 3]; 2]) -> [[f64; 3]; 3] {
    let [a1, a2] = tangents;
    let normal = cross(a1, a2);
    let unit = |x: [f64; 3]| {
        let length = dot(x, x).sqrt();
        x.map(|value| value / length)
    };
    let (e1, metric) = (unit(a1), inverse_metric(tangents));
    let e2 = cross(unit(normal), e1);
    let dual = [0, 1].map(|alpha| [0, 1, 2].map(|c| metric[alpha][0] * a1[c] + metric[alpha][1] * a2[c]));
    let [p, q] = [e1, e2].map(|axis| dual.map(|vector| dot(vector, axis)));
    [
        [p[0] * p[0], p[1] * p[1], p[0] * p[1]],
        [q[0] * q[0], q[1] * q[1], q[0] * q[1]],
        [2.0 * p[0] * q[0], 2.0 * p[1] * q[1], p[0] * q[1] + p[1] * q[0]],
    ]
}

/// Computes mapᵀ · stiffness · map.
fn turned(stiffness: &[[f64; 3]; 3], map: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|i| {
        [0, 1, 2].map(|j| (0..3).map(|k| (0..3).map(|l| map[k][i] * stiffness[k][l] * map[l][j]).sum::<f64>()).sum())
    })
}

/// St. Venant–Kirchhoff in plane stress: C^αβγδ = E/(1−ν²) [ν A^αβ A^γδ + ½(1−ν)(A^αγ A^βδ + A^αδ A^βγ)], with t C for
/// the membrane and t³/12 C for bending (Kiendl 2011, section 3.3).
fn isotropic(
    youngs_modulus_mpa: f64,
    poissons_ratio: f64,
    thickness_mm: f64,
    tangents: [[f64; 3]; 2],
) -> ShellStiffness {
    let metric = inverse_metric(tangents);
    let pairs = [[0, 0], [1, 1], [0, 1]];
    let modulus = youngs_modulus_mpa / (1.0 - poissons_ratio * poissons_ratio);
    let tensor = pairs.map(|[a, b]| {
        pairs.map(|[c, d]| {
            modulus
                * (poissons_ratio * metric[a][b] * metric[c][d]
                    + 0.5 * (1.0 - poissons_ratio) * (metric[a][c] * metric[b][d] + metric[a][d] * metric[b][c]))
        })
    });
    let times = |factor: f64| tensor.map(|row| row.map(|value| factor * value));
    ShellStiffness { membrane: times(thickness_mm), bending: times(thickness_mm.powi(3) / 12.0), coupling: None }
}

/// Contravariant metric A^αβ.
fn inverse_metric(tangents: [[f64; 3]; 2]) -> [[f64; 2]; 2] {
    let [a1, a2] = tangents;
    let normal = cross(a1, a2);
    let determinant = dot(normal, normal);
    let mixed = -dot(a1, a2) / determinant;
    [[dot(a2, a2) / determinant, mixed], [mixed, dot(a1, a1) / determinant]]
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: OrthotropicLaw = OrthotropicLaw {
        youngs_modulus_1_mpa: 140e3,
        youngs_modulus_2_mpa: 10e3,
        poissons_ratio_12: 0.3,
        shear_modulus_12_mpa: 5e3,
        thermal_expansion_1_per_k: None,
        thermal_expansion_2_per_k: None,
        strengths: None,
    };
    const TANGENTS: [[f64; 3]; 2] = [[2.0, 0.1, 0.3], [-0.4, 1.5, 0.2]];

    fn close(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) {
        let scale = b.iter().flatten().fold(0.0_f64, |most, value| most.max(value.abs()));
        for (x, y) in a.iter().flatten().zip(b.iter().flatten()) {
            assert!((x - y).abs() < 1e-12 * scale, "{x} {y}");
        }
    }

    #[test]
    fn equal_moduli_are_isotropic_in_any_number_of_layers_and_at_any_angle() {
        let (e, nu, t) = (70e3, 0.3, 0.4);
        let law = OrthotropicLaw {
            youngs_modulus_1_mpa: e,
            youngs_modulus_2_mpa: e,
            poissons_ratio_12: nu,
            shear_modulus_12_mpa: e / (2.0 * (1.0 + nu)),
            ..LAW
        };
        let expected = isotropic(e, nu, t, TANGENTS);
        let ply = |angle_deg: f64| Ply { thickness_mm: t / 4.0, angle_deg, law, density_kg_m3: None };
        let found = layered(&[ply(0.0), ply(30.0), ply(-70.0), ply(90.0)], 0.0, TANGENTS);
        close(found.membrane, expected.membrane);
        close(found.bending, expected.bending);
        assert_eq!(found.coupling, None);
    }

    /// [0/90] by hand: B₁₁ = (E₂ − E₁) t² / 8(1 − ν₁₂ν₂₁) with the 0° ply at the bottom.
    #[test]
    fn a_cross_ply_strip_couples_as_by_hand() {
        let ply = |angle_deg: f64| Ply { thickness_mm: 0.1, angle_deg, law: LAW, density_kg_m3: None };
        let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let found = layered(&[ply(0.0), ply(90.0)], 0.0, unit);
        let scale = 1.0 / (1.0 - 0.3 * 0.3 * 10.0 / 140.0);
        let coupling = found.coupling.unwrap();
        assert!((coupling[0][0] / (scale * (10e3 - 140e3) * 0.04 / 8.0) - 1.0).abs() < 1e-12);
        assert!((coupling[0][0] + coupling[1][1]).abs() < 1e-9 && coupling[0][1].abs() < 1e-9);
        assert!((found.membrane[0][0] / (scale * 150e3 * 0.1) - 1.0).abs() < 1e-12);
        assert!((found.bending[2][2] / (5e3 * 0.008 / 12.0) - 1.0).abs() < 1e-12);
        assert_eq!(layered(&[ply(0.0), ply(90.0), ply(90.0), ply(0.0)], 0.0, unit).coupling, None);
    }

    /// The energy of ε + z κ through the thickness, by Gauss points in each ply.
    #[test]
    fn energy_is_that_of_the_layers() {
        let plies = [
            Ply { thickness_mm: 0.1, angle_deg: 20.0, law: LAW, density_kg_m3: None },
            Ply { thickness_mm: 0.25, angle_deg: -50.0, law: LAW, density_kg_m3: None },
        ];
        let stiffness = layered(&plies, 0.07, TANGENTS);
        let (membrane, bending) = ([1e-3, -2e-3, 5e-4], [4e-3, 1e-3, -2e-3]);
        let form = |m: &[[f64; 3]; 3], a: [f64; 3], b: [f64; 3]| -> f64 { (0..3).map(|i| a[i] * dot(m[i], b)).sum() };
        let found = 0.5 * form(&stiffness.membrane, membrane, membrane)
            + form(&stiffness.coupling.unwrap(), membrane, bending)
            + 0.5 * form(&stiffness.bending, bending, bending);
        let map = cartesian_strains(TANGENTS);
        let (mut exact, mut bottom) = (0.0, -0.175 - 0.07);
        for ply in &plies {
            for [node, weight] in crate::shell::gauss_legendre(3) {
                let z = bottom + 0.5 * ply.thickness_mm * (1.0 + node);
                let strain = [0, 1, 2].map(|i| membrane[i] + z * bending[i]);
                let strain = map.map(|row| dot(row, strain));
                exact += 0.25 * ply.thickness_mm * weight * form(&ply_stiffness(ply), strain, strain);
            }
            bottom += ply.thickness_mm;
        }
        assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
    }

    /// The same shell seen from two surfaces: ε at the middle is ε − offset κ at the surface.
    #[test]
    fn an_offset_surface_sees_the_same_energy() {
        let (e, nu, t, offset) = (70e3, 0.3, 0.4, 0.13);
        let found = isotropic(e, nu, t, TANGENTS).seen_from(offset);
        let law = OrthotropicLaw {
            youngs_modulus_1_mpa: e,
            youngs_modulus_2_mpa: e,
            poissons_ratio_12: nu,
            shear_modulus_12_mpa: e / (2.0 * (1.0 + nu)),
            ..LAW
        };
        let layer = layered(&[Ply { thickness_mm: t, angle_deg: 20.0, law, density_kg_m3: None }], offset, TANGENTS);
        close(found.membrane, layer.membrane);
        close(found.bending, layer.bending);
        close(found.coupling.unwrap(), layer.coupling.unwrap());
    }
}
