//! How far the loads of a scene move the shell.

use super::key::key;
use super::loads;
use crate::model::size::Size;
use crate::scene::{Hold, Motion, NumbersIn, Scene};
use crate::units::significant;

/// Displacement over thickness up to which a shell that bends shows nothing, and membrane strain up to which one that stretches
/// shows nothing; where both are less, the loads are a thousandth of those that were meant. The shipped scenes of several load steps
/// have at least 0.38 of the one; a sphere under pressure, which stretches, may move by 0.0065 of its thickness and is meant so.
const STILL: f64 = 0.05;
const STILL_STRAIN: f64 = 1e-5;
/// Displacement by linear theory over the largest extent from which on loads are odd. A ring under a following pressure has 20, a
/// strip that is rolled up 3.
const FAR: f64 = 500.0;
/// Angles that are round in radians, degrees.
const ROUND_DEG: [f64; 6] = [30.0, 45.0, 60.0, 90.0, 180.0, 360.0];

/// Whether it can be said of a scene how far its loads move the shell: by several load steps, none of which moves a support.
///
/// A single load step is a linear solve, which many do at loads so small that nothing else shows.
pub fn is_driven_by_loads(scene: &Scene) -> bool {
    let steps = scene.load.target() / scene.load.longest_increment();
    scene.output.units == NumbersIn::Keys
        && scene.end_rotation().is_none()
        && !scene.actions.is_empty()
        && steps > 1.5
        && scene.supports.iter().all(|support| !moves(&support.hold))
}

/// Writes a sentence where the loads of a scene hardly move its shell, or throw it far off; `motion_mm` is how far they move it
/// at most by linear theory.
pub fn odd_motion(scene: &Scene, size: &Size, motion_mm: f64) -> Option<String> {
    let shown = |value: f64| significant(value, 2);
    let [thickness, extent] = [motion_mm / size.thickness_mm, motion_mm / size.largest_mm()];
    if thickness < STILL && loads::largest_strain(scene, size).is_some_and(|strain| strain < STILL_STRAIN) {
        return Some(format!(
            "all loads together move the shell by {} mm by linear theory, {} of its thickness: are forces in N, lengths in mm, and \
             pressures and moduli in MPa?",
            shown(motion_mm),
            shown(thickness)
        ));
    }
    (extent > FAR).then(|| {
        format!(
            "all loads together would move the shell by {} mm by linear theory, {} times its largest extent: are forces in N, \
             lengths and thickness in mm, and pressures and moduli in MPa?",
            shown(motion_mm),
            shown(extent)
        )
    })
}

/// Rotations of supports that are round in radians.
pub(super) fn odd_rotations(scene: &Scene) -> Option<String> {
    let in_radians = |angle: f64| ROUND_DEG.into_iter().find(|round| (angle.abs() - round.to_radians()).abs() < 2e-3);
    let of = |name: String, angle: f64| {
        let round = in_radians(angle)?;
        Some(format!("{} is in degrees: in radians that would be {}", key(&name, angle), round.copysign(angle)))
    };
    if let Some(load) = scene.end_rotation() {
        return of("load.rotation_deg".to_owned(), load.rotation_deg);
    }
    scene.supports.iter().find_map(|support| {
        let Hold::Rigid { motions, .. } = &support.hold else { return None };
        let given = motions[3..].iter().zip(["x", "y", "z"]);
        given.into_iter().find_map(|(motion, axis)| match motion {
            Motion::Given(angle) => of(format!("the turn of support \"{}\" about {axis}", support.name), *angle),
            Motion::Free(_) => None,
        })
    })
}

fn moves(hold: &Hold) -> bool {
    match hold {
        Hold::Displacement { displacement_mm } => displacement_mm.iter().flatten().any(|given| *given != 0.0),
        Hold::Rigid { motions, .. } => {
            motions.iter().any(|motion| matches!(motion, Motion::Given(value) if *value != 0.0))
        }
        Hold::Symmetric | Hold::RigidMotions => false,
    }
}
