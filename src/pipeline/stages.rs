//! The stages, each a pure function of scene and state: no clock, no files, no memory that decides a result.

use std::sync::Arc;

use crate::adapt::{Coarsened, Finest, project_displacements};
use crate::digest::Hash;
use crate::energy::{At, TermSource, Terms, check_balance, check_held, remarks, strain_energy};
use crate::equilibrium::{Configuration, Iterate, Workspace, WorkspaceError};
use crate::model::{FreeStrains, MOST_CONTROL_POINTS, Member, ModelError, Tables, members};
use crate::pipeline::StageError;
use crate::pipeline::current_mesh::CurrentMesh;
use crate::pipeline::doubts::{Doubts, ReadAt, doubtful};
use crate::pipeline::evaluation::Evaluation;
use crate::pipeline::imperfect_start::imperfection_remarks;
use crate::pipeline::load_drive::LoadDrive;
use crate::pipeline::path_drive::PathDrive;
use crate::pipeline::probes::read_probes;
use crate::pipeline::step::{Drives, Step, out_of_order};
use crate::record::{Reading, Report, Warning, run_hash};
use crate::scene::{Drive, Indicator, Scene, Stage};
use crate::spline::{Mesh, Patch, knot_counts};
use crate::state::{DriveMemory, Refinement, State};

/// Runner of the stages of one scene. It keeps buffers of the current mesh, which new ones would fill with the same
/// bits.
#[derive(Debug)]
pub struct Stages {
    scene: Scene,
    own: Vec<Arc<dyn TermSource>>,
    current: CurrentMesh,
}

impl Stages {
    /// Creates the stages of a scene.
    pub fn new(scene: Scene) -> Self {
        Self::with_terms(scene, Vec::new())
    }

    /// Creates the stages of a scene with energies or loads of the caller's own.
    pub fn with_terms(scene: Scene, own: Vec<Arc<dyn TermSource>>) -> Self {
        Self { scene, own, current: CurrentMesh::default() }
    }

    /// Sources of the terms of the caller's own.
    pub fn own_terms(&self) -> &[Arc<dyn TermSource>] {
        &self.own
    }

    /// Hash of everything that decides the results: of the scene, and of terms of the caller's own where there are any.
    pub fn hash(&self) -> Hash {
        let terms: Vec<(&str, Hash)> = self.own.iter().map(|source| (source.name(), source.hash())).collect();
        run_hash(&self.scene, &terms)
    }

    /// Scene that the stages run.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Makes the state that the scene starts from: undeformed, before the first step.
    ///
    /// # Errors
    /// Where the scene cannot be made discrete, its supports and terms leave a rigid motion free, or its loads do work
    /// on a rigid motion that only a support of rigid motions holds.
    pub fn start(&mut self) -> Result<State, ModelError> {
        let mut state = State::undeformed(self.current.start(&self.scene, &self.own)?.clone());
        let mesh = &state.mesh;
        let unknowns = self.current.unknowns(&self.scene, mesh)?;
        check_held(&self.scene, mesh, unknowns, &self.own)?;
        check_balance(&self.scene, mesh, unknowns, &self.own)?;
        if unknowns.count() == 0 {
            return Err(ModelError::NothingFree { elements: mesh.elements() });
        }
        if unknowns.turns_are_unknown() {
            state.turns = vec![[0.0; 3]; unknowns.sections().len()];
        }
        Ok(state)
    }

    /// Number of free unknowns of the model on the mesh of a state.
    ///
    /// # Errors
    /// Where supports do not fit the mesh.
    pub fn unknowns(&mut self, state: &State) -> Result<usize, ModelError> {
        Ok(self.current.unknowns(&self.scene, &state.mesh)?.count())
    }

    /// Remarks on what the scene leaves open or its theory leaves out, a sentence each.
    ///
    /// # Errors
    /// Where supports or loads do not fit the mesh of the state.
    pub fn remarks(&mut self, state: &State) -> Result<Vec<String>, ModelError> {
        let unknowns = self.current.unknowns(&self.scene, &state.mesh)?;
        let mut all = remarks(&self.scene, &state.mesh, unknowns, &self.own)?;
        all.extend(imperfection_remarks(&self.scene, &state.mesh)?);
        Ok(all)
    }

    /// Warnings about the equilibrium that a run ends with, which a run that ends there gives itself.
    ///
    /// # Errors
    /// Where the scene does not fit the mesh of the state, or the mesh not in memory.
    pub fn warnings_at_end(&mut self, state: &State) -> Result<Vec<Warning>, StageError> {
        let Self { scene, own, current } = self;
        let work = current.workspace(scene, own, &state.mesh);
        let work = work.map_err(|cause| no_workspace(cause, &state.mesh, state.step, Stage::Solve))?;
        Ok(Doubts { scene, own, work, state }.all(ReadAt::AtEnd))
    }

    /// How far loads and free strains move the shell at most on the way to the target by linear theory, at its control points, mm;
    /// `None` where the stiffness of the start has no factor.
    pub fn linear_motion_mm(&mut self, start: &State) -> Option<f64> {
        let Self { scene, own, current } = self;
        let work = current.workspace(scene, own, &start.mesh).ok()?;
        let kinks = scene.actions.iter().flat_map(|action| action.history.kinks());
        let mut largest = None;
        for parameter in kinks.chain([scene.load.target()]) {
            let motion = work.linear_release(Configuration { parameter, ..Configuration::of(start) }).ok()?.motion_mm();
            largest = Some(motion.max(largest.unwrap_or(0.0)));
        }
        largest
    }

    /// How far the spans of the starting mesh may be halved; `None` where the scene refines nothing, or the mesh does not fit in
    /// memory.
    pub fn finest(&mut self, start: &State) -> Option<Finest> {
        let Self { scene, own, current } = self;
        let adapt = scene.adapt.as_ref()?;
        let work = current.workspace(scene, own, &start.mesh).ok()?;
        Some(Finest::of(scene, adapt, work.discretization()))
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
        let (mut next, mut report) = match stage {
            Stage::Solve => self.drive(stage, state, observer)?.solve()?,
            Stage::SwitchBranch => self.drive(stage, state, observer)?.switch_branch()?,
            Stage::EvaluateIndicators => self.evaluate(state)?,
            Stage::RefineKnots => self.refine(state)?,
            Stage::ProjectDisplacements => self.project(state)?,
            Stage::CoarsenKnots => self.coarsen(state)?,
            Stage::ReEquilibrate => self.drive(stage, state, observer)?.re_equilibrate()?,
        };
        next.stage = Some(stage);
        report.stage = stage;
        self.warn(state, &next, &mut report)?;
        Ok((next, report))
    }

    /// Creates the drive of the scene at a state.
    fn drive<'a>(
        &'a mut self,
        stage: Stage,
        state: &'a State,
        observer: &'a mut dyn FnMut(&Iterate),
    ) -> Result<Box<dyn Drives + 'a>, StageError> {
        let step = if stage == Stage::Solve { state.step + 1 } else { state.step };
        let (scene, work) = self.workspace(&state.mesh, step, stage)?;
        let step = Step { stage, scene, work, state, observer };
        Ok(match Drive::of(scene) {
            Drive::Load(_) => Box::new(LoadDrive { step }),
            Drive::Path(_, limits) => Box::new(PathDrive { step, limits }),
        })
    }

    fn workspace(&mut self, mesh: &Arc<Mesh>, step: u64, stage: Stage) -> Result<(&Scene, &mut Workspace), StageError> {
        let work = self.current.workspace(&self.scene, &self.own, mesh);
        Ok((&self.scene, work.map_err(|cause| no_workspace(cause, mesh, step, stage))?))
    }

    fn evaluate(&mut self, state: &State) -> Result<(State, Report), StageError> {
        let Self { scene, own, current } = self;
        let Some(adapt) = &scene.adapt else {
            return Err(out_of_order(state, Stage::EvaluateIndicators, "the scene has no [adapt]"));
        };
        let evaluated = Evaluation { scene, adapt, own, current, state }.run();
        evaluated.map_err(|cause| no_workspace(cause, &state.mesh, state.step, Stage::EvaluateIndicators))
    }

    /// Takes superfluous knots out. What the approximation of the displacements costs shows in the energy of the report.
    fn coarsen(&mut self, state: &State) -> Result<(State, Report), StageError> {
        if state.superfluous.iter().flatten().all(Vec::is_empty) {
            return Err(out_of_order(state, Stage::CoarsenKnots, "no knot is superfluous"));
        }
        let failed = |cause| StageError::Model { step: state.step, stage: Stage::CoarsenKnots, cause };
        let start = self.current.start(&self.scene, &self.own).map_err(failed)?;
        let Some(coarsened) = Coarsened::new(state.mesh.lone(), &state.superfluous[0], start.lone()) else {
            return Err(out_of_order(
                state,
                Stage::CoarsenKnots,
                "a superfluous knot is one that the scene starts with",
            ));
        };
        let displacement = coarsened.approximated(&state.displacement);
        let coarser = Arc::new(coarsened.patch.clone().into());
        let (scene, work) = self.workspace(&coarser, state.step, Stage::CoarsenKnots)?;
        let at = Configuration { displacement: &displacement, ..Configuration::of(state) };
        let (displacement, turns) = work.allowed(at);
        let next = State {
            mesh: coarser,
            superfluous: state.mesh.no_knots(),
            turns,
            strain_energy_n_mm: scene.symmetry.copies() as f64 * work.energy(&displacement, state.parameter),
            displacement,
            drive: DriveMemory {
                control: state.drive.control,
                course: state.drive.course.projected(|vectors| coarsened.approximated(vectors)),
            },
            refinement: None,
            estimate: None,
            ..state.clone()
        };
        let report = Report::of(scene, &next, work.discretization().unknowns.count());
        Ok((next, report))
    }

    fn refine(&mut self, state: &State) -> Result<(State, Report), StageError> {
        if state.marked.iter().flatten().all(Vec::is_empty) {
            return Err(out_of_order(state, Stage::RefineKnots, "no knot span is marked"));
        }
        let finer = Arc::new(state.mesh.with_knots(&state.marked));
        if finer.point_count() > MOST_CONTROL_POINTS {
            let (step, elements, count) = (state.step, finer.elements(), finer.point_count());
            return Err(StageError::RefinedTooFar { step, elements, count });
        }
        // The energy is integrated on the finer elements: its change here is the error of the coarser quadrature, and
        // projecting then changes nothing.
        let parts = self.scene.symmetry.copies() as f64;
        let energy = parts * (self.strain_energy_on(state, &finer) + self.stored_by_terms(state)?);
        let unknowns = match self.current.unknowns(&self.scene, &finer) {
            Ok(unknowns) => unknowns.count(),
            Err(cause) => return Err(StageError::Model { step: state.step, stage: Stage::RefineKnots, cause }),
        };
        let report = Report {
            marked: knot_counts(&state.marked),
            elements: finer.elements(),
            strain_energy_n_mm: energy,
            ..Report::of(&self.scene, state, unknowns)
        };
        let [before, after] = [&state.mesh, &finer].map(|mesh| mesh.elements().count() as f64);
        // Along a path every critical point is located: the change by refining is not needed.
        let refinement = (!Drive::of(&self.scene).follows_path()).then(|| Refinement {
            changed_n_mm: (energy - state.strain_energy_n_mm).abs(),
            growth: after / before - 1.0,
            expected_n_mm: state.refinement.map(|last| last.of_all_n_mm()),
            ripple_n_mm: state.refinement.map_or(0.0, |last| last.ripple_n_mm),
        });
        let next = State {
            marked: finer.no_knots(),
            refined: Some(finer),
            strain_energy_n_mm: energy,
            refinement,
            ..state.clone()
        };
        Ok((next, report))
    }

    /// Computes the strain energy of the shells at a state, integrated on the elements of a finer mesh, N·mm.
    fn strain_energy_on(&self, state: &State, finer: &Mesh) -> f64 {
        let points = state.mesh.point_count();
        let of_member = |(member, finer): (Member, &Patch)| {
            let tables = Tables::of_member(&member, finer, points);
            let natural = FreeStrains::new(&member.scene, member.patch).at(state.parameter);
            strain_energy(&tables, &state.displacement, natural)
        };
        members(&self.scene, &state.mesh).into_iter().zip(&finer.patches).map(of_member).sum()
    }

    /// Computes the energy that springs and terms of the caller's own store in the model, N·mm.
    fn stored_by_terms(&mut self, state: &State) -> Result<f64, StageError> {
        if !Terms::may_store(&self.scene, &self.own) {
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
        let State {
            mesh,
            displacement,
            marked,
            refined: _,
            step,
            stage,
            parameter,
            turns,
            moment_n_mm,
            strain_energy_n_mm: _,
            negative_pivots,
            drive: DriveMemory { control, course },
            largest_force_n,
            refinement,
            superfluous: _,
            estimate: _,
        } = state;
        let project = |vectors: &[[f64; 3]]| project_displacements(mesh, finer, vectors);
        let displacement = project(displacement);
        let (scene, work) = self.workspace(finer, *step, Stage::ProjectDisplacements)?;
        let next = State {
            mesh: finer.clone(),
            marked: marked.clone(),
            refined: None,
            step: *step,
            stage: *stage,
            parameter: *parameter,
            turns: turns.clone(),
            moment_n_mm: *moment_n_mm,
            strain_energy_n_mm: scene.symmetry.copies() as f64 * work.energy(&displacement, *parameter),
            displacement,
            negative_pivots: *negative_pivots,
            drive: DriveMemory { control: *control, course: course.projected(project) },
            largest_force_n: *largest_force_n,
            refinement: *refinement,
            superfluous: finer.no_knots(),
            estimate: None,
        };
        let report = Report::of(scene, &next, work.discretization().unknowns.count());
        Ok((next, report))
    }

    /// Adds the warnings about the state that a stage made, or about the one before it.
    fn warn(&mut self, before: &State, after: &State, report: &mut Report) -> Result<(), StageError> {
        // Where a tolerance rules, the estimate says what meshes before were off by.
        let by_error = self.scene.adapt.as_ref().is_some_and(|adapt| matches!(adapt.indicator, Indicator::Error(_)));
        let refined = !by_error && matches!(report.stage, Stage::RefineKnots | Stage::ReEquilibrate);
        let elements = report.elements.clone();
        report.warnings.extend(refined.then(|| Warning::of_refining(before, after, elements)).flatten());
        for (state, read_at) in doubtful(&self.scene, before, after, report) {
            let work = self.current.workspace(&self.scene, &self.own, &state.mesh);
            let work = work.map_err(|cause| no_workspace(cause, &state.mesh, report.step, report.stage))?;
            report.warnings.extend(Doubts { scene: &self.scene, own: &self.own, work, state }.all(read_at));
        }
        Ok(())
    }

    /// Reads every probe of the scene at an equilibrium.
    ///
    /// # Errors
    /// Where the scene cannot be made discrete on the state's mesh, or a probe asks for what the scene does not have.
    pub fn read_probes(&mut self, state: &State) -> Result<Vec<Reading>, StageError> {
        let made_by = state.stage.unwrap_or(Stage::Solve);
        let (scene, work) = self.workspace(&state.mesh, state.step, made_by)?;
        read_probes(scene, work, Configuration::of(state), state.strain_energy_n_mm)
            .map_err(|cause| StageError::Model { step: state.step, stage: made_by, cause })
    }
}

/// The error of a stage whose mesh the scene does not fit, or that does not fit in memory.
fn no_workspace(cause: WorkspaceError, mesh: &Mesh, step: u64, stage: Stage) -> StageError {
    match cause {
        WorkspaceError::Factor(cause) => StageError::TooLarge { step, stage, elements: mesh.elements(), cause },
        WorkspaceError::Model(cause) => StageError::Model { step, stage, cause },
    }
}
