//! The mid-surface of a scene as an exact NURBS surface in its fewest elements.

use crate::model::ModelError;
use crate::model::joint::smoothed;
use crate::model::profile::profile_curve;
use crate::model::soundness::{check_normals, check_seam, closed_directions};
use crate::scene::{Geometry, NurbsPatch, Scene, Seam};
use crate::spline::{
    Grid, HomogeneousCurve, Patch, circular_arc, collocation, control_count, greville_points, straight_line,
};

/// A surface, and the number of elements that the scene asks for.
pub(super) struct Shape {
    /// Exact surface in its fewest elements, with the degree of the scene's mesh.
    pub mesh: Patch,
    /// Number of elements of the model in each direction.
    pub elements: [usize; 2],
}

/// Builds the surface of a scene. A tape spring with turning ends spans x in [0, L] and the arc angle φ in [−α/2, α/2]
/// from the apex; its half-length model x in [0, L/2], its half-arc model φ in [0, α/2].
///
/// # Errors
/// Where the degree of the mesh is below that of the surface, or the surface is not one that a shell can have.
pub(super) fn shape(scene: &Scene) -> Result<Shape, ModelError> {
    let [p, q] = scene.mesh.degree;
    let elements = scene.mesh.elements;
    let mesh = match &scene.geometry {
        Geometry::TapeSpring { length_mm, radius_mm, arc_deg } => {
            return Ok(tape_spring(scene, *length_mm, *radius_mm, *arc_deg));
        }
        Geometry::CylinderPanel { length_mm, radius_mm, arc_deg, from_deg, .. } => {
            let [from, to] = arc(*arc_deg, *from_deg, -arc_deg / 2.0);
            translated(&straight_line(*length_mm, p), &circular_arc(*radius_mm, from, to, q))
        }
        Geometry::Plate { length_mm, width_mm } => {
            product(&straight_line(*length_mm, p), &straight_line(*width_mm, q), |u, v| {
                [u[0] * v[2], v[0] * u[2], 0.0, u[2] * v[2]]
            })
        }
        Geometry::Annulus { inner_radius_mm, outer_radius_mm, arc_deg, from_deg, .. } => {
            let mut radius = straight_line(outer_radius_mm - inner_radius_mm, p);
            radius.points.iter_mut().for_each(|point| point[0] += inner_radius_mm * point[2]);
            // The arc runs from the second axis towards the first: (sin, cos) at its angle.
            let [from, to] = arc(*arc_deg, *from_deg, 0.0);
            product(&radius, &circular_arc(1.0, from, to, q), |r, turn| {
                [r[0] * turn[1], r[0] * turn[0], 0.0, r[2] * turn[2]]
            })
        }
        Geometry::SphereZone { radius_mm, latitude_deg: [south, north], arc_deg, from_deg, .. } => {
            let profile = circular_arc(*radius_mm, south.to_radians(), north.to_radians(), q);
            let [from, to] = arc(*arc_deg, *from_deg, 0.0);
            product(&circular_arc(1.0, from, to, p), &profile, |turn, profile| {
                [profile[1] * turn[1], profile[1] * turn[0], profile[0] * turn[2], profile[2] * turn[2]]
            })
        }
        Geometry::Profile { length_mm, profile, start_mm, direction_deg } => {
            let across = profile_curve(profile, *start_mm, *direction_deg, q);
            smoothed(translated(&straight_line(*length_mm, p), &across), [false; 2])?
        }
        Geometry::Nurbs(patch) => nurbs(patch, scene.mesh.degree)?,
    };
    Ok(Shape { mesh, elements })
}

/// Angles at which an arc starts and ends, radians.
fn arc(arc_deg: f64, from_deg: Option<f64>, default_deg: f64) -> [f64; 2] {
    let from = from_deg.unwrap_or(default_deg);
    [from.to_radians(), (from + arc_deg).to_radians()]
}

fn tape_spring(scene: &Scene, length_mm: f64, radius_mm: f64, arc_deg: f64) -> Shape {
    let [degree, arc_degree] = scene.mesh.degree;
    let [half_length, half_arc] = scene.symmetry.cuts();
    let length = if half_length { length_mm / 2.0 } else { length_mm };
    let half = arc_deg.to_radians() / 2.0;
    let from = if half_arc { 0.0 } else { -half };
    let divide = |whole: usize, halved: bool| if halved { whole.div_ceil(2) } else { whole };
    let elements = [divide(scene.mesh.elements[0], half_length), divide(scene.mesh.elements[1], half_arc)];
    let mesh = translated(&straight_line(length, degree), &circular_arc(radius_mm, from, half, arc_degree));
    Shape { mesh, elements }
}

/// Builds the cylinder over `across` (in the y–z plane) along `along` (x).
fn translated(along: &HomogeneousCurve, across: &HomogeneousCurve) -> Patch {
    product(along, across, |[x, _, _], [y, z, w]| [x * w, *y, *z, *w])
}

/// Combines the control points of two curves, u slow.
fn product(u: &HomogeneousCurve, v: &HomogeneousCurve, point: impl Fn(&[f64; 3], &[f64; 3]) -> [f64; 4]) -> Patch {
    let control_points =
        u.points.iter().flat_map(|a| v.points.iter().map(|b| point(a, b)).collect::<Vec<_>>()).collect();
    Patch { degree: [u.degree, v.degree], knots: [u.knots.clone(), v.knots.clone()], control_points }
}

/// Builds the user's patch on [0, 1]², raised to the degree of the mesh and smooth up to rounding.
fn nurbs(patch: &NurbsPatch, degree: [usize; 2]) -> Result<Patch, ModelError> {
    let mesh = sound(patch, degree).map_err(|fault| match fault {
        ModelError::DegreeTooLow { .. } => fault,
        _ if sound(&listed_the_other_way(patch), degree).is_ok() => {
            ModelError::ListedUFastest { fault: Box::new(fault) }
        }
        _ => fault,
    })?;
    check_seam(&mesh, patch.seam)?;
    Ok(mesh)
}

/// Builds the surface of a patch, where a shell can have it.
fn sound(patch: &NurbsPatch, degree: [usize; 2]) -> Result<Patch, ModelError> {
    let mesh = raised_to(patch, degree)?;
    let closed = closed_directions(&mesh).map(|closed| closed && patch.seam == Some(Seam::Smooth));
    let mesh = smoothed(mesh, closed)?;
    check_normals(&mesh)?;
    Ok(mesh)
}

/// Returns the patch whose points are listed with u running fastest.
fn listed_the_other_way(patch: &NurbsPatch) -> NurbsPatch {
    let [along, across] = [(&patch.knots_u, patch.degrees[0]), (&patch.knots_v, patch.degrees[1])]
        .map(|(knots, degree)| control_count(knots, degree));
    let listed = Grid::new([across, along]);
    NurbsPatch {
        control_points_mm: listed.first_fastest().map(|k| patch.control_points_mm[k]).collect(),
        weights: listed.first_fastest().map(|k| patch.weights[k]).collect(),
        ..patch.clone()
    }
}

fn raised_to(patch: &NurbsPatch, degree: [usize; 2]) -> Result<Patch, ModelError> {
    let unit = |knots: &[f64]| {
        let (first, last) = (knots[0], knots[knots.len() - 1]);
        knots.iter().map(|knot| (knot - first) / (last - first)).collect::<Vec<f64>>()
    };
    let weighted = patch.control_points_mm.iter().zip(&patch.weights).map(|([x, y, z], w)| [x * w, y * w, z * w, *w]);
    let mut mesh = Patch {
        degree: patch.degrees,
        knots: [unit(&patch.knots_u), unit(&patch.knots_v)],
        control_points: weighted.collect(),
    };
    for direction in 0..2 {
        if degree[direction] < mesh.degree[direction] {
            return Err(ModelError::DegreeTooLow { geometry: mesh.degree[direction], mesh: degree[direction] });
        }
        while mesh.degree[direction] < degree[direction] {
            mesh = raised(&mesh, direction);
        }
    }
    Ok(mesh)
}

/// Raises the degree of a surface in one direction by one: the space in which every distinct knot has one more
/// multiplicity contains it, so interpolating at the Greville points is exact.
fn raised(mesh: &Patch, direction: usize) -> Patch {
    let old = &mesh.knots[direction];
    let mut knots = Vec::with_capacity(2 * old.len());
    for (index, knot) in old.iter().enumerate() {
        knots.push(*knot);
        if old.get(index + 1) != Some(knot) {
            knots.push(*knot);
        }
    }
    let degree = mesh.degree[direction] + 1;
    let count = control_count(&knots, degree);
    let greville = greville_points(&knots, degree);
    let counts = mesh.control_counts();
    let values = collocation(old, mesh.degree[direction], &greville);
    let square = collocation(&knots, degree, &greville);
    // Nonsingular by Schoenberg and Whitney: each Greville point lies inside the support of its function.
    let map = square.lu().solve(&values).unwrap_or(values);
    let across = counts[1 - direction];
    let mut new_counts = counts;
    new_counts[direction] = count;
    let index = |counts: [usize; 2], along: usize, j: usize| Grid::new(counts).index_along(direction, along, j);
    let mut control_points = vec![[0.0; 4]; count * across];
    for j in 0..across {
        for row in 0..count {
            let target = &mut control_points[index(new_counts, row, j)];
            for column in 0..counts[direction] {
                let source = mesh.control_points[index(counts, column, j)];
                (0..4).for_each(|c| target[c] += map[(row, column)] * source[c]);
            }
        }
    }
    let mut raised = Patch { degree: mesh.degree, knots: mesh.knots.clone(), control_points };
    raised.degree[direction] = degree;
    raised.knots[direction] = knots;
    raised
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::starting_patch;
    use crate::scene::parse;
    use crate::shell::{cross, dot, norm};
    use crate::spline::mid_surface_point;

    fn meshed(geometry: Geometry, degree: [usize; 2]) -> Patch {
        let mut scene = parse(include_str!("../../pipelines/verification/rolled-cantilever.toml"), "x.toml").unwrap();
        scene.geometry = geometry;
        scene.mesh.degree = degree;
        scene.mesh.elements = [3, 5];
        starting_patch(&scene).unwrap()
    }

    /// Every sampled point is on the surface, and the normal points where it should.
    fn check(mesh: &Patch, on_surface: impl Fn([f64; 3]) -> f64, normal: impl Fn([f64; 3]) -> [f64; 3]) {
        for sample in 0..100 {
            let at = [(sample % 10) as f64 / 9.0, (sample / 10) as f64 / 9.0];
            let point = mid_surface_point(mesh, &[], at);
            assert!(on_surface(point.position).abs() < 1e-11, "{at:?}: {}", on_surface(point.position));
            let found = cross(point.derivatives[0], point.derivatives[1]);
            let expected = normal(point.position);
            assert!(dot(found, expected) > (1.0 - 1e-9) * norm(found) * norm(expected), "{at:?}");
        }
    }

    #[test]
    fn surfaces_are_exact_and_look_the_right_way() {
        for degree in [[2, 2], [3, 4], [5, 3]] {
            for arc_deg in [20.0, 170.0, 360.0] {
                let seam = (arc_deg == 360.0).then_some(Seam::Smooth);
                let from_deg = (arc_deg != 170.0).then_some(-70.0);
                let panel = Geometry::CylinderPanel { length_mm: 4.0, radius_mm: 3.0, arc_deg, from_deg, seam };
                check(&meshed(panel, degree), |[_, y, z]| y.hypot(z) - 3.0, |[_, y, z]| [0.0, y, z]);
                let ring = Geometry::Annulus { inner_radius_mm: 1.0, outer_radius_mm: 2.5, arc_deg, from_deg, seam };
                check(&meshed(ring, degree), |[_, _, z]| z, |_| [0.0, 0.0, 1.0]);
                let latitude_deg = [-20.0, 50.0];
                let zone = Geometry::SphereZone { radius_mm: 2.0, latitude_deg, arc_deg, from_deg, seam };
                check(&meshed(zone, degree), |x| norm(x) - 2.0, |x| x);
            }
            let plate = Geometry::Plate { length_mm: 4.0, width_mm: 3.0 };
            check(&meshed(plate, degree), |[_, _, z]| z, |_| [0.0, 0.0, 1.0]);
        }
    }

    #[test]
    fn a_patch_of_the_user_is_raised_exactly() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let patch = NurbsPatch {
            degrees: [1, 2],
            knots_u: vec![0.0, 0.0, 2.0, 2.0],
            knots_v: vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
            control_points_mm: vec![
                [0.0, 0.0, 3.0],
                [0.0, 3.0, 3.0],
                [0.0, 3.0, 0.0],
                [4.0, 0.0, 3.0],
                [4.0, 3.0, 3.0],
                [4.0, 3.0, 0.0],
            ],
            weights: vec![1.0, half, 1.0, 1.0, half, 1.0],
            seam: None,
        };
        let mesh = meshed(Geometry::Nurbs(patch), [3, 5]);
        check(&mesh, |[_, y, z]| y.hypot(z) - 3.0, |[_, y, z]| [0.0, y, z]);
    }
}
