//! Strains that the shell takes up without forces where nothing holds it: by a change of temperature, or because its
//! natural curvature is another than that of its geometry.
//!
//! With eigenstrains e(z) in the layers, classical lamination theory (Reddy, *Mechanics of Laminated Composite Plates and
//! Shells*, 2nd ed., section 3.3.3) has the energy per area
//!
//! w = ½ ∫ (ε + z κ − e)·Q (ε + z κ − e) dz = ½ x·S x − x·(N, M) + ½ ∫ e·Q e dz
//!
//! for x = (ε, κ), S made of A, B and D, N = ∫ Q e dz and M = ∫ Q e z dz. It is formed as ½ (x − x̂)·S (x − x̂) + ½ (∫ e·Q
//! e dz − x̂·S x̂) with the free strain x̂ = S⁻¹ (N, M), in which nothing cancels where the shell is free of stress. The
//! last part is the energy that layers of different expansion lock in each other.
//!
//! Over a curved surface a free strain ε̂ changes the curvature as well: equal expansion makes a cylinder of radius R one
//! of (1 + ε̂) R with the same angle. b grows as a length and κ = B − b is −ε̂ B. It is taken here as κ̂ = −½ (ε̂ B + B ε̂) for
//! any ε̂, so that principal sections keep their angles; that layers expand through the thickness by another amount
//! ("spring-in" of angles) is left out.

use crate::scene::{Material, OrthotropicLaw, Ply};
use crate::shell::material::{heights, ply_stiffness, shell_stiffness};

/// Strains in axes e₁ along A₁ and e₂ = n × e₁ in which the shell is free of forces and moments.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FreeStrain {
    /// ε₁₁, ε₂₂, 2ε₁₂.
    pub membrane: [f64; 3],
    /// κ₁₁, κ₂₂, 2κ₁₂ in addition to what follows from `membrane` on a curved surface, 1/mm.
    pub bending: [f64; 3],
}

/// Computes the free strain per kelvin, and the energy that layers of different expansion lock in each other at one kelvin,
/// N·mm per mm², which grows with the square of the temperature. Returns `None` where the material has no expansion.
pub fn thermal_strain(material: &Material) -> Option<(FreeStrain, f64)> {
    let even = |membrane: [f64; 3]| (FreeStrain { membrane, bending: [0.0; 3] }, 0.0);
    match material {
        Material::Isotropic { thermal_expansion_per_k, .. } => {
            thermal_expansion_per_k.map(|expansion| even([expansion, expansion, 0.0]))
        }
        Material::Orthotropic { law, angle_deg, .. } => expansion(law, *angle_deg).map(even),
        Material::Laminate { plies, offset_mm } => of_layers(material, plies, *offset_mm),
    }
}

fn of_layers(material: &Material, plies: &[Ply], offset_mm: f64) -> Option<(FreeStrain, f64)> {
    let mut forces = [0.0; 6];
    let mut energy = 0.0;
    for (ply, [bottom, top]) in plies.iter().zip(heights(plies, offset_mm)) {
        let strain = expansion(&ply.law, ply.angle_deg)?;
        let stress = ply_stiffness(ply).map(|row| product(row, strain));
        let first = 0.5 * (top * top - bottom * bottom);
        for i in 0..3 {
            forces[i] += stress[i] * ply.thickness_mm;
            forces[3 + i] += stress[i] * first;
        }
        energy += 0.5 * product(stress, strain) * ply.thickness_mm;
    }
    let stiffness = shell_stiffness(material, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let coupling = stiffness.coupling.unwrap_or_default();
    let mut whole = [[0.0; 6]; 6];
    for i in 0..3 {
        for j in 0..3 {
            whole[i][j] = stiffness.membrane[i][j];
            whole[i][3 + j] = coupling[i][j];
            whole[3 + j][i] = coupling[i][j];
            whole[3 + i][3 + j] = stiffness.bending[i][j];
        }
    }
    let strain = solve(whole, forces);
    let free = 0.5 * strain.iter().zip(&forces).map(|(x, force)| x * force).sum::<f64>();
    let [e1, e2, shear, k1, k2, twist] = strain;
    // Between layers that expand alike only rounding is left.
    let locked = if energy - free > 1e-12 * energy { energy - free } else { 0.0 };
    Some((FreeStrain { membrane: [e1, e2, shear], bending: [k1, k2, twist] }, locked))
}

/// Strains (11, 22, 12 with engineering shear) of a free layer per kelvin in the surface's axes (Reddy, eq. 2.3.23).
fn expansion(law: &OrthotropicLaw, angle_deg: f64) -> Option<[f64; 3]> {
    let [along, across] = law.expansion_per_k()?;
    let (s, c) = angle_deg.to_radians().sin_cos();
    Some([c * c * along + s * s * across, s * s * along + c * c * across, 2.0 * c * s * (along - across)])
}

fn product(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Solves a symmetric positive definite system by elimination.
fn solve(mut matrix: [[f64; 6]; 6], mut right: [f64; 6]) -> [f64; 6] {
    for pivot in 0..6 {
        for row in pivot + 1..6 {
            let factor = matrix[row][pivot] / matrix[pivot][pivot];
            for column in pivot..6 {
                matrix[row][column] -= factor * matrix[pivot][column];
            }
            right[row] -= factor * right[pivot];
        }
    }
    for row in (0..6).rev() {
        let known: f64 = (row + 1..6).map(|column| matrix[row][column] * right[column]).sum();
        right[row] = (right[row] - known) / matrix[row][row];
    }
    right
}
