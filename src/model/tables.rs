//! Shape functions and the undeformed shell at every quadrature point of a mesh.

use rayon::prelude::*;

use crate::scene::{Quadrature, Scene};
use crate::shell::{PointBatch, PointReference, gauss_legendre};
use crate::spline::{
    Mesh, Spans, basis_derivatives, basis_derivatives_len, find_span, quotient_derivatives, tensor_derivatives,
};

/// Basis functions are padded to a multiple of this, so that kernels work on whole vectors of any width.
pub(crate) const LANES: usize = 8;

/// Points that kernels work on at once.
pub(crate) const BATCH: usize = 4;

/// Tables of a mesh. Elements are ordered with the second direction fastest, points within an element likewise.
#[derive(Debug)]
pub struct Tables {
    /// Elements each way.
    pub elements: [usize; 2],
    /// First control index of each element, each way.
    pub first: [Vec<usize>; 2],
    /// Quadrature points of an element.
    pub points_per_element: usize,
    /// (p₁ + 1)(p₂ + 1).
    pub functions_per_element: usize,
    /// The same, padded to a multiple of 8; the padding holds zeros.
    pub padded: usize,
    /// `functions[((element · points + point) · 5 + k) · padded + a]`: derivative k (,1 ,2 ,11 ,22 ,12) of function
    /// a = a₁ (p₂ + 1) + a₂.
    pub functions: Vec<f64>,
    /// `points[element · points_per_element + point]`.
    pub points: Vec<PointReference>,
    /// The same points by fours, the last of an element's with what is left.
    pub batches: Vec<PointBatch>,
    /// Reference length of each element each way through its middle, mm.
    pub lengths: Vec<[f64; 2]>,
}

impl Tables {
    /// Tables for the scene's quadrature and material on a mesh.
    pub fn new(scene: &Scene, mesh: &Mesh) -> Self {
        Self::on_elements_of(scene, mesh, mesh)
    }

    /// Tables of the functions of `mesh` at the quadrature points of the elements of `finer`, which is `mesh` with
    /// knots inserted: what a displacement on `mesh` has for an energy where `finer` is integrated.
    pub fn on_elements_of(scene: &Scene, mesh: &Mesh, finer: &Mesh) -> Self {
        let spans = [0, 1].map(|k| {
            let mut spans = Spans::of(&finer.knots[k], mesh.degree[k]);
            for (index, [from, to]) in spans.index.iter_mut().zip(&spans.bounds) {
                *index = find_span(&mesh.knots[k], mesh.degree[k], 0.5 * (from + to));
            }
            spans
        });
        let rules = mesh.degree.map(|degree| {
            gauss_legendre(match scene.mesh.quadrature {
                Quadrature::Full => degree + 1,
                Quadrature::Reduced => degree,
            })
        });
        let directions = [0, 1].map(|k| Direction::new(mesh, k, &spans[k], &rules[k]));
        let elements = [spans[0].count(), spans[1].count()];
        let points_per_element = rules[0].len() * rules[1].len();
        let functions_per_element = (mesh.degree[0] + 1) * (mesh.degree[1] + 1);
        let padded = functions_per_element.next_multiple_of(LANES);
        let count = elements[0] * elements[1];
        let mut functions = vec![0.0; count * points_per_element * 5 * padded];
        let built: Vec<(Vec<PointReference>, [f64; 2])> = functions
            .par_chunks_mut(points_per_element * 5 * padded)
            .enumerate()
            .map(|(element, out)| {
                let at = [element / elements[1], element % elements[1]];
                element_tables(scene, mesh, &directions, at, padded, out)
            })
            .collect();
        let lengths = built.iter().map(|(_, length)| *length).collect();
        let points: Vec<PointReference> = built.into_iter().flat_map(|(points, _)| points).collect();
        let of_element = points.par_chunks(points_per_element);
        let batches = of_element.flat_map_iter(|points| points.chunks(BATCH).map(PointBatch::new)).collect();
        let first = [0, 1].map(|k| spans[k].index.iter().map(|s| s - mesh.degree[k]).collect());
        Self { elements, first, points_per_element, functions_per_element, padded, functions, points, batches, lengths }
    }

    /// Functions of all points of an element: `points_per_element · 5 · padded` numbers.
    pub fn element_functions(&self, element: usize) -> &[f64] {
        let size = self.points_per_element * 5 * self.padded;
        &self.functions[element * size..][..size]
    }

    /// Reference points of an element.
    pub fn element_points(&self, element: usize) -> &[PointReference] {
        &self.points[element * self.points_per_element..][..self.points_per_element]
    }

    /// The same points by fours.
    pub fn element_batches(&self, element: usize) -> &[PointBatch] {
        let count = self.points_per_element.div_ceil(BATCH);
        &self.batches[element * count..][..count]
    }
}

/// One direction: basis functions at the Gauss points of each element.
struct Direction {
    first: Vec<usize>,
    /// Size in the parameter of each element.
    sizes: Vec<f64>,
    /// Gauss weights on [−1, 1].
    weights: Vec<f64>,
    /// `basis[element][point]` as [`basis_derivatives`] fills it.
    basis: Vec<Vec<Vec<f64>>>,
}

impl Direction {
    fn new(mesh: &Mesh, direction: usize, spans: &Spans, rule: &[[f64; 2]]) -> Self {
        let degree = mesh.degree[direction];
        let knots = &mesh.knots[direction];
        let at_points = |span: usize, [from, to]: [f64; 2]| {
            rule.iter()
                .map(|[node, _]| {
                    let mut basis = vec![0.0; basis_derivatives_len(degree)];
                    let parameter = 0.5 * (from + to) + 0.5 * (to - from) * node;
                    basis_derivatives(knots, degree, span, parameter, &mut basis);
                    basis
                })
                .collect()
        };
        Self {
            first: spans.index.iter().map(|span| span - degree).collect(),
            sizes: spans.bounds.iter().map(|[from, to]| to - from).collect(),
            weights: rule.iter().map(|[_, weight]| *weight).collect(),
            basis: spans.index.iter().zip(&spans.bounds).map(|(span, bounds)| at_points(*span, *bounds)).collect(),
        }
    }
}

/// Fills the functions of an element; returns its points and its lengths each way.
fn element_tables(
    scene: &Scene,
    mesh: &Mesh,
    directions: &[Direction; 2],
    at: [usize; 2],
    padded: usize,
    out: &mut [f64],
) -> (Vec<PointReference>, [f64; 2]) {
    let [d1, d2] = directions;
    let [p1, p2] = mesh.degree;
    let n2 = mesh.control_counts()[1];
    let (size1, size2) = (d1.sizes[at[0]], d2.sizes[at[1]]);
    let mut points = Vec::new();
    let mut lengths = [0.0; 2];
    for (q1, weight1) in d1.weights.iter().enumerate() {
        for (q2, weight2) in d2.weights.iter().enumerate() {
            let (along, across) = (&d1.basis[at[0]][q1], &d2.basis[at[1]][q2]);
            let weighted = |a1: usize, a2: usize| {
                let control = mesh.control_points[(d1.first[at[0]] + a1) * n2 + d2.first[at[1]] + a2];
                (control, tensor_derivatives(along, across, mesh.degree, [a1, a2]).map(|value| value * control[3]))
            };
            let mut sums = [0.0; 6];
            for a1 in 0..=p1 {
                for a2 in 0..=p2 {
                    let (_, product) = weighted(a1, a2);
                    (0..6).for_each(|k| sums[k] += product[k]);
                }
            }
            let base = points.len() * 5 * padded;
            let mut derivatives = [[0.0; 3]; 5];
            for a1 in 0..=p1 {
                for a2 in 0..=p2 {
                    let (control, product) = weighted(a1, a2);
                    let rational = quotient_derivatives(product, sums);
                    for k in 0..5 {
                        out[base + k * padded + a1 * (p2 + 1) + a2] = rational[k + 1];
                        for c in 0..3 {
                            derivatives[k][c] += rational[k + 1] * control[c] / control[3];
                        }
                    }
                }
            }
            let weight = 0.25 * weight1 * weight2 * size1 * size2;
            let point = PointReference::new(derivatives, &scene.material, weight);
            let tangents = point.tangent_lengths();
            lengths[0] += 0.25 * weight1 * weight2 * size1 * tangents[0];
            lengths[1] += 0.25 * weight1 * weight2 * size2 * tangents[1];
            points.push(point);
        }
    }
    (points, lengths)
}
