//! The mesh that refining ends with at the latest: every span halved as long as the length limit allows.

use crate::adapt::indicators::{length_limit, span_lengths};
use crate::energy::{Discretization, Shell};
use crate::model::{Member, members};
use crate::scene::{Adapt, Scene};
use crate::spline::{Elements, Mesh, Patch, Spans};

/// Parts of each span of each patch, along u and v, in the finest mesh that the length limit allows.
#[derive(Clone, Debug, PartialEq)]
pub struct Finest(Vec<[Vec<usize>; 2]>);

impl Finest {
    /// Finds how far the spans of the starting mesh may be halved.
    pub fn of(scene: &Scene, adapt: &Adapt, start: &Discretization) -> Self {
        let of_shell = |(member, shell): (Member, &Shell)| {
            let limits = length_limit(&member.scene, shell, adapt.length_limit);
            let lengths = span_lengths(shell);
            [0, 1].map(|axis| lengths[axis].iter().map(|length| parts(*length, limits[axis])).collect())
        };
        Self(members(scene, &start.mesh).into_iter().zip(&start.shells).map(of_shell).collect())
    }

    /// Elements each way of each patch.
    pub fn elements(&self) -> Elements {
        let counts = |parts: &[Vec<usize>; 2]| parts.each_ref().map(|parts| parts.iter().sum());
        self.0.iter().map(counts).collect()
    }

    /// The mesh itself.
    pub fn mesh(&self, start: &Mesh) -> Mesh {
        let cuts_of = |(patch, parts): (&Patch, &[Vec<usize>; 2])| {
            [0, 1].map(|axis| {
                let spans = Spans::of(&patch.knots[axis], patch.degree[axis]).bounds;
                let cuts = spans.into_iter().zip(&parts[axis]).flat_map(|([from, to], parts)| {
                    (1..*parts).map(move |k| from + (to - from) * k as f64 / *parts as f64)
                });
                cuts.collect()
            })
        };
        start.with_knots(&start.patches.iter().zip(&self.0).map(cuts_of).collect::<Vec<_>>())
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
        let finest = Finest(vec![[vec![4, 2], vec![1]]]);
        assert_eq!(finest.elements(), [6, 1]);
    }
}
