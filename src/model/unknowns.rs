//! Free unknowns, and how the displacement of every control point follows from them and from the end rotation.
//!
//! Each control point has a *frame*: space, or an end section that turns by θ. In its frame its displacement has three
//! components v; linear homogeneous constraints between components of one frame (a support, a plane of symmetry, a C¹
//! joint) are eliminated once per mesh, so that v = C q with free unknowns q, and
//!
//! u(θ, q) = rigid(θ) + Q(θ) C q + slide,   T = ∂u/∂q,   u,θ = rigid' + Q' C q.
//!
//! A clamped end (theory: Kirchhoff–Love support without membrane strain) holds its row of control points rigidly; the
//! second row keeps its offset normal to the shell in the turned section's frame and is free along the turned axis
//! (stretch) and along the turned arc tangent (shear). Holding that row rigidly instead would fix the membrane strain
//! at the end.

use std::collections::BTreeMap;

use crate::model::RigidEnd;
use crate::scene::Scene;
use crate::shell::{add, dot, norm, scaled, sub};
use crate::spline::Mesh;

/// Coefficients below this, relative to 1, are rounding: the constraint that they belong to is redundant.
const REDUNDANT: f64 = 1e-11;

/// The share of one unknown in the displacement of one control point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Index of the unknown.
    pub unknown: usize,
    /// Displacement per unit of it, in the control point's frame.
    pub direction: [f64; 3],
    /// Whether the direction turns with the frame (a slide does not).
    turns: bool,
}

/// Free unknowns of a mesh.
#[derive(Debug)]
pub struct Unknowns {
    count: usize,
    /// Entries of control point i: `entries[start[i]..start[i + 1]]`.
    start: Vec<usize>,
    entries: Vec<Entry>,
    /// The end section that a control point turns with.
    frame: Vec<Option<usize>>,
    ends: [RigidEnd; 2],
    /// Undeformed control points, mm.
    points: Vec<[f64; 3]>,
    /// Control point and component whose displacement *is* the unknown.
    home: Vec<(usize, usize)>,
    /// Unknown of the free slide of end 0, and a control point of its rigid row.
    slide: Option<(usize, usize)>,
}

impl Unknowns {
    /// Constraints of the scene on this mesh, eliminated.
    pub fn new(scene: &Scene, mesh: &Mesh) -> Self {
        let ends = RigidEnd::both(scene);
        let points: Vec<[f64; 3]> = mesh.control_points.iter().map(|[x, y, z, w]| [x / w, y / w, z / w]).collect();
        let [half_length, _] = scene.symmetry.cuts();
        let [n1, n2] = mesh.control_counts();
        let frame: Vec<Option<usize>> = (0..n1 * n2)
            .map(|i| match i / n2 {
                row if row < 2 => Some(0),
                row if !half_length && row >= n1 - 2 => Some(1),
                _ => None,
            })
            .collect();
        let eliminated = eliminate(&constraints(scene, mesh, &points));
        let mut unknowns =
            Self { count: 0, start: vec![0], entries: Vec::new(), frame, ends, points, home: Vec::new(), slide: None };
        unknowns.number(&eliminated);
        unknowns
    }

    /// Number of free unknowns.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The control point that an unknown belongs to; of several that share it, the first.
    pub fn home_of(&self, unknown: usize) -> usize {
        self.home[unknown].0
    }

    /// Entries of a control point.
    pub fn entries_of(&self, point: usize) -> &[Entry] {
        &self.entries[self.start[point]..self.start[point + 1]]
    }

    /// Whether the control point's three components are three unknowns of their own.
    pub fn is_regular(&self, point: usize) -> bool {
        let entries = self.entries_of(point);
        self.frame[point].is_none()
            && entries.len() == 3
            && entries.iter().enumerate().all(|(c, entry)| {
                entry.unknown == entries[0].unknown + c
                    && entry.direction == unit(c)
                    && self.home[entry.unknown] == (point, c)
            })
    }

    /// Numbers the components that were not eliminated, along the length, and lists each control point's entries.
    fn number(&mut self, eliminated: &BTreeMap<usize, Expression>) {
        let mut of_component = BTreeMap::new();
        // End 0 slides: its unknown comes first, beside the rows that it moves.
        let slide_point = (0..self.points.len()).find(|i| self.frame[*i].is_some_and(|end| self.ends[end].slides));
        if let Some(point) = slide_point {
            self.slide = Some((self.count, point));
            self.home.push((point, 0));
            self.count += 1;
        }
        for component in 0..3 * self.points.len() {
            if !eliminated.contains_key(&component) {
                of_component.insert(component, self.count);
                self.home.push((component / 3, component % 3));
                self.count += 1;
            }
        }
        for point in 0..self.points.len() {
            let mut directions: BTreeMap<usize, [f64; 3]> = BTreeMap::new();
            for c in 0..3 {
                let component = 3 * point + c;
                if let Some(unknown) = of_component.get(&component) {
                    directions.entry(*unknown).or_default()[c] += 1.0;
                } else if let Some(expression) = eliminated.get(&component) {
                    for (other, factor) in expression {
                        directions.entry(of_component[other]).or_default()[c] += factor;
                    }
                }
            }
            let slides = self.frame[point].is_some_and(|end| self.ends[end].slides);
            if let (Some((unknown, _)), true) = (self.slide, slides) {
                self.entries.push(Entry { unknown, direction: unit(0), turns: false });
            }
            let turns = self.frame[point].is_some();
            self.entries.extend(directions.into_iter().map(|(unknown, direction)| Entry { unknown, direction, turns }));
            self.start.push(self.entries.len());
        }
    }

    /// The affine map from unknowns to displacements at an end rotation (radians).
    pub fn at(&self, theta: f64) -> Placement<'_> {
        let mut directions = Vec::with_capacity(self.entries.len());
        let mut direction_rates = Vec::new();
        for point in 0..self.points.len() {
            let turn =
                self.frame[point].map(|end| (self.ends[end].rotation(theta), self.ends[end].rotation_rate(theta)));
            for (index, entry) in (self.start[point]..).zip(self.entries_of(point)) {
                match turn {
                    Some((rotation, rate)) if entry.turns => {
                        directions.push(rotation.map(|row| dot(row, entry.direction)));
                        direction_rates.push((index, point, rate.map(|row| dot(row, entry.direction))));
                    }
                    _ => directions.push(entry.direction),
                }
            }
        }
        Placement { unknowns: self, theta, directions, direction_rates }
    }
}

/// u(θ, q) at one θ: directions of all entries in space, and how they change with θ.
#[derive(Debug)]
pub struct Placement<'a> {
    unknowns: &'a Unknowns,
    theta: f64,
    directions: Vec<[f64; 3]>,
    /// (entry, control point, ∂direction/∂θ) of the entries that turn.
    direction_rates: Vec<(usize, usize, [f64; 3])>,
}

impl Placement<'_> {
    /// Directions in space of the entries of a control point, in the order of [`Unknowns::entries_of`].
    pub fn directions_of(&self, point: usize) -> &[[f64; 3]] {
        &self.directions[self.unknowns.start[point]..self.unknowns.start[point + 1]]
    }

    /// u(θ, q), one vector a control point.
    pub fn displacement(&self, q: &[f64]) -> Vec<[f64; 3]> {
        let unknowns = self.unknowns;
        (0..unknowns.points.len())
            .map(|point| {
                let start = match unknowns.frame[point] {
                    Some(end) => unknowns.ends[end].displacement(self.theta, unknowns.points[point]),
                    None => [0.0; 3],
                };
                let entries = unknowns.entries_of(point).iter().zip(self.directions_of(point));
                entries.fold(start, |sum, (entry, direction)| add(sum, scaled(q[entry.unknown], *direction)))
            })
            .collect()
    }

    /// The unknowns of a displacement that this placement can represent: q with u(θ, q) = `displacement`.
    pub fn unknowns_of(&self, displacement: &[[f64; 3]]) -> Vec<f64> {
        let unknowns = self.unknowns;
        let mut slide = 0.0;
        if let Some((_, point)) = unknowns.slide {
            slide = displacement[point][0] - unknowns.ends[0].displacement(self.theta, unknowns.points[point])[0];
        }
        let mut q: Vec<f64> = unknowns
            .home
            .iter()
            .map(|(point, c)| {
                let Some(end) = unknowns.frame[*point] else { return displacement[*point][*c] };
                let end = unknowns.ends[end];
                let mut relative = sub(displacement[*point], end.displacement(self.theta, unknowns.points[*point]));
                if end.slides {
                    relative[0] -= slide;
                }
                let rotation = end.rotation(self.theta);
                (0..3).map(|row| rotation[row][*c] * relative[row]).sum()
            })
            .collect();
        if let Some((unknown, _)) = unknowns.slide {
            q[unknown] = slide;
        }
        q
    }

    /// ∂u/∂θ at fixed unknowns.
    pub fn rate(&self, q: &[f64]) -> Vec<[f64; 3]> {
        let unknowns = self.unknowns;
        let mut rate: Vec<[f64; 3]> = (0..unknowns.points.len())
            .map(|point| match unknowns.frame[point] {
                Some(end) => unknowns.ends[end].displacement_rate(self.theta, unknowns.points[point]),
                None => [0.0; 3],
            })
            .collect();
        for (entry, point, direction) in &self.direction_rates {
            rate[*point] = add(rate[*point], scaled(q[unknowns.entries[*entry].unknown], *direction));
        }
        rate
    }

    /// Tᵀ g: forces on the control points to forces on the unknowns.
    pub fn restrict(&self, forces: &[[f64; 3]]) -> Vec<f64> {
        let mut restricted = vec![0.0; self.unknowns.count];
        for (point, force) in forces.iter().enumerate() {
            for (entry, direction) in self.unknowns.entries_of(point).iter().zip(self.directions_of(point)) {
                restricted[entry.unknown] += dot(*force, *direction);
            }
        }
        restricted
    }

    /// (∂T/∂θ)ᵀ g.
    pub fn restrict_rate(&self, forces: &[[f64; 3]]) -> Vec<f64> {
        let mut restricted = vec![0.0; self.unknowns.count];
        for (entry, point, direction) in &self.direction_rates {
            restricted[self.unknowns.entries[*entry].unknown] += dot(forces[*point], *direction);
        }
        restricted
    }
}

fn unit(c: usize) -> [f64; 3] {
    let mut vector = [0.0; 3];
    vector[c] = 1.0;
    vector
}

/// Σ factor · component; component = 3 · control point + c.
type Expression = Vec<(usize, f64)>;

/// All linear homogeneous constraints of the scene on frame components, each as an expression that is zero.
fn constraints(scene: &Scene, mesh: &Mesh, points: &[[f64; 3]]) -> Vec<Expression> {
    let [n1, n2] = mesh.control_counts();
    let [half_length, half_arc] = scene.symmetry.cuts();
    let at = |i1: usize, i2: usize, c: usize| 3 * (i1 * n2 + i2) + c;
    let joints = joints(mesh);
    // The normal of a cylinder at a control point is radial in the section plane. Control points that a plane of
    // symmetry or a C¹ joint holds on one line span the tangent there and share its normal: their own would take a
    // free motion away.
    let mut normal_like: Vec<usize> = (0..n2).collect();
    if half_arc {
        normal_like[1] = 0;
    }
    for (joint, ..) in &joints {
        normal_like[joint - 1] = *joint;
        normal_like[joint + 1] = *joint;
    }
    let mut all: Vec<Expression> = Vec::new();
    let mut clamp = |edge: usize, inner: usize| {
        for i2 in 0..n2 {
            all.extend((0..3).map(|c| vec![(at(edge, i2, c), 1.0)]));
            let [_, y, z] = points[inner * n2 + normal_like[i2]];
            let radius = norm([0.0, y, z]);
            all.push(vec![(at(inner, i2, 1), y / radius), (at(inner, i2, 2), z / radius)]);
        }
    };
    clamp(0, 1);
    if !half_length {
        clamp(n1 - 1, n1 - 2);
    }
    if half_length {
        for i2 in 0..n2 {
            all.push(vec![(at(n1 - 1, i2, 0), 1.0)]);
            all.extend((1..3).map(|c| vec![(at(n1 - 1, i2, c), 1.0), (at(n1 - 2, i2, c), -1.0)]));
        }
    }
    if half_arc {
        for i1 in 0..n1 {
            all.push(vec![(at(i1, 0, 1), 1.0)]);
            all.extend([0, 2].map(|c| vec![(at(i1, 0, c), 1.0), (at(i1, 1, c), -1.0)]));
        }
    }
    for (joint, before, after) in joints {
        for i1 in 0..n1 {
            all.extend((0..3).map(|c| {
                vec![
                    (at(i1, joint, c), 1.0),
                    (at(i1, joint - 1, c), -before / (before + after)),
                    (at(i1, joint + 1, c), -after / (before + after)),
                ]
            }));
        }
    }
    all
}

/// C⁰ joints along the arc: control index and the weights of equal derivatives on both sides. With A = Σ N w u and
/// W = Σ N w, u = A/W has the one-sided derivatives (p/Δ)(w₋/w)(u − u₋) and (p/Δ)(w₊/w)(u₊ − u) there.
fn joints(mesh: &Mesh) -> Vec<(usize, f64, f64)> {
    let degree = mesh.degree[1];
    let knots = &mesh.knots[1];
    let n2 = mesh.control_counts()[1];
    (degree + 1..n2)
        .filter(|k| knots[*k] < knots[k + 1] && knots[k + 1 - degree] == knots[*k])
        .map(|last| {
            // Knots last − p + 1 ..= last coincide: function last − p is 1 there.
            let joint = last - degree;
            let before = knots[last] - knots[last - degree];
            let after = knots[last + 1] - knots[last];
            (joint, mesh.control_points[joint - 1][3] / before, mesh.control_points[joint + 1][3] / after)
        })
        .collect()
}

/// Gaussian elimination: each eliminated component in terms of components that are not. Linear in the number of
/// constraints, since each shares components with few others.
fn eliminate(constraints: &[Expression]) -> BTreeMap<usize, Expression> {
    let mut order: Vec<usize> = Vec::new();
    let mut eliminated: BTreeMap<usize, Expression> = BTreeMap::new();
    for constraint in constraints {
        let row = expand(constraint, &eliminated);
        let Some((pivot, factor)) = largest(&row) else { continue };
        let rest = row.iter().filter(|(component, _)| **component != pivot).map(|(c, f)| (*c, -f / factor)).collect();
        eliminated.insert(pivot, rest);
        order.push(pivot);
    }
    // A component may have been eliminated after it was used: put its expression in, last first.
    for pivot in order.into_iter().rev() {
        let complete = expand(&eliminated[&pivot], &eliminated).into_iter().collect();
        eliminated.insert(pivot, complete);
    }
    eliminated
}

/// Replaces eliminated components until none is left; drops what cancels.
fn expand(expression: &Expression, eliminated: &BTreeMap<usize, Expression>) -> BTreeMap<usize, f64> {
    let mut sum: BTreeMap<usize, f64> = BTreeMap::new();
    let mut pending = expression.clone();
    while let Some((component, factor)) = pending.pop() {
        match eliminated.get(&component) {
            Some(replacement) => pending.extend(replacement.iter().map(|(c, f)| (*c, factor * f))),
            None => *sum.entry(component).or_default() += factor,
        }
    }
    sum.retain(|_, factor| factor.abs() > REDUNDANT);
    sum
}

/// The component with the largest factor; the first of equals.
fn largest(row: &BTreeMap<usize, f64>) -> Option<(usize, f64)> {
    row.iter().fold(None, |best: Option<(usize, f64)>, (component, factor)| match best {
        Some((_, other)) if other.abs() >= factor.abs() => best,
        _ => Some((*component, *factor)),
    })
}
