//! Stability of an equilibrium: the lowest eigenvalue of the tangent stiffness and its mode.

use crate::equilibrium::newton::{SolveError, Standing, Workspace};
use crate::shell::dot;

/// Inverse iterations at most; near a limit point the lowest eigenvalue stands far below the next, and a handful
/// suffice.
const MAX_ITERATIONS: usize = 200;
/// The eigenvalue has settled when it changes by less than this, relatively.
const SETTLED: f64 = 1e-10;

/// The eigenpair of the stiffness on the free unknowns whose eigenvalue is smallest in magnitude.
#[derive(Clone, Debug, PartialEq)]
pub struct SoftMode {
    /// Eigenvalue, N/mm (unknowns are displacements of control points).
    pub eigenvalue: f64,
    /// Displacement of the control points, scaled to a largest length of 1.
    pub shape: Vec<[f64; 3]>,
    /// Control point that moves most.
    pub largest_at: usize,
    /// Inverse iterations that it took.
    pub iterations: usize,
}

/// Inverse iteration (Golub & Van Loan, *Matrix Computations*, 4th ed., section 8.2.2) with the L D Lᵀ factor at a
/// state; the sign of the Rayleigh quotient tells a stable state from an unstable one.
///
/// # Errors
/// Where the stiffness has no factor.
pub fn soft_mode(work: &mut Workspace, at: Standing) -> Result<SoftMode, SolveError> {
    work.factorize_at(at)?;
    let Workspace { discretization, solver, .. } = &mut *work;
    let count = discretization.unknowns.count();
    // A start that no symmetry is orthogonal to, the same in every run.
    let mut vector: Vec<f64> = (0..count).map(|i| 1.0 + (i as f64 * 0.618_033_988_75).fract()).collect();
    normalize(&mut vector);
    let mut eigenvalue = 0.0;
    let mut iterations = 0;
    while iterations < MAX_ITERATIONS {
        iterations += 1;
        let mut next = vector.clone();
        solver.solve(&mut next);
        // λ ≈ 1 / (v · K⁻¹ v) for a unit v.
        let settled = 1.0 / vector.iter().zip(&next).map(|(a, b)| a * b).sum::<f64>();
        normalize(&mut next);
        vector = next;
        let change = (settled - eigenvalue).abs();
        eigenvalue = settled;
        if change <= SETTLED * settled.abs() {
            break;
        }
    }
    let free = discretization.unknowns.of_displacement(at.displacement, at.turns, at.parameter);
    let mut shape = discretization.unknowns.place(&free, at.parameter).velocity(&vector, &[]);
    let lengths: Vec<f64> = shape.iter().map(|u| dot(*u, *u).sqrt()).collect();
    let largest_at = (0..lengths.len()).fold(0, |best, i| if lengths[i] > lengths[best] { i } else { best });
    let largest = lengths[largest_at];
    shape.iter_mut().for_each(|u| *u = u.map(|value| value / largest));
    Ok(SoftMode { eigenvalue, shape, largest_at, iterations })
}

fn normalize(vector: &mut [f64]) {
    let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    vector.iter_mut().for_each(|x| *x /= length);
}
