//! What the words of a scene come to where they leave it open.

use crate::model::Unknowns;
use crate::model::place::parameters_of;
use crate::scene::{Action, ActionKind, ForceVector, Geometry, Scene, SurfaceDirection};
use crate::shell::{PointReference, cross, dot, norm, scaled};
use crate::spline::{Mesh, Spans, mid_surface_point};
use crate::units::{rounded, significant};

/// Offset over radius from which on it is said. A tube under pressure on a surface t/2 off is 1.5 offset/R off.
const LARGE_OFFSET: f64 = 5e-3;
/// Length of quadratic elements, in sqrt(R t) of the curvature along them, from which on it is said. The baseline on 4 across,
/// 4.8 of these, has 384 N·mm at 8° in place of 285, and on 16, 1.2, it is right to 2 %.
const LOCKED: f64 = 2.0;

/// A sentence for each support of rigid motions (what it holds), for each action along the normal (which side that is), and for
/// what the shell's theory or its elements leave out from the start.
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
    supports.chain(actions).chain(of_offset(scene, mesh)).chain(of_degree_2(scene, mesh)).collect()
}

/// A surface off the middle of the thickness whose radius is not far larger: the shell's theory leaves z/R out.
fn of_offset(scene: &Scene, mesh: &Mesh) -> Option<String> {
    let offset_mm = scene.material.offset_mm();
    let curvature = |sample: usize| {
        let at = [(sample % 5) as f64 / 4.0, (sample / 5) as f64 / 4.0];
        let derivatives = mid_surface_point(mesh, &[], at).derivatives;
        PointReference::new(derivatives, &scene.material, 1.0).largest_curvature()
    };
    let share = offset_mm.abs() * (0..25).map(curvature).fold(0.0, f64::max);
    (share > LARGE_OFFSET).then(|| {
        format!(
            "the surface lies {} mm off the middle of the thickness, {} % of its smallest radius: results may be off by as much and \
             half again, and weight acts on the surface; draw the middle surface instead",
            significant(offset_mm, 3),
            significant(100.0 * share, 2)
        )
    })
}

/// Elements of degree 2 that are long for the curvature along them: a change of curvature stretches them.
fn of_degree_2(scene: &Scene, mesh: &Mesh) -> Option<String> {
    let thickness = scene.material.thickness_mm();
    let lengths = |way: usize| {
        let spans = Spans::of(&mesh.knots[way], mesh.degree[way]).bounds;
        spans.into_iter().map(move |[from, to]| {
            let middle = 0.5 * (from + to);
            let point = mid_surface_point(mesh, &[], if way == 0 { [middle, 0.5] } else { [0.5, middle] });
            let [a1, a2, a11, a22, _] = point.derivatives;
            let (tangent, second) = if way == 0 { (a1, a11) } else { (a2, a22) };
            let normal = cross(a1, a2);
            let curvature = (dot(second, normal) / (norm(normal) * dot(tangent, tangent))).abs();
            ((to - from) * norm(tangent), (thickness / curvature).sqrt())
        })
    };
    let quadratic = (0..2).filter(|way| mesh.degree[*way] == 2);
    let worst = quadratic.flat_map(|way| lengths(way).map(move |(length, layer)| (way, length, layer)));
    let (way, length, layer) = worst.max_by(|one, other| (one.1 / one.2).total_cmp(&(other.1 / other.2)))?;
    (length > LOCKED * layer).then(|| {
        format!(
            "elements of degree 2 are {} mm long in {}, where {LOCKED} sqrt(R t) is {} mm: they lock, and moments may be too large by \
             half; write a higher mesh.degree, or more elements",
            significant(length, 3),
            ["u", "v"][way],
            significant(LOCKED * layer, 3)
        )
    })
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
