//! The array of tables `[[probe]]`: what reports read.

use super::actions::has_centre;
use super::data::{Component, Geometry, Probe, ProbeKind, Support};
use super::fault::Checked;
use super::table::Table;

/// One `[[probe]]`.
pub(super) fn probe(table: &Table, supports: &[Support], geometry: &Geometry) -> Checked<Probe> {
    let kind = table.data();
    match &kind {
        ProbeKind::Displacement { component: Component::Radial, .. } => has_centre(table, "component", geometry)?,
        ProbeKind::Reaction { support, .. } if supports.iter().all(|known| known.name != *support) => {
            let known: Vec<String> = supports.iter().map(|support| format!("\"{}\"", support.name)).collect();
            let remedy = match known.is_empty() {
                true => "the scene has no [[support]]".to_owned(),
                false => format!("the supports are {}", known.join(", ")),
            };
            return Err(table.wrong_at("support", format!("no support is called \"{support}\""), remedy));
        }
        _ => {}
    }
    Ok(Probe { name: table.name(), kind })
}
