//! How long the next step along the path is, and how the step before it changes that.
//!
//! | the last step | the next one |
//! |---|---|
//! | continued | as long as its iterations and its turn say, between the scene's shortest and longest |
//! | found no equilibrium, turned too sharply or ended too far away | half as long |
//! | passed a limit point or a bifurcation | half as long, then on with the rest: bisection until the parameter changes by less than the snap tolerance over what is left; then past it |
//!
//! Critical points are recognised by the pivots: at a limit point of the parameter the rate of the parameter along the
//! path and the determinant of the stiffness change sign; at a bifurcation the pivots change without the rate. Between
//! critical points the sign of (rate of the parameter) · (−1)^(negative pivots) is therefore constant (Keller 1977),
//! and a step that ends on its own path turned round, or on another branch, mostly shows as a bifurcation that vanishes
//! when the step is halved; it is not taken while it can be. Pivots that change and change back within a step leave no
//! trace: a step that leaves out a loop of the path, or ends on a branch with as many of them, is recognised by its
//! chord, which does not lie between the tangents at its ends, or by the energy, which is not the work done.
//!
//! Under loads that follow the shell and have no potential the pivots are those of the symmetric part of the tangent, and
//! pass zero elsewhere than its determinant: a limit point then shows as two critical points close together.

use crate::equilibrium::ContinuedPoint;
use crate::pipeline::step_control::{energy_released, is_jump};
use crate::record::CriticalPoint;
use crate::scene::{ArcLength, Scene};
use crate::state::{CriticalAhead, PathMemory, State};

/// Number of Newton iterations that a step is to take: the hinged roof, 12.7 mm, takes least in all with 4 to 6.
const AIMED_ITERATIONS: f64 = 5.0;
/// Angle, in radians, that the tangent is to turn by in a step. The angle with the fewest iterations leaves sharp turns
/// to chance: the path of the tape spring's snap turns by a right angle within 0.2 mm.
const AIMED_TURN: f64 = 0.3;
/// Cosine of the largest turn in a step that is taken.
const SHARPEST_TURN: f64 = 0.8;
/// Cosine between the chord of a step and the mean of the tangents at its ends: arcs of circles have 1. A step that leaves
/// out a loop of the path ends with its tangent anywhere to its chord.
const STRAIGHTEST_CHORD: f64 = 0.98;
/// Distance of the end of a step, relative to its length, beyond which the step has left the path.
const FARTHEST: f64 = 1.5;

/// A step along the path to attempt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathAttempt {
    /// Length of the step, mm.
    pub length_mm: f64,
    /// Whether a critical point within the step is located well enough to be passed.
    pub may_pass: bool,
    /// Whether a step of half the length is still allowed.
    pub can_be_halved: bool,
}

/// Chooses the step along the path that follows a state.
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
    let may_pass = rate * ahead.within_mm <= scene.snap_tolerance() || ahead.within_mm <= LOCATED * path.first_mm;
    attempt(if may_pass { ahead.within_mm } else { 0.5 * ahead.within_mm }, may_pass)
}

/// Finest location of a critical point, relative to the first step: below it rounding decides.
const LOCATED: f64 = 1e-7;

/// Judgement of a point that a step has found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Judgement {
    /// The point is accepted, and the path continues from it.
    Taken(Option<CriticalPoint>),
    /// The point lies beyond a critical point that is not located yet.
    Past(CriticalAhead),
    /// The point may be on another branch.
    TooFar,
}

impl PathAttempt {
    /// Judges the point that the step found.
    pub fn judge(&self, state: &State, path: &PathMemory, point: &ContinuedPoint) -> Judgement {
        let strays = point.turn < SHARPEST_TURN || point.chord < STRAIGHTEST_CHORD;
        let released = energy_released(state, &point.solved);
        let energies = (point.solved.balance.scale(state.strain_energy_n_mm), point.solved.balance.stored);
        if strays || point.distance > FARTHEST * self.length_mm || is_jump(released, energies.0, energies.1) {
            return Judgement::TooFar;
        }
        let here = (path.parameter_rate, state.negative_pivots);
        let there = (point.heading.parameter, point.solved.negative_pivots as u64);
        match CriticalPoint::between(here, there) {
            Some(_) if !self.may_pass => {
                Judgement::Past(CriticalAhead { within_mm: self.length_mm, rate_beyond: there.0 })
            }
            // Within the tolerance, but the path turned round: the step may have met its own path again in the reverse
            // direction.
            Some(critical) if critical.turns_back_alone() && self.can_be_halved => Judgement::TooFar,
            passed => Judgement::Taken(passed),
        }
    }

    /// Memory of the path at a point that was accepted.
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
            at_bifurcation: passed.is_some_and(|critical| critical.is_bifurcation() && critical.pivots_changed > 0),
        }
    }

    /// Memory of the path after a step that found no point, or none that can be accepted; `None` where the next step
    /// would be shorter than the scene allows.
    pub fn shortened(&self, limits: &ArcLength, path: &PathMemory) -> Option<PathMemory> {
        let half = 0.5 * self.length_mm;
        let critical_ahead = match path.critical_ahead {
            // The critical point ahead lies within the attempted step, or there is none.
            Some(ahead) if !self.may_pass => Some(CriticalAhead { within_mm: self.length_mm, ..ahead }),
            _ => None,
        };
        let next_mm = if critical_ahead.is_some() { path.next_mm } else { half };
        (half >= limits.shortest_step * path.first_mm).then(|| PathMemory { critical_ahead, next_mm, ..path.clone() })
    }
}

/// Memory of the path after its first step.
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
mod tests;
