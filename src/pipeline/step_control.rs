//! Which rotation the next solve tries, and what a failed or jumping one teaches.
//!
//! Steps lie on the multiples of the scene's increment, so that runs can be compared point by point. Where a solve finds no
//! equilibrium, the increment is halved, and doubled back after each success. Where the shell jumps, the jump is bracketed: the last good
//! rotation is below it, `jump_seen_at_deg` beyond, and the middle is tried until the bracket is as narrow as the scene's
//! `snap_tolerance_deg`; then the jump is taken, and the run goes on with the scene's increment.

use crate::equilibrium::Solved;
use crate::scene::{Scene, Stage};
use crate::state::{Rejection, State, StepControl};

/// Energy that leaves the balance of a step, relative to the strain energy, above which the step jumped. The baseline's snap
/// releases half of the energy; the trapezoidal rule over its smooth steps of 0.4° is off by less than 1e-4.
const JUMP_SHARE: f64 = 0.01;

/// A solve to try.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attempt {
    /// Rotation to reach, degrees.
    pub target_deg: f64,
    /// Whether a jump on the way is accepted: it is located well enough.
    pub may_jump: bool,
}

/// The solve that follows a state.
pub fn next_attempt(scene: &Scene, state: &State) -> Attempt {
    let here = state.rotation_deg;
    let tolerance = scene.solver.snap_tolerance_deg;
    if let Some(beyond) = state.control.jump_seen_at_deg {
        let located = beyond - here <= tolerance;
        return Attempt { target_deg: if located { beyond } else { 0.5 * (here + beyond) }, may_jump: located };
    }
    let increment = scene.load.increment_deg / 2.0_f64.powi(state.control.halvings as i32);
    // The next multiple; a rotation that is one already, to rounding, does not count.
    let multiple = (here / increment + 1e-6).floor() + 1.0;
    let target_deg = (multiple * increment).min(scene.load.rotation_deg);
    Attempt { target_deg, may_jump: target_deg - here <= tolerance }
}

/// The stage that follows a state; `None` where the run has reached its target.
pub fn next_stage(scene: &Scene, state: &State) -> Option<Stage> {
    let has = |stage| scene.pipeline.contains(&stage);
    let evaluated = match state.stage {
        None => return Some(Stage::Solve),
        Some(Stage::Solve) if state.control.rejection.is_some() => return Some(Stage::Solve),
        Some(Stage::RefineKnots) => return Some(Stage::ProjectDisplacements),
        Some(Stage::ProjectDisplacements) => return Some(Stage::ReEquilibrate),
        Some(Stage::Solve | Stage::ReEquilibrate) => false,
        Some(Stage::EvaluateIndicators) => true,
    };
    if !evaluated && has(Stage::EvaluateIndicators) {
        return Some(Stage::EvaluateIndicators);
    }
    if has(Stage::RefineKnots) && state.marked.iter().any(|knots| !knots.is_empty()) {
        return Some(Stage::RefineKnots);
    }
    (state.rotation_deg < scene.load.rotation_deg).then_some(Stage::Solve)
}

impl Attempt {
    /// Size of the attempted step, degrees.
    pub fn increment_deg(&self, state: &State) -> f64 {
        self.target_deg - state.rotation_deg
    }

    /// Work of the end moments (trapezoidal rule) that did not go into strain energy, N·mm.
    pub fn energy_released(&self, state: &State, solved: &Solved) -> f64 {
        let work = (state.moment_n_mm + solved.moment) * self.increment_deg(state).to_radians();
        state.strain_energy_n_mm + work - solved.energy
    }

    /// Step control after the attempt was taken.
    pub fn control_after_success(&self, before: &StepControl) -> StepControl {
        StepControl {
            halvings: before.halvings.saturating_sub(1),
            jump_seen_at_deg: before.jump_seen_at_deg.filter(|beyond| *beyond > self.target_deg),
            rejection: None,
        }
    }

    /// Step control after the attempt was turned down.
    pub fn control_after_rejection(&self, before: &StepControl, rejection: Rejection) -> StepControl {
        match rejection {
            Rejection::Jump => StepControl {
                halvings: before.halvings,
                jump_seen_at_deg: Some(self.target_deg),
                rejection: Some(rejection),
            },
            Rejection::NoEquilibrium => {
                StepControl { halvings: before.halvings + 1, jump_seen_at_deg: None, rejection: Some(rejection) }
            }
        }
    }
}

/// Whether energy that left the balance says that the shell jumped.
pub fn is_jump(released: f64, before: f64, after: f64) -> bool {
    released.abs() > JUMP_SHARE * before.max(after)
}
