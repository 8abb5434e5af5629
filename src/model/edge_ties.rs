//! Edges that conform, tied: both have the same displacements, and where the joint is smooth the same slopes.
//!
//! Across a smooth joint lines of control points go on in the other patch. Where each middle point lies on the straight line
//! between its neighbours on both sides, in one ratio all along, the displacement of the middle one is tied to theirs
//! alike ([`super::joint`]), which is a slope that is continuous in every motion. Other smooth joints keep their angle by an energy.
//!
//! Where the surfaces of two shells of one material are continuous in further derivatives, so are the displacements of both: a shell
//! that is cut in two at a knot has the functions of the whole one. The k-th derivative of A = Σ N w u at an end of a
//! clamped knot vector is a sum over k + 1 control points, whose factors follow from those of derivatives of splines (Piegl &
//! Tiller, equation 3.8).

use crate::model::edge::side;
use crate::model::edge_pair::{EdgePair, PairedEdge};
use crate::model::elimination::Expression;
use crate::model::joint::shares_across;
use crate::model::member::Member;
use crate::model::supports::Supports;
use crate::scene::{Hold, JointKind, Support};

/// Difference of derivatives of surfaces that are continuous, relative to their size.
const CONTINUOUS: f64 = 1e-9;

/// Whether linear ties make a joint smooth.
pub(crate) fn is_tied_smoothly(pair: &EdgePair) -> bool {
    pair.joint.kind == JointKind::Smooth && pair.conforms && Lines::of(pair).shares().is_some()
}

/// Control points of the structure with their homogeneous coordinates.
type Line = Vec<(usize, [f64; 4])>;

/// Lines of control points across a joint, on either side from the edge inwards.
struct Lines<'a> {
    pair: &'a EdgePair<'a>,
    /// Lines in the order of the first edge.
    sides: [Vec<Line>; 2],
}

impl<'a> Lines<'a> {
    fn of(pair: &'a EdgePair<'a>) -> Self {
        let lines = |edge: &PairedEdge, reversed: bool| {
            let (direction, at_end) = side(edge.at.edge);
            let grid = edge.patch.grid();
            let count = grid.counts[direction];
            let depth = (edge.patch.degree[direction] + 1).min(count);
            let line = |along: usize| {
                let point = |k: usize| {
                    let own = grid.index_along(direction, if at_end { count - 1 - k } else { k }, along);
                    (edge.first + own, edge.patch.control_points[own])
                };
                (0..depth).map(point).collect::<Vec<_>>()
            };
            let mut lines: Vec<_> = (0..grid.counts[1 - direction]).map(line).collect();
            if reversed {
                lines.reverse();
            }
            lines
        };
        let reversed = pair.matching == Some(true);
        Self { pair, sides: [lines(&pair.edges[0], false), lines(&pair.edges[1], reversed)] }
    }

    /// Knots across an edge, from the edge inwards and increasing from 0.
    fn knots(&self, k: usize) -> Vec<f64> {
        let edge = &self.pair.edges[k];
        let (direction, at_end) = side(edge.at.edge);
        let knots = &edge.patch.knots[direction];
        match at_end {
            false => knots.iter().map(|knot| knot - knots[0]).collect(),
            true => knots.iter().rev().map(|knot| knots[knots.len() - 1] - knot).collect(),
        }
    }

    fn degree(&self, k: usize) -> usize {
        let edge = &self.pair.edges[k];
        edge.patch.degree[side(edge.at.edge).0]
    }

    /// Shares of the neighbours on both sides in every middle point; `None` where lines do not go on.
    fn shares(&self) -> Option<[f64; 2]> {
        let spans = [0, 1].map(|k| {
            let (knots, degree) = (self.knots(k), self.degree(k));
            (knots[degree + 1] - knots[degree]) / degree as f64
        });
        let lines: Vec<[[f64; 4]; 3]> =
            self.sides[0].iter().zip(&self.sides[1]).map(|(one, other)| [one[1].1, one[0].1, other[1].1]).collect();
        shares_across(&lines, spans)
    }

    /// Whether a derivative of the surfaces is continuous where the parameters run at speeds of this ratio.
    fn is_continuous(&self, order: usize, ratio: f64) -> bool {
        let factors = [0, 1].map(|k| derivative_at_start(&self.knots(k), self.degree(k), order));
        self.sides[0].iter().zip(&self.sides[1]).all(|(one, other)| {
            let sum = |line: &[(usize, [f64; 4])], factors: &[f64], c: usize| -> (f64, f64) {
                let terms = line.iter().zip(factors).map(|((_, point), factor)| factor * point[c]);
                terms.fold((0.0, 0.0), |(sum, size), term| (sum + term, size + term.abs()))
            };
            // Inwards on one side is outwards on the other.
            let sign = if order.is_multiple_of(2) { 1.0 } else { -1.0 };
            let scale = sign * ratio.powi(order as i32);
            let compared = |c: usize| {
                let ((a, size), (b, other_size)) = (sum(one, &factors[0], c), sum(other, &factors[1], c));
                ((a - scale * b).abs(), size + scale.abs() * other_size)
            };
            // A coordinate alone may be no more than rounding: in the plane y = 0 all of y is.
            let places = [0, 1, 2].map(compared);
            let size = places.iter().fold(0.0_f64, |most, (_, size)| most.max(*size));
            let (difference, weights) = compared(3);
            places.iter().all(|(difference, _)| *difference <= CONTINUOUS * size) && difference <= CONTINUOUS * weights
        })
    }
}

/// Factors of the first control points in a derivative of a spline at the start of its knots, which are clamped.
fn derivative_at_start(knots: &[f64], degree: usize, order: usize) -> Vec<f64> {
    // Rows of differences: those of derivative k as sums over control points.
    let mut rows: Vec<Vec<f64>> =
        (0..=order).map(|i| (0..=order).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    for k in 1..=order {
        let p = degree + 1 - k;
        rows = (0..=order - k)
            .map(|i| {
                let factor = p as f64 / (knots[i + degree + 1] - knots[i + k]);
                rows[i].iter().zip(&rows[i + 1]).map(|(a, b)| factor * (b - a)).collect()
            })
            .collect();
    }
    rows.swap_remove(0)
}

impl Supports {
    /// Ties the control points of edges that conform.
    pub(super) fn tie_edges(&mut self, pairs: &[EdgePair], members: &[Member], all: &[Support]) {
        for pair in pairs.iter().filter(|pair| pair.conforms) {
            let lines = Lines::of(pair);
            for (one, other) in lines.sides[0].iter().zip(&lines.sides[1]) {
                for c in 0..3 {
                    self.push(None, vec![(3 * one[0].0 + c, 1.0), (3 * other[0].0 + c, -1.0)]);
                }
            }
            if pair.joint.kind == JointKind::Smooth
                && let Some(shares) = lines.shares()
            {
                self.tie_slopes(&lines, shares);
                self.tie_derivatives(&lines, members, all);
            }
        }
    }

    fn tie_slopes(&mut self, lines: &Lines, shares: [f64; 2]) {
        let total = shares[0] + shares[1];
        for (one, other) in lines.sides[0].iter().zip(&lines.sides[1]) {
            for c in 0..3 {
                let component = |point: usize| 3 * point + c;
                self.push(
                    None,
                    vec![
                        (component(one[0].0), 1.0),
                        (component(one[1].0), -shares[0] / total),
                        (component(other[1].0), -shares[1] / total),
                    ],
                );
            }
        }
    }

    /// Ties further derivatives where those of the surfaces are continuous. Lines beside an edge that a section holds are left out:
    /// its normals are tied already.
    fn tie_derivatives(&mut self, lines: &Lines, members: &[Member], all: &[Support]) {
        let [one, other] = lines.pair.edges.each_ref().map(|edge| &members[edge.at.shell].scene.material);
        let degree = lines.degree(0);
        if one != other || degree != lines.degree(1) {
            return;
        }
        let Some(ratio) = speed_ratio(lines) else { return };
        let held = held_ends(lines.pair, all);
        let count = lines.sides[0].len();
        for order in 2..degree {
            let deep_enough = (0..2).all(|k| lines.sides[k].iter().all(|line| line.len() > order));
            if !deep_enough || !(1..=order).all(|order| lines.is_continuous(order, ratio)) {
                return;
            }
            let factors = [0, 1].map(|k| derivative_at_start(&lines.knots(k), degree, order));
            let scale = if order.is_multiple_of(2) { 1.0 } else { -1.0 } * ratio.powi(order as i32);
            let size = factors[0].iter().fold(0.0_f64, |most, factor| most.max(factor.abs()));
            for index in (0..count).filter(|index| !((held[0] && *index < 2) || (held[1] && index + 2 >= count))) {
                for c in 0..3 {
                    let terms = |k: usize, share: f64| {
                        let line = &lines.sides[k][index];
                        let of_point = move |((point, weighted), factor): (&(usize, [f64; 4]), &f64)| {
                            (3 * point + c, share * factor * weighted[3] / size)
                        };
                        line.iter().zip(&factors[k]).map(of_point).collect::<Expression>()
                    };
                    self.push(None, [terms(0, 1.0), terms(1, -scale)].concat());
                }
            }
        }
    }
}

/// Ratio of the speeds of the parameters across a joint, second to first, by the first derivatives of the surfaces.
fn speed_ratio(lines: &Lines) -> Option<f64> {
    let factors = [0, 1].map(|k| derivative_at_start(&lines.knots(k), lines.degree(k), 1));
    let slope = |k: usize| {
        let line = &lines.sides[k][0];
        let along = |c: usize| (0..2).map(|j| factors[k][j] * line[j].1[c]).sum::<f64>();
        (0..3).map(|c| along(c).powi(2)).sum::<f64>().sqrt()
    };
    let (one, other) = (slope(0), slope(1));
    (other > 0.0).then(|| one / other)
}

/// Whether a section that turns the shells' normals holds them at the first and at the last line across a joint.
fn held_ends(pair: &EdgePair, all: &[Support]) -> [bool; 2] {
    let mut held = [false; 2];
    for (k, edge) in pair.edges.iter().enumerate() {
        let reversed = k == 1 && pair.matching == Some(true);
        let sections = all.iter().filter(|support| matches!(support.hold, Hold::Rigid { normals_turn: true, .. }));
        for on in sections.flat_map(Support::edges).filter(|on| on.shell == edge.at.shell) {
            let (direction, at_end) = side(on.edge);
            if direction == edge.running() {
                held[usize::from(at_end != reversed)] = true;
            }
        }
    }
    held
}
