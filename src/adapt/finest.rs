//! The mesh that refining ends with at the latest: every span halved as long as the length limit allows.

use crate::adapt::indicators::{length_limit, span_lengths};
use crate::energy::Discretization;
use crate::scene::{Adapt, Scene};
use crate::spline::{Mesh, Spans};

/// Parts of each span of a mesh, along u and v, in the finest mesh that the length limit allows.
#[derive(Clone, Debug, PartialEq)]
pub struct Finest([Vec<usize>; 2]);

impl Finest {
    /// Finds how far the spans of the starting mesh may be halved.
    pub fn of(scene: &Scene, adapt: &Adapt, start: &Discretization) -> Self {
        let limits = length_limit(scene, start, adapt.length_limit);
        let lengths = span_lengths(start);
        Self([0, 1].map(|axis| lengths[axis].iter().map(|length| parts(*length, limits[axis])).collect()))
    }

    /// Elements each way.
    pub fn elements(&self) -> [usize; 2] {
        self.0.each_ref().map(|parts| parts.iter().sum())
    }

    /// The mesh itself.
    pub fn mesh(&self, start: &Mesh) -> Mesh {
        let new = [0, 1].map(|axis| {
            let spans = Spans::of(&start.knots[axis], start.degree[axis]).bounds;
            let cuts = spans.into_iter().zip(&self.0[axis]).flat_map(|([from, to], parts)| {
                (1..*parts).map(move |k| from + (to - from) * k as f64 / *parts as f64)
            });
            cuts.collect()
        });
        start.with_knots(&new)
    }
}

/// Parts of a span that is halved while its halves stay above the limit.
fn parts(length: f64, limit: f64) -> usize {
    let mut parts = 1_usize;
    while length / (2.0 * parts as f64) > limit && parts < MOST_PARTS {
        parts *= 2;
    }
    parts
}

/// Parts of a span at most: a mesh is refused long before.
const MOST_PARTS: usize = 1 << 20;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_are_halved_down_to_the_limit() {
        assert_eq!([parts(75.0, 1.0), parts(2.0, 1.0), parts(2.1, 1.0), parts(1.0, 0.0)], [64, 1, 2, MOST_PARTS]);
        let finest = Finest([vec![4, 2], vec![1]]);
        assert_eq!(finest.elements(), [6, 1]);
    }
}
