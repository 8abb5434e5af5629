//! Solve and re-equilibrate where the path of equilibria is followed by arc length.

use crate::equilibrium::{Continuation, ContinuedPoint, Direction, Iterate, Sense, SolveError, Standing};
use crate::pipeline::path_control::{CriticalPoint, Judgement, PathAttempt, next_path_attempt, path_begun};
use crate::pipeline::stages::{reject, settle};
use crate::pipeline::step_control::{has_reached, next_attempt};
use crate::pipeline::{Outcome, Parameter, Report, StageError, Stages};
use crate::scene::{ArcLength, History, Scene, Stage};
use crate::state::{PathMemory, Rejection, State, StepControl};

/// A parameter this close to the target, relatively, is there.
const AT_TARGET: f64 = 1e-9;

impl Stages {
    /// One step along the path. Where it fails, goes too far or passes a critical point that is not located yet, the state
    /// stays and only its memory changes.
    pub(super) fn step_along_path(
        &mut self,
        limits: &ArcLength,
        state: &State,
        observer: &mut dyn FnMut(&Iterate),
    ) -> Result<(State, Report), StageError> {
        if state.step >= limits.most_steps as u64 {
            return Err(self.too_long(limits, state));
        }
        match &state.path {
            None => self.begin_path(limits, state, observer),
            Some(path) => self.continue_path(limits, state, path, observer),
        }
    }

    /// The first step: an increment of the parameter.
    fn begin_path(
        &mut self,
        limits: &ArcLength,
        state: &State,
        observer: &mut dyn FnMut(&Iterate),
    ) -> Result<(State, Report), StageError> {
        let step = state.step + 1;
        let attempt = next_attempt(&self.scene, state);
        let (scene, work) = self.workspace(&state.mesh, step, Stage::Solve)?;
        let found = Continuation::new(scene, work).begin(Standing::of(state), attempt.target_deg, &mut |iterate| {
            observer(iterate);
            false
        });
        match found {
            Ok(point) => {
                let pivots = point.solved.negative_pivots as u64;
                let passed = CriticalPoint::between((1.0, state.negative_pivots), (1.0, pivots));
                if let (Some(_), Some(control)) = (passed, attempt.control_after_failure(&self.scene, state)) {
                    let mut report = self.report(state, step);
                    report.record_effort(point.solved.effort);
                    report.attempted_parameter = attempt.target_deg;
                    return Ok(reject(state, report, Outcome::RejectedCriticalPoint, control));
                }
                let path = path_begun(limits, &point);
                self.taken(state, &point, path, passed)
            }
            Err(cause) => {
                let mut report = self.report(state, step);
                report.attempted_parameter = attempt.target_deg;
                report.record_failure(&cause);
                match attempt.control_after_failure(&self.scene, state) {
                    Some(control) => Ok(reject(state, report, Outcome::RejectedNoEquilibrium, control)),
                    None => Err(self.stopped(state, attempt, cause)),
                }
            }
        }
    }

    fn continue_path(
        &mut self,
        limits: &ArcLength,
        state: &State,
        path: &PathMemory,
        observer: &mut dyn FnMut(&Iterate),
    ) -> Result<(State, Report), StageError> {
        let step = state.step + 1;
        let attempt = next_path_attempt(&self.scene, limits, path);
        let target = self.scene.load.target();
        let (scene, work) = self.workspace(&state.mesh, step, Stage::Solve)?;
        let mut watch = |iterate: &Iterate| {
            observer(iterate);
            false
        };
        let (from, mut continuation) = (Standing::of(state), Continuation::new(scene, work));
        let mut aimed_at = state.parameter;
        let ahead = state.parameter + attempt.length_mm * path.parameter_rate;
        let corner = corner_between(scene, state.parameter, ahead);
        let mut found = match corner {
            Some(corner) => continuation.step_to_corner(from, corner, &mut watch),
            None => continuation.step(from, &path.heading, attempt.length_mm, &mut watch),
        };
        if let Ok(beyond) = &found
            && beyond.parameter.abs() > target * (1.0 + AT_TARGET)
            && !matches!(attempt.judge(state, path, beyond), Judgement::TooFar)
        {
            let end = target.copysign(beyond.parameter);
            let spent = beyond.solved.effort;
            aimed_at = end;
            found = continuation.step_to(from, beyond, end, &mut watch).map(|mut point| {
                point.solved.effort.iterations += spent.iterations;
                point.solved.effort.factorizations += spent.factorizations;
                point
            });
        }
        match found {
            Err(cause) => {
                let mut report = self.report(state, step);
                report.record_failure(&cause);
                report.attempted_parameter = aimed_at;
                let why = cause.to_string();
                self.shorten(limits, state, path, attempt, (report, Outcome::RejectedNoEquilibrium, why))
            }
            Ok(point) => {
                let judgement = attempt.judge(state, path, &point);
                let mut report = self.report(state, step);
                report.record_effort(point.solved.effort);
                report.attempted_parameter = point.parameter;
                match judgement {
                    Judgement::Taken(passed) => {
                        let next = attempt.after(limits, path, &point, passed);
                        self.taken(state, &point, next, passed)
                    }
                    Judgement::Past(ahead) => {
                        report.outcome = Outcome::RejectedCriticalPoint;
                        let memory = PathMemory { critical_ahead: Some(ahead), ..path.clone() };
                        Ok((turned_down(state, Rejection::CriticalPoint, memory), report))
                    }
                    Judgement::TooFar => {
                        let why = format!(
                            "it ended {:.3e} mm away with the path turned by {:.0}°",
                            point.distance,
                            point.turn.clamp(-1.0, 1.0).acos().to_degrees()
                        );
                        self.shorten(limits, state, path, attempt, (report, Outcome::RejectedSharpTurn, why))
                    }
                }
            }
        }
    }

    fn shorten(
        &self,
        limits: &ArcLength,
        state: &State,
        path: &PathMemory,
        attempt: PathAttempt,
        (mut report, outcome, why): (Report, Outcome, String),
    ) -> Result<(State, Report), StageError> {
        report.outcome = outcome;
        let rejection = match outcome {
            Outcome::RejectedSharpTurn => Rejection::SharpTurn,
            _ => Rejection::NoEquilibrium,
        };
        match attempt.shortened(limits, path) {
            Some(memory) => Ok((turned_down(state, rejection, memory), report)),
            None => Err(StageError::PathLost {
                step: state.step + 1,
                reached: Parameter::of(&self.scene).shown(state.parameter),
                shortest: limits.shortest_step,
                first_mm: path.first_mm,
                attempted_mm: attempt.length_mm,
                why,
            }),
        }
    }

    fn too_long(&self, limits: &ArcLength, state: &State) -> StageError {
        let parameter = Parameter::of(&self.scene);
        StageError::PathTooLong {
            step: state.step,
            target: parameter.shown(self.scene.load.target()),
            reached: parameter.shown(state.parameter),
            most: limits.most_steps,
        }
    }

    /// The state at the new point.
    fn taken(
        &mut self,
        state: &State,
        point: &ContinuedPoint,
        path: PathMemory,
        passed: Option<CriticalPoint>,
    ) -> Result<(State, Report), StageError> {
        let mut next = settle(state, &point.solved);
        next.step = state.step + 1;
        next.parameter = point.parameter;
        next.control = StepControl::default();
        next.path = Some(path);
        next.previous = None;
        let mut report = self.report(&next, next.step);
        report.attempted_parameter = point.parameter;
        report.record(&next, &point.solved);
        report.critical_point = passed;
        report.probes = self.read_probes(&next)?;
        Ok((next, report))
    }

    /// On a refined mesh the path is another: its point nearest to where the shell is, or, at the end of the run, the one
    /// with that parameter.
    pub(super) fn correct_path(
        &mut self,
        state: &State,
        path: &PathMemory,
        observer: &mut dyn FnMut(&Iterate),
    ) -> Result<(State, Report), StageError> {
        let heading = Direction { motion: path.heading.clone(), parameter: path.parameter_rate };
        let (scene, work) = self.workspace(&state.mesh, state.step, Stage::ReEquilibrate)?;
        let mut watch = |iterate: &Iterate| {
            observer(iterate);
            false
        };
        let at_end = has_reached(scene, state, scene.load.target());
        let found = Continuation::new(scene, work).correct(Standing::of(state), &heading, at_end, &mut watch);
        let point = match found {
            Ok(point) => point,
            // Where the shell is stable it can be let down to the finer mesh's equilibrium at the same load.
            Err(_) if state.negative_pivots == 0 => {
                let (relaxed, report) = self.relax(state, observer)?;
                let memory = self.path_on_branch(&relaxed, &relaxed, path);
                let memory = memory.map_err(|cause| self.not_re_equilibrated(state, cause))?;
                return Ok((State { path: Some(memory), ..relaxed }, report));
            }
            Err(cause) => return Err(self.not_re_equilibrated(state, cause)),
        };
        let mut next = settle(state, &point.solved);
        next.parameter = point.parameter;
        next.path = Some(PathMemory {
            heading: point.heading.motion,
            parameter_rate: point.heading.parameter,
            critical_ahead: None,
            ..path.clone()
        });
        let mut report = self.report(&next, next.step);
        report.record(&next, &point.solved);
        // A finer mesh has its critical points elsewhere: one may now lie behind the shell that lay ahead of it.
        report.critical_point = CriticalPoint::between(
            (path.parameter_rate, state.negative_pivots),
            (next.path.as_ref().map_or(0.0, |path| path.parameter_rate), next.negative_pivots),
        );
        report.probes = self.read_probes(&next)?;
        Ok((next, report))
    }

    /// Memory on the branch that was switched to from `before`: onwards with the parameter as before. What was a long step
    /// before may be nothing here (a column that bends moves much farther than one that is compressed), so that the way from
    /// one branch to the other becomes the unit where it is longer.
    pub(super) fn path_on_branch(
        &mut self,
        before: &State,
        state: &State,
        path: &PathMemory,
    ) -> Result<PathMemory, SolveError> {
        let (scene, work) = match self.work.as_mut() {
            Some(work) => (&self.scene, work),
            None => return Ok(path.clone()),
        };
        let sense = Sense::Parameter { grows: path.parameter_rate > 0.0 };
        let mut continuation = Continuation::new(scene, work);
        let heading = continuation.heading_at(Standing::of(state), sense)?;
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
}

/// The first load factor on the way at which a history has a corner, up to where the run ends.
fn corner_between(scene: &Scene, from: f64, to: f64) -> Option<f64> {
    let histories =
        scene.actions.iter().map(|action| &action.history).chain(scene.supports.iter().map(|support| &support.history));
    let end = scene.load.target() * (1.0 + AT_TARGET);
    let way = (to - from).signum();
    let distance = |corner: &f64| way * (corner - from);
    histories
        .flat_map(History::kinks)
        .filter(|corner| corner.abs() < end && distance(corner) > AT_TARGET * end && distance(corner) <= distance(&to))
        .min_by(|one, other| distance(one).total_cmp(&distance(other)))
}

/// The state where it was, with another attempt to make.
fn turned_down(state: &State, rejection: Rejection, path: PathMemory) -> State {
    let control = StepControl { rejection: Some(rejection), ..state.control };
    State { control, marked: Default::default(), path: Some(path), ..state.clone() }
}
