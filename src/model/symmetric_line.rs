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
use crate::model::elimination::Expression;
use crate::model::mirror::{ANGLE, Mirror, NoPlane};
use crate::model::soundness::POSITION;
use crate::model::supports::{Supports, along, in_plane};
use crate::shell::{add, cross, dot, norm, scaled, sub};
use crate::spline::{Mesh, basis_derivatives, basis_derivatives_len, find_span};
use crate::units::place;

/// Weighted sums of control points.
type Sums = Vec<Vec<(usize, f64)>>;

/// Shares of weights along a line that differ by less are rounding.
const EVEN: f64 = 1e-9;

/// A line of a mesh.
pub(super) struct Line {
    /// Its displacement: one sum for each of its control points as a curve; weights of 1 in all.
    places: Sums,
    /// The derivative of its displacement across it, alike, in parts of the largest weight.
    slopes: Sums,
}

impl Supports {
    /// No displacement across the plane of a line, and slopes that are even on both sides of it.
    pub(super) fn mirror_line(&mut self, index: usize, mesh: &Mesh, mirror: &Mirror) -> Result<(), ModelError> {
        let line = Line::new(mesh, mirror.way, mirror.parameter).map_err(|reason| ModelError::NotASymmetryPlane {
            support: mirror.support.clone(),
            reason: reason.to_string(),
        })?;
        let points: Vec<usize> = line.places.iter().chain(&line.slopes).flatten().map(|(point, _)| *point).collect();
        self.check_sections_keep(&points, mirror)?;
        let directed = |sum: &[(usize, f64)], direction: [f64; 3]| -> Expression {
            let of_point = |(point, factor): &(usize, f64)| along(*point, scaled(*factor, direction));
            sum.iter().flat_map(of_point).collect()
        };
        for (place, slope) in line.places.iter().zip(&line.slopes) {
            self.push(Some(index), directed(place, mirror.normal));
            let tangents = in_plane(mirror.normal);
            tangents.into_iter().for_each(|direction| self.push(Some(index), directed(slope, direction)));
        }
        let curve = sums_of(mesh, &line.places);
        let share = 1.0 / curve.len() as f64;
        let middle = curve.iter().fold([0.0; 3], |sum, x| add(sum, scaled(share, *x)));
        let trace = &mut self.traces[index];
        (trace.points, trace.pole, trace.is_inner_mirror) = (points, middle, true);
        Ok(())
    }
}

impl Line {
    /// The line on which the parameter of direction `way` has a value.
    ///
    /// # Errors
    /// Where no spline keeps its slope there.
    pub(super) fn new(mesh: &Mesh, way: usize, parameter: f64) -> Result<Self, NoPlane> {
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
            if (sum(&slope) - rate * total).abs() > EVEN * steepest {
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

    /// Unit normal of the plane of symmetry.
    ///
    /// # Errors
    /// Where it lies in none.
    pub(super) fn normal(&self, mesh: &Mesh) -> Result<[f64; 3], NoPlane> {
        let curve = sums_of(mesh, &self.places);
        let across = sums_of(mesh, &self.slopes);
        let steepest = across.iter().fold([0.0; 3], |best, x| if norm(*x) > norm(best) { *x } else { best });
        let normal = scaled(1.0 / norm(steepest), steepest);
        let off_axis = |slope: [f64; 3]| norm(cross(slope, normal)).atan2(dot(slope, normal));
        let angles = across.iter().map(|slope| off_axis(*slope)).zip(&curve);
        let (off, at) = angles.fold((0.0, &curve[0]), |worst, one| if one.0 > worst.0 { one } else { worst });
        if off > ANGLE {
            return Err(NoPlane::Skewed { off_deg: off.to_degrees(), at: place(*at) });
        }
        let size = curve.iter().map(|x| norm(sub(*x, curve[0]))).fold(norm(steepest), f64::max);
        let distances = curve.iter().map(|x| dot(sub(*x, curve[0]), normal).abs()).zip(&curve);
        let (off_mm, at) = distances.fold((0.0, &curve[0]), |worst, one| if one.0 > worst.0 { one } else { worst });
        match off_mm > POSITION * size {
            true => Err(NoPlane::NotPlane { off_mm, at: place(*at), tolerance_mm: POSITION * size }),
            false => Ok(normal),
        }
    }
}

/// Weighted sums of the control points, mm.
fn sums_of(mesh: &Mesh, sums: &Sums) -> Vec<[f64; 3]> {
    let of_sum = |sum: &Vec<(usize, f64)>| {
        sum.iter().fold([0.0; 3], |to, (point, factor)| {
            let [x, y, z, w] = mesh.control_points[*point];
            add(to, scaled(factor / w, [x, y, z]))
        })
    };
    sums.iter().map(of_sum).collect()
}
