//! How long an estimate of the error holds.

use crate::adapt::judged_mesh::REFINED_FROM;
use crate::state::{Estimate, State};

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
