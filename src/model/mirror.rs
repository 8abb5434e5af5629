//! Planes of symmetry: the plane that an edge, or a line inside, lies in, and whether material and loads are their own mirror images there.
//!
//! A mirror image turns the sense of shear: of the stiffnesses A, B and D in axes along and across the plane, those that
//! couple shear with stretch (index pairs 16 and 26) change their sign, and must be zero. The same six follow for either of
//! the two axes.

use crate::model::ModelError;
use crate::model::edge::side;
use crate::model::joint::SMOOTH;
use crate::model::place::parameters_of;
use crate::model::soundness::POSITION;
use crate::model::supports::supports_of;
use crate::model::symmetric_line::Line;
use crate::scene::{
    ActionKind, Edge, ForceVector, Hold, Material, ParametricDirection, Place, Scene, Support, SurfaceDirection,
};
use crate::shell::{add, cross, dot, norm, scaled, shell_stiffness, sub, thermal_strain};
use crate::spline::{Mesh, Spans, SurfacePoint, mid_surface_point};
use crate::units::{place, significant};

/// Angles (rad) between an edge's normal plane and the surface that are rounding of coordinates given to five digits; also
/// the share of a stiffness that turning the axes by as much makes.
pub(super) const ANGLE: f64 = SMOOTH;
/// Deviations below this are rounding of a computation: elimination finds constraints redundant that differ by as little.
const ROUNDING: f64 = 1e-12;

/// An edge, or a line inside, in a plane of symmetry.
#[derive(Clone, Debug)]
pub struct Mirror {
    /// Name of its support.
    pub support: String,
    /// The edge; `None` for a line inside.
    pub edge: Option<Edge>,
    /// The direction (0 or 1) whose parameter is the same all along it.
    pub way: usize,
    /// That parameter.
    pub parameter: f64,
    /// Unit normal of the plane.
    pub normal: [f64; 3],
}

/// Why an edge or a line is no plane of symmetry.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoPlane {
    /// It is not plane.
    #[error(
        "it leaves a plane by {} mm at {at} (up to {} mm, {POSITION} of its size, is taken for rounding)",
        significant(*off_mm, 3),
        significant(*tolerance_mm, 3)
    )]
    NotPlane {
        /// Largest distance from the plane, mm.
        off_mm: f64,
        /// Where.
        at: String,
        /// What is taken for rounding, mm.
        tolerance_mm: f64,
    },
    /// The surface leaves the plane at another angle.
    #[error(
        "the surface crosses its plane at {at} {}° off a right angle (up to {}° is taken for rounding)",
        significant(*off_deg, 3),
        significant(ANGLE.to_degrees(), 2)
    )]
    NotAtRightAngles {
        /// Angle, degrees.
        off_deg: f64,
        /// Where.
        at: String,
    },
    /// The lines of control points leave the plane at another angle.
    #[error(
        "the parametric lines of the surface cross its plane at {at} {}° off a right angle (up to {}° is taken for \
         rounding): put the second row of control points straight behind the first",
        significant(*off_deg, 3),
        significant(ANGLE.to_degrees(), 2)
    )]
    Skewed {
        /// Angle, degrees.
        off_deg: f64,
        /// Where.
        at: String,
    },
    /// The weights across a line inside are shared out differently along it.
    #[error(
        "the weights of the surface change across the line in shares that differ along it, so that no spline keeps its slope: model the half, whose edge lies there"
    )]
    UnevenWeights,
}

impl Mirror {
    /// The planes of symmetry among some supports. Those that meet at right angles within the tolerance do so to rounding, and
    /// so do those along an axis: constraints that differ by less than the coordinates' rounding must not both hold.
    ///
    /// # Errors
    /// Where an edge does not lie in a plane that the surface crosses at right angles.
    pub fn all(scene: &Scene, supports: &[Support], mesh: &Mesh) -> Result<Vec<Self>, ModelError> {
        let mut mirrors: Vec<Self> = Vec::new();
        for support in supports.iter().filter(|support| support.hold == Hold::Symmetric) {
            let found = match support.on {
                Place::Edge(edge) => {
                    let (way, at_end) = side(edge);
                    let parameter = if at_end { 1.0 } else { 0.0 };
                    symmetry_plane(mesh, edge).map(|plane| (Some(edge), way, parameter, plane))
                }
                Place::Line(direction, fraction) => {
                    let way = if direction == ParametricDirection::U { 0 } else { 1 };
                    let parameter = parameters_of(&scene.geometry, [fraction; 2])[way];
                    Line::new(mesh, way, parameter)
                        .and_then(|line| line.normal(mesh))
                        .map(|normal| (None, way, parameter, along_axis(normal)))
                }
                Place::Point(_) | Place::Whole => return Err(ModelError::NotAnEdge { support: support.name.clone() }),
            };
            let (edge, way, parameter, plane) = found.map_err(|reason| ModelError::NotASymmetryPlane {
                support: support.name.clone(),
                reason: reason.to_string(),
            })?;
            let normal = mirrors.iter().fold(plane, |normal, other| square_to(normal, other.normal));
            mirrors.push(Self { support: support.name.clone(), edge, way, parameter, normal });
        }
        Ok(mirrors)
    }

    /// The point of the surface at a parameter along it.
    fn point(&self, mesh: &Mesh, parameter: f64) -> SurfacePoint {
        let at = if self.way == 0 { [self.parameter, parameter] } else { [parameter, self.parameter] };
        mid_surface_point(mesh, &[], at)
    }
}

/// The vector itself, or without its share along another unit vector where that is rounding of coordinates.
fn square_to(vector: [f64; 3], other: [f64; 3]) -> [f64; 3] {
    let share = dot(vector, other);
    if !(ROUNDING..2.0 * ANGLE).contains(&share.abs()) {
        return vector;
    }
    unit(sub(vector, scaled(share, other)))
}

/// The vector itself, or the axis that it differs from by rounding of coordinates.
fn along_axis(vector: [f64; 3]) -> [f64; 3] {
    let largest = (0..3).fold(0, |best, c| if vector[c].abs() > vector[best].abs() { c } else { best });
    let mut axis = [0.0; 3];
    axis[largest] = 1.0_f64.copysign(vector[largest]);
    if (ROUNDING..ANGLE).contains(&norm(sub(vector, axis))) { axis } else { vector }
}

fn unit(vector: [f64; 3]) -> [f64; 3] {
    scaled(1.0 / norm(vector), vector)
}

/// The unit normal of the plane of symmetry that an edge can lie in: the direction from its control points to those of the
/// row beside it.
///
/// # Errors
/// Why it cannot.
pub fn symmetry_plane(mesh: &Mesh, edge: Edge) -> Result<[f64; 3], NoPlane> {
    let (way, at_end) = side(edge);
    let counts = mesh.control_counts();
    let running = counts[1 - way];
    let point = |k: usize, j: usize| {
        let along = if at_end { counts[way] - 1 - k } else { k };
        let [x, y, z, w] = mesh.control_points[if way == 0 { along * counts[1] + j } else { j * counts[1] + along }];
        [x / w, y / w, z / w]
    };
    let points: Vec<[f64; 3]> = (0..running).map(|j| point(0, j)).collect();
    let steps: Vec<[f64; 3]> = (0..running).map(|j| sub(point(1, j), points[j])).collect();
    let off_axis = |normal: [f64; 3], step: [f64; 3]| norm(cross(step, normal)).atan2(dot(step, normal));
    let first = unit(steps[0]);
    let parallel = steps.iter().all(|step| off_axis(first, *step) <= ROUNDING);
    let normal = if parallel { first } else { unit(steps.iter().fold([0.0; 3], |sum, step| add(sum, *step))) };
    let normal = along_axis(normal);

    let origin = scaled(1.0 / running as f64, points.iter().fold([0.0; 3], |sum, point| add(sum, *point)));
    let size = points.iter().map(|point| norm(sub(*point, points[0]))).fold(norm(steps[0]), f64::max);
    let distance = |point: &[f64; 3]| dot(sub(*point, origin), normal).abs();
    let farthest = points.iter().max_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(&points[0]);
    if distance(farthest) > POSITION * size {
        // A plane edge whose surface leaves it at an angle, or no plane at all: the edge alone says which.
        let (off_mm, at) = off_own_plane(&points);
        return Err(match off_mm > POSITION * size {
            true => NoPlane::NotPlane { off_mm, at: place(at), tolerance_mm: POSITION * size },
            false => {
                let along = unit(sub(points[running - 1], points[0]));
                let off_deg = dot(along, normal).abs().asin().to_degrees();
                NoPlane::NotAtRightAngles { off_deg, at: place(points[0]) }
            }
        });
    }
    let skewest = (0..running).map(|j| (off_axis(normal, steps[j]), points[j]));
    let (off, at) = skewest.fold((0.0, points[0]), |worst, one| if one.0 > worst.0 { one } else { worst });
    match off > ANGLE {
        true => Err(NoPlane::Skewed { off_deg: off.to_degrees(), at: place(at) }),
        false => Ok(normal),
    }
}

/// The point that lies farthest from the plane through the two that span most with the first and the last, and how far, mm.
fn off_own_plane(points: &[[f64; 3]]) -> (f64, [f64; 3]) {
    let arms: Vec<[f64; 3]> = points.iter().map(|x| sub(*x, points[0])).collect();
    let last = arms[arms.len() - 1];
    let normal =
        arms.iter().map(|x| cross(*x, last)).fold([0.0; 3], |best, x| if norm(x) > norm(best) { x } else { best });
    let length = norm(normal).max(f64::MIN_POSITIVE);
    let off = arms.iter().zip(points).map(|(arm, point)| (dot(*arm, normal).abs() / length, *point));
    off.fold((0.0, points[0]), |worst, one| if one.0 > worst.0 { one } else { worst })
}

/// Refuses material and loads that are not their own mirror images at the planes of symmetry that a scene asks for.
///
/// # Errors
/// Where one is not, or an edge lies in no plane of symmetry.
pub fn check_mirror_images(scene: &Scene, mesh: &Mesh) -> Result<(), ModelError> {
    for mirror in Mirror::all(scene, &supports_of(scene), mesh)? {
        check_material(&scene.material, mesh, &mirror)?;
        check_loads(scene, &mirror)?;
        check_natural_states(scene, mesh, &mirror)?;
    }
    Ok(())
}

fn check_material(material: &Material, mesh: &Mesh, mirror: &Mirror) -> Result<(), ModelError> {
    if matches!(material, Material::Isotropic { .. }) {
        return Ok(());
    }
    let running = 1 - mirror.way;
    for [from, to] in Spans::of(&mesh.knots[running], mesh.degree[running]).bounds {
        for parameter in [from, 0.5 * (from + to), to] {
            let point = mirror.point(mesh, parameter);
            let tangents = [point.derivatives[0], point.derivatives[1]];
            let terms = shear_coupling(material, tangents, unit(point.derivatives[running]));
            if !terms.is_empty() {
                return Err(ModelError::MaterialNotMirrored {
                    support: mirror.support.clone(),
                    at: place(point.position),
                    terms: terms.join(", "),
                    tolerance: ANGLE,
                });
            }
        }
    }
    Ok(())
}

/// Refuses free strains with shear in axes along and across the plane, which a mirror image turns round.
fn check_natural_states(scene: &Scene, mesh: &Mesh, mirror: &Mirror) -> Result<(), ModelError> {
    let running = 1 - mirror.way;
    for action in &scene.actions {
        let strains = match action.kind {
            ActionKind::Temperature { .. } => {
                thermal_strain(&scene.material).map_or(Vec::new(), |(free, _)| vec![free.membrane, free.bending])
            }
            ActionKind::NaturalCurvature { change_per_mm: [k11, k22, k12] } => vec![[k11, k22, 2.0 * k12]],
            _ => continue,
        };
        for [from, to] in Spans::of(&mesh.knots[running], mesh.degree[running]).bounds {
            for parameter in [from, 0.5 * (from + to), to] {
                let point = mirror.point(mesh, parameter);
                let (e1, along) = (unit(point.derivatives[0]), unit(point.derivatives[running]));
                let normal = unit(cross(point.derivatives[0], point.derivatives[1]));
                let (cos, sin) = (dot(along, e1), dot(along, cross(normal, e1)));
                let shear = |[s11, s22, s12]: [f64; 3]| 2.0 * cos * sin * (s22 - s11) + (cos * cos - sin * sin) * s12;
                let size = |strain: [f64; 3]| strain.iter().map(|s| s.abs()).fold(0.0, f64::max);
                if let Some(strain) = strains.iter().find(|strain| shear(**strain).abs() > 2.0 * ANGLE * size(**strain))
                {
                    return Err(ModelError::LoadNotMirrored {
                        action: action.name.clone(),
                        support: mirror.support.clone(),
                        how: format!("with a free strain of {} in shear along it", significant(shear(*strain), 4)),
                    });
                }
            }
        }
    }
    Ok(())
}

/// The stiffnesses between shear and stretch in axes along a tangent of the surface and across it, where they are more than
/// rounding, in words.
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

/// Refuses what acts on the line itself, or everywhere, and would be undone by its mirror image. A load elsewhere has its image
/// elsewhere.
fn check_loads(scene: &Scene, mirror: &Mirror) -> Result<(), ModelError> {
    let axis = place(mirror.normal);
    let normal = axis.trim_end_matches(" mm");
    let is_on = |on: &Place| match on {
        Place::Edge(edge) => Some(*edge) == mirror.edge,
        Place::Line(direction, fraction) => {
            let way = if *direction == ParametricDirection::U { 0 } else { 1 };
            way == mirror.way && parameters_of(&scene.geometry, [*fraction; 2])[way] == mirror.parameter
        }
        Place::Point(at) => parameters_of(&scene.geometry, *at)[mirror.way] == mirror.parameter,
        Place::Whole => false,
    };
    for action in &scene.actions {
        let across = |force: &ForceVector, unit: &str| match force {
            ForceVector::Components(force) => {
                let share = dot(*force, mirror.normal);
                let off = share.abs() > 2.0 * ANGLE * norm(*force);
                off.then(|| format!("with {} {unit} across it, along {normal}", significant(share, 4)))
            }
            ForceVector::Along(_, SurfaceDirection::Outward) => Some("outward, across its plane".into()),
            // The surface crosses the plane at right angles: its normal lies in it, as does the centre of a symmetric one.
            ForceVector::Along(_, SurfaceDirection::Normal | SurfaceDirection::Radial) => None,
        };
        let how = match &action.kind {
            ActionKind::Force { on, force_n } if is_on(&Place::Point(*on)) => across(force_n, "N"),
            ActionKind::LineForce { on, force_n_per_mm } if is_on(on) => across(force_n_per_mm, "N/mm"),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::starting_mesh;
    use crate::scene::parse;

    #[test]
    fn edges_of_a_tape_spring_lie_in_planes_of_symmetry() {
        let scene = parse(include_str!("../../pipelines/baseline.toml"), "baseline.toml").unwrap();
        let mesh = starting_mesh(&scene).unwrap();
        assert_eq!(symmetry_plane(&mesh, Edge::UEnd).map(|normal| normal.map(f64::abs)), Ok([1.0, 0.0, 0.0]));
        // The free edge of a cylinder lies in its own radial plane.
        assert!(symmetry_plane(&mesh, Edge::VStart).is_ok());
    }

    #[test]
    fn rounding_of_coordinates_is_taken_out_and_no_more() {
        let slanted = unit([1.0, 2e-4, 0.0]);
        assert_eq!(along_axis(slanted), [1.0, 0.0, 0.0]);
        assert_eq!(along_axis(unit([-1.0, 0.0, 3e-3])), unit([-1.0, 0.0, 3e-3]));
        let square = square_to(slanted, unit([3e-4, 1.0, 0.0]));
        assert!(dot(square, unit([3e-4, 1.0, 0.0])).abs() < 1e-15);
        let exact = [1.0, 3e-16, 0.0];
        assert_eq!(along_axis(exact), exact, "bits of exact planes stay");
    }
}
