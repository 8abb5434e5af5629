//! Condition of the stiffness on the free unknowns: how far apart its largest and smallest eigenvalues lie in magnitude.
//!
//! The largest by power iteration, the smallest by inverse iteration with the factor (Golub & Van Loan, *Matrix
//! Computations*, 4th ed., section 8.2). Both approach from inside, so that the ratio is a lower bound; a few per
//! cent of it are of no interest, and the iterations stop there.

use crate::equilibrium::configuration::Configuration;
use crate::equilibrium::solve_error::SolveError;
use crate::equilibrium::vector::product;
use crate::equilibrium::workspace::{Formed, Workspace};

/// Relative change of an eigenvalue in one iteration at which it is known well enough.
const SETTLED: f64 = 1e-4;
/// Largest number of iterations: where eigenvalues lie close together the vector does not settle, but the value nearly
/// does.
const MOST_ITERATIONS: usize = 1000;

/// Both ends of the spectrum of the stiffness on the free unknowns (its symmetric part, where loads turn with the
/// shell).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Condition {
    /// Largest magnitude of an eigenvalue, N/mm (all unknowns are lengths).
    pub largest: f64,
    /// Smallest magnitude of an eigenvalue, N/mm.
    pub smallest: f64,
}

impl Condition {
    /// Finds the extreme eigenvalues of the stiffness at a state.
    ///
    /// # Errors
    /// Where the stiffness has no factor.
    pub fn at(work: &mut Workspace, at: Configuration) -> Result<Self, SolveError> {
        let Formed { tangent, configuration, .. } = work.form_at(at);
        let (matrix, count) = (tangent.matrix(), configuration.free.len());
        tangent.factorize_formed()?;
        let solver = &tangent.solver;
        let largest = magnitude(count, |vector| solver.multiply(&matrix, vector));
        let smallest = magnitude(count, |vector| {
            let mut solved = vector.to_vec();
            solver.solve(&mut solved);
            solved
        });
        Ok(Self { largest, smallest: 1.0 / smallest })
    }

    /// Condition number: ratio of the largest eigenvalue to the smallest.
    pub fn number(&self) -> f64 {
        self.largest / self.smallest
    }
}

/// Finds the largest magnitude of an eigenvalue of a symmetric operator: |A v| for a unit v, which grows from one
/// iteration to the next, also where eigenvalues of both signs have that magnitude.
fn magnitude(count: usize, mut apply: impl FnMut(&[f64]) -> Vec<f64>) -> f64 {
    // The start is the same in every run, and has no symmetry.
    let mut vector: Vec<f64> = (0..count).map(|i| 1.0 + (i as f64 * 0.618_033_988_75).fract()).collect();
    let mut value = product(&vector, &vector).sqrt();
    for iteration in 0..MOST_ITERATIONS {
        vector.iter_mut().for_each(|x| *x /= value);
        vector = apply(&vector);
        let next = product(&vector, &vector).sqrt();
        let settled = (next - value).abs() <= SETTLED * next;
        value = next;
        // The first value is the length of the start, not an eigenvalue.
        if (settled && iteration > 0) || !value.is_finite() || value == 0.0 {
            break;
        }
    }
    value
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use nalgebra::DMatrix;

    use super::*;
    use crate::model::starting_mesh;
    use crate::scene::parse;

    /// Against all eigenvalues of the dense matrix, undeformed and in a shape that is far from equilibrium, where the
    /// stiffness is indefinite.
    #[test]
    fn agrees_with_the_dense_spectrum() {
        let scene = parse(include_str!("../../pipelines/baseline-quarter.toml"), "baseline-quarter.toml").unwrap();
        let mesh = Arc::new(starting_mesh(&scene).unwrap());
        let mut work = Workspace::new(&scene, &mesh).unwrap();
        let count = work.discretization.unknowns.count();
        let mut indefinite = 0;
        for (size, parameter) in [(0.0, 0.0), (0.5, 5.0)] {
            let free: Vec<f64> = (0..count).map(|i| size * ((i * 7919 % 1013) as f64 / 1013.0 - 0.5)).collect();
            let displacement = work.discretization.unknowns.configure(&free, parameter).displacement();
            let at = Configuration { displacement: &displacement, turns: &[], parameter, largest_force: 0.0 };
            let found = Condition::at(&mut work, at).unwrap();
            let matrix = work.form_at(at).tangent.matrix();
            let dense = DMatrix::from_fn(count, count, |row, column| {
                let mut unit = vec![0.0; count];
                unit[column] = 1.0;
                work.tangent.solver.multiply(&matrix, &unit)[row]
            });
            let eigenvalues = dense.symmetric_eigen().eigenvalues;
            indefinite += usize::from(eigenvalues.min() < 0.0);
            let sizes: Vec<f64> = eigenvalues.iter().map(|value| value.abs()).collect();
            let (most, least) = sizes.iter().fold((0.0_f64, f64::INFINITY), |(m, l), x| (m.max(*x), l.min(*x)));
            assert!((found.largest / most - 1.0).abs() < 0.02, "{} {most}", found.largest);
            assert!((found.smallest / least - 1.0).abs() < 0.02, "{} {least}", found.smallest);
            assert!(found.number() <= 1.001 * most / least, "an estimate from inside: {}", found.number());
        }
        assert_eq!(indefinite, 1);
    }
}
