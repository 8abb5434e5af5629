//! Places at which nothing happens: u and v are exchanged in one of them.

use super::key::exchanged;
use crate::scene::{Action, ActionKind, Component, ForceVector, Hold, Motion, ProbeKind, Region, Scene, Support};

/// Difference of fractions up to which places are one.
const SAME: f64 = 1e-9;

pub(super) fn odd(scene: &Scene) -> Vec<String> {
    let actions = scene.actions.iter().filter_map(|action| carried(scene, action));
    actions.chain(read_where_held(scene)).collect()
}

/// An action on a place that a support holds in its direction, so that the shell does not feel it.
fn carried(scene: &Scene, Action { name, kind, .. }: &Action) -> Option<String> {
    let (on, acts) = match kind {
        ActionKind::Force { on, force_n } => (Region::Point(*on), components(force_n)),
        ActionKind::LineForce { on, force_n_per_mm } => (*on, components(force_n_per_mm)),
        ActionKind::EdgeMoment { on, .. } => (Region::Edge(*on), [true; 3]),
        _ => return None,
    };
    let is_moment = matches!(kind, ActionKind::EdgeMoment { .. });
    let carries = |support: &&Support| {
        let held = if is_moment && !is_clamped(&support.hold) { [false; 3] } else { held(&support.hold) };
        lies_on(on, support.on) && (0..3).all(|c| held[c] || !acts[c])
    };
    let support = scene.supports.iter().find(carries)?;
    Some(format!(
        "action \"{name}\" acts on {on}, where support \"{}\" holds the shell and carries all of it: {}",
        support.name,
        exchanged(on)
    ))
}

/// Displacement probes on places that do not move.
fn read_where_held(scene: &Scene) -> impl Iterator<Item = String> {
    scene.probes.iter().filter_map(|probe| {
        let ProbeKind::Displacement { on, component } = probe.kind else { return None };
        let is_still = |support: &&Support| {
            let held = still(&support.hold);
            let is_read = match component {
                Component::X => held[0],
                Component::Y => held[1],
                Component::Z => held[2],
                Component::Magnitude | Component::Normal | Component::Radial => held == [true; 3],
            };
            is_read && lies_on(Region::Point(on), support.on)
        };
        let support = scene.supports.iter().find(is_still)?;
        let on = Region::Point(on);
        Some(format!(
            "probe \"{}\" reads the displacement at {on}, which support \"{}\" keeps at 0: {}",
            probe.name,
            support.name,
            exchanged(on)
        ))
    })
}

/// Whether a place is a part of another.
fn lies_on(place: Region, other: Region) -> bool {
    let [place, other] = [place, other].map(Region::fractions);
    let agrees = |direction: usize| match (place[direction], other[direction]) {
        (_, None) => true,
        (Some(one), Some(other)) => (one - other).abs() <= SAME,
        (None, Some(_)) => false,
    };
    (0..2).all(agrees)
}

/// The components that a force has.
fn components(force: &ForceVector) -> [bool; 3] {
    match force {
        ForceVector::Components(force) => force.map(|component| component != 0.0),
        ForceVector::Along(..) => [true; 3],
    }
}

/// The components of the displacement that a support gives, whatever they are.
fn held(hold: &Hold) -> [bool; 3] {
    match hold {
        Hold::Displacement { displacement_mm } => displacement_mm.map(|given| given.is_some()),
        Hold::Rigid { motions, .. } => [is_given(motions); 3],
        _ => [false; 3],
    }
}

/// The components of the displacement that a support keeps at 0.
fn still(hold: &Hold) -> [bool; 3] {
    match hold {
        Hold::Displacement { displacement_mm } => displacement_mm.map(|given| given == Some(0.0)),
        Hold::Rigid { motions, .. } => [motions.iter().all(|motion| *motion == Motion::Given(0.0)); 3],
        _ => [false; 3],
    }
}

fn is_clamped(hold: &Hold) -> bool {
    matches!(hold, Hold::Rigid { motions, normals_turn: true, .. } if is_given(motions))
}

fn is_given(motions: &[Motion; 6]) -> bool {
    motions.iter().all(|motion| matches!(motion, Motion::Given(_)))
}
