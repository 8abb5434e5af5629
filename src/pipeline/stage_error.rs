//! Why a stage could not be run to its end, in words.

use crate::equilibrium::{FactorError, SolveError};
use crate::model::{MOST_CONTROL_POINTS, ModelError};
use crate::scene::Stage;

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
    /// Not even the first step has an equilibrium.
    #[error(
        "step {step}, solve: no equilibrium was found near the undeformed shell, at {attempted}, nor at larger increments: \
         {cause}; look at sizes and units of loads, thickness and geometry, and at what the supports leave free; then take a \
         smaller increment or raise solver.max_iterations"
    )]
    NoStart {
        /// Load step.
        step: u64,
        /// Where the last attempt would have stood.
        attempted: String,
        /// Why the last attempt failed.
        cause: Box<SolveError>,
    },
    /// The shell jumps or loses its stability, where is located, and the solver did not reach the shape beyond it.
    #[error(
        "step {step}, solve: the shell jumps or loses its stability between {reached} and {attempted}, and no equilibrium \
         beyond was reached: {cause}; raise solver.max_iterations"
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
        "step {step}, re-equilibrate at {reached} on {} × {} elements: {cause}; raise solver.max_iterations (by arc length: lower continuation.longest_step), or adapt.threshold to \
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
    /// The path could not be followed.
    #[error(
        "step {step}, solve: the path was lost at {reached}: a step shorter than continuation.shortest_step = {shortest} \
         first steps ({first_mm:.3e} mm) would be needed; the last attempt, of {attempted_mm:.3e} mm: {why}"
    )]
    PathLost {
        /// Load step.
        step: u64,
        /// Where the last good state stands.
        reached: String,
        /// The scene's shortest step.
        shortest: f64,
        /// Length of the first step, mm.
        first_mm: f64,
        /// Length of the last attempt, mm.
        attempted_mm: f64,
        /// What became of it.
        why: String,
    },
    /// The path is longer than the scene allows.
    #[error(
        "step {step}: the path has not reached {target} after continuation.most_steps = {most} load steps; it stands at \
         {reached}; raise most_steps, or longest_step for longer steps, and go on with `foldline run SCENE --resume`"
    )]
    PathTooLong {
        /// Load step.
        step: u64,
        /// Where the run was to end.
        target: String,
        /// Where the last state stands.
        reached: String,
        /// Load steps that are allowed.
        most: usize,
    },
    /// The unstable equilibrium could not be left.
    #[error(
        "step {step}, switch-branch at {reached}: {cause}; raise solver.max_iterations, or take smaller increments"
    )]
    NotSwitched {
        /// Load step.
        step: u64,
        /// Where the state stands.
        reached: String,
        /// Why the solve failed.
        cause: Box<SolveError>,
    },
    /// No stable equilibrium was found beside the unstable one.
    #[error(
        "step {step}, switch-branch at {reached}: after leaving along {modes} modes the equilibrium still has {negative_pivots} \
         negative pivot(s); take smaller increments, or take switch-branch out of pipeline.stages"
    )]
    StillUnstable {
        /// Load step.
        step: u64,
        /// Where the state stands.
        reached: String,
        /// Modes that were left.
        modes: usize,
        /// Negative pivots of the last equilibrium.
        negative_pivots: u64,
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
