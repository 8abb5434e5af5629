//! The constitutive law of the shell: from a material to the energy per area as a quadratic form of the strains.

use crate::scene::Material;
use crate::shell::{cross, dot};

/// Stiffness of a unit of reference area in the local parameter basis, order (11, 22, 12) with engineering shear
/// (2ε₁₂, 2κ₁₂): w = ½ ε·membrane·ε + ½ κ·bending·κ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShellStiffness {
    /// N/mm times parameter units.
    pub membrane: [[f64; 3]; 3],
    /// N·mm times parameter units.
    pub bending: [[f64; 3]; 3],
}

/// Stiffness at a point with reference tangents A₁, A₂.
///
/// St. Venant–Kirchhoff in plane stress: C^αβγδ = E/(1−ν²) [ν A^αβ A^γδ + ½(1−ν)(A^αγ A^βδ + A^αδ A^βγ)], with t C for
/// the membrane and t³/12 C for bending (Kiendl 2011, section 3.3).
pub fn shell_stiffness(material: &Material, tangents: [[f64; 3]; 2]) -> ShellStiffness {
    let Material::Isotropic { youngs_modulus_mpa, poissons_ratio, thickness_mm } = *material else { todo!() };
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
    ShellStiffness { membrane: times(thickness_mm), bending: times(thickness_mm.powi(3) / 12.0) }
}

/// Contravariant metric A^αβ.
fn inverse_metric(tangents: [[f64; 3]; 2]) -> [[f64; 2]; 2] {
    let [a1, a2] = tangents;
    let normal = cross(a1, a2);
    let determinant = dot(normal, normal);
    let mixed = -dot(a1, a2) / determinant;
    [[dot(a2, a2) / determinant, mixed], [mixed, dot(a1, a1) / determinant]]
}
