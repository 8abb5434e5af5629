//! Displacements of places on the surface as weighted sums of those of control points.

use crate::model::ModelError;
use crate::model::edge::edge_rows;
use crate::model::place::parameters_of;
use crate::scene::{ParametricDirection, Place, Scene};
use crate::spline::{Mesh, basis_derivatives, basis_derivatives_len, evaluate_surface, find_span};

/// Displacements of a place as weighted sums of control points (weights of 1 in all): each control point of an edge, the
/// point, each control point of a line.
pub(crate) fn control_expressions(scene: &Scene, mesh: &Mesh, on: Place) -> Result<Vec<Vec<(usize, f64)>>, ModelError> {
    let [_, n2] = mesh.control_counts();
    Ok(match on {
        Place::Edge(edge) => edge_rows(mesh, edge)?.outer.into_iter().map(|point| vec![(point, 1.0)]).collect(),
        Place::Point(fractions) => {
            let (first, functions) = evaluate_surface(mesh, parameters_of(&scene.geometry, fractions));
            let columns = mesh.degree[1] + 1;
            let control = |a: usize| (first[0] + a / columns) * n2 + first[1] + a % columns;
            vec![nonzero(functions[0].iter().enumerate().map(|(a, value)| (control(a), *value)).collect())]
        }
        Place::Line(direction, fraction) => line_expressions(scene, mesh, direction, fraction),
        Place::Whole => (0..mesh.control_points.len()).map(|point| vec![(point, 1.0)]).collect(),
    })
}

/// Σ_i N_i w_ij u_ij / Σ_i N_i w_ij for each j: the control points of the line as a curve.
fn line_expressions(
    scene: &Scene,
    mesh: &Mesh,
    direction: ParametricDirection,
    fraction: f64,
) -> Vec<Vec<(usize, f64)>> {
    let way = if direction == ParametricDirection::U { 0 } else { 1 };
    let parameter = parameters_of(&scene.geometry, [fraction; 2])[way];
    let [n1, n2] = mesh.control_counts();
    let degree = mesh.degree[way];
    let span = find_span(&mesh.knots[way], degree, parameter);
    let mut basis = vec![0.0; basis_derivatives_len(degree)];
    basis_derivatives(&mesh.knots[way], degree, span, parameter, &mut basis);
    let running = if way == 0 { n2 } else { n1 };
    (0..running)
        .map(|j| {
            let control = |a: usize| if way == 0 { (span - degree + a) * n2 + j } else { j * n2 + span - degree + a };
            let weighted: Vec<(usize, f64)> =
                (0..=degree).map(|a| (control(a), basis[a] * mesh.control_points[control(a)][3])).collect();
            let total: f64 = weighted.iter().map(|(_, value)| value).sum();
            nonzero(weighted.into_iter().map(|(point, value)| (point, value / total)).collect())
        })
        .collect()
}

fn nonzero(mut sum: Vec<(usize, f64)>) -> Vec<(usize, f64)> {
    sum.retain(|(_, factor)| *factor != 0.0);
    sum
}
