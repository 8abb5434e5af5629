//! The array of tables `[[action]]`: what acts on the shell.

use super::data::{Action, ActionKind, ForceVector, Geometry, LoadedArea, Material, Place, SurfaceDirection};
use super::fault::{Checked, Fault};
use super::places::{edge, has_centre, history, place, point};
use super::table::{ANY, Table};

/// Acceleration of free fall, m/s².
const FREE_FALL: [f64; 3] = [0.0, 0.0, -9.81];

/// One `[[action]]`.
pub(super) fn action(table: Table<'_, '_>, ordinal: usize, shell: (&Geometry, &Material)) -> Checked<Action> {
    let (geometry, material) = shell;
    let name = table.maybe_text("name")?.unwrap_or_else(|| format!("action {ordinal}"));
    let kinds =
        ["force", "line-force", "area-force", "gravity", "edge-moment", "pressure", "temperature", "natural-curvature"];
    let kind = match table.word("kind", &kinds.map(|kind| (kind, kind)))? {
        "force" => {
            ActionKind::Force { on: point(&table)?, force_n: vector(&table, "force_n", geometry)?.inside(&table)? }
        }
        "line-force" => line_force(&table, geometry)?,
        "area-force" => area_force(&table, geometry)?,
        "gravity" => gravity(&table, material)?,
        "edge-moment" => ActionKind::EdgeMoment {
            on: edge(&table, "an edge moment")?,
            moment_n: table.number("moment_n", ANY, "1.0")?,
        },
        "temperature" => ActionKind::Temperature { change_k: table.number("change_k", ANY, "-100.0")? },
        "natural-curvature" => {
            ActionKind::NaturalCurvature { change_per_mm: table.tuple("change_per_mm", "[0.01, 0.0, 0.0]")? }
        }
        _ => ActionKind::Pressure {
            pressure_mpa: table.number("pressure_mpa", ANY, "0.001")?,
            follower: table.switch_or("follower", true)?,
        },
    };
    let history = history(&table)?;
    table.finish()?;
    Ok(Action { name, kind, history })
}

fn line_force(table: &Table<'_, '_>, geometry: &Geometry) -> Checked<ActionKind> {
    let on = place(table)?;
    if matches!(on, Place::Point(_)) {
        return Err(table.wrong(
            table.place_of("on").as_ref(),
            "a force per length needs a length",
            "write an edge or a line in `on`, or use `kind = \"force\"` and `force_n`",
        ));
    }
    let force = vector(table, "force_n_per_mm", geometry)?;
    let force_n_per_mm = if matches!(on, Place::Edge(_)) { force } else { force.inside(table)? };
    Ok(ActionKind::LineForce { on, force_n_per_mm })
}

fn area_force(table: &Table<'_, '_>, geometry: &Geometry) -> Checked<ActionKind> {
    let force_n_per_mm2 = vector(table, "force_n_per_mm2", geometry)?.inside(table)?;
    let areas = [("area", LoadedArea::Undeformed), ("projected-area", LoadedArea::Projected)];
    let per = table.maybe_word("per", &areas)?.unwrap_or_default();
    if per == LoadedArea::Projected && matches!(force_n_per_mm2, ForceVector::Along(..)) {
        return Err(table.wrong(
            table.place_of("per").as_ref(),
            "an area is projected along one direction, and `along` gives each point its own",
            "write components, such as `force_n_per_mm2 = [0.0, 0.0, -0.001]`, or `per = \"area\"`",
        ));
    }
    Ok(ActionKind::AreaForce { force_n_per_mm2, per })
}

fn gravity(table: &Table<'_, '_>, material: &Material) -> Checked<ActionKind> {
    let acceleration_m_s2 = table.maybe_tuple("acceleration_m_s2", "[0.0, 0.0, -9.81]")?.unwrap_or(FREE_FALL);
    if material.mass_kg_per_mm2().is_none() {
        let remedy = match material {
            Material::Laminate { .. } => "write `density_kg_m3` in [material] for all plies, or in each [[ply]]",
            _ => "write `density_kg_m3` in [material], such as 7850.0 for steel",
        };
        return Err(table.wrong(table.place_of("kind").as_ref(), "a shell without density has no weight", remedy));
    }
    Ok(ActionKind::Gravity { acceleration_m_s2 })
}

/// A force by its components, or by a number and `along`.
fn vector(table: &Table<'_, '_>, name: &'static str, geometry: &Geometry) -> Checked<ForceVector> {
    let words = [
        ("normal", SurfaceDirection::Normal),
        ("radial", SurfaceDirection::Radial),
        ("outward", SurfaceDirection::Outward),
    ];
    let along = table.maybe_word("along", &words)?;
    let is_list = table.entry(name).is_none_or(|entry| entry.value.get_ref().as_array().is_some());
    match (along, is_list) {
        (None, true) => Ok(ForceVector::Components(table.tuple(name, "[0.0, 0.0, 1.0]")?)),
        (None, false) => {
            table.number(name, ANY, "1.0")?;
            Err(table.wrong(
                table.place_of(name).as_ref(),
                format!("`{name}` is one number, and says no direction"),
                format!("write three components, such as `{name} = [0.0, 0.0, 1.0]`, or add `along = \"normal\"` (or \"radial\", or \"outward\" on an edge)"),
            ))
        }
        (Some(_), true) if table.entry(name).is_some() => Err(table.wrong(
            table.place_of("along").as_ref(),
            format!("`{name}` has components, which say the direction already"),
            format!("take `along` out, or write one number, such as `{name} = 1.0`"),
        )),
        (Some(direction), _) => {
            let size = table.number(name, ANY, "1.0")?;
            if direction == SurfaceDirection::Radial {
                has_centre(table, "along", geometry)?;
            }
            Ok(ForceVector::Along(size, direction))
        }
    }
}

impl ForceVector {
    /// The same, if it is not directed out of an edge: where it acts there is none.
    fn inside(self, table: &Table<'_, '_>) -> Result<Self, Box<Fault>> {
        match self {
            ForceVector::Along(_, SurfaceDirection::Outward) => Err(table.wrong(
                table.place_of("along").as_ref(),
                "only an edge has a side that is outward",
                "use `kind = \"line-force\"` on an edge, or `along = \"normal\"` or \"radial\"",
            )),
            other => Ok(other),
        }
    }
}
