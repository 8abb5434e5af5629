//! Each row of the table, and paths made up with a critical point on them.

use super::*;
use crate::energy::Balance;
use crate::equilibrium::{Direction, Effort, Solved};
use crate::record::CriticalPoint;
use crate::scene::{ArcLengthWord, Stage, parse};
use crate::spline::Patch;

const LIMITS: ArcLength =
    ArcLength { control: ArcLengthWord::ArcLength, longest_step: 4.0, shortest_step: 1e-3, most_steps: 1000 };
const FIRST_MM: f64 = 2.0;
const SHORTEST_MM: f64 = 1e-3 * FIRST_MM;
/// Cosine of a turn that asks for neither a longer nor a shorter step.
const GENTLE: f64 = 0.999;

fn scene(tolerance: f64) -> Scene {
    let mut scene = parse(include_str!("../../../pipelines/baseline-uniform.toml"), "baseline-uniform.toml").unwrap();
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

fn state_with(negative_pivots: u64) -> State {
    let mesh = Patch { degree: [2, 2], knots: [vec![], vec![]], control_points: vec![] };
    State { step: 1, stage: Some(Stage::Solve), negative_pivots, ..State::undeformed(mesh) }
}

/// A point that a step found after `distance`, where the parameter has this rate and the stiffness these pivots.
fn point(distance: f64, turn: f64, rate: f64, negative_pivots: usize, iterations: usize) -> ContinuedPoint {
    ContinuedPoint {
        solved: Solved {
            displacement: vec![],
            turns: vec![],
            balance: Balance::default(),
            moment: 0.0,
            negative_pivots,
            largest_force: 0.0,
            residual: 0.0,
            effort: Effort { iterations, factorizations: iterations },
        },
        parameter: 0.0,
        heading: Direction { motion: vec![[1.0, 0.0, 0.0]], parameter: rate },
        distance,
        turn,
        chord: 1.0,
    }
}

/// Length of the step that follows one that continued.
fn length_after(iterations: usize, turn: f64, length_mm: f64) -> f64 {
    let attempt = PathAttempt { length_mm, may_pass: false, can_be_halved: true };
    let found = point(length_mm, turn, 1.0, 0, iterations);
    let path = PathMemory { next_mm: length_mm, ..memory(1.0) };
    assert_eq!(attempt.judge(&state_with(0), &path, &found), Judgement::Taken(None));
    let next = attempt.after(&LIMITS, &path, &found, None);
    assert_eq!((next.travelled_mm, next.critical_ahead), (10.0 + length_mm, None));
    next_path_attempt(&scene(0.01), &LIMITS, &next).length_mm
}

#[test]
fn a_step_that_continued_says_how_long_the_next_one_is() {
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
            assert_eq!(attempt.judge(&state_with(0), &path, &found), Judgement::TooFar);
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
    assert_eq!(shorter.next_mm, path.next_mm, "beyond it the path continues as before");
    let finest = LOCATED * FIRST_MM;
    let last = PathMemory { critical_ahead: Some(CriticalAhead { within_mm: finest, ..ahead }), ..memory(1.0) };
    let attempt = next_path_attempt(&scene(1e-9), &LIMITS, &last);
    assert!(
        attempt.may_pass && attempt.length_mm == finest,
        "located however loose or tight the tolerance: {attempt:?}"
    );
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
            match attempt.judge(&state_with(self.pivots(s)), &path, &found) {
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
                    assert_eq!(ahead, CriticalAhead { within_mm: attempt.length_mm, rate_beyond: self.rate(there) });
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
/// never happens on a path that continues, so the step is not taken as long as it can be halved, whatever the tolerance.
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
                match attempt.judge(&state_with(1), &path, &found) {
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
