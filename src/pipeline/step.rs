//! A step of a drive in progress, and what every drive does alike.

use crate::equilibrium::{Configuration, Coordinates, Effort, Equilibrium, Iterate, SolveError, Solved, Workspace};
use crate::pipeline::StageError;
use crate::pipeline::probes::{read_connections, read_probes};
use crate::pipeline::step_control::{Attempt, energy_released, is_jump_on_refinement, known_release};
use crate::record::{Outcome, Report, Warning};
use crate::scene::{Parameter, Scene, Spring, Stage};
use crate::shell::norm;
use crate::state::{Course, DriveMemory, State, StepControl};

/// Angle, in degrees, beyond which a step may pass half a turn, where the rotation vector of a section goes back to its opposite.
const FARTHEST_TURN_DEG: f64 = 175.0;

/// A drive at a state: how it moves the structure on, and how it continues on a finer mesh or another branch.
pub(super) trait Drives {
    /// Takes a step. Where that fails or leads too far, the state stays and only the memory of the drive changes.
    fn solve(&mut self) -> Result<(State, Report), StageError>;

    /// Finds the equilibrium on the refined mesh of the state.
    fn re_equilibrate(&mut self) -> Result<(State, Report), StageError>;

    /// Moves from an unstable equilibrium to a stable one at the same load.
    fn switch_branch(&mut self) -> Result<(State, Report), StageError>;
}

/// A stage that looks for an equilibrium, with what it works on.
pub(super) struct Step<'a> {
    pub stage: Stage,
    pub scene: &'a Scene,
    /// Workspace of the state's mesh.
    pub work: &'a mut Workspace,
    /// State that the stage starts from.
    pub state: &'a State,
    /// Callback that sees every Newton iterate.
    pub observer: &'a mut dyn FnMut(&Iterate),
}

impl Step<'_> {
    /// Formats a value of the scene's parameter with its unit.
    pub fn shown(&self, parameter: f64) -> String {
        Parameter::of(self.scene).shown(parameter)
    }

    /// Returns the state before the step, with the drive's memory changed for another attempt.
    pub fn stay(&self, control: StepControl, course: Course) -> State {
        State {
            drive: DriveMemory { control, course },
            marked: self.state.mesh.no_knots(),
            superfluous: self.state.mesh.no_knots(),
            ..self.state.clone()
        }
    }

    /// Makes the report of a solve that was rejected.
    pub fn rejected(&self, outcome: Outcome, attempted_parameter: f64, effort: Effort) -> Report {
        Report {
            step: self.state.step + 1,
            outcome,
            attempted_parameter,
            iterations: effort.iterations,
            factorizations: effort.factorizations,
            ..Report::of(self.scene, self.state, self.work.discretization().unknowns.count())
        }
    }

    /// Makes the report of a solve that found no equilibrium.
    pub fn failed(&self, outcome: Outcome, attempted_parameter: f64, cause: &SolveError) -> Report {
        let residual = cause.last().map_or(f64::NAN, Iterate::relative_residual);
        Report { residual, ..self.rejected(outcome, attempted_parameter, cause.effort()) }
    }

    /// Makes the report of the state at a new equilibrium, with its probes.
    pub fn arrived(&mut self, next: &State, solved: &Solved) -> Result<Report, StageError> {
        self.check_springs(next)?;
        let Self { stage, scene, work, .. } = self;
        let probes = read_probes(scene, work, Configuration::of(next), next.strain_energy_n_mm)
            .map_err(|cause| StageError::Model { step: next.step, stage: *stage, cause })?;
        let connections = read_connections(work, Configuration::of(next));
        let warnings = connections.iter().filter_map(|connection| Warning::of_connection(next.parameter, connection));
        Ok(Report {
            warnings: warnings.collect(),
            connections,
            iterations: solved.effort.iterations,
            factorizations: solved.effort.factorizations,
            residual: solved.residual,
            work_n_mm: solved.balance.work,
            put_in_n_mm: solved.balance.put_in,
            probes,
            ..Report::of(scene, next, work.discretization().unknowns.count())
        })
    }

    /// Refuses a state in which a section with a spring of rotation has turned beyond what the spring can tell.
    fn check_springs(&self, next: &State) -> Result<(), StageError> {
        if self.scene.springs.is_empty() {
            return Ok(());
        }
        let unknowns = &self.work.discretization().unknowns;
        let supports = unknowns.supports();
        let Coordinates { placement, .. } = Coordinates::of(unknowns, Configuration::of(next));
        let springs = self.scene.springs.iter().filter(|spring| spring.rotation_n_mm_per_deg != [0.0; 3]);
        for Spring { name, section, .. } in springs {
            let index = supports.find(section).and_then(|support| supports.footprints[support].section);
            let angle_deg = index.map_or(0.0, |index| norm(placement.turn(index)).to_degrees());
            if angle_deg > FARTHEST_TURN_DEG {
                let (spring, section) = (name.clone(), section.clone());
                let parameter = self.shown(next.parameter);
                return Err(StageError::SpringTurnedOver { step: next.step, spring, section, angle_deg, parameter });
            }
        }
        Ok(())
    }

    /// Ends a step whose increment of the parameter found no equilibrium: a smaller one follows, if it is allowed.
    pub fn cut(&self, attempt: Attempt, cause: SolveError) -> Result<(State, Report), StageError> {
        match attempt.control_after_failure(self.scene, self.state) {
            Some(control) => {
                let report = self.failed(Outcome::RejectedNoEquilibrium, attempt.target, &cause);
                Ok((self.stay(control, self.state.drive.course.clone()), report))
            }
            None => Err(self.stopped(attempt, cause)),
        }
    }

    /// Makes the error of a solve that cannot be tried with a smaller increment.
    fn stopped(&self, attempt: Attempt, cause: SolveError) -> StageError {
        let state = self.state;
        let (reached, attempted) = (self.shown(state.parameter), self.shown(attempt.target));
        let (step, cause) = (state.step + 1, Box::new(cause));
        match state.drive.control.jump_beyond {
            Some(_) if state.step == 0 => StageError::NoStart { step, attempted, cause },
            Some(_) => StageError::JumpNotFollowed { step, reached, attempted, cause },
            None => {
                let least = self.scene.least_increment();
                let least_key = match Parameter::of(self.scene) {
                    Parameter::Rotation => "solver.least_increment_deg",
                    Parameter::LoadFactor => "load.least_increment",
                };
                StageError::NoEquilibrium { step, reached, attempted, least_key, least, cause }
            }
        }
    }

    /// Finds the equilibrium on a refined mesh at the same load.
    pub fn relax(&mut self) -> Result<(State, Report), StageError> {
        let Self { scene, work, state, observer, .. } = self;
        let mut unstable_on_the_way = false;
        let mut watch = |iterate: &Iterate| {
            observer(iterate);
            unstable_on_the_way |= iterate.negative_pivots > 0;
            false
        };
        let solved = Equilibrium::new(scene, work).relax(Configuration::of(state), &mut watch);
        let solved = solved.map_err(|cause| self.not_re_equilibrated(cause))?;
        let released = energy_released(self.state, &solved);
        let mut next = settle(self.state, &solved);
        let mut report = self.arrived(&next, &solved)?;
        // A finer mesh alone lowers the energy a little; a jump also passes over an unstable shape.
        // From a best approximation on a coarser mesh most of what is released is its own error.
        let is_coarsened = self.state.stage == Some(Stage::CoarsenKnots);
        report.jumped = unstable_on_the_way && !is_coarsened && is_jump_on_refinement(self.state, released);
        if report.jumped {
            report.energy_released_n_mm = known_release(released);
            next.drive.course = Course::Unknown;
            next.refinement = None;
        } else if let Some(refinement) = &mut next.refinement {
            refinement.changed_n_mm += released.abs();
        }
        Ok((next, report))
    }

    /// Makes the error of a refined mesh on which no equilibrium was found.
    pub fn not_re_equilibrated(&self, cause: SolveError) -> StageError {
        StageError::NotReEquilibrated {
            step: self.state.step,
            reached: self.shown(self.state.parameter),
            elements: self.state.mesh.elements(),
            cause: Box::new(cause),
        }
    }
}

/// Makes the state at a new equilibrium.
pub(super) fn settle(state: &State, solved: &Solved) -> State {
    State {
        displacement: solved.displacement.clone(),
        turns: solved.turns.clone(),
        marked: state.mesh.no_knots(),
        superfluous: state.mesh.no_knots(),
        moment_n_mm: solved.moment,
        strain_energy_n_mm: solved.balance.stored,
        largest_force_n: solved.largest_force,
        negative_pivots: solved.negative_pivots as u64,
        ..state.clone()
    }
}

/// Makes the error of a stage that lacks what another stage provides.
pub(super) fn out_of_order(state: &State, stage: Stage, missing: &'static str) -> StageError {
    StageError::OutOfOrder { step: state.step, stage, after: state.stage.map_or("the start", Stage::name), missing }
}
