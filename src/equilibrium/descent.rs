//! Newton's method as a descent on the strain energy.
//!
//! Backtracking on the energy (Nocedal & Wright, *Numerical Optimization*, 2nd ed., algorithm 3.1). Where the stiffness
//! is not positive definite, the negative pivots of its L D Lᵀ factor are replaced by their magnitudes: that matrix
//! differs from K by one of the rank of its negative part, costs no second factorization, and gives a descent direction
//! that reverses Newton's where the curvature is negative (section 3.4 there, modified factorizations). At least every
//! second iterate does not raise the merit, up to rounding.
//!
//! With loads, what descends is the strain energy less the work of the loads along the steps taken
//! ([`crate::energy::Terms::strokes`]), so that it needs no potential. Where loads that turn with the shell have a skew
//! tangent, the direction solves the whole system (GMRES on the factor of the symmetric part).
//!
//! A full Newton step that does not lower the energy is taken all the same for one more step (a watchdog, section 15.6
//! there): in a thin shell the valley of low energy is curved, a straight step leaves it at the cost of membrane
//! energy, and the next step returns to it. Backtracking at once follows the valley in many small steps: the snap of
//! the baseline's quarter model took 64 iterations that way and 31 with one step of patience; two and four steps of
//! patience took 33 and 37.
//!
//! Continuing with the factor of the point where the load step began (modified Newton, Shamanskii 1967) does not pay,
//! though a residual and a solve cost a sixth of an iteration: after the tangent predictor such a step brings the
//! residual of the baseline from 0.24 to 0.03 of the reactions and the next one back to 0.06, since the shell has
//! turned and what was bending is stretching. `baseline-quarter.toml` took 879 factorizations that way, and 753
//! without.
//!
//! Nor with corrections accelerated by Anderson mixing in the metric of the factor (five before), though a residual and a solve cost a
//! twentieth of an iteration on degrees [3, 5]. With the factor of the load step's start they diverge once the ends have turned by some 4°:
//! of 170 solves of the whole baseline 12 came to their end. With the factor of the predicted point, behind a first full step, 176 of 311
//! did, and 518 factorizations were taken for 636, in 14 % less time: on a fold one full step from the parabola is within the
//! tolerance already, and the factor of the equilibrium is wanted all the same, for its stability and the next tangent.
//!
//! Nor do steps bent to second order, x + d − ½ K⁻¹ Π‴[d, d] (Chebyshev's method; Transtrum & Sethna 2012, arXiv:1201.5885), with
//! Π‴[d, d] from one residual at half the step: factorizations of the baseline 587 to 494, of R = 15 mm 772 to 642, of the slit
//! annulus 469 to 414, but of folds that travel (equal sense, adaptive) 3213 to 3299, and some 7 % of the baseline's time. From
//! residuals on both sides it is more exact, and leaves shells pressed that a straight step leaves stretched: on the way they
//! seem unstable, and the annulus takes 2215.
//!
//! Nor did membrane forces in the stiffness that are linear in the last step (mixed integration points, Magisano, Leonetti &
//! Garcea 2017, here C (ε − ½ d,α·d,β) for a step d) save any: with them the same scene took 455 iterations for 344, and
//! its snap 35 to 72 factorizations for 25 to 37, as the stiffness away from equilibrium was more often indefinite.

use crate::energy::{Discretization, Want};
use crate::equilibrium::assembly::Assembled;
use crate::equilibrium::configuration::{Configuration, Coordinates};
use crate::equilibrium::force_scale::ForceScale;
use crate::equilibrium::iterate::{Effort, Iterate};
use crate::equilibrium::ledger::SolveStart;
use crate::equilibrium::solve_error::SolveError;
use crate::equilibrium::solved::Ended;
use crate::equilibrium::tangent_stiffness::TangentStiffness;
use crate::equilibrium::vector::product;
use crate::equilibrium::workspace::Workspace;

/// Share of the predicted decrease that a step must achieve (Nocedal & Wright, section 3.1).
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Energies that differ by less than this, relatively, are equal: rounding in sums over some 10⁵ points.
const ENERGY_ROUNDING: f64 = 1e-12;
/// A step that does not pay is cut to between these shares of its length. Cuts to less than 0.3 made the baseline's snap
/// longer: over three rules of quadrature on the quarter model, and the whole one, it takes 29, 25, 25 and 27 factorizations
/// with 0.3, and 37, 25, 30 and 27 with 0.1.
const SHORTEST_CUT: f64 = 0.3;
const LONGEST_CUT: f64 = 0.5;
/// Largest number of trials of a shorter step before the line search gives up.
const MAX_BACKTRACKS: usize = 30;
/// Largest number of doublings of a step along negative curvature.
const MAX_DOUBLINGS: usize = 6;

/// A descent in progress: residual and stiffness are assembled at the current point.
pub(super) struct Descent<'a> {
    here: Coordinates<'a>,
    discretization: &'a Discretization,
    assembled: &'a mut Assembled,
    tangent: &'a mut TangentStiffness,
    /// Strokes of the actions since the state that the solve started from, N·mm.
    strokes: Vec<f64>,
    /// Largest force met before, N.
    largest_force: f64,
    gradient: Vec<f64>,
    step_length: f64,
    /// Start of a step that has not lowered the energy yet.
    watched: Option<Start>,
    pub(super) effort: Effort,
}

/// A point with a descent direction.
struct Start {
    free: Vec<f64>,
    displacement: Vec<[f64; 3]>,
    /// Strokes of the actions so far, N·mm.
    strokes: Vec<f64>,
    work: f64,
    direction: Vec<f64>,
    /// Derivative of the energy along the direction; negative.
    slope: f64,
    iterate: Iterate,
}

impl Start {
    fn moved(&self, length: f64) -> Vec<f64> {
        self.free.iter().zip(&self.direction).map(|(q, d)| q + length * d).collect()
    }

    /// Computes the strain energy less the work of the loads.
    fn merit(&self) -> f64 {
        self.iterate.energy - self.work
    }

    /// Whether a step of this length decreases the merit sufficiently.
    fn is_enough(&self, length: f64, merit: f64) -> bool {
        let rounding = ENERGY_ROUNDING * (self.iterate.energy.abs() + self.work.abs());
        merit <= self.merit() + SUFFICIENT_DECREASE * length * self.slope + rounding
    }
}

impl<'a> Descent<'a> {
    /// Begins a descent at some unknowns, on the way from a state.
    pub(super) fn new(workspace: &'a mut Workspace, from: Configuration, parameter: f64, free: Vec<f64>) -> Self {
        let Workspace { discretization, tangent, assembled, .. } = workspace;
        let discretization = &*discretization;
        let here = Coordinates::at(&discretization.unknowns, free, parameter);
        assembled.assemble(discretization, &here.displacement, parameter, Want::Stiffness);
        Self {
            strokes: discretization.terms.strokes(&discretization.mesh, from.displacement, &here.displacement),
            here,
            largest_force: from.largest_force,
            discretization,
            assembled,
            tangent,
            gradient: Vec::new(),
            step_length: 0.0,
            watched: None,
            effort: Effort::default(),
        }
    }

    /// Restarts the descent from other unknowns, on the way from a state; the effort so far stays counted.
    pub(super) fn start_at(&mut self, from: Configuration, free: Vec<f64>) {
        self.go_to(free);
        let Discretization { mesh, terms, .. } = self.discretization;
        self.strokes = terms.strokes(mesh, from.displacement, &self.here.displacement);
    }

    /// Moves to other unknowns and assembles everything there.
    fn go_to(&mut self, free: Vec<f64>) {
        self.here = Coordinates::at(&self.discretization.unknowns, free, self.here.parameter);
        let Coordinates { displacement, parameter, .. } = &self.here;
        self.assembled.assemble(self.discretization, displacement, *parameter, Want::Stiffness);
    }

    /// Factors the stiffness at the current point and returns its iterate.
    pub(super) fn iterate(&mut self) -> Result<Iterate, SolveError> {
        let assembled = &*self.assembled;
        let forces = assembled.forces();
        self.gradient = self.here.placement.restrict(&forces);
        let scale = ForceScale::at(self.discretization, assembled, &self.here.displacement, self.largest_force);
        let of_unknowns = &self.discretization.unknowns;
        let last = Iterate::at(of_unknowns, assembled.energy, scale, &self.gradient, self.effort);
        let mut last = SolveError::unless_finite(last, self.effort)?;
        last.step_length = self.step_length;
        self.effort.factorizations += 1;
        let factored = self.tangent.factorize(self.discretization, &self.here.placement, assembled);
        let negative = factored.map_err(|cause| SolveError::Factor { cause, effort: self.effort })?;
        last.negative_pivots = negative.count;
        last.shift = 2.0 * negative.largest;
        Ok(last)
    }

    /// Energy of the model that has left the balance so far, N·mm.
    pub(super) fn released_since(&self, before: &SolveStart) -> f64 {
        before.released(self.discretization, self.here.parameter, &self.strokes, self.assembled.energy)
    }

    /// Takes a step from the point of `last`.
    pub(super) fn step(&mut self, last: &Iterate) -> Result<(), SolveError> {
        let indefinite = last.negative_pivots > 0;
        if indefinite {
            self.tangent.solver.make_positive();
        }
        let direction = self.direction(indefinite);
        let slope = product(&self.gradient, &direction);
        let here = Start {
            free: self.here.free.clone(),
            displacement: self.here.displacement.clone(),
            strokes: self.strokes.clone(),
            work: self.discretization.terms.work(&self.strokes, self.here.parameter),
            direction,
            slope,
            iterate: *last,
        };
        self.effort.iterations += 1;

        if indefinite {
            let Some(length) = self.along_negative_curvature(&here) else {
                return match self.watched.take() {
                    Some(from) => self.shorten(from),
                    None => Err(SolveError::LineSearchFailed { last: *last, effort: self.effort }),
                };
            };
            let energy = self.settle(&here, length);
            return self.judge(here, length, energy);
        }
        let energy = self.settle(&here, 1.0);
        self.judge(here, 1.0, energy)
    }

    /// Computes Newton's direction, or the modified one.
    fn direction(&mut self, indefinite: bool) -> Vec<f64> {
        let mut direction: Vec<f64> = self.gradient.iter().map(|g| -g).collect();
        if self.assembled.has_skew() && !indefinite {
            let Self { tangent, here, assembled, discretization, .. } = self;
            let solved = tangent.solve_whole(discretization, &here.placement, assembled, &direction);
            if product(&self.gradient, &solved) < 0.0 {
                return solved;
            }
        }
        self.tangent.solver.solve(&mut direction);
        direction
    }

    /// Keeps a step that lowered the energy, watches one that did not, and returns to the start of a watched step that
    /// did not pay.
    fn judge(&mut self, here: Start, length: f64, energy: f64) -> Result<(), SolveError> {
        match self.watched.take() {
            Some(from) if !from.is_enough(1.0, energy) => self.shorten(from),
            Some(_) => Ok(()),
            None if here.is_enough(length, energy) => Ok(()),
            None if energy.is_finite() => {
                self.watched = Some(here);
                Ok(())
            }
            None => self.shorten(here),
        }
    }

    /// Ends the descent; returns where it ended and its effort.
    pub(super) fn finish(self) -> Ended {
        let forces = self.assembled.forces();
        Ended {
            reactions: self.here.placement.reactions(&forces),
            turns: self.here.placement.turns(),
            displacement: self.here.displacement,
            strokes: self.strokes,
            effort: self.effort,
        }
    }

    /// Returns to where a step started and takes the first shorter one that pays.
    fn shorten(&mut self, from: Start) -> Result<(), SolveError> {
        let energy = self.energy_at(&from, 1.0);
        match self.backtrack(&from, 1.0, energy) {
            Some(length) => {
                self.settle(&from, length);
                Ok(())
            }
            None => Err(SolveError::LineSearchFailed { last: from.iterate, effort: self.effort }),
        }
    }

    /// Doubles the step while that pays: along negative curvature the quadratic model does not give its length.
    fn along_negative_curvature(&self, here: &Start) -> Option<f64> {
        let mut best = (1.0, self.energy_at(here, 1.0));
        if !here.is_enough(best.0, best.1) {
            return self.backtrack(here, best.0, best.1);
        }
        for _ in 0..MAX_DOUBLINGS {
            let longer = 2.0 * best.0;
            let energy = self.energy_at(here, longer);
            if energy >= best.1 || energy.is_nan() {
                break;
            }
            best = (longer, energy);
        }
        Some(best.0)
    }

    /// Finds a shorter step that pays, by the minimum of the parabola through energy, slope and the failed trial.
    fn backtrack(&self, from: &Start, mut length: f64, mut energy: f64) -> Option<f64> {
        for _ in 0..MAX_BACKTRACKS {
            let curvature = energy - from.merit() - length * from.slope;
            let minimum = -0.5 * from.slope * length * length / curvature;
            length = if minimum.is_finite() {
                minimum.clamp(SHORTEST_CUT * length, LONGEST_CUT * length)
            } else {
                SHORTEST_CUT * length
            };
            energy = self.energy_at(from, length);
            if from.is_enough(length, energy) {
                return Some(length);
            }
        }
        None
    }

    /// Computes the strain energy less the work of the loads.
    fn energy_at(&self, from: &Start, length: f64) -> f64 {
        let Discretization { unknowns, terms, .. } = self.discretization;
        let parameter = self.here.parameter;
        let displacement = &unknowns.configure(&from.moved(length), parameter).displacement();
        let energy = self.discretization.energy(displacement, parameter);
        energy - terms.work(&self.strokes_to(from, displacement), parameter)
    }

    /// Computes the strokes up to a displacement, straight from where a step started.
    fn strokes_to(&self, from: &Start, displacement: &[[f64; 3]]) -> Vec<f64> {
        let Discretization { mesh, terms, .. } = self.discretization;
        let last = terms.strokes(mesh, &from.displacement, displacement);
        from.strokes.iter().zip(last).map(|(before, stroke)| before + stroke).collect()
    }

    /// Moves to a point and assembles everything there; returns the strain energy less the work of the loads.
    fn settle(&mut self, from: &Start, length: f64) -> f64 {
        self.go_to(from.moved(length));
        self.step_length = length;
        self.strokes = self.strokes_to(from, &self.here.displacement);
        self.assembled.energy - self.discretization.terms.work(&self.strokes, self.here.parameter)
    }
}
