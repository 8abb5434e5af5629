//! How long an estimate of the error holds.

use crate::state::{Estimate, State};

/// Load steps for which an estimate holds at most.
const LONGEST: f64 = 12.0;
/// Load steps in which an error grows by a factor e at most, where a fold grows over spans that are too long for it: on the quarters
/// of R = 15 mm, t = 0.06 mm and of R = 20 mm five- and sixfold in eight steps of 0.4°.
const GROWTH: f64 = 4.0;
/// Share of the tolerance that the error may have grown to when it is estimated again.
const GROWN_TO: f64 = 0.7;
/// Factor by which the largest indicator of a direction may change while an estimate holds: close to a limit point the shape changes
/// within a few steps. With 2 the whole baseline snaps at 10.4° and R = 6 mm at 42.8°, with 1.15 at 10.0° and 40.8° (in truth at
/// 9.91° and 39.86°).
const FACTOR: f64 = 1.15;

/// Indicators below this share of the larger one are not compared.
const NOISE: f64 = 1e-6;

/// Whether an estimate made on the same mesh still holds for a state whose largest indicators are these.
pub fn still_holds(estimate: &Estimate, state: &State, indicators: [f64; 2], tolerance: f64) -> bool {
    // A direction that does not bend has indicators of rounding.
    let noise = NOISE * indicators.into_iter().fold(0.0, f64::max);
    let is_near = |(now, then): (f64, f64)| now <= FACTOR * then.max(noise) && then <= FACTOR * now.max(noise);
    let steps = (GROWTH * (GROWN_TO * tolerance / estimate.relative_error).ln()).clamp(1.0, LONGEST);
    state.step < estimate.step + steps as u64 && indicators.into_iter().zip(estimate.largest_indicator).all(is_near)
}
