//! What a run takes: found by its first load steps on the mesh that it starts with, before anything is logged.

use std::sync::Arc;
use std::time::Instant;

use crate::equilibrium::{Configuration, Workspace};
use crate::model::{ModelError, Size, is_driven_by_loads, odd_motion, oddities, symmetric_lines};
use crate::pipeline::{Run, RunError, Stages};
use crate::record::{MemorySink, Outcome, Record};
use crate::scene::{Scene, Stage};
use crate::spline::{Elements, Mesh};
use crate::state::State;

/// Load steps that are done at least: the first starts from rest, and those behind it are like the rest of a run.
const LEAST_STEPS: usize = 3;
/// Load steps that are done at most, where they are quick.
const MOST_STEPS: usize = 12;
/// Seconds after which no more are done than must be.
const QUICK_S: f64 = 0.5;
/// Stages that are run for them, at most: a step that finds no equilibrium is cut.
const MOST_STAGES: usize = 40;
/// Runs of a step for its time where the scene has but one.
const REPEATS: usize = 3;
/// Control points of the finest mesh up to which it is tried out: it takes seconds.
const MOST_TRIED: usize = 20_000;

/// What is known of a run before it.
#[derive(Debug)]
#[non_exhaustive]
pub struct Forecast {
    /// Size of the shell.
    pub size: Size,
    /// Elements of the model each way.
    pub elements: Elements,
    /// Free unknowns of the model.
    pub unknowns: usize,
    /// A load step; an error where none can be done, `None` where the mesh is too large to try one.
    pub step: Option<Result<StepCost, RunError>>,
    /// Load steps to the target if every increment is the longest that is allowed; `None` by arc length.
    pub load_steps: Option<f64>,
    /// The finest mesh, where the mesh changes on the way; all else is of the mesh at the start alone.
    pub finest: Option<FinestMesh>,
    /// Whether the whole shell and all that acts on it is its own mirror image in the line u = 0.5, and in v = 0.5.
    pub symmetric: [bool; 2],
    /// Numbers that look like slips, a sentence each.
    pub odd: Vec<String>,
    /// What the scene leaves open or its theory leaves out, a sentence each.
    pub remarks: Vec<String>,
}

/// What a load step takes.
#[derive(Clone, Copy, Debug)]
pub struct StepCost {
    /// Newton iterations.
    pub iterations: usize,
    /// Wall time with tables and factor at hand, seconds.
    pub wall_s: f64,
    /// Whether the first increment was too long to find an equilibrium, so that it is cut.
    pub first_is_cut: bool,
}

/// The mesh with every span halved as far as the length limit allows: no run of the scene has a finer one.
#[derive(Clone, Debug)]
pub struct FinestMesh {
    /// Elements of the model each way.
    pub elements: Elements,
    /// The mesh; `None` where it is too large to be tried out.
    mesh: Option<Arc<Mesh>>,
}

/// What the finest mesh takes.
#[derive(Clone, Copy, Debug)]
pub struct FinestCost {
    /// Free unknowns of the model.
    pub unknowns: usize,
    /// Wall time of a Newton iteration, seconds.
    pub iteration_s: f64,
}

impl Forecast {
    /// Checks a scene as a run does at its start, and does its first load steps on the starting mesh. Where that is the mesh of
    /// the whole run, they end as a run does, by halving all elements to see whether they are fine enough, which takes more
    /// memory than all else.
    ///
    /// # Errors
    /// Where a run of the scene would be refused at its start.
    pub fn of(scene: &Scene) -> Result<Self, ModelError> {
        let mut stages = Stages::new(scene.clone());
        let start = stages.start()?;
        let size = Size::of(scene)?;
        let (unknowns, remarks) = (stages.unknowns(&start)?, stages.remarks(&start)?);
        let mut odd = oddities(scene, &size);
        let is_tried = start.mesh.elements().count() <= MOST_TRIED;
        if is_tried {
            odd.extend(hardly_moved_or_thrown_off(&mut stages, &start, &size));
        }
        let finest = stages.finest(&start).map(|finest| {
            let elements = finest.elements();
            let is_small = elements.count() <= MOST_TRIED;
            FinestMesh { elements, mesh: is_small.then(|| Arc::new(finest.mesh(&start.mesh))) }
        });
        // What it keeps of the starting mesh would be in memory twice.
        drop(stages);
        Ok(Self {
            odd,
            size,
            elements: start.mesh.elements(),
            unknowns,
            remarks,
            load_steps: scene.continuation.is_none().then(|| scene.load.target() / scene.load.longest_increment()),
            finest,
            symmetric: match &start.mesh.patches[..] {
                // What is imperfect is no mirror image of itself.
                [patch] if scene.imperfections.is_empty() => symmetric_lines(scene, patch),
                _ => [false; 2],
            },
            step: is_tried.then(|| step_cost(scene, start)),
        })
    }
}

impl FinestMesh {
    /// Makes the scene discrete on this mesh and factors its stiffness once, so that the memory of the process shows what a run
    /// takes at most; `None` where the mesh is too large to be tried out.
    pub fn cost(&self, scene: &Scene) -> Option<FinestCost> {
        let mesh = self.mesh.clone()?;
        let mut work = Workspace::new(scene, &mesh).ok()?;
        let unknowns = &work.discretization().unknowns;
        let (count, sections) = (unknowns.count(), unknowns.sections().len());
        let turns = if unknowns.turns_are_unknown() { vec![[0.0; 3]; sections] } else { Vec::new() };
        let displacement = vec![[0.0; 3]; mesh.point_count()];
        let at = Configuration { displacement: &displacement, turns: &turns, parameter: 0.0, largest_force: 0.0 };
        let begin = Instant::now();
        work.linear_release(at).ok()?;
        Some(FinestCost { unknowns: count, iteration_s: begin.elapsed().as_secs_f64() })
    }
}

/// Writes a sentence where the loads hardly move the shell by linear theory, or throw it far off.
pub fn hardly_moved_or_thrown_off(stages: &mut Stages, start: &State, size: &Size) -> Option<String> {
    let is_asked = is_driven_by_loads(stages.scene());
    is_asked
        .then(|| stages.linear_motion_mm(start))
        .flatten()
        .and_then(|motion| odd_motion(stages.scene(), size, motion))
}

/// Does the first load steps. A load step takes what most of those behind the first take in iterations, each as quick as the
/// quickest, as other programs only slow it down.
fn step_cost(scene: &Scene, start: State) -> Result<StepCost, RunError> {
    let mut run = Run::new(Stages::new(on_one_mesh(scene)), start.clone(), None);
    let mut records: Vec<Record> = Vec::new();
    let begin = Instant::now();
    let is_step = |record: &&Record| record.report.stage == Stage::Solve && record.report.outcome == Outcome::Done;
    while records.len() < MOST_STAGES {
        match run.advance(&mut MemorySink::default()) {
            Ok(Some(record)) => records.push(record),
            Ok(None) => break,
            Err(cause) if records.is_empty() => return Err(cause),
            Err(_) => break,
        }
        let done = records.iter().filter(is_step).count();
        if done >= LEAST_STEPS && (done >= MOST_STEPS || begin.elapsed().as_secs_f64() > QUICK_S) {
            break;
        }
    }
    let mut iterations: Vec<usize> = records.iter().skip(1).filter(is_step).map(iterations_of).collect();
    iterations.sort_unstable();
    let first_is_cut = records.first().is_some_and(|record| record.report.outcome != Outcome::Done);
    let is_ended = run.next_stage().is_none();
    let state = run.state().clone();
    let (iterations, wall_s) = match iterations.get(iterations.len() / 2) {
        Some(iterations) => (*iterations, evaluations(*iterations) * quickest(&records)),
        None => repeated(&mut Stages::new(scene.clone()), &start)?,
    };
    if !is_ended {
        drop(run);
        let warnings = Stages::new(scene.clone()).warnings_at_end(&state);
        warnings.map_err(RunError::Stage)?;
    }
    Ok(StepCost { iterations, wall_s, first_is_cut })
}

fn iterations_of(record: &Record) -> usize {
    record.report.iterations
}

/// Evaluations of forces and stiffness in a solve of so many iterations: one more, at the equilibrium itself.
fn evaluations(iterations: usize) -> f64 {
    1.0 + iterations as f64
}

/// The least wall time of an evaluation in the solves behind the first, which makes tables and structure too, seconds.
fn quickest(records: &[Record]) -> f64 {
    let solves = records.iter().skip(1).filter(|record| record.report.stage == Stage::Solve);
    solves.map(|record| record.wall_s / evaluations(record.report.iterations)).fold(f64::INFINITY, f64::min)
}

/// Iterations and least time of the first step, once its tables are made.
fn repeated(stages: &mut Stages, start: &State) -> Result<(usize, f64), RunError> {
    let (_, report) = stages.run(Stage::Solve, start, &mut |_| {})?;
    let mut least = f64::INFINITY;
    for _ in 0..REPEATS {
        let begin = Instant::now();
        stages.run(Stage::Solve, start, &mut |_| {})?;
        least = least.min(begin.elapsed().as_secs_f64());
    }
    Ok((report.iterations, least))
}

/// The scene with its mesh left as it starts.
fn on_one_mesh(scene: &Scene) -> Scene {
    let on_one_mesh = |stage: &Stage| matches!(stage, Stage::Solve | Stage::SwitchBranch);
    let pipeline = scene.pipeline.iter().copied().filter(on_one_mesh).collect();
    Scene { pipeline, adapt: None, ..scene.clone() }
}
