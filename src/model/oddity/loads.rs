//! Loads, accelerations and increments that look odd.

use super::key::key;
use crate::model::size::Size;
use crate::scene::{Action, ActionKind, ForceVector, History, Load, Scene};
use crate::shell::norm;
use crate::units::significant;

/// Membrane strain from which on a load is odd: a structure has long failed.
const MOST_STRAIN: f64 = 0.05;
/// Acceleration from which on weight is odd, m/s²: a hundred times that of the earth.
const MOST_ACCELERATION: f64 = 1000.0;
/// 0 °C, K.
const ZERO_CELSIUS_K: f64 = 273.15;
/// Load steps from which on an increment is odd.
const MOST_STEPS: f64 = 5000.0;

pub(super) fn odd(scene: &Scene, size: &Size) -> Vec<String> {
    let actions = scene.actions.iter().filter_map(|action| of_action(scene, size, action));
    actions.chain(increments(&scene.load)).collect()
}

fn of_action(scene: &Scene, size: &Size, Action { name, kind, history, .. }: &Action) -> Option<String> {
    if let ActionKind::Gravity { acceleration_m_s2 } = kind {
        let acceleration = norm(*acceleration_m_s2);
        return (acceleration > MOST_ACCELERATION).then(|| {
            format!(
                "action \"{name}\" has an acceleration of {} m/s², {} times that of the earth: is it in mm/s²?",
                significant(acceleration, 4),
                significant(acceleration / 9.81, 3)
            )
        });
    }
    if let ActionKind::Temperature { change_k } = kind
        && is_absolute(*change_k)
    {
        return Some(format!(
            "action \"{name}\" has {}, which is {} °C: a change of temperature is meant, not a temperature",
            key("change_k", *change_k),
            significant(change_k - ZERO_CELSIUS_K, 4)
        ));
    }
    let (load, unit, strain) = strain_of(scene, size, kind)?;
    let strain = strain * largest_factor(history, scene.load.target());
    (strain > MOST_STRAIN).then(|| {
        format!(
            "action \"{name}\" has {} {unit} at load factor 1, which would stretch the shell by some {} %: is it in {unit}?",
            significant(load, 4),
            significant(100.0 * strain, 2)
        )
    })
}

/// Whether a change of temperature is a whole number of degrees Celsius above absolute zero.
fn is_absolute(change_k: f64) -> bool {
    let celsius = change_k - ZERO_CELSIUS_K;
    (celsius - celsius.round()).abs() < 1e-6 && celsius > -ZERO_CELSIUS_K
}

/// Size of a load with its unit, and the membrane strain that it causes if nothing but the membrane carries it: a force per length
/// over E t.
fn strain_of(scene: &Scene, size: &Size, kind: &ActionKind) -> Option<(f64, &'static str, f64)> {
    let [_, modulus] = size.moduli_mpa;
    let stiffness = modulus * size.thickness_mm;
    let side = size.sides_mm[0].min(size.sides_mm[1]);
    let radius = size.radius_mm.map_or(side, |radius| radius.min(side));
    let of = |force: &ForceVector| match force {
        ForceVector::Components(force) => norm(*force),
        ForceVector::Along(size, _) => size.abs(),
    };
    Some(match kind {
        ActionKind::Force { force_n, .. } => (of(force_n), "N", of(force_n) / (side * stiffness)),
        ActionKind::LineForce { force_n_per_mm, .. } => (of(force_n_per_mm), "N/mm", of(force_n_per_mm) / stiffness),
        ActionKind::AreaForce { force_n_per_mm2, .. } => {
            (of(force_n_per_mm2), "N/mm²", of(force_n_per_mm2) * radius / stiffness)
        }
        ActionKind::Pressure { pressure_mpa, .. } => {
            (pressure_mpa.abs(), "MPa", pressure_mpa.abs() * radius / stiffness)
        }
        ActionKind::Temperature { change_k } => {
            let strain = crate::shell::thermal_strain(&scene.material).map_or(0.0, |(free, _)| norm(free.membrane));
            (change_k.abs(), "K", strain * change_k.abs())
        }
        _ => return None,
    })
}

/// The largest strain that one of the actions causes on the way to the target; `None` where what one of them does is not
/// estimated.
pub(super) fn largest_strain(scene: &Scene, size: &Size) -> Option<f64> {
    scene.actions.iter().try_fold(0.0, |largest, Action { kind, history, .. }| {
        let strain = match kind {
            ActionKind::EdgeMoment { moment_n, .. } => {
                6.0 * moment_n.abs() / (size.moduli_mpa[1] * size.thickness_mm.powi(2))
            }
            _ => strain_of(scene, size, kind)?.2,
        };
        Some(f64::max(largest, strain * largest_factor(history, scene.load.target())))
    })
}

/// Largest factor of an action on the way to a load factor.
fn largest_factor(history: &History, target: f64) -> f64 {
    history.kinks().chain([target]).map(|at| history.at(at).abs()).fold(0.0, f64::max)
}

fn increments(load: &Load) -> Option<String> {
    let (name, unit) = match load {
        Load::EndRotation(_) => ("load.increment_deg", "°: is it in radians?"),
        Load::Steps(_) => ("load.increment", ""),
    };
    let steps = load.target() / load.longest_increment();
    (steps > MOST_STEPS).then(|| {
        let [steps, target] = [steps, load.target()].map(|value| significant(value, 6));
        format!("{} makes {steps} load steps to {target}{unit}", key(name, load.increment()))
    })
}
