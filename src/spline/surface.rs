//! Points and derivatives of a tensor-product NURBS surface, for construction, pictures and tests; assembly has its
//! own tables.

use crate::spline::{Mesh, basis_derivatives, basis_derivatives_len, find_span};

/// A point of a surface: position and the five derivatives that a Kirchhoff–Love shell needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Position, mm.
    pub position: [f64; 3],
    /// Derivatives a₁, a₂, a₁₁, a₂₂, a₁₂ with respect to the parameters.
    pub derivatives: [[f64; 3]; 5],
}

/// Evaluates the rational basis functions at a point: `(first control index in each direction, values and five
/// derivatives)`. `functions[k][a₁ (p₂ + 1) + a₂]`, k = value, ,1 ,2 ,11 ,22 ,12.
pub fn evaluate_surface(mesh: &Mesh, parameters: [f64; 2]) -> ([usize; 2], [Vec<f64>; 6]) {
    let [p1, p2] = mesh.degree;
    let grid = mesh.grid();
    let span = [0, 1].map(|direction| find_span(&mesh.knots[direction], mesh.degree[direction], parameters[direction]));
    let mut along = vec![0.0; basis_derivatives_len(p1)];
    let mut across = vec![0.0; basis_derivatives_len(p2)];
    basis_derivatives(&mesh.knots[0], p1, span[0], parameters[0], &mut along);
    basis_derivatives(&mesh.knots[1], p2, span[1], parameters[1], &mut across);
    let first = [span[0] - p1, span[1] - p2];
    let mut weighted: [Vec<f64>; 6] = Default::default();
    let mut sums = [0.0; 6];
    for a1 in 0..=p1 {
        for a2 in 0..=p2 {
            let weight = mesh.control_points[grid.index([first[0] + a1, first[1] + a2])][3];
            let products = tensor_derivatives(&along, &across, [p1, p2], [a1, a2]);
            for k in 0..6 {
                weighted[k].push(weight * products[k]);
                sums[k] += weight * products[k];
            }
        }
    }
    for a in 0..(p1 + 1) * (p2 + 1) {
        let rational = quotient_derivatives([0, 1, 2, 3, 4, 5].map(|k| weighted[k][a]), sums);
        for k in 0..6 {
            weighted[k][a] = rational[k];
        }
    }
    (first, weighted)
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
pub fn mid_surface_point(mesh: &Mesh, displacement: &[[f64; 3]], parameters: [f64; 2]) -> SurfacePoint {
    let [point] = mid_surface_points(mesh, [displacement], parameters);
    point
}

/// Evaluates the same point of several surfaces that differ by the displacement of their control points.
pub fn mid_surface_points<const N: usize>(
    mesh: &Mesh,
    displacements: [&[[f64; 3]]; N],
    parameters: [f64; 2],
) -> [SurfacePoint; N] {
    let (first, functions) = evaluate_surface(mesh, parameters);
    displacements.map(|displacement| sum(mesh, displacement, first, &functions))
}

/// The sum of the control points around a point, moved by `displacement`, with their functions there.
fn sum(mesh: &Mesh, displacement: &[[f64; 3]], first: [usize; 2], functions: &[Vec<f64>; 6]) -> SurfacePoint {
    let mut sums = [[0.0; 3]; 6];
    for (a, index) in mesh.window(first).enumerate() {
        let [x, y, z] = mesh.point(index);
        let shift = displacement.get(index).copied().unwrap_or_default();
        let position = [x + shift[0], y + shift[1], z + shift[2]];
        for k in 0..6 {
            for c in 0..3 {
                sums[k][c] += functions[k][a] * position[c];
            }
        }
    }
    SurfacePoint { position: sums[0], derivatives: [sums[1], sums[2], sums[3], sums[4], sums[5]] }
}
