//! Moduli, strengths, densities and angles of plies that look odd.

use super::key::key;
use crate::model::size::laws;
use crate::scene::{Material, OrthotropicLaw};
use crate::units::significant;

/// Young's moduli, MPa: from soft plastics to beyond diamond, 1.2e6.
const MODULUS_MPA: [f64; 2] = [1e3, 2e6];
/// From here on a modulus is one in Pa, below in kPa.
const PASCAL: f64 = 1e9;
/// Densities, kg/m³: from a light foam to osmium.
const DENSITY_KG_M3: [f64; 2] = [10.0, 2.5e4];
/// Shear modulus over the least and the largest Young's modulus.
const SHEAR_OVER_LEAST: f64 = 0.02;
const SHEAR_OVER_LARGEST: f64 = 2.0;
/// Strength over the modulus of its direction.
const STRENGTH_OVER_MODULUS: [f64; 2] = [5e-5, 0.2];
/// Angles of plies that are round in radians, degrees.
const ROUND_DEG: [f64; 4] = [30.0, 45.0, 60.0, 90.0];

/// The first odd number of each kind: plies are much alike.
pub(super) fn odd(material: &Material) -> Vec<String> {
    let layers = laws(material);
    let modulus = layers.iter().find_map(|(layer, moduli)| odd_modulus(layer, moduli));
    let laws: Vec<(String, &OrthotropicLaw)> = match material {
        Material::Isotropic { .. } => vec![],
        Material::Orthotropic { law, .. } => vec![("material.".into(), law)],
        Material::Laminate { plies, .. } => {
            layers.into_iter().map(|(layer, _)| layer).zip(plies.iter().map(|ply| &ply.law)).collect()
        }
    };
    let shear = laws.iter().find_map(|(layer, law)| odd_shear(layer, law));
    let strength = laws.iter().find_map(|(layer, law)| odd_strength(layer, law));
    [modulus, shear, strength, odd_density(material), odd_angle(material)].into_iter().flatten().collect()
}

fn odd_modulus(layer: &str, moduli: &[f64]) -> Option<String> {
    let [least, most] = MODULUS_MPA;
    let (index, modulus) = moduli.iter().enumerate().find(|(_, modulus)| !(least..=most).contains(*modulus))?;
    let name = match moduli.len() {
        1 => "youngs_modulus_mpa",
        _ => ["youngs_modulus_1_mpa", "youngs_modulus_2_mpa"][index],
    };
    let (unit, factor) = match *modulus {
        modulus if modulus < least => ("GPa", 1e3),
        modulus if modulus < PASCAL => ("kPa", 1e-3),
        _ => ("Pa", 1e-6),
    };
    let meant = significant(factor * modulus, 6);
    Some(format!("{layer}{} is in MPa: if {unit} were meant, write {meant}", key(name, *modulus)))
}

fn odd_shear(layer: &str, law: &OrthotropicLaw) -> Option<String> {
    let moduli = [law.youngs_modulus_1_mpa, law.youngs_modulus_2_mpa];
    let [least, largest] = [moduli[0].min(moduli[1]), moduli[0].max(moduli[1])];
    let shear = law.shear_modulus_12_mpa;
    (shear < SHEAR_OVER_LEAST * least || shear > SHEAR_OVER_LARGEST * largest).then(|| {
        let [least, largest] = [least, largest].map(|modulus| significant(modulus, 4));
        let name = key("shear_modulus_12_mpa", shear);
        format!("{layer}{name} beside Young's moduli of {least} and {largest} MPa: is it in MPa?")
    })
}

fn odd_strength(layer: &str, law: &OrthotropicLaw) -> Option<String> {
    let strengths = law.strengths?;
    let [least, most] = STRENGTH_OVER_MODULUS;
    let all = [
        ("tensile_strength_1_mpa", strengths.tensile_strength_1_mpa, law.youngs_modulus_1_mpa),
        ("compressive_strength_1_mpa", strengths.compressive_strength_1_mpa, law.youngs_modulus_1_mpa),
        ("tensile_strength_2_mpa", strengths.tensile_strength_2_mpa, law.youngs_modulus_2_mpa),
        ("compressive_strength_2_mpa", strengths.compressive_strength_2_mpa, law.youngs_modulus_2_mpa),
        ("shear_strength_12_mpa", strengths.shear_strength_12_mpa, law.shear_modulus_12_mpa),
    ];
    let odd = all.into_iter().find(|(_, strength, modulus)| !(least..=most).contains(&(strength / modulus)))?;
    let (name, strength, modulus) = odd;
    let modulus = significant(modulus, 4);
    Some(format!("{layer}{} beside a modulus of {modulus} MPa: is it in MPa?", key(name, strength)))
}

fn odd_density(material: &Material) -> Option<String> {
    let densities: Vec<f64> = match material {
        Material::Isotropic { density_kg_m3, .. } | Material::Orthotropic { density_kg_m3, .. } => {
            density_kg_m3.iter().copied().collect()
        }
        Material::Laminate { plies, .. } => plies.iter().filter_map(|ply| ply.density_kg_m3).collect(),
    };
    let [least, most] = DENSITY_KG_M3;
    let density = densities.into_iter().find(|density| !(least..=most).contains(density))?;
    let hint = match density {
        density if density < 1e-7 => "t/mm³ times 1e12 are kg/m³",
        density if density < 1e-3 => "kg/mm³ times 1e9 are kg/m³",
        density if density < least => "g/cm³ times 1000 are kg/m³",
        _ => "nothing is so heavy",
    };
    Some(format!("{} is in kg/m³: {hint}", key("density_kg_m3", density)))
}

/// An angle of a ply that is a round one in radians.
fn odd_angle(material: &Material) -> Option<String> {
    let angles: Vec<f64> = match material {
        Material::Isotropic { .. } => vec![],
        Material::Orthotropic { angle_deg, .. } => vec![*angle_deg],
        Material::Laminate { plies, .. } => plies.iter().map(|ply| ply.angle_deg).collect(),
    };
    let in_radians = |angle: f64| ROUND_DEG.into_iter().find(|round| (angle.abs() - round.to_radians()).abs() < 1e-2);
    let (angle, round) = angles.into_iter().find_map(|angle| Some((angle, in_radians(angle)?)))?;
    Some(format!("{} is in degrees: in radians that would be {}", key("angle_deg", angle), round.copysign(angle)))
}
