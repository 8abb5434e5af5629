//! What can be wrong with a scene that was run to see whether it ends as it states.

use serde::{Serialize, Serializer};

use crate::equilibrium::SolveError;
use crate::scene::{ExpectedOutcome, Stage};

/// A fault found in a run that is checked against its `[expect]` table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExtremeFault {
    /// It did not end as it states.
    #[error("the scene states that it ends `{}` (within {limit_s} s)", expected.name())]
    EndedOtherwise {
        /// The end that the scene states.
        expected: ExpectedOutcome,
        /// Time for a run, seconds.
        limit_s: f64,
    },
    /// It ended in a panic, which is wrong whatever the scene states.
    #[error("a panic is never right; the line above says where")]
    Panicked,
    /// No load step came to an equilibrium.
    #[error("no load step ended in an equilibrium")]
    NoStep,
    /// What was kept of the run is not the run.
    #[error("stage {ordinal} of the run was not kept as it was made")]
    Lost {
        /// The first stage that differs.
        ordinal: u64,
    },
    /// The last equilibrium is not found again from its own state.
    #[error("the equilibrium of step {step} is not found again from its own state")]
    NotFoundAgain {
        /// Load step.
        step: u64,
    },
    /// A result is not a number.
    #[error("step {step}, {stage}: a result is not a number")]
    NotANumber {
        /// Load step.
        step: u64,
        /// The stage.
        stage: Stage,
    },
    /// The residual of an equilibrium is too large.
    #[error("an equilibrium has a residual of {residual:.1e} of the forces; solver.tolerance is {tolerance:e}")]
    OutOfBalance {
        /// |residual| over the forces that it is compared with.
        residual: f64,
        /// The scene's tolerance.
        tolerance: f64,
    },
    /// Work went where it cannot.
    #[error(
        "work and strain energy of the smooth steps differ by {balance:.1e} of the strain energy; {most} is the most"
    )]
    EnergyOutOfBalance {
        /// Work less strain energy, relative.
        balance: f64,
        /// The largest imbalance allowed.
        most: f64,
    },
    /// The stiffness at the end has no factor.
    #[error("no condition at the end: {cause}")]
    NoFactor {
        /// The error of the solver.
        cause: Box<SolveError>,
    },
    /// The stiffness at the end is singular.
    #[error("the condition of the stiffness at the end is {condition}")]
    Singular {
        /// Estimate of the condition number.
        condition: f64,
    },
    /// The stiffness at the end is not symmetric.
    #[error("the stiffness at the end is not symmetric: {error:.1e}, and rounding is below {most:e}")]
    NotSymmetric {
        /// Relative asymmetry of the stiffness.
        error: f64,
        /// The largest asymmetry allowed.
        most: f64,
    },
    /// Changing an input in its last place changes the result.
    #[error(
        "{bits:.0} bits of the result survive a change of one unit in the last place of an input; {least} are the least"
    )]
    Noise {
        /// Number of bits that survive.
        bits: f64,
        /// The least number of bits allowed.
        least: f64,
    },
    /// Changing an input in its last place changes how the run ends.
    #[error("with one unit more in the last place of an input it ends `{ended}`")]
    NudgedEndedOtherwise {
        /// How the run with the changed input ended.
        ended: &'static str,
    },
    /// The result is farther off than the scene states.
    #[error(
        "the result is {:.1} % off `expect.peak` or `expect.last`, and {:.0} % is the most: refine the mesh, or state \
         more in `expect.within`, and why in `expect.inexact`",
        100.0 * error,
        100.0 * most
    )]
    Inexact {
        /// Relative error.
        error: f64,
        /// The largest error allowed.
        most: f64,
    },
    /// `same_as` names no scene.
    #[error("expect.same_as = \"{other}\" is no scene of this folder")]
    NoOtherScene {
        /// Name of the other scene.
        other: String,
    },
    /// The other scene took other steps.
    #[error("the curve of {other} has {theirs} equilibria, and this one {ours}; they part after {parameter}")]
    OtherSteps {
        /// Name of the other scene.
        other: String,
        /// Number of equilibria of the other scene.
        theirs: usize,
        /// Equilibria of this scene.
        ours: usize,
        /// The last common value of the parameter.
        parameter: f64,
    },
    /// The curves differ.
    #[error(
        "at {parameter} the curve is {difference:.1e} of its largest value off that of {other}; {most:e} is the most"
    )]
    OtherCurve {
        /// Name of the other scene.
        other: String,
        /// Where the difference is largest.
        parameter: f64,
        /// Relative difference of the curves.
        difference: f64,
        /// The largest difference allowed.
        most: f64,
    },
}

impl Serialize for ExtremeFault {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
