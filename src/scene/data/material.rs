//! Constitutive law and thickness.

use serde::{Deserialize, Serialize};

/// Constitutive law and thickness.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
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
    },
    /// One orthotropic layer, symmetric about the mid-surface.
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
    },
    /// Plies through the thickness, from the side that the normal points away from (bottom) to the other (top); the
    /// surface of the geometry lies in the middle of the total thickness.
    Laminate {
        /// From bottom to top.
        plies: Vec<Ply>,
    },
}

impl Material {
    /// Total thickness, mm.
    pub fn thickness_mm(&self) -> f64 {
        match self {
            Material::Isotropic { thickness_mm, .. } | Material::Orthotropic { thickness_mm, .. } => *thickness_mm,
            Material::Laminate { plies } => plies.iter().map(|ply| ply.thickness_mm).sum(),
        }
    }

    /// Mass per area of the surface, kg/mm²; `None` where a density is missing.
    pub fn mass_kg_per_mm2(&self) -> Option<f64> {
        let layer = |density_kg_m3: Option<f64>, thickness_mm: f64| Some(density_kg_m3? * CUBIC_METRES * thickness_mm);
        match self {
            Material::Isotropic { density_kg_m3, thickness_mm, .. }
            | Material::Orthotropic { density_kg_m3, thickness_mm, .. } => layer(*density_kg_m3, *thickness_mm),
            Material::Laminate { plies } => plies.iter().map(|ply| layer(ply.density_kg_m3, ply.thickness_mm)).sum(),
        }
    }
}

/// A cubic millimetre in cubic metres.
const CUBIC_METRES: f64 = 1e-9;

/// Moduli of an orthotropic layer in plane stress.
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
}

/// A ply of a laminate.
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
