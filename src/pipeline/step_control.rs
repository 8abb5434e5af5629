//! Which value of the parameter the next solve attempts, and how a failure or a jump changes that.
//!
//! Steps lie on the multiples of the scene's increment, so that runs can be compared point by point. Increments that have
//! grown end at the points of histories, too.
//!
//! | the last solve | memory | the next solve |
//! |---|---|---|
//! | continued | forgets a jump; one halving less | the next multiple of the increment, or the target if that is nearer |
//! | continued in at most [`EASY`] iterations, and the scene lets increments grow | the increment doubled | the next multiple of that |
//! | continued in more than [`HARD`] with an increment that had grown | that halved | the next multiple of that |
//! | found no equilibrium | halvings, so that the increment is at most half of what was tried | the next multiple of that |
//! | continued inside a bracket, or jumped, with an increment that had grown | the scene's own increment | the next multiple of that |
//! | passed an unstable shape or released energy | the rotation where it did | the middle between here and there |
//! | continued, but on a refined mesh the shell jumps | the rotation where it did, and the state before it | the middle between there and here |
//! | the same, within `snap_tolerance_deg` of here | the same | there, and the jump is taken |
//!
//! A success inside a bracket forgets the bracket and tries the whole step again: what looked like a jump may have
//! been a step too large for a sharp turn of the path, and for a real one the second look costs two or three
//! iterations.

use crate::equilibrium::Solved;
use crate::scene::{Drive, Scene, Stage};
use crate::state::{Rejection, State, StepControl};

/// Relative energy released in a step (not balanced by work, relative to the strain energy) above which the shell
/// jumped. The baseline's snap releases half of the energy; the trapezoidal rule, by which given motions do work, is
/// off by less than 1e-4 over its smooth steps of 0.4°. Loads take their strokes from the steps of the solve, and only
/// their factors from means. Steps so large that this is off by more are cut, until it is not.
const JUMP_SHARE: f64 = 0.01;

/// Relative energy released in re-equilibrating above which the shell jumped; a finer mesh alone lowers the energy:
/// degree 2 on coarse meshes by up to 3 %, the baseline's fold, when the snap continues during refinement, by 6 to 17
/// %.
const REFINEMENT_JUMP_SHARE: f64 = 0.05;

/// Largest number of iterations after which increments grow, up to the limit that the scene sets. The baseline's
/// quarter takes 511 factorizations at 0.4° throughout, and 325 and 329 with increments up to 1.6° and 3.2°: `foldline
/// study pipelines/baseline-quarter.toml --against pipelines/baseline-reference.toml --vary
/// 'load.longest_increment_deg=[0.4, 1.6, 3.2]'`.
const EASY: usize = 3;
/// Number of iterations above which an increment that has grown is halved: steps of 1.6° up to the baseline's limit
/// point take 7 iterations and end in a jump, where steps of 3.2° along its fold take 5.
const HARD: usize = 6;

/// Distance of two values of the parameter, relative to the increment, below which they are equal: multiples of decimal
/// numbers are not exact.
const SAME: f64 = 1e-6;

/// A solve to attempt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attempt {
    /// Value of the scene's parameter to reach.
    pub target: f64,
    /// Whether a jump on the way is accepted because it is located well enough.
    pub may_jump: bool,
}

/// Chooses the solve that follows a state.
pub fn next_attempt(scene: &Scene, state: &State) -> Attempt {
    let here = state.parameter;
    let tolerance = scene.snap_tolerance();
    if let Some(beyond) = state.drive.control.jump_beyond {
        let middle = 0.5 * (here + beyond);
        let located = beyond - here <= tolerance || middle <= here || middle >= beyond;
        return Attempt { target: if located { beyond } else { middle }, may_jump: located };
    }
    let increment = increment_of(scene, state.drive.control.halvings);
    let multiple = ((here / increment + SAME).floor() + 1.0) * increment;
    let last = scene.load.target();
    let mut target = if multiple > last - SAME * increment { last } else { multiple };
    // An increment that has grown stops at the points of histories.
    if state.drive.control.halvings < 0 {
        let point = scene.next_history_point(here + SAME * scene.load.increment());
        target = point.map_or(target, |point| point.min(target));
    }
    Attempt { target, may_jump: target - here <= tolerance }
}

/// Increment of the scene, halved this many times (or doubled, where negative).
fn increment_of(scene: &Scene, halvings: i32) -> f64 {
    scene.load.increment() / 2.0_f64.powi(halvings)
}

/// Whether a value of the parameter is reached, up to the rounding of steps.
pub fn has_reached(scene: &Scene, state: &State, parameter: f64) -> bool {
    Drive::of(scene).progress(state.parameter) >= parameter - SAME * scene.load.increment()
}

/// Chooses the stage that follows a state; `None` where the run has reached its target.
pub fn next_stage(scene: &Scene, state: &State) -> Option<Stage> {
    let has = |stage| scene.pipeline.contains(&stage);
    let evaluated = match state.stage {
        None => return Some(Stage::Solve),
        Some(Stage::Solve) if state.drive.control.rejection.is_some() => return Some(Stage::Solve),
        Some(Stage::RefineKnots) => return Some(Stage::ProjectDisplacements),
        Some(Stage::ProjectDisplacements | Stage::CoarsenKnots) => return Some(Stage::ReEquilibrate),
        Some(Stage::Solve | Stage::ReEquilibrate) if has(Stage::SwitchBranch) && is_to_be_left(scene, state) => {
            return Some(Stage::SwitchBranch);
        }
        Some(Stage::Solve | Stage::ReEquilibrate | Stage::SwitchBranch) => false,
        Some(Stage::EvaluateIndicators) => true,
    };
    if !evaluated && has(Stage::EvaluateIndicators) {
        return Some(Stage::EvaluateIndicators);
    }
    if has(Stage::RefineKnots) && state.marked.iter().flatten().any(|knots| !knots.is_empty()) {
        return Some(Stage::RefineKnots);
    }
    if has(Stage::CoarsenKnots) && state.superfluous.iter().flatten().any(|knots| !knots.is_empty()) {
        return Some(Stage::CoarsenKnots);
    }
    (!has_reached(scene, state, scene.load.target())).then_some(Stage::Solve)
}

/// Whether a run leaves the unstable equilibrium of a state. Along a path it leaves only a branch that has just become
/// unstable: behind a limit point the path itself is asked for.
fn is_to_be_left(scene: &Scene, state: &State) -> bool {
    let along_path = Drive::of(scene).follows_path();
    let bifurcated = state.drive.path().is_some_and(|path| path.at_bifurcation);
    state.negative_pivots > 0 && (!along_path || bifurcated)
}

impl Attempt {
    /// Size of the attempted step, in the units of the scene's parameter.
    pub fn increment(&self, state: &State) -> f64 {
        self.target - state.parameter
    }

    /// Step control after the attempt succeeded in this many iterations.
    pub fn control_after_success(&self, scene: &Scene, before: &StepControl, iterations: usize) -> StepControl {
        let twice = increment_of(scene, before.halvings.saturating_sub(1));
        let may_grow = iterations <= EASY && twice <= scene.load.longest_increment() * (1.0 + SAME);
        let change = if before.jump_beyond.is_some() {
            // After a jump, or a turn that looked like one, an increment that had grown was too large.
            before.halvings.min(0).saturating_neg()
        } else if before.halvings > 0 || may_grow {
            -1
        } else {
            i32::from(before.halvings < 0 && iterations > HARD)
        };
        let halvings = before.halvings.saturating_add(change);
        StepControl { halvings, jump_beyond: None, rejection: None }
    }

    /// Step control after the attempt passed an unstable shape or released energy.
    pub fn control_after_jump(&self, before: &StepControl) -> StepControl {
        StepControl { jump_beyond: Some(self.target), rejection: Some(Rejection::Jump), ..*before }
    }

    /// Step control after the attempt found no equilibrium; `None` where an increment below the scene's least one
    /// would be needed, or where a located jump could not be followed.
    pub fn control_after_failure(&self, scene: &Scene, state: &State) -> Option<StepControl> {
        if state.drive.control.jump_beyond.is_some() && self.may_jump {
            return None;
        }
        let half = 0.5 * self.increment(state);
        let mut halvings = state.drive.control.halvings;
        while increment_of(scene, halvings) > half * (1.0 + SAME) {
            halvings += 1;
        }
        let increment = increment_of(scene, halvings);
        let rejection = Some(Rejection::NoEquilibrium);
        (increment >= scene.least_increment()).then_some(StepControl { halvings, jump_beyond: None, rejection })
    }
}

/// Energy released from a state to an equilibrium, N·mm: work of loads, given motions and changes of the natural state
/// that did not go into strain energy.
pub fn energy_released(state: &State, solved: &Solved) -> f64 {
    solved.balance.dissipated(state.strain_energy_n_mm)
}

/// Energy released, N·mm, where it is known: a shell never releases a negative energy, and a negative value comes from
/// the means that work is formed with, or from loads whose work depends on the path of the shell.
pub fn known_release(released: f64) -> Option<f64> {
    (released >= 0.0).then_some(released)
}

/// Whether the energy released shows that the shell jumped.
pub fn is_jump(released: f64, before: f64, after: f64) -> bool {
    released.abs() > JUMP_SHARE * before.max(after)
}

/// Whether the energy released in re-equilibrating on a finer mesh shows that the shell jumped: it is more than
/// refining any mesh releases, or than this one was expected to.
pub fn is_jump_on_refinement(state: &State, released: f64) -> bool {
    let share = |expected: f64| expected.max(JUMP_SHARE * state.strain_energy_n_mm);
    let expected = state.refinement.and_then(|refinement| refinement.expected_n_mm).map(share);
    released > expected.unwrap_or(f64::INFINITY).min(REFINEMENT_JUMP_SHARE * state.strain_energy_n_mm)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{EndRotation, Load, parse};
    use crate::spline::Patch;
    use crate::state::{Course, DriveMemory};

    fn scene(increment: f64, rotation_deg: f64) -> Scene {
        let mut scene = parse(include_str!("../../pipelines/baseline-uniform.toml"), "baseline-uniform.toml").unwrap();
        let sense = scene.end_rotation().unwrap().sense;
        scene.load = Load::EndRotation(EndRotation {
            sense,
            rotation_deg,
            increment_deg: increment,
            longest_increment_deg: None,
        });
        scene.solver.snap_tolerance_deg = Some(0.01);
        scene.solver.least_increment_deg = Some(1e-4);
        scene
    }

    fn at(parameter: f64, control: StepControl) -> State {
        let mesh = Patch { degree: [2, 2], knots: [vec![], vec![]], control_points: vec![] };
        let drive = DriveMemory { control, course: Course::Unknown };
        State { step: 1, stage: Some(Stage::Solve), parameter, drive, ..State::undeformed(mesh) }
    }

    /// Rotations of a run in which every attempt succeeds.
    fn smooth(scene: &Scene) -> Vec<f64> {
        let mut state = at(0.0, StepControl::default());
        let mut rotations = Vec::new();
        while next_stage(scene, &state).is_some() {
            let attempt = next_attempt(scene, &state);
            state = at(attempt.target, attempt.control_after_success(scene, &state.drive.control, 4));
            rotations.push(state.parameter);
        }
        rotations
    }

    #[test]
    fn steps_are_multiples_and_no_slivers() {
        for increment in [0.1, 0.3, 0.4, 0.6, 0.7] {
            for tenths in 1..=120 {
                let target = f64::from(tenths) / 10.0;
                let rotations = smooth(&scene(increment, target));
                assert_eq!(rotations.len(), (target / increment - 1e-6).ceil() as usize, "{target} by {increment}");
                assert_eq!(rotations.last(), Some(&target));
            }
        }
        assert_eq!(smooth(&scene(0.4, 1.0)).len(), 3);
        assert_eq!(smooth(&scene(5.0, 1.0)), [1.0]);
    }

    /// Runs with a shell that jumps at `critical`, one way; returns the bracket in which the jump was taken, and the
    /// attempts.
    fn locate(scene: &Scene, critical: f64) -> ([f64; 2], usize) {
        let mut state = at(0.0, StepControl::default());
        for attempts in 1..10_000 {
            let attempt = next_attempt(scene, &state);
            assert!(attempt.target > state.parameter);
            let jumps = state.parameter < critical && attempt.target >= critical;
            if jumps && attempt.may_jump {
                return ([state.parameter, attempt.target], attempts);
            }
            state = if jumps {
                at(state.parameter, attempt.control_after_jump(&state.drive.control))
            } else {
                at(attempt.target, attempt.control_after_success(scene, &state.drive.control, 4))
            };
        }
        panic!("never located");
    }

    #[test]
    fn a_jump_is_bracketed_to_the_tolerance() {
        for critical in [0.003, 0.4, 3.217, 9.9039, 9.99999] {
            let ([below, beyond], attempts) = locate(&scene(0.4, 20.0), critical);
            assert!(below < critical && critical <= beyond && beyond - below <= 0.01, "{critical}: {below} {beyond}");
            assert!(attempts <= (critical / 0.4) as usize + 20, "{attempts} attempts to {critical}");
        }
        let mut fine = scene(0.4, 20.0);
        // Finer than numbers are: the bracket of two neighbours ends it.
        fine.solver.snap_tolerance_deg = Some(1e-18);
        let ([below, beyond], _) = locate(&fine, 3.217);
        assert!(below < beyond && beyond - below < 1e-14);
    }

    #[test]
    fn a_failing_solve_is_never_tried_again_unchanged_and_ends() {
        for start in [0.0, 9.6, 9.90625, 9.9999] {
            let scene = scene(0.4, 20.0);
            let mut state = at(start, StepControl::default());
            let mut before = f64::INFINITY;
            let mut tries = 0;
            loop {
                let attempt = next_attempt(&scene, &state);
                let size = attempt.increment(&state);
                assert!(size <= 0.5 * before * (1.0 + 1e-5), "{start}: {size} after {before}");
                before = size;
                tries += 1;
                match attempt.control_after_failure(&scene, &state) {
                    Some(control) => state = at(start, control),
                    None => break,
                }
            }
            assert!(tries <= 15, "{tries} tries from {start}");
        }
    }

    #[test]
    fn the_increment_grows_back() {
        let scene = scene(0.4, 20.0);
        let mut state = at(2.0, StepControl { halvings: 3, ..StepControl::default() });
        let mut sizes = Vec::new();
        for _ in 0..5 {
            let attempt = next_attempt(&scene, &state);
            sizes.push((attempt.increment(&state) * 1e6).round() / 1e6);
            state = at(attempt.target, attempt.control_after_success(&scene, &state.drive.control, 4));
        }
        assert_eq!(sizes, [0.05, 0.05, 0.1, 0.2, 0.4]);
    }

    #[test]
    fn increments_grow_and_shrink_with_the_iterations() {
        let mut scene = scene(0.4, 20.0);
        let Load::EndRotation(load) = &mut scene.load else { unreachable!() };
        load.longest_increment_deg = Some(2.0);
        let mut state = at(0.0, StepControl { halvings: 1, ..StepControl::default() });
        let mut sizes = Vec::new();
        for iterations in [3, 3, 3, 3, 3, 4, 6, 7, 7, 7, 7] {
            let attempt = next_attempt(&scene, &state);
            let multiple = attempt.target / 0.2;
            assert!((multiple - multiple.round()).abs() < 1e-9, "steps are multiples of the current increment");
            state = at(attempt.target, attempt.control_after_success(&scene, &state.drive.control, iterations));
            sizes.push(0.4 / 2.0_f64.powi(state.drive.control.halvings));
        }
        // Up to 1.6 (3.2 would be more than 2), steady between, and back to the scene's own, not below it.
        assert_eq!(sizes, [0.4, 0.8, 1.6, 1.6, 1.6, 1.6, 1.6, 0.8, 0.4, 0.4, 0.4]);
        // A turn that looked like a jump ends the growth.
        let seen = StepControl { halvings: -2, jump_beyond: Some(9.6), rejection: None };
        let bracketed = at(8.0, seen);
        let after = next_attempt(&scene, &bracketed).control_after_success(&scene, &bracketed.drive.control, 3);
        assert_eq!((after.halvings, after.jump_beyond), (0, None));
        // A failure cuts what had grown.
        let grown = at(8.0, StepControl { halvings: -2, ..StepControl::default() });
        let attempt = next_attempt(&scene, &grown);
        assert_eq!(attempt.control_after_failure(&scene, &grown).unwrap().halvings, -1);
    }

    /// A load that comes and goes is not stepped over.
    #[test]
    fn grown_increments_end_at_the_points_of_histories() {
        let text = include_str!("../../tests/restart/column.toml")
            .replace("increment = 0.25", "increment = 0.25\nlongest_increment = 2.0")
            .replace("factor = 1.05", "factor = 4.0")
            .replace("name = \"thrust\"", "name = \"thrust\"\nhistory = [[0, 0], [1.1, 1], [1.3, 0], [4, 0]]");
        let (text, _) = text.split_once("[continuation]").unwrap();
        let scene = parse(text, "column.toml").unwrap();
        let mut state = at(0.0, StepControl::default());
        let mut parameters = Vec::new();
        while next_stage(&scene, &state).is_some() {
            let attempt = next_attempt(&scene, &state);
            state = at(attempt.target, attempt.control_after_success(&scene, &state.drive.control, 2));
            parameters.push(state.parameter);
        }
        assert_eq!(parameters, [0.25, 0.5, 1.0, 1.1, 1.3, 2.0, 4.0]);
    }

    #[test]
    fn a_located_jump_that_cannot_be_followed_is_not_tried_again() {
        let scene = scene(0.4, 20.0);
        let control = StepControl { jump_beyond: Some(5.005), ..StepControl::default() };
        let state = at(5.0, control);
        let attempt = next_attempt(&scene, &state);
        assert_eq!((attempt.target, attempt.may_jump), (5.005, true));
        assert_eq!(attempt.control_after_failure(&scene, &state), None);
    }
}
