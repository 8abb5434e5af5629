//! What the words of a scene come to where they leave it open.

use crate::model::Unknowns;
use crate::model::place::parameters_of;
use crate::scene::{Action, ActionKind, ForceVector, Geometry, Scene, SurfaceDirection};
use crate::shell::{cross, norm, scaled};
use crate::spline::{Mesh, mid_surface_point};
use crate::units::rounded;

/// A sentence for each support of rigid motions (what it holds) and for each action along the normal (which side that is).
pub fn remarks(scene: &Scene, mesh: &Mesh, unknowns: &Unknowns) -> Vec<String> {
    let supports = unknowns.supports().held_motions.iter().map(|held| {
        let name = &unknowns.supports().traces[held.support].name;
        let motions = match held.free.basis.ncols() {
            6 => "all six rigid motions".into(),
            count => format!("{count} of the six rigid motions"),
        };
        format!(
            "support \"{name}\" holds {motions} on the mean of points at thirds of u and v, and carries nothing while the loads \
             are in balance"
        )
    });
    let actions = scene.actions.iter().filter_map(|action| of_action(scene, mesh, action));
    supports.chain(actions).collect()
}

fn of_action(scene: &Scene, mesh: &Mesh, Action { name, kind, .. }: &Action) -> Option<String> {
    let sense = match kind {
        ActionKind::Pressure { pressure_mpa, follower } => {
            let how = if *follower {
                "and turns with the shell"
            } else {
                "keeps that direction and acts on the undeformed area"
            };
            return Some(format!("action \"{name}\" pushes {}, {how}", side(scene, mesh, *pressure_mpa)));
        }
        ActionKind::Force { force_n: ForceVector::Along(size, SurfaceDirection::Normal), .. } => *size,
        ActionKind::LineForce { force_n_per_mm: ForceVector::Along(size, SurfaceDirection::Normal), .. } => *size,
        ActionKind::AreaForce { force_n_per_mm2: ForceVector::Along(size, SurfaceDirection::Normal), .. } => *size,
        _ => return None,
    };
    Some(format!("action \"{name}\" pushes {}, and keeps that direction", side(scene, mesh, sense)))
}

/// Where a load of this sign along the normal pushes the undeformed shell.
fn side(scene: &Scene, mesh: &Mesh, sense: f64) -> String {
    let out = sense >= 0.0;
    let which = |one: &str, other: &str| if out { one.to_owned() } else { other.to_owned() };
    match &scene.geometry {
        Geometry::Plate { .. } | Geometry::Annulus { .. } => which("towards +z", "towards −z"),
        Geometry::TapeSpring { .. } | Geometry::CylinderPanel { .. } => which("away from the axis", "towards the axis"),
        Geometry::SphereZone { .. } => which("away from the centre", "towards the centre"),
        Geometry::Nurbs(_) => {
            let middle = mid_surface_point(mesh, &[], parameters_of(&scene.geometry, [0.5; 2]));
            let normal = cross(middle.derivatives[0], middle.derivatives[1]);
            let unit = scaled(if out { 1.0 } else { -1.0 } / norm(normal), normal).map(rounded);
            format!("along ({}, {}, {}) at u 0.5, v 0.5", unit[0], unit[1], unit[2])
        }
    }
}
