//! The array of tables `[[probe]]`: what reports read.

use super::data::{Axis, Component, Geometry, Place, Probe, ProbeKind, Reaction, Support};
use super::fault::Checked;
use super::places::{has_centre, place, point};
use super::table::Table;

const AXES: [(&str, Axis); 3] = [("x", Axis::X), ("y", Axis::Y), ("z", Axis::Z)];
const COMPONENTS: [(&str, Component); 6] = [
    ("x", Component::X),
    ("y", Component::Y),
    ("z", Component::Z),
    ("magnitude", Component::Magnitude),
    ("normal", Component::Normal),
    ("radial", Component::Radial),
];
const REACTIONS: [(&str, Reaction); 6] = [
    ("force-x", Reaction::ForceX),
    ("force-y", Reaction::ForceY),
    ("force-z", Reaction::ForceZ),
    ("moment-x", Reaction::MomentX),
    ("moment-y", Reaction::MomentY),
    ("moment-z", Reaction::MomentZ),
];

/// One `[[probe]]`.
pub(super) fn probe(table: Table<'_, '_>, supports: &[Support], geometry: &Geometry) -> Checked<Probe> {
    let Some(name) = table.maybe_text("name")? else {
        return Err(table.missing("name", "write what reports should call it, such as `name = \"tip\"`"));
    };
    let kinds = ["displacement", "reaction", "section-moment", "energy", "bending-strain"];
    let kind = match table.word("kind", &kinds.map(|kind| (kind, kind)))? {
        "displacement" => {
            let component = table.word("component", &COMPONENTS)?;
            if component == Component::Radial {
                has_centre(&table, "component", geometry)?;
            }
            ProbeKind::Displacement { on: point(&table)?, component }
        }
        "reaction" => {
            let known: Vec<String> = supports.iter().map(|support| format!("\"{}\"", support.name)).collect();
            let remedy = match known.is_empty() {
                true => "the scene has no [[support]]".to_owned(),
                false => format!("the supports are {}", known.join(", ")),
            };
            let Some(support) = table.maybe_text("support")? else {
                return Err(table.missing("support", remedy));
            };
            if supports.iter().all(|known| known.name != support) {
                return Err(table.wrong(
                    table.place_of("support").as_ref(),
                    format!("no support is called \"{support}\""),
                    remedy,
                ));
            }
            ProbeKind::Reaction { support, component: table.word("component", &REACTIONS)? }
        }
        "section-moment" => match place(&table)? {
            on @ Place::Line(..) => ProbeKind::SectionMoment { on, component: table.word("component", &AXES)? },
            _ => {
                return Err(table.wrong(
                    table.place_of("on").as_ref(),
                    "a section is a line",
                    "write for example `on = \"u=0.5\"`",
                ));
            }
        },
        "energy" => ProbeKind::Energy,
        _ => ProbeKind::BendingStrain,
    };
    table.finish()?;
    Ok(Probe { name, kind })
}
