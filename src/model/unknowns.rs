//! Free unknowns, and the coordinates from which the displacement of every control point follows.
//!
//! *Coordinates* x are the free unknowns q followed by the given motions m(s), functions of the scene's parameter s. Each
//! control point has a *frame*: space, or a rigid section with a pose of its own. In its frame its displacement has three
//! components v; linear constraints between components of one frame (a support, a plane of symmetry, a C¹ joint) are
//! eliminated once per mesh, so that v = C x. A control point X in a section about c with translation t and rotation
//! vector ω moves by
//!
//! u = t + (exp(ω) − I)(X − c) + exp(ω) v,
//!
//! and t and ω are coordinates as well, free or given. Rotation coordinates are ω times the size of the section, so that
//! all coordinates are lengths, and the forces conjugate to them are forces.
//!
//! A clamped edge (Kirchhoff–Love support without membrane strain) holds its row of control points rigidly; the second
//! row keeps its offset normal to the shell in the section's frame and is free along the edge's outward direction
//! (stretch) and along the edge (shear). Holding that row rigidly instead would fix the membrane strain at the edge.

use std::collections::BTreeMap;

use crate::model::ModelError;
use crate::model::elimination::{Expression, eliminate};
use crate::model::supports::{PrescribedMotion, Section, Supports};

use crate::scene::Scene;
use crate::shell::basis_vector;
use crate::spline::Mesh;

/// The share of one coordinate in the displacement of one control point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Index of the coordinate, which is a free unknown if it is below [`Unknowns::count`].
    pub coordinate: usize,
    /// Effect of a unit of the coordinate.
    pub share: Share,
}

/// Effect of a unit of a coordinate on a control point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Share {
    /// The control point moves by this vector.
    Fixed([f64; 3]),
    /// The control point moves by this vector, turned with its section.
    Turning([f64; 3]),
    /// The section moves along the axis with this index.
    Translation(usize),
    /// The section turns by the component of its rotation vector with this index.
    Rotation(usize),
}

/// The quantity that a free unknown stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Home {
    /// A component of a control point in its frame.
    Component(usize, usize),
    /// A motion of a section, seen at a control point of its rigid row.
    Motion { section: usize, motion: usize, point: usize },
}

/// The free unknowns of a mesh, and how the control points depend on them.
#[derive(Debug)]
pub struct Unknowns {
    pub(super) count: usize,
    /// Entries of control point i: `entries[start[i]..start[i + 1]]`, of which those up to `free_end[i]` are free.
    pub(super) start: Vec<usize>,
    free_end: Vec<usize>,
    pub(super) entries: Vec<Entry>,
    pub(super) supports: Supports,
    /// Coordinate of each motion of each section.
    pub(super) motions: Vec<[usize; 6]>,
    /// Prescribed motions of the given coordinates.
    given: Vec<PrescribedMotion>,
    /// Undeformed control points, mm.
    pub(crate) points: Vec<[f64; 3]>,
    pub(super) home: Vec<Home>,
}

impl Unknowns {
    /// Eliminates the constraints of the scene on this mesh.
    ///
    /// # Errors
    /// Where the supports contradict each other, or do not fit the surface.
    pub fn new(scene: &Scene, mesh: &Mesh) -> Result<Self, ModelError> {
        let supports = Supports::new(scene, mesh)?;
        let points: Vec<[f64; 3]> = mesh.points().collect();
        let first_given = 3 * points.len();
        let eliminated = eliminate(&supports.constraints, first_given)
            .map_err(|contradiction| supports.contradiction(contradiction.constraint))?;
        let mut unknowns = Self {
            count: 0,
            start: vec![0],
            free_end: Vec::new(),
            entries: Vec::new(),
            given: supports.displacements.clone(),
            motions: Vec::new(),
            supports,
            points,
            home: Vec::new(),
        };
        unknowns.number(&eliminated, &in_turn(mesh));
        Ok(unknowns)
    }

    /// Number of free unknowns.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Number of given coordinates.
    pub fn given_count(&self) -> usize {
        self.given.len()
    }

    /// Values of the given coordinates at a parameter, mm.
    pub fn given_at(&self, parameter: f64) -> Vec<f64> {
        self.given.iter().map(|law| law.at(parameter)).collect()
    }

    /// Derivatives of the given coordinates with respect to the parameter, mm.
    pub fn given_rates_at(&self, parameter: f64) -> Vec<f64> {
        self.given.iter().map(|law| law.rate(parameter)).collect()
    }

    /// Rigid sections that move.
    pub fn sections(&self) -> &[Section] {
        &self.supports.sections
    }

    /// Constraints that the supports impose.
    pub fn supports(&self) -> &Supports {
        &self.supports
    }

    /// Whether the displacement alone does not determine the rotations of the sections, because one turns freely.
    pub fn turns_are_unknown(&self) -> bool {
        self.motions.iter().any(|motions| motions[3..].iter().any(|coordinate| *coordinate < self.count))
    }

    /// Control point that an unknown belongs to; the first one where several share it.
    pub fn home_of(&self, unknown: usize) -> usize {
        match self.home[unknown] {
            Home::Component(point, _) | Home::Motion { point, .. } => point,
        }
    }

    /// Entries of a control point that belong to free unknowns.
    pub fn entries_of(&self, point: usize) -> &[Entry] {
        &self.entries[self.start[point]..self.free_end[point]]
    }

    /// Whether the control point's three components are three unknowns of their own.
    pub fn is_regular(&self, point: usize) -> bool {
        let entries = &self.entries[self.start[point]..self.start[point + 1]];
        entries.len() == 3
            && entries.iter().enumerate().all(|(c, entry)| {
                entry.coordinate < self.count
                    && entry.coordinate == entries[0].coordinate + c
                    && entry.share == Share::Fixed(basis_vector(c))
                    && self.home[entry.coordinate] == Home::Component(point, c)
            })
    }

    /// Numbers the free motions of sections and the components that were not eliminated, with control points in this order,
    /// so that unknowns that meet are near each other; and lists each control point's entries.
    fn number(&mut self, eliminated: &BTreeMap<usize, Expression>, in_turn: &[usize]) {
        let components = 3 * self.points.len();
        let mut of_component = BTreeMap::new();
        self.motions = vec![[usize::MAX; 6]; self.supports.sections.len()];
        for point in in_turn.iter().copied() {
            self.number_motions_at(point);
            for c in (0..3).filter(|c| !eliminated.contains_key(&(3 * point + c))) {
                of_component.insert(3 * point + c, self.home.len());
                self.home.push(Home::Component(point, c));
            }
        }
        self.count = self.home.len();
        self.number_given_motions();
        for k in 0..self.supports.displacements.len() {
            of_component.insert(components + k, self.count + k);
        }
        for point in 0..self.points.len() {
            self.list(point, eliminated, &of_component);
        }
    }

    /// The free motions of a section come with the first control point of its rigid row: far from the rows that they move,
    /// they would make a banded matrix a full one. Given motions are put behind everything else later.
    fn number_motions_at(&mut self, point: usize) {
        for (section, held) in self.supports.sections.iter().enumerate().filter(|(_, held)| held.rigid_row[0] == point)
        {
            for (motion, law) in held.motions.iter().enumerate() {
                if law.is_none() {
                    self.motions[section][motion] = self.home.len();
                    self.home.push(Home::Motion { section, motion, point });
                }
            }
        }
    }

    fn number_given_motions(&mut self) {
        for (section, coordinates) in self.supports.sections.iter().zip(&mut self.motions) {
            for (law, coordinate) in section.motions.iter().zip(coordinates) {
                if let Some(law) = law {
                    *coordinate = self.count + self.given.len();
                    self.given.push(law.clone());
                }
            }
        }
    }

    fn list(&mut self, point: usize, eliminated: &BTreeMap<usize, Expression>, of_component: &BTreeMap<usize, usize>) {
        let mut directions: BTreeMap<usize, [f64; 3]> = BTreeMap::new();
        for c in 0..3 {
            let component = 3 * point + c;
            if let Some(coordinate) = of_component.get(&component) {
                directions.entry(*coordinate).or_default()[c] += 1.0;
            } else if let Some(expression) = eliminated.get(&component) {
                for (other, factor) in expression {
                    directions.entry(of_component[other]).or_default()[c] += factor;
                }
            }
        }
        let section = self.supports.section_of[point];
        let mut all: Vec<Entry> = Vec::new();
        if let Some(section) = section {
            for (motion, coordinate) in self.motions[section].into_iter().enumerate() {
                let share = if motion < 3 { Share::Translation(motion) } else { Share::Rotation(motion - 3) };
                all.push(Entry { coordinate, share });
            }
        }
        for (coordinate, direction) in directions {
            let share = if section.is_some() { Share::Turning(direction) } else { Share::Fixed(direction) };
            all.push(Entry { coordinate, share });
        }
        all.sort_by_key(|entry| entry.coordinate);
        self.free_end.push(self.entries.len() + all.iter().filter(|entry| entry.coordinate < self.count).count());
        self.entries.extend(all);
        self.start.push(self.entries.len());
    }
}

/// Lists control points so that those that meet are near each other: of one patch line after line along the direction that
/// has more of them, of several by their positions along the longest side of the structure.
fn in_turn(mesh: &Mesh) -> Vec<usize> {
    if let [patch] = &mesh.patches[..] {
        let grid = patch.grid();
        let [n1, n2] = grid.counts;
        return if n1 >= n2 { (0..grid.len()).collect() } else { grid.first_fastest().collect() };
    }
    let points: Vec<[f64; 3]> = mesh.points().collect();
    let extent = |c: usize| {
        let [low, high] =
            points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x[c]), high.max(x[c])]);
        high - low
    };
    let longest = [1, 2].into_iter().fold(0, |best, c| if extent(c) > extent(best) { c } else { best });
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|one, other| points[*one][longest].total_cmp(&points[*other][longest]));
    order
}
