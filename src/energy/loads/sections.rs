//! Loads on rigid sections, as forces on the control points of their edges, which move as a rigid body.
//!
//! With the arms X̃ᵢ of the control points from their mean and S = Σ X̃ᵢ X̃ᵢᵀ, the weights wᵢ = X̃ᵢ · S⁺ e have Σ wᵢ = 0 and
//! Σ wᵢ xᵢ = R e for every unit vector e that the arms span. Forces M wᵢ f are therefore a couple with the potential −M f · (R e), and
//! the moment M (e × f). A force at a point c of the span has the weights 1/n + X̃ᵢ · S⁺ (c − mean).

use nalgebra::{Matrix3, Vector3};

use crate::energy::term::pairs_among;
use crate::energy::{At, Tangent, Term};
use crate::model::{EdgeRows, Member, ModelError, edge_rows};
use crate::scene::{Axis, History, Hold, Scene, ShellEdge, Support};
use crate::shell::{add, basis_vector, cross, dot, norm, scaled, sub};
use crate::spline::Mesh;

/// Extent of a section in a direction, relative to its largest one, below which it has none.
const FLAT: f64 = 1e-6;

/// Whether a section lies where both parameters are below `limits`.
///
/// # Errors
/// Where it lies on both sides of such a line.
pub(in crate::energy) fn is_below(scene: &Scene, section: &str, limits: [f64; 2]) -> Result<bool, ModelError> {
    let edges = scene.supports.iter().filter(|support| support.name == section).flat_map(Support::edges);
    for ShellEdge { edge, .. } in edges {
        let (direction, at_end) = edge.side();
        let across = direction.index();
        if limits[1 - across].is_finite() {
            return Err(ModelError::SectionAcross { section: section.to_owned() });
        }
        if limits[across].is_finite() {
            return Ok(!at_end);
        }
    }
    Ok(true)
}

/// The control points of a rigid section.
#[derive(Debug)]
pub(in crate::energy) struct SectionPoints {
    pub points: Vec<(usize, [f64; 3])>,
    pub mean: [f64; 3],
    /// Reference point of the section, undeformed, mm.
    pub reference: [f64; 3],
    /// A control point of the edge and the one next to it, which lies along the tangent of the shell there, where the shell's normal
    /// turns with the section.
    pub beside: Option<[usize; 2]>,
    /// Pseudo-inverse of S.
    inverse: Matrix3<f64>,
    /// Orthonormal vectors that the arms span.
    pub span: Vec<[f64; 3]>,
}

impl SectionPoints {
    /// Finds the control points of the support of this name.
    ///
    /// # Errors
    /// Where there is no such section, or its surface has no normal.
    pub fn of(scene: &Scene, mesh: &Mesh, members: &[Member], section: &str) -> Result<Self, ModelError> {
        let support = scene.supports.iter().find(|support| support.name == section);
        let no_such = || ModelError::NoSuchSupport { support: section.to_owned() };
        let support = support.ok_or_else(no_such)?;
        let rows_of = |ShellEdge { shell, edge }: ShellEdge| {
            let member = &members[shell];
            Ok(edge_rows(member.patch, edge)?.shifted(member.points.start))
        };
        let rows = EdgeRows::joined(support.edges().map(rows_of))?.ok_or_else(no_such)?;
        let points: Vec<(usize, [f64; 3])> = rows.outer.iter().map(|point| (*point, mesh.point(*point))).collect();
        let reference = match &support.hold {
            Hold::Rigid { reference_mm: Some(reference), .. } => *reference,
            _ => rows.centroid,
        };
        let normals_turn = matches!(support.hold, Hold::Rigid { normals_turn: true, .. });
        let beside = normals_turn.then(|| [rows.outer[0], rows.inner[0]]);
        Ok(Self { beside, ..Self::new(points, reference) })
    }

    fn new(points: Vec<(usize, [f64; 3])>, reference: [f64; 3]) -> Self {
        let share = 1.0 / points.len() as f64;
        let mean = points.iter().fold([0.0; 3], |sum, (_, x)| add(sum, scaled(share, *x)));
        let mut square = Matrix3::zeros();
        for (_, x) in &points {
            let arm = Vector3::from(sub(*x, mean));
            square += arm * arm.transpose();
        }
        let eigen = square.symmetric_eigen();
        let most = eigen.eigenvalues.max();
        let mut inverse = Matrix3::zeros();
        let mut span = Vec::new();
        for k in (0..3).filter(|k| eigen.eigenvalues[*k] > FLAT * FLAT * most) {
            let vector = eigen.eigenvectors.column(k);
            inverse += vector * vector.transpose() / eigen.eigenvalues[k];
            span.push([vector[0], vector[1], vector[2]]);
        }
        Self { points, mean, reference, beside: None, inverse, span }
    }

    /// Weights of the control points whose sum of positions is R e.
    pub fn weights(&self, direction: [f64; 3]) -> Vec<f64> {
        let inner = self.inverse * Vector3::from(direction);
        self.points.iter().map(|(_, x)| Vector3::from(sub(*x, self.mean)).dot(&inner)).collect()
    }

    /// How far a vector is from what the arms span, relative to its length.
    fn outside(&self, vector: [f64; 3]) -> f64 {
        let inside = self.span.iter().fold([0.0; 3], |sum, axis| add(sum, scaled(dot(*axis, vector), *axis)));
        let rest = sub(vector, inside);
        (dot(rest, rest) / dot(vector, vector).max(f64::MIN_POSITIVE)).sqrt()
    }

    /// Forces on the control points that are a force at the reference point.
    ///
    /// # Errors
    /// Where the reference point lies outside of what the edges span.
    pub fn force(&self, section: &str, force: [f64; 3]) -> Result<Vec<(usize, [f64; 3])>, ModelError> {
        let arm = sub(self.reference, self.mean);
        // The mean itself is a point of the span, whatever rounding makes of the arm.
        let size = self.points.iter().map(|(_, x)| norm(sub(*x, self.mean))).fold(0.0, f64::max);
        if norm(arm) > FLAT * size && self.outside(arm) > FLAT {
            return Err(ModelError::SectionWithoutExtent {
                section: section.to_owned(),
                what: "its reference point lies off its edges, and a force",
            });
        }
        let share = 1.0 / self.points.len() as f64;
        let weights = self.weights(arm);
        Ok(self
            .points
            .iter()
            .zip(weights)
            .map(|((point, _), weight)| (*point, scaled(share + weight, force)))
            .collect())
    }

    /// Weights of a couple that acts about an axis with forces along another one.
    ///
    /// # Errors
    /// Where both are one axis, or the section has no extent along the arms.
    fn couple(&self, section: &str, about: Axis, along: Axis) -> Result<Vec<f64>, ModelError> {
        let arms = cross(unit(along), unit(about));
        if dot(arms, arms) == 0.0 {
            return Err(ModelError::SectionWithoutExtent {
                section: section.to_owned(),
                what: "a moment about the axis of its own forces",
            });
        }
        if self.outside(arms) > FLAT {
            return Err(ModelError::SectionWithoutExtent {
                section: section.to_owned(),
                what: "it has no extent along the arms of the moment, which",
            });
        }
        Ok(self.weights(arms))
    }

    /// Forces on the control points that are a dead moment.
    ///
    /// # Errors
    /// As for a couple.
    pub fn dead_moment(
        &self,
        section: &str,
        moment: f64,
        [about, along]: [Axis; 2],
    ) -> Result<Vec<(usize, [f64; 3])>, ModelError> {
        let weights = self.couple(section, about, along)?;
        let force = |((point, _), weight): (&(usize, [f64; 3]), f64)| (*point, scaled(moment * weight, unit(along)));
        Ok(self.points.iter().zip(weights).map(force).collect())
    }

    /// The couple whose forces turn with the section.
    ///
    /// # Errors
    /// As for a couple, and where the control points lie on a line.
    pub(super) fn turning_moment(
        &self,
        section: &str,
        moment: f64,
        [about, along]: [Axis; 2],
        history: History,
    ) -> Result<TurningCouple, ModelError> {
        let weights = self.couple(section, about, along)?;
        let [first, second, ..] = self.span[..] else {
            return Err(ModelError::SectionWithoutExtent {
                section: section.to_owned(),
                what: "its edges lie on a line, and a moment that turns with it",
            });
        };
        let third = cross(first, second);
        let frame = [first, second].map(|axis| self.weights(axis));
        let direction = [first, second, third].map(|axis| dot(axis, unit(along)));
        let forces = weights.into_iter().map(|weight| moment * weight).collect();
        Ok(TurningCouple { history, points: self.points.clone(), forces, frame, direction })
    }
}

fn unit(axis: Axis) -> [f64; 3] {
    basis_vector(axis as usize)
}

/// A moment on a rigid section whose forces turn with it.
#[derive(Debug)]
pub(super) struct TurningCouple {
    history: History,
    /// Control points with their undeformed positions, mm.
    points: Vec<(usize, [f64; 3])>,
    /// Forces at factor 1, N.
    forces: Vec<f64>,
    /// Weights of two unit vectors of the section.
    frame: [Vec<f64>; 2],
    /// Components of the direction of the forces on these two and on their vector product.
    direction: [f64; 3],
}

impl TurningCouple {
    /// The two unit vectors as the section stands.
    fn axes(&self, displacement: &[[f64; 3]]) -> [[f64; 3]; 2] {
        self.frame.each_ref().map(|weights| {
            let terms = self.points.iter().zip(weights);
            terms.fold([0.0; 3], |sum, ((point, x), weight)| add(sum, scaled(*weight, add(*x, displacement[*point]))))
        })
    }

    fn turned(&self, displacement: &[[f64; 3]]) -> [f64; 3] {
        let [one, other] = self.axes(displacement);
        let [a, b, c] = self.direction;
        add(add(scaled(a, one), scaled(b, other)), scaled(c, cross(one, other)))
    }

    fn add(&self, displacement: &[[f64; 3]], factor: f64, forces: &mut [[f64; 3]]) {
        let direction = self.turned(displacement);
        for ((point, _), force) in self.points.iter().zip(&self.forces) {
            forces[*point] = add(forces[*point], scaled(factor * force, direction));
        }
    }
}

impl Term for TurningCouple {
    fn pairs(&self) -> Vec<[usize; 2]> {
        pairs_among(self.points.iter().map(|(point, _)| *point))
    }

    fn add_forces(&self, at: At, forces: &mut [[f64; 3]]) {
        self.add(at.displacement, self.history.at(at.parameter), forces);
    }

    fn has_tangent(&self) -> bool {
        true
    }

    fn has_skew(&self) -> bool {
        true
    }

    fn add_tangent(&self, at: At, tangent: &mut Tangent) {
        self.add_slopes(at, self.history.at(at.parameter), tangent);
    }

    /// The load grows; what its motion changes is of second order.
    fn add_stress_stiffness(&self, at: At, _: &[[f64; 3]], tangent: &mut Tangent) {
        self.add_slopes(at, self.history.rate(at.parameter), tangent);
    }

    fn add_rates(&self, at: At, rates: &mut [[f64; 3]]) {
        self.add(at.displacement, self.history.rate(at.parameter), rates);
    }

    /// The mean of the forces before and after times the motion.
    fn strokes(&self, _: &Mesh, from: &[[f64; 3]], to: &[[f64; 3]]) -> Vec<f64> {
        let mean = scaled(0.5, add(self.turned(from), self.turned(to)));
        let stroke = |((point, _), force): (&(usize, [f64; 3]), &f64)| force * dot(mean, sub(to[*point], from[*point]));
        vec![self.points.iter().zip(&self.forces).map(stroke).sum()]
    }

    fn factors(&self, parameter: f64) -> Vec<f64> {
        vec![self.history.at(parameter)]
    }
}

impl TurningCouple {
    fn add_slopes(&self, at: At, factor: f64, tangent: &mut Tangent) {
        let [one, other] = self.axes(at.displacement);
        let [a, b, c] = self.direction;
        for (j, (moved, _)) in self.points.iter().enumerate() {
            let (w1, w2) = (self.frame[0][j], self.frame[1][j]);
            // Columns of the derivative of the direction by the position of this control point.
            let columns = [0, 1, 2].map(|d| {
                let straight = scaled(a * w1 + b * w2, basis_vector(d));
                let turned = add(scaled(w1, cross(basis_vector(d), other)), scaled(w2, cross(one, basis_vector(d))));
                add(straight, scaled(c, turned))
            });
            for ((point, _), force) in self.points.iter().zip(&self.forces) {
                let slope = [0, 1, 2].map(|c| [0, 1, 2].map(|d| factor * force * columns[d][c]));
                tangent.add([*point, *moved], slope);
            }
        }
    }
}
