//! The arrays of tables `[[spring]]` and `[[mass]]`: what hangs on a rigid section; and the sections that tables name.

use super::data::{Hold, Motion, PointMass, Spring, Support};
use super::fault::{Checked, Faults};
use super::table::Table;
use super::tables::Tables;

/// What hangs on rigid sections.
pub(super) type OnSections = (Vec<Spring>, Vec<PointMass>);

/// Reads all springs and masses.
pub(super) fn on_sections(tables: &Tables, supports: &[Support], faults: &mut Faults) -> OnSections {
    let mut springs: Vec<Spring> = Vec::new();
    for table in tables.all("spring") {
        springs.extend(faults.keep(spring(table, supports, &springs)));
    }
    let masses = tables.all("mass").filter_map(|table| faults.keep(mass(table, supports))).collect();
    (springs, masses)
}

/// Finds the rigid section that a table names.
pub(super) fn section<'s>(table: &Table, supports: &'s [Support]) -> Checked<&'s Support> {
    let name: String = table.get("section");
    let is_rigid = |support: &&Support| matches!(support.hold, Hold::Rigid { .. });
    let sections = supports.iter().filter(is_rigid);
    if let Some(found) = sections.clone().find(|support| support.name == name) {
        return Ok(found);
    }
    let names: Vec<String> = sections.map(|support| format!("\"{}\"", support.name)).collect();
    let remedy = match names.is_empty() {
        true => "add a [[support]] of kind = \"rigid\" with motions that are \"free\"".to_owned(),
        false => format!("the rigid sections are {}", names.join(", ")),
    };
    Err(table.wrong_at("section", format!("no rigid section is called \"{name}\""), remedy))
}

const TRANSLATION: &str = "translation_n_per_mm";
const ROTATION: &str = "rotation_n_mm_per_deg";

fn spring(table: &Table, supports: &[Support], before: &[Spring]) -> Checked<Spring> {
    let section = section(table, supports)?;
    let spring = Spring {
        name: table.name(),
        section: table.get("section"),
        translation_n_per_mm: table.get(TRANSLATION),
        rotation_n_mm_per_deg: table.get(ROTATION),
    };
    let mut names = supports.iter().map(|support| &support.name).chain(before.iter().map(|spring| &spring.name));
    if names.any(|name| *name == spring.name) {
        let problem = "a support or another spring has the same name";
        return Err(table.wrong_at("name", problem, "probes need a name for each"));
    }
    let stiffness: Vec<f64> = spring.translation_n_per_mm.into_iter().chain(spring.rotation_n_mm_per_deg).collect();
    if stiffness.iter().all(|value| *value == 0.0) {
        let remedy = format!("write for example `{TRANSLATION} = [0.0, 0.0, 5.0]`, or `{ROTATION}`");
        return Err(table.wrong(None, "a spring without stiffness has no effect", remedy));
    }
    let Hold::Rigid { motions, .. } = &section.hold else { return Ok(spring) };
    let words = ["along x", "along y", "along z", "about x", "about y", "about z"];
    for (k, (motion, _)) in motions.iter().zip(&stiffness).enumerate().filter(|(_, (_, value))| **value != 0.0) {
        // Rotations about several axes that are free do not commute with those that are held: only the whole is refused.
        let is_held = |motion: &Motion| *motion == Motion::Given(0.0);
        let no_turn = k >= 3 && motions[3..].iter().all(is_held);
        if (k < 3 && is_held(motion)) || no_turn {
            let problem =
                format!("section \"{}\" does not move {}, and a spring has no effect", section.name, words[k]);
            let key = if k < 3 { TRANSLATION } else { ROTATION };
            return Err(table.wrong_at(
                key,
                problem,
                "make the motion \"free\" in the support, or take the stiffness out",
            ));
        }
    }
    Ok(spring)
}

fn mass(table: &Table, supports: &[Support]) -> Checked<PointMass> {
    section(table, supports)?;
    let (section, mass_kg, at_mm) = (table.get("section"), table.get("mass_kg"), table.get("at_mm"));
    Ok(PointMass { name: table.name(), section, mass_kg, at_mm })
}
