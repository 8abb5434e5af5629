//! What hangs on a rigid section.

use serde::{Deserialize, Serialize};

/// A spring between a rigid section and the ground, free of force while the section is not moved.
///
/// Its energy is ½ Σ k_i u_i² + ½ Σ c_i φ_i², with the displacement u of the section's reference point and the rotation vector φ of
/// the section, |φ| < π.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spring {
    /// What probes and errors call it.
    pub name: String,
    /// Name of the support that is the section.
    pub section: String,
    /// k along x, y, z, N/mm.
    pub translation_n_per_mm: [f64; 3],
    /// c about x, y, z, N·mm per degree.
    pub rotation_n_mm_per_deg: [f64; 3],
}

/// A point mass on a rigid section, which moves with it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointMass {
    /// What errors call it.
    pub name: String,
    /// Name of the support that is the section.
    pub section: String,
    /// The mass, kg.
    pub mass_kg: f64,
    /// Its place while the section is not moved, mm; `None`: the section's reference point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_mm: Option<[f64; 3]>,
}
