//! Whether material and loads are their own mirror images at the planes of symmetry that a scene asks for.
//!
//! A mirror image turns the sense of shear: of the stiffnesses A, B and D in axes along and across the plane, those that
//! couple shear with stretch (index pairs 16 and 26) change their sign, and must be zero. The same six follow for either of
//! the two axes.

use crate::model::ModelError;
use crate::model::edge::side;
use crate::model::limits::ANGLE;
use crate::model::mirror::Mirror;
use crate::model::mirror_image::check_own_image;
use crate::model::parametrize::parameters_of;
use crate::model::scene_supports::supports_of;
use crate::model::symmetry_plane::unit;
use crate::scene::{ActionKind, ForceVector, Material, Region, Scene, SurfaceDirection};
use crate::shell::{cross, dot, shell_stiffness, thermal_strain, unit_normal};
use crate::spline::Patch;
use crate::units::{place, significant};

/// Refuses material and loads that are not their own mirror images at the planes of symmetry that a scene asks for.
///
/// # Errors
/// Where material or loads are not, or an edge lies in no plane of symmetry.
pub fn check_mirror_images(scene: &Scene, mesh: &Patch) -> Result<(), ModelError> {
    for mirror in Mirror::all(scene, &supports_of(scene), mesh)? {
        check_material(&scene.material, mesh, &mirror)?;
        check_loads(scene, &mirror)?;
        check_natural_states(scene, mesh, &mirror)?;
        if mirror.edge.is_none() {
            check_own_image(scene, mesh, &mirror)?;
        }
    }
    Ok(())
}

fn check_material(material: &Material, mesh: &Patch, mirror: &Mirror) -> Result<(), ModelError> {
    if matches!(material, Material::Isotropic { .. }) {
        return Ok(());
    }
    for point in mirror.samples(mesh) {
        let tangents = [point.derivatives[0], point.derivatives[1]];
        let terms = shear_coupling(material, tangents, unit(point.derivatives[1 - mirror.direction]));
        if !terms.is_empty() {
            return Err(ModelError::MaterialNotMirrored {
                support: mirror.support.clone(),
                at: place(point.position),
                terms: terms.join(", "),
                tolerance: ANGLE,
            });
        }
    }
    Ok(())
}

/// Refuses free strains with shear in axes along and across the plane, which a mirror image turns round.
fn check_natural_states(scene: &Scene, mesh: &Patch, mirror: &Mirror) -> Result<(), ModelError> {
    let points = mirror.samples(mesh);
    for action in &scene.actions {
        let strains = match action.kind {
            ActionKind::Temperature { .. } => {
                thermal_strain(&scene.material).map_or(Vec::new(), |(free, _)| vec![free.membrane, free.bending])
            }
            ActionKind::NaturalCurvature { change_per_mm: [k11, k22, k12] } => vec![[k11, k22, 2.0 * k12]],
            _ => continue,
        };
        for point in &points {
            let (e1, along) = (unit(point.derivatives[0]), unit(point.derivatives[1 - mirror.direction]));
            let normal = unit_normal([point.derivatives[0], point.derivatives[1]]);
            let (cos, sin) = (dot(along, e1), dot(along, cross(normal, e1)));
            let shear = |[s11, s22, s12]: [f64; 3]| 2.0 * cos * sin * (s22 - s11) + (cos * cos - sin * sin) * s12;
            let size = |strain: [f64; 3]| strain.iter().map(|s| s.abs()).fold(0.0, f64::max);
            if let Some(strain) = strains.iter().find(|strain| shear(**strain).abs() > 2.0 * ANGLE * size(**strain)) {
                return Err(ModelError::LoadNotMirrored {
                    action: action.name.clone(),
                    support: mirror.support.clone(),
                    how: format!("with a free strain of {} in shear along it", significant(shear(*strain), 4)),
                });
            }
        }
    }
    Ok(())
}

/// Describes the stiffnesses between shear and stretch, in axes along a tangent of the surface and across it, that are
/// more than rounding.
fn shear_coupling(material: &Material, [a1, a2]: [[f64; 3]; 2], tangent: [f64; 3]) -> Vec<String> {
    let across = cross(unit(cross(a1, a2)), tangent);
    // Covariant strains (11, 22, 2·12) from those in the axes: ε_αβ = ε_ij (A_α·e_i)(A_β·e_j).
    let [p, q] = [a1, a2].map(|tangent_of| [dot(tangent_of, tangent), dot(tangent_of, across)]);
    let map = [
        [p[0] * p[0], p[1] * p[1], p[0] * p[1]],
        [q[0] * q[0], q[1] * q[1], q[0] * q[1]],
        [2.0 * p[0] * q[0], 2.0 * p[1] * q[1], p[0] * q[1] + p[1] * q[0]],
    ];
    let in_axes = |stiffness: &[[f64; 3]; 3], i: usize, j: usize| -> f64 {
        (0..3).map(|k| (0..3).map(|l| map[k][i] * stiffness[k][l] * map[l][j]).sum::<f64>()).sum()
    };
    let stiffness = shell_stiffness(material, [a1, a2]);
    let largest = |of: &[[f64; 3]; 3]| in_axes(of, 0, 0).max(in_axes(of, 1, 1));
    let (membrane, bending) = (largest(&stiffness.membrane), largest(&stiffness.bending));
    let coupling = stiffness.coupling.unwrap_or_default();
    let all = [
        ("A", &stiffness.membrane, membrane, "N/mm"),
        ("B", &coupling, (membrane * bending).sqrt(), "N"),
        ("D", &stiffness.bending, bending, "N·mm"),
    ];
    all.iter()
        .flat_map(|(name, matrix, scale, unit)| [0, 1].map(|i| (name, i, in_axes(matrix, i, 2), *scale, unit)))
        .filter(|(_, _, value, scale, _)| value.abs() > ANGLE * scale)
        .map(|(name, i, value, _, unit)| format!("{name}{}6 = {} {unit}", i + 1, significant(value, 4)))
        .collect()
}

/// Refuses what acts on the line itself, on a line that meets it, or everywhere, and would be undone by its mirror image. Behind
/// an edge the image of a load elsewhere is not modelled; behind a line inside it is ([`check_own_image`]).
fn check_loads(scene: &Scene, mirror: &Mirror) -> Result<(), ModelError> {
    let axis = place(mirror.normal);
    let normal = axis.trim_end_matches(" mm");
    let is_on = |on: &Region| match on {
        Region::Edge(edge) => Some(*edge) == mirror.edge,
        Region::Line(direction, fraction) => {
            let direction = direction.index();
            direction == mirror.direction && mirror.is_at(parameters_of(&scene.geometry, [*fraction; 2])[direction])
        }
        Region::Point(at) => mirror.is_at(parameters_of(&scene.geometry, *at)[mirror.direction]),
        Region::Whole => false,
    };
    // A line in the other direction meets the plane in a point.
    let meets = |on: &Region| match on {
        Region::Edge(edge) => side(*edge).0 != mirror.direction,
        Region::Line(direction, _) => direction.index() != mirror.direction,
        Region::Point(_) | Region::Whole => false,
    };
    for action in &scene.actions {
        let across = |force: &ForceVector, unit: &str| match force {
            ForceVector::Components(force) => mirror
                .share_across(*force)
                .map(|share| format!("with {} {unit} across it, along {normal}", significant(share, 4))),
            ForceVector::Along(_, SurfaceDirection::Outward) => Some("outward, across its plane".into()),
            // The surface crosses the plane at right angles: its normal lies in it, as does the centre of a symmetric one.
            ForceVector::Along(_, SurfaceDirection::Normal | SurfaceDirection::Radial) => None,
        };
        let how = match &action.kind {
            ActionKind::Force { on, force_n } if is_on(&Region::Point(*on)) => across(force_n, "N"),
            ActionKind::LineForce { on, force_n_per_mm } if is_on(on) => across(force_n_per_mm, "N/mm"),
            // Outward of such a line lies in the plane, as its line crosses that at right angles.
            ActionKind::LineForce { on, force_n_per_mm: force @ ForceVector::Components(_) } if meets(on) => {
                across(force, "N/mm").map(|how| format!("where its line meets it, {how}"))
            }
            ActionKind::AreaForce { force_n_per_mm2, .. } => across(force_n_per_mm2, "N/mm²"),
            ActionKind::Gravity { acceleration_m_s2 } => across(&ForceVector::Components(*acceleration_m_s2), "m/s²"),
            ActionKind::EdgeMoment { on, .. } if Some(*on) == mirror.edge => Some("as a moment about its edge".into()),
            _ => None,
        };
        if let Some(how) = how {
            return Err(ModelError::LoadNotMirrored {
                action: action.name.clone(),
                support: mirror.support.clone(),
                how,
            });
        }
    }
    Ok(())
}
