//! The spline space with its geometry: what knot insertion changes.

use crate::digest::{Feed, Hash};
use crate::spline::insert_knots_into_net;

/// Tensor-product NURBS mid-surface. Control points are ordered with the second direction (arc) fastest:
/// index = i₁ · n₂ + i₂.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Polynomial degree each way.
    pub degree: [usize; 2],
    /// Open knot vectors each way; nᵢ = knots.len() − degree − 1 control points.
    pub knots: [Vec<f64>; 2],
    /// Homogeneous control points (w x, w y, w z, w), mm; length n₁ · n₂.
    pub control_points: Vec<[f64; 4]>,
}

impl Mesh {
    /// Control points each way.
    pub fn control_counts(&self) -> [usize; 2] {
        [0, 1].map(|k| self.knots[k].len() - self.degree[k] - 1)
    }

    /// Non-empty knot spans (elements) each way.
    pub fn element_counts(&self) -> [usize; 2] {
        [0, 1].map(|k| self.knots[k].windows(2).filter(|pair| pair[0] < pair[1]).count())
    }

    /// The same surface with `new` knots (ascending, each way) inserted.
    pub fn with_knots(&self, new: &[Vec<f64>; 2]) -> Self {
        let mut finer = self.clone();
        for direction in 0..2 {
            let counts = finer.control_counts();
            let (knots, net) = insert_knots_into_net(
                &finer.knots[direction],
                finer.degree[direction],
                &finer.control_points,
                counts,
                direction,
                &new[direction],
            );
            finer.knots[direction] = knots;
            finer.control_points = net;
        }
        finer
    }

    /// Content hash; independent of how a log encodes the mesh.
    pub fn hash(&self) -> Hash {
        let mut feed = Feed::new("foldline mesh");
        for k in 0..2 {
            feed.integer(self.degree[k] as u64);
            feed.numbers(&self.knots[k]);
        }
        feed.integer(self.control_points.len() as u64);
        feed.each(self.control_points.as_flattened());
        feed.finish()
    }
}
