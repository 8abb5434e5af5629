//! The array of tables `[[probe]]`: what reports read.

use super::actions::has_centre;
use super::data::{Component, Probe, ProbeKind, Spring, Support};
use super::fault::Checked;
use super::shells::Shells;
use super::table::Table;

/// One `[[probe]]`.
pub(super) fn probe(table: &Table, held: (&[Support], &[Spring]), shells: &Shells) -> Checked<Probe> {
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
        ProbeKind::Reaction { support, .. } => check_support(table, support, held)?,
        _ => {}
    }
    Ok(Probe { name: table.name(), shell, kind })
}

/// Refuses the name of what neither is a support nor a spring.
fn check_support(table: &Table, name: &str, (supports, springs): (&[Support], &[Spring])) -> Checked<()> {
    let of_supports = supports.iter().map(|support| &*support.name);
    let known: Vec<&str> = of_supports.chain(springs.iter().map(|spring| &*spring.name)).collect();
    if known.contains(&name) {
        return Ok(());
    }
    let quoted: Vec<String> = known.iter().map(|known| format!("\"{known}\"")).collect();
    let remedy = match (quoted.is_empty(), springs.is_empty()) {
        (true, _) => "the scene has no [[support]]".to_owned(),
        (_, true) => format!("the supports are {}", quoted.join(", ")),
        (_, false) => format!("the supports and springs are {}", quoted.join(", ")),
    };
    Err(table.wrong_at("support", format!("no support is called \"{name}\""), remedy))
}
