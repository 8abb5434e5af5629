//! `[material]` of another kind than an isotropic one, and the array of tables `[[ply]]`.

use super::data::{Material, OrthotropicLaw, Ply};
use super::fault::Checked;
use super::kinds::MATERIALS;
use super::table::{ANY, LENGTH, Range, Table};

const DENSITY: Range = Range { above: 0.0, most: 1e12, reason: "densities are positive, in kg/m3 (steel: 7850)" };
const EXPANSION: Range = Range {
    above: -1e-3,
    most: 1e-3,
    reason: "a strain per kelvin, such as 22.5e-6 across the fibres of carbon in epoxy",
};
const MODULUS: Range = Range { above: 0.0, most: 1e13, reason: "moduli are positive, in MPa" };

/// What one table says of a layer: moduli, Poisson's ratio and expansions.
#[derive(Clone, Copy, Default)]
struct GivenLaw {
    youngs_modulus_1_mpa: Option<f64>,
    youngs_modulus_2_mpa: Option<f64>,
    poissons_ratio_12: Option<f64>,
    shear_modulus_12_mpa: Option<f64>,
    thermal_expansion_1_per_k: Option<f64>,
    thermal_expansion_2_per_k: Option<f64>,
}

impl GivenLaw {
    fn read(table: &Table<'_, '_>) -> Checked<Self> {
        let ratio =
            Range { above: -10.0, most: 10.0, reason: "Poisson's ratio nu12 is below sqrt(E1/E2) in magnitude" };
        Ok(Self {
            youngs_modulus_1_mpa: table.maybe_number("youngs_modulus_1_mpa", MODULUS)?,
            youngs_modulus_2_mpa: table.maybe_number("youngs_modulus_2_mpa", MODULUS)?,
            poissons_ratio_12: table.maybe_number("poissons_ratio_12", ratio)?,
            shear_modulus_12_mpa: table.maybe_number("shear_modulus_12_mpa", MODULUS)?,
            thermal_expansion_1_per_k: table.maybe_number("thermal_expansion_1_per_k", EXPANSION)?,
            thermal_expansion_2_per_k: table.maybe_number("thermal_expansion_2_per_k", EXPANSION)?,
        })
    }

    /// Refuses what contradicts itself, as far as it is given.
    fn checked(self, table: &Table<'_, '_>) -> Checked<Self> {
        let expansions = [
            ("thermal_expansion_1_per_k", self.thermal_expansion_1_per_k),
            ("thermal_expansion_2_per_k", self.thermal_expansion_2_per_k),
        ];
        if let [(given, Some(_)), (other, None)] | [(other, None), (given, Some(_))] = expansions {
            return Err(table.wrong(
                table.place_of(given).as_ref(),
                format!("`{given}` is given and `{other}` is not"),
                format!("write both; `{other} = 0.0` does not expand that way"),
            ));
        }
        let ratio = self.youngs_modulus_1_mpa.zip(self.youngs_modulus_2_mpa).map(|(along, across)| along / across);
        if let Some((nu, ratio)) = self.poissons_ratio_12.zip(ratio).filter(|(nu, ratio)| nu * nu >= *ratio) {
            return Err(table.wrong(
                table.place_of("poissons_ratio_12").as_ref(),
                format!("nu12 = {nu} is too large for E1/E2 = {ratio}: the layer would have no stiffness"),
                "nu12 squared must be below E1/E2",
            ));
        }
        Ok(self)
    }

    /// What is missing comes from `default`.
    fn or(self, default: Self) -> Self {
        Self {
            youngs_modulus_1_mpa: self.youngs_modulus_1_mpa.or(default.youngs_modulus_1_mpa),
            youngs_modulus_2_mpa: self.youngs_modulus_2_mpa.or(default.youngs_modulus_2_mpa),
            poissons_ratio_12: self.poissons_ratio_12.or(default.poissons_ratio_12),
            shear_modulus_12_mpa: self.shear_modulus_12_mpa.or(default.shear_modulus_12_mpa),
            thermal_expansion_1_per_k: self.thermal_expansion_1_per_k.or(default.thermal_expansion_1_per_k),
            thermal_expansion_2_per_k: self.thermal_expansion_2_per_k.or(default.thermal_expansion_2_per_k),
        }
    }
}

/// Law of the layer of one table; what is missing comes from `default`.
fn law(table: &Table<'_, '_>, default: GivenLaw) -> Checked<OrthotropicLaw> {
    let given = GivenLaw::read(table)?.or(default).checked(table)?;
    let modulus = |name: &'static str, value: Option<f64>| {
        let remedy = "an orthotropic layer has youngs_modulus_1_mpa, youngs_modulus_2_mpa, poissons_ratio_12, shear_modulus_12_mpa";
        value.ok_or_else(|| table.missing(name, remedy))
    };
    Ok(OrthotropicLaw {
        youngs_modulus_1_mpa: modulus("youngs_modulus_1_mpa", given.youngs_modulus_1_mpa)?,
        youngs_modulus_2_mpa: modulus("youngs_modulus_2_mpa", given.youngs_modulus_2_mpa)?,
        poissons_ratio_12: given
            .poissons_ratio_12
            .ok_or_else(|| table.missing("poissons_ratio_12", "write for example `poissons_ratio_12 = 0.3`"))?,
        shear_modulus_12_mpa: modulus("shear_modulus_12_mpa", given.shear_modulus_12_mpa)?,
        thermal_expansion_1_per_k: given.thermal_expansion_1_per_k,
        thermal_expansion_2_per_k: given.thermal_expansion_2_per_k,
    })
}

/// A material of one of [`MATERIALS`].
pub(super) fn material(table: Table<'_, '_>, plies: Vec<Table<'_, '_>>) -> Checked<Material> {
    let kind = table.word("kind", &MATERIALS.map(|kind| (kind, kind)))?;
    if kind == "orthotropic" {
        let material = Material::Orthotropic {
            law: law(&table, GivenLaw::default())?,
            angle_deg: table.number_or("angle_deg", ANY, 0.0)?,
            thickness_mm: table.number("thickness_mm", LENGTH, "0.1")?,
            density_kg_m3: table.maybe_number("density_kg_m3", DENSITY)?,
            offset_mm: table.number_or("offset_mm", ANY, 0.0)?,
        };
        table.finish()?;
        return no_plies(plies).map(|()| material);
    }
    let offset_mm = table.number_or("offset_mm", ANY, 0.0)?;
    let default = GivenLaw::read(&table)?.checked(&table)?;
    let density_kg_m3 = table.maybe_number("density_kg_m3", DENSITY)?;
    if plies.is_empty() {
        return Err(table.wrong(
            None,
            "a laminate has no plies",
            "add `[[ply]]` tables from bottom to top, each with thickness_mm and angle_deg",
        ));
    }
    table.finish()?;
    let mut laminate = Vec::new();
    for ply in plies {
        laminate.push(Ply {
            thickness_mm: ply.number("thickness_mm", LENGTH, "0.05")?,
            angle_deg: ply.number_or("angle_deg", ANY, 0.0)?,
            law: law(&ply, default)?,
            density_kg_m3: ply.maybe_number("density_kg_m3", DENSITY)?.or(density_kg_m3),
        });
        ply.finish()?;
    }
    Ok(Material::Laminate { plies: laminate, offset_mm })
}

/// Refuses plies that belong to no laminate.
pub(super) fn no_plies(plies: Vec<Table<'_, '_>>) -> Checked<()> {
    match plies.first() {
        Some(ply) => Err(ply.wrong(
            None,
            "plies belong to a laminate",
            "write `kind = \"laminate\"` in [material], or take the [[ply]] tables away",
        )),
        None => Ok(()),
    }
}
