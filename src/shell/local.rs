//! Strains and stress resultants at a point of the shell in its own axes: e₁ along A₁, e₂ = n × e₁ in the undeformed surface.

use crate::scene::Material;
use crate::shell::material::{cartesian_strains, shell_stiffness};
use crate::shell::{FreeStrain, PointReference, dot, sub};

/// What a point of the shell is under, in its own axes, order (11, 22, 12).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalPoint {
    /// Membrane strains ε₁₁, ε₂₂, 2ε₁₂ from the undeformed shell.
    pub membrane: [f64; 3],
    /// Bending strains κ₁₁, κ₂₂, 2κ₁₂ from the undeformed shell, 1/mm.
    pub bending: [f64; 3],
    /// The part of the membrane strains from which the resultants come: without free strains.
    pub elastic_membrane: [f64; 3],
    /// The same of the bending strains, 1/mm.
    pub elastic_bending: [f64; 3],
    /// Membrane forces n₁₁, n₂₂, n₁₂, N/mm.
    pub forces: [f64; 3],
    /// Bending moments m₁₁, m₂₂, m₁₂, N·mm/mm.
    pub moments: [f64; 3],
    /// Strain energy per area, N·mm/mm²; what layers lock in each other is left out.
    pub energy: f64,
}

/// Computes the state of a point from the derivatives A₁, A₂, A₁₁, A₂₂, A₁₂ of the undeformed surface and those of the
/// displacement. Resultants are the second Piola–Kirchhoff ones of the undeformed surface (Kiendl 2011, section 3.3).
pub fn local_point(
    material: &Material,
    undeformed: [[f64; 3]; 5],
    displacement: &[[f64; 3]; 5],
    free: Option<&FreeStrain>,
) -> LocalPoint {
    let point = PointReference::new(undeformed, material, 1.0);
    let point = free.map_or(point, |free| point.under(free));
    let map = cartesian_strains([undeformed[0], undeformed[1]]);
    let local = |covariant: [f64; 3]| map.map(|row| dot(row, covariant));
    let strains = point.strains(displacement);
    let elastic = [sub(strains.membrane, point.free.membrane), sub(strains.bending, point.free.bending)].map(local);
    let stiffness = shell_stiffness(material, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let coupling = stiffness.coupling.unwrap_or_default();
    let [membrane, bending] = elastic;
    let sum = |rows: &[[f64; 3]; 3], x: [f64; 3], others: &[[f64; 3]; 3], y: [f64; 3]| {
        [0, 1, 2].map(|i| dot(rows[i], x) + dot(others[i], y))
    };
    // The coupling is symmetric in these axes.
    let forces = sum(&stiffness.membrane, membrane, &coupling, bending);
    let moments = sum(&stiffness.bending, bending, &coupling, membrane);
    LocalPoint {
        membrane: local(strains.membrane),
        bending: local(strains.bending),
        elastic_membrane: membrane,
        elastic_bending: bending,
        forces,
        moments,
        energy: 0.5 * (dot(forces, membrane) + dot(moments, bending)),
    }
}

impl LocalPoint {
    /// Strains ε₁₁, ε₂₂, 2ε₁₂ at a height above the surface of the geometry along its normal, mm, in axes turned by an angle
    /// from e₁ towards e₂, degrees.
    pub fn strains_at(&self, height: f64, angle_deg: f64) -> [f64; 3] {
        turned_strains(at_height(self.membrane, self.bending, height), angle_deg)
    }

    /// The same of the elastic strains, as far as layers lock none in each other.
    pub fn elastic_strains_at(&self, height: f64, angle_deg: f64) -> [f64; 3] {
        turned_strains(at_height(self.elastic_membrane, self.elastic_bending, height), angle_deg)
    }
}

/// ε + z κ.
pub(super) fn at_height(membrane: [f64; 3], bending: [f64; 3], height: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| membrane[i] + height * bending[i])
}

/// Strains ε₁₁, ε₂₂, 2ε₁₂ in axes turned by an angle from axis 1 towards axis 2, degrees.
pub(super) fn turned_strains([xx, yy, shear]: [f64; 3], angle_deg: f64) -> [f64; 3] {
    let (s, c) = angle_deg.to_radians().sin_cos();
    [
        c * c * xx + s * s * yy + c * s * shear,
        s * s * xx + c * c * yy - c * s * shear,
        2.0 * c * s * (yy - xx) + (c * c - s * s) * shear,
    ]
}

/// Principal values of a symmetric tensor (11, 22, 12), the larger first.
pub fn principal([xx, yy, xy]: [f64; 3]) -> [f64; 2] {
    let (middle, radius) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
    [middle + radius, middle - radius]
}
