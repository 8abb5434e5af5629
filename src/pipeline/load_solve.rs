//! Solve and re-equilibrate where the load is prescribed, and the way from an unstable equilibrium to a stable one.

use crate::equilibrium::{
    Continuation, Effort, Equilibrium, Iterate, Observer, SolveError, Solved, Standing, Workspace, soft_mode,
};
use crate::pipeline::ripple::{Watch, is_ripple};
use crate::pipeline::stages::{out_of_order, reject, settle};
use crate::pipeline::step_control::{
    Attempt, energy_released, is_jump, is_jump_on_refinement, known_release, next_attempt,
};
use crate::pipeline::{CriticalPoint, Outcome, Parameter, Report, StageError, Stages};
use crate::scene::{Scene, Stage};
use crate::shell::{norm, sub};
use crate::state::{Previous, State};

/// Largest motion off an unstable equilibrium along its soft mode, in thicknesses: beyond rounding by far, and far less
/// than what bending makes of it.
const SWITCHING_AMPLITUDE: f64 = 0.1;
/// A motion this many times as far as the path's before it is no step along that path. Near a limit point the rate grows
/// without bound, but a step that ends stable has not come to it; next to bifurcations of tape springs the ratio was 7 and
/// more.
const LEFT: f64 = 4.0;
/// Modes that are left one after the other. Each descent ends in a minimum of the energy but where a symmetry holds it on a
/// ridge; the tape spring in equal-sense bending has two such modes at once.
const MOST_MODES: usize = 8;

/// Whether the shell moved much farther than it did before for as much load: it has left its path for another one, though
/// next to a bifurcation that takes little energy. Known by the equilibrium before.
fn leaves_path(state: &State, to: f64, solved: &Solved) -> bool {
    let Some(previous) = &state.previous else { return false };
    let length = |from: &[[f64; 3]], to: &[[f64; 3]]| {
        from.iter().zip(to).map(|(u, v)| norm(sub(*v, *u)).powi(2)).sum::<f64>().sqrt()
    };
    let rate = length(&previous.displacement, &state.displacement) / (state.parameter - previous.parameter);
    length(&state.displacement, &solved.displacement) > LEFT * rate * (to - state.parameter)
}

/// How a solve came to its equilibrium.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    /// Along the path.
    Along,
    /// Over a ripple of the mesh.
    OverRipple,
    /// By a jump, or onto another path.
    OffPath,
}

impl Way {
    /// Of a solve that moved the load on from a state.
    fn of(state: &State, attempt: &Attempt, watch: &Watch, solved: &Solved) -> Self {
        let released = energy_released(state, solved);
        let ripples = watch.unstable && solved.negative_pivots == 0 && is_ripple(state, released);
        let bracketed = watch.unstable && state.control.jump_seen_at_deg.is_some();
        let left = (ripples || bracketed) && leaves_path(state, attempt.target_deg, solved);
        if left || is_jump(released, state.strain_energy_n_mm.max(solved.put_in), solved.energy) {
            Way::OffPath
        } else if ripples {
            Way::OverRipple
        } else {
            Way::Along
        }
    }
}

/// Equilibrium at another load. A descent leaves an unstable branch; a run that stands on one follows it by Newton's method, as
/// far as that goes.
fn reach(
    scene: &Scene,
    work: &mut Workspace,
    state: &State,
    target: f64,
    observer: Observer,
) -> Result<Solved, SolveError> {
    let from = Standing::of(state);
    if state.negative_pivots > 0 {
        match Continuation::new(scene, work).begin(from, target, observer) {
            Ok(point) => return Ok(point.solved),
            Err(stopped @ SolveError::Stopped { .. }) => return Err(stopped),
            Err(_) => {}
        }
    }
    Equilibrium::new(scene, work).after(state.previous.as_ref()).advance(from, target, observer)
}

impl Stages {
    /// Moves the load on by one increment. Where that fails or jumps too coarsely, the state stays and only its step
    /// control changes.
    pub(super) fn move_load(
        &mut self,
        state: &State,
        observer: &mut dyn FnMut(&Iterate),
    ) -> Result<(State, Report), StageError> {
        let step = state.step + 1;
        let attempt = next_attempt(&self.scene, state);
        let (scene, work) = self.workspace(&state.mesh, step, Stage::Solve)?;
        let mut watch = Watch::new(state, scene.symmetry.copies() as f64);
        let solved = reach(scene, work, state, attempt.target_deg, &mut |iterate| {
            observer(iterate);
            watch.sees_jump(iterate) && !attempt.may_jump
        });
        let mut report = self.report(state, step);
        report.attempted_parameter = attempt.target_deg;
        match solved {
            Ok(solved) => {
                let released = energy_released(state, &solved);
                let way = Way::of(state, &attempt, &watch, &solved);
                let is_to_be_located = match way {
                    Way::Along => watch.unstable,
                    Way::OverRipple => false,
                    Way::OffPath => true,
                };
                if is_to_be_located && !attempt.may_jump {
                    report.record_effort(solved.effort);
                    let control = attempt.control_after_jump(&state.control);
                    return Ok(reject(state, report, Outcome::RejectedJump, control));
                }
                let mut next = settle(state, &solved);
                next.step = step;
                next.parameter = attempt.target_deg;
                next.control = attempt.control_after_success(&self.scene, &state.control, solved.effort.iterations);
                next.path = None;
                // The path bends on from an equilibrium before only where it is one path, and where displacements say all.
                let onwards = way == Way::Along && state.negative_pivots == 0 && next.turns.is_empty();
                next.previous =
                    onwards.then(|| Previous { displacement: state.displacement.clone(), parameter: state.parameter });
                report.record(&next, &solved);
                if let Some(refinement) = next.refinement.as_mut().filter(|_| way != Way::Along) {
                    refinement.ripple_n_mm = if way == Way::OverRipple { released.max(0.0) } else { 0.0 };
                }
                report.probes = self.read_probes(&next)?;
                report.jumped = way == Way::OffPath;
                report.rippled = way == Way::OverRipple;
                report.critical_point = CriticalPoint::passed_by_load(state, &next).filter(|_| way == Way::Along);
                report.energy_released_n_mm = if way == Way::Along { Some(0.0) } else { known_release(released) };
                Ok((next, report))
            }
            Err(cause) => {
                report.record_failure(&cause);
                if matches!(cause, SolveError::Stopped { .. }) {
                    let control = attempt.control_after_jump(&state.control);
                    return Ok(reject(state, report, Outcome::RejectedJump, control));
                }
                match attempt.control_after_failure(&self.scene, state) {
                    Some(control) => Ok(reject(state, report, Outcome::RejectedNoEquilibrium, control)),
                    None => Err(self.stopped(state, attempt, cause)),
                }
            }
        }
    }

    /// The error of a solve that cannot be tried with a smaller increment.
    pub(super) fn stopped(&self, state: &State, attempt: Attempt, cause: SolveError) -> StageError {
        let parameter = Parameter::of(&self.scene);
        let (reached, attempted) = (parameter.shown(state.parameter), parameter.shown(attempt.target_deg));
        let (step, cause) = (state.step + 1, Box::new(cause));
        match state.control.jump_seen_at_deg {
            Some(_) if state.step == 0 => StageError::NoStart { step, attempted, cause },
            Some(_) => StageError::JumpNotFollowed { step, reached, attempted, cause },
            None => {
                let least = self.scene.least_increment();
                let least_key = match parameter {
                    Parameter::Rotation => "solver.least_increment_deg",
                    Parameter::LoadFactor => "load.least_increment",
                };
                StageError::NoEquilibrium { step, reached, attempted, least_key, least, cause }
            }
        }
    }

    /// Finds equilibrium on a refined mesh at the same load.
    pub(super) fn relax(
        &mut self,
        state: &State,
        observer: &mut dyn FnMut(&Iterate),
    ) -> Result<(State, Report), StageError> {
        let step = state.step;
        let mut unstable_on_the_way = false;
        let mut watch = |iterate: &Iterate| {
            observer(iterate);
            unstable_on_the_way |= iterate.negative_pivots > 0;
            false
        };
        let (scene, work) = self.workspace(&state.mesh, step, Stage::ReEquilibrate)?;
        let solved = Equilibrium::new(scene, work).relax(Standing::of(state), &mut watch);
        let solved = solved.map_err(|cause| self.not_re_equilibrated(state, cause))?;
        let released = energy_released(state, &solved);
        let mut next = settle(state, &solved);
        let mut report = self.report(&next, step);
        report.record(&next, &solved);
        report.probes = self.read_probes(&next)?;
        // A finer mesh lowers the energy a little by itself; a jump passes over an unstable shape.
        report.jumped = unstable_on_the_way && is_jump_on_refinement(state, released);
        if report.jumped {
            report.energy_released_n_mm = known_release(released);
            next.previous = None;
            next.refinement = None;
        } else if let Some(refinement) = &mut next.refinement {
            refinement.changed_n_mm += released.abs();
        }
        Ok((next, report))
    }

    pub(super) fn not_re_equilibrated(&self, state: &State, cause: SolveError) -> StageError {
        StageError::NotReEquilibrated {
            step: state.step,
            reached: Parameter::of(&self.scene).shown(state.parameter),
            elements: state.mesh.element_counts(),
            cause: Box::new(cause),
        }
    }

    /// Leaves an unstable equilibrium along its soft modes, one after the other.
    pub(super) fn switch_branch(
        &mut self,
        state: &State,
        observer: &mut dyn FnMut(&Iterate),
    ) -> Result<(State, Report), StageError> {
        if state.negative_pivots == 0 {
            return Err(out_of_order(state, Stage::SwitchBranch, "the equilibrium is stable"));
        }
        let amplitude = SWITCHING_AMPLITUDE * self.scene.material.thickness_mm();
        let failed = |stages: &Self, cause: SolveError| StageError::NotSwitched {
            step: state.step,
            reached: Parameter::of(&stages.scene).shown(state.parameter),
            cause: Box::new(cause),
        };
        let mut next = state.clone();
        let mut effort = Effort::default();
        let mut work_done = 0.0;
        for _ in 0..MOST_MODES {
            let (scene, work) = self.workspace(&state.mesh, state.step, Stage::SwitchBranch)?;
            let from = Standing::of(&next);
            let mut watch = |iterate: &Iterate| {
                observer(iterate);
                false
            };
            let left = soft_mode(work, from).and_then(|mode| {
                effort.factorizations += mode.factorizations;
                Equilibrium::new(scene, work).leave(from, &mode, amplitude, &mut watch)
            });
            let left = left.map_err(|cause| failed(self, cause))?;
            effort.iterations += left.effort.iterations;
            effort.factorizations += left.effort.factorizations;
            work_done += left.work;
            next = State { previous: None, ..settle(&next, &left) };
            if next.negative_pivots == 0 {
                let released = state.strain_energy_n_mm + work_done - next.strain_energy_n_mm;
                if let Some(path) = &state.path {
                    next.path = Some(self.path_on_branch(state, &next, path).map_err(|cause| failed(self, cause))?);
                }
                let mut report = self.report(&next, next.step);
                report.record(&next, &Solved { effort, work: work_done, ..left });
                report.probes = self.read_probes(&next)?;
                report.jumped = is_jump(released, state.strain_energy_n_mm, next.strain_energy_n_mm);
                report.energy_released_n_mm = known_release(released);
                return Ok((next, report));
            }
        }
        Err(StageError::StillUnstable {
            step: state.step,
            reached: Parameter::of(&self.scene).shown(state.parameter),
            modes: MOST_MODES,
            negative_pivots: next.negative_pivots,
        })
    }
}
