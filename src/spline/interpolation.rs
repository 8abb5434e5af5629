//! Splines through given values: of a function of the parameters in the space of a patch, and of a table of measured values.
//!
//! In the space of a patch they are taken at the Greville points ξᵢ = (ξᵢ₊₁ + … + ξᵢ₊ₚ)/p, at which splines of any degree up to 5 and
//! any knots exist and converge with the order p + 1 (de Boor, *A Practical Guide to Splines*, chapter XIII). Through measured
//! values goes the spline of degree 3, or less where there are fewer of them, whose knots are means of their places (NURBS Book,
//! equation 9.8): the one of which smooth data want no more.

use nalgebra::{DMatrix, Dyn, LU};

use crate::spline::{Grid, Patch, basis_derivatives, basis_derivatives_len, control_count, find_span};

/// Degree of a spline through measured values.
const MEASURED_DEGREE: usize = 3;

/// Lists the Greville points of a knot vector.
pub fn greville_points(knots: &[f64], degree: usize) -> Vec<f64> {
    let (first, last) = (knots[0], knots[knots.len() - 1]);
    let mean = |k: usize| knots[k + 1..k + 1 + degree].iter().sum::<f64>() / degree as f64;
    (0..control_count(knots, degree)).map(|k| mean(k).clamp(first, last)).collect()
}

/// Values of all functions (columns) at some parameters (rows).
pub fn collocation(knots: &[f64], degree: usize, parameters: &[f64]) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(parameters.len(), control_count(knots, degree));
    let mut basis = vec![0.0; basis_derivatives_len(degree)];
    for (row, parameter) in parameters.iter().enumerate() {
        let span = find_span(knots, degree, *parameter);
        basis_derivatives(knots, degree, span, *parameter, &mut basis);
        (0..=degree).for_each(|a| matrix[(row, span - degree + a)] = basis[a]);
    }
    matrix
}

/// Interpolation in the space of a patch, at its Greville points.
#[derive(Debug)]
pub struct Interpolation {
    /// The points of each direction.
    pub points: [Vec<f64>; 2],
    values: [DMatrix<f64>; 2],
    factors: [LU<f64, Dyn, Dyn>; 2],
    control_points: DMatrix<f64>,
}

impl Interpolation {
    /// Prepares the interpolation in the space of a patch.
    pub fn new(patch: &Patch) -> Self {
        let points = [0, 1].map(|k| greville_points(&patch.knots[k], patch.degree[k]));
        let values = [0, 1].map(|k| collocation(&patch.knots[k], patch.degree[k], &points[k]));
        let factors = values.clone().map(DMatrix::lu);
        let [rows, columns] = patch.control_counts();
        let weights = patch.control_points.iter().map(|point| point[3]);
        Self { points, values, factors, control_points: DMatrix::from_row_iterator(rows, columns, weights) }
    }

    /// Lists the Greville points of the patch as a grid, the second direction fastest.
    pub fn grid(&self) -> Vec<[f64; 2]> {
        let [us, vs] = &self.points;
        us.iter().flat_map(|u| vs.iter().map(move |v| [*u, *v])).collect()
    }

    /// Finds the displacement of the control points under which the surface moves by these values at the points of [`Self::grid`].
    /// Rational: Σ N w d = Σ N w times the values, there.
    pub fn control_values(&self, values: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let weights = &self.values[0] * &self.control_points * self.values[1].transpose();
        let (rows, columns) = weights.shape();
        let mut result = vec![[0.0; 3]; values.len()];
        for c in 0..3 {
            let component = DMatrix::from_row_iterator(rows, columns, values.iter().map(|value| value[c]));
            let found = solve_both(&self.factors, weights.component_mul(&component));
            let found = found.component_div(&self.control_points);
            let grid = Grid::new([rows, columns]);
            (0..grid.len()).for_each(|k| result[k][c] = found[(grid.place(k)[0], grid.place(k)[1])]);
        }
        result
    }
}

/// Solves B₁ X B₂ᵀ = R.
fn solve_both(factors: &[LU<f64, Dyn, Dyn>; 2], right: DMatrix<f64>) -> DMatrix<f64> {
    // By Schoenberg and Whitney neither is singular: each point lies inside the support of its function.
    let solve = |factor: &LU<f64, Dyn, Dyn>, right: DMatrix<f64>| factor.solve(&right).unwrap_or(right);
    let half = solve(&factors[0], right);
    solve(&factors[1], half.transpose()).transpose()
}

/// The spline of two variables through values on a full grid.
#[derive(Debug)]
pub struct ScalarSurface {
    knots: [Vec<f64>; 2],
    degree: [usize; 2],
    control_values: DMatrix<f64>,
}

impl ScalarSurface {
    /// Creates the spline through `values` at places that ascend each way, two or more of them; the second direction runs fastest.
    pub fn through(places: [&[f64]; 2], values: &[f64]) -> Self {
        let degree = places.map(|places| MEASURED_DEGREE.min(places.len() - 1));
        Self::of([0, 1].map(|k| averaged_knots(places[k], degree[k])), degree, places, values)
    }

    /// Creates the spline on given knots, with as many places each way as it has functions, which lie in their supports.
    pub fn of(knots: [Vec<f64>; 2], degree: [usize; 2], places: [&[f64]; 2], values: &[f64]) -> Self {
        let factors = [0, 1].map(|k| collocation(&knots[k], degree[k], places[k]).lu());
        let right = DMatrix::from_row_iterator(places[0].len(), places[1].len(), values.iter().copied());
        Self { control_values: solve_both(&factors, right), knots, degree }
    }

    /// Evaluates the spline.
    pub fn at(&self, place: [f64; 2]) -> f64 {
        let [along, across] = [0, 1].map(|k| {
            let span = find_span(&self.knots[k], self.degree[k], place[k]);
            let mut basis = vec![0.0; basis_derivatives_len(self.degree[k])];
            basis_derivatives(&self.knots[k], self.degree[k], span, place[k], &mut basis);
            (span - self.degree[k], basis)
        });
        let row = |a: usize| -> f64 {
            (0..=self.degree[1]).map(|b| across.1[b] * self.control_values[(along.0 + a, across.0 + b)]).sum()
        };
        (0..=self.degree[0]).map(|a| along.1[a] * row(a)).sum()
    }
}

/// Knots for a spline through values at these places.
fn averaged_knots(places: &[f64], degree: usize) -> Vec<f64> {
    let (first, last) = (places[0], places[places.len() - 1]);
    let inner = (1..places.len() - degree).map(|j| places[j..j + degree].iter().sum::<f64>() / degree as f64);
    let ends = |knot: f64| std::iter::repeat_n(knot, degree + 1);
    ends(first).chain(inner).chain(ends(last)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::mid_surface_point;

    fn patch() -> Patch {
        let knots =
            [vec![0.0, 0.0, 0.0, 0.0, 0.2, 0.7, 0.7, 1.0, 1.0, 1.0, 1.0], vec![0.0, 0.0, 0.0, 0.4, 1.0, 1.0, 1.0]];
        let degree = [3, 2];
        let grid = Grid::new([0, 1].map(|k| control_count(&knots[k], degree[k])));
        let point = |k: usize| {
            let ([i, j], weight) = (grid.place(k), 1.0 + 0.1 * ((k * 7) % 5) as f64);
            [i as f64, j as f64, 0.1 * (i * j) as f64, 1.0].map(|x| x * weight)
        };
        Patch { degree, control_points: (0..grid.len()).map(point).collect(), knots }
    }

    /// What lies in the space comes back: the surface itself, which is rational.
    #[test]
    fn a_surface_goes_through_its_own_points() {
        let patch = patch();
        let interpolation = Interpolation::new(&patch);
        let values: Vec<[f64; 3]> =
            interpolation.grid().into_iter().map(|at| mid_surface_point(&patch, &[], at).position).collect();
        for (found, expected) in interpolation.control_values(&values).iter().zip(patch.points()) {
            assert!((0..3).all(|c| (found[c] - expected[c]).abs() < 1e-12), "{found:?} {expected:?}");
        }
    }

    /// Cubics are exact between measured values, and of few values what their number gives.
    #[test]
    fn a_measured_cubic_is_exact_everywhere() {
        let (us, vs) = ([0.0, 0.1, 0.35, 0.5, 0.8, 1.0], [0.0, 0.6, 1.0]);
        let function = |u: f64, v: f64| 1.0 - 2.0 * u + u.powi(3) * (1.0 + v - 0.5 * v * v);
        let values: Vec<f64> = us.iter().flat_map(|u| vs.iter().map(move |v| function(*u, *v))).collect();
        let surface = ScalarSurface::through([&us, &vs], &values);
        for k in 0..50 {
            let (u, v) = (k as f64 / 49.0, (k as f64 * 0.618).fract());
            assert!((surface.at([u, v]) - function(u, v)).abs() < 1e-13, "{u} {v}");
        }
    }
}
