//! `[material]` and the array of tables `[[ply]]`.

use serde_json::{Map, Value};

use super::data::{Material, Ply};
use super::fault::{Checked, Fault};
use super::problem::Problem;
use super::table::{Table, data};

/// Keys of a layer's law that every ply has, of its own or from `[material]`.
const OF_EACH_PLY: [&str; 4] =
    ["youngs_modulus_1_mpa", "youngs_modulus_2_mpa", "poissons_ratio_12", "shear_modulus_12_mpa"];
/// Keys of a layer's law that come in pairs.
const EXPANSIONS: [&str; 2] = ["thermal_expansion_1_per_k", "thermal_expansion_2_per_k"];

/// Keys of a layer's strengths, which come together.
const STRENGTHS: [&str; 5] = [
    "tensile_strength_1_mpa",
    "compressive_strength_1_mpa",
    "tensile_strength_2_mpa",
    "compressive_strength_2_mpa",
    "shear_strength_12_mpa",
];

/// The material of a scene.
pub(super) fn material(table: &Table, plies: Vec<&Table>) -> Checked<Material> {
    if table.kind() != "isotropic" {
        check_law(table, &table.values)?;
    }
    match (table.kind(), plies.first()) {
        ("laminate", None) => Err(table.wrong(
            None,
            "a laminate has no plies",
            "add `[[ply]]` tables from bottom to top, each with thickness_mm and angle_deg",
        )),
        ("laminate", Some(_)) => {
            let plies = plies.into_iter().map(|ply_table| ply(ply_table, table)).collect::<Checked<_>>()?;
            Ok(Material::Laminate { plies, offset_mm: table.get("offset_mm") })
        }
        (_, Some(ply)) => Err(ply.wrong(
            None,
            "plies belong to a laminate",
            "write `kind = \"laminate\"` in [material], or take the [[ply]] tables away",
        )),
        (_, None) => Ok(table.data()),
    }
}

/// A ply; what it lacks comes from the table of its laminate.
fn ply(table: &Table, laminate: &Table) -> Checked<Ply> {
    let mut values = laminate.values.clone();
    values.extend(table.values.clone());
    let mut keys = table.section.keys.iter();
    if let Some(key) = keys.find(|key| OF_EACH_PLY.contains(&key.name) && !values.contains_key(key.name)) {
        return Err(Fault::new(Problem::MissingKey { key }, &table.place).in_item(Some(table.title.clone())));
    }
    check_law(table, &values)?;
    Ok(data(&table.title, values))
}

/// Refuses a law that contradicts itself, as far as it is given.
fn check_law(table: &Table, values: &Map<String, Value>) -> Checked<()> {
    let number = |name: &str| values.get(name).and_then(Value::as_f64);
    if let [(given, Some(_)), (other, None)] | [(other, None), (given, Some(_))] =
        EXPANSIONS.map(|name| (name, number(name)))
    {
        return Err(table.wrong_at(
            given,
            format!("`{given}` is given and `{other}` is not"),
            format!("write both; `{other} = 0.0` does not expand that way"),
        ));
    }
    let (given, missing): (Vec<&str>, Vec<&str>) = STRENGTHS.into_iter().partition(|name| number(name).is_some());
    if let (Some(given), false) = (given.first(), missing.is_empty()) {
        return Err(table.wrong_at(
            given,
            format!("of the strengths of a layer these are missing: {}", missing.join(", ")),
            "write all five or none: a criterion of failure needs them all",
        ));
    }
    let [e1, e2, nu, _] = OF_EACH_PLY.map(number);
    let ratio = e1.zip(e2).map(|(along, across)| along / across);
    if let Some((nu, ratio)) = nu.zip(ratio).filter(|(nu, ratio)| nu * nu >= *ratio) {
        return Err(table.wrong_at(
            "poissons_ratio_12",
            format!("nu12 = {nu} is too large for E1/E2 = {ratio}: the layer would have no stiffness"),
            "nu12 squared must be below E1/E2",
        ));
    }
    Ok(())
}
