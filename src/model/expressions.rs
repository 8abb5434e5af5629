//! Displacements of places on the surface as weighted sums of those of control points.

use crate::model::ModelError;
use crate::model::edge::edge_rows;
use crate::model::place::parameters_of;
use crate::scene::{Region, Scene};
use crate::spline::{Mesh, basis_derivatives, basis_derivatives_len, evaluate_surface, find_span};

/// A weighted sum of control points.
pub(super) type Sum = Vec<(usize, f64)>;

/// Displacements of a place as weighted sums of control points (weights of 1 in all): each control point of an edge, the
/// point, each control point of a line.
pub(crate) fn control_expressions(scene: &Scene, mesh: &Mesh, on: Region) -> Result<Vec<Sum>, ModelError> {
    Ok(match on {
        Region::Edge(edge) => edge_rows(mesh, edge)?.outer.into_iter().map(|point| vec![(point, 1.0)]).collect(),
        Region::Point(fractions) => {
            let (first, functions) = evaluate_surface(mesh, parameters_of(&scene.geometry, fractions));
            vec![nonzero(mesh.window(first).zip(functions[0].iter().copied()).collect())]
        }
        Region::Line(direction, fraction) => {
            let way = direction.index();
            let terms = line_terms(mesh, way, parameters_of(&scene.geometry, [fraction; 2])[way]);
            terms.iter().map(|[values, _]| shares(values)).collect()
        }
        Region::Whole => (0..mesh.control_points.len()).map(|point| vec![(point, 1.0)]).collect(),
    })
}

/// N_i w_ij and N_i′ w_ij on the line on which the parameter of direction `way` has a value, with their control points: for each
/// j, the terms of a control point of the line as a curve and of its derivative across.
pub(super) fn line_terms(mesh: &Mesh, way: usize, parameter: f64) -> Vec<[Sum; 2]> {
    let grid = mesh.grid();
    let degree = mesh.degree[way];
    let span = find_span(&mesh.knots[way], degree, parameter);
    let mut basis = vec![0.0; basis_derivatives_len(degree)];
    basis_derivatives(&mesh.knots[way], degree, span, parameter, &mut basis);
    let (values, slopes) = basis.split_at(degree + 1);
    let terms = |j: usize| {
        let control = |a: usize| grid.index_along(way, span - degree + a, j);
        [values, slopes].map(|functions| {
            (0..=degree).map(|a| (control(a), functions[a] * mesh.control_points[control(a)][3])).collect()
        })
    };
    (0..grid.counts[1 - way]).map(terms).collect()
}

/// Terms over their sum: weights of 1 in all.
pub(super) fn shares(terms: &[(usize, f64)]) -> Sum {
    let total: f64 = terms.iter().map(|(_, value)| value).sum();
    nonzero(terms.iter().map(|(point, value)| (*point, value / total)).collect())
}

pub(super) fn nonzero(mut sum: Sum) -> Sum {
    sum.retain(|(_, factor)| *factor != 0.0);
    sum
}
