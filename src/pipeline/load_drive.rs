//! The drive by load: increments of the parameter, which are cut where they fail or jump.

use crate::equilibrium::{
    Configuration, Continuation, Effort, Equilibrium, Iterate, Observer, SolveError, Solved, Workspace,
};
use crate::pipeline::StageError;
use crate::pipeline::branch_switch::switch_branch;
use crate::pipeline::ripple::{Watch, is_ripple};
use crate::pipeline::step::{Drives, Step, settle};
use crate::pipeline::step_control::{Attempt, energy_released, is_jump, known_release, next_attempt};
use crate::record::{CriticalPoint, Outcome, Report};
use crate::scene::Scene;
use crate::shell::{add, norm, scaled, sub};
use crate::state::{Course, DriveMemory, Previous, State, StepControl};

/// Ratio of the rates of motion in a step and in the one before, beyond which the shell has changed to another branch.
/// Near a limit point the rate grows without bound, but a step that ends stable has not come to it; next to
/// bifurcations of tape springs the ratio was 7 and more.
const BRANCH_CHANGE_RATIO: f64 = 4.0;

/// Steps that a return from a jump on refining goes back beyond the equilibrium that the step began at, one after the other:
/// a mesh that is too coarse may pass the limit point by more than a step. The course is taken for straight.
const STEPS_BACK: [f64; 4] = [0.0, 1.0, 3.0, 7.0];

/// Drive that moves the load on by increments.
pub(super) struct LoadDrive<'a> {
    pub step: Step<'a>,
}

impl Drives for LoadDrive<'_> {
    /// Moves the load on by one increment. Where that fails or jumps too coarsely, the state stays and only its step
    /// control changes.
    fn solve(&mut self) -> Result<(State, Report), StageError> {
        let Step { scene, work, state, observer, .. } = &mut self.step;
        let attempt = next_attempt(scene, state);
        let mut watch = Watch::new(state, scene.symmetry.copies() as f64);
        let solved = reach(scene, work, state, attempt.target, &mut |iterate| {
            observer(iterate);
            watch.sees_jump(iterate) && !attempt.may_jump
        });
        let solved = match solved {
            Ok(solved) => solved,
            Err(cause @ SolveError::Stopped { .. }) => {
                let report = self.step.failed(Outcome::RejectedJump, attempt.target, &cause);
                return Ok((self.before_jump(attempt), report));
            }
            Err(cause) => return self.step.cut(attempt, cause),
        };
        let arrival = Arrival::of(self.step.state, &attempt, &watch, &solved);
        let is_to_be_located = match arrival {
            Arrival::AlongPath => watch.unstable,
            Arrival::OverRipple => false,
            Arrival::OffPath => true,
        };
        if is_to_be_located && !attempt.may_jump {
            let report = self.step.rejected(Outcome::RejectedJump, attempt.target, solved.effort);
            return Ok((self.before_jump(attempt), report));
        }
        self.take(attempt, arrival, &solved)
    }

    /// Finds the equilibrium on the refined mesh. Where the shell jumps on it, the step has passed a limit point that the
    /// coarser mesh did not show: the drive returns to before it, and the jump is located on this mesh.
    fn re_equilibrate(&mut self) -> Result<(State, Report), StageError> {
        let (relaxed, report) = self.step.relax()?;
        let returned = if report.jumped { self.before_refining(&report)? } else { None };
        Ok(returned.unwrap_or((relaxed, report)))
    }

    fn switch_branch(&mut self) -> Result<(State, Report), StageError> {
        switch_branch(&mut self.step, |_, _| Ok(Course::Unknown))
    }
}

impl LoadDrive<'_> {
    /// Returns the state before the step, with a jump ahead to be located.
    fn before_jump(&self, attempt: Attempt) -> State {
        let DriveMemory { control, course } = &self.step.state.drive;
        self.step.stay(attempt.control_after_jump(control), course.clone())
    }

    /// Returns to a stable equilibrium before a step that turned out, on a finer mesh, to have passed a limit point: the one
    /// that the step began at, or where that lies beyond it too, one that the course so far leads back to. `None` where the
    /// course is not known, the jump is located well enough already, or none is found.
    fn before_refining(&mut self, jumped: &Report) -> Result<Option<(State, Report)>, StageError> {
        let Step { scene, work, state, observer, .. } = &mut self.step;
        let Some(previous) = state.drive.previous() else { return Ok(None) };
        let step = state.parameter - previous.parameter;
        if step <= scene.snap_tolerance() {
            return Ok(None);
        }
        let mut effort = Effort { iterations: jumped.iterations, factorizations: jumped.factorizations };
        for back in STEPS_BACK {
            let parameter = previous.parameter - back * step;
            if parameter <= 0.0 {
                break;
            }
            let moved = |(there, here): (&[f64; 3], &[f64; 3])| add(*there, scaled(back, sub(*there, *here)));
            let near: Vec<[f64; 3]> = previous.displacement.iter().zip(&state.displacement).map(moved).collect();
            let mut loses_stability = |iterate: &Iterate| {
                observer(iterate);
                iterate.negative_pivots > 0
            };
            let from = Configuration::of(state);
            match Equilibrium::new(scene, work).reach(from, parameter, &near, &mut loses_stability) {
                Ok(solved) => {
                    let effort = effort.and(solved.effort);
                    return self.returned(parameter, &Solved { effort, ..solved }).map(Some);
                }
                Err(cause) => effort = effort.and(cause.effort()),
            }
        }
        Ok(None)
    }

    /// The state at an equilibrium before a jump on refining, which is ahead again.
    fn returned(&mut self, parameter: f64, solved: &Solved) -> Result<(State, Report), StageError> {
        let state = self.step.state;
        let mut next = settle(state, solved);
        next.parameter = parameter;
        next.refinement = None;
        let control = StepControl { jump_beyond: Some(state.parameter), rejection: None, ..state.drive.control };
        next.drive = DriveMemory { control, course: Course::Unknown };
        let report = self.step.arrived(&next, solved)?;
        Ok((next, Report { attempted_parameter: state.parameter, ..report }))
    }

    /// Accepts the step: returns the state at the attempted load.
    fn take(&mut self, attempt: Attempt, arrival: Arrival, solved: &Solved) -> Result<(State, Report), StageError> {
        let Step { scene, state, .. } = self.step;
        let released = energy_released(state, solved);
        let mut next = settle(state, solved);
        next.step = state.step + 1;
        next.parameter = attempt.target;
        // An equilibrium before helps to predict only where both lie on one path, and where displacements determine the
        // state.
        let onwards = arrival == Arrival::AlongPath && state.negative_pivots == 0 && next.turns.is_empty();
        next.drive = DriveMemory {
            control: attempt.control_after_success(scene, &state.drive.control, solved.effort.iterations),
            course: match onwards {
                true => Course::Load(Previous { displacement: state.displacement.clone(), parameter: state.parameter }),
                false => Course::Unknown,
            },
        };
        if let Some(refinement) = next.refinement.as_mut().filter(|_| arrival != Arrival::AlongPath) {
            refinement.ripple_n_mm = if arrival == Arrival::OverRipple { released.max(0.0) } else { 0.0 };
        }
        let mut report = self.step.arrived(&next, solved)?;
        report.jumped = arrival == Arrival::OffPath;
        report.rippled = arrival == Arrival::OverRipple;
        report.critical_point = CriticalPoint::passed_by_load(state, &next).filter(|_| arrival == Arrival::AlongPath);
        report.energy_released_n_mm = if arrival == Arrival::AlongPath { Some(0.0) } else { known_release(released) };
        Ok((next, report))
    }
}

/// Whether the shell moved much farther than it did before for as much load: it has left its path for another one,
/// though next to a bifurcation that takes little energy. The rate before follows from the equilibrium before.
fn leaves_path(state: &State, to: f64, solved: &Solved) -> bool {
    let Some(previous) = state.drive.previous() else { return false };
    let length = |from: &[[f64; 3]], to: &[[f64; 3]]| {
        from.iter().zip(to).map(|(u, v)| norm(sub(*v, *u)).powi(2)).sum::<f64>().sqrt()
    };
    let rate = length(&previous.displacement, &state.displacement) / (state.parameter - previous.parameter);
    length(&state.displacement, &solved.displacement) > BRANCH_CHANGE_RATIO * rate * (to - state.parameter)
}

/// The way in which a solve came to its equilibrium.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Arrival {
    /// The solve followed the path.
    AlongPath,
    /// The solve passed over a ripple of the mesh.
    OverRipple,
    /// The solve jumped, or changed to another path.
    OffPath,
}

impl Arrival {
    /// Classifies a solve that moved the load on from a state.
    fn of(state: &State, attempt: &Attempt, watch: &Watch, solved: &Solved) -> Self {
        let released = energy_released(state, solved);
        let ripples = watch.unstable && solved.negative_pivots == 0 && is_ripple(state, released);
        let bracketed = watch.unstable && state.drive.control.jump_beyond.is_some();
        let left = (ripples || bracketed) && leaves_path(state, attempt.target, solved);
        if left || is_jump(released, solved.balance.scale(state.strain_energy_n_mm), solved.balance.stored) {
            Arrival::OffPath
        } else if ripples {
            Arrival::OverRipple
        } else {
            Arrival::AlongPath
        }
    }
}

/// Solves for the equilibrium at another load. A descent leaves an unstable branch; a run that is on one follows it by
/// Newton's method, as far as that goes.
fn reach(
    scene: &Scene,
    work: &mut Workspace,
    state: &State,
    target: f64,
    observer: Observer,
) -> Result<Solved, SolveError> {
    let from = Configuration::of(state);
    if state.negative_pivots > 0 {
        match Continuation::new(scene, work).begin(from, target, observer) {
            Ok(point) => return Ok(point.solved),
            Err(stopped @ SolveError::Stopped { .. }) => return Err(stopped),
            Err(_) => {}
        }
    }
    Equilibrium::new(scene, work).after(state.drive.previous()).advance(from, target, observer)
}
