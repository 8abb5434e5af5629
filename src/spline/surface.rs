//! Points and derivatives of a tensor-product NURBS surface, for construction, pictures and tests; assembly has its
//! own tables.

use super::basis::MAX_DEGREE;
use crate::spline::{Patch, basis_derivatives, basis_derivatives_len, find_span};

/// A point of a surface: position and the five derivatives that a Kirchhoff–Love shell needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Position, mm.
    pub position: [f64; 3],
    /// Derivatives a₁, a₂, a₁₁, a₂₂, a₁₂ with respect to the parameters.
    pub derivatives: [[f64; 3]; 5],
}

/// Most basis functions that do not vanish at a point, one way and both.
const MOST_EACH_WAY: usize = MAX_DEGREE + 1;
const MOST: usize = MOST_EACH_WAY * MOST_EACH_WAY;

/// The basis functions of one direction that do not vanish at a parameter, with two derivatives.
#[derive(Clone, Copy, Debug)]
pub struct LineBasis {
    /// The parameter.
    pub parameter: f64,
    first: usize,
    derivatives: [f64; 3 * MOST_EACH_WAY],
}

impl LineBasis {
    /// Evaluates the functions of a direction of a mesh.
    pub fn at(patch: &Patch, direction: usize, parameter: f64) -> Self {
        let (knots, degree) = (&patch.knots[direction], patch.degree[direction]);
        let span = find_span(knots, degree, parameter);
        let mut derivatives = [0.0; 3 * MOST_EACH_WAY];
        basis_derivatives(knots, degree, span, parameter, &mut derivatives[..basis_derivatives_len(degree)]);
        Self { parameter, first: span - degree, derivatives }
    }
}

/// The rational basis functions that do not vanish at a point, with the derivatives that a shell needs.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceBasis {
    /// First control index in each direction.
    first: [usize; 2],
    /// `functions[k][a₁ (p₂ + 1) + a₂]`, k = value, ,1 ,2 ,11 ,22 ,12.
    functions: [[f64; MOST]; 6],
    count: usize,
}

impl SurfaceBasis {
    /// Evaluates the functions at a point of the parameters.
    pub fn at(patch: &Patch, parameters: [f64; 2]) -> Self {
        let [along, across] = [0, 1].map(|direction| LineBasis::at(patch, direction, parameters[direction]));
        Self::of(patch, &along, &across)
    }

    /// Evaluates the functions where two lines of the parameters meet.
    pub fn of(patch: &Patch, along: &LineBasis, across: &LineBasis) -> Self {
        let [p1, p2] = patch.degree;
        let first = [along.first, across.first];
        let (mut functions, mut sums) = ([[0.0; MOST]; 6], [0.0; 6]);
        let count = (p1 + 1) * (p2 + 1);
        for (a, index) in patch.window(first).enumerate() {
            let weight = patch.control_points[index][3];
            let place = [a / (p2 + 1), a % (p2 + 1)];
            let products = tensor_derivatives(&along.derivatives, &across.derivatives, [p1, p2], place);
            for k in 0..6 {
                functions[k][a] = weight * products[k];
                sums[k] += weight * products[k];
            }
        }
        for a in 0..count {
            let rational = quotient_derivatives([0, 1, 2, 3, 4, 5].map(|k| functions[k][a]), sums);
            for k in 0..6 {
                functions[k][a] = rational[k];
            }
        }
        Self { first, functions, count }
    }

    /// The point of the surface whose control points are moved by `displacement` (in their order; empty for the undeformed
    /// surface).
    pub fn point(&self, patch: &Patch, displacement: &[[f64; 3]]) -> SurfacePoint {
        let mut sums = [[0.0; 3]; 6];
        for (a, index) in patch.window(self.first).enumerate() {
            let position = moved(patch, displacement, index);
            for k in 0..6 {
                for c in 0..3 {
                    sums[k][c] += self.functions[k][a] * position[c];
                }
            }
        }
        SurfacePoint { position: sums[0], derivatives: [sums[1], sums[2], sums[3], sums[4], sums[5]] }
    }
}

/// Evaluates the position, mm, of a surface where two lines of the parameters meet; [`SurfaceBasis::point`] gives the same.
pub fn position_on_lines(patch: &Patch, displacement: &[[f64; 3]], [along, across]: [&LineBasis; 2]) -> [f64; 3] {
    let columns = patch.degree[1] + 1;
    let (mut weighted, mut sum) = ([0.0; MOST], 0.0);
    for (a, index) in patch.window([along.first, across.first]).enumerate() {
        let product = along.derivatives[a / columns] * across.derivatives[a % columns];
        weighted[a] = patch.control_points[index][3] * product;
        sum += weighted[a];
    }
    let mut position = [0.0; 3];
    for (a, index) in patch.window([along.first, across.first]).enumerate() {
        let (function, point) = (weighted[a] / sum, moved(patch, displacement, index));
        for c in 0..3 {
            position[c] += function * point[c];
        }
    }
    position
}

/// A control point where its displacement takes it, mm.
fn moved(patch: &Patch, displacement: &[[f64; 3]], index: usize) -> [f64; 3] {
    let [x, y, z] = patch.point(index);
    let shift = displacement.get(index).copied().unwrap_or_default();
    [x + shift[0], y + shift[1], z + shift[2]]
}

/// Evaluates the rational basis functions at a point: `(first control index in each direction, values and five
/// derivatives)`. `functions[k][a₁ (p₂ + 1) + a₂]`, k = value, ,1 ,2 ,11 ,22 ,12.
pub fn evaluate_surface(patch: &Patch, parameters: [f64; 2]) -> ([usize; 2], [Vec<f64>; 6]) {
    let SurfaceBasis { first, functions, count } = SurfaceBasis::at(patch, parameters);
    (first, functions.map(|values| values[..count].to_vec()))
}

/// Computes a product N₁N₂ of basis functions and its derivatives ,1 ,2 ,11 ,22 ,12.
pub fn tensor_derivatives(along: &[f64], across: &[f64], degree: [usize; 2], a: [usize; 2]) -> [f64; 6] {
    let u = |k: usize| along[k * (degree[0] + 1) + a[0]];
    let v = |k: usize| across[k * (degree[1] + 1) + a[1]];
    [u(0) * v(0), u(1) * v(0), u(0) * v(1), u(2) * v(0), u(0) * v(2), u(1) * v(1)]
}

/// Computes the derivatives of f / w from those of f and w (value, ,1 ,2 ,11 ,22 ,12), by the quotient rule.
pub fn quotient_derivatives(f: [f64; 6], w: [f64; 6]) -> [f64; 6] {
    let value = f[0] / w[0];
    let d1 = (f[1] - value * w[1]) / w[0];
    let d2 = (f[2] - value * w[2]) / w[0];
    let d11 = (f[3] - 2.0 * d1 * w[1] - value * w[3]) / w[0];
    let d22 = (f[4] - 2.0 * d2 * w[2] - value * w[4]) / w[0];
    let d12 = (f[5] - d1 * w[2] - d2 * w[1] - value * w[5]) / w[0];
    [value, d1, d2, d11, d22, d12]
}

/// Evaluates a point of the surface whose control points are moved by `displacement` (in their order; empty for the
/// undeformed surface).
pub fn mid_surface_point(patch: &Patch, displacement: &[[f64; 3]], parameters: [f64; 2]) -> SurfacePoint {
    SurfaceBasis::at(patch, parameters).point(patch, displacement)
}

/// Evaluates the same point of several surfaces that differ by the displacement of their control points.
pub fn mid_surface_points<const N: usize>(
    patch: &Patch,
    displacements: [&[[f64; 3]]; N],
    parameters: [f64; 2],
) -> [SurfacePoint; N] {
    let basis = SurfaceBasis::at(patch, parameters);
    displacements.map(|displacement| basis.point(patch, displacement))
}
