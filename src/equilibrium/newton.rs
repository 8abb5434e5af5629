//! Equilibrium at a value of the scene's parameter: a minimum of the strain energy, less the work of loads, over the free
//! unknowns.
//!
//! Predictor: the tangent one, K Δq = Δf − ∂g/∂m Δm − Δg for loads f, given motions m and what free strains change
//! internal forces by, after which three Newton iterations a step reach 1e-7 of the reactions; moving the ends alone
//! needs 8 to 11. Where an equilibrium before is known, the path is extrapolated as a parabola through it: the solves
//! of `baseline-quarter.toml` take half the iterations that they take with tangents alone. Corrector: [`Descent`].

use crate::equilibrium::assembly::subtract;
use crate::equilibrium::configuration::{Configuration, Coordinates};
use crate::equilibrium::descent::Descent;
use crate::equilibrium::iterate::Observer;
use crate::equilibrium::ledger::SolveStart;
use crate::equilibrium::solve_error::SolveError;
use crate::equilibrium::solved::Solved;
use crate::equilibrium::stability::SoftMode;
use crate::equilibrium::tangent_stiffness::TangentStiffness;
use crate::equilibrium::workspace::Workspace;
use crate::scene::Scene;
use crate::shell::add;
use crate::state::Previous;

/// Smallest base of the predictor's parabola, relative to the step: the errors that rounding and the tolerance leave in
/// the equilibria grow with its inverse square.
const SHORTEST_BASE: f64 = 0.1;

/// Relative difference of energies below which both sides of a bifurcation count as equal.
const CLEARLY: f64 = 1e-10;

/// Solver for equilibria of a scene on the mesh of a workspace.
#[derive(Debug)]
pub struct Equilibrium<'a> {
    scene: &'a Scene,
    work: &'a mut Workspace,
    previous: Option<&'a Previous>,
}

impl<'a> Equilibrium<'a> {
    /// Creates a solver that uses the buffers of `work`.
    pub fn new(scene: &'a Scene, work: &'a mut Workspace) -> Self {
        Self { scene, work, previous: None }
    }

    /// Uses an equilibrium before the one that [`Self::advance`] starts from, on the same path, for the predictor.
    pub fn after(self, previous: Option<&'a Previous>) -> Self {
        Self { previous, ..self }
    }

    /// Solves from an equilibrium to one at another parameter.
    ///
    /// # Errors
    /// Where none is found within the limits, or the observer stops the solve.
    pub fn advance(&mut self, from: Configuration, to: f64, observer: Observer) -> Result<Solved, SolveError> {
        let (start, bent, before) = self.predict(from, to);
        self.minimize(start, bent, from, to, &before, observer)
    }

    /// Solves for the equilibrium at the same parameter from a displacement that may be out of balance.
    ///
    /// # Errors
    /// As for [`Self::advance`].
    pub fn relax(&mut self, from: Configuration, observer: Observer) -> Result<Solved, SolveError> {
        let start = from.free(&self.work.discretization.unknowns);
        let before = SolveStart::unbalanced(self.work, from);
        self.minimize(start, None, from, from.parameter, &before, observer)
    }

    /// Solves for the equilibrium at another parameter from a displacement that is thought to be near it.
    ///
    /// # Errors
    /// As for [`Self::advance`], and where the stiffness has no factor at `from`.
    pub fn reach(
        &mut self,
        from: Configuration,
        to: f64,
        near: &[[f64; 3]],
        observer: Observer,
    ) -> Result<Solved, SolveError> {
        let start =
            Configuration { displacement: near, parameter: to, ..from }.free(&self.work.discretization.unknowns);
        self.work.factorize_at(from)?;
        let before = SolveStart::at(self.work, from);
        self.minimize(start, None, from, to, &before, observer)
    }

    /// Descends from an unstable equilibrium to another one at the same parameter: moves off along its soft mode by a
    /// largest motion of `amplitude` mm, to the side that has less energy, and continues as [`Self::relax`] does.
    ///
    /// # Errors
    /// As for [`Self::advance`].
    pub fn leave(
        &mut self,
        from: Configuration,
        mode: &SoftMode,
        amplitude: f64,
        observer: Observer,
    ) -> Result<Solved, SolveError> {
        let free = from.free(&self.work.discretization.unknowns);
        let side = |share: f64| -> Vec<f64> { free.iter().zip(&mode.free).map(|(q, m)| q + share * m).collect() };
        let (one, other) = (side(amplitude), side(-amplitude));
        // Of two equal sides the same one is taken on every machine: rounding does not decide.
        let start = if self.lies_clearly_lower(&other, &one, from.parameter) { other } else { one };
        let before = SolveStart::at(self.work, from);
        self.minimize(start, None, from, from.parameter, &before, observer)
    }

    /// Predicts the unknowns at `to`: along the tangent of the path where it is stable, or the old ones, whichever have
    /// less energy; and those along the parabola where they have even less.
    fn predict(&mut self, from: Configuration, to: f64) -> (Vec<f64>, Option<Vec<f64>>, SolveStart) {
        // Where the stiffness has no factor (exactly at a limit point), the old unknowns are as good a start.
        let negative = self.work.factorize_at(from).unwrap_or(usize::MAX);
        let Workspace { discretization, tangent: TangentStiffness { solver, .. }, assembled, .. } = &mut *self.work;
        let unknowns = &discretization.unknowns;
        let Coordinates { free: old, placement, .. } = Coordinates::of(unknowns, from);
        let forces = assembled.forces();
        let before = SolveStart::with(&placement, &forces, from, assembled.energy);
        if negative > 0 {
            return (old, None, before);
        }
        let (given, target) = (unknowns.given_at(from.parameter), unknowns.given_at(to));
        let motion: Vec<f64> = given.iter().zip(&target).map(|(m0, m1)| m1 - m0).collect();
        let stiff = assembled.multiply(discretization, &placement.velocity(&[], &motion));
        let more = discretization.external_forces(from.displacement, to);
        let mut change = subtract(&subtract(&stiff, &more), &negated(&assembled.external));
        let natural = discretization.natural_at(to);
        if natural.iter().any(Option::is_some) {
            let freed = assembled.change_of_forces(discretization, from.displacement, &natural);
            change.iter_mut().zip(freed).for_each(|(sum, force)| *sum = add(*sum, force));
        }
        let mut step = placement.restrict(&change);
        for (sum, turned) in step.iter_mut().zip(placement.restrict_rate(&forces, &motion)) {
            *sum = -(*sum + turned);
        }
        solver.solve(&mut step);
        let along: Vec<f64> = old.iter().zip(&step).map(|(q, dq)| q + dq).collect();
        let bent = self.bend(&old, &step, from.parameter, to);
        let start = if self.lies_lower(&along, &old, to) { along } else { old };
        let bent = bent.filter(|bent| self.lies_lower(bent, &start, to));
        (start, bent, before)
    }

    /// Extrapolates along the parabola through the equilibrium before, q₋ at parameter s₋, and the current one, q with
    /// the tangent step Δq to s + h: q + Δq + (q₋ − q + Δq a) / a² with a = (s − s₋)/h.
    fn bend(&self, old: &[f64], step: &[f64], from: f64, to: f64) -> Option<Vec<f64>> {
        let previous = self.previous?;
        let ratio = (from - previous.parameter) / (to - from);
        if !(ratio.is_finite() && ratio > SHORTEST_BASE) {
            return None;
        }
        let unknowns = &self.work.discretization.unknowns;
        let before = unknowns.of_displacement(&previous.displacement, &[], previous.parameter);
        let bent = |((q, dq), p): ((&f64, &f64), &f64)| q + dq + (p - q + dq * ratio) / (ratio * ratio);
        Some(old.iter().zip(step).zip(&before).map(bent).collect())
    }

    /// Whether strain energy less work of the loads is no more at `one` than at `other`.
    fn lies_lower(&self, one: &[f64], other: &[f64], parameter: f64) -> bool {
        let (difference, _) = self.rise(one, other, parameter);
        difference <= 0.0
    }

    /// Whether strain energy less work of the loads is less at `one` than at `other` by more than rounding.
    fn lies_clearly_lower(&self, one: &[f64], other: &[f64], parameter: f64) -> bool {
        let (difference, energy) = self.rise(one, other, parameter);
        difference < -CLEARLY * energy.abs()
    }

    /// Computes the strain energy less work of the loads at `one` minus that at `other`, and the strain energy at
    /// `other`.
    fn rise(&self, one: &[f64], other: &[f64], parameter: f64) -> (f64, f64) {
        let discretization = &self.work.discretization;
        let [one, other] = [one, other].map(|free| discretization.unknowns.configure(free, parameter).displacement());
        let strokes = discretization.terms.strokes(&discretization.mesh, &other, &one);
        let done = discretization.terms.work(&strokes, parameter);
        let energy = self.work.energy(&other, parameter);
        (self.work.energy(&one, parameter) - done - energy, energy)
    }

    /// Descends from `bent` where the stiffness there is positive definite, and else from `unknowns`.
    fn minimize(
        &mut self,
        unknowns: Vec<f64>,
        bent: Option<Vec<f64>>,
        from: Configuration,
        parameter: f64,
        before: &SolveStart,
        observer: Observer,
    ) -> Result<Solved, SolveError> {
        let (tolerance, max_iterations) = (self.scene.solver.tolerance, self.scene.solver.max_iterations);
        self.work.factored_at = None;
        let is_bent = bent.is_some();
        let mut descent = Descent::new(self.work, from, parameter, bent.unwrap_or_else(|| unknowns.clone()));
        let mut first = descent.iterate();
        if is_bent && !first.as_ref().is_ok_and(|first| first.negative_pivots == 0) {
            descent.start_at(from, unknowns);
            first = descent.iterate();
        }
        let mut first = Some(first);
        let last = loop {
            let mut last = first.take().unwrap_or_else(|| descent.iterate())?;
            last.released = descent.released_since(before);
            if observer(&last) {
                return Err(SolveError::Stopped { last, effort: descent.effort });
            }
            if last.is_equilibrium(tolerance) {
                break last;
            }
            if last.iteration >= max_iterations {
                return Err(SolveError::TooManyIterations { last, effort: descent.effort });
            }
            descent.step(&last)?;
        };
        let ended = descent.finish();
        Ok(self.work.solved(self.scene, parameter, before, ended, &last))
    }
}

fn negated(forces: &[[f64; 3]]) -> Vec<[f64; 3]> {
    forces.iter().map(|force| force.map(|value| -value)).collect()
}
