//! Planes of symmetry through lines inside the shell.
//!
//! On the line ξ = ξ₀ a field that is even about the plane has no component across it, and the derivative ∂u/∂ξ has none
//! in it. With u = A/W, A = Σ N_i(ξ) M_j(η) w_ij u_ij and W alike, both are conditions on splines in η,
//!
//! A_⊥ = 0 and (A_,ξ − (W_,ξ/W) A)_∥ = 0,
//!
//! of which the second is one only where W_,ξ/W = c is the same all along the line. Then they hold on the whole line exactly
//! where they hold for each j, whether a knot stands at ξ₀ or not: Σ_i N_i w_ij u_ij,⊥ = 0 and Σ_i (N_i′ − c N_i) w_ij u_ij,∥ = 0.
//! The undeformed surface must meet them itself; then so does the deformed one, at any rotation.

use crate::model::ModelError;
use crate::model::edge::{NoPlane, PLANE};
use crate::model::elimination::Expression;
use crate::model::place::parameters_of;
use crate::model::supports::{Supports, along, in_plane};
use crate::scene::{ParametricDirection, Scene};
use crate::shell::{add, cross, dot, norm, scaled, sub};
use crate::spline::{Mesh, basis_derivatives, basis_derivatives_len, find_span};

/// Weighted sums of control points.
type Sums = Vec<Vec<(usize, f64)>>;

/// A line of a mesh.
struct Line {
    /// Its displacement: one sum for each of its control points as a curve; weights of 1 in all.
    places: Sums,
    /// The derivative of its displacement across it, alike, in parts of the largest weight.
    slopes: Sums,
}

impl Supports {
    /// No displacement across the plane of a line, and slopes that are even on both sides of it.
    pub(super) fn mirror_line(
        &mut self,
        index: usize,
        scene: &Scene,
        mesh: &Mesh,
        direction: ParametricDirection,
        fraction: f64,
    ) -> Result<(), ModelError> {
        let way = if direction == ParametricDirection::U { 0 } else { 1 };
        let parameter = parameters_of(&scene.geometry, [fraction; 2])[way];
        let no_plane = |reason: NoPlane| ModelError::NotASymmetryPlane {
            support: self.traces[index].name.clone(),
            reason: reason.to_string(),
        };
        let line = Line::new(mesh, way, parameter).map_err(no_plane)?;
        let (normal, middle) = line.plane(mesh).map_err(no_plane)?;
        let points: Vec<usize> = line.places.iter().chain(&line.slopes).flatten().map(|(point, _)| *point).collect();
        self.check_sections_keep(index, &points, normal)?;
        let directed = |sum: &[(usize, f64)], direction: [f64; 3]| -> Expression {
            let of_point = |(point, factor): &(usize, f64)| along(*point, scaled(*factor, direction));
            sum.iter().flat_map(of_point).collect()
        };
        for (place, slope) in line.places.iter().zip(&line.slopes) {
            self.push(Some(index), directed(place, normal));
            in_plane(normal).into_iter().for_each(|direction| self.push(Some(index), directed(slope, direction)));
        }
        let trace = &mut self.traces[index];
        (trace.points, trace.pole, trace.is_inner_mirror) = (points, middle, true);
        Ok(())
    }
}

impl Line {
    fn new(mesh: &Mesh, way: usize, parameter: f64) -> Result<Self, NoPlane> {
        let degree = mesh.degree[way];
        let span = find_span(&mesh.knots[way], degree, parameter);
        let mut basis = vec![0.0; basis_derivatives_len(degree)];
        basis_derivatives(&mesh.knots[way], degree, span, parameter, &mut basis);
        let (values, slopes) = basis.split_at(degree + 1);
        let [n1, n2] = mesh.control_counts();
        let running = if way == 0 { n2 } else { n1 };
        let mut line = Self { places: Vec::new(), slopes: Vec::new() };
        let mut rate = None;
        for j in 0..running {
            let control = |a: usize| if way == 0 { (span - degree + a) * n2 + j } else { j * n2 + span - degree + a };
            let weighted = |basis: &[f64]| -> Vec<(usize, f64)> {
                let weight = |a: usize| mesh.control_points[control(a)][3];
                (0..=degree).map(|a| (control(a), basis[a] * weight(a))).collect()
            };
            let (value, slope) = (weighted(values), weighted(slopes));
            let sum = |terms: &[(usize, f64)]| terms.iter().map(|(_, factor)| factor).sum::<f64>();
            let steepest = slope.iter().map(|(_, factor)| factor.abs()).fold(0.0, f64::max);
            let total = sum(&value);
            let rate = *rate.get_or_insert(sum(&slope) / total);
            if (sum(&slope) - rate * total).abs() > PLANE * steepest {
                return Err(NoPlane::UnevenWeights);
            }
            let even = slope
                .iter()
                .zip(&value)
                .map(|((point, slope), (_, value))| (*point, (slope - rate * value) / steepest));
            line.slopes.push(even.filter(|(_, factor)| *factor != 0.0).collect());
            line.places
                .push(value.iter().map(|(point, value)| (*point, value / total)).filter(|(_, f)| *f != 0.0).collect());
        }
        Ok(line)
    }

    /// Unit normal of the plane of symmetry, and the mean of the line's control points, mm.
    fn plane(&self, mesh: &Mesh) -> Result<([f64; 3], [f64; 3]), NoPlane> {
        let at = |sum: &Vec<(usize, f64)>| {
            sum.iter().fold([0.0; 3], |to, (point, factor)| {
                let [x, y, z, w] = mesh.control_points[*point];
                add(to, scaled(factor / w, [x, y, z]))
            })
        };
        let curve: Vec<[f64; 3]> = self.places.iter().map(at).collect();
        let across: Vec<[f64; 3]> = self.slopes.iter().map(at).collect();
        let steepest = across.iter().fold([0.0; 3], |best, x| if norm(*x) > norm(best) { *x } else { best });
        let normal = scaled(1.0 / norm(steepest), steepest);
        let size = curve.iter().map(|x| norm(sub(*x, curve[0]))).fold(norm(steepest), f64::max);
        if across.iter().any(|slope| norm(cross(*slope, normal)) > PLANE * norm(steepest)) {
            return Err(NoPlane::Skewed);
        }
        if curve.iter().any(|x| dot(sub(*x, curve[0]), normal).abs() > PLANE * size) {
            return Err(NoPlane::NotPlane);
        }
        let share = 1.0 / curve.len() as f64;
        Ok((normal, curve.iter().fold([0.0; 3], |sum, x| add(sum, scaled(share, *x)))))
    }
}
