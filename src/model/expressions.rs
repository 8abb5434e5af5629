//! Displacements of places on the surface as weighted sums of those of control points.

use crate::model::ModelError;
use crate::model::edge::edge_rows;
use crate::model::parametrize::parameters_of;
use crate::scene::{Region, Scene};
use crate::spline::{Patch, basis_derivatives, basis_derivatives_len, evaluate_surface, find_span};

/// A weighted sum over control points: (control point, weight).
pub(crate) type Sum = Vec<(usize, f64)>;

/// Expresses the displacements of a place as weighted sums over control points (weights sum to 1): of each control
/// point of an edge, of the point, of each control point of a line.
pub(crate) fn control_expressions(scene: &Scene, patch: &Patch, on: Region) -> Result<Vec<Sum>, ModelError> {
    Ok(match on {
        Region::Edge(edge) => edge_rows(patch, edge)?.outer.into_iter().map(|point| vec![(point, 1.0)]).collect(),
        Region::Point(fractions) => {
            let (first, functions) = evaluate_surface(patch, parameters_of(&scene.geometry, fractions));
            vec![nonzero(patch.window(first).zip(functions[0].iter().copied()).collect())]
        }
        Region::Line(direction, fraction) => {
            let direction = direction.index();
            let terms = line_terms(patch, direction, parameters_of(&scene.geometry, [fraction; 2])[direction]);
            terms.iter().map(|[values, _]| shares(values)).collect()
        }
        Region::Whole => (0..patch.control_points.len()).map(|point| vec![(point, 1.0)]).collect(),
    })
}

/// Renumbers control points as those of a structure in which the first of the patch has the number `first`.
pub(crate) fn shifted(mut sums: Vec<Sum>, first: usize) -> Vec<Sum> {
    sums.iter_mut().flatten().for_each(|(point, _)| *point += first);
    sums
}

/// Computes N_i w_ij and N_i′ w_ij on the line on which the parameter of `direction` has a value, with their control
/// points: for each j, the terms of a control point of the line as a curve and of its derivative across.
pub(super) fn line_terms(patch: &Patch, direction: usize, parameter: f64) -> Vec<[Sum; 2]> {
    let grid = patch.grid();
    let degree = patch.degree[direction];
    let span = find_span(&patch.knots[direction], degree, parameter);
    let mut basis = vec![0.0; basis_derivatives_len(degree)];
    basis_derivatives(&patch.knots[direction], degree, span, parameter, &mut basis);
    let (values, slopes) = basis.split_at(degree + 1);
    let terms = |j: usize| {
        let control = |a: usize| grid.index_along(direction, span - degree + a, j);
        [values, slopes].map(|functions| {
            (0..=degree).map(|a| (control(a), functions[a] * patch.control_points[control(a)][3])).collect()
        })
    };
    (0..grid.counts[1 - direction]).map(terms).collect()
}

/// Divides terms by their sum, so that the weights sum to 1.
pub(super) fn shares(terms: &[(usize, f64)]) -> Sum {
    let total: f64 = terms.iter().map(|(_, value)| value).sum();
    nonzero(terms.iter().map(|(point, value)| (*point, value / total)).collect())
}

pub(super) fn nonzero(mut sum: Sum) -> Sum {
    sum.retain(|(_, factor)| *factor != 0.0);
    sum
}
