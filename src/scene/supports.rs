//! The array of tables `[[support]]`: what holds the shell.

use super::data::{History, Hold, Motion, Place, Support};
use super::fault::Checked;
use super::places::{edge, edge_or_line, history, place};
use super::table::{ANY, Table};

/// One `[[support]]`.
pub(super) fn support(table: Table<'_, '_>, ordinal: usize) -> Checked<Support> {
    let name = table.maybe_text("name")?.unwrap_or_else(|| format!("support {ordinal}"));
    let kinds = ["hinged", "fixed", "displacement", "symmetric", "clamped", "rigid", "rigid-motions"];
    let kind = table.word("kind", &kinds.map(|kind| (kind, kind)))?;
    let zero = Some(0.0);
    let (on, hold) = match kind {
        "hinged" => (place(&table)?, Hold::Displacement { displacement_mm: [zero; 3] }),
        "fixed" => (place(&table)?, Hold::Displacement { displacement_mm: held(&table)? }),
        "displacement" => {
            let displacement_mm =
                [table.maybe_number("x_mm", ANY)?, table.maybe_number("y_mm", ANY)?, table.maybe_number("z_mm", ANY)?];
            if displacement_mm == [None; 3] {
                return Err(table.wrong(
                    None,
                    "no component is given",
                    "write `x_mm`, `y_mm` or `z_mm`; those left out are free",
                ));
            }
            (place(&table)?, Hold::Displacement { displacement_mm })
        }
        "symmetric" => (edge_or_line(&table)?, Hold::Symmetric),
        "rigid-motions" => (Place::Whole, Hold::RigidMotions),
        "clamped" => {
            let motions = [Motion::Given(0.0); 6];
            let hold = Hold::Rigid { motions, reference_mm: None, normals_turn: true };
            (Place::Edge(edge(&table, "a clamp")?), hold)
        }
        _ => (Place::Edge(edge(&table, "a rigid section")?), rigid(&table)?),
    };
    let history = if ["displacement", "rigid"].contains(&kind) { history(&table)? } else { History::default() };
    table.finish()?;
    Ok(Support { name, on, hold, history })
}

fn held(table: &Table<'_, '_>) -> Checked<[Option<f64>; 3]> {
    let Some(words) = table.maybe_words("hold")? else { return Ok([Some(0.0); 3]) };
    let mut held = [None; 3];
    for word in &words {
        match ["x", "y", "z"].iter().position(|axis| axis == word) {
            Some(axis) => held[axis] = Some(0.0),
            None => {
                return Err(table.wrong(
                    table.place_of("hold").as_ref(),
                    format!("`hold` cannot name \"{word}\""),
                    "components are \"x\", \"y\" and \"z\"",
                ));
            }
        }
    }
    if held == [None; 3] {
        return Err(table.wrong(
            table.place_of("hold").as_ref(),
            "`hold` holds nothing",
            "name at least one of \"x\", \"y\", \"z\"",
        ));
    }
    Ok(held)
}

fn rigid(table: &Table<'_, '_>) -> Checked<Hold> {
    let names = ["x_mm", "y_mm", "z_mm", "rotation_x_deg", "rotation_y_deg", "rotation_z_deg"];
    let mut motions = [Motion::Given(0.0); 6];
    for (motion, name) in motions.iter_mut().zip(names) {
        let Some(entry) = table.entry(name) else { continue };
        *motion = match entry.value.get_ref().as_str() {
            Some("free") => Motion::FREE,
            Some(_) => {
                return Err(table.wrong(
                    Some(&entry.value_place()),
                    format!("`{name}` must be a number or \"free\""),
                    "0.0 holds the motion",
                ));
            }
            None => Motion::Given(table.number_or(name, ANY, 0.0)?),
        };
    }
    let reference_mm = table.maybe_tuple("reference_mm", "[0.0, 0.0, 0.0]")?;
    let normals_turn = table.maybe_word("normals", &[("turn", true), ("free", false)])?.unwrap_or(true);
    Ok(Hold::Rigid { motions, reference_mm, normals_turn })
}
