//! Constitutive law and thickness.

use serde::{Deserialize, Serialize};

/// The constitutive law of the shell and its thickness.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Material {
    /// St. Venant–Kirchhoff, isotropic.
    Isotropic {
        /// Young's modulus E.
        youngs_modulus_mpa: f64,
        /// Poisson's ratio ν, in (−1, ½).
        poissons_ratio: f64,
        /// Shell thickness t.
        thickness_mm: f64,
        /// Density ρ, kg/m³; only [`super::ActionKind::Gravity`] asks for it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        density_kg_m3: Option<f64>,
        /// Where the surface of the geometry lies; see [`Material::offset_mm`].
        #[serde(default, skip_serializing_if = "is_zero")]
        offset_mm: f64,
        /// Strain of a free shell per kelvin.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        thermal_expansion_per_k: Option<f64>,
    },
    /// One orthotropic layer.
    Orthotropic {
        /// Moduli in the material axes.
        #[serde(flatten)]
        law: OrthotropicLaw,
        /// Angle of material axis 1 from the u direction of the surface towards v.
        angle_deg: f64,
        /// Shell thickness t.
        thickness_mm: f64,
        /// Density ρ, kg/m³; only [`super::ActionKind::Gravity`] asks for it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        density_kg_m3: Option<f64>,
        /// Where the surface of the geometry lies; see [`Material::offset_mm`].
        #[serde(default, skip_serializing_if = "is_zero")]
        offset_mm: f64,
    },
    /// Plies through the thickness, from the side that the normal points away from (bottom) to the other (top).
    Laminate {
        /// The plies from bottom to top.
        plies: Vec<Ply>,
        /// Where the surface of the geometry lies; see [`Material::offset_mm`].
        #[serde(default, skip_serializing_if = "is_zero")]
        offset_mm: f64,
    },
}

impl Material {
    /// Total thickness of the shell, mm.
    pub fn thickness_mm(&self) -> f64 {
        match self {
            Material::Isotropic { thickness_mm, .. } | Material::Orthotropic { thickness_mm, .. } => *thickness_mm,
            Material::Laminate { plies, .. } => plies.iter().map(|ply| ply.thickness_mm).sum(),
        }
    }

    /// Mass per area of the surface, kg/mm²; `None` where a density is missing.
    pub fn mass_kg_per_mm2(&self) -> Option<f64> {
        let layer = |density_kg_m3: Option<f64>, thickness_mm: f64| Some(density_kg_m3? * CUBIC_METRES * thickness_mm);
        match self {
            Material::Isotropic { density_kg_m3, thickness_mm, .. }
            | Material::Orthotropic { density_kg_m3, thickness_mm, .. } => layer(*density_kg_m3, *thickness_mm),
            Material::Laminate { plies, .. } => {
                plies.iter().map(|ply| layer(ply.density_kg_m3, ply.thickness_mm)).sum()
            }
        }
    }

    /// Distance of the surface of the geometry from the middle of the thickness, along the normal, mm: half the thickness
    /// puts the surface on top, minus half of it at the bottom.
    pub fn offset_mm(&self) -> f64 {
        match self {
            Material::Isotropic { offset_mm, .. }
            | Material::Orthotropic { offset_mm, .. }
            | Material::Laminate { offset_mm, .. } => *offset_mm,
        }
    }

    /// Whether the scene gives the thermal expansion of the material.
    pub fn expands(&self) -> bool {
        match self {
            Material::Isotropic { thermal_expansion_per_k, .. } => thermal_expansion_per_k.is_some(),
            Material::Orthotropic { law, .. } => law.expansion_per_k().is_some(),
            Material::Laminate { plies, .. } => plies.iter().all(|ply| ply.law.expansion_per_k().is_some()),
        }
    }
}

fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

/// A cubic millimetre in cubic metres.
const CUBIC_METRES: f64 = 1e-9;

/// The moduli of an orthotropic layer in plane stress.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OrthotropicLaw {
    /// Young's modulus E₁ along material axis 1 (the fibres).
    pub youngs_modulus_1_mpa: f64,
    /// Young's modulus E₂ across.
    pub youngs_modulus_2_mpa: f64,
    /// Poisson's ratio ν₁₂: strain along 2 is −ν₁₂ times that along 1 under stress along 1. ν₁₂² < E₁/E₂.
    pub poissons_ratio_12: f64,
    /// Shear modulus G₁₂.
    pub shear_modulus_12_mpa: f64,
    /// Strain of a free layer along material axis 1 per kelvin.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thermal_expansion_1_per_k: Option<f64>,
    /// Thermal expansion across material axis 1, 1/K.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thermal_expansion_2_per_k: Option<f64>,
    /// Stresses at which the layer fails; no state depends on them.
    #[serde(flatten, default, skip_serializing_if = "Option::is_none")]
    pub strengths: Option<Strengths>,
}

/// Stresses at which an orthotropic layer fails where each acts alone; all positive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Strengths {
    /// Tension along material axis 1 (the fibres), Xₜ.
    pub tensile_strength_1_mpa: f64,
    /// Compression along it, X_c.
    pub compressive_strength_1_mpa: f64,
    /// Tension across, Yₜ.
    pub tensile_strength_2_mpa: f64,
    /// Compression across, Y_c.
    pub compressive_strength_2_mpa: f64,
    /// Shear in the plane of the layer, S.
    pub shear_strength_12_mpa: f64,
}

impl OrthotropicLaw {
    /// Strains of a free layer along and across material axis 1 per kelvin, where both are given.
    pub fn expansion_per_k(&self) -> Option<[f64; 2]> {
        Some([self.thermal_expansion_1_per_k?, self.thermal_expansion_2_per_k?])
    }
}

/// One ply of a laminate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ply {
    /// Thickness of the ply.
    pub thickness_mm: f64,
    /// Angle of material axis 1 from the u direction of the surface towards v.
    pub angle_deg: f64,
    /// Moduli in the material axes.
    #[serde(flatten)]
    pub law: OrthotropicLaw,
    /// Density ρ, kg/m³.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density_kg_m3: Option<f64>,
}
