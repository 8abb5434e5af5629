//! The five stages, each a pure function of scene and state: no clock, no files, no memory that decides a result.

use std::sync::Arc;

use crate::adapt::{evaluate_indicators, project_displacements};
use crate::equilibrium::{
    Effort, Equilibrium, FactorError, Iterate, SolveError, Solved, Standing, Workspace, WorkspaceError, strain_energy,
};
use crate::model::{MOST_CONTROL_POINTS, ModelError, Tables, Unknowns, free_motion, starting_mesh};
use crate::pipeline::probes::read_probes;
use crate::pipeline::step_control::{Attempt, is_jump, is_jump_on_refinement, next_attempt};
use crate::pipeline::{Outcome, Parameter, Reading, Report};
use crate::scene::{Scene, Stage};
use crate::spline::Mesh;
use crate::state::{State, StepControl};

/// Why a stage could not be run to its end. The state before it stands.
#[derive(Debug, thiserror::Error)]
pub enum StageError {
    /// The increment was cut down to the least one and still no equilibrium was found.
    #[error(
        "step {step}, solve: no equilibrium at {attempted} from {reached}, and an increment below \
         {least_key} = {least} would be needed; the last attempt: {cause}"
    )]
    NoEquilibrium {
        /// Load step.
        step: u64,
        /// Where the last good state stands.
        reached: String,
        /// Where the last attempt would have stood.
        attempted: String,
        /// The key of the scene's least increment.
        least_key: &'static str,
        /// The scene's least increment, in the units of its parameter.
        least: f64,
        /// Why the last attempt failed.
        cause: Box<SolveError>,
    },
    /// The shell jumps, the jump is located, and the solver did not reach the shape beyond it.
    #[error(
        "step {step}, solve: the shell jumps between {reached} and {attempted}, and the shape beyond was not reached: \
         {cause}; raise solver.max_iterations"
    )]
    JumpNotFollowed {
        /// Load step.
        step: u64,
        /// Where the last good state stands.
        reached: String,
        /// Beyond the jump.
        attempted: String,
        /// Why the solve failed.
        cause: Box<SolveError>,
    },
    /// The refined mesh has no equilibrium at the load.
    #[error(
        "step {step}, re-equilibrate at {reached} on {} × {} elements: {cause}; raise solver.max_iterations, or adapt.threshold to \
         refine less at once, and go on with `foldline run SCENE --resume`",
        elements[0],
        elements[1]
    )]
    NotReEquilibrated {
        /// Load step.
        step: u64,
        /// Where the state stands.
        reached: String,
        /// Elements each way.
        elements: [usize; 2],
        /// Why the solve failed.
        cause: Box<SolveError>,
    },
    /// The equations do not fit in memory.
    #[error("step {step}, {stage} on {elements:?} elements: {cause}")]
    TooLarge {
        /// Load step.
        step: u64,
        /// The stage.
        stage: Stage,
        /// Elements each way.
        elements: [usize; 2],
        /// What the solver said.
        cause: FactorError,
    },
    /// Supports or loads do not fit the mesh.
    #[error("step {step}, {stage}: {cause}")]
    Model {
        /// Load step.
        step: u64,
        /// The stage.
        stage: Stage,
        /// What does not fit.
        cause: ModelError,
    },
    /// Refinement asks for more than memory holds.
    #[error(
        "step {step}, refine-knots: {} × {} elements would have {count} control points, and the most is {MOST_CONTROL_POINTS}; raise \
         adapt.threshold or adapt.length_limit_mm",
        elements[0],
        elements[1]
    )]
    RefinedTooFar {
        /// Load step.
        step: u64,
        /// Elements each way that were asked for.
        elements: [usize; 2],
        /// Control points of that mesh.
        count: usize,
    },
    /// The stage needs what the stage before it makes.
    #[error("step {step}: {stage} cannot follow {after}: {missing}")]
    OutOfOrder {
        /// Load step.
        step: u64,
        /// The stage.
        stage: Stage,
        /// The stage that made the state.
        after: &'static str,
        /// What is missing, in words.
        missing: &'static str,
    },
}

/// Runs the stages of one scene; keeps buffers of the mesh in hand, which a new one would fill with the same bits.
#[derive(Debug)]
pub struct Stages {
    scene: Scene,
    work: Option<Workspace>,
}

impl Stages {
    /// Stages of a scene.
    pub fn new(scene: Scene) -> Self {
        Self { scene, work: None }
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The state that the scene starts from: undeformed, before the first step.
    ///
    /// # Errors
    /// Where the scene cannot be made discrete, or its supports leave a rigid motion free.
    pub fn start(&self) -> Result<State, ModelError> {
        let mesh = starting_mesh(&self.scene)?;
        let unknowns = Unknowns::new(&self.scene, &mesh)?;
        if let Some(motion) = free_motion(&unknowns) {
            return Err(ModelError::FreeMotion { motion });
        }
        let turns = if unknowns.turns_are_unknown() { vec![[0.0; 3]; unknowns.sections().len()] } else { vec![] };
        Ok(State {
            turns,
            displacement: vec![[0.0; 3]; mesh.control_points.len()],
            mesh: Arc::new(mesh),
            marked: Default::default(),
            refined: None,
            step: 0,
            stage: None,
            parameter: 0.0,
            moment_n_mm: 0.0,
            strain_energy_n_mm: 0.0,
            negative_pivots: 0,
            control: StepControl::default(),
        })
    }

    /// Runs a stage. `observer` sees every Newton iterate.
    ///
    /// # Errors
    /// Where the stage cannot be run to its end; see [`StageError`].
    pub fn run(
        &mut self,
        stage: Stage,
        state: &State,
        observer: &mut dyn FnMut(&Iterate),
    ) -> Result<(State, Report), StageError> {
        let result = match stage {
            Stage::Solve => self.solve(state, observer),
            Stage::EvaluateIndicators => self.evaluate(state),
            Stage::RefineKnots => self.refine(state),
            Stage::ProjectDisplacements => self.project(state),
            Stage::ReEquilibrate => self.re_equilibrate(state, observer),
        };
        result.map(|(mut state, mut report)| {
            state.stage = Some(stage);
            report.stage = stage;
            (state, report)
        })
    }

    fn workspace(&mut self, mesh: &Arc<Mesh>, step: u64, stage: Stage) -> Result<(&Scene, &mut Workspace), StageError> {
        let kept = self.work.take().filter(|work| {
            let known = &work.discretization().mesh;
            Arc::ptr_eq(known, mesh) || known == mesh
        });
        let work = match kept {
            Some(work) => work,
            None => Workspace::new(&self.scene, mesh).map_err(|cause| match cause {
                WorkspaceError::Factor(cause) => {
                    StageError::TooLarge { step, stage, elements: mesh.element_counts(), cause }
                }
                WorkspaceError::Model(cause) => StageError::Model { step, stage, cause },
            })?,
        };
        Ok((&self.scene, self.work.insert(work)))
    }

    /// Moves the load on by one increment. Where that fails or jumps too coarsely, the state stays and only its step
    /// control changes.
    fn solve(&mut self, state: &State, observer: &mut dyn FnMut(&Iterate)) -> Result<(State, Report), StageError> {
        let step = state.step + 1;
        let attempt = next_attempt(&self.scene, state);
        let (scene, work) = self.workspace(&state.mesh, step, Stage::Solve)?;
        // A run that stands on an unstable branch (and says so) follows it; what ends an attempt is a further loss of
        // stability.
        let mut watch = |iterate: &Iterate| {
            observer(iterate);
            !attempt.may_jump && iterate.negative_pivots as u64 > state.negative_pivots
        };
        let solved = Equilibrium::new(scene, work).advance(Standing::of(state), attempt.target_deg, &mut watch);
        let mut report = self.report(state, step);
        report.attempted_parameter = attempt.target_deg;
        match solved {
            Ok(solved) => {
                let released = attempt.energy_released(state, &solved);
                let jumped = is_jump(released, state.strain_energy_n_mm, solved.energy);
                if jumped && !attempt.may_jump {
                    report.record_effort(solved.effort);
                    let control = attempt.control_after_jump(&state.control);
                    return Ok(reject(state, report, Outcome::RejectedJump, control));
                }
                let mut next = settle(state, &solved);
                next.step = step;
                next.parameter = attempt.target_deg;
                next.control = attempt.control_after_success(&state.control);
                report.record(&next, &solved);
                report.probes = self.read_probes(&next)?;
                report.jumped = jumped;
                report.energy_released_n_mm = if jumped { released } else { 0.0 };
                Ok((next, report))
            }
            Err(cause) => {
                report.record_effort(cause.effort());
                report.residual = cause.last().map_or(f64::NAN, |last| last.residual / last.reactions);
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
    fn stopped(&self, state: &State, attempt: Attempt, cause: SolveError) -> StageError {
        let parameter = Parameter::of(&self.scene);
        let (reached, attempted) = (parameter.shown(state.parameter), parameter.shown(attempt.target_deg));
        let (step, cause) = (state.step + 1, Box::new(cause));
        match state.control.jump_seen_at_deg {
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

    fn evaluate(&mut self, state: &State) -> Result<(State, Report), StageError> {
        let mut report = self.report(state, state.step);
        let Some(adapt) = self.scene.adapt.clone() else {
            return Err(out_of_order(state, Stage::EvaluateIndicators, "the scene has no [adapt]"));
        };
        let (scene, work) = self.workspace(&state.mesh, state.step, Stage::EvaluateIndicators)?;
        let indicators = evaluate_indicators(scene, &adapt, work.discretization(), &state.displacement);
        report.marked = [indicators.marked[0].len(), indicators.marked[1].len()];
        report.largest_indicator = indicators.largest;
        Ok((State { marked: indicators.marked, ..state.clone() }, report))
    }

    fn refine(&mut self, state: &State) -> Result<(State, Report), StageError> {
        if state.marked.iter().all(Vec::is_empty) {
            return Err(out_of_order(state, Stage::RefineKnots, "no knot span is marked"));
        }
        let finer = state.mesh.with_knots(&state.marked);
        if finer.control_points.len() > MOST_CONTROL_POINTS {
            let (step, elements, count) = (state.step, finer.element_counts(), finer.control_points.len());
            return Err(StageError::RefinedTooFar { step, elements, count });
        }
        // Integrated where the finer mesh is: what the energy changes here is the error of the coarser quadrature, and
        // projecting then changes nothing.
        let tables = Tables::on_elements_of(&self.scene, &state.mesh, &finer);
        let energy = self.scene.symmetry.copies() as f64 * strain_energy(&state.mesh, &tables, &state.displacement);
        let mut report = self.report(state, state.step);
        report.marked = [state.marked[0].len(), state.marked[1].len()];
        report.elements = finer.element_counts();
        let fits = Unknowns::new(&self.scene, &finer);
        report.unknowns =
            fits.map_err(|cause| StageError::Model { step: state.step, stage: Stage::RefineKnots, cause })?.count();
        report.strain_energy_n_mm = energy;
        let next = State {
            refined: Some(Arc::new(finer)),
            marked: Default::default(),
            strain_energy_n_mm: energy,
            ..state.clone()
        };
        Ok((next, report))
    }

    fn project(&mut self, state: &State) -> Result<(State, Report), StageError> {
        let Some(finer) = &state.refined else {
            return Err(out_of_order(state, Stage::ProjectDisplacements, "there is no refined mesh"));
        };
        let displacement = project_displacements(&state.mesh, finer, &state.displacement);
        let parts = self.scene.symmetry.copies() as f64;
        let (_, work) = self.workspace(finer, state.step, Stage::ProjectDisplacements)?;
        let strain_energy_n_mm = parts * work.energy(&displacement);
        let next = State { mesh: finer.clone(), refined: None, displacement, strain_energy_n_mm, ..state.clone() };
        let report = self.report(&next, next.step);
        Ok((next, report))
    }

    fn re_equilibrate(
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
        let solved = Equilibrium::new(scene, work).relax(Standing::of(state), &mut watch).map_err(|cause| {
            StageError::NotReEquilibrated {
                step,
                reached: Parameter::of(scene).shown(state.parameter),
                elements: state.mesh.element_counts(),
                cause: Box::new(cause),
            }
        })?;
        let released = state.strain_energy_n_mm + solved.work - solved.energy;
        let next = settle(state, &solved);
        let mut report = self.report(&next, step);
        report.record(&next, &solved);
        report.probes = self.read_probes(&next)?;
        // A finer mesh lowers the energy a little by itself; a jump passes over an unstable shape.
        report.jumped = unstable_on_the_way && is_jump_on_refinement(released, state.strain_energy_n_mm);
        if report.jumped {
            report.energy_released_n_mm = released;
        }
        Ok((next, report))
    }

    fn read_probes(&mut self, state: &State) -> Result<Vec<Reading>, StageError> {
        let (scene, work) = self.workspace(&state.mesh, state.step, Stage::Solve)?;
        Ok(read_probes(scene, work, Standing::of(state), state.strain_energy_n_mm))
    }

    /// A report of the state as it stands; the stage fills in what it did. `stage` is set by [`Self::run`].
    fn report(&mut self, state: &State, step: u64) -> Report {
        let unknowns = match &self.work {
            Some(work) if work.discretization().mesh == state.mesh => work.discretization().unknowns.count(),
            _ => Unknowns::new(&self.scene, &state.mesh).map_or(0, |unknowns| unknowns.count()),
        };
        Report {
            step,
            stage: Stage::Solve,
            outcome: Outcome::Done,
            driven_by: Parameter::of(&self.scene),
            work_n_mm: 0.0,
            probes: Vec::new(),
            parameter: state.parameter,
            attempted_parameter: state.parameter,
            moment_n_mm: state.moment_n_mm,
            strain_energy_n_mm: state.strain_energy_n_mm,
            elements: state.mesh.element_counts(),
            unknowns,
            iterations: 0,
            factorizations: 0,
            negative_pivots: state.negative_pivots,
            residual: 0.0,
            energy_released_n_mm: 0.0,
            jumped: false,
            marked: [0, 0],
            largest_indicator: [0.0; 2],
        }
    }
}

impl Report {
    fn record_effort(&mut self, effort: Effort) {
        self.iterations = effort.iterations;
        self.factorizations = effort.factorizations;
    }

    fn record(&mut self, state: &State, solved: &Solved) {
        self.record_effort(solved.effort);
        self.parameter = state.parameter;
        self.moment_n_mm = state.moment_n_mm;
        self.strain_energy_n_mm = state.strain_energy_n_mm;
        self.negative_pivots = state.negative_pivots;
        self.residual = solved.residual;
        self.work_n_mm = solved.work;
    }
}

/// The state at a new equilibrium.
fn settle(state: &State, solved: &Solved) -> State {
    State {
        displacement: solved.displacement.clone(),
        turns: solved.turns.clone(),
        marked: Default::default(),
        moment_n_mm: solved.moment,
        strain_energy_n_mm: solved.energy,
        negative_pivots: solved.negative_pivots as u64,
        ..state.clone()
    }
}

/// The state where it was, with another attempt to make.
fn reject(state: &State, mut report: Report, outcome: Outcome, control: StepControl) -> (State, Report) {
    report.outcome = outcome;
    (State { control, marked: Default::default(), ..state.clone() }, report)
}

fn out_of_order(state: &State, stage: Stage, missing: &'static str) -> StageError {
    StageError::OutOfOrder { step: state.step, stage, after: state.stage.map_or("the start", Stage::name), missing }
}
