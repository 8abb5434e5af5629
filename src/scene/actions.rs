//! The array of tables `[[action]]`: what acts on the shell.

use serde_json::{Value, json};

use super::data::{
    Action, ActionKind, ForceVector, Geometry, Material, PointMass, Region, Shell, Support, SurfaceDirection,
};
use super::fault::Checked;
use super::histories::history;
use super::sections::section;
use super::shells::Shells;
use super::table::{Table, data};

/// One `[[action]]`.
pub(super) fn action(table: &Table, shells: &Shells, supports: &[Support], masses: &[PointMass]) -> Checked<Action> {
    let acts_on_all =
        ["gravity", "temperature", "natural-curvature", "section-force", "section-moment"].contains(&table.kind());
    let shell = shells.named_in(table, acts_on_all)?;
    let Shell { geometry, material, .. } = &shells.all[shell.unwrap_or(0)];
    let mut values = table.values.clone();
    for name in ["force_n", "force_n_per_mm", "force_n_per_mm2"] {
        if let Some(force) = values.get_mut(name) {
            *force = vector(table, name, force.take(), geometry)?;
        }
    }
    if let Some(per) = values.get_mut("per") {
        *per = json!(if table.word("per") == "area" { "undeformed" } else { "projected" });
    }
    let kind = data(&table.title, values);
    check(table, &kind, (material, masses))?;
    if let ActionKind::SectionForce { .. } | ActionKind::SectionMoment { .. } = kind {
        section(table, supports)?;
    }
    // The only shell is not named.
    let shell = shell.filter(|_| shells.are_named);
    Ok(Action { name: table.name(), kind, shell, history: history(table)? })
}

/// A force by its components, or by a number and `along`.
fn vector(table: &Table, name: &str, force: Value, geometry: &Geometry) -> Checked<Value> {
    match (table.get::<Option<SurfaceDirection>>("along"), force.is_array()) {
        (None, true) => Ok(force),
        (None, false) => Err(table.wrong_at(
            name,
            format!("`{name}` is one number, and gives no direction"),
            format!("write three components, such as `{name} = [0.0, 0.0, 1.0]`, or add `along = \"normal\"` (or \"radial\", or \"outward\" on an edge)"),
        )),
        (Some(_), true) => Err(table.wrong_at(
            "along",
            format!("`{name}` has components, which give the direction already"),
            format!("take `along` out, or write one number, such as `{name} = 1.0`"),
        )),
        (Some(direction), false) => {
            if direction == SurfaceDirection::Radial {
                has_centre(table, "along", geometry)?;
            }
            Ok(json!([force, direction]))
        }
    }
}

/// What must hold between its keys, and with the material.
fn check(table: &Table, kind: &ActionKind, (material, masses): (&Material, &[PointMass])) -> Checked<()> {
    match kind {
        ActionKind::LineForce {
            on: Region::Line(..),
            force_n_per_mm: ForceVector::Along(_, SurfaceDirection::Outward),
        } => Err(table.wrong_at(
            "along",
            "only an edge has a side that is outward",
            "write an edge in `on`, or `along = \"normal\"` or \"radial\"",
        )),
        ActionKind::AreaForce { force_n_per_mm2: ForceVector::Along(..), per } if !per.is_undeformed() => Err(table
            .wrong_at(
                "per",
                "an area is projected along one direction, and `along` gives each point its own",
                "write components, such as `force_n_per_mm2 = [0.0, 0.0, -0.001]`, or `per = \"area\"`",
            )),
        ActionKind::Gravity { .. } if material.mass_kg_per_mm2().is_none() && masses.is_empty() => {
            let remedy = match material {
                Material::Laminate { .. } => "write `density_kg_m3` in [material] for all plies, or in each [[ply]]",
                _ => "write `density_kg_m3` in [material], such as 7850.0 for steel",
            };
            Err(table.wrong_at("kind", "a shell without density has no weight", remedy))
        }
        _ => Ok(()),
    }
}

/// Refuses the word `radial` where the shape has neither axis nor centre.
pub(super) fn has_centre(table: &Table, key: &str, geometry: &Geometry) -> Checked<()> {
    if geometry.away_from_centre([0.0; 3]).is_some() {
        return Ok(());
    }
    let shape = match geometry {
        Geometry::Plate { .. } => "a plate",
        Geometry::Profile { .. } => "a profile",
        _ => "a nurbs surface",
    };
    Err(table.wrong_at(
        key,
        format!("{shape} has no axis and no centre that \"radial\" could be away from"),
        "write \"normal\", or use components in x, y and z",
    ))
}
