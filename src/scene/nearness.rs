//! Places that are almost one: what holds or moves two of them differently tears at a gap that no element resolves.

use super::data::{Action, ActionKind, Region, Support};
use super::fault::Checked;
use super::regions::EDGES;
use super::table::Table;
use super::tables::Tables;
use crate::units::significant;

/// Fractions of a side by which places are apart, or one.
const APART: f64 = 1e-4;

/// A place of a scene and where it is written.
struct Site<'a> {
    name: String,
    /// The shell, by its place in the list.
    shell: usize,
    on: Region,
    table: &'a Table,
}

/// Refuses supports and actions on places that almost coincide, or almost lie on an edge.
pub(super) fn check(tables: &Tables, supports: &[Support], actions: &[Action]) -> Checked<()> {
    let (held, loaded) = (tables.all("support"), tables.all("action"));
    let supports = supports.iter().zip(held).map(|(support, table)| Site {
        name: format!("support \"{}\"", support.name),
        shell: support.shell,
        on: support.on,
        table,
    });
    let actions = actions.iter().zip(loaded).filter_map(|(action, table)| {
        let (name, on) = (format!("action \"{}\"", action.name), place_of(&action.kind)?);
        Some(Site { name, shell: action.shell.unwrap_or(0), on, table })
    });
    let edges = EDGES.map(|(edge, name)| (Region::Edge(edge), format!("the edge \"{name}\"")));
    let mut before: Vec<Site> = Vec::new();
    for site in supports.chain(actions) {
        let edges = edges.iter().map(|(on, name)| (*on, name));
        let others = before.iter().filter(|other| other.shell == site.shell).map(|other| (other.on, &other.name));
        let mut gaps = edges.chain(others).filter_map(|(on, name)| Some((gap(site.on, on)?, name)));
        if let Some((gap, other)) = gaps.next() {
            return Err(site.table.wrong_at(
                "on",
                format!("{} lies {} of a side from {other}, which is almost the same place", site.name, significant(gap, 2)),
                format!("no element resolves what is between them: write the same place for both, or put them {APART} of the side apart"),
            ));
        }
        before.push(site);
    }
    Ok(())
}

/// Where an action is, unless it is on the whole surface.
fn place_of(kind: &ActionKind) -> Option<Region> {
    match kind {
        ActionKind::Force { on, .. } => Some(Region::Point(*on)),
        ActionKind::LineForce { on, .. } => Some(*on),
        ActionKind::EdgeMoment { on, .. } => Some(Region::Edge(*on)),
        _ => None,
    }
}

/// How far two places are apart that are almost one, as a fraction of a side.
fn gap(one: Region, other: Region) -> Option<f64> {
    let [one, other] = [one, other].map(Region::fractions);
    let apart = (0..2).filter_map(|direction| Some((one[direction]? - other[direction]?).abs())).fold(0.0, f64::max);
    (0.0 < apart && apart < APART).then_some(apart)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::data::{Edge, ParametricDirection};

    #[test]
    fn places_are_one_or_apart_or_almost_one() {
        let line = |u: f64| Region::Line(ParametricDirection::U, u);
        assert_eq!(gap(line(1e-6), Region::Edge(Edge::UStart)), Some(1e-6));
        assert!(gap(Region::Point([0.3, 0.5]), Region::Point([0.300_01, 0.5])).is_some());
        assert!(gap(Region::Point([0.3, 0.5]), line(0.300_01)).is_some());
        assert_eq!(gap(Region::Point([0.3, 0.5]), Region::Point([0.300_01, 0.6])), None);
        assert_eq!(gap(Region::Point([0.3, 0.5]), line(0.3)), None);
        assert_eq!(gap(line(0.3), line(0.301)), None);
        assert_eq!(gap(line(1e-6), Region::Edge(Edge::VStart)), None);
        assert_eq!(gap(line(0.3), Region::Whole), None);
    }
}
