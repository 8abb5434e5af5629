//! What a run takes on the mesh that it starts with: found by its first load steps, before anything is logged.

use std::time::Instant;

use crate::model::{ModelError, Size, oddities, symmetric_lines};
use crate::pipeline::{Run, RunError, Stages};
use crate::record::{MemorySink, Outcome, Record};
use crate::scene::{EndRotation, Load, LoadSteps, Scene, Stage};
use crate::state::State;

/// Load steps that are done: the first starts from rest, and those behind it are like the rest of a run.
const STEPS: f64 = 3.0;
/// Stages that are run for them, at most: a step that finds no equilibrium is cut.
const MOST_STAGES: usize = 10;
/// Runs of a step for its time where the scene has but one.
const REPEATS: usize = 3;

/// What is known of a run before it.
#[derive(Debug)]
#[non_exhaustive]
pub struct Forecast {
    /// Size of the shell.
    pub size: Size,
    /// Elements of the model each way.
    pub elements: [usize; 2],
    /// Free unknowns of the model.
    pub unknowns: usize,
    /// A load step; an error where none can be done.
    pub step: Result<StepCost, RunError>,
    /// Load steps to the target if every increment is the longest that is allowed; `None` by arc length.
    pub load_steps: Option<f64>,
    /// Whether the mesh changes on the way, so that all of this is of the mesh at the start alone.
    pub refines: bool,
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

impl Forecast {
    /// Checks a scene as a run does at its start, and does its first load steps on the starting mesh. They end as a run does, by
    /// halving all elements to see whether they are fine enough, which takes more memory than all else.
    ///
    /// # Errors
    /// Where a run of the scene would be refused at its start.
    pub fn of(scene: &Scene) -> Result<Self, ModelError> {
        let mut stages = Stages::new(scene.clone());
        let start = stages.start()?;
        let size = Size::of(scene)?;
        Ok(Self {
            odd: oddities(scene, &size),
            size,
            elements: start.mesh.element_counts(),
            unknowns: stages.unknowns(&start)?,
            remarks: stages.remarks(&start)?,
            load_steps: scene.continuation.is_none().then(|| scene.load.target() / scene.load.longest_increment()),
            refines: scene.adapt.is_some(),
            symmetric: symmetric_lines(scene, &start.mesh),
            step: step_cost(stages, start),
        })
    }
}

/// Does the first load steps; the quickest behind the first counts, as other programs only slow it down.
fn step_cost(mut stages: Stages, start: State) -> Result<StepCost, RunError> {
    let mut run = Run::new(Stages::new(beginning_of(stages.scene())), start.clone(), None);
    let mut records: Vec<Record> = Vec::new();
    while records.len() < MOST_STAGES {
        match run.advance(&mut MemorySink::default()) {
            Ok(Some(record)) => records.push(record),
            Ok(None) => break,
            Err(cause) if records.is_empty() => return Err(cause),
            Err(_) => break,
        }
    }
    let is_step = |record: &&Record| record.report.stage == Stage::Solve && record.report.outcome == Outcome::Done;
    let quickest = records.iter().skip(1).filter(is_step).min_by(|one, other| one.wall_s.total_cmp(&other.wall_s));
    let (iterations, wall_s) = match quickest {
        Some(record) => (record.report.iterations, record.wall_s),
        None => repeated(&mut stages, &start)?,
    };
    let first_is_cut = records.first().is_some_and(|record| record.report.outcome != Outcome::Done);
    Ok(StepCost { iterations, wall_s, first_is_cut })
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

/// The first load steps of a scene on its starting mesh, as a scene.
fn beginning_of(scene: &Scene) -> Scene {
    let target = scene.load.target().min(STEPS * scene.load.increment());
    let load = match scene.load.clone() {
        Load::EndRotation(load) => Load::EndRotation(EndRotation { rotation_deg: target, ..load }),
        Load::Steps(load) => Load::Steps(LoadSteps { factor: target, ..load }),
    };
    let on_one_mesh = |stage: &Stage| matches!(stage, Stage::Solve | Stage::SwitchBranch);
    let pipeline = scene.pipeline.iter().copied().filter(on_one_mesh).collect();
    Scene { load, pipeline, adapt: None, ..scene.clone() }
}
