//! Equilibrium at a value of the scene's parameter: a minimum of the strain energy, less the work of loads, over the free
//! unknowns.
//!
//! Predictor: the tangent one, K Δq = Δf − ∂g/∂m Δm − Δg for loads f, given motions m and what free strains change internal
//! forces by, after which three Newton iterations a step reach 1e-7 of the
//! reactions; moving the ends alone needs 8 to 11. Where an equilibrium before is known, the path is bent on as a parabola
//! through it: the solves of `baseline-quarter.toml` take half the iterations that they take with tangents alone.
//! Corrector: [`Descent`].

use std::sync::Arc;

use crate::equilibrium::assembly::{Assembled, Want, strain_energy};
use crate::equilibrium::descent::{Descent, Ended, largest, length, product};
use crate::equilibrium::external::{External, subtract};
use crate::equilibrium::force_scale::ForceScale;
use crate::equilibrium::ledger::Before;
use crate::equilibrium::solve_error::{SolveError, WorkspaceError};
use crate::equilibrium::sparse::NegativePivots;
use crate::equilibrium::stability::SoftMode;
use crate::equilibrium::tangent_stiffness::TangentStiffness;
use crate::model::{Discretization, Unknowns};
use crate::scene::Scene;
use crate::shell::add;
use crate::spline::Mesh;
use crate::state::{Previous, State};

/// The parabola of the predictor is drawn on from a base of at least this share of the step: what rounding and the
/// tolerance leave in the equilibria grows with its inverse square.
const SHORTEST_BASE: f64 = 0.1;

/// Energies of two sides of a bifurcation that differ by less than this, relatively, are equal.
const CLEARLY: f64 = 1e-10;

/// What is known after an iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iterate {
    /// Newton steps taken.
    pub iteration: usize,
    /// Strain energy of the model, N·mm.
    pub energy: f64,
    /// |Tᵀ (g − f)|, N.
    pub residual: f64,
    /// What the residual is held against.
    pub forces: ForceScale,
    /// Negative pivots of the last factored stiffness.
    pub negative_pivots: usize,
    /// Step length along the last direction; 1 is a full Newton step.
    pub step_length: f64,
    /// Twice the largest magnitude of a negative pivot: what turning it positive adds, N/mm; 0 where there is none.
    pub shift: f64,
    /// Control point with the largest residual.
    pub worst_point: usize,
    /// Of a descent: energy of the model that has left the balance since its start, if reactions stay what they were, N·mm.
    pub released: f64,
}

impl Iterate {
    /// At a point with this gradient on the free unknowns, whose stiffness is not factored yet.
    pub(super) fn at(
        unknowns: &Unknowns,
        energy: f64,
        forces: ForceScale,
        gradient: &[f64],
        effort: Effort,
    ) -> Result<Self, SolveError> {
        let last = Self {
            iteration: effort.iterations,
            energy,
            residual: gradient.iter().map(|g| g * g).sum::<f64>().sqrt(),
            forces,
            negative_pivots: 0,
            step_length: 1.0,
            shift: 0.0,
            worst_point: unknowns.home_of(largest(gradient)),
            released: 0.0,
        };
        match last.energy.is_finite() && last.residual.is_finite() {
            true => Ok(last),
            false => Err(SolveError::NotANumber { last, effort }),
        }
    }

    /// |residual| over the forces that it is held against.
    pub fn relative_residual(&self) -> f64 {
        self.forces.share(self.residual)
    }

    /// Whether forces balance to this tolerance.
    pub fn is_equilibrium(&self, tolerance: f64) -> bool {
        self.forces.balances(self.residual, tolerance)
    }
}

/// A point of equilibrium.
#[derive(Clone, Debug)]
pub struct Solved {
    /// Displacement of the control points, mm.
    pub displacement: Vec<[f64; 3]>,
    /// Rotation vectors of the rigid sections where one of them turns freely, radians.
    pub turns: Vec<[f64; 3]>,
    /// Strain energy of the whole shell, N·mm.
    pub energy: f64,
    /// Work of loads, given motions and changes of the natural state on the whole shell since the start of the solve, N·mm: reactions, and factors of the
    /// actions, by their means before and after; strokes of the actions along the way that the solve took.
    pub work: f64,
    /// What the change of the natural state would have put into the whole shell had it stayed, and at least a hundred times
    /// what rounding of the displacement is worth, N·mm. Where a shell follows its natural state, or is carried off without
    /// strain, this is the measure of energies, not the little that it stores.
    pub put_in: f64,
    /// Turning ends: moment at each end of the whole shell, dΠ/dθ / 2, N·mm. Otherwise 0.
    pub moment: f64,
    /// Negative pivots of the stiffness there; 0 where the equilibrium is stable.
    pub negative_pivots: usize,
    /// |residual| over the forces that it is held against.
    pub residual: f64,
    /// The largest force met so far, N; see [`ForceScale::met`].
    pub largest_force: f64,
    /// What it took.
    pub effort: Effort,
}

/// What a solve cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Newton iterations.
    pub iterations: usize,
    /// Numeric factorizations.
    pub factorizations: usize,
}

/// Where a solve starts from.
#[derive(Clone, Copy, Debug)]
pub struct Standing<'s> {
    /// Displacement of the control points, mm.
    pub displacement: &'s [[f64; 3]],
    /// Rotation vectors of the rigid sections where one of them turns freely; empty otherwise.
    pub turns: &'s [[f64; 3]],
    /// The scene's parameter.
    pub parameter: f64,
    /// The largest force met so far, N; see [`ForceScale::met`].
    pub largest_force: f64,
}

impl<'s> Standing<'s> {
    /// A state.
    pub fn of(state: &'s State) -> Self {
        Self {
            displacement: &state.displacement,
            turns: &state.turns,
            parameter: state.parameter,
            largest_force: state.largest_force_n,
        }
    }
}

/// Buffers for one mesh. Holds nothing that decides a result: a new one gives the same bits.
#[derive(Debug)]
pub struct Workspace {
    pub(super) discretization: Discretization,
    pub(super) tangent: TangentStiffness,
    pub(super) assembled: Assembled,
    /// Where the stiffness in `assembled` and its factor were formed, and its negative pivots.
    pub(super) factored_at: Option<Factored>,
}

#[derive(Debug)]
pub(super) struct Factored {
    parameter: f64,
    displacement: Vec<[f64; 3]>,
    turns: Vec<[f64; 3]>,
    negative: usize,
}

impl Workspace {
    /// Tables, structure and symbolic factor for a mesh.
    ///
    /// # Errors
    /// Where supports or loads do not fit the mesh, or the factor does not fit in memory.
    pub fn new(scene: &Scene, mesh: &Arc<Mesh>) -> Result<Self, WorkspaceError> {
        let discretization = Discretization::new(scene, mesh)?;
        let tangent = TangentStiffness::new(&discretization)?;
        let assembled = Assembled::new(&discretization);
        Ok(Self { discretization, tangent, assembled, factored_at: None })
    }

    /// The mesh's tables and unknowns.
    pub fn discretization(&self) -> &Discretization {
        &self.discretization
    }

    /// Energy of the model at a displacement and a value of the parameter, N·mm.
    pub fn energy(&self, displacement: &[[f64; 3]], parameter: f64) -> f64 {
        let Discretization { tables, free_strains, .. } = &self.discretization;
        strain_energy(tables, displacement, free_strains.at(parameter))
    }

    /// Internal forces less loads on the control points, N: at equilibrium, the reactions of the supports.
    pub fn forces(&mut self, at: Standing) -> Vec<[f64; 3]> {
        let known = self.factored_at.as_ref().is_some_and(|known| known.is_at(&at));
        if !known {
            self.factored_at = None;
            self.assembled.assemble(&self.discretization, at.displacement, at.parameter, Want::Residual);
        }
        let loads = External::forces_at(&self.discretization, at.displacement, at.parameter);
        subtract(&self.assembled.residual, &loads)
    }

    /// Stiffness and factor at a displacement, unless the last solve left them there; returns the negative pivots. Not
    /// counted in the effort of a solve, which would then depend on what ran before in the same process.
    pub(super) fn factorize_at(&mut self, at: Standing) -> Result<usize, SolveError> {
        // Where sections turn freely the state decides the unknowns to rounding only: those that a solve ended with would
        // give other bits than those of the same state read from a log.
        let exact = !self.discretization.unknowns.turns_are_unknown();
        if let Some(known) = self.factored_at.as_ref().filter(|known| exact && known.is_at(&at)) {
            return Ok(known.negative);
        }
        self.form_at(at);
        let negative = self.factorize_formed()?.count;
        self.factored_at = Some(Factored::new(at, negative));
        Ok(negative)
    }

    /// Factors the matrix that was formed or filled in; not counted in the effort of a solve.
    pub(super) fn factorize_formed(&mut self) -> Result<NegativePivots, SolveError> {
        let factored = self.tangent.solver.factorize();
        factored.map_err(|cause| SolveError::Factor { cause, effort: Effort::default() })
    }

    /// The matrix on the free unknowns at a state, not factored.
    pub(super) fn form_at(&mut self, at: Standing) -> &[f64] {
        self.factored_at = None;
        let Self { discretization, tangent, assembled, .. } = self;
        assembled.assemble(discretization, at.displacement, at.parameter, Want::Stiffness);
        let external = External::new(discretization, at.displacement, at.parameter, assembled);
        let free = discretization.unknowns.of_displacement(at.displacement, at.turns, at.parameter);
        let placement = discretization.unknowns.place(&free, at.parameter);
        tangent.form(discretization, &placement, assembled, &external)
    }
}

impl Factored {
    fn new(at: Standing, negative: usize) -> Self {
        let (displacement, turns) = (at.displacement.to_vec(), at.turns.to_vec());
        Self { parameter: at.parameter, displacement, turns, negative }
    }

    fn is_at(&self, at: &Standing) -> bool {
        self.parameter == at.parameter && self.displacement == at.displacement && self.turns == at.turns
    }
}

/// Equilibrium of a scene on the mesh of a workspace.
#[derive(Debug)]
pub struct Equilibrium<'a> {
    scene: &'a Scene,
    work: &'a mut Workspace,
    previous: Option<&'a Previous>,
}

/// Watches iterates; `true` stops the solve.
pub type Observer<'o> = &'o mut dyn FnMut(&Iterate) -> bool;

impl<'a> Equilibrium<'a> {
    /// Works in these buffers.
    pub fn new(scene: &'a Scene, work: &'a mut Workspace) -> Self {
        Self { scene, work, previous: None }
    }

    /// Knows of an equilibrium before the one that [`Self::advance`] starts from, on the same path.
    pub fn after(self, previous: Option<&'a Previous>) -> Self {
        Self { previous, ..self }
    }

    /// From an equilibrium to one at another parameter.
    ///
    /// # Errors
    /// Where none is found within the limits, or the observer stops the solve.
    pub fn advance(&mut self, from: Standing, to: f64, observer: Observer) -> Result<Solved, SolveError> {
        let (start, bent, before) = self.predict(from, to);
        self.minimize(start, bent, from, to, &before, observer)
    }

    /// Equilibrium at the same parameter from a displacement that may be out of balance.
    ///
    /// # Errors
    /// As for [`Self::advance`].
    pub fn relax(&mut self, from: Standing, observer: Observer) -> Result<Solved, SolveError> {
        let discretization = &self.work.discretization;
        let start = discretization.unknowns.of_displacement(from.displacement, from.turns, from.parameter);
        let before = Before::unbalanced(self.work, from);
        self.minimize(start, None, from, from.parameter, &before, observer)
    }

    /// Down from an unstable equilibrium at the same parameter: off along its soft mode by a largest motion of `amplitude`
    /// mm, to the side that has less energy, and then as in [`Self::relax`].
    ///
    /// # Errors
    /// As for [`Self::advance`].
    pub fn leave(
        &mut self,
        from: Standing,
        mode: &SoftMode,
        amplitude: f64,
        observer: Observer,
    ) -> Result<Solved, SolveError> {
        let unknowns = &self.work.discretization.unknowns;
        let free = unknowns.of_displacement(from.displacement, from.turns, from.parameter);
        let side = |share: f64| -> Vec<f64> { free.iter().zip(&mode.free).map(|(q, m)| q + share * m).collect() };
        let (one, other) = (side(amplitude), side(-amplitude));
        // Of two sides that are alike, one and the same on every machine: rounding does not decide.
        let start = if self.lies_clearly_lower(&other, &one, from.parameter) { other } else { one };
        let before = Before::at(self.work, from);
        self.minimize(start, None, from, from.parameter, &before, observer)
    }

    /// Unknowns at `to`: along the tangent of the path where it is stable, or the old ones, whichever has less energy; and
    /// those along the parabola where they have even less.
    fn predict(&mut self, from: Standing, to: f64) -> (Vec<f64>, Option<Vec<f64>>, Before) {
        // Where the stiffness has no factor (exactly at a limit point), the old unknowns are as good a start.
        let negative = self.work.factorize_at(from).unwrap_or(usize::MAX);
        let Workspace { discretization, tangent: TangentStiffness { solver, .. }, assembled, .. } = &mut *self.work;
        let unknowns = &discretization.unknowns;
        let old = unknowns.of_displacement(from.displacement, from.turns, from.parameter);
        let placement = unknowns.place(&old, from.parameter);
        let loads = External::forces_at(discretization, from.displacement, from.parameter);
        let forces = subtract(&assembled.residual, &loads);
        let before = Before::with(discretization, &placement, &forces, from, assembled.energy);
        if negative > 0 {
            return (old, None, before);
        }
        let (given, target) = (unknowns.given_at(from.parameter), unknowns.given_at(to));
        let motion: Vec<f64> = given.iter().zip(&target).map(|(m0, m1)| m1 - m0).collect();
        let stiff = assembled.multiply(discretization, &placement.velocity(&[], &motion));
        let more = External::forces_at(discretization, from.displacement, to);
        let mut change = subtract(&subtract(&stiff, &more), &negated(&loads));
        if let Some(natural) = discretization.free_strains.at(to) {
            let freed = assembled.change_of_forces(discretization, from.displacement, Some(natural));
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

    /// The parabola through the equilibrium before, q₋ at parameter s₋, and the one in hand, q with the tangent step Δq to
    /// s + h: q + Δq + (q₋ − q + Δq a) / a² with a = (s − s₋)/h.
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

    /// Whether it is less by more than rounding.
    fn lies_clearly_lower(&self, one: &[f64], other: &[f64], parameter: f64) -> bool {
        let (difference, energy) = self.rise(one, other, parameter);
        difference < -CLEARLY * energy.abs()
    }

    /// Strain energy less work of the loads at `one` less that at `other`, and the strain energy there.
    fn rise(&self, one: &[f64], other: &[f64], parameter: f64) -> (f64, f64) {
        let discretization = &self.work.discretization;
        let [one, other] = [one, other].map(|free| discretization.unknowns.place(free, parameter).displacement());
        let strokes = discretization.loads.strokes(&discretization.mesh, &other, &one);
        let done = discretization.loads.work(&strokes, parameter);
        let energy = self.work.energy(&other, parameter);
        (self.work.energy(&one, parameter) - done - energy, energy)
    }

    /// Descends from `bent` where the stiffness there is positive definite, and else from `unknowns`.
    fn minimize(
        &mut self,
        unknowns: Vec<f64>,
        bent: Option<Vec<f64>>,
        from: Standing,
        parameter: f64,
        before: &Before,
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

impl Workspace {
    /// What a solve has found; remembers that stiffness and factor stand there.
    pub(super) fn solved(
        &mut self,
        scene: &Scene,
        parameter: f64,
        before: &Before,
        ended: Ended,
        last: &Iterate,
    ) -> Solved {
        let largest_force = last.forces.met_here();
        let at = Standing { displacement: &ended.displacement, turns: &ended.turns, parameter, largest_force };
        let put_in = before.put_in(&self.discretization, parameter, &ended.displacement);
        let rounding = last.forces.rounding * length(&ended.displacement);
        self.factored_at = Some(Factored::new(at, last.negative_pivots));
        let unknowns = &self.discretization.unknowns;
        let parts = scene.symmetry.copies() as f64;
        let moment = match scene.end_rotation() {
            // All given motions are proportional to θ in degrees.
            Some(_) => 0.5 * parts * product(&ended.reactions, &unknowns.given_at(1.0)) * 1.0_f64.to_degrees(),
            None => 0.0,
        };
        Solved {
            energy: parts * last.energy,
            work: parts
                * (before.work(&self.discretization, parameter, &ended.reactions, &ended.strokes)
                    + 0.5 * (put_in[0] + put_in[1])),
            put_in: parts * put_in[0].abs().max(put_in[1].abs()).max(100.0 * rounding),
            moment,
            negative_pivots: last.negative_pivots,
            residual: last.relative_residual(),
            largest_force,
            effort: ended.effort,
            displacement: ended.displacement,
            turns: ended.turns,
        }
    }
}

fn negated(forces: &[[f64; 3]]) -> Vec<[f64; 3]> {
    forces.iter().map(|force| force.map(|value| -value)).collect()
}
