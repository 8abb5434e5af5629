//! The edges that a joint joins: where each lies on the other, and whether both have the same control points.
//!
//! Edges *match* where they are one curve at the same parameter, forwards or backwards, in the same degree. Matching edges with the
//! same knots *conform*: their functions are the same, so that displacements agree everywhere where those of the control points
//! do. Knots of matching edges are passed on from one to the other ([`pass_on`]), so that edges that conform once do so for
//! ever.

use crate::model::ModelError;
use crate::model::edge::{centroid_and_length, edge_parameters, on_edge, rows_of, side};
use crate::model::member::{Member, members};
use crate::scene::{Joint, JointKind, Scene, ShellEdge};
use crate::shell::{cross, dot, norm, scaled, sub, unit_normal};
use crate::spline::{KnotLists, Mesh, Patch, Spans, SurfacePoint};
use crate::units::place;

/// Distance of edges that meet, relative to the smaller thickness.
pub(super) const MEETING: f64 = 1e-2;
/// Angle between surfaces, in degrees, up to which a joint may be smooth: imperfections and coarse curves make less.
const SMOOTH_DEG: f64 = 5.0;
/// Distance of points that are one, and difference of weights, relative to the length of an edge.
const SAME: f64 = 1e-9;
/// Difference of knots that are one.
pub(crate) const SAME_KNOT: f64 = 1e-9;
/// Points of each span at which edges are compared.
const SAMPLES: usize = 4;
/// Samples of each span from which the nearest point of an edge is searched.
const STARTS: usize = 8;
/// Largest number of Newton steps to the nearest point.
const NEWTON_STEPS: usize = 40;

/// One of the edges of a joint.
#[derive(Clone, Copy, Debug)]
pub struct PairedEdge<'a> {
    /// The edge.
    pub at: ShellEdge,
    /// Its patch.
    pub patch: &'a Patch,
    /// Number of the first control point of the patch.
    pub first: usize,
}

impl<'a> PairedEdge<'a> {
    pub(super) fn new(at: ShellEdge, members: &'a [Member<'a>]) -> Self {
        let member = &members[at.shell];
        Self { at, patch: member.patch, first: member.points.start }
    }

    /// Direction along the edge.
    pub fn running(&self) -> usize {
        1 - side(self.at.edge).0
    }

    /// Evaluates the undeformed surface at a parameter along the edge.
    pub fn point(&self, parameter: f64) -> SurfacePoint {
        on_edge(self.patch, self.at.edge, parameter)
    }

    /// Parameters (u, v) at a parameter along the edge.
    pub fn parameters(&self, parameter: f64) -> [f64; 2] {
        edge_parameters(self.at.edge, parameter)
    }

    /// Length of the element beside the edge at a parameter, across it, mm.
    pub fn element_length(&self, parameter: f64) -> f64 {
        let (direction, at_end) = side(self.at.edge);
        let spans = Spans::of(&self.patch.knots[direction], self.patch.degree[direction]).bounds;
        let span = if at_end { spans.last() } else { spans.first() };
        let across = self.point(parameter).derivatives[direction];
        let along = self.point(parameter).derivatives[1 - direction];
        // Across the edge at right angles, however the lines of the surface lie.
        let square = sub(across, scaled(dot(across, along) / dot(along, along), along));
        span.map_or(0.0, |[from, to]| (to - from) * norm(square))
    }

    /// Bounds of the knot spans along the edge.
    pub fn spans(&self) -> Vec<[f64; 2]> {
        let running = self.running();
        Spans::of(&self.patch.knots[running], self.patch.degree[running]).bounds
    }

    /// Length of the edge, mm.
    pub fn length(&self) -> f64 {
        centroid_and_length(self.patch, self.at.edge).1
    }

    /// Finds the parameter of the point of the edge that is nearest to a point, and its distance, mm.
    pub fn nearest(&self, point: [f64; 3]) -> (f64, f64) {
        let running = self.running();
        let away = |at: f64| norm(sub(self.point(at).position, point));
        let starts = self
            .spans()
            .into_iter()
            .flat_map(|[from, to]| (0..=STARTS).map(move |k| from + (to - from) * k as f64 / STARTS as f64));
        let mut best = starts
            .map(|at| (at, away(at)))
            .fold((0.0, f64::INFINITY), |best, one| if one.1 < best.1 { one } else { best });
        let mut at = best.0;
        for _ in 0..NEWTON_STEPS {
            let surface = self.point(at);
            let (tangent, second) = (surface.derivatives[running], surface.derivatives[2 + running]);
            let gap = sub(surface.position, point);
            let slope = dot(tangent, tangent) + dot(gap, second);
            let step = dot(gap, tangent) / if slope > 0.0 { slope } else { dot(tangent, tangent) };
            at = (at - step).clamp(0.0, 1.0);
            if step.abs() < 1e-15 {
                break;
            }
        }
        let found = (at, away(at));
        if found.1 <= best.1 {
            best = found;
        }
        best
    }
}

/// The two edges of a joint; the first is the shorter one, which lies on the other.
#[derive(Clone, Debug)]
pub struct EdgePair<'a> {
    /// The joint.
    pub joint: &'a Joint,
    /// The edges.
    pub edges: [PairedEdge<'a>; 2],
    /// Where the edges match: whether the second runs backwards.
    pub matching: Option<bool>,
    /// Whether they conform.
    pub conforms: bool,
}

impl EdgePair<'_> {
    /// Finds the parameter of the second edge where the first one has a parameter.
    pub fn opposite(&self, parameter: f64) -> f64 {
        match self.matching {
            Some(reversed) => turned(parameter, reversed),
            None => self.edges[1].nearest(self.edges[0].point(parameter).position).0,
        }
    }

    /// Finds the parameter of the first edge where the second one has a parameter.
    pub fn back(&self, parameter: f64) -> f64 {
        match self.matching {
            Some(reversed) => turned(parameter, reversed),
            None => self.edges[0].nearest(self.edges[1].point(parameter).position).0,
        }
    }
}

/// The parameter of an edge that may run backwards.
fn turned(parameter: f64, reversed: bool) -> f64 {
    if reversed { 1.0 - parameter } else { parameter }
}

/// Finds the edges of the joints of a scene.
///
/// # Errors
/// Where edges do not meet.
pub fn edge_pairs<'a>(scene: &'a Scene, members: &'a [Member<'a>]) -> Result<Vec<EdgePair<'a>>, ModelError> {
    scene.joints.iter().map(|joint| edge_pair(joint, members)).collect()
}

fn edge_pair<'a>(joint: &'a Joint, members: &'a [Member<'a>]) -> Result<EdgePair<'a>, ModelError> {
    let mut edges = joint.edges.map(|edge| PairedEdge::new(edge, members));
    let lengths = edges.map(|edge| edge.length());
    if lengths[1] < lengths[0] * (1.0 - SAME) {
        edges.reverse();
    }
    let thickness = |edge: &PairedEdge| members[edge.at.shell].scene.material.thickness_mm();
    let tolerance = MEETING * thickness(&edges[0]).min(thickness(&edges[1]));
    check_meeting(joint, &edges, tolerance)?;
    let matching = [false, true].into_iter().find(|reversed| do_match(&edges, *reversed, SAME * lengths[0]));
    let conforms = matching.is_some_and(|reversed| do_conform(&edges, reversed, SAME * lengths[0]));
    Ok(EdgePair { joint, edges, matching, conforms })
}

/// Parameters along an edge at which it is compared with another one: the ends, and points of every span.
fn samples(edge: &PairedEdge) -> Vec<f64> {
    let running = edge.running();
    Spans::of(&edge.patch.knots[running], edge.patch.degree[running]).samples(SAMPLES)
}

/// Refuses edges that do not meet, and a smooth joint of surfaces that meet at an angle.
fn check_meeting(joint: &Joint, edges: &[PairedEdge; 2], tolerance: f64) -> Result<(), ModelError> {
    let (mut worst, mut angle_deg) = ((0.0, [0.0; 3]), 0.0_f64);
    for at in samples(&edges[0]) {
        let here = edges[0].point(at);
        let (beside, distance) = edges[1].nearest(here.position);
        if distance > worst.0 {
            worst = (distance, here.position);
        }
        if joint.kind == JointKind::Smooth {
            let [one, other] = [&here, &edges[1].point(beside)]
                .map(|SurfacePoint { derivatives: [a1, a2, ..], .. }| unit_normal([*a1, *a2]));
            angle_deg = angle_deg.max(norm(cross(one, other)).min(1.0).asin().to_degrees());
        }
    }
    let (distance, at) = worst;
    if distance > tolerance {
        return Err(ModelError::EdgesApart { joint: joint.name.clone(), distance, at: place(at), most: tolerance });
    }
    match angle_deg > SMOOTH_DEG {
        true => Err(ModelError::NotSmooth { joint: joint.name.clone(), angle_deg }),
        false => Ok(()),
    }
}

/// Whether two edges of one degree are one curve at the same parameter.
fn do_match([one, other]: &[PairedEdge; 2], reversed: bool, tolerance: f64) -> bool {
    let degree = |edge: &PairedEdge| edge.patch.degree[edge.running()];
    let is_near = |at: f64| norm(sub(one.point(at).position, other.point(turned(at, reversed)).position)) <= tolerance;
    degree(one) == degree(other)
        && samples(one).into_iter().chain(samples(other).into_iter().map(|at| turned(at, reversed))).all(is_near)
}

/// Whether two edges that match have the same control points.
fn do_conform([one, other]: &[PairedEdge; 2], reversed: bool, tolerance: f64) -> bool {
    let (of_one, of_other) = (&one.patch.knots[one.running()], &other.patch.knots[other.running()]);
    let mapped = mapped(of_other, reversed);
    let same_knots =
        of_one.len() == mapped.len() && of_one.iter().zip(&mapped).all(|(a, b)| (a - b).abs() <= SAME_KNOT);
    let row = |edge: &PairedEdge, reversed: bool| {
        let mut row = rows_of(edge.patch, edge.at.edge)[0].clone();
        if reversed {
            row.reverse();
        }
        row.into_iter().map(|point| edge.patch.control_points[point]).collect::<Vec<[f64; 4]>>()
    };
    let (a, b) = (row(one, false), row(other, reversed));
    let ratio = a[0][3] / b[0][3];
    let is_same = |(a, b): (&[f64; 4], &[f64; 4])| {
        let point = |p: &[f64; 4]| [p[0] / p[3], p[1] / p[3], p[2] / p[3]];
        norm(sub(point(a), point(b))) <= tolerance && (a[3] / b[3] / ratio - 1.0).abs() <= SAME
    };
    same_knots && a.len() == b.len() && a.iter().zip(&b).all(is_same)
}

/// Knots as an edge that may run backwards has them.
fn mapped(knots: &[f64], reversed: bool) -> Vec<f64> {
    let mut mapped: Vec<f64> = knots.iter().map(|knot| turned(*knot, reversed)).collect();
    if reversed {
        mapped.reverse();
    }
    mapped
}

/// Knots of a list that another one lacks, each as often as it lacks them.
fn lacking(knots: &[f64], list: &[f64]) -> Vec<f64> {
    let mut rest = knots.to_vec();
    let is_lacking = |knot: &&f64| match rest.iter().position(|other| (*other - **knot).abs() <= SAME_KNOT) {
        Some(at) => {
            rest.swap_remove(at);
            false
        }
        None => true,
    };
    list.iter().filter(is_lacking).copied().collect()
}

/// Passes knots on along matching edges of a mesh to which `new` knots are to be added, to the patches on the other side of every
/// joint where one edge has all knots of the other; returns all knots to add.
///
/// # Errors
/// Where edges do not meet.
pub fn pass_on(scene: &Scene, mesh: &Mesh, new: KnotLists) -> Result<KnotLists, ModelError> {
    if scene.joints.is_empty() {
        return Ok(new);
    }
    let members = members(scene, mesh);
    let pairs = edge_pairs(scene, &members)?;
    let mut new = new;
    loop {
        let mut changed = false;
        for EdgePair { edges: [one, other], matching, conforms, .. } in &pairs {
            let Some(reversed) = *matching else { continue };
            let with_new = |edge: &PairedEdge, new: &KnotLists| {
                let running = edge.running();
                let mut knots = edge.patch.knots[running].clone();
                knots.extend(&new[edge.at.shell][running]);
                knots.sort_by(f64::total_cmp);
                knots
            };
            let (of_one, of_other) = (with_new(one, &new), mapped(&with_new(other, &new), reversed));
            let (to_one, to_other) = (lacking(&of_one, &of_other), lacking(&of_other, &of_one));
            // Edges that never had knots in common stay as they are.
            if !conforms && !to_one.is_empty() && !to_other.is_empty() {
                continue;
            }
            let to_other: Vec<f64> = to_other.into_iter().map(|knot| turned(knot, reversed)).collect();
            for (edge, knots) in [(one, to_one), (other, to_other)] {
                changed |= !knots.is_empty();
                let list = &mut new[edge.at.shell][edge.running()];
                list.extend(knots);
                list.sort_by(f64::total_cmp);
            }
        }
        if !changed {
            return Ok(new);
        }
    }
}
