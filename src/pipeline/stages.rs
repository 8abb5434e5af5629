//! The stages, each a pure function of scene and state: no clock, no files, no memory that decides a result.

use std::sync::Arc;

use crate::adapt::{evaluate_indicators, project_displacements};
use crate::digest::{Feed, Hash};
use crate::equilibrium::{Effort, Iterate, SolveError, Solved, Standing, Workspace, WorkspaceError, strain_energy};
use crate::model::{
    At, FreeStrains, MOST_CONTROL_POINTS, ModelError, Tables, TermSource, Unknowns, check_balance, free_motion,
    remarks, starting_mesh,
};
use crate::pipeline::probes::read_probes;
use crate::pipeline::{Outcome, Parameter, Reading, Report, StageError, Warning};
use crate::scene::{Scene, Stage};
use crate::spline::Mesh;
use crate::state::{PathMemory, Previous, Refinement, State, StepControl};

/// Runs the stages of one scene; keeps buffers of the mesh in hand, which a new one would fill with the same bits.
#[derive(Debug)]
pub struct Stages {
    pub(super) scene: Scene,
    pub(super) own: Vec<Arc<dyn TermSource>>,
    pub(super) work: Option<Workspace>,
}

impl Stages {
    /// Stages of a scene.
    pub fn new(scene: Scene) -> Self {
        Self::with_terms(scene, Vec::new())
    }

    /// Stages of a scene with energies or loads of the caller's own.
    pub fn with_terms(scene: Scene, own: Vec<Arc<dyn TermSource>>) -> Self {
        Self { scene, own, work: None }
    }

    /// Energies and loads of the caller's own.
    pub fn own_terms(&self) -> &[Arc<dyn TermSource>] {
        &self.own
    }

    /// Hash of what decides the results: of the scene, and of the terms where there are any of the caller's own.
    pub fn hash(&self) -> Hash {
        if self.own.is_empty() {
            return self.scene.hash();
        }
        let mut feed = Feed::new("foldline scene with terms");
        feed.bytes(self.scene.hash().as_bytes());
        for source in &self.own {
            feed.integer(source.name().len() as u64);
            feed.bytes(source.name().as_bytes());
            feed.bytes(source.hash().as_bytes());
        }
        feed.finish()
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The state that the scene starts from: undeformed, before the first step.
    ///
    /// # Errors
    /// Where the scene cannot be made discrete, its supports leave a rigid motion free, or its loads push one that is
    /// only held so.
    pub fn start(&self) -> Result<State, ModelError> {
        let mesh = starting_mesh(&self.scene)?;
        let unknowns = Unknowns::new(&self.scene, &mesh)?;
        if let Some(motion) = free_motion(&unknowns) {
            return Err(ModelError::FreeMotion { motion });
        }
        check_balance(&self.scene, &mesh, &unknowns)?;
        if unknowns.count() == 0 {
            return Err(ModelError::NothingFree { elements: mesh.element_counts() });
        }
        let turns = if unknowns.turns_are_unknown() { vec![[0.0; 3]; unknowns.sections().len()] } else { vec![] };
        Ok(State { turns, ..State::undeformed(mesh) })
    }

    /// What supports and actions of the scene come to where its words leave it open: a sentence each.
    ///
    /// # Errors
    /// Where supports or loads do not fit the mesh of the state.
    pub fn remarks(&self, state: &State) -> Result<Vec<String>, ModelError> {
        remarks(&self.scene, &state.mesh, &Unknowns::new(&self.scene, &state.mesh)?)
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
            Stage::Solve => match self.scene.continuation.clone() {
                Some(limits) => self.step_along_path(&limits, state, observer),
                None => self.move_load(state, observer),
            },
            Stage::SwitchBranch => self.switch_branch(state, observer),
            Stage::EvaluateIndicators => self.evaluate(state),
            Stage::RefineKnots => self.refine(state),
            Stage::ProjectDisplacements => self.project(state),
            Stage::ReEquilibrate => match &state.path {
                Some(path) if self.scene.continuation.is_some() => self.correct_path(state, path, observer),
                _ => self.relax(state, observer),
            },
        };
        result.map(|(mut next, mut report)| {
            next.stage = Some(stage);
            report.stage = stage;
            self.warn(state, &next, &mut report);
            (next, report)
        })
    }

    pub(super) fn workspace(
        &mut self,
        mesh: &Arc<Mesh>,
        step: u64,
        stage: Stage,
    ) -> Result<(&Scene, &mut Workspace), StageError> {
        let kept = self.work.take().filter(|work| {
            let known = &work.discretization().mesh;
            Arc::ptr_eq(known, mesh) || known == mesh
        });
        let work = match kept {
            Some(work) => work,
            None => Workspace::with_terms(&self.scene, mesh, &self.own).map_err(|cause| match cause {
                WorkspaceError::Factor(cause) => {
                    StageError::TooLarge { step, stage, elements: mesh.element_counts(), cause }
                }
                WorkspaceError::Model(cause) => StageError::Model { step, stage, cause },
            })?,
        };
        Ok((&self.scene, self.work.insert(work)))
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
        let blocked = indicators.blocked.filter(|_| report.marked == [0, 0]);
        report.warnings.extend(blocked.map(|blocked| Warning::of_blocked(state, blocked)));
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
        let natural = FreeStrains::new(&self.scene, &state.mesh).at(state.parameter);
        let parts = self.scene.symmetry.copies() as f64;
        let energy = parts * (strain_energy(&tables, &state.displacement, natural) + self.stored_by_terms(state)?);
        let mut report = self.report(state, state.step);
        report.marked = [state.marked[0].len(), state.marked[1].len()];
        report.elements = finer.element_counts();
        let fits = Unknowns::new(&self.scene, &finer);
        report.unknowns =
            fits.map_err(|cause| StageError::Model { step: state.step, stage: Stage::RefineKnots, cause })?.count();
        report.strain_energy_n_mm = energy;
        let [before, after] = [&*state.mesh, &finer].map(|mesh| mesh.element_counts().iter().product::<usize>() as f64);
        // Along a path every critical point is located: nothing asks what refining changed.
        let refinement = self.scene.continuation.is_none().then(|| Refinement {
            changed_n_mm: (energy - state.strain_energy_n_mm).abs(),
            growth: after / before - 1.0,
            expected_n_mm: state.refinement.map(|last| last.of_all_n_mm()),
            ripple_n_mm: state.refinement.map_or(0.0, |last| last.ripple_n_mm),
        });
        let next = State {
            refined: Some(Arc::new(finer)),
            marked: Default::default(),
            strain_energy_n_mm: energy,
            refinement,
            ..state.clone()
        };
        Ok((next, report))
    }

    /// Energy that terms of the caller's own store in the model, N·mm.
    fn stored_by_terms(&mut self, state: &State) -> Result<f64, StageError> {
        if self.own.is_empty() {
            return Ok(0.0);
        }
        let (_, work) = self.workspace(&state.mesh, state.step, Stage::RefineKnots)?;
        let at = At { mesh: &state.mesh, displacement: &state.displacement, parameter: state.parameter };
        Ok(work.discretization().terms.energy(at))
    }

    fn project(&mut self, state: &State) -> Result<(State, Report), StageError> {
        let Some(finer) = &state.refined else {
            return Err(out_of_order(state, Stage::ProjectDisplacements, "there is no refined mesh"));
        };
        let displacement = project_displacements(&state.mesh, finer, &state.displacement);
        let parts = self.scene.symmetry.copies() as f64;
        let (_, work) = self.workspace(finer, state.step, Stage::ProjectDisplacements)?;
        let strain_energy_n_mm = parts * work.energy(&displacement, state.parameter);
        let carried = |path: &PathMemory| PathMemory {
            heading: project_displacements(&state.mesh, finer, &path.heading),
            ..path.clone()
        };
        let path = state.path.as_ref().map(carried);
        let previous = state.previous.as_ref().map(|previous| Previous {
            displacement: project_displacements(&state.mesh, finer, &previous.displacement),
            ..*previous
        });
        let mesh = finer.clone();
        let next = State { mesh, refined: None, displacement, strain_energy_n_mm, path, previous, ..state.clone() };
        let report = self.report(&next, next.step);
        Ok((next, report))
    }

    /// Reads every probe of the scene at an equilibrium.
    ///
    /// # Errors
    /// Where the scene cannot be made discrete on the state's mesh.
    pub fn read_probes(&mut self, state: &State) -> Result<Vec<Reading>, StageError> {
        let (scene, work) = self.workspace(&state.mesh, state.step, Stage::Solve)?;
        Ok(read_probes(scene, work, Standing::of(state), state.strain_energy_n_mm))
    }

    /// A report of the state as it stands; the stage fills in what it did. `stage` is set by [`Self::run`].
    pub(super) fn report(&mut self, state: &State, step: u64) -> Report {
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
            put_in_n_mm: 0.0,
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
            energy_released_n_mm: Some(0.0),
            jumped: false,
            rippled: false,
            marked: [0, 0],
            largest_indicator: [0.0; 2],
            path_length_mm: state.path.as_ref().map(|path| path.travelled_mm),
            critical_point: None,
            warnings: Vec::new(),
        }
    }
}

impl Report {
    pub(super) fn record_failure(&mut self, cause: &SolveError) {
        self.record_effort(cause.effort());
        self.residual = cause.last().map_or(f64::NAN, |last| last.relative_residual());
    }

    pub(super) fn record_effort(&mut self, effort: Effort) {
        self.iterations = effort.iterations;
        self.factorizations = effort.factorizations;
    }

    pub(super) fn record(&mut self, state: &State, solved: &Solved) {
        self.record_effort(solved.effort);
        self.parameter = state.parameter;
        self.moment_n_mm = state.moment_n_mm;
        self.strain_energy_n_mm = state.strain_energy_n_mm;
        self.negative_pivots = state.negative_pivots;
        self.residual = solved.residual;
        self.work_n_mm = solved.work;
        self.put_in_n_mm = solved.put_in;
        self.path_length_mm = state.path.as_ref().map(|path| path.travelled_mm);
    }
}

/// The state at a new equilibrium.
pub(super) fn settle(state: &State, solved: &Solved) -> State {
    State {
        displacement: solved.displacement.clone(),
        turns: solved.turns.clone(),
        marked: Default::default(),
        moment_n_mm: solved.moment,
        strain_energy_n_mm: solved.energy,
        largest_force_n: solved.largest_force,
        negative_pivots: solved.negative_pivots as u64,
        ..state.clone()
    }
}

/// The state where it was, with another attempt to make.
pub(super) fn reject(state: &State, mut report: Report, outcome: Outcome, control: StepControl) -> (State, Report) {
    report.outcome = outcome;
    (State { control, marked: Default::default(), ..state.clone() }, report)
}

pub(super) fn out_of_order(state: &State, stage: Stage, missing: &'static str) -> StageError {
    StageError::OutOfOrder { step: state.step, stage, after: state.stage.map_or("the start", Stage::name), missing }
}
