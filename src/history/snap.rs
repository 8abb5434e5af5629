//! Where exactly a run jumped or lost its stability: from the last stable state before, the load is halved until it is
//! known. The path beyond it, followed by arc length, shows what kind of critical point it is.

use crate::equilibrium::{
    Configuration, Continuation, Equilibrium, Iterate, Observer, Sense, SoftMode, SolveError, Workspace, WorkspaceError,
};
use crate::history::bisection::LoadBisection;
use crate::history::logged_scene::{LoggedSceneError, check_terms};
use crate::history::stability::mode_of;
use crate::history::states::{RemakeError, States};
use crate::journal::Log;
use crate::pipeline::{is_jump, known_release};
use crate::record::{CriticalPoint, Outcome, Parameter};
use crate::scene::Scene;
use crate::state::State;

/// A jump or loss of stability, located.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SnapReport {
    /// Last value of the parameter at which the shell is stable where it was, and the first at which it is not.
    pub bracket: [f64; 2],
    /// Moment on both sides, N·mm.
    pub moment_n_mm: [f64; 2],
    /// Energy released at the end of the bracket, N·mm; `None` where it is not known.
    pub energy_released_n_mm: Option<f64>,
    /// Negative pivots: in the last stable state, the most on the way through the jump, and after it.
    pub negative_pivots: [usize; 3],
    /// What the path passes there: limit point or bifurcation, and how many pivots change sign. `None` where the path was
    /// lost before it passed anything.
    pub critical: Option<CriticalPoint>,
    /// The mode that is softest in the last stable state.
    pub mode: SoftMode,
    /// Undeformed place of the control point that moves most in it, mm.
    pub mode_at: [f64; 3],
    /// The last stable state.
    pub stable: State,
    /// Number of solves that the search took.
    pub solves: usize,
}

/// Why a jump could not be located.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SnapError {
    /// The log holds no jump, and no equilibrium in it is unstable.
    #[error("no stage of this log jumped or lost its stability; the farthest state in it is at {farthest}")]
    NoJump {
        /// Parameter of the farthest state.
        farthest: String,
    },
    /// A state of the log is not available.
    #[error(transparent)]
    State(#[from] RemakeError),
    /// It was made with other terms of the caller's own.
    #[error(transparent)]
    Terms(#[from] LoggedSceneError),
    /// The jump is in the first step: there is no stable state before it.
    #[error(
        "the run jumps or loses its stability in its first step: there is no stable state in the log to go back to; run it with a smaller increment"
    )]
    NothingBefore,
    /// The jump does not happen on the mesh before it.
    #[error(
        "the shell goes from {from} to {to} without a jump and stays stable on the mesh that it had: that came from refining \
         the mesh; run the scene from a finer mesh to bisect it"
    )]
    OnRefinedMesh {
        /// Parameter of the last stable state.
        from: String,
        /// Parameter of the jump.
        to: String,
    },
    /// A solve failed.
    #[error("a solve from {from} to {to} failed")]
    Solve {
        /// Parameter at which the solve started.
        from: String,
        /// Parameter to which it was to lead.
        to: String,
        /// The error of the solver.
        source: Box<SolveError>,
    },
    /// The equations do not fit in memory, or the scene not the mesh.
    #[error(transparent)]
    Workspace(#[from] WorkspaceError),
}

/// The index of the first stage of a log that jumped or ended in an unstable equilibrium.
pub fn first_loss_of_stability(log: &Log) -> Option<usize> {
    let place = log.entries().iter().position(|entry| {
        let report = &entry.record.report;
        let found = report.outcome == Outcome::Done && report.stage.finds_equilibrium();
        report.jumped || (found && report.negative_pivots > 0)
    })?;
    Some(log.first() + place)
}

/// The error for a log that was read in parts and holds no jump; `farthest` is the largest value of the parameter in
/// it.
pub fn no_jump(scene: &Scene, farthest: f64) -> SnapError {
    SnapError::NoJump { farthest: Parameter::of(scene).shown(farthest) }
}

/// Locates the first jump or loss of stability of a log to `tolerance`, on the mesh of the last stable state before it;
/// `states` are those of the log, or of a part of it that begins before the jump, with the terms of the caller's own that it was
/// made with.
///
/// # Errors
/// Where the log holds no such thing, was made with other terms, or a solve fails.
pub fn find_snap(states: &mut States, scene: &Scene, tolerance: f64) -> Result<SnapReport, SnapError> {
    let log = states.log();
    let shown = |value: f64| Parameter::of(scene).shown(value);
    let Some(jump) = first_loss_of_stability(log) else {
        let parameters = log.entries().iter().map(|entry| entry.record.report.parameter);
        return Err(no_jump(scene, parameters.fold(0.0, f64::max)));
    };
    check_terms(log, jump, states.own_terms())?;
    let (before, behind) = log.entries().split_at(jump - log.first());
    let reached = behind[0].record.report.parameter;
    // By arc length the last stable point may lie at a higher load than the first one behind the limit point.
    let before = before.iter().rposition(|entry| {
        let report = &entry.record.report;
        report.parameter < reached || (report.path_length_mm.is_some() && report.negative_pivots == 0)
    });
    let before = before.map(|place| log.first() + place);
    let start = states.at(before.ok_or(SnapError::NothingBefore)?)?;
    let mut work = Workspace::with_terms(scene, &start.mesh, states.own_terms())?;
    let mut attempts = SnapSearch { scene, work: &mut work, count: 0 };

    let mut stable = start;
    let mut beyond = reached.max(stable.parameter);
    let along_path = stable.drive.path().is_some();
    loop {
        let next =
            if beyond > stable.parameter { attempts.solve_unless_jump(&stable, beyond)? } else { Some(stable.clone()) };
        match next {
            None => break,
            Some(next) if along_path && attempts.count < MOST_ATTEMPTS => {
                stable = next;
                beyond = stable.parameter + scene.load.increment();
            }
            Some(_) => return Err(SnapError::OnRefinedMesh { from: shown(stable.parameter), to: shown(beyond) }),
        }
    }
    let mut search = LoadBisection::new(stable.parameter, beyond, tolerance);
    while let Some(parameter) = search.next() {
        let next = attempts.solve_unless_jump(&stable, parameter)?;
        search = search.narrowed(parameter, next.is_none());
        if let Some(next) = next {
            stable = next;
        }
    }
    let bracket = search.bracket();
    let (after, work_done, most_negative) = attempts.solve_across_jump(&stable, bracket[1])?;
    let critical = attempts.critical_point_after(&stable, bracket);
    let solves = attempts.count;
    let (mode, mode_at) = mode_of(scene, &mut work, &stable).map_err(|source| SnapError::Solve {
        from: shown(stable.parameter),
        to: shown(stable.parameter),
        source: Box::new(source),
    })?;
    Ok(SnapReport {
        bracket,
        moment_n_mm: [stable.moment_n_mm, after.moment_n_mm],
        energy_released_n_mm: known_release(stable.strain_energy_n_mm + work_done - after.strain_energy_n_mm),
        negative_pivots: [stable.negative_pivots as usize, most_negative, after.negative_pivots as usize],
        critical,
        mode,
        mode_at,
        stable,
        solves,
    })
}

/// Solves before a search gives up.
const MOST_ATTEMPTS: usize = 100;

struct SnapSearch<'a> {
    scene: &'a Scene,
    work: &'a mut Workspace,
    count: usize,
}

impl SnapSearch<'_> {
    /// The equilibrium at a rotation, if the shell reaches it without passing an unstable shape or releasing energy.
    fn solve_unless_jump(&mut self, from: &State, parameter: f64) -> Result<Option<State>, SnapError> {
        let stable = from.negative_pivots as usize;
        let (reached, work) = match self.solve(from, parameter, &mut |iterate| iterate.negative_pivots > stable) {
            Ok(reached) => reached,
            // Beyond a limit point there is nothing to converge to near by.
            Err(
                SolveError::Stopped { .. } | SolveError::TooManyIterations { .. } | SolveError::LineSearchFailed { .. },
            ) => {
                return Ok(None);
            }
            Err(source) => return Err(self.failed(from, parameter, source)),
        };
        let released = from.strain_energy_n_mm + work - reached.strain_energy_n_mm;
        let jumped = is_jump(released, from.strain_energy_n_mm, reached.strain_energy_n_mm);
        Ok((!jumped).then_some(reached))
    }

    /// Follows the path from the last stable state until something changes. Steps grow from what the bracket is wide, since
    /// the length of the path to a limit point goes with the square root of that.
    fn critical_point_after(&mut self, from: &State, bracket: [f64; 2]) -> Option<CriticalPoint> {
        let mut continuation = Continuation::new(self.scene, self.work);
        let start = continuation.heading_at(Configuration::of(from), Sense::Parameter { grows: true }).ok()?;
        let mut length = (bracket[1] - bracket[0]).abs().max(f64::EPSILON * bracket[1].abs()) / start.parameter;
        let mut heading = start;
        let mut at = from.clone();
        for _ in 0..MOST_ATTEMPTS {
            self.count += 1;
            let Ok(point) = continuation.step(Configuration::of(&at), &heading.motion, length, &mut |_| false) else {
                length *= 0.5;
                continue;
            };
            let here = (heading.parameter, at.negative_pivots);
            let passed = CriticalPoint::between(here, (point.heading.parameter, point.solved.negative_pivots as u64));
            if passed.is_some() {
                return passed;
            }
            at = State {
                displacement: point.solved.displacement,
                turns: point.solved.turns,
                parameter: point.parameter,
                negative_pivots: point.solved.negative_pivots as u64,
                ..at
            };
            heading = point.heading;
            length *= 2.0;
        }
        None
    }

    fn failed(&self, from: &State, parameter: f64, source: SolveError) -> SnapError {
        let shown = |value: f64| Parameter::of(self.scene).shown(value);
        SnapError::Solve { from: shown(from.parameter), to: shown(parameter), source: Box::new(source) }
    }

    /// The equilibrium at a rotation however it is reached, the work done, and the most negative pivots on the way.
    fn solve_across_jump(&mut self, from: &State, parameter: f64) -> Result<(State, f64, usize), SnapError> {
        let mut most = 0;
        let mut watch = |iterate: &Iterate| {
            most = most.max(iterate.negative_pivots);
            false
        };
        let reached = self.solve(from, parameter, &mut watch);
        let (reached, work) = reached.map_err(|source| self.failed(from, parameter, source))?;
        Ok((reached, work, most))
    }

    fn solve(&mut self, from: &State, parameter: f64, watch: Observer) -> Result<(State, f64), SolveError> {
        self.count += 1;
        let solved = Equilibrium::new(self.scene, self.work).advance(Configuration::of(from), parameter, watch)?;
        let reached = State {
            displacement: solved.displacement,
            turns: solved.turns,
            parameter,
            moment_n_mm: solved.moment,
            strain_energy_n_mm: solved.balance.stored,
            largest_force_n: solved.largest_force,
            negative_pivots: solved.negative_pivots as u64,
            ..from.clone()
        };
        Ok((reached, solved.balance.work))
    }
}
