//! The equations R(q, λ) = 0 at a point: residual, its rate with the parameter, and the factor of the stiffness.

use crate::energy::{At, Discretization, Term, Want};
use crate::equilibrium::assembly::Assembled;
use crate::equilibrium::configuration::{Configuration, Coordinates};
use crate::equilibrium::force_scale::ForceScale;
use crate::equilibrium::iterate::{Effort, Iterate};
use crate::equilibrium::solve_error::SolveError;
use crate::equilibrium::solved::Ended;
use crate::equilibrium::tangent_stiffness::TangentStiffness;
use crate::equilibrium::workspace::Workspace;
use crate::shell::sub;

/// The equations along a path, in the buffers of a workspace.
pub(super) struct Equations<'w> {
    pub(super) discretization: &'w Discretization,
    pub(super) tangent: &'w mut TangentStiffness,
    pub(super) assembled: &'w mut Assembled,
    /// Largest force met before, N.
    largest_force: f64,
    /// Number of negative pivots, where residual, stiffness and factor are already those of the state that is asked for
    /// next.
    ready: Option<usize>,
}

/// The equations at a point; the factor of their stiffness is in the workspace.
pub(super) struct Point<'w> {
    pub here: Coordinates<'w>,
    /// Residual R: forces on the free unknowns, N.
    pub gradient: Vec<f64>,
    /// Rate ∂R/∂λ of the residual with the parameter.
    pub gradient_rate: Vec<f64>,
    /// Rates of the given coordinates with λ, mm.
    pub given_rates: Vec<f64>,
    pub iterate: Iterate,
}

impl<'w> Equations<'w> {
    /// Creates the equations of a path that begins at a state.
    pub fn of(work: &'w mut Workspace, from: Configuration) -> Self {
        let Workspace { discretization, tangent, assembled, factored_at } = work;
        *factored_at = None;
        Self { discretization, tangent, assembled, largest_force: from.largest_force, ready: None }
    }

    /// Prepares the equations for [`Self::at_configuration`] at this state, with the stiffness and factor that a solve
    /// left there if there are any. Where sections turn freely everything is formed again: the state decides the
    /// unknowns up to rounding only.
    pub fn factored_at(work: &'w mut Workspace, at: Configuration) -> Result<Self, SolveError> {
        if work.discretization.unknowns.turns_are_unknown() {
            return Ok(Self::of(work, at));
        }
        let negative = work.factorize_at(at)?;
        let Workspace { discretization, tangent, assembled, .. } = work;
        Ok(Self { discretization, tangent, assembled, largest_force: at.largest_force, ready: Some(negative) })
    }

    /// Assembles and factors the equations at a configuration.
    pub fn at_configuration(&mut self, at: Configuration) -> Result<Point<'w>, SolveError> {
        // This is not counted in the effort of the solve that follows, which would depend on what ran before in the
        // same process.
        self.at(at.free(&self.discretization.unknowns), at.parameter, &mut Effort::default())
    }

    /// Assembles and factors the equations at some free unknowns and a parameter.
    pub fn at(&mut self, free: Vec<f64>, parameter: f64, effort: &mut Effort) -> Result<Point<'w>, SolveError> {
        let discretization = self.discretization;
        let here = Coordinates::at(&discretization.unknowns, free, parameter);
        let Coordinates { placement, displacement, .. } = &here;
        let ready = std::mem::take(&mut self.ready);
        if ready.is_none() {
            self.assembled.assemble(discretization, displacement, parameter, Want::Stiffness);
        }
        let forces = self.assembled.forces();
        let gradient = placement.restrict(&forces);
        let scale = ForceScale::at(discretization, self.assembled, displacement, self.largest_force);
        let iterate = Iterate::at(&discretization.unknowns, self.assembled.energy, scale, &gradient, *effort);
        let mut iterate = SolveError::unless_finite(iterate, *effort)?;
        if let Some(negative) = ready {
            iterate.negative_pivots = negative;
        } else {
            effort.factorizations += 1;
            let factored = self.tangent.factorize(discretization, placement, self.assembled);
            let negative = factored.map_err(|cause| SolveError::Factor { cause, effort: *effort })?;
            iterate.negative_pivots = negative.count;
            iterate.shift = 2.0 * negative.largest;
        }
        let given_rates = discretization.unknowns.given_rates_at(parameter);
        let motion = placement.velocity(&[], &given_rates);
        let mut force_rates = self.assembled.multiply(discretization, &motion);
        let at = At { mesh: &discretization.mesh, displacement, parameter };
        let loads = discretization.terms.rates(at);
        let skew = self.assembled.multiply_skew(discretization, &motion);
        for (point, rate) in force_rates.iter_mut().enumerate() {
            (0..3).for_each(|c| rate[c] += skew[point][c] - loads[point][c]);
        }
        let mut of_shell = vec![[0.0; 3]; displacement.len()];
        discretization.shells.iter().for_each(|shell| shell.add_rates(at, &mut of_shell));
        force_rates.iter_mut().zip(of_shell).for_each(|(sum, rate)| *sum = sub(*sum, rate));
        let mut gradient_rate = placement.restrict(&force_rates);
        for (sum, turned) in gradient_rate.iter_mut().zip(placement.restrict_rate(&forces, &given_rates)) {
            *sum += turned;
        }
        Ok(Point { here, gradient, gradient_rate, given_rates, iterate })
    }

    /// Solves ∂R/∂q x = b at a point.
    pub fn solve(&mut self, point: &Point, right_hand_side: &[f64]) -> Vec<f64> {
        let Self { discretization, tangent, assembled, .. } = self;
        match assembled.has_skew() {
            true => tangent.solve_whole(discretization, &point.here.placement, assembled, right_hand_side),
            false => {
                let mut solution = right_hand_side.to_vec();
                tangent.solver.solve(&mut solution);
                solution
            }
        }
    }
}

impl Point<'_> {
    /// Forms the result of a solve that started at a state and ends at this point.
    pub fn ended(self, equations: &Equations, from: Configuration, effort: Effort) -> Ended {
        let forces = equations.assembled.forces();
        let Discretization { mesh, terms, .. } = equations.discretization;
        Ended {
            reactions: self.here.placement.reactions(&forces),
            turns: self.here.placement.turns(),
            strokes: terms.strokes(mesh, from.displacement, &self.here.displacement),
            displacement: self.here.displacement,
            effort,
        }
    }
}
