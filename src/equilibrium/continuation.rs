//! Continuation along the path of equilibria, with the parameter λ as an unknown in addition to the free unknowns q.
//!
//! A step of length s goes from a point of the path along its unit tangent t to a point of the plane t·Δx = s: the residual
//! R(q, λ) and the equation of the plane are solved together by Newton's method (Riks 1979; Wempner 1971; the linear
//! constraint makes the consistently linearised method of Schweizerhof & Wriggers 1986 exact, and has none of the two roots
//! of Crisfield's sphere). With K δ₁ = −R and K δ₂ = −∂R/∂λ the bordered system takes one factorization an iteration.
//! Between a limit point in λ and the next, K has a negative pivot, and its L D Lᵀ factor serves as it is.
//!
//! Lengths are of displacements alone, λ has no weight (Crisfield's cylindrical choice): λ may be degrees or a load factor,
//! and a prescribed motion shows in the displacements anyway. See [`Metric`] for how they are measured.

use crate::equilibrium::configuration::Configuration;
use crate::equilibrium::equations::{Equations, Point};
use crate::equilibrium::iterate::{Effort, Observer};
use crate::equilibrium::ledger::SolveStart;
use crate::equilibrium::metric::Metric;
use crate::equilibrium::solve_error::SolveError;
use crate::equilibrium::solved::Solved;
use crate::equilibrium::workspace::Workspace;
use crate::scene::Scene;
use crate::shell::{add, scaled, sub};

/// Largest number of Newton iterations of a step. Steps of the tape spring's path that converge take 3 to 7; what has
/// not converged by then has mostly left the neighbourhood of the path.
const MOST_ITERATIONS: usize = 12;
/// Largest number of Newton iterations to the path on a finer mesh.
const MOST_CORRECTIONS: usize = 60;
/// Largest distance from the plane that counts as on it, relative to the length of the step.
const ON_PLANE: f64 = 1e-6;

/// A direction of the path: rates along its length.
#[derive(Clone, Debug, PartialEq)]
pub struct Direction {
    /// Rates of the displacements of the control points; their length is 1.
    pub motion: Vec<[f64; 3]>,
    /// Rate of the parameter, per mm.
    pub parameter: f64,
}

/// A point of the path, reached from another.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ContinuedPoint {
    /// The equilibrium.
    pub solved: Solved,
    /// Value of the scene's parameter there.
    pub parameter: f64,
    /// Tangent of the path there, in the direction of travel.
    pub heading: Direction,
    /// Straight distance from the point before, mm.
    pub distance: f64,
    /// Cosine of the angle between the tangents at both points.
    pub turn: f64,
    /// Cosine of the angle between the chord and the mean of both tangents: 1 for an arc of a circle.
    pub chord: f64,
}

/// Direction in which the path continues from a point.
#[derive(Clone, Copy, Debug)]
pub enum Sense<'s> {
    /// In the direction of a growing (or falling) parameter.
    Parameter { grows: bool },
    /// In the direction at less than a right angle to this motion of the control points.
    Along(&'s [[f64; 3]]),
}

/// Condition that a solve along the path ends on.
enum Constraint<'c> {
    /// A value of the parameter.
    Parameter(f64),
    /// The nearest point of the path: each iteration moves at right angles to the tangent of the level curve R(q, λ) =
    /// const. that it starts from (the Moore–Penrose inverse of Allgower & Georg, Introduction to Numerical
    /// Continuation Methods, chapter 3). A fixed plane may miss a path that turns away on a finer mesh.
    Nearest,
    /// The plane t·(u − u₀) = s.
    Plane { normal: &'c [[f64; 3]], from: &'c [[f64; 3]], distance: f64 },
}

/// Tangent of the path at a point.
struct Tangent {
    direction: Direction,
    /// Rates of the free unknowns along the path.
    free: Vec<f64>,
}

/// Solver that follows the path of equilibria of a scene on the mesh of a workspace.
#[derive(Debug)]
pub struct Continuation<'a> {
    scene: &'a Scene,
    work: &'a mut Workspace,
    metric: Metric,
}

impl<'a> Continuation<'a> {
    /// Creates a continuation that uses the buffers of `work`.
    pub fn new(scene: &'a Scene, work: &'a mut Workspace) -> Self {
        let metric = Metric::new(&work.discretization.mesh);
        Self { scene, work, metric }
    }

    /// Makes the first step of a path: a change of the parameter, predicted along the tangent.
    ///
    /// # Errors
    /// Where no equilibrium is found in a few iterations, or nothing moves.
    pub fn begin(&mut self, from: Configuration, to: f64, observer: Observer) -> Result<ContinuedPoint, SolveError> {
        let (tangent, free) = self.tangent_at(from, Sense::Parameter { grows: to > from.parameter })?;
        let distance = (to - from.parameter) / tangent.direction.parameter;
        let start = (along(&free, &tangent.free, distance), to);
        self.solve(from, &tangent.direction, start, &Constraint::Parameter(to), None, observer)
    }

    /// Makes a step of this length, in the sense of `heading`.
    ///
    /// # Errors
    /// Where no equilibrium is found in a few iterations.
    pub fn step(
        &mut self,
        from: Configuration,
        heading: &[[f64; 3]],
        distance: f64,
        observer: Observer,
    ) -> Result<ContinuedPoint, SolveError> {
        let (Tangent { direction, free: rates }, free) = self.tangent_at(from, Sense::Along(heading))?;
        let start = (along(&free, &rates, distance), from.parameter + distance * direction.parameter);
        let plane = Constraint::Plane { normal: &direction.motion, from: from.displacement, distance };
        self.solve(from, &direction, start, &plane, None, observer)
    }

    /// Makes a step to a value of the parameter at which a history has a corner. The path may turn there by any angle,
    /// even back on itself, where one drive stops and another begins. The heading at the end is that beyond the corner,
    /// in which the parameter continues as before, or the heading of the path before the corner where nothing moves
    /// beyond it.
    ///
    /// # Errors
    /// Where no equilibrium is found in a few iterations.
    pub fn step_to_corner(
        &mut self,
        from: Configuration,
        parameter: f64,
        observer: Observer,
    ) -> Result<ContinuedPoint, SolveError> {
        let point = self.begin(from, parameter, observer)?;
        let Solved { displacement, turns, largest_force, .. } = &point.solved;
        let sense = Sense::Parameter { grows: parameter > from.parameter };
        let there = Configuration { displacement, turns, parameter, largest_force: *largest_force };
        let heading = match self.heading_at(there, sense) {
            Err(SolveError::NothingMoves { .. }) => point.heading.clone(),
            found => found?,
        };
        Ok(ContinuedPoint { heading, turn: 1.0, chord: 1.0, ..point })
    }

    /// Finds the point of the path with this parameter, between `from` and a point that was reached from there.
    ///
    /// # Errors
    /// Where no equilibrium is found in a few iterations.
    pub fn step_to(
        &mut self,
        from: Configuration,
        beyond: &ContinuedPoint,
        parameter: f64,
        observer: Observer,
    ) -> Result<ContinuedPoint, SolveError> {
        let (tangent, _) = self.tangent_at(from, Sense::Along(&beyond.heading.motion))?;
        let share = (parameter - from.parameter) / (beyond.parameter - from.parameter);
        let between = |a: &[[f64; 3]], b: &[[f64; 3]]| -> Vec<[f64; 3]> {
            a.iter().zip(b).map(|(a, b)| add(*a, scaled(share, sub(*b, *a)))).collect()
        };
        let displacement = &between(from.displacement, &beyond.solved.displacement);
        let turns = &between(from.turns, &beyond.solved.turns);
        let free = Configuration { displacement, turns, parameter, ..from }.free(&self.work.discretization.unknowns);
        self.solve(from, &tangent.direction, (free, parameter), &Constraint::Parameter(parameter), None, observer)
    }

    /// Finds the point of the path nearest to a displacement that may be out of balance; where `held`, the one with the
    /// same parameter.
    ///
    /// # Errors
    /// Where none is found in a few iterations.
    pub fn correct(
        &mut self,
        from: Configuration,
        heading: &Direction,
        held: bool,
        observer: Observer,
    ) -> Result<ContinuedPoint, SolveError> {
        let constraint = if held { Constraint::Parameter(from.parameter) } else { Constraint::Nearest };
        let free = from.free(&self.work.discretization.unknowns);
        self.solve(from, heading, (free, from.parameter), &constraint, Some(&heading.motion), observer)
    }

    /// Finds the unit tangent of the path at an equilibrium.
    ///
    /// # Errors
    /// Where the stiffness has no factor, or nothing moves.
    pub fn heading_at(&mut self, at: Configuration, sense: Sense) -> Result<Direction, SolveError> {
        self.tangent_at(at, sense).map(|(tangent, _)| tangent.direction)
    }

    /// Straight distance between two displacements, mm.
    pub fn distance(&self, from: &[[f64; 3]], to: &[[f64; 3]]) -> f64 {
        self.metric.length(&motion(from, to))
    }

    /// Finds the tangent at an equilibrium, and the free unknowns there.
    fn tangent_at(&mut self, at: Configuration, sense: Sense) -> Result<(Tangent, Vec<f64>), SolveError> {
        let mut equations = Equations::factored_at(self.work, at)?;
        let point = equations.at_configuration(at)?;
        let tangent = tangent(&mut equations, &point, &self.metric, sense)?;
        Ok((tangent, point.here.free))
    }

    /// Solves for a point of the path, which continues in the sense of `onwards`, or else of the chord from `from`.
    fn solve(
        &mut self,
        from: Configuration,
        heading: &Direction,
        (mut free, mut parameter): (Vec<f64>, f64),
        constraint: &Constraint,
        onwards: Option<&[[f64; 3]]>,
        observer: Observer,
    ) -> Result<ContinuedPoint, SolveError> {
        let before = SolveStart::at(self.work, from);
        let Self { scene, work, metric } = self;
        // A correction cannot fall back on a shorter step.
        let most = if onwards.is_some() { MOST_CORRECTIONS } else { MOST_ITERATIONS };
        let mut effort = Effort::default();
        let mut equations = Equations::of(work, from);
        let point = loop {
            let point = equations.at(free, parameter, &mut effort)?;
            let last = point.iterate;
            if observer(&last) {
                return Err(SolveError::Stopped { last, effort });
            }
            let (off, scale) = constraint.distance(&point, metric);
            if last.is_equilibrium(scene.solver.tolerance) && off.abs() <= ON_PLANE * scale {
                break point;
            }
            if last.iteration >= most {
                return Err(SolveError::TooManyIterations { last, effort });
            }
            let step = equations.solve(&point, &negative(&point.gradient));
            let rates = equations.solve(&point, &negative(&point.gradient_rate));
            let change = constraint.change(&point, metric, off, &step, &rates);
            if !change.is_finite() {
                return Err(SolveError::NothingMoves { parameter: point.here.parameter, effort });
            }
            effort.iterations += 1;
            parameter += change;
            free = along(&along(&point.here.free, &step, 1.0), &rates, change);
        };
        let chord = motion(from.displacement, &point.here.displacement);
        let sense = onwards.unwrap_or(&chord);
        let end = match tangent(&mut equations, &point, metric, Sense::Along(sense)) {
            Ok(tangent) => tangent.direction,
            // A run may end where its histories do: there the path has the heading by which it came.
            Err(SolveError::NothingMoves { .. }) if metric.length(&chord) > 0.0 => {
                let share = 1.0 / metric.length(&chord);
                let motion = chord.iter().map(|step| scaled(share, *step)).collect();
                Direction { motion, parameter: share * (parameter - from.parameter) }
            }
            Err(error) => return Err(error),
        };
        let (last, ended) = (point.iterate, point.ended(&equations, from, effort));
        let mean: Vec<[f64; 3]> = heading.motion.iter().zip(&end.motion).map(|(a, b)| add(*a, *b)).collect();
        let lengths = metric.length(&chord) * metric.length(&mean);
        Ok(ContinuedPoint {
            chord: if lengths > 0.0 { metric.product(&chord, &mean) / lengths } else { 1.0 },
            distance: metric.length(&chord),
            turn: metric.product(&heading.motion, &end.motion),
            heading: end,
            parameter,
            solved: work.solved(scene, parameter, &before, ended, &last),
        })
    }
}

impl Constraint<'_> {
    /// Distance of a point from where the solve is to end, and the scale that it is measured by.
    fn distance(&self, point: &Point, metric: &Metric) -> (f64, f64) {
        match self {
            Constraint::Parameter(parameter) => (parameter - point.here.parameter, parameter.abs()),
            Constraint::Nearest => (0.0, 0.0),
            Constraint::Plane { normal, from, distance } => {
                (distance - metric.product(normal, &motion(from, &point.here.displacement)), distance.abs())
            }
        }
    }

    /// Change of the parameter with which `step` + change · `rates` meets the constraint.
    fn change(&self, point: &Point, metric: &Metric, off: f64, step: &[f64], rates: &[f64]) -> f64 {
        match self {
            Constraint::Parameter(_) => off,
            Constraint::Nearest => {
                let tangent = point.here.placement.velocity(rates, &point.given_rates);
                -metric.product(&tangent, &point.here.placement.velocity(step, &[]))
                    / metric.product(&tangent, &tangent)
            }
            Constraint::Plane { normal, .. } => {
                let ahead = metric.product(normal, &point.here.placement.velocity(step, &[]));
                (off - ahead) / metric.product(normal, &point.here.placement.velocity(rates, &point.given_rates))
            }
        }
    }
}

/// Finds the tangent of the path at an equilibrium: q̇ = −K⁻¹ ∂R/∂λ λ̇, scaled to a motion of length 1.
fn tangent(equations: &mut Equations, point: &Point, metric: &Metric, sense: Sense) -> Result<Tangent, SolveError> {
    let rates = equations.solve(point, &negative(&point.gradient_rate));
    let motion = point.here.placement.velocity(&rates, &point.given_rates);
    let length = metric.length(&motion);
    if !(length.is_finite() && length > 0.0) {
        return Err(SolveError::NothingMoves { parameter: point.here.parameter, effort: Effort::default() });
    }
    let onwards = match sense {
        Sense::Parameter { grows } => grows,
        Sense::Along(heading) => metric.product(heading, &motion) >= 0.0,
    };
    let parameter = if onwards { 1.0 / length } else { -1.0 / length };
    Ok(Tangent {
        direction: Direction { motion: motion.into_iter().map(|rate| scaled(parameter, rate)).collect(), parameter },
        free: rates.iter().map(|rate| parameter * rate).collect(),
    })
}

fn motion(from: &[[f64; 3]], to: &[[f64; 3]]) -> Vec<[f64; 3]> {
    to.iter().zip(from).map(|(u, v)| sub(*u, *v)).collect()
}

fn along(from: &[f64], direction: &[f64], distance: f64) -> Vec<f64> {
    from.iter().zip(direction).map(|(q, d)| q + distance * d).collect()
}

fn negative(vector: &[f64]) -> Vec<f64> {
    vector.iter().map(|value| -value).collect()
}
