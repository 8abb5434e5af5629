//! The drive along the path of equilibria, by arc length.

use crate::equilibrium::{Configuration, Continuation, ContinuedPoint, Direction, Iterate, Sense, SolveError};
use crate::pipeline::StageError;
use crate::pipeline::branch_switch::switch_branch;
use crate::pipeline::path_control::{Judgement, PathAttempt, next_path_attempt, path_begun};
use crate::pipeline::step::{Drives, Step, settle};
use crate::pipeline::step_control::{has_reached, next_attempt};
use crate::record::{CriticalPoint, Outcome, Report};
use crate::scene::{ArcLength, History, Scene};
use crate::state::{Course, DriveMemory, PathMemory, Rejection, State, StepControl};

/// Relative distance of the parameter from the target below which the target is reached.
const AT_TARGET: f64 = 1e-9;

/// Drive that follows the path of equilibria.
pub(super) struct PathDrive<'a> {
    pub step: Step<'a>,
    pub limits: &'a ArcLength,
}

impl Drives for PathDrive<'_> {
    /// Takes a step along the path. Where it fails, leads too far or passes a critical point that is not located yet,
    /// the state stays and only its memory changes.
    fn solve(&mut self) -> Result<(State, Report), StageError> {
        let state = self.step.state;
        if state.step >= self.limits.most_steps as u64 {
            return Err(self.too_long());
        }
        match state.drive.path() {
            None => self.begin(),
            Some(path) => self.continue_path(path),
        }
    }

    /// Finds the equilibrium on the path of the refined mesh, which differs from the path before.
    fn re_equilibrate(&mut self) -> Result<(State, Report), StageError> {
        match self.step.state.drive.path() {
            None => self.step.relax(),
            Some(path) => self.correct(path),
        }
    }

    /// Switches to a stable branch, along which the path continues.
    fn switch_branch(&mut self) -> Result<(State, Report), StageError> {
        let state = self.step.state;
        switch_branch(&mut self.step, |step, branch| match state.drive.path() {
            None => Ok(Course::Unknown),
            Some(path) => path_on_branch(step, state, branch, path).map(Course::Path),
        })
    }
}

impl PathDrive<'_> {
    /// Takes the first step: an increment of the parameter.
    fn begin(&mut self) -> Result<(State, Report), StageError> {
        let Step { scene, work, state, observer, .. } = &mut self.step;
        let attempt = next_attempt(scene, state);
        let found = Continuation::new(scene, work).begin(Configuration::of(state), attempt.target, &mut |iterate| {
            observer(iterate);
            false
        });
        let point = match found {
            Ok(point) => point,
            Err(cause) => return self.step.cut(attempt, cause),
        };
        let pivots = point.solved.negative_pivots as u64;
        let passed = CriticalPoint::between((1.0, state.negative_pivots), (1.0, pivots));
        if let (Some(_), Some(control)) = (passed, attempt.control_after_failure(scene, state)) {
            let course = state.drive.course.clone();
            let report = self.step.rejected(Outcome::RejectedCriticalPoint, attempt.target, point.solved.effort);
            return Ok((self.step.stay(control, course), report));
        }
        self.take(&point, path_begun(self.limits, &point), passed)
    }

    /// Takes a step from a point of the path.
    fn continue_path(&mut self, path: &PathMemory) -> Result<(State, Report), StageError> {
        let attempt = next_path_attempt(self.step.scene, self.limits, path);
        let (found, aimed_at) = self.find(path, attempt);
        let point = match found {
            Ok(point) => point,
            Err(cause) => {
                let report = self.step.failed(Outcome::RejectedNoEquilibrium, aimed_at, &cause);
                return self.shorten(path, attempt, report, &cause.to_string());
            }
        };
        let rejected = |outcome| self.step.rejected(outcome, point.parameter, point.solved.effort);
        match attempt.judge(self.step.state, path, &point) {
            Judgement::Taken(passed) => self.take(&point, attempt.after(self.limits, path, &point, passed), passed),
            Judgement::Past(ahead) => {
                let memory = PathMemory { critical_ahead: Some(ahead), ..path.clone() };
                let report = rejected(Outcome::RejectedCriticalPoint);
                Ok((self.reject(Rejection::CriticalPoint, memory), report))
            }
            Judgement::TooFar => {
                let turned = point.turn.clamp(-1.0, 1.0).acos().to_degrees();
                let why = format!("it ended {:.3e} mm away with the path turned by {turned:.0}°", point.distance);
                self.shorten(path, attempt, rejected(Outcome::RejectedSharpTurn), &why)
            }
        }
    }

    /// Finds the point that a step leads to: at the next corner of a history where the step reaches it, and at the
    /// target where the path leads beyond it. Also returns the parameter that was aimed at.
    fn find(&mut self, path: &PathMemory, attempt: PathAttempt) -> (Result<ContinuedPoint, SolveError>, f64) {
        let Step { scene, work, state, observer, .. } = &mut self.step;
        let mut watch = |iterate: &Iterate| {
            observer(iterate);
            false
        };
        let target = scene.load.target();
        let (from, mut continuation) = (Configuration::of(state), Continuation::new(scene, work));
        let ahead = state.parameter + attempt.length_mm * path.parameter_rate;
        let found = match corner_between(scene, state.parameter, ahead) {
            Some(corner) => continuation.step_to_corner(from, corner, &mut watch),
            None => continuation.step(from, &path.heading, attempt.length_mm, &mut watch),
        };
        match found {
            Ok(beyond)
                if beyond.parameter.abs() > target * (1.0 + AT_TARGET)
                    && !matches!(attempt.judge(state, path, &beyond), Judgement::TooFar) =>
            {
                let end = target.copysign(beyond.parameter);
                let spent = beyond.solved.effort;
                let found = continuation.step_to(from, &beyond, end, &mut watch).map(|mut point| {
                    point.solved.effort.iterations += spent.iterations;
                    point.solved.effort.factorizations += spent.factorizations;
                    point
                });
                (found, end)
            }
            found => (found, state.parameter),
        }
    }

    /// Returns the state before the step, with half the step to try.
    fn shorten(
        &self,
        path: &PathMemory,
        attempt: PathAttempt,
        report: Report,
        why: &str,
    ) -> Result<(State, Report), StageError> {
        let rejection = match report.outcome {
            Outcome::RejectedSharpTurn => Rejection::SharpTurn,
            _ => Rejection::NoEquilibrium,
        };
        match attempt.shortened(self.limits, path) {
            Some(memory) => Ok((self.reject(rejection, memory), report)),
            None => Err(StageError::PathLost {
                step: self.step.state.step + 1,
                reached: self.step.shown(self.step.state.parameter),
                shortest: self.limits.shortest_step,
                first_mm: path.first_mm,
                attempted_mm: attempt.length_mm,
                why: why.to_string(),
            }),
        }
    }

    /// Returns the state before the step, with the reason of its rejection and the memory for another attempt.
    fn reject(&self, rejection: Rejection, path: PathMemory) -> State {
        let control = StepControl { rejection: Some(rejection), ..self.step.state.drive.control };
        self.step.stay(control, Course::Path(path))
    }

    fn too_long(&self) -> StageError {
        StageError::PathTooLong {
            step: self.step.state.step,
            target: self.step.shown(self.step.scene.load.target()),
            reached: self.step.shown(self.step.state.parameter),
            most: self.limits.most_steps,
        }
    }

    /// Accepts a point: returns the state at it.
    fn take(
        &mut self,
        point: &ContinuedPoint,
        path: PathMemory,
        passed: Option<CriticalPoint>,
    ) -> Result<(State, Report), StageError> {
        let mut next = settle(self.step.state, &point.solved);
        next.step = self.step.state.step + 1;
        next.parameter = point.parameter;
        next.drive = DriveMemory { control: StepControl::default(), course: Course::Path(path) };
        let mut report = self.step.arrived(&next, &point.solved)?;
        report.critical_point = passed;
        Ok((next, report))
    }

    /// Moves to the nearest point of the refined mesh's path or, at the end of the run, to the one with the same
    /// parameter.
    fn correct(&mut self, path: &PathMemory) -> Result<(State, Report), StageError> {
        let heading = Direction { motion: path.heading.clone(), parameter: path.parameter_rate };
        let Step { scene, work, state, observer, .. } = &mut self.step;
        let mut watch = |iterate: &Iterate| {
            observer(iterate);
            false
        };
        let at_end = has_reached(scene, state, scene.load.target());
        let found = Continuation::new(scene, work).correct(Configuration::of(state), &heading, at_end, &mut watch);
        let point = match found {
            Ok(point) => point,
            Err(_) if state.negative_pivots == 0 => return self.descend(path),
            Err(cause) => return Err(self.step.not_re_equilibrated(cause)),
        };
        let before = (path.parameter_rate, state.negative_pivots);
        let mut next = settle(state, &point.solved);
        next.parameter = point.parameter;
        let after = (point.heading.parameter, next.negative_pivots);
        next.drive.course = Course::Path(PathMemory {
            heading: point.heading.motion,
            parameter_rate: point.heading.parameter,
            critical_ahead: None,
            ..path.clone()
        });
        let mut report = self.step.arrived(&next, &point.solved)?;
        // On the finer mesh the critical point may already have been passed.
        report.critical_point = CriticalPoint::between(before, after);
        Ok((next, report))
    }

    /// Descends to the finer mesh's equilibrium at the same load, which is possible where the shell is stable.
    fn descend(&mut self, path: &PathMemory) -> Result<(State, Report), StageError> {
        let (mut relaxed, report) = self.step.relax()?;
        let memory = path_on_branch(&mut self.step, &relaxed, &relaxed, path);
        relaxed.drive.course = Course::Path(memory.map_err(|cause| self.step.not_re_equilibrated(cause))?);
        Ok((relaxed, report))
    }
}

/// Memory of the path on a branch that was switched to from `before`; the parameter continues as before. A long step on
/// the old branch may be a tiny one here (a column that bends moves much farther than one that is compressed), so that
/// the distance between the branches becomes the unit of length where it is longer.
fn path_on_branch(step: &mut Step, before: &State, state: &State, path: &PathMemory) -> Result<PathMemory, SolveError> {
    let sense = Sense::Parameter { grows: path.parameter_rate > 0.0 };
    let mut continuation = Continuation::new(step.scene, step.work);
    let heading = continuation.heading_at(Configuration::of(state), sense)?;
    let moved = continuation.distance(&before.displacement, &state.displacement);
    Ok(PathMemory {
        first_mm: path.first_mm.max(moved),
        next_mm: path.next_mm.max(moved),
        heading: heading.motion,
        parameter_rate: heading.parameter,
        critical_ahead: None,
        at_bifurcation: false,
        ..path.clone()
    })
}

/// Finds the first load factor between two values at which a history has a corner, up to the end of the run.
fn corner_between(scene: &Scene, from: f64, to: f64) -> Option<f64> {
    let histories =
        scene.actions.iter().map(|action| &action.history).chain(scene.supports.iter().map(|support| &support.history));
    let end = scene.load.target() * (1.0 + AT_TARGET);
    let sense = (to - from).signum();
    let distance = |corner: &f64| sense * (corner - from);
    histories
        .flat_map(History::kinks)
        .filter(|corner| corner.abs() < end && distance(corner) > AT_TARGET * end && distance(corner) <= distance(&to))
        .min_by(|one, other| distance(one).total_cmp(&distance(other)))
}
