//! Stability of an equilibrium: the lowest eigenvalue of the tangent stiffness, and its mode.
//!
//! The eigenvalue is that of K φ = μ M φ, M = Tᵀ m T with the integrals m of the basis functions ([`super::metric`]): the
//! stiffness against a motion whose root mean square is 1 mm, so that it hardly depends on the mesh. It is found below
//! all others, whatever the number of negative pivots, by Sylvester's law of inertia: K − σ M has as many negative pivots
//! as there are eigenvalues below σ (spectrum slicing, Parlett, *The Symmetric Eigenvalue Problem*, section 3.3). Inverse
//! iteration (Golub & Van Loan, *Matrix Computations*, 4th ed., section 8.2.2) from a shift below it (0 where the state is
//! stable) then gives the mode. Of a part of a symmetric shell it is the lowest of the modes that share its symmetry.

use crate::energy::Discretization;
use crate::equilibrium::configuration::{Configuration, Coordinates};
use crate::equilibrium::metric::Metric;
use crate::equilibrium::solve_error::SolveError;
use crate::equilibrium::tangent_stiffness::TangentStiffness;
use crate::equilibrium::vector::{product, scale_to_one};
use crate::equilibrium::workspace::{Formed, Workspace};
use crate::model::{Blocks, Placement};

/// Largest number of inverse iterations. Near a critical point the lowest eigenvalue lies far from the next, and a
/// handful suffice; of eigenvalues that are nearly equal any mixture of modes will do.
const MAX_ITERATIONS: usize = 200;
/// Change of the eigenvalue, relative to its distance from the shift, below which it has settled.
const SETTLED: f64 = 1e-10;
/// The same for the estimate of a buckling load, whose error is of second order in the mode's: the load of a TRAC boom,
/// whose lowest modes come in pairs, has settled to four digits in a tenth of the time.
const ESTIMATED: f64 = 1e-5;
/// Relative change below which an eigenvalue has settled where only its magnitude is asked for.
const ROUGH: f64 = 0.1;
/// Largest ratio of the shift to the lowest eigenvalue, where that is negative.
const FARTHEST: f64 = 4.0;
/// Largest number of trials of shifts: from the smallest magnitude of a number to the largest.
const MAX_SHIFTS: usize = 600;

/// The lowest eigenvalue of the stiffness on the free unknowns, with its mode.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SoftMode {
    /// Eigenvalue, N/mm: twice the energy of a small motion along the mode with a root mean square of 1 mm.
    pub eigenvalue: f64,
    /// Displacement of the control points, scaled to a largest length of 1.
    pub shape: Vec<[f64; 3]>,
    /// Rates of the free unknowns in the mode.
    pub(super) free: Vec<f64>,
    /// Control point that moves most.
    pub largest_at: usize,
    /// Number of inverse iterations that it took.
    pub iterations: usize,
    /// Number of factorizations that it took.
    pub factorizations: usize,
}

/// Finds the softest mode at a state.
///
/// # Errors
/// Where the stiffness has no factor.
pub fn soft_mode(work: &mut Workspace, at: Configuration) -> Result<SoftMode, SolveError> {
    settled_mode(work, at, SETTLED)
}

/// Finds the softest mode, up to a change of the eigenvalue from one iteration to the next.
fn settled_mode(work: &mut Workspace, at: Configuration, settled: f64) -> Result<SoftMode, SolveError> {
    let Formed { discretization, tangent, configuration } = work.form_at(at);
    let Coordinates { free, placement, .. } = configuration;
    let mass = mass(discretization, tangent, &placement);
    let mut slicing = Slicing { mass, stiffness: tangent.matrix(), tangent, tried: 0 };
    // The start is the same in every run, and has no symmetry.
    let start: Vec<f64> = (0..free.len()).map(|i| 1.0 + (i as f64 * 0.618_033_988_75).fract()).collect();
    slicing.shift_below(&start)?;
    let (vector, eigenvalue, iterations) = slicing.iterate(start, settled);
    let factorizations = slicing.tried;
    let mut shape = placement.velocity(&vector, &[]);
    let (largest_at, largest) = scale_to_one(&mut shape);
    let free = vector.iter().map(|value| value / largest).collect();
    Ok(SoftMode { eigenvalue, shape, free, largest_at, iterations, factorizations })
}

/// First-order estimate of the load at which a shell buckled that is now unstable.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LinearBuckling {
    /// Number of negative pivots of the stiffness at the state.
    pub negative: usize,
    /// The scene's parameter at which the softest mode loses its stiffness, were that linear in the parameter from the
    /// undeformed shell on: exact where the shell deforms in proportion to the load before it buckles.
    pub parameter: f64,
}

/// Difference of the strain energy from that of a small displacement of the same shape, scaled up, up to which the
/// shell has deformed in proportion. Near limit points stiffness falls with the root of the distance, and the estimate
/// is 5 to 11 % low for a hinged roof that is right to 1 %.
const IN_PROPORTION: f64 = 0.1;
/// Factor that makes a displacement small.
const SMALL: f64 = 1e-3;

impl LinearBuckling {
    /// Estimates the buckling load at a state; `None` where it is stable, where the shell has not deformed in
    /// proportion to the load, or where the mode has no stiffness in the undeformed shell either.
    ///
    /// # Errors
    /// Where the stiffness has no factor.
    pub fn of(work: &mut Workspace, at: Configuration) -> Result<Option<Self>, SolveError> {
        let negative = work.factorize_at(at)?;
        if negative == 0 || !work.is_in_proportion(at) {
            return Ok(None);
        }
        let mode = settled_mode(work, at, ESTIMATED)?.free;
        let here = work.stiffness_along(&mode, at);
        let (still, unturned) = (vec![[0.0; 3]; at.displacement.len()], vec![[0.0; 3]; at.turns.len()]);
        let rest = Configuration { displacement: &still, turns: &unturned, parameter: 0.0, largest_force: 0.0 };
        let at_rest = work.stiffness_along(&mode, rest);
        let parameter = at.parameter * at_rest / (at_rest - here);
        Ok((here < 0.0 && at_rest > 0.0).then_some(Self { negative, parameter }))
    }
}

impl Workspace {
    fn is_in_proportion(&self, at: Configuration) -> bool {
        let small: Vec<[f64; 3]> = at.displacement.iter().map(|u| u.map(|value| SMALL * value)).collect();
        let energy = self.energy(at.displacement, at.parameter);
        (self.energy(&small, 0.0) / (SMALL * SMALL) - energy).abs() <= IN_PROPORTION * energy
    }

    /// Computes vᵀKv of a direction v in the free unknowns.
    fn stiffness_along(&mut self, direction: &[f64], at: Configuration) -> f64 {
        let Formed { tangent, .. } = self.form_at(at);
        let stiffness = tangent.matrix();
        product(direction, &tangent.solver.multiply(&stiffness, direction))
    }
}

/// Computes Tᵀ m T in the structure of the stiffness.
fn mass(discretization: &Discretization, tangent: &TangentStiffness, placement: &Placement) -> Vec<f64> {
    let mut diagonal = Blocks::zeros(&discretization.blocks);
    for (point, weight) in Metric::new(&discretization.mesh).weights.iter().enumerate() {
        let own = diagonal.block_mut(discretization.blocks.start(point));
        (0..3).for_each(|c| own[4 * c] = *weight);
    }
    tangent.project(discretization, placement, &diagonal)
}

/// The matrix K − σ M for changing shifts σ.
struct Slicing<'w> {
    tangent: &'w mut TangentStiffness,
    stiffness: Vec<f64>,
    mass: Vec<f64>,
    tried: usize,
}

impl Slicing<'_> {
    /// Factors K − σ M; returns the number of eigenvalues below σ.
    fn count_below(&mut self, shift: f64) -> Result<usize, SolveError> {
        self.tried += 1;
        self.tangent.factorize_sum(&self.stiffness, -shift, &self.mass).map(|negative| negative.count)
    }

    /// Puts the shift below the lowest eigenvalue and not far from it, and leaves its factor in the solver.
    fn shift_below(&mut self, start: &[f64]) -> Result<(), SolveError> {
        if self.count_below(0.0)? == 0 {
            return Ok(());
        }
        // This gives a scale to begin with. The vector itself is no start to continue from: it has little of the lowest
        // mode.
        let (_, nearest, _) = self.iterate(start.to_vec(), ROUGH);
        let (mut above, mut below) = (0.0, -2.0 * nearest.abs());
        while self.count_below(below)? > 0 && self.tried < MAX_SHIFTS {
            (above, below) = (below, 4.0 * below);
        }
        while below < FARTHEST * above && self.tried < MAX_SHIFTS {
            // Where the first shift was far enough no shift above is known yet: it has no geometric mean with 0.
            let middle = if above == 0.0 { below / FARTHEST } else { -(below * above).sqrt() };
            match self.count_below(middle)? {
                0 => below = middle,
                _ => above = middle,
            }
        }
        self.count_below(below).map(|_| ())
    }

    /// Computes vᵀ A v.
    fn form(&self, vector: &[f64], values: &[f64]) -> f64 {
        product(vector, &self.tangent.solver.multiply(values, vector))
    }

    /// Iterates with the current factor; returns mode, eigenvalue and the number of iterations.
    fn iterate(&mut self, mut vector: Vec<f64>, settled: f64) -> (Vec<f64>, f64, usize) {
        let mut last = f64::INFINITY;
        for iteration in 1..=MAX_ITERATIONS {
            let mut next = self.tangent.solver.multiply(&self.mass, &vector);
            self.tangent.solver.solve(&mut next);
            let length = self.form(&next, &self.mass).sqrt();
            vector = next.into_iter().map(|value| value / length).collect();
            let eigenvalue = self.form(&vector, &self.stiffness);
            // 1/length is the distance of the eigenvalue from the shift.
            if (eigenvalue - last).abs() <= settled / length || iteration == MAX_ITERATIONS {
                return (vector, eigenvalue, iteration);
            }
            last = eigenvalue;
        }
        (vector, last, MAX_ITERATIONS)
    }
}
