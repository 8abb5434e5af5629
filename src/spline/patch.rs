//! A spline space with its geometry: what knot insertion changes.

use crate::digest::{Feed, Hash};
use crate::spline::{Grid, control_count, insert_knots_into_net};

/// Tensor-product NURBS mid-surface; its control points are numbered as a [`Grid`], the second direction (arc) fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Polynomial degree in each direction.
    pub degree: [usize; 2],
    /// Open knot vector of each direction; nᵢ = knots.len() − degree − 1 control points.
    pub knots: [Vec<f64>; 2],
    /// Homogeneous control points (w x, w y, w z, w), mm; length n₁ · n₂.
    pub control_points: Vec<[f64; 4]>,
}

impl Patch {
    /// Number of control points in each direction.
    pub fn control_counts(&self) -> [usize; 2] {
        [0, 1].map(|direction| control_count(&self.knots[direction], self.degree[direction]))
    }

    /// Grid that numbers the control points.
    pub fn grid(&self) -> Grid {
        Grid::new(self.control_counts())
    }

    /// Position of a control point, mm.
    pub fn point(&self, index: usize) -> [f64; 3] {
        cartesian(self.control_points[index])
    }

    /// Positions of all control points, mm.
    pub fn points(&self) -> impl Iterator<Item = [f64; 3]> {
        self.control_points.iter().copied().map(cartesian)
    }

    /// Control points of an element, in the order of its functions, where `first` are the indices of the first of them.
    pub fn window(&self, first: [usize; 2]) -> impl Iterator<Item = usize> + use<> {
        self.grid().window(first, self.degree.map(|p| p + 1))
    }

    /// Number of non-empty knot spans (elements) in each direction.
    pub fn element_counts(&self) -> [usize; 2] {
        [0, 1].map(|direction| self.knots[direction].windows(2).filter(|pair| pair[0] < pair[1]).count())
    }

    /// Integrals of the B-splines (without the weights) of all control points over the parameter domain, relative to its
    /// area: they sum to 1. ∫N_i dξ = (ξ_{i+p+1} − ξ_i)/(p + 1): de Boor, *A Practical Guide to Splines*, chapter X.
    pub fn basis_integrals(&self) -> Vec<f64> {
        let integrals = [0, 1].map(|direction| {
            let (knots, degree) = (&self.knots[direction], self.degree[direction]);
            let total = knots[knots.len() - 1] - knots[0];
            let integral = |i: usize| (knots[i + degree + 1] - knots[i]) / ((degree + 1) as f64 * total);
            (0..control_count(knots, degree)).map(integral).collect::<Vec<f64>>()
        });
        integrals[0].iter().flat_map(|along| integrals[1].iter().map(move |across| along * across)).collect()
    }

    /// Returns the same surface with the knots `new` of each direction (ascending) inserted.
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

    /// Content hash of the patch; independent of how a log encodes it.
    pub fn hash(&self) -> Hash {
        let mut feed = Feed::new("foldline mesh");
        for direction in 0..2 {
            feed.integer(self.degree[direction] as u64);
            feed.numbers(&self.knots[direction]);
        }
        feed.integer(self.control_points.len() as u64);
        feed.each(self.control_points.as_flattened());
        feed.finish()
    }
}

/// Cartesian coordinates, mm, of the point with homogeneous coordinates (w x, w y, w z, w).
pub fn cartesian([x, y, z, w]: [f64; 4]) -> [f64; 3] {
    [x / w, y / w, z / w]
}
