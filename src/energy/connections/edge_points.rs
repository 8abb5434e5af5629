//! Points along a joint, and how stiff it is there.

use super::coupled::{CoupledPoint, SurfaceSide};
use super::kept_angle::KeptAngle;
use crate::model::{EdgePair, Member, PairedEdge, SAME_KNOT, gauss_points, is_tied_smoothly};
use crate::scene::JointKind;
use crate::shell::{norm, shell_stiffness};

/// Finds the points of a joint; none where control points that are shared do all of it.
pub(super) fn edge_points(pair: &EdgePair, members: &[Member]) -> Vec<CoupledPoint<KeptAngle>> {
    let keeps_angle = pair.joint.kind != JointKind::Hinge && !is_tied_smoothly(pair);
    if pair.conforms && !keeps_angle {
        return Vec::new();
    }
    let [one, other] = &pair.edges;
    let [membrane, bending] = stiffness(pair, members);
    let count = one.patch.degree[one.running()].max(other.patch.degree[other.running()]) + 1;
    let spans = common_spans(pair);
    let points = spans.into_iter().flat_map(|span| gauss_points(span, count));
    let point = |[at, weight]: [f64; 2]| {
        let beside = pair.opposite(at);
        let sides = [(one, at), (other, beside)]
            .map(|(edge, at): (&PairedEdge, f64)| SurfaceSide::new(edge.patch, edge.first, edge.parameters(at)));
        let undeformed = [sides[0].undeformed, sides[1].undeformed];
        let length = 0.5 * (one.element_length(at) + other.element_length(beside));
        let along = weight * norm(undeformed[0][1 + one.running()]);
        let share = |stiffness: f64| pair.joint.stiffness * stiffness / length * along;
        let law = KeptAngle {
            running: one.running(),
            rotation: if keeps_angle { share(bending) } else { 0.0 },
            displacement: if pair.conforms { 0.0 } else { share(membrane) },
            angle: KeptAngle::angle_of(&undeformed, one.running()),
        };
        CoupledPoint { sides, law }
    };
    points.map(point).collect()
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
