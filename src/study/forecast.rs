//! What a run takes on the mesh that it starts with: found by doing its first load step, before anything is logged.

use std::time::{Duration, Instant};

use crate::model::{ModelError, Size, oddities, symmetric_lines};
use crate::pipeline::{StageError, Stages};
use crate::record::Outcome;
use crate::scene::{EndRotation, Load, LoadSteps, Scene, Stage};

/// Runs of the first step for its time, at most, and the time after which there are no more.
const MOST_RUNS: usize = 5;
const LONG_ENOUGH: Duration = Duration::from_millis(200);

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
    /// The first load step; an error where it cannot be done.
    pub first_step: Result<FirstStep, StageError>,
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

/// The first load step of a run.
#[derive(Clone, Copy, Debug)]
pub struct FirstStep {
    /// Newton iterations.
    pub iterations: usize,
    /// Wall time with tables and factor at hand, seconds.
    pub wall_s: f64,
    /// Whether it ends in an equilibrium; otherwise a run goes on with a shorter step.
    pub has_equilibrium: bool,
}

impl Forecast {
    /// Checks a scene as a run does at its start, and does its first load step: as if it were the last, since a run ends by halving
    /// all elements to see whether they are fine enough, which takes more memory than all else; for the tables; and for the time.
    ///
    /// # Errors
    /// Where a run of the scene would be refused at its start.
    pub fn of(scene: &Scene) -> Result<Self, ModelError> {
        let mut stages = Stages::new(scene.clone());
        let start = stages.start()?;
        let remarks = stages.remarks(&start)?;
        let unknowns = stages.unknowns(&start)?;
        let size = Size::of(scene)?;
        // Its outcome is that of the first step, which is asked for its time below.
        let _ = Stages::new(ending_after_a_step(scene)).run(Stage::Solve, &start, &mut |_| {});
        let mut step = || {
            let begin = Instant::now();
            let (_, report) = stages.run(Stage::Solve, &start, &mut |_| {})?;
            Ok(FirstStep {
                iterations: report.iterations,
                wall_s: begin.elapsed().as_secs_f64(),
                has_equilibrium: report.outcome == Outcome::Done,
            })
        };
        Ok(Self {
            odd: oddities(scene, &size),
            size,
            elements: start.mesh.element_counts(),
            unknowns,
            first_step: step().and_then(|_| quickest(step)),
            load_steps: scene.continuation.is_none().then(|| scene.load.target() / scene.load.longest_increment()),
            refines: scene.adapt.is_some(),
            symmetric: symmetric_lines(scene, &start.mesh),
            remarks,
        })
    }
}

/// The scene with the target that its first load step reaches.
fn ending_after_a_step(scene: &Scene) -> Scene {
    let load = match scene.load.clone() {
        Load::EndRotation(load) => Load::EndRotation(EndRotation { rotation_deg: load.increment_deg, ..load }),
        Load::Steps(load) => Load::Steps(LoadSteps { factor: load.increment, ..load }),
    };
    Scene { load, ..scene.clone() }
}

/// The quickest of some runs of a step: other programs only slow it down.
fn quickest(mut step: impl FnMut() -> Result<FirstStep, StageError>) -> Result<FirstStep, StageError> {
    let begin = Instant::now();
    let mut best = step()?;
    for _ in 1..MOST_RUNS {
        if begin.elapsed() > LONG_ENOUGH {
            break;
        }
        let next = step()?;
        best = if next.wall_s < best.wall_s { next } else { best };
    }
    Ok(best)
}
