//! Remarks on what a scene leaves open, and on what its theory and elements leave out.

use std::sync::Arc;

use crate::energy::{At, TermSource, Terms};
use crate::model::{
    ERROR_OF_OFFSET, Extent, FreeStrains, Member, Mirror, ModelError, ROUNDING, THICK, Unknowns, members,
    parameters_of, unjoined_edges,
};
use crate::scene::{Action, ActionKind, ForceVector, Geometry, History, Scene, ShellEdge, SurfaceDirection};
use crate::shell::{FreeStrain, cross, dot, norm, scaled};
use crate::spline::{Mesh, Patch, Spans, mid_surface_point};
use crate::units::{rounded, significant};

/// Offset over radius from which on there is a remark.
const LARGE_OFFSET: f64 = 1e-3;
/// Length of quadratic elements, in sqrt(R t) of the curvature along them, from which on there is a remark. The
/// baseline on 4 across, 4.8 of these, has 384 N·mm at 8° in place of 285, and on 16, 1.2, it is right to 2 %.
const LOCKED: f64 = 2.0;

/// Writes a sentence for each support of rigid motions (what it holds), for each action along the normal (which side
/// that is) or across a plane of symmetry (what its image does), for loads that do nothing, and for what the theory of
/// the shell or its elements leave out.
///
/// # Errors
/// Where loads or planes of symmetry do not fit the mesh.
pub fn remarks(
    scene: &Scene,
    mesh: &Mesh,
    unknowns: &Unknowns,
    own: &[Arc<dyn TermSource>],
) -> Result<Vec<String>, ModelError> {
    let supports = unknowns.supports().held_motions.iter().map(|held| {
        let name = &unknowns.supports().footprints[held.support].name;
        let motions = match held.free.basis.ncols() {
            6 => "all six rigid motions".into(),
            count => format!("{count} of the six rigid motions"),
        };
        format!(
            "support \"{name}\" holds {motions} on the mean of points at thirds of u and v, and carries nothing while the loads \
             are in balance"
        )
    });
    let (mut of_actions, mut images, mut theory) = (Vec::new(), Vec::new(), Vec::new());
    for Member { scene, patch, .. } in members(scene, mesh) {
        of_actions.extend(scene.actions.iter().filter_map(|action| of_action(&scene, patch, action)));
        images.extend(of_images(&scene, patch)?);
        theory.extend(of_thickness(&scene, patch).into_iter().chain(of_degree_2(&scene, patch)));
    }
    let unjoined = unjoined_edges(scene, &members(scene, mesh)).into_iter().map(|edges| {
        let [one, other] = edges.map(|ShellEdge { shell, edge }| {
            format!("\"{}.{}\"", scene.shell_name(shell).unwrap_or_default(), edge.name())
        });
        format!("edges {one} and {other} lie on each other, and nothing connects them: write a [[joint]] if the shells go on there")
    });
    let of_kinds = of_actions.into_iter().chain(images).chain(of_masses(scene));
    let all = supports.chain(unjoined).chain(of_kinds).chain(of_nothing(scene, mesh, unknowns, own)?).chain(theory);
    let mut said: Vec<String> = Vec::new();
    // Shells that are alike would say the same twice.
    all.for_each(|remark| {
        if !said.contains(&remark) {
            said.push(remark)
        }
    });
    Ok(said)
}

/// A remark on masses that weigh nothing.
fn of_masses(scene: &Scene) -> Option<String> {
    let mass = scene.masses.first()?;
    let has_gravity = scene.actions.iter().any(|action| matches!(action.kind, ActionKind::Gravity { .. }));
    (!has_gravity).then(|| {
        let name = &mass.name;
        format!(
            "mass \"{name}\" has no effect: there is no action of kind \"gravity\", and masses have no inertia at rest"
        )
    })
}

/// Remarks on what the theory of thin shells leaves out: a shell that is thick for its radius or its side, and a curved
/// surface off the middle of the thickness.
fn of_thickness(scene: &Scene, patch: &Patch) -> Vec<String> {
    let Extent { radius_mm, side_mm, .. } = Extent::of(patch, &scene.material);
    let (thickness_mm, offset_mm) = (scene.material.thickness_mm(), scene.material.offset_mm());
    let lengths = [("smallest radius of curvature", radius_mm), ("shorter side", side_mm)];
    let thick = lengths.into_iter().filter(|(_, length_mm)| thickness_mm >= THICK * length_mm).map(|(name, length_mm)| {
        format!(
            "the thickness, {} mm, is {} % of the {name}, {} mm: the theory of thin shells, which leaves out shear across the \
             thickness, is meant for thinner ones",
            significant(thickness_mm, 3),
            significant(100.0 * thickness_mm / length_mm, 2),
            significant(length_mm, 3)
        )
    });
    let share = offset_mm.abs() / radius_mm;
    let off = (share > LARGE_OFFSET).then(|| {
        format!(
            "the surface lies {} mm off the middle of the thickness, {} % of its smallest radius: results may be off by {} %, and \
             weight acts on the surface; draw the middle surface with its own radius instead",
            significant(offset_mm, 3),
            significant(100.0 * share, 2),
            significant(100.0 * ERROR_OF_OFFSET * share, 2)
        )
    });
    thick.chain(off).collect()
}

/// Remarks on elements of degree 2 that are long for the curvature along them: a change of curvature stretches them.
fn of_degree_2(scene: &Scene, patch: &Patch) -> Option<String> {
    let thickness = scene.material.thickness_mm();
    let lengths = |direction: usize| {
        let spans = Spans::of(&patch.knots[direction], patch.degree[direction]).bounds;
        spans.into_iter().map(move |[from, to]| {
            let middle = 0.5 * (from + to);
            let point = mid_surface_point(patch, &[], if direction == 0 { [middle, 0.5] } else { [0.5, middle] });
            let [a1, a2, a11, a22, _] = point.derivatives;
            let (tangent, second) = if direction == 0 { (a1, a11) } else { (a2, a22) };
            let normal = cross(a1, a2);
            let curvature = (dot(second, normal) / (norm(normal) * dot(tangent, tangent))).abs();
            ((to - from) * norm(tangent), (thickness / curvature).sqrt())
        })
    };
    let quadratic = (0..2).filter(|direction| patch.degree[*direction] == 2);
    let worst =
        quadratic.flat_map(|direction| lengths(direction).map(move |(length, layer)| (direction, length, layer)));
    let (direction, length, layer) = worst.max_by(|one, other| (one.1 / one.2).total_cmp(&(other.1 / other.2)))?;
    (length > LOCKED * layer).then(|| {
        format!(
            "elements of degree 2 are {} mm long in {}, where {LOCKED} sqrt(R t) is {} mm: they lock, and moments may be too large by \
             half; write a higher mesh.degree, or more elements",
            significant(length, 3),
            ["u", "v"][direction],
            significant(LOCKED * layer, 3)
        )
    })
}

/// Remarks on loads, given motions and free strains that are zero throughout, or that act where the shell is held.
fn of_nothing(
    scene: &Scene,
    mesh: &Mesh,
    unknowns: &Unknowns,
    own: &[Arc<dyn TermSource>],
) -> Result<Option<String>, ModelError> {
    let loads = Terms::on(scene, mesh, own)?;
    let free_strains: Vec<FreeStrains> =
        members(scene, mesh).iter().map(|member| FreeStrains::new(&member.scene, member.patch)).collect();
    let still = vec![[0.0; 3]; mesh.point_count()];
    let histories = scene.actions.iter().map(|action| &action.history);
    let kinks = histories.chain(scene.supports.iter().map(|support| &support.history)).flat_map(History::kinks);
    let mut loaded = false;
    for load_factor in kinks.chain([scene.load.target()]) {
        let moves = unknowns.given_at(load_factor).iter().any(|value| *value != 0.0);
        let natural = free_strains.iter().filter_map(|strains| strains.at(load_factor));
        let strained = natural.into_iter().any(|state| state.strain != FreeStrain::default());
        let forces = loads.forces(At { mesh, displacement: &still, parameter: load_factor });
        let all: f64 = forces.iter().map(|force| norm(*force)).sum();
        let placement = unknowns.configure(&vec![0.0; unknowns.count()], load_factor);
        let pushes = placement.restrict(&forces).iter().any(|force| force.abs() > ROUNDING * all);
        if moves || strained || pushes {
            return Ok(None);
        }
        loaded |= all > 0.0;
    }
    let why = match loaded {
        true => "all loads act on places that supports hold, which carry them directly",
        false => "all loads, given motions and free strains are zero",
    };
    Ok(Some(format!("nothing acts on the shell, and it will stay as it is: {why}")))
}

/// Remarks on forces across a plane of symmetry away from its edge: the mirrored shell is pulled in the opposite
/// direction.
fn of_images(scene: &Scene, patch: &Patch) -> Result<Vec<String>, ModelError> {
    let mirrors = Mirror::all(scene, &scene.supports, patch)?;
    let of = |Action { name, kind, .. }: &Action| {
        let (force, unit) = match kind {
            ActionKind::Force { force_n: ForceVector::Components(force), .. } => (force, "N"),
            ActionKind::LineForce { force_n_per_mm: ForceVector::Components(force), .. } => (force, "N/mm"),
            _ => return None,
        };
        let edges = mirrors.iter().filter(|mirror| mirror.edge.is_some());
        let (mirror, share) = edges.filter_map(|mirror| Some((mirror, mirror.share_across(*force)?))).next()?;
        Some(format!(
            "action \"{name}\" has {} {unit} across the plane of symmetry of support \"{}\": its image behind that pulls in the opposite direction",
            significant(share.abs(), 4),
            mirror.support
        ))
    };
    Ok(scene.actions.iter().filter_map(of).collect())
}

fn of_action(scene: &Scene, patch: &Patch, Action { name, kind, .. }: &Action) -> Option<String> {
    let sense = match kind {
        ActionKind::Pressure { pressure_mpa, follower } => {
            let how = if *follower {
                "and turns with the shell"
            } else {
                "keeps that direction and acts on the undeformed area"
            };
            return Some(format!("action \"{name}\" pushes {}, {how}", side(scene, patch, *pressure_mpa)));
        }
        ActionKind::Force { force_n: ForceVector::Along(size, SurfaceDirection::Normal), .. } => *size,
        ActionKind::LineForce { force_n_per_mm: ForceVector::Along(size, SurfaceDirection::Normal), .. } => *size,
        ActionKind::AreaForce { force_n_per_mm2: ForceVector::Along(size, SurfaceDirection::Normal), .. } => *size,
        _ => return None,
    };
    Some(format!("action \"{name}\" pushes {}, and keeps that direction", side(scene, patch, sense)))
}

/// Says in words where a load of this sign along the normal pushes the undeformed shell.
fn side(scene: &Scene, patch: &Patch, sense: f64) -> String {
    let out = sense >= 0.0;
    let which = |one: &str, other: &str| if out { one.to_owned() } else { other.to_owned() };
    match &scene.geometry {
        Geometry::Plate { .. } | Geometry::Annulus { .. } => which("towards +z", "towards −z"),
        Geometry::TapeSpring { .. } | Geometry::CylinderPanel { .. } => which("away from the axis", "towards the axis"),
        Geometry::SphereZone { .. } => which("away from the centre", "towards the centre"),
        Geometry::Profile { .. } | Geometry::Nurbs(_) => {
            let middle = mid_surface_point(patch, &[], parameters_of(&scene.geometry, [0.5; 2]));
            let normal = cross(middle.derivatives[0], middle.derivatives[1]);
            let unit = scaled(if out { 1.0 } else { -1.0 } / norm(normal), normal).map(rounded);
            format!("along ({}, {}, {}) at u 0.5, v 0.5", unit[0], unit[1], unit[2])
        }
    }
}
