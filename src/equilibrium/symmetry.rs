//! How symmetric the stiffness is that the kernels make.
//!
//! The assembled matrix keeps one half and is symmetric whatever the kernels do. So the bilinear form is summed here
//! from the full 15 × 15 Hessians of the quadrature points, for two fields x and y on the control points:
//! |x·(K y) − y·(K x)| shows a Hessian that is not symmetric, and |x·(K y) − x·(K_half y)| an assembled matrix that is not
//! the sum of the Hessians. Loads that turn with the shell have a tangent of their own and are left out.

use crate::energy::{Discretization, Want};
use crate::equilibrium::assembly::Assembled;
use crate::equilibrium::configuration::Configuration;
use crate::equilibrium::workspace::Workspace;
use crate::model::{PointTable, Tables};
use crate::shell::{Hessian, PointReference, dot};

/// Errors of the stiffness of the shell at a state, relative to |x| |K y|.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SymmetryError {
    /// Asymmetry of the Hessians: |x·(K y) − y·(K x)|.
    pub hessians: f64,
    /// Difference of the assembled half from the Hessians: |x·(K y) − x·(K_half y)|.
    pub assembled: f64,
}

impl SymmetryError {
    /// Measures the errors at a state.
    pub fn at(work: &mut Workspace, at: Configuration) -> Self {
        let mut half = Assembled::new(&work.discretization);
        let natural = work.discretization.natural_at(at.parameter);
        half.assemble_shells(&work.discretization, at.displacement, &natural, Want::Stiffness);
        measure(&work.discretization, at.displacement, &half, |shell, point, u, hessian| {
            natural[shell].map_or(*point, |natural| point.under(&natural.strain)).hessian(u, hessian);
        })
    }

    /// The larger of the two errors.
    pub fn largest(&self) -> f64 {
        // `max` would drop what is not a number.
        if self.hessians >= self.assembled || self.hessians.is_nan() { self.hessians } else { self.assembled }
    }
}

/// Derivatives of a field at a quadrature point, in the order of the Hessian's rows.
type Derivatives = [[f64; 3]; 5];

fn measure(
    discretization: &Discretization,
    displacement: &[[f64; 3]],
    half: &Assembled,
    hessian_of: impl Fn(usize, &PointReference, &Derivatives, &mut Hessian),
) -> SymmetryError {
    let count = displacement.len();
    let (x, y) = (field(count, 0.618_033_988_75), field(count, 0.414_213_562_37));
    let fields = [displacement, &x[..], &y[..]];
    let [mut forward, mut backward] = [0.0; 2];
    for (index, shell) in discretization.shells.iter().enumerate() {
        let tables = &shell.tables;
        let of_shell =
            |point: &PointReference, u: &Derivatives, hessian: &mut Hessian| hessian_of(index, point, u, hessian);
        let mut add = |[more_forward, more_backward]: [f64; 2]| {
            forward += more_forward;
            backward += more_backward;
        };
        add(forms(tables, &tables.points, fields, &of_shell));
        tables.stretching.iter().for_each(|stretching| add(forms(tables, stretching, fields, &of_shell)));
    }
    let stiff = half.multiply(discretization, &y);
    let stored: f64 = x.iter().zip(&stiff).map(|(a, b)| dot(*a, *b)).sum();
    let size = length(&x) * length(&stiff);
    SymmetryError { hessians: (forward - backward).abs() / size, assembled: (forward - stored).abs() / size }
}

/// Computes x·(K y) and y·(K x) of the points of a table, for the fields displacement, x, y.
fn forms<Batch, const ROWS: usize>(
    tables: &Tables,
    table: &PointTable<Batch, ROWS>,
    [displacement, x, y]: [&[[f64; 3]]; 3],
    hessian_of: &impl Fn(&PointReference, &Derivatives, &mut Hessian),
) -> [f64; 2] {
    let Tables { padded, ref connectivity, .. } = *tables;
    let mut hessian: Hessian = [[0.0; 16]; 15];
    let mut forms = [0.0; 2];
    for element in 0..connectivity.elements() {
        let points = connectivity.controls(element);
        for (q, point) in table.element_points(element).iter().enumerate() {
            let functions = &table.element_functions(element)[q * ROWS * padded..][..ROWS * padded];
            let derivatives = |field: &[[f64; 3]]| -> Derivatives {
                let mut derivatives = [[0.0; 3]; 5];
                for (k, row) in functions.chunks(padded).enumerate() {
                    let shares = points.iter().zip(row);
                    derivatives[k] =
                        shares.fold([0.0; 3], |sum, (i, share)| [0, 1, 2].map(|c| sum[c] + share * field[*i][c]));
                }
                derivatives
            };
            hessian_of(point, &derivatives(displacement), &mut hessian);
            let (dx, dy) = (derivatives(x), derivatives(y));
            forms[0] += form(&dx, &hessian, &dy);
            forms[1] += form(&dy, &hessian, &dx);
        }
    }
    forms
}

/// Makes a field without any symmetry, the same in every run.
fn field(count: usize, ratio: f64) -> Vec<[f64; 3]> {
    (0..count).map(|i| [0, 1, 2].map(|c| ((3 * i + c + 1) as f64 * ratio).fract() - 0.5)).collect()
}

/// Computes Σ x_p H_pq y_q from every entry of H, without assuming symmetry.
fn form(x: &Derivatives, hessian: &Hessian, y: &Derivatives) -> f64 {
    (0..15).map(|p| x[p / 3][p % 3] * (0..15).map(|q| hessian[p][q] * y[q / 3][q % 3]).sum::<f64>()).sum()
}

fn length(field: &[[f64; 3]]) -> f64 {
    field.iter().map(|x| dot(*x, *x)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::model::starting_mesh;
    use crate::scene::parse;

    /// What the sums of some 600 points of both signs leave of 2⁻⁵³.
    const ROUNDING: f64 = 1e-13;

    fn deformed() -> (Discretization, Vec<[f64; 3]>, Assembled) {
        let scene = parse(include_str!("../../pipelines/baseline.toml"), "baseline.toml").unwrap();
        let discretization = Discretization::new(&scene, &Arc::new(starting_mesh(&scene).unwrap())).unwrap();
        let shape = field(discretization.mesh.point_count(), 0.732_050_807_57);
        let mut half = Assembled::new(&discretization);
        half.assemble(&discretization, &shape, 0.0, Want::Stiffness);
        (discretization, shape, half)
    }

    #[test]
    fn the_stiffness_is_symmetric_to_rounding() {
        let (discretization, shape, half) = deformed();
        let error = measure(&discretization, &shape, &half, |_, point, u, hessian| {
            point.hessian(u, hessian);
        });
        assert!(error.hessians < ROUNDING && error.assembled < ROUNDING, "{error:?}");
    }

    /// Every entry off the diagonal, wrong by a ten-thousandth of the largest, is seen.
    #[test]
    fn a_hessian_that_is_not_symmetric_shows() {
        let (discretization, shape, half) = deformed();
        for (p, q) in [(0, 1), (3, 0), (6, 2), (14, 9), (5, 11)] {
            let error = measure(&discretization, &shape, &half, |_, point, u, hessian| {
                point.hessian(u, hessian);
                let largest = hessian.iter().flatten().fold(0.0_f64, |most, value| most.max(value.abs()));
                hessian[p][q] += 1e-4 * largest;
            });
            assert!(error.hessians > 100.0 * ROUNDING, "({p}, {q}): {error:?}");
        }
    }

    #[test]
    fn a_matrix_that_is_not_the_sum_of_the_hessians_shows() {
        let (discretization, shape, mut half) = deformed();
        let largest = half.stiffness.values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        // The block of a control point in the middle with itself.
        let points = discretization.mesh.point_count();
        let own = discretization.blocks.start(points / 2);
        half.stiffness.block_mut(own)[0] += 1e-6 * largest;
        let error = measure(&discretization, &shape, &half, |_, point, u, hessian| {
            point.hessian(u, hessian);
        });
        assert!(error.hessians < ROUNDING && error.assembled > 100.0 * ROUNDING, "{error:?}");
    }
}
