//! Position and rotation of a rigid section as functions of its control points, with two derivatives.
//!
//! The control points X̃ᵢ of the edges, from their mean, move with the section, so that for two directions e that they span the vectors
//! p, q = Σ wᵢ xᵢ are R e ([`SectionPoints`]). On a straight edge there is one such direction p; the shell's tangent beside the edge,
//! between a control point of the edge and the one next to it, may stretch and shear, but stays in the turned tangent plane, and is q.
//! From both follow the orthonormal vectors t = p/|p|, n = p × q/|p × q| and t × n, which are the undeformed ones turned by
//! R = Σ e_a E_aᵀ. All are functions of nine numbers: the mean displacement of the control points, p and q.
//!
//! The rotation vector of R is φ = g(c) v with c = cos φ = (tr R − 1)/2, the axial vector v = ½ Σ E_a × e_a of its skew part and
//! g(c) = arccos(c)/√(1 − c²), g′ = (c g − 1)/(1 − c²), g″ = (g + 3 c g′)/(1 − c²); near c = 1, with x = 1 − c,
//! g = Σ n!/(2n + 1)!! xⁿ.

use crate::energy::loads::SectionPoints;
use crate::model::ModelError;
use crate::shell::{FrameVector, TANGENTS, add, cross, dot, norm, scaled, sub};
use crate::spline::Mesh;

/// Number of components of the mean displacement, p and q together.
pub(super) const POSE: usize = 3 + TANGENTS;

/// Size of 1 − cos φ up to which g is summed up as a series: at φ = 25°, its terms fall by a factor of 20.
const NEARLY_UNTURNED: f64 = 0.1;
/// Terms of that series: the last one is below 1e-17 of the first.
const SERIES: usize = 16;

/// The pose of a rigid section as a function of its control points.
#[derive(Debug)]
pub(super) struct SectionFrame {
    /// Control points with their shares in the mean, p and q.
    pub points: Vec<(usize, [f64; 3])>,
    /// Mean of the undeformed control points of the edges, mm.
    mean: [f64; 3],
    /// p and q, undeformed.
    undeformed: [[f64; 3]; 2],
    /// t, t × n and n, undeformed.
    axes: [[f64; 3]; 3],
    /// Whether the control points determine the whole rotation, and not that of a line alone.
    turns: bool,
}

/// A point that moves with a section.
#[derive(Clone, Copy, Debug)]
pub(super) struct Carried {
    /// Where it is while the section is not moved, mm.
    pub position: [f64; 3],
    /// Components on the section's axes of its way from the mean of the control points, mm.
    arm: [f64; 3],
}

/// The pose of a section at some displacement.
pub(super) struct PoseAt {
    mean: [f64; 3],
    axes: [FrameVector; 3],
}

impl SectionFrame {
    /// Finds how the pose follows from the control points.
    pub fn new(section: &SectionPoints, mesh: &Mesh) -> Self {
        let share = 1.0 / section.points.len() as f64;
        let first = section.span.first().copied().unwrap_or([1.0, 0.0, 0.0]);
        let of_p = section.weights(first);
        let all = section.points.iter().zip(&of_p);
        let mut points: Vec<(usize, [f64; 3])> = all.map(|((point, _), w)| (*point, [share, *w, 0.0])).collect();
        let mut turns = true;
        let second = match (section.span.get(1), section.beside) {
            (Some(second), _) => {
                for ((_, shares), weight) in points.iter_mut().zip(section.weights(*second)) {
                    shares[2] = weight;
                }
                *second
            }
            (None, Some([at, beside])) => {
                let tangent = sub(mesh.point(beside), mesh.point(at));
                let per_mm = 1.0 / norm(tangent);
                points.push((at, [0.0, 0.0, -per_mm]));
                points.push((beside, [0.0, 0.0, per_mm]));
                scaled(per_mm, tangent)
            }
            (None, None) => {
                turns = false;
                let across = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|axis| cross(first, axis));
                across[usize::from(norm(across[1]) > norm(across[0]))]
            }
        };
        let undeformed = [first, second];
        let axes = axes_of(undeformed).map(|axis| axis.value);
        Self { points, mean: section.mean, undeformed, axes, turns }
    }

    /// A point that moves with the section.
    ///
    /// # Errors
    /// Where the control points do not determine where it moves; `what` says what acts on it.
    pub fn carried(&self, section: &str, position: [f64; 3], what: &'static str) -> Result<Carried, ModelError> {
        let way = sub(position, self.mean);
        let arm = self.axes.map(|axis| dot(axis, way));
        let is_off = arm[1].hypot(arm[2]) > OFF_LINE * arm[0].abs().max(1.0);
        match !self.turns && is_off {
            true => Err(ModelError::SectionWithoutExtent { section: section.to_owned(), what }),
            false => Ok(Carried { position, arm }),
        }
    }

    /// Whether the control points determine the whole rotation.
    pub fn turns(&self) -> bool {
        self.turns
    }

    /// The pose at a displacement of the control points.
    pub fn at(&self, displacement: &[[f64; 3]]) -> PoseAt {
        let rates = self.rates(displacement);
        let vectors = [0, 1].map(|k| add(self.undeformed[k], rates[k + 1]));
        PoseAt { mean: rates[0], axes: axes_of(vectors) }
    }

    /// Rates of the mean displacement, of p and of q at rates of the control points.
    pub fn rates(&self, rates: &[[f64; 3]]) -> [[f64; 3]; 3] {
        self.points.iter().fold([[0.0; 3]; 3], |sums, (point, shares)| {
            [0, 1, 2].map(|k| add(sums[k], scaled(shares[k], rates[*point])))
        })
    }

    /// The rotation vector of a pose.
    pub fn rotation(&self, pose: &PoseAt) -> FrameVector {
        rotation_vector(&self.axes, &pose.axes)
    }
}

/// Distance from the line of a straight edge, relative to that along it, up to which a point lies on it.
const OFF_LINE: f64 = 1e-6;

impl PoseAt {
    /// Displacement of a carried point, and its derivatives by p and q; by the mean displacement it has the unit matrix.
    pub fn displacement(&self, carried: &Carried, frame: &SectionFrame) -> FrameVector {
        let turned = FrameVector::combined(&self.axes, carried.arm);
        let value = add(self.mean, sub(add(frame.mean, turned.value), carried.position));
        FrameVector { value, ..turned }
    }
}

/// t, t × n and n.
fn axes_of(vectors: [[f64; 3]; 2]) -> [FrameVector; 3] {
    let normal = FrameVector::normal(vectors);
    let across = FrameVector::edge_normal(vectors, 0);
    [normal.cross(&across), across, normal]
}

/// The rotation vector that turns the vectors E_a into e_a.
fn rotation_vector(from: &[[f64; 3]; 3], to: &[FrameVector; 3]) -> FrameVector {
    let axial = |vector: &dyn Fn(&FrameVector) -> [f64; 3]| {
        let products = from.iter().zip(to).map(|(e, turned)| cross(*e, vector(turned)));
        scaled(0.5, products.fold([0.0; 3], add))
    };
    let trace = |vector: &dyn Fn(&FrameVector) -> [f64; 3]| -> f64 {
        0.5 * from.iter().zip(to).map(|(e, turned)| dot(*e, vector(turned))).sum::<f64>()
    };
    let cos = trace(&|turned| turned.value) - 0.5;
    let [g, slope, bend] = angle_over_sine(cos);
    let v = axial(&|turned| turned.value);
    let c_first: [f64; TANGENTS] = std::array::from_fn(|p| trace(&|turned| turned.first[p]));
    let v_first: [[f64; 3]; TANGENTS] = std::array::from_fn(|p| axial(&|turned| turned.first[p]));
    let first = std::array::from_fn(|p| add(scaled(slope * c_first[p], v), scaled(g, v_first[p])));
    let second = std::array::from_fn(|p| {
        std::array::from_fn(|q| {
            let c_second = trace(&|turned| turned.second[p][q]);
            let v_second = axial(&|turned| turned.second[p][q]);
            let mixed = add(scaled(c_first[p], v_first[q]), scaled(c_first[q], v_first[p]));
            let of_g = scaled(bend * c_first[p] * c_first[q] + slope * c_second, v);
            add(add(of_g, scaled(slope, mixed)), scaled(g, v_second))
        })
    });
    FrameVector { value: scaled(g, v), first, second }
}

/// g(c), g′(c) and g″(c).
fn angle_over_sine(cos: f64) -> [f64; 3] {
    let x = 1.0 - cos;
    if x > NEARLY_UNTURNED {
        let square = (1.0 - cos * cos).max(f64::MIN_POSITIVE);
        let g = cos.clamp(-1.0, 1.0).acos() / square.sqrt();
        let slope = (cos * g - 1.0) / square;
        return [g, slope, (g + 3.0 * cos * slope) / square];
    }
    let (mut g, mut slope, mut bend) = (1.0, 0.0, 0.0);
    let mut factor = 1.0;
    for n in 1..SERIES {
        let order = n as f64;
        factor *= order / (2.0 * order + 1.0);
        g += factor * x.powi(n as i32);
        slope -= factor * order * x.powi(n as i32 - 1);
        if n > 1 {
            bend += factor * order * (order - 1.0) * x.powi(n as i32 - 2);
        }
    }
    [g, slope, bend]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shell::basis_vector;

    #[test]
    fn the_series_continues_the_formula() {
        let x = NEARLY_UNTURNED;
        let [below, above] = [x * (1.0 - 1e-9), x * (1.0 + 1e-9)].map(|x| angle_over_sine(1.0 - x));
        for k in 0..3 {
            assert!((below[k] - above[k]).abs() < 1e-8, "{k}: {} {}", below[k], above[k]);
        }
        let angle = 2.0_f64;
        assert!((angle_over_sine(angle.cos())[0] - angle / angle.sin()).abs() < 1e-14);
    }

    /// Derivatives by finite differences, at several angles, and the vector against its rotation.
    #[test]
    fn a_rotation_vector_has_these_derivatives() {
        let from = [0, 1, 2].map(basis_vector);
        let vector = |at: [f64; TANGENTS]| {
            let [t, across, n] = axes_of([[at[0], at[1], at[2]], [at[3], at[4], at[5]]]);
            rotation_vector(&from, &[t, n, across])
        };
        for angle in [0.0_f64, 0.1, 1.2, 2.8] {
            let (sin, cos) = angle.sin_cos();
            // About z, with q along −z, stretched and sheared: t, n and t × n are the turned x, y and z.
            let at = [cos, sin, 0.0, 0.3 * cos, 0.3 * sin, -1.7];
            let here = vector(at);
            assert!(norm(sub(here.value, [0.0, 0.0, angle])) < 1e-12, "{angle}: {:?}", here.value);
            let step = 1e-6;
            for p in 0..TANGENTS {
                let beside = |sign: f64| {
                    let mut there = at;
                    there[p] += sign * step;
                    vector(there)
                };
                let (after, before) = (beside(1.0), beside(-1.0));
                for c in 0..3 {
                    let slope = (after.value[c] - before.value[c]) / (2.0 * step);
                    assert!((slope - here.first[p][c]).abs() < 1e-7, "{angle} {p} {c}: {slope} {}", here.first[p][c]);
                    for q in 0..TANGENTS {
                        let bend = (after.first[q][c] - before.first[q][c]) / (2.0 * step);
                        let found = here.second[p][q][c];
                        assert!(
                            (bend - found).abs() < 1e-5 * (1.0 + found.abs()),
                            "{angle} {p} {q} {c}: {bend} {found}"
                        );
                    }
                }
            }
        }
    }
}
