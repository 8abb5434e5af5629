//! How long the next step along the path is, and what a step that was made teaches.
//!
//! | the last step | the next one |
//! |---|---|
//! | went on | as long as its iterations and its turn say, between the scene's shortest and longest |
//! | found no equilibrium, turned too sharply or ended too far away | half as long |
//! | passed a limit point or a bifurcation | half as long, then on with the rest: bisection until the parameter changes by less than the snap tolerance over what is left; then past it |
//!
//! Critical points are told by the pivots: at a limit point of the parameter the rate of the parameter along the path
//! and the determinant of the stiffness change sign; at a bifurcation the pivots change without the rate. The sign of
//! (rate of the parameter) · (−1)^(negative pivots) is therefore constant along a branch (Keller 1977), and a step that ends
//! on its own path turned round, or on another branch, shows as a bifurcation that vanishes when the step is halved: it
//! is never taken, while a real one stays however short the step.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::equilibrium::ContinuedPoint;
use crate::scene::{ArcLength, Scene};
use crate::state::{CriticalAhead, PathMemory, State};

/// Newton iterations that a step is to take: the hinged roof, 12.7 mm, takes least in all with 4 to 6.
const AIMED_ITERATIONS: f64 = 5.0;
/// Angle, in radians, that the tangent is to turn by in a step. What takes fewest iterations leaves sharp turns to chance:
/// the path of the tape spring's snap turns by a right angle within 0.2 mm.
const AIMED_TURN: f64 = 0.3;
/// Cosine of the largest turn in a step that is taken.
const SHARPEST_TURN: f64 = 0.8;
/// A step that ends farther away than this, relative to its length, has left the path.
const FARTHEST: f64 = 1.5;

/// A limit point or a bifurcation that a step has passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct CriticalPoint {
    /// Whether the parameter turns back: a limit point.
    pub limit_point: bool,
    /// By how many the negative pivots of the stiffness changed.
    pub pivots_changed: i64,
}

impl CriticalPoint {
    /// Between two points of the path, each with the rate of the parameter there and the negative pivots.
    pub fn between(before: (f64, u64), after: (f64, u64)) -> Option<Self> {
        let limit_point = before.0.signum() != after.0.signum();
        let pivots_changed = after.1 as i64 - before.1 as i64;
        (limit_point || pivots_changed != 0).then_some(Self { limit_point, pivots_changed })
    }

    /// For a table: what it is, and how the pivots changed.
    pub fn in_words(&self) -> String {
        let change = format!(
            "{:+} negative pivot{}",
            self.pivots_changed,
            if self.pivots_changed.abs() == 1 { "" } else { "s" }
        );
        match (self.limit_point, self.is_bifurcation()) {
            (true, false) => format!("limit point ({change})"),
            (true, true) => format!("limit point and bifurcation ({change})"),
            (false, _) => format!("bifurcation ({change})"),
        }
    }

    /// Whether the parameter turns back while the pivots stay: no limit point, unless a bifurcation falls on it.
    fn turns_back_alone(&self) -> bool {
        self.limit_point && self.pivots_changed == 0
    }

    /// Whether another path crosses here.
    pub fn is_bifurcation(&self) -> bool {
        self.pivots_changed.unsigned_abs() != u64::from(self.limit_point)
    }
}

/// A step to try.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathAttempt {
    /// Its length, mm.
    pub length_mm: f64,
    /// Whether a critical point on the way is located well enough to be passed.
    pub may_pass: bool,
    /// Whether half its length is still allowed.
    pub can_be_halved: bool,
}

/// The step that follows.
pub fn next_path_attempt(scene: &Scene, limits: &ArcLength, path: &PathMemory) -> PathAttempt {
    let shortest = limits.shortest_step * path.first_mm;
    let attempt = |length_mm: f64, may_pass| {
        let can_be_halved = 0.5 * length_mm >= shortest;
        PathAttempt { length_mm, may_pass, can_be_halved }
    };
    let Some(ahead) = path.critical_ahead else {
        return attempt(path.next_mm, false);
    };
    let rate = ahead.rate_beyond.abs().max(path.parameter_rate.abs());
    let may_pass = rate * ahead.within_mm <= scene.snap_tolerance() || ahead.within_mm <= 2.0 * shortest;
    attempt(if may_pass { ahead.within_mm } else { 0.5 * ahead.within_mm }, may_pass)
}

/// What to do with a point that a step has found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Judgement {
    /// Go on from it.
    Taken(Option<CriticalPoint>),
    /// It lies beyond a critical point that is not located yet.
    Past(CriticalAhead),
    /// It may be on another branch.
    TooFar,
}

impl PathAttempt {
    /// Judges the point that the step found.
    pub fn judge(&self, state: &State, path: &PathMemory, point: &ContinuedPoint) -> Judgement {
        if point.turn < SHARPEST_TURN || point.distance > FARTHEST * self.length_mm {
            return Judgement::TooFar;
        }
        let here = (path.parameter_rate, state.negative_pivots);
        let there = (point.heading.parameter, point.solved.negative_pivots as u64);
        match CriticalPoint::between(here, there) {
            Some(_) if !self.may_pass => {
                Judgement::Past(CriticalAhead { within_mm: self.length_mm, rate_beyond: there.0 })
            }
            // Within the tolerance, but the path turned round: it may have been met again from behind.
            Some(critical) if critical.turns_back_alone() && self.can_be_halved => Judgement::TooFar,
            passed => Judgement::Taken(passed),
        }
    }

    /// Memory at the point that was taken.
    pub fn after(
        &self,
        limits: &ArcLength,
        path: &PathMemory,
        point: &ContinuedPoint,
        passed: Option<CriticalPoint>,
    ) -> PathMemory {
        let rest = path.critical_ahead.filter(|ahead| ahead.within_mm > self.length_mm && !self.may_pass);
        let next_mm = match path.critical_ahead {
            Some(_) => path.next_mm,
            None => {
                let by_iterations = (AIMED_ITERATIONS / point.solved.effort.iterations.max(1) as f64).sqrt();
                let by_turn = AIMED_TURN / point.turn.clamp(-1.0, 1.0).acos().max(1e-3);
                let length = self.length_mm * by_iterations.min(by_turn).clamp(0.5, 2.0);
                length.clamp(limits.shortest_step * path.first_mm, limits.longest_step * path.first_mm)
            }
        };
        PathMemory {
            heading: point.heading.motion.clone(),
            parameter_rate: point.heading.parameter,
            first_mm: path.first_mm,
            next_mm,
            travelled_mm: path.travelled_mm + point.distance,
            critical_ahead: rest.map(|ahead| CriticalAhead { within_mm: ahead.within_mm - self.length_mm, ..ahead }),
            at_bifurcation: passed.is_some_and(|critical| critical.is_bifurcation()),
        }
    }

    /// Memory after a step that found nothing, or nothing that can be taken; `None` where it would have to be shorter than
    /// the scene allows.
    pub fn shortened(&self, limits: &ArcLength, path: &PathMemory) -> Option<PathMemory> {
        let half = 0.5 * self.length_mm;
        let critical_ahead = match path.critical_ahead {
            // What is ahead lies within what was tried, or was an illusion.
            Some(ahead) if !self.may_pass => Some(CriticalAhead { within_mm: self.length_mm, ..ahead }),
            _ => None,
        };
        let next_mm = if critical_ahead.is_some() { path.next_mm } else { half };
        (half >= limits.shortest_step * path.first_mm).then(|| PathMemory { critical_ahead, next_mm, ..path.clone() })
    }
}

/// Memory after the first step of a path.
pub fn path_begun(limits: &ArcLength, point: &ContinuedPoint) -> PathMemory {
    let by_iterations = (AIMED_ITERATIONS / point.solved.effort.iterations.max(1) as f64).sqrt();
    PathMemory {
        heading: point.heading.motion.clone(),
        parameter_rate: point.heading.parameter,
        first_mm: point.distance,
        next_mm: point.distance * by_iterations.clamp(limits.shortest_step.max(0.5), limits.longest_step.min(1.0)),
        travelled_mm: point.distance,
        critical_ahead: None,
        at_bifurcation: false,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::equilibrium::{Direction, Effort, Solved};
    use crate::scene::{ArcLengthWord, Stage, parse};
    use crate::spline::Mesh;
    use crate::state::StepControl;

    const LIMITS: ArcLength =
        ArcLength { control: ArcLengthWord::ArcLength, longest_step: 4.0, shortest_step: 1e-3, most_steps: 1000 };
    const FIRST_MM: f64 = 2.0;
    const SHORTEST_MM: f64 = 1e-3 * FIRST_MM;
    /// Cosine of a turn that asks for neither a longer nor a shorter step.
    const GENTLE: f64 = 0.999;

    fn scene(tolerance: f64) -> Scene {
        let mut scene = parse(include_str!("../../pipelines/baseline-uniform.toml"), "baseline-uniform.toml").unwrap();
        scene.continuation = Some(LIMITS);
        scene.solver.snap_tolerance_deg = Some(tolerance);
        scene
    }

    fn memory(parameter_rate: f64) -> PathMemory {
        PathMemory {
            heading: vec![[1.0, 0.0, 0.0]],
            parameter_rate,
            first_mm: FIRST_MM,
            next_mm: FIRST_MM,
            travelled_mm: 10.0,
            critical_ahead: None,
            at_bifurcation: false,
        }
    }

    fn standing(negative_pivots: u64) -> State {
        State {
            mesh: Arc::new(Mesh { degree: [2, 2], knots: [vec![], vec![]], control_points: vec![] }),
            displacement: vec![],
            marked: Default::default(),
            refined: None,
            step: 1,
            stage: Some(Stage::Solve),
            parameter: 0.0,
            turns: vec![],
            moment_n_mm: 0.0,
            strain_energy_n_mm: 0.0,
            negative_pivots,
            control: StepControl::default(),
            previous: None,
            path: None,
        }
    }

    /// A point that a step found after `distance`, where the parameter has this rate and the stiffness these pivots.
    fn point(distance: f64, turn: f64, rate: f64, negative_pivots: usize, iterations: usize) -> ContinuedPoint {
        ContinuedPoint {
            solved: Solved {
                displacement: vec![],
                turns: vec![],
                energy: 0.0,
                work: 0.0,
                moment: 0.0,
                negative_pivots,
                residual: 0.0,
                effort: Effort { iterations, factorizations: iterations },
            },
            parameter: 0.0,
            heading: Direction { motion: vec![[1.0, 0.0, 0.0]], parameter: rate },
            distance,
            turn,
        }
    }

    /// Length of the step that follows one that went on.
    fn length_after(iterations: usize, turn: f64, length_mm: f64) -> f64 {
        let attempt = PathAttempt { length_mm, may_pass: false, can_be_halved: true };
        let found = point(length_mm, turn, 1.0, 0, iterations);
        let path = PathMemory { next_mm: length_mm, ..memory(1.0) };
        assert_eq!(attempt.judge(&standing(0), &path, &found), Judgement::Taken(None));
        let next = attempt.after(&LIMITS, &path, &found, None);
        assert_eq!((next.travelled_mm, next.critical_ahead), (10.0 + length_mm, None));
        next_path_attempt(&scene(0.01), &LIMITS, &next).length_mm
    }

    #[test]
    fn a_step_that_went_on_says_how_long_the_next_one_is() {
        assert!(length_after(2, GENTLE, 2.0) > 2.0, "few iterations: longer");
        assert!(length_after(11, GENTLE, 2.0) < 2.0, "many: shorter");
        assert!(length_after(2, 0.85, 2.0) < 2.0, "a sharp turn: shorter, however few the iterations");
        let lengths: Vec<f64> = (1..=12).map(|iterations| length_after(iterations, GENTLE, 2.0)).collect();
        assert!(lengths.windows(2).all(|pair| pair[1] <= pair[0]), "{lengths:?}");
        // Never longer than the scene's longest step, nor shorter than its shortest.
        assert_eq!(length_after(1, 1.0, 7.9), 4.0 * FIRST_MM);
        assert_eq!(length_after(12, 0.81, 1.1 * SHORTEST_MM), SHORTEST_MM);
    }

    #[test]
    fn a_step_that_failed_or_went_too_far_is_halved_until_it_is_too_short() {
        let mut path = memory(1.0);
        for tries in 0.. {
            let attempt = next_path_attempt(&scene(0.01), &LIMITS, &path);
            assert_eq!(attempt.length_mm, FIRST_MM / 2.0_f64.powi(tries));
            assert!(attempt.length_mm >= SHORTEST_MM, "{} mm is tried", attempt.length_mm);
            for found in [point(attempt.length_mm, 0.5, 1.0, 0, 3), point(1.6 * attempt.length_mm, 0.99, 1.0, 0, 3)] {
                assert_eq!(attempt.judge(&standing(0), &path, &found), Judgement::TooFar);
            }
            match attempt.shortened(&LIMITS, &path) {
                Some(shorter) => path = shorter,
                None => {
                    assert!(0.5 * attempt.length_mm < SHORTEST_MM);
                    return;
                }
            }
            assert_eq!((path.parameter_rate, path.travelled_mm, path.first_mm), (1.0, 10.0, FIRST_MM), "nothing else");
        }
    }

    /// Inside a bracket a failure halves what was tried, and never ends the run while there is a shorter step.
    #[test]
    fn a_failure_inside_a_bracket_keeps_the_bracket() {
        let ahead = CriticalAhead { within_mm: 1.0, rate_beyond: -1.0 };
        let path = PathMemory { critical_ahead: Some(ahead), ..memory(1.0) };
        let attempt = next_path_attempt(&scene(0.01), &LIMITS, &path);
        assert_eq!((attempt.length_mm, attempt.may_pass), (0.5, false));
        let shorter = attempt.shortened(&LIMITS, &path).unwrap();
        assert_eq!(next_path_attempt(&scene(0.01), &LIMITS, &shorter).length_mm, 0.25);
        assert_eq!(shorter.next_mm, path.next_mm, "beyond it the path goes on as before");
        let last =
            PathMemory { critical_ahead: Some(CriticalAhead { within_mm: 1.9 * SHORTEST_MM, ..ahead }), ..memory(1.0) };
        let attempt = next_path_attempt(&scene(1e-9), &LIMITS, &last);
        assert!(attempt.may_pass && attempt.length_mm == 1.9 * SHORTEST_MM, "{attempt:?}");
        assert_eq!(attempt.shortened(&LIMITS, &last), None);
    }

    /// A path λ(s) with something critical on it, followed until that is passed.
    struct Track {
        /// Where it is, mm from the start.
        critical_mm: f64,
        /// λ is `rate` (s − s²/2s_c) for a limit point, `rate` s for a bifurcation.
        rate: f64,
        limit_point: bool,
        pivots_changed: u64,
    }

    impl Track {
        fn parameter(&self, s: f64) -> f64 {
            self.rate * if self.limit_point { s - 0.5 * s * s / self.critical_mm } else { s }
        }

        fn rate(&self, s: f64) -> f64 {
            self.rate * if self.limit_point { 1.0 - s / self.critical_mm } else { 1.0 }
        }

        fn pivots(&self, s: f64) -> u64 {
            if s > self.critical_mm { self.pivots_changed } else { 0 }
        }

        /// What was passed, between which places, and after how many attempts.
        fn follow(&self, tolerance: f64) -> (CriticalPoint, [f64; 2], usize) {
            let scene = scene(tolerance);
            let (mut s, mut path) = (0.0, PathMemory { travelled_mm: 0.0, ..memory(self.rate(0.0)) });
            for attempts in 1..1000 {
                let attempt = next_path_attempt(&scene, &LIMITS, &path);
                assert!(attempt.length_mm > 0.0);
                let there = s + attempt.length_mm;
                let found = point(attempt.length_mm, GENTLE, self.rate(there), self.pivots(there) as usize, 3);
                match attempt.judge(&standing(self.pivots(s)), &path, &found) {
                    Judgement::Taken(passed) => {
                        let known = path.critical_ahead.map(|ahead| s + ahead.within_mm);
                        path = attempt.after(&LIMITS, &path, &found, passed);
                        assert!((path.travelled_mm - there).abs() < 1e-12);
                        if let Some(passed) = passed {
                            assert_eq!(path.critical_ahead, None, "what is passed is forgotten");
                            assert_eq!(path.at_bifurcation, passed.is_bifurcation());
                            return (passed, [s, there], attempts);
                        }
                        // After a part of a bracket the rest of it remains.
                        let rest = path.critical_ahead.map(|ahead| there + ahead.within_mm);
                        assert!(known.zip(rest).is_none_or(|(known, rest)| (known - rest).abs() < 1e-12));
                        assert_eq!(known.is_some(), rest.is_some());
                        s = there;
                    }
                    Judgement::Past(ahead) => {
                        assert!(!attempt.may_pass);
                        assert_eq!(
                            ahead,
                            CriticalAhead { within_mm: attempt.length_mm, rate_beyond: self.rate(there) }
                        );
                        path.critical_ahead = Some(ahead);
                    }
                    Judgement::TooFar => panic!("{attempt:?}"),
                }
            }
            panic!("never passed")
        }
    }

    #[test]
    fn critical_points_are_bracketed_to_the_tolerance_and_passed() {
        for critical_mm in [0.7, 5.0, 37.3, 1000.0] {
            for (limit_point, pivots_changed) in [(true, 1), (false, 1), (false, 2), (true, 2)] {
                for rate in [0.3, -0.3, 40.0] {
                    let track = Track { critical_mm, rate, limit_point, pivots_changed };
                    let (passed, [before, after], attempts) = track.follow(0.01);
                    let expected = CriticalPoint { limit_point, pivots_changed: pivots_changed as i64 };
                    assert_eq!(passed, expected);
                    assert_eq!(passed.is_bifurcation(), !(limit_point && pivots_changed == 1));
                    assert!(before < critical_mm && critical_mm <= after, "{critical_mm}: {before} {after}");
                    let located = (track.parameter(after) - track.parameter(before)).abs();
                    let finest = after - before <= 2.0 * SHORTEST_MM;
                    assert!(located <= 0.01 * (1.0 + 1e-9) || finest, "{critical_mm}: {located}");
                    assert!(attempts < (critical_mm / FIRST_MM) as usize + 30, "{attempts} attempts");
                }
            }
        }
    }

    /// However fine the tolerance, the shortest step ends the bisection.
    #[test]
    fn bisection_ends() {
        let track = Track { critical_mm: 5.0, rate: 100.0, limit_point: false, pivots_changed: 1 };
        let (_, [before, after], attempts) = track.follow(1e-300);
        assert!(after - before <= 2.0 * SHORTEST_MM && attempts < 40, "{before} {after}, {attempts} attempts");
    }

    /// A step that ended on its own path turned round: the parameter runs the other way and the pivots are the same. That
    /// never happens on a path that goes on, so the step is not taken as long as it can be halved, whatever the tolerance.
    #[test]
    fn a_reflected_step_is_never_taken_while_it_can_be_halved() {
        for tolerance in [1e-6, 0.01, 1.0, 1e3] {
            for rate in [1e-6, 0.01, 1.0] {
                let scene = scene(tolerance);
                let mut path = memory(rate);
                let mut attempts = 0;
                loop {
                    attempts += 1;
                    assert!(attempts < 40, "tolerance {tolerance}, rate {rate}: no end");
                    let attempt = next_path_attempt(&scene, &LIMITS, &path);
                    // What looks like a step onwards: straight ahead, and as far as it should be.
                    let found = point(attempt.length_mm, GENTLE, -rate, 1, 3);
                    match attempt.judge(&standing(1), &path, &found) {
                        Judgement::Taken(_) => {
                            let length = attempt.length_mm;
                            let can_be_halved = 0.5 * length >= SHORTEST_MM * (1.0 + 1e-12);
                            assert!(!can_be_halved, "tolerance {tolerance}, rate {rate}: {length} mm is taken");
                            break;
                        }
                        Judgement::Past(ahead) => path.critical_ahead = Some(ahead),
                        Judgement::TooFar => match attempt.shortened(&LIMITS, &path) {
                            Some(shorter) => path = shorter,
                            None => break,
                        },
                    }
                }
            }
        }
    }

    #[test]
    fn a_path_begins_with_the_first_step_as_its_unit() {
        let path = path_begun(&LIMITS, &point(0.37, GENTLE, 2.0, 0, 3));
        assert_eq!((path.first_mm, path.travelled_mm, path.parameter_rate), (0.37, 0.37, 2.0));
        assert!(path.next_mm <= 4.0 * 0.37 && path.next_mm >= 0.5 * 0.37);
        assert_eq!((path.critical_ahead, path.at_bifurcation), (None, false));
    }

    #[test]
    fn words_for_critical_points() {
        let words = |limit_point, pivots_changed| CriticalPoint { limit_point, pivots_changed }.in_words();
        assert_eq!(words(true, 1), "limit point (+1 negative pivot)");
        assert_eq!(words(true, -1), "limit point (-1 negative pivot)");
        assert_eq!(words(false, 2), "bifurcation (+2 negative pivots)");
        assert_eq!(words(true, -2), "limit point and bifurcation (-2 negative pivots)");
        assert_eq!(CriticalPoint::between((1.0, 2), (0.5, 2)), None);
        let turned = CriticalPoint::between((1.0, 0), (-0.5, 0)).unwrap();
        assert!(turned.limit_point && turned.is_bifurcation());
    }
}
