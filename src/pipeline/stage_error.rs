//! The errors of stages, in words.

use crate::equilibrium::{FactorError, SolveError};
use crate::model::{MOST_CONTROL_POINTS, ModelError};
use crate::scene::Stage;
use crate::spline::Elements;

/// Reasons why a stage could not be run to its end. The state before it remains valid.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StageError {
    /// The increment was cut down to the least one and still no equilibrium was found.
    #[error(
        "step {step}, solve: no equilibrium at {attempted} from {reached}, and an increment below \
         {least_key} = {least} would be needed; the last attempt: {cause}"
    )]
    NoEquilibrium {
        /// Number of the load step.
        step: u64,
        /// Parameter of the last good state, with its unit.
        reached: String,
        /// Parameter of the last attempt, with its unit.
        attempted: String,
        /// The key of the scene's least increment.
        least_key: &'static str,
        /// The scene's least increment, in the units of its parameter.
        least: f64,
        /// Reason why the last attempt failed.
        cause: Box<SolveError>,
    },
    /// Not even the first step has an equilibrium.
    #[error(
        "step {step}, solve: no equilibrium was found near the undeformed shell, at {attempted}, nor at larger increments: \
         {cause}; check sizes and units of loads, thickness and geometry, and what the supports leave free; then take a \
         smaller increment or raise solver.max_iterations"
    )]
    NoStart {
        /// Number of the load step.
        step: u64,
        /// Parameter of the last attempt, with its unit.
        attempted: String,
        /// Reason why the last attempt failed.
        cause: Box<SolveError>,
    },
    /// The shell jumps or loses its stability at a located point, and the solver did not reach the shape beyond it.
    #[error(
        "step {step}, solve: the shell jumps or loses its stability between {reached} and {attempted}, and no equilibrium \
         beyond was reached: {cause}; raise solver.max_iterations"
    )]
    JumpNotFollowed {
        /// Number of the load step.
        step: u64,
        /// Parameter of the last good state, with its unit.
        reached: String,
        /// Parameter beyond the jump, with its unit.
        attempted: String,
        /// Reason why the solve failed.
        cause: Box<SolveError>,
    },
    /// The refined mesh has no equilibrium at the load.
    #[error(
        "step {step}, re-equilibrate at {reached} on {elements} elements: {cause}; raise solver.max_iterations (by arc length: lower continuation.longest_step), or adapt.threshold to \
         refine less at once, and continue with `foldline run SCENE --resume`"
    )]
    NotReEquilibrated {
        /// Number of the load step.
        step: u64,
        /// Parameter of the state, with its unit.
        reached: String,
        /// Number of elements in each direction.
        elements: Elements,
        /// Reason why the solve failed.
        cause: Box<SolveError>,
    },
    /// A section with a spring of rotation turned by half a turn.
    #[error(
        "step {step}, solve: at {parameter} section \"{section}\" has turned by {angle_deg:.0}°, and its spring \"{spring}\" knows its \
         rotation vector below half a turn alone: end the run earlier, or give the spring's stiffness to a shell that bends"
    )]
    SpringTurnedOver {
        /// Number of the load step.
        step: u64,
        /// Name of the spring.
        spring: String,
        /// Name of the support that is the section.
        section: String,
        /// Angle by which it has turned, degrees.
        angle_deg: f64,
        /// Parameter, with its unit.
        parameter: String,
    },
    /// The path could not be followed.
    #[error(
        "step {step}, solve: the path was lost at {reached}: a step shorter than continuation.shortest_step = {shortest} \
         first steps ({first_mm:.3e} mm) would be needed; the last attempt, of {attempted_mm:.3e} mm: {why}"
    )]
    PathLost {
        /// Number of the load step.
        step: u64,
        /// Parameter of the last good state, with its unit.
        reached: String,
        /// The scene's shortest step.
        shortest: f64,
        /// Length of the first step, mm.
        first_mm: f64,
        /// Length of the last attempt, mm.
        attempted_mm: f64,
        /// Outcome of the last attempt, in words.
        why: String,
    },
    /// The path is longer than the scene allows.
    #[error(
        "step {step}: the path has not reached {target} after continuation.most_steps = {most} load steps; it is at \
         {reached}; raise most_steps, or longest_step for longer steps, and continue with `foldline run SCENE --resume`"
    )]
    PathTooLong {
        /// Number of the load step.
        step: u64,
        /// Target of the run, with its unit.
        target: String,
        /// Parameter of the last state, with its unit.
        reached: String,
        /// Number of load steps that are allowed.
        most: usize,
    },
    /// The unstable equilibrium could not be left.
    #[error(
        "step {step}, switch-branch at {reached}: {cause}; raise solver.max_iterations, or take smaller increments"
    )]
    NotSwitched {
        /// Number of the load step.
        step: u64,
        /// Parameter of the state, with its unit.
        reached: String,
        /// Reason why the solve failed.
        cause: Box<SolveError>,
    },
    /// No stable equilibrium was found near the unstable one.
    #[error(
        "step {step}, switch-branch at {reached}: after leaving along {modes} modes the equilibrium still has {negative_pivots} \
         negative pivot(s); take smaller increments, or remove switch-branch from pipeline.stages"
    )]
    StillUnstable {
        /// Number of the load step.
        step: u64,
        /// Parameter of the state, with its unit.
        reached: String,
        /// Number of modes along which it was left.
        modes: usize,
        /// Number of negative pivots of the last equilibrium.
        negative_pivots: u64,
    },
    /// The equations do not fit in memory.
    #[error("step {step}, {stage} on {elements} elements: {cause}")]
    TooLarge {
        /// Number of the load step.
        step: u64,
        /// Stage that failed.
        stage: Stage,
        /// Number of elements in each direction.
        elements: Elements,
        /// Error of the sparse solver.
        cause: FactorError,
    },
    /// Supports or loads do not fit the mesh.
    #[error("step {step}, {stage}: {cause}")]
    Model {
        /// Number of the load step.
        step: u64,
        /// Stage that failed.
        stage: Stage,
        /// Error of the model.
        cause: ModelError,
    },
    /// Refinement asks for more than memory holds.
    #[error(
        "step {step}, refine-knots: {elements} elements would have {count} control points, and the most is {MOST_CONTROL_POINTS}; raise \
         adapt.threshold or adapt.length_limit_mm"
    )]
    RefinedTooFar {
        /// Number of the load step.
        step: u64,
        /// Number of elements in each direction that were asked for.
        elements: Elements,
        /// Number of control points of that mesh.
        count: usize,
    },
    /// The stage needs what the stage before it makes.
    #[error("step {step}: {stage} cannot follow {after}: {missing}")]
    OutOfOrder {
        /// Number of the load step.
        step: u64,
        /// Stage that failed.
        stage: Stage,
        /// The stage that made the state.
        after: &'static str,
        /// What the stage lacks, in words.
        missing: &'static str,
    },
}
