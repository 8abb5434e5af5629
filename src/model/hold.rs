//! The constraints that each kind of support makes.

use crate::model::ModelError;
use crate::model::edge::{EdgeRows, edge_rows};
use crate::model::edge_pair::edge_pairs;
use crate::model::edge_ties::is_tied_smoothly;
use crate::model::elimination::Expression;
use crate::model::expressions::{control_expressions, shifted};
use crate::model::member::{Member, members};
use crate::model::mirror::Mirror;
use crate::model::scene_supports::supports_of;
use crate::model::supports::{Footprint, PrescribedMotion, Section, Supports};
use crate::model::symmetric_line::Line;
use crate::model::ties::Ties;
use crate::scene::{Hold, Motion, Region, Scene, ShellEdge, Support};
use crate::shell::{add, dot, norm, scaled, sub};
use crate::spline::Mesh;

impl Supports {
    /// Finds the constraints of a scene's supports on a mesh.
    ///
    /// # Errors
    /// Where a support does not fit the surface, or two contradict each other.
    pub fn new(scene: &Scene, mesh: &Mesh) -> Result<Self, ModelError> {
        let mut supports = Self {
            sections: Vec::new(),
            section_of: vec![None; mesh.point_count()],
            constraints: Vec::new(),
            displacements: Vec::new(),
            footprints: Vec::new(),
            owner: Vec::new(),
            held_motions: None,
        };
        let all = supports_of(scene);
        let members = members(scene, mesh);
        let pairs = edge_pairs(scene, &members)?;
        let smooth: Vec<ShellEdge> = pairs
            .iter()
            .filter(|pair| is_tied_smoothly(pair))
            .flat_map(|pair| pair.edges.map(|edge| edge.at))
            .collect();
        let ties = members.iter().map(|member| {
            let own = smooth.iter().filter(|at| at.shell == member.index).map(|at| at.edge);
            Ties::new(&member.scene, member.patch, &member.supports(&all), own)
        });
        let ties = ties.collect::<Result<Vec<Ties>, _>>()?;
        let points: Vec<[f64; 3]> = mesh.points().collect();
        // Sections come first: other supports of their control points must know their frames.
        for (index, support) in all.iter().enumerate() {
            supports.footprints.push(Footprint {
                name: support.name.clone(),
                points: vec![],
                mirrored: vec![],
                is_inner_mirror: false,
                pole: [0.0; 3],
                section: None,
            });
            if let Hold::Rigid { .. } = support.hold {
                let rows_of = |ShellEdge { shell, edge }: ShellEdge| {
                    let member = &members[shell];
                    Ok(ties[shell].rows(member.patch, edge)?.shifted(member.points.start))
                };
                if let Some(rows) = EdgeRows::joined(support.edges().map(rows_of))? {
                    supports.hold_rigidly(index, support, &rows, &points)?;
                }
            }
        }
        for member in &members {
            supports.hold_member(member, &all, &points)?;
        }
        for (member, ties) in members.iter().zip(&ties) {
            supports.tie(ties, member);
        }
        supports.tie_edges(&pairs, &members, &all);
        // What the other supports leave free is known only at the end.
        for (index, _) in all.iter().enumerate().filter(|(_, support)| support.hold == Hold::RigidMotions) {
            supports.hold_rigid_motions(index, &members, &points)?;
        }
        supports.check_frames()?;
        Ok(supports)
    }

    /// Holds one shell of a structure by its planes of symmetry and given displacements.
    fn hold_member(&mut self, member: &Member, all: &[Support], points: &[[f64; 3]]) -> Result<(), ModelError> {
        let Member { scene, patch, points: range, .. } = member;
        let mut mirrors = Mirror::all(scene, &member.supports(all), patch)?.into_iter();
        for (index, support) in all.iter().enumerate().filter(|(_, support)| support.shell == member.index) {
            match (&support.hold, support.on) {
                (Hold::Rigid { .. } | Hold::RigidMotions, _) => {}
                (Hold::Symmetric, on) => {
                    let Some(mirror) = mirrors.next() else { continue };
                    match on {
                        Region::Edge(edge) => {
                            self.mirror(index, &edge_rows(patch, edge)?.shifted(range.start), &mirror)?;
                        }
                        _ => self.mirror_line(index, member, &mirror)?,
                    }
                }
                (Hold::Displacement { displacement_mm }, on) => {
                    let places = shifted(control_expressions(scene, patch, on)?, range.start);
                    self.displace(index, support, *displacement_mm, &places, points)?;
                }
            }
        }
        Ok(())
    }

    /// Holds a clamped edge, or a rigid section with motions of its own.
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
                    Some(PrescribedMotion { at_one, history: support.history.clone() })
                }
            };
            let laws: Vec<Option<PrescribedMotion>> = motions.iter().enumerate().map(law).collect();
            let section = self.sections.len();
            self.sections.push(Section {
                centre,
                size,
                motions: [0, 1, 2, 3, 4, 5].map(|k| laws[k].clone()),
                rigid_row: rows.outer.clone(),
            });
            for point in &held {
                if let Some(other) = self.section_of[*point].replace(section) {
                    let first = self.footprints.iter().find(|footprint| footprint.section == Some(other));
                    return Err(ModelError::SectionShared {
                        support: support.name.clone(),
                        other: first.map_or_else(String::new, |footprint| footprint.name.clone()),
                    });
                }
            }
            self.footprints[index].section = Some(section);
        }
        for point in &rows.outer {
            (0..3).for_each(|c| self.push(Some(index), vec![(3 * point + c, 1.0)]));
        }
        if *normals_turn {
            for (point, normal) in rows.inner.iter().zip(&rows.normals) {
                self.push(Some(index), along(*point, *normal));
            }
        }
        self.footprints[index].points = held;
        self.footprints[index].pole = centre;
        Ok(())
    }

    /// Holds an edge in a plane of symmetry: no displacement across it, and slopes that continue evenly behind it.
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
        self.footprints[index].points = rows.outer.iter().chain(&rows.inner).copied().collect();
        self.footprints[index].pole = rows.centroid;
        self.footprints[index].mirrored = rows.outer.clone();
        Ok(())
    }

    /// Holds a line inside in a plane of symmetry: no displacement across it, and slopes that are even on both sides.
    fn mirror_line(&mut self, index: usize, member: &Member, mirror: &Mirror) -> Result<(), ModelError> {
        let line = Line::new(member.patch, mirror.direction, mirror.parameter).map_err(|reason| {
            ModelError::NotASymmetryPlane { support: mirror.support.clone(), reason: reason.to_string() }
        })?;
        let first = member.points.start;
        let [places, slopes] = [&line.places, &line.slopes].map(|sums| shifted(sums.clone(), first));
        let points: Vec<usize> = places.iter().chain(&slopes).flatten().map(|(point, _)| *point).collect();
        self.check_sections_keep(&points, mirror)?;
        let directed = |sum: &[(usize, f64)], direction: [f64; 3]| -> Expression {
            let of_point = |(point, factor): &(usize, f64)| along(*point, scaled(*factor, direction));
            sum.iter().flat_map(of_point).collect()
        };
        for (place, slope) in places.iter().zip(&slopes) {
            self.push(Some(index), directed(place, mirror.normal));
            let tangents = in_plane(mirror.normal);
            tangents.into_iter().for_each(|direction| self.push(Some(index), directed(slope, direction)));
        }
        let curve = line.points(member.patch);
        let share = 1.0 / curve.len() as f64;
        let middle = curve.iter().fold([0.0; 3], |sum, x| add(sum, scaled(share, *x)));
        let footprint = &mut self.footprints[index];
        (footprint.points, footprint.pole, footprint.is_inner_mirror) = (points, middle, true);
        Ok(())
    }

    /// Prescribes components of a displacement, for each of some weighted sums over control points.
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
                self.displacements.push(PrescribedMotion { at_one: value, history: support.history.clone() });
                3 * points.len() + self.displacements.len() - 1
            });
            for place in places {
                let mut expression: Expression = place.iter().map(|(point, factor)| (3 * point + c, *factor)).collect();
                // The weights of a place sum to 1, so that all control points of an edge move by the value.
                expression.extend(given.map(|component| (component, -1.0)));
                self.push(Some(index), expression);
            }
        }
        let weight: f64 = places.len() as f64;
        let mut pole = [0.0; 3];
        for (point, factor) in places.iter().flatten() {
            (0..3).for_each(|c| pole[c] += factor * points[*point][c] / weight);
        }
        self.footprints[index].points = held;
        self.footprints[index].pole = pole;
        Ok(())
    }

    fn overlap(&self, index: usize, section: usize) -> ModelError {
        let other = self.footprints.iter().find(|footprint| footprint.section == Some(section));
        ModelError::SectionShared {
            support: self.footprints[index].name.clone(),
            other: other.map_or_else(String::new, |footprint| footprint.name.clone()),
        }
    }

    /// Adds the constraints of C¹ joints of segments, and of seams.
    fn tie(&mut self, ties: &Ties, member: &Member) {
        let (grid, first) = (member.patch.grid(), member.points.start);
        let counts = grid.counts;
        for direction in 0..2 {
            for across in 0..counts[1 - direction] {
                for joint in ties.joints[direction].iter().chain(&ties.seam[direction]) {
                    let total = joint.before_weight + joint.after_weight;
                    for c in 0..3 {
                        let component = |along: usize| 3 * (first + grid.index_along(direction, along, across)) + c;
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
                        let component = |along: usize| 3 * (first + grid.index_along(direction, along, across)) + c;
                        self.push(None, vec![(component(last), 1.0), (component(0), -1.0)]);
                    }
                }
            }
        }
    }
}

/// Expression for the component of a control point along a direction.
fn along(point: usize, direction: [f64; 3]) -> Expression {
    (0..3).map(|c| (3 * point + c, direction[c])).filter(|(_, factor)| *factor != 0.0).collect()
}

/// Two unit vectors that span the plane with this normal; axes where the normal is one.
fn in_plane(normal: [f64; 3]) -> [[f64; 3]; 2] {
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
