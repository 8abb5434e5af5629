//! Where the energy of a layer is summed up in one direction of a patch: at the Greville points of its functions.
//!
//! A stiff layer holds u − u′ + ½ t (a₃ + a₃′) at each of its points. As many Gauss points as the degree, in each of the elements, are
//! far more conditions than smooth splines have freedoms, one an element and direction: what they leave is too stiff. A TRAC boom of
//! 30 × 9 cubic elements buckled at 1179, 1019, 930 and 881 N mm with layers of 50, 5, 0.5 and 0.05 E/t, where the layer itself makes
//! 0.1 %. At the Greville points of one shell, interpolation gives its every motion from that of the other: no freedom of the other is
//! lost, and none is left loose (in the manner of Zou, Hughes, Scott, Sauer & Savitha 2021, *Galerkin formulations of isogeometric
//! shell analysis: alleviating locking with Greville quadratures and higher-order element technology*). Their weights
//! integrate every spline of the space, so that a soft layer converges as before.

use std::iter::repeat_n;

use nalgebra::DVector;

use crate::model::SAME_KNOT;
use crate::spline::{collocation, greville_points};

/// Smallest weight, relative to the integral of the function of its point. On meshes that are graded with care none is below 0.2; where
/// elements of quite other sizes meet, weights may be negative.
const LEAST: f64 = 0.1;

/// A stretch of a direction within which functions are smooth, and a layer begins or ends nowhere.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Open knot vector of the functions on it.
    pub knots: Vec<f64>,
    pub degree: usize,
    /// Their Greville points.
    pub points: Vec<f64>,
    pub weights: Vec<f64>,
}

impl Piece {
    fn between(knots: &[f64], degree: usize, [from, to]: [f64; 2]) -> Self {
        let within = knots.iter().copied().filter(|knot| *knot > from + SAME_KNOT && *knot < to - SAME_KNOT);
        let knots: Vec<f64> = repeat_n(from, degree + 1).chain(within).chain(repeat_n(to, degree + 1)).collect();
        let mut points = greville_points(&knots, degree);
        let integrals: Vec<f64> =
            knots.windows(degree + 2).map(|of| (of[degree + 1] - of[0]) / (degree + 1) as f64).collect();
        let values = collocation(&knots, degree, &points);
        let exact = values.transpose().lu().solve(&DVector::from_column_slice(&integrals));
        // The integrals themselves integrate what is linear.
        let weights = match exact {
            Some(exact) if exact.iter().zip(&integrals).all(|(weight, integral)| *weight >= LEAST * integral) => {
                exact.iter().copied().collect()
            }
            _ => integrals,
        };
        // The end belongs to this piece, with the tangents that it has there.
        if let Some(last) = points.last_mut().filter(|_| to < 1.0) {
            *last = to.next_down();
        }
        Self { knots, degree, points, weights }
    }

    /// The point next to one, off the nearer end: its own number away from the ends.
    pub fn inwards(&self, index: usize) -> usize {
        index.clamp(1, self.points.len() - 2)
    }

    /// Where it begins and ends.
    pub fn ends(&self) -> [f64; 2] {
        [self.knots[0], self.knots[self.knots.len() - 1]]
    }
}

/// Parameters at which the functions of a knot vector are only continuous, both ends among them.
pub(super) fn kinks(knots: &[f64], degree: usize) -> Vec<f64> {
    let mut all: Vec<f64> =
        knots.windows(degree).filter(|equal| equal[0] == equal[degree - 1]).map(|equal| equal[0]).collect();
    all.dedup();
    all
}

/// Divides a direction at its kinks, and at other parameters.
pub(super) fn pieces(knots: &[f64], degree: usize, others: impl IntoIterator<Item = f64>) -> Vec<Piece> {
    let mut ends = kinks(knots, degree);
    for other in others {
        if ends.iter().all(|end| (end - other).abs() > SAME_KNOT) {
            ends.push(other);
        }
    }
    ends.sort_by(f64::total_cmp);
    ends.windows(2).map(|ends| Piece::between(knots, degree, [ends[0], ends[1]])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Piece by piece, every power up to the degree is integrated, and the weights are positive on halved meshes.
    #[test]
    fn the_points_of_a_direction_integrate_its_splines() {
        for degree in 2..=5 {
            let ends = |at: f64| repeat_n(at, degree + 1);
            let inner =
                [0.125, 0.25, 0.3125, 0.34375, 0.375, 0.5].into_iter().chain(repeat_n(0.625, degree)).chain([0.75]);
            let knots: Vec<f64> = ends(0.0).chain(inner).chain(ends(1.0)).collect();
            let pieces = pieces(&knots, degree, [0.9, 0.625]);
            let found: Vec<[f64; 2]> = pieces.iter().map(Piece::ends).collect();
            assert_eq!(found, [[0.0, 0.625], [0.625, 0.9], [0.9, 1.0]]);
            for piece in &pieces {
                let (Piece { points, weights, .. }, [from, to]) = (piece, piece.ends());
                assert!(weights.iter().all(|weight| *weight > 0.0), "{degree}: {weights:?}");
                for power in 0..=degree as i32 {
                    let sum: f64 = points.iter().zip(weights).map(|(x, w)| w * x.powi(power)).sum();
                    let exact = (to.powi(power + 1) - from.powi(power + 1)) / f64::from(power + 1);
                    assert!((sum - exact).abs() < 1e-13, "{degree} {power}: {sum} {exact}");
                }
            }
        }
    }

    /// Elements of quite other sizes beside each other: no weight is negative, and what is linear is still integrated.
    #[test]
    fn no_weight_is_negative_on_wild_knots() {
        let knots = [0.0, 0.0, 0.0, 0.0, 0.001, 0.5, 0.5005, 0.9, 0.901, 1.0, 1.0, 1.0, 1.0];
        let [Piece { points, weights, .. }] = &pieces(&knots, 3, [])[..] else { panic!("one piece") };
        assert!(weights.iter().all(|weight| *weight > 0.0), "{weights:?}");
        let moment: f64 = points.iter().zip(weights).map(|(x, w)| w * x).sum();
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-14 && (moment - 0.5).abs() < 1e-14);
    }
}
