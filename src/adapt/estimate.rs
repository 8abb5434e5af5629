//! When an estimate of the error is made, what it says of a mesh, and what is to be done about it.

use crate::adapt::DirectionalError;
use crate::adapt::splitting::ToSplit;
use crate::spline::Mesh;
use crate::state::{Estimate, State};

/// Share of the tolerance from which on a mesh is refined. Estimates are of first order, and made now and then: a fold that grows
/// over spans of a length that just serves is off by up to three times what is estimated before and behind them.
const REFINED_FROM: f64 = 0.3;
/// Share of the tolerance that refining aims at.
const REFINED_TO: f64 = 0.15;
/// Share of the tolerance that coarsening stays below.
const COARSENED_TO: f64 = 0.1;

/// Load steps for which an estimate holds at most.
const LONGEST: u64 = 8;
/// Factors by which the largest indicator of a direction may change while an estimate holds: between these, and the square root
/// of what the error may still grow by.
const FACTORS: [f64; 2] = [1.1, 2.0];

/// Indicators below this share of the larger one are not compared.
const NOISE: f64 = 1e-6;

/// Whether an estimate made on the same mesh still holds for a state whose largest indicators are these.
pub fn still_holds(estimate: &Estimate, state: &State, indicators: [f64; 2], tolerance: f64) -> bool {
    let room = (REFINED_FROM * tolerance / estimate.relative_error).sqrt().clamp(FACTORS[0], FACTORS[1]);
    // A direction that does not bend has indicators of rounding.
    let noise = NOISE * indicators.into_iter().fold(0.0, f64::max);
    let is_near = |(now, then): (f64, f64)| now <= room * then.max(noise) && then <= room * now.max(noise);
    state.step < estimate.step + LONGEST && indicators.into_iter().zip(estimate.largest_indicator).all(is_near)
}

/// The error that a mesh causes at an equilibrium, by direction and span.
#[derive(Clone, Copy, Debug)]
pub struct JudgedMesh<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// What halving the spans of either direction would change.
    pub errors: &'a [DirectionalError; 2],
    /// Relative error of the measured quantity by direction.
    pub relative: [f64; 2],
    /// Length of every span of either direction, mm.
    pub lengths: &'a [Vec<f64>; 2],
    /// Length that no span is split below, mm.
    pub limit: [f64; 2],
    /// Relative error that the mesh may cause.
    pub tolerance: f64,
}

impl JudgedMesh<'_> {
    /// Knots to insert in each direction; empty where the error is small enough.
    ///
    /// The shares by which spans are chosen are of the energy. A probe far from a point load is so refined for at the load.
    pub fn marked(&self) -> [Vec<f64>; 2] {
        if self.relative.iter().sum::<f64>() <= REFINED_FROM * self.tolerance {
            return Default::default();
        }
        let Self { mesh, errors, relative, lengths, limit, .. } = *self;
        ToSplit { mesh, errors, relative, lengths, limit }.knots(REFINED_TO * self.tolerance)
    }

    /// Relative error that taking knots out may add; 0 where there is no room for that.
    pub fn room(&self) -> f64 {
        (COARSENED_TO * self.tolerance - self.relative.iter().sum::<f64>()).max(0.0)
    }
}
