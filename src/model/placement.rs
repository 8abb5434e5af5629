//! The displacement u(x) at one set of coordinates, its derivatives, and what rigid sections that turn add to the
//! stiffness.

use crate::model::rotation::{Rotation, apply};
use crate::model::supports::{Section, Supports};
use crate::model::unknowns::{Entry, Home, Share, Unknowns};
use crate::shell::{add, basis_vector, dot, scaled, sub};

/// The displacement at some coordinates, and its derivatives with respect to them.
#[derive(Debug)]
pub struct Placement<'a> {
    unknowns: &'a Unknowns,
    coordinates: Vec<f64>,
    rotations: Vec<Rotation>,
    /// Direction in space of each entry.
    directions: Vec<[f64; 3]>,
    /// Arms X − c + v of the control points of sections, mm.
    arms: Vec<[f64; 3]>,
    /// Displacements v of the control points of sections in their frames, mm. They are kept apart from the arms, whose
    /// rounding is a share of the shell's size: at a millionth of a degree v has few digits left in them.
    locals: Vec<[f64; 3]>,
}

/// The pose of a section.
#[derive(Clone, Debug)]
struct Pose {
    /// Translation (mm) and rotation vector (radians).
    pub motions: [f64; 6],
    rotation: Rotation,
    centre: [f64; 3],
}

impl Pose {
    fn new(motions: [f64; 6], centre: [f64; 3]) -> Self {
        Self { motions, rotation: Rotation::new([motions[3], motions[4], motions[5]]), centre }
    }

    /// Displacement v, in the section's frame, of a control point X that is displaced by u.
    pub fn local(&self, point: [f64; 3], displacement: [f64; 3]) -> [f64; 3] {
        let [x, y, z, ..] = self.motions;
        let arm = sub(point, self.centre);
        let relative = sub(sub(displacement, [x, y, z]), apply(&self.rotation.change, arm));
        self.rotation.turn_back(relative)
    }
}

impl Unknowns {
    /// Computes the displacement at some free unknowns and a parameter.
    pub fn configure(&self, unknowns: &[f64], parameter: f64) -> Placement<'_> {
        Placement::new(self, unknowns, parameter)
    }

    /// Finds the free unknowns of a displacement that can be represented at a parameter. `turns` are the rotation
    /// vectors of the sections where one of them turns freely, and empty otherwise.
    pub fn of_displacement(&self, displacement: &[[f64; 3]], turns: &[[f64; 3]], parameter: f64) -> Vec<f64> {
        let poses = self.poses_of(displacement, turns, parameter);
        self.home
            .iter()
            .map(|home| match *home {
                Home::Component(point, c) => match self.supports.section_of[point] {
                    Some(section) => poses[section].local(self.points[point], displacement[point])[c],
                    None => displacement[point][c],
                },
                Home::Motion { section, motion, .. } => {
                    let size = if motion < 3 { 1.0 } else { self.supports.sections[section].size };
                    poses[section].motions[motion] * size
                }
            })
            .collect()
    }

    /// Finds the poses of the sections in a displacement.
    fn poses_of(&self, displacement: &[[f64; 3]], turns: &[[f64; 3]], parameter: f64) -> Vec<Pose> {
        let given = self.given_at(parameter);
        let pose = |(index, section): (usize, &Section)| {
            let mut motions = [0.0; 6];
            for (motion, value) in motions.iter_mut().enumerate() {
                let size = if motion < 3 { 1.0 } else { section.size };
                *value = match self.motions[index][motion].checked_sub(self.count) {
                    Some(known) => given[known] / size,
                    None if motion >= 3 => turns.get(index).map_or(0.0, |turn| turn[motion - 3]),
                    None => 0.0,
                };
            }
            // A free translation is that of the rigid row.
            let still = Pose::new(motions, section.centre);
            let point = section.rigid_row[0];
            let arm = sub(self.points[point], section.centre);
            let shift = sub(displacement[point], apply(&still.rotation.change, arm));
            for c in 0..3 {
                if self.motions[index][c] < self.count {
                    motions[c] = shift[c];
                }
            }
            Pose { motions, ..still }
        };
        self.supports.sections.iter().enumerate().map(pose).collect()
    }
}

impl<'a> Placement<'a> {
    fn new(unknowns: &'a Unknowns, free: &[f64], parameter: f64) -> Self {
        let mut coordinates = free.to_vec();
        coordinates.extend(unknowns.given_at(parameter));
        let turn = |(section, motions): (&Section, &[usize; 6])| {
            Rotation::new([3, 4, 5].map(|motion| coordinates[motions[motion]] / section.size))
        };
        let rotations = unknowns.supports.sections.iter().zip(&unknowns.motions).map(turn).collect();
        let mut placement =
            Self { unknowns, coordinates, rotations, directions: Vec::new(), arms: Vec::new(), locals: Vec::new() };
        placement.arms = vec![[0.0; 3]; unknowns.points.len()];
        placement.locals = vec![[0.0; 3]; unknowns.points.len()];
        placement.directions.reserve(unknowns.entries.len());
        for point in 0..unknowns.points.len() {
            let entries = placement.all_entries(point);
            if let Some(section) = unknowns.supports.section_of[point] {
                let start = sub(unknowns.points[point], unknowns.supports.sections[section].centre);
                let local = entries.iter().fold([0.0; 3], |sum, entry| match entry.share {
                    Share::Turning(v) => add(sum, scaled(placement.coordinates[entry.coordinate], v)),
                    _ => sum,
                });
                placement.locals[point] = local;
                placement.arms[point] = add(start, local);
            }
            for entry in entries {
                let direction = placement.direction(point, entry);
                placement.directions.push(direction);
            }
        }
        placement
    }

    fn all_entries(&self, point: usize) -> &'a [Entry] {
        let unknowns = self.unknowns;
        &unknowns.entries[unknowns.start[point]..unknowns.start[point + 1]]
    }

    fn section(&self, point: usize) -> Option<(usize, &Rotation, f64)> {
        let section = self.unknowns.supports.section_of[point]?;
        Some((section, &self.rotations[section], self.unknowns.supports.sections[section].size))
    }

    pub(super) fn supports(&self) -> &'a Supports {
        &self.unknowns.supports
    }

    /// Rotates a force on a control point into its frame.
    pub(super) fn seen_in_frame(&self, point: usize, force: [f64; 3]) -> [f64; 3] {
        self.section(point).map_or(force, |(_, rotation, _)| rotation.turn_back(force))
    }

    /// Rotates a force from the frame of a control point into space.
    pub(super) fn seen_in_space(&self, point: usize, force: [f64; 3]) -> [f64; 3] {
        self.section(point).map_or(force, |(_, rotation, _)| rotation.turn(force))
    }

    fn direction(&self, point: usize, entry: &Entry) -> [f64; 3] {
        match (entry.share, self.section(point)) {
            (Share::Turning(v), Some((_, rotation, _))) => rotation.turn(v),
            (Share::Rotation(k), Some((_, rotation, size))) => {
                scaled(1.0 / size, apply(&rotation.first[k], self.arms[point]))
            }
            (Share::Translation(axis), _) => basis_vector(axis),
            (Share::Fixed(v) | Share::Turning(v), _) => v,
            (Share::Rotation(_), None) => [0.0; 3],
        }
    }

    /// Directions in space of the free entries of a control point, in the order of [`Unknowns::entries_of`].
    pub fn directions_of(&self, point: usize) -> &[[f64; 3]] {
        &self.directions[self.unknowns.start[point]..][..self.unknowns.entries_of(point).len()]
    }

    /// Displacement u of every control point, mm.
    pub fn displacement(&self) -> Vec<[f64; 3]> {
        let unknowns = self.unknowns;
        (0..unknowns.points.len())
            .map(|point| {
                let entries = self.all_entries(point);
                let Some((section, rotation, _)) = self.section(point) else {
                    let start = unknowns.start[point];
                    let pairs = entries.iter().zip(&self.directions[start..]);
                    return pairs.fold([0.0; 3], |sum, (entry, direction)| {
                        add(sum, scaled(self.coordinates[entry.coordinate], *direction))
                    });
                };
                let (arm, local) = (self.arms[point], self.locals[point]);
                let shift = [0, 1, 2].map(|axis| self.coordinates[unknowns.motions[section][axis]]);
                add(add(shift, apply(&rotation.change, arm)), local)
            })
            .collect()
    }

    /// Rotation vectors of the sections, radians; empty where the displacement alone determines them.
    pub fn turns(&self) -> Vec<[f64; 3]> {
        if !self.unknowns.turns_are_unknown() {
            return Vec::new();
        }
        (0..self.unknowns.supports.sections.len()).map(|section| self.turn(section)).collect()
    }

    /// Translation of a section, mm.
    pub fn translation(&self, section: usize) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.coordinates[self.unknowns.motions[section][axis]])
    }

    /// Rotation vector of a section, radians.
    pub fn turn(&self, section: usize) -> [f64; 3] {
        let size = self.unknowns.supports.sections[section].size;
        [3, 4, 5].map(|k| self.coordinates[self.unknowns.motions[section][k]] / size)
    }

    /// Velocity of the control points for rates of the free and the given coordinates, either of which may be empty.
    pub fn velocity(&self, free: &[f64], given: &[f64]) -> Vec<[f64; 3]> {
        let count = self.unknowns.count;
        let rate = |coordinate: usize| match coordinate.checked_sub(count) {
            Some(known) => given.get(known).copied().unwrap_or(0.0),
            None => free.get(coordinate).copied().unwrap_or(0.0),
        };
        (0..self.unknowns.points.len())
            .map(|point| {
                let start = self.unknowns.start[point];
                let pairs = self.all_entries(point).iter().zip(&self.directions[start..]);
                pairs.fold([0.0; 3], |sum, (entry, direction)| add(sum, scaled(rate(entry.coordinate), *direction)))
            })
            .collect()
    }

    /// Computes Tᵀ g: forces on the free unknowns from forces g on the control points.
    pub fn restrict(&self, forces: &[[f64; 3]]) -> Vec<f64> {
        let mut restricted = vec![0.0; self.unknowns.count];
        for (point, force) in forces.iter().enumerate() {
            for (entry, direction) in self.unknowns.entries_of(point).iter().zip(self.directions_of(point)) {
                restricted[entry.coordinate] += dot(*force, *direction);
            }
        }
        restricted
    }

    /// Computes the forces conjugate to the given coordinates, N, from forces on the control points.
    pub fn reactions(&self, forces: &[[f64; 3]]) -> Vec<f64> {
        let mut reactions = vec![0.0; self.unknowns.given_count()];
        for (point, force) in forces.iter().enumerate() {
            let start = self.unknowns.start[point];
            for (entry, direction) in self.all_entries(point).iter().zip(&self.directions[start..]) {
                if let Some(known) = entry.coordinate.checked_sub(self.unknowns.count) {
                    reactions[known] += dot(*force, *direction);
                }
            }
        }
        reactions
    }

    /// Second derivative ∂²u/∂x_a∂x_b of a control point; `None` unless one of the two coordinates turns its section.
    fn second(&self, point: usize, a: &Entry, b: &Entry) -> Option<[f64; 3]> {
        let (_, rotation, size) = self.section(point)?;
        match (a.share, b.share) {
            (Share::Rotation(k), Share::Rotation(l)) => {
                Some(scaled(1.0 / (size * size), apply(&rotation.second[k][l], self.arms[point])))
            }
            (Share::Rotation(k), Share::Turning(v)) | (Share::Turning(v), Share::Rotation(k)) => {
                Some(scaled(1.0 / size, apply(&rotation.first[k], v)))
            }
            _ => None,
        }
    }

    /// Computes Σ g · ∂²u/∂q_a∂q_b over control points, for pairs a ≥ b of free unknowns, which sections that turn
    /// freely add to the stiffness. Empty where none does.
    pub fn curvature(&self, forces: &[[f64; 3]]) -> Vec<(usize, usize, f64)> {
        let mut terms = Vec::new();
        if !self.unknowns.turns_are_unknown() {
            return terms;
        }
        for (point, force) in forces.iter().enumerate() {
            let entries = self.unknowns.entries_of(point);
            for a in entries {
                for b in entries.iter().filter(|b| b.coordinate <= a.coordinate) {
                    if let Some(second) = self.second(point, a, b) {
                        terms.push((a.coordinate, b.coordinate, dot(*force, second)));
                    }
                }
            }
        }
        terms
    }

    /// Computes Σ g · ∂²u/∂q∂m ṁ over control points: the rate of Tᵀ g as the given coordinates move.
    pub fn restrict_rate(&self, forces: &[[f64; 3]], given: &[f64]) -> Vec<f64> {
        let mut restricted = vec![0.0; self.unknowns.count];
        for (point, force) in forces.iter().enumerate().filter(|(point, _)| self.section(*point).is_some()) {
            let (free, known) = self.all_entries(point).split_at(self.unknowns.entries_of(point).len());
            for a in free {
                for b in known {
                    if let Some(second) = self.second(point, a, b) {
                        restricted[a.coordinate] += given[b.coordinate - self.unknowns.count] * dot(*force, second);
                    }
                }
            }
        }
        restricted
    }
}
