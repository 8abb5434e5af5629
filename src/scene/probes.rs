//! The array of tables `[[probe]]`: what reports read.

use super::actions::has_centre;
use super::data::{Component, Probe, ProbeKind, Support};
use super::fault::Checked;
use super::shells::Shells;
use super::table::Table;

/// One `[[probe]]`.
pub(super) fn probe(table: &Table, supports: &[Support], shells: &Shells) -> Checked<Probe> {
    let kind: ProbeKind = table.data();
    let is_of_all = matches!(kind, ProbeKind::Reaction { .. } | ProbeKind::Energy);
    let shell = shells.named_in(table, is_of_all)?.unwrap_or(0);
    let geometry = &shells.all[shell].geometry;
    if let (ProbeKind::SectionMoment { .. }, true) = (&kind, shells.are_named) {
        return Err(table.wrong_at(
            "kind",
            "a line cuts one shell of a structure, and the others carry moments past it",
            "read what a support carries: `kind = \"reaction\"` with the name of the `support` and, of a rigid section, a `component` such as \
             \"moment-y\", about its reference point",
        ));
    }
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
    Ok(Probe { name: table.name(), shell, kind })
}
