//! Exact refinement: knots are inserted into the geometry, and later into the displacement, both in homogeneous
//! coordinates, since the weights change too. The old displacement lies in the new space, so the energy is the same to
//! rounding.

use crate::spline::{Mesh, Patch, insert_knots_into_net, without_knots};

/// Carries a displacement over from `mesh` to `finer`, which is `mesh` with knots inserted.
pub fn project_displacements(mesh: &Mesh, finer: &Mesh, displacement: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let patches = mesh.patches.iter().zip(&finer.patches).zip(mesh.ranges());
    patches.flat_map(|((patch, finer), points)| projected(patch, finer, &displacement[points])).collect()
}

fn projected(patch: &Patch, finer: &Patch, displacement: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut net = weighted(patch, displacement);
    let mut counts = patch.control_counts();
    for direction in 0..2 {
        let inserted = without_knots(&finer.knots[direction], &patch.knots[direction]);
        let degree = patch.degree[direction];
        (_, net) = insert_knots_into_net(&patch.knots[direction], degree, &net, counts, direction, &inserted);
        counts[direction] += inserted.len();
    }
    unweighted(finer, &net)
}

/// Vectors at the control points of a mesh in homogeneous coordinates.
pub(super) fn weighted(mesh: &Patch, vectors: &[[f64; 3]]) -> Vec<[f64; 3]> {
    vectors.iter().zip(&mesh.control_points).map(|(vector, point)| vector.map(|value| value * point[3])).collect()
}

/// Vectors at the control points of a mesh from homogeneous coordinates.
pub(super) fn unweighted(mesh: &Patch, net: &[[f64; 3]]) -> Vec<[f64; 3]> {
    net.iter().zip(&mesh.control_points).map(|(vector, point)| vector.map(|value| value / point[3])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::{circular_arc, mid_surface_point, straight_line};

    #[test]
    fn geometry_and_displacement_are_the_same_functions_after_refinement() {
        let (along, across) = (straight_line(30.0, 3), circular_arc(10.0, -1.0, 1.0, 3));
        let control_points = along
            .points
            .iter()
            .flat_map(|[x, _, _]| across.points.iter().map(move |[y, z, w]| [x * w, *y, *z, *w]))
            .collect();
        let mesh = Patch { degree: [3, 3], knots: [along.knots, across.knots], control_points };
        let displacement: Vec<[f64; 3]> =
            (0..16).map(|i| [0.1 * i as f64, ((i * 7) % 5) as f64, -0.3 * ((i * 3) % 4) as f64]).collect();
        let finer = mesh.with_knots(&[vec![0.25, 0.5], vec![0.5, 0.75]]);
        let projected = projected(&mesh, &finer, &displacement);
        for sample in 0..50 {
            let at = [(sample % 7) as f64 / 6.0, (sample / 7) as f64 / 7.0];
            let (old, new) = (mid_surface_point(&mesh, &displacement, at), mid_surface_point(&finer, &projected, at));
            for c in 0..3 {
                assert!((old.position[c] - new.position[c]).abs() < 1e-13, "{at:?}");
                for k in 0..5 {
                    let scale = 1.0 + old.derivatives[k][c].abs();
                    assert!((old.derivatives[k][c] - new.derivatives[k][c]).abs() < 1e-12 * scale, "{at:?} {k}");
                }
            }
        }
    }
}
