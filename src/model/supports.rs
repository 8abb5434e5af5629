//! What a scene's supports ask of the control points of a mesh: rigid sections, linear constraints, given displacements.
//!
//! All constraints are between components of control points in their frames (see [`super::Unknowns`]). Holding an edge
//! needs only its own row of control points; its slope (a clamp, a plane of symmetry) also needs the row beside it.

use crate::model::ModelError;
use crate::model::edge::{EdgeRows, edge_rows};
use crate::model::elimination::Expression;
use crate::model::expressions::control_expressions;
use crate::model::joint::{Joint, joints, seam};
use crate::model::mirror::Mirror;
use crate::model::rigid_support::HeldMotions;
use crate::model::soundness::closed_directions;
use crate::scene::{
    Edge, Geometry, History, Hold, Load, Motion, NurbsPatch, ParametricDirection, Place, Scene, Seam, Sense, Support,
};
use crate::shell::{dot, norm, sub};
use crate::spline::Mesh;

/// Components of a plane's normal below which a motion along an axis lies in the plane.
const KEPT: f64 = 1e-9;
/// Motions of a rigid section, as they stand in a scene.
const MOTIONS: [&str; 6] = ["x_mm", "y_mm", "z_mm", "rotation_x_deg", "rotation_y_deg", "rotation_z_deg"];

/// A given motion as a function of the scene's parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// At factor 1, mm.
    at_one: f64,
    history: History,
}

impl Law {
    /// At a parameter, mm.
    pub fn at(&self, parameter: f64) -> f64 {
        self.at_one * self.history.at(parameter)
    }

    /// Derivative with respect to the parameter, mm.
    pub fn rate(&self, parameter: f64) -> f64 {
        self.at_one * self.history.rate(parameter)
    }
}

/// A rigid section that moves.
#[derive(Clone, Debug)]
pub struct Section {
    /// The point that its translation is that of, undeformed, mm.
    pub centre: [f64; 3],
    /// Largest distance of its control points from there, mm.
    pub size: f64,
    /// Laws of translations and rotation vector (times the size), mm; `None` where free.
    pub motions: [Option<Law>; 6],
    /// Control points of the edge.
    pub rigid_row: Vec<usize>,
}

/// A support on the mesh, for its reactions.
#[derive(Clone, Debug)]
pub struct Trace {
    /// Name of the support.
    pub name: String,
    /// Control points that it holds.
    pub points: Vec<usize>,
    /// Of a plane of symmetry, the control points of its edge; empty for other supports.
    pub mirrored: Vec<usize>,
    /// Whether it is a plane of symmetry through a line inside the shell.
    pub is_inner_mirror: bool,
    /// The point that moments are about, undeformed, mm.
    pub pole: [f64; 3],
    /// The section that the pole moves with.
    pub section: Option<usize>,
}

/// What the supports of a scene ask of a mesh.
#[derive(Clone, Debug)]
pub struct Supports {
    /// Rigid sections that move.
    pub sections: Vec<Section>,
    /// The section that each control point belongs to.
    pub section_of: Vec<Option<usize>>,
    /// Expressions in components (3 · control point + c, or 3 · control points + k for given displacement k) that are
    /// zero.
    pub constraints: Vec<Expression>,
    /// Laws of the given displacements.
    pub displacements: Vec<Law>,
    /// Where the supports act, in the order of the scene.
    pub traces: Vec<Trace>,
    /// For each constraint, the support that it comes from; `None` for a joint.
    pub(super) owner: Vec<Option<usize>>,
    /// What a support that holds rigid motions alone holds.
    pub(super) held_motions: Option<HeldMotions>,
}

impl Supports {
    /// Supports of a scene on a mesh.
    ///
    /// # Errors
    /// Where one does not fit the surface, or two contradict each other.
    pub fn new(scene: &Scene, mesh: &Mesh) -> Result<Self, ModelError> {
        let count = mesh.control_points.len();
        let mut supports = Self {
            sections: Vec::new(),
            section_of: vec![None; count],
            constraints: Vec::new(),
            displacements: Vec::new(),
            traces: Vec::new(),
            owner: Vec::new(),
            held_motions: None,
        };
        let all = supports_of(scene);
        let ties = Ties::new(scene, mesh, &all)?;
        let points: Vec<[f64; 3]> = mesh.points().collect();
        // Sections first: what else holds their control points must know their frames.
        for (index, support) in all.iter().enumerate() {
            supports.traces.push(Trace {
                name: support.name.clone(),
                points: vec![],
                mirrored: vec![],
                is_inner_mirror: false,
                pole: [0.0; 3],
                section: None,
            });
            if let (Hold::Rigid { .. }, Place::Edge(edge)) = (&support.hold, support.on) {
                supports.hold_rigidly(index, support, &ties.rows(mesh, edge)?, &points)?;
            }
        }
        let mut mirrors = Mirror::all(scene, &all, mesh)?.into_iter();
        for (index, support) in all.iter().enumerate() {
            match (&support.hold, support.on) {
                (Hold::Rigid { .. } | Hold::RigidMotions, _) => {}
                (Hold::Symmetric, on) => {
                    let Some(mirror) = mirrors.next() else { continue };
                    match on {
                        Place::Edge(edge) => supports.mirror(index, &edge_rows(mesh, edge)?, &mirror)?,
                        _ => supports.mirror_line(index, mesh, &mirror)?,
                    }
                }
                (Hold::Displacement { displacement_mm }, on) => {
                    let places = control_expressions(scene, mesh, on)?;
                    supports.displace(index, support, *displacement_mm, &places, &points)?;
                }
            }
        }
        supports.tie(&ties, mesh);
        // What the others leave free is known last.
        for (index, _) in all.iter().enumerate().filter(|(_, support)| support.hold == Hold::RigidMotions) {
            supports.hold_rigid_motions(index, scene, mesh, &points)?;
        }
        supports.check_frames()?;
        Ok(supports)
    }

    /// The error for a constraint that contradicts those before it.
    pub fn contradiction(&self, constraint: usize) -> ModelError {
        let support = self.owner[constraint].map_or("the joints", |index| self.traces[index].name.as_str()).to_owned();
        let points: Vec<usize> = self.constraints[constraint].iter().map(|(component, _)| component / 3).collect();
        // On one mesh those beside share a few control points with it; the one in the way shares most.
        let shared = |trace: &Trace| points.iter().filter(|point| trace.points.contains(point)).count();
        let others = self.traces.iter().filter(|trace| trace.name != support && shared(trace) > 0);
        let other = others.rev().max_by_key(|trace| shared(trace));
        ModelError::Contradiction { support, other: other.map(|trace| trace.name.clone()) }
    }

    pub(super) fn push(&mut self, owner: Option<usize>, expression: Expression) {
        self.constraints.push(expression);
        self.owner.push(owner);
    }

    /// A clamped edge, or a rigid section with motions of its own.
    fn hold_rigidly(
        &mut self,
        index: usize,
        support: &Support,
        rows: &EdgeRows,
        points: &[[f64; 3]],
    ) -> Result<(), ModelError> {
        let Hold::Rigid { motions, reference_mm, normals_turn } = &support.hold else { return Ok(()) };
        let centre = reference_mm.unwrap_or(rows.centroid);
        let mut held = rows.outer.clone();
        if *normals_turn {
            held.extend(&rows.inner);
        }
        let moves = motions.iter().any(|motion| *motion != Motion::Given(0.0));
        if moves {
            let size = held.iter().map(|point| norm(sub(points[*point], centre))).fold(0.0, f64::max);
            let law = |(k, motion): (usize, &Motion)| match motion {
                Motion::Free(_) => None,
                Motion::Given(value) => {
                    let at_one = if k < 3 { *value } else { value.to_radians() * size };
                    Some(Law { at_one, history: support.history.clone() })
                }
            };
            let laws: Vec<Option<Law>> = motions.iter().enumerate().map(law).collect();
            let section = self.sections.len();
            self.sections.push(Section {
                centre,
                size,
                motions: [0, 1, 2, 3, 4, 5].map(|k| laws[k].clone()),
                rigid_row: rows.outer.clone(),
            });
            for point in &held {
                if let Some(other) = self.section_of[*point].replace(section) {
                    let first = self.traces.iter().find(|trace| trace.section == Some(other));
                    return Err(ModelError::SectionShared {
                        support: support.name.clone(),
                        other: first.map_or_else(String::new, |trace| trace.name.clone()),
                    });
                }
            }
            self.traces[index].section = Some(section);
        }
        for point in &rows.outer {
            (0..3).for_each(|c| self.push(Some(index), vec![(3 * point + c, 1.0)]));
        }
        if *normals_turn {
            for (point, normal) in rows.inner.iter().zip(&rows.normals) {
                self.push(Some(index), along(*point, *normal));
            }
        }
        self.traces[index].points = held;
        self.traces[index].pole = centre;
        Ok(())
    }

    /// A plane of symmetry: no displacement across it, and slopes that go on evenly behind it.
    fn mirror(&mut self, index: usize, rows: &EdgeRows, mirror: &Mirror) -> Result<(), ModelError> {
        let normal = mirror.normal;
        self.check_sections_keep(&rows.outer, mirror)?;
        let [first, second] = in_plane(normal);
        for (outer, inner) in rows.outer.iter().zip(&rows.inner) {
            self.push(Some(index), along(*outer, normal));
            for direction in [first, second] {
                let mut expression = along(*outer, direction);
                expression.extend(along(*inner, direction).into_iter().map(|(component, factor)| (component, -factor)));
                self.push(Some(index), expression);
            }
        }
        self.traces[index].points = rows.outer.iter().chain(&rows.inner).copied().collect();
        self.traces[index].pole = rows.centroid;
        self.traces[index].mirrored = rows.outer.clone();
        Ok(())
    }

    /// Refuses a plane of symmetry that a section could leave.
    pub(super) fn check_sections_keep(&self, points: &[usize], mirror: &Mirror) -> Result<(), ModelError> {
        for section in points.iter().filter_map(|point| self.section_of[*point]) {
            let motions = self.sections[section].motions_out_of_plane(mirror.normal);
            if !motions.is_empty() {
                let held = self.traces.iter().find(|trace| trace.section == Some(section));
                return Err(ModelError::SectionLeavesPlane {
                    section: held.map_or_else(String::new, |trace| trace.name.clone()),
                    support: mirror.support.clone(),
                    motions,
                });
            }
        }
        Ok(())
    }

    /// Given components of a displacement, for each of some weighted sums of control points.
    fn displace(
        &mut self,
        index: usize,
        support: &Support,
        displacement: [Option<f64>; 3],
        places: &[Vec<(usize, f64)>],
        points: &[[f64; 3]],
    ) -> Result<(), ModelError> {
        let held: Vec<usize> = places.iter().flatten().map(|(point, _)| *point).collect();
        if let Some(section) = held.iter().find_map(|point| self.section_of[*point]) {
            return Err(self.overlap(index, section));
        }
        for (c, value) in displacement.into_iter().enumerate() {
            let Some(value) = value else { continue };
            let given = (value != 0.0).then(|| {
                self.displacements.push(Law { at_one: value, history: support.history.clone() });
                3 * points.len() + self.displacements.len() - 1
            });
            for place in places {
                let mut expression: Expression = place.iter().map(|(point, factor)| (3 * point + c, *factor)).collect();
                // Weights of a place sum to 1, so that all control points of an edge move by the value.
                expression.extend(given.map(|component| (component, -1.0)));
                self.push(Some(index), expression);
            }
        }
        let weight: f64 = places.len() as f64;
        let mut pole = [0.0; 3];
        for (point, factor) in places.iter().flatten() {
            (0..3).for_each(|c| pole[c] += factor * points[*point][c] / weight);
        }
        self.traces[index].points = held;
        self.traces[index].pole = pole;
        Ok(())
    }

    fn overlap(&self, index: usize, section: usize) -> ModelError {
        let other = self.traces.iter().find(|trace| trace.section == Some(section));
        ModelError::SectionShared {
            support: self.traces[index].name.clone(),
            other: other.map_or_else(String::new, |trace| trace.name.clone()),
        }
    }

    /// Constraints are between components of one frame: on a mesh of too few elements a tie may join a control point of a
    /// section that moves with one that does not move with it.
    fn check_frames(&self) -> Result<(), ModelError> {
        for (expression, owner) in self.constraints.iter().zip(&self.owner) {
            let mut frames = expression.iter().filter_map(|(component, _)| self.section_of.get(component / 3));
            let Some(first) = frames.next() else { continue };
            let Some(other) = frames.find(|frame| *frame != first) else { continue };
            let section = self.traces.iter().find(|trace| trace.section.is_some() && trace.section == first.or(*other));
            return Err(ModelError::TiedToSection {
                tie: owner.map_or("a joint of the surface".into(), |index| format!("\"{}\"", self.traces[index].name)),
                section: section.map_or_else(String::new, |trace| trace.name.clone()),
            });
        }
        Ok(())
    }

    /// C¹ joints of segments, and seams.
    fn tie(&mut self, ties: &Ties, mesh: &Mesh) {
        let grid = mesh.grid();
        let counts = grid.counts;
        for direction in 0..2 {
            for across in 0..counts[1 - direction] {
                for joint in ties.joints[direction].iter().chain(&ties.seam[direction]) {
                    let total = joint.before_weight + joint.after_weight;
                    for c in 0..3 {
                        let component = |along: usize| 3 * grid.index_along(direction, along, across) + c;
                        self.push(
                            None,
                            vec![
                                (component(joint.index), 1.0),
                                (component(joint.before), -joint.before_weight / total),
                                (component(joint.after), -joint.after_weight / total),
                            ],
                        );
                    }
                }
                if !ties.seam[direction].is_empty() {
                    let last = counts[direction] - 1;
                    for c in 0..3 {
                        let component = |along: usize| 3 * grid.index_along(direction, along, across) + c;
                        self.push(None, vec![(component(last), 1.0), (component(0), -1.0)]);
                    }
                }
            }
        }
    }
}

impl Section {
    /// The motions that would take a plane with this normal out of its place, as they stand in a scene.
    fn motions_out_of_plane(&self, normal: [f64; 3]) -> Vec<&'static str> {
        let still = |k: usize| self.motions[k].as_ref().is_some_and(|law| law.at_one == 0.0);
        let keeps = |k: usize| match k {
            0..3 => normal[k].abs() < KEPT,
            _ => normal[k - 3].abs() > 1.0 - KEPT,
        };
        (0..6).filter(|k| !still(*k) && !keeps(*k)).map(|k| MOTIONS[k]).collect()
    }
}

/// The supports of a scene in words of its own, or those that turning ends come to.
pub(super) fn supports_of(scene: &Scene) -> Vec<Support> {
    let (Load::EndRotation(load), Geometry::TapeSpring { length_mm, radius_mm, arc_deg }) =
        (&scene.load, &scene.geometry)
    else {
        return scene.supports.clone();
    };
    let half = arc_deg.to_radians() / 2.0;
    let height = radius_mm * half.sin() / half;
    // Opposite sense: the free edges (below the centroid) are stretched, so the end at x = length turns by −θ. The
    // parameter is θ in degrees.
    let sign = match load.sense {
        Sense::Opposite => 1.0,
        Sense::Equal => -1.0,
    };
    let zero = Motion::Given(0.0);
    let end = |name: &str, edge: Edge, x: f64, slide: Motion, sign: f64| Support {
        name: name.into(),
        on: Place::Edge(edge),
        hold: Hold::Rigid {
            motions: [slide, zero, zero, zero, Motion::Given(sign), zero],
            reference_mm: Some([x, 0.0, height]),
            normals_turn: true,
        },
        history: History::default(),
    };
    let mirror = |name: &str, edge: Edge| Support {
        name: name.into(),
        on: Place::Edge(edge),
        hold: Hold::Symmetric,
        history: History::default(),
    };
    // The first end slides, so that there is no axial force; the other, or the plane of symmetry in its place, holds
    // the shell along x.
    let [half_length, half_arc] = scene.symmetry.cuts();
    let mut supports = vec![end("first end", Edge::UStart, 0.0, Motion::FREE, sign)];
    supports.push(match half_length {
        true => mirror("middle of the length", Edge::UEnd),
        false => end("second end", Edge::UEnd, *length_mm, zero, -sign),
    });
    if half_arc {
        supports.push(mirror("apex", Edge::VStart));
    }
    supports
}

/// What ties rows of control points to each other.
struct Ties {
    joints: [Vec<Joint>; 2],
    /// One or none each way.
    seam: [Vec<Joint>; 2],
    /// Edges in planes of symmetry.
    mirrors: Vec<Edge>,
}

impl Ties {
    fn new(scene: &Scene, mesh: &Mesh, supports: &[Support]) -> Result<Self, ModelError> {
        let closed = match scene.geometry {
            Geometry::CylinderPanel { seam: Some(Seam::Smooth), .. }
            | Geometry::Annulus { seam: Some(Seam::Smooth), .. } => [false, true],
            Geometry::SphereZone { seam: Some(Seam::Smooth), .. } => [true, false],
            Geometry::Nurbs(NurbsPatch { seam: Some(Seam::Smooth), .. }) => closed_directions(mesh),
            _ => [false, false],
        };
        let closing = |way: usize| if closed[way] { seam(mesh, way).map(|joint| vec![joint]) } else { Ok(vec![]) };
        let mirrors = supports.iter().filter(|support| support.hold == Hold::Symmetric).filter_map(|s| match s.on {
            Place::Edge(edge) => Some(edge),
            _ => None,
        });
        Ok(Self {
            joints: [joints(mesh, 0)?, joints(mesh, 1)?],
            seam: [closing(0)?, closing(1)?],
            mirrors: mirrors.collect(),
        })
    }

    /// Rows of an edge. Control points that a plane of symmetry or a C¹ joint holds on one line span the tangent there
    /// and share its normal: their own would take a free motion away.
    fn rows(&self, mesh: &Mesh, edge: Edge) -> Result<EdgeRows, ModelError> {
        let mut rows = edge_rows(mesh, edge)?;
        let (across, _) = edge.side();
        let running = if across == ParametricDirection::U { 1 } else { 0 };
        let last = rows.normals.len() - 1;
        for mirror in &self.mirrors {
            match mirror.side() {
                (direction, _) if direction == across => {}
                (_, false) => rows.normals[1] = rows.normals[0],
                (_, true) => rows.normals[last - 1] = rows.normals[last],
            }
        }
        for joint in self.joints[running].iter().chain(&self.seam[running]) {
            rows.normals[joint.before] = rows.normals[joint.index];
            rows.normals[joint.after] = rows.normals[joint.index];
        }
        Ok(rows)
    }
}

/// The component of a control point along a direction.
pub(super) fn along(point: usize, direction: [f64; 3]) -> Expression {
    (0..3).map(|c| (3 * point + c, direction[c])).filter(|(_, factor)| *factor != 0.0).collect()
}

/// Two unit vectors that span the plane with this normal; axes where the normal is one.
pub(super) fn in_plane(normal: [f64; 3]) -> [[f64; 3]; 2] {
    let largest = (0..3).fold(0, |best, c| if normal[c].abs() > normal[best].abs() { c } else { best });
    [1, 2].map(|step| {
        let axis = (largest + step) % 3;
        let mut vector = [0.0; 3];
        vector[axis] = 1.0;
        let share = dot(vector, normal);
        let flat = [0, 1, 2].map(|c| vector[c] - share * normal[c]);
        let length = norm(flat);
        flat.map(|value| value / length)
    })
}
