//! Edges that lie on each other though nothing connects them.

use crate::model::edge::rows_of;
use crate::model::edge_pair::{MEETING, PairedEdge};
use crate::model::member::Member;
use crate::scene::{Edge, Scene, ShellEdge, Support};

/// Parameters along an edge at which it is seen whether it lies on another.
const SEEN: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Finds the edges that lie on an edge of another shell, each with that one, where no joint, bond or section connects the two.
pub fn unjoined_edges(scene: &Scene, members: &[Member]) -> Vec<[ShellEdge; 2]> {
    let all: Vec<PairedEdge> = (0..members.len())
        .flat_map(|shell| Edge::ALL.map(|edge| PairedEdge::new(ShellEdge { shell, edge }, members)))
        .collect();
    let boxes: Vec<[[f64; 3]; 2]> = all.iter().map(box_of).collect();
    let mut found = Vec::new();
    for (i, one) in all.iter().enumerate() {
        for (j, other) in all.iter().enumerate().skip(i + 1).filter(|(_, other)| other.at.shell != one.at.shell) {
            let thickness = |edge: &PairedEdge| members[edge.at.shell].scene.material.thickness_mm();
            let tolerance = MEETING * thickness(one).min(thickness(other));
            let lies = || lies_on(one, other, tolerance) || lies_on(other, one, tolerance);
            if do_overlap(&boxes[i], &boxes[j], tolerance) && !are_connected(scene, one.at, other.at) && lies() {
                found.push([one.at, other.at]);
            }
        }
    }
    found
}

fn are_connected(scene: &Scene, one: ShellEdge, other: ShellEdge) -> bool {
    // Through other edges on the same line as well.
    let mut joined = vec![one];
    while let Some(next) = scene.joints.iter().find_map(|joint| {
        let [a, b] = joint.edges.map(|edge| joined.contains(&edge));
        (a != b).then(|| joint.edges[usize::from(a)])
    }) {
        joined.push(next);
    }
    let glued = scene.bonds.iter().any(|bond| bond.shells.contains(&one.shell) && bond.shells.contains(&other.shell));
    let held = |edge: ShellEdge| move |support: &Support| support.edges().any(|of| of == edge);
    joined.contains(&other) || glued || scene.supports.iter().any(|support| held(one)(support) && held(other)(support))
}

fn lies_on(one: &PairedEdge, other: &PairedEdge, tolerance: f64) -> bool {
    SEEN.iter().all(|at| other.nearest(one.point(*at).position).1 <= tolerance)
}

/// The box of the control points of an edge, in which it lies.
fn box_of(edge: &PairedEdge) -> [[f64; 3]; 2] {
    let mut ends = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for point in rows_of(edge.patch, edge.at.edge)[0].iter().map(|index| edge.patch.point(*index)) {
        for c in 0..3 {
            ends[0][c] = ends[0][c].min(point[c]);
            ends[1][c] = ends[1][c].max(point[c]);
        }
    }
    ends
}

fn do_overlap(one: &[[f64; 3]; 2], other: &[[f64; 3]; 2], tolerance: f64) -> bool {
    (0..3).all(|c| one[0][c] <= other[1][c] + tolerance && other[0][c] <= one[1][c] + tolerance)
}
