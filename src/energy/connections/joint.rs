//! The energies of a joint: its points along the edge, and how stiff it is there.

use super::coupled::{CoupledPoint, Coupling, SurfaceSide};
use super::kept_angle::KeptAngle;
use super::mean_gap::{GapPoint, MeanGaps};
use crate::energy::Term;
use crate::model::{EdgePair, Member, PairedEdge, SAME_KNOT, gauss_points, is_tied_smoothly};
use crate::scene::JointKind;
use crate::shell::{norm, shell_stiffness};
use crate::spline::greville_points;

/// The energies of a joint, each `None` where control points that are shared do all of it.
#[derive(Debug)]
pub(super) struct Joint {
    /// Keeps the edges together.
    gaps: Option<MeanGaps>,
    /// Keeps the angle.
    angle: Option<Coupling<KeptAngle>>,
    /// Where else the angle is looked at: at both ends; and close together, where its energy is summed up at few points.
    others: Vec<CoupledPoint<KeptAngle>>,
}

impl Joint {
    /// Finds the energies of a joint; `None` where it has none.
    pub fn of(pair: &EdgePair, members: &[Member]) -> Option<Self> {
        let keeps_angle = pair.joint.kind != JointKind::Hinge && !is_tied_smoothly(pair);
        if pair.conforms && !keeps_angle {
            return None;
        }
        let edge = Along { pair, stiffness: stiffness(pair, members) };
        let count = pair.edges.iter().map(|edge| edge.patch.degree[edge.running()]).max().unwrap_or(0) + 1;
        let points: Vec<[f64; 2]> = common_spans(pair).into_iter().flat_map(|span| gauss_points(span, count)).collect();
        let gaps = (!pair.conforms).then(|| {
            let points: Vec<GapPoint> = points.iter().map(|point| edge.gap(*point)).collect();
            MeanGaps::new(&points, fewer_functions(pair))
        });
        if !keeps_angle {
            return Some(Self { gaps, angle: None, others: Vec::new() });
        }
        let ends = [[0.0; 2], [1.0, 0.0]];
        let (at, others) = match pair.conforms {
            true => (points, ends.to_vec()),
            false => (few_points(pair), [points, ends.to_vec()].concat()),
        };
        let [at, others] = [at, others].map(|points| points.into_iter().map(|point| edge.angle(point)).collect());
        Some(Self { gaps, angle: Some(Coupling::new(at)), others })
    }

    /// Where the angle is looked at: close together, and at both ends.
    pub fn seen(&self) -> impl Iterator<Item = &CoupledPoint<KeptAngle>> {
        let own = self.angle.iter().filter(|_| self.gaps.is_none()).flat_map(|angle| &angle.points);
        own.chain(&self.others)
    }

    /// The terms of which it is the sum.
    pub fn parts(&self) -> impl Iterator<Item = &dyn Term> {
        let gaps = self.gaps.iter().map(|gaps| gaps as &dyn Term);
        gaps.chain(self.angle.iter().map(|angle| angle as &dyn Term))
    }
}

/// Points along the edge of a joint.
struct Along<'a> {
    pair: &'a EdgePair<'a>,
    /// Largest stiffness against stretching and against bending of the two shells, N/mm and N·mm.
    stiffness: [f64; 2],
}

impl Along<'_> {
    fn sides(&self, at: f64) -> [SurfaceSide; 2] {
        let [one, other] = &self.pair.edges;
        [(one, at), (other, self.pair.opposite(at))]
            .map(|(edge, at): (&PairedEdge, f64)| SurfaceSide::new(edge.patch, edge.first, edge.parameters(at)))
    }

    /// Length of the edge that a weight stands for, and mean length of the elements beside it, mm.
    fn lengths(&self, [at, weight]: [f64; 2], sides: &[SurfaceSide; 2]) -> [f64; 2] {
        let [one, other] = &self.pair.edges;
        let beside = 0.5 * (one.element_length(at) + other.element_length(self.pair.opposite(at)));
        [weight * norm(sides[0].undeformed[1 + one.running()]), beside]
    }

    fn angle(&self, point: [f64; 2]) -> CoupledPoint<KeptAngle> {
        let sides = self.sides(point[0]);
        let undeformed = [sides[0].undeformed, sides[1].undeformed];
        let [along, length] = self.lengths(point, &sides);
        let running = self.pair.edges[0].running();
        let law = KeptAngle {
            running,
            rotation: self.pair.joint.stiffness * self.stiffness[1] / length * along,
            angle: KeptAngle::angle_of(&undeformed, running),
        };
        CoupledPoint { sides, law }
    }

    fn gap(&self, point: [f64; 2]) -> GapPoint {
        let sides = self.sides(point[0]);
        let [along, length] = self.lengths(point, &sides);
        GapPoint { sides, length: along, stiffness: self.pair.joint.stiffness * self.stiffness[0] / length }
    }
}

/// Points of the first edge with the parts of it that are nearer to them than to others: as many as the edge with fewer functions has
/// functions, at its Greville abscissae, and the ends. As for gaps ([`super::mean_gap`]), more points would leave the slopes of both
/// sides only what both can have: a tape spring cut along its axis is then 3 % too stiff across its fold.
fn few_points(pair: &EdgePair) -> Vec<[f64; 2]> {
    let fewer = fewer_functions(pair);
    let edge = &pair.edges[fewer];
    let greville = greville_points(&edge.patch.knots[edge.running()], edge.patch.degree[edge.running()]);
    let ends = part_of_second(pair);
    let seen = greville.into_iter().filter_map(|at| match fewer {
        0 => Some(at),
        _ => (at > ends[0] && at < ends[1]).then(|| pair.back(at)),
    });
    let mut points: Vec<f64> = seen.chain([0.0, 1.0]).collect();
    points.sort_by(f64::total_cmp);
    points.dedup_by(|next, one| (*next - *one).abs() <= SAME_KNOT);
    let middle = |pair: &[f64]| 0.5 * (pair[0] + pair[1]);
    let bounds: Vec<f64> = [0.0].into_iter().chain(points.windows(2).map(middle)).chain([1.0]).collect();
    points.into_iter().zip(bounds.windows(2)).map(|(at, bounds)| [at, bounds[1] - bounds[0]]).collect()
}

/// The edge (0 or 1) that has fewer functions along the joint: as many as knots inside, each as often as it stands there, and one more
/// than the degree.
fn fewer_functions(pair: &EdgePair) -> usize {
    let [one, other] = &pair.edges;
    let ends = part_of_second(pair);
    let functions = |edge: &PairedEdge, [from, to]: [f64; 2]| {
        let knots = &edge.patch.knots[edge.running()];
        let inside = knots.iter().filter(|knot| **knot > from + SAME_KNOT && **knot < to - SAME_KNOT).count();
        inside + edge.patch.degree[edge.running()] + 1
    };
    usize::from(functions(other, [ends[0], ends[1]]) < functions(one, [0.0, 1.0]))
}

/// Parameters of the second edge between which the first one lies on it.
fn part_of_second(pair: &EdgePair) -> [f64; 2] {
    let mut ends = [0.0, 1.0].map(|end| pair.opposite(end));
    ends.sort_by(f64::total_cmp);
    ends
}

/// Largest stiffness against stretching and against bending of the two shells, N/mm and N·mm.
fn stiffness(pair: &EdgePair, members: &[Member]) -> [f64; 2] {
    let of_shell = |edge: &PairedEdge| {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let stiffness = shell_stiffness(&members[edge.at.shell].scene.material, axes);
        [stiffness.membrane, stiffness.bending].map(|matrix| matrix[0][0].max(matrix[1][1]))
    };
    let [one, other] = pair.edges.each_ref().map(of_shell);
    [0, 1].map(|k| one[k].max(other[k]))
}

/// The spans of the first edge, cut where the other one has knots as well.
fn common_spans(pair: &EdgePair) -> Vec<[f64; 2]> {
    let [one, other] = &pair.edges;
    let seen = other.spans().into_iter().flatten().map(|knot| pair.back(knot));
    let mut cuts: Vec<f64> = one.spans().into_iter().flatten().chain(seen).collect();
    cuts.sort_by(f64::total_cmp);
    cuts.dedup_by(|next, one| (*next - *one).abs() <= SAME_KNOT);
    cuts.windows(2).map(|pair| [pair[0], pair[1]]).collect()
}
