//! Exact refinement: knots are inserted into the geometry, and later into the displacement, both in homogeneous
//! coordinates, since the weights change too. The old displacement lies in the new space, so the energy is the same to
//! rounding.

use crate::spline::{Mesh, insert_knots_into_net};

/// Carries a displacement over from `mesh` to `finer`, which is `mesh` with knots inserted.
pub fn project_displacements(mesh: &Mesh, finer: &Mesh, displacement: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let weights = mesh.control_points.iter().map(|point| point[3]);
    let mut net: Vec<[f64; 3]> = displacement.iter().zip(weights).map(|(u, w)| u.map(|value| value * w)).collect();
    let mut counts = mesh.control_counts();
    for direction in 0..2 {
        let inserted = added_knots(&mesh.knots[direction], &finer.knots[direction]);
        let degree = mesh.degree[direction];
        (_, net) = insert_knots_into_net(&mesh.knots[direction], degree, &net, counts, direction, &inserted);
        counts[direction] += inserted.len();
    }
    net.iter().zip(&finer.control_points).map(|(u, point)| u.map(|value| value / point[3])).collect()
}

/// Knots of `finer` that are not in `coarse`, with multiplicity; both ascending.
fn added_knots(coarse: &[f64], finer: &[f64]) -> Vec<f64> {
    let mut rest = coarse.iter().peekable();
    finer.iter().copied().filter(|knot| rest.next_if(|other| *other == knot).is_none()).collect()
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
        let mesh = Mesh { degree: [3, 3], knots: [along.knots, across.knots], control_points };
        let displacement: Vec<[f64; 3]> =
            (0..16).map(|i| [0.1 * i as f64, ((i * 7) % 5) as f64, -0.3 * ((i * 3) % 4) as f64]).collect();
        let finer = mesh.with_knots(&[vec![0.25, 0.5], vec![0.5, 0.75]]);
        let projected = project_displacements(&mesh, &finer, &displacement);
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
