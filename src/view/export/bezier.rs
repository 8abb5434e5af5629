//! Elements as rational Bézier patches: Bézier extraction by knot insertion up to multiplicity p at every knot (Borden, Scott,
//! Evans & Hughes, *Int. J. Numer. Meth. Engng* 87, 2011), and patches that interpolate a field.

use nalgebra::DMatrix;

use crate::spline::{Grid, Patch, Spans};

use super::whole_shell::{WholeShell, displacements};

/// The whole shell as one rational Bézier patch per element.
#[derive(Debug)]
pub(super) struct BezierPatches {
    /// Undeformed surface with every knot of multiplicity p: patches share the control points of their borders.
    pub(super) undeformed: Patch,
    /// Displacements of its control points, mm.
    pub(super) displacement: Vec<[f64; 3]>,
    spans: [Spans; 2],
    /// Bernstein polynomials at uniform points, in each direction.
    basis: [DMatrix<f64>; 2],
    /// Their inverses: values at these points to coefficients.
    interpolation: [DMatrix<f64>; 2],
}

impl BezierPatches {
    /// Extracts the patches of a shell.
    pub(super) fn of(shell: &WholeShell) -> Self {
        let [undeformed, deformed] = [shell.undeformed(), shell.deformed()].map(extracted);
        let displacement = displacements(&undeformed, &deformed).collect();
        let spans = [0, 1].map(|direction| Spans::of(&undeformed.knots[direction], undeformed.degree[direction]));
        let basis = undeformed.degree.map(bernstein_at_uniform_points);
        // Points that differ have one interpolating polynomial.
        let interpolation = basis.clone().map(|basis| basis.clone().try_inverse().unwrap_or(basis));
        Self { basis, interpolation, displacement, spans, undeformed }
    }

    /// The elements, the second direction fastest.
    pub(super) fn elements(&self) -> Grid {
        Grid::new([0, 1].map(|direction| self.spans[direction].count()))
    }

    /// The control points of a patch, the second direction fastest.
    pub(super) fn controls(&self) -> Grid {
        Grid::new(self.undeformed.degree.map(|degree| degree + 1))
    }

    /// Control points of the patch of an element.
    pub(super) fn of_element(&self, element: usize) -> impl Iterator<Item = usize> {
        let (place, [p1, p2]) = (self.elements().place(element), self.undeformed.degree);
        self.undeformed.window([place[0] * p1, place[1] * p2])
    }

    /// Bounds of an element in the parameters.
    pub(super) fn bounds(&self, element: usize) -> [[f64; 2]; 2] {
        let place = self.elements().place(element);
        [0, 1].map(|direction| self.spans[direction].bounds[place[direction]])
    }

    /// As many points as a patch has control points, uniformly over an element in the parameters, with its borders.
    pub(super) fn nodes(&self, element: usize) -> impl Iterator<Item = [f64; 2]> {
        let (grid, bounds, degree) = (self.controls(), self.bounds(element), self.undeformed.degree);
        (0..grid.len()).map(move |k| {
            let place = grid.place(k);
            [0, 1].map(|direction| {
                let [from, to] = bounds[direction];
                from + (to - from) * place[direction] as f64 / degree[direction] as f64
            })
        })
    }

    /// Coefficients of a rational patch, with the weights of the element, that has these values at the nodes.
    pub(super) fn interpolating(&self, element: usize, values: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let grid = self.controls();
        let weights: Vec<f64> = self.of_element(element).map(|k| self.undeformed.control_points[k][3]).collect();
        // Σ Bₐ wₐ cₐ = (Σ Bₐ wₐ) f at each node is linear in wₐ cₐ.
        let weight_at = self.at_nodes(&weights);
        let [along, across] = &self.interpolation;
        let components = [0, 1, 2].map(|c| {
            let weighted = DMatrix::from_fn(grid.counts[0], grid.counts[1], |i, j| {
                let k = grid.index([i, j]);
                weight_at[k] * values[k][c]
            });
            along * weighted * across.transpose()
        });
        let of_control = |k: usize| {
            let [i, j] = grid.place(k);
            [0, 1, 2].map(|c| components[c][(i, j)] / weights[k])
        };
        (0..grid.len()).map(of_control).collect()
    }

    /// The polynomial patch with these coefficients at the nodes.
    fn at_nodes(&self, coefficients: &[f64]) -> Vec<f64> {
        let grid = self.controls();
        let [along, across] = &self.basis;
        let values = along * DMatrix::from_row_slice(grid.counts[0], grid.counts[1], coefficients) * across.transpose();
        (0..grid.len()).map(|k| grid.place(k)).map(|[i, j]| values[(i, j)]).collect()
    }
}

/// The same surface with every inner knot of multiplicity p.
fn extracted(mesh: &Patch) -> Patch {
    let missing = [0, 1].map(|direction| {
        let groups = mesh.knots[direction].chunk_by(|a, b| a == b);
        let degree = mesh.degree[direction];
        groups.flat_map(|group| std::iter::repeat_n(group[0], degree.saturating_sub(group.len()))).collect()
    });
    mesh.with_knots(&missing)
}

/// Bernstein polynomials of a degree p at i/p: a row for each point.
fn bernstein_at_uniform_points(degree: usize) -> DMatrix<f64> {
    let choose = |k: usize| (0..k).fold(1.0, |product, i| product * (degree - i) as f64 / (i + 1) as f64);
    DMatrix::from_fn(degree + 1, degree + 1, |i, k| {
        let t = i as f64 / degree as f64;
        choose(k) * t.powi(k as i32) * (1.0 - t).powi((degree - k) as i32)
    })
}
