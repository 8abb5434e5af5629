//! The error that a mesh causes and what is to be done about it: knot spans are split so that it falls below what is asked, for as
//! few unknowns as that takes.

use crate::adapt::DirectionalError;
use crate::spline::{Patch, Spans};

/// Share of the tolerance from which on a mesh is refined. Estimates are of first order, and made now and then: where a fold grows
/// over spans much too long for it, an error of 0.9 % was estimated as 0.15 % (the quarter of L = 150 mm at 36°, with 0.3 here).
const REFINED_FROM: f64 = 0.2;
/// Share of the tolerance that refining aims at.
const REFINED_TO: f64 = 0.1;
/// Share of the tolerance that coarsening stays below.
const COARSENED_TO: f64 = 0.07;

/// Parts at most that a span is split in at once: the estimate is of the present mesh.
pub(super) const MOST_PARTS: usize = 4;

/// Share of an error that one round of refinement aims to leave, at least. Next to a jump the present shape is far from that on a
/// finer mesh (a fold on a coarse mesh is wider than it will be), and a round that trusted it would refine where nothing
/// bends in the end.
const LEFT_BY_A_ROUND: f64 = 0.125;

/// Share of the best gain from which another counts as the same: the two sides of a symmetric shell differ by rounding, and by what
/// the tolerance of the solver leaves.
const ALIKE: f64 = 0.98;

/// A span with its share of the error, split in so many parts.
#[derive(Clone, Copy, Debug)]
struct Split {
    direction: usize,
    span: usize,
    error: f64,
    parts: usize,
    /// Parts at most.
    most: usize,
}

/// The error that a mesh causes at an equilibrium, by direction and span.
#[derive(Clone, Copy, Debug)]
pub struct JudgedMesh<'a> {
    /// The mesh.
    pub mesh: &'a Patch,
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
        self.split_to(REFINED_TO * self.tolerance)
    }

    /// Relative error that taking knots out may add; 0 where there is no room for that.
    pub fn room(&self) -> f64 {
        (COARSENED_TO * self.tolerance - self.relative.iter().sum::<f64>()).max(0.0)
    }

    /// Knots to insert in each direction, so that the estimated relative error falls to `target` or by a round's share.
    ///
    /// A span of degree p in k parts has k^(−2(p−1)) of its error left (bending energy; Strang & Fix, *An Analysis of the
    /// Finite Element Method*, 1973), at the cost of k − 1 rows of control points. Part after part goes to the span that gains
    /// most per unknown, and to all that gain as much: a shell that bends alike on both sides of its middle is to be refined alike.
    /// As gains only fall, no other split of as many unknowns leaves less.
    fn split_to(&self, target: f64) -> [Vec<f64>; 2] {
        let target = target.max(LEFT_BY_A_ROUND * self.relative.iter().sum::<f64>());
        let mut splits = self.whole();
        while splits.iter().map(|split| self.left(split)).sum::<f64>() > target {
            let Some(best) = splits.iter().filter_map(|split| self.gain(split)).max_by(f64::total_cmp) else { break };
            let gains_alike = |split: &&mut Split| self.gain(split).is_some_and(|gain| gain >= ALIKE * best);
            splits.iter_mut().filter(gains_alike).for_each(|split| split.parts += 1);
        }
        [0, 1].map(|direction| {
            let bounds = Spans::of(&self.mesh.knots[direction], self.mesh.degree[direction]).bounds;
            let of_direction = splits.iter().filter(|split| split.direction == direction);
            of_direction.flat_map(|split| cuts(bounds[split.span], split.parts)).collect()
        })
    }

    /// All spans, not split yet.
    fn whole(&self) -> Vec<Split> {
        let of_direction = |direction: usize| {
            let shares = &self.errors[direction].shares;
            let sum: f64 = shares.iter().map(|share| share.abs()).sum();
            let split = move |(span, share): (usize, &f64)| {
                // Where supports hold every point, all spans are as likely.
                let part = if sum > 0.0 { share.abs() / sum } else { 1.0 / shares.len() as f64 };
                let error = self.relative[direction] * part;
                let fitting = (self.lengths[direction][span] / self.limit[direction]).min(MOST_PARTS as f64);
                Split { direction, span, error, parts: 1, most: fitting as usize }
            };
            shares.iter().enumerate().map(split)
        };
        of_direction(0).chain(of_direction(1)).collect()
    }

    /// Error that is left of a span in parts.
    fn left(&self, split: &Split) -> f64 {
        let order = 2 * (self.mesh.degree[split.direction] - 1);
        split.error * (split.parts as f64).powi(-(order as i32))
    }

    /// What one part more takes away per control point of the row that it adds; `None` where no part fits.
    fn gain(&self, split: &Split) -> Option<f64> {
        let more = Split { parts: split.parts + 1, ..*split };
        let row = self.mesh.control_counts()[1 - split.direction] as f64;
        (more.parts <= split.most).then(|| (self.left(split) - self.left(&more)) / row)
    }
}

/// Knots that cut a span in so many equal parts.
pub(super) fn cuts([from, to]: [f64; 2], parts: usize) -> impl Iterator<Item = f64> {
    // Of two parts exactly the middle of the span, to the bit.
    (1..parts).map(move |cut| (from * (parts - cut) as f64 + to * cut as f64) / parts as f64)
}
