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
    /// Quadrature points of element e: `point_start[e]..point_start[e + 1]`.
    point_start: Vec<usize>,
    /// The same of batches.
    batch_start: Vec<usize>,
    /// (p₁ + 1)(p₂ + 1).
    pub functions_per_element: usize,
    /// The same, padded to a multiple of 8; the padding holds zeros.
    pub padded: usize,
    /// `functions[(point · 5 + k) · padded + a]`: derivative k (,1 ,2 ,11 ,22 ,12) of function
    /// a = a₁ (p₂ + 1) + a₂.
    pub functions: Vec<f64>,
    /// Points, element by element.
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
        let counts = [0, 1].map(|k| point_counts(scene.mesh.quadrature, mesh.degree[k], &finer.knots[k]));
        let directions = [0, 1].map(|k| Direction::new(mesh, k, &spans[k], &counts[k]));
        let elements = [spans[0].count(), spans[1].count()];
        let points_of = |element: usize| counts[0][element / elements[1]] * counts[1][element % elements[1]];
        let functions_per_element = (mesh.degree[0] + 1) * (mesh.degree[1] + 1);
        let padded = functions_per_element.next_multiple_of(LANES);
        let count = elements[0] * elements[1];
        let point_start = starts((0..count).map(points_of));
        let batch_start = starts((0..count).map(|element| points_of(element).div_ceil(BATCH)));
        let mut functions = vec![0.0; point_start[count] * 5 * padded];
        let mut rest = &mut functions[..];
        let mut of_elements = Vec::with_capacity(count);
        for element in 0..count {
            let (of_element, others) = rest.split_at_mut(points_of(element) * 5 * padded);
            of_elements.push(of_element);
            rest = others;
        }
        let built: Vec<(Vec<PointReference>, [f64; 2])> = of_elements
            .into_par_iter()
            .enumerate()
            .map(|(element, out)| {
                let at = [element / elements[1], element % elements[1]];
                element_tables(scene, mesh, &directions, at, padded, out)
            })
            .collect();
        let lengths = built.iter().map(|(_, length)| *length).collect();
        let by_fours = |(points, _): &(Vec<PointReference>, _)| {
            points.chunks(BATCH).map(PointBatch::new).collect::<Vec<PointBatch>>()
        };
        let batches = built.par_iter().flat_map_iter(by_fours).collect();
        let points: Vec<PointReference> = built.into_iter().flat_map(|(points, _)| points).collect();
        let first = [0, 1].map(|k| spans[k].index.iter().map(|s| s - mesh.degree[k]).collect());
        Self {
            elements,
            first,
            point_start,
            batch_start,
            functions_per_element,
            padded,
            functions,
            points,
            batches,
            lengths,
        }
    }

    /// Functions of all points of an element: points · 5 · `padded` numbers.
    pub fn element_functions(&self, element: usize) -> &[f64] {
        let size = 5 * self.padded;
        &self.functions[self.point_start[element] * size..self.point_start[element + 1] * size]
    }

    /// Reference points of an element.
    pub fn element_points(&self, element: usize) -> &[PointReference] {
        &self.points[self.point_start[element]..self.point_start[element + 1]]
    }

    /// The same points by fours.
    pub fn element_batches(&self, element: usize) -> &[PointBatch] {
        &self.batches[self.batch_start[element]..self.batch_start[element + 1]]
    }
}

/// Sums of all counts before each, and of all.
fn starts(counts: impl Iterator<Item = usize>) -> Vec<usize> {
    let sums = counts.scan(0, |sum, count| {
        *sum += count;
        Some(*sum)
    });
    std::iter::once(0).chain(sums).collect()
}

/// Gauss points of each element in one direction.
///
/// Reduced integration that knows where splines are smooth (Adam, Hughes, Bouabdallah, Zarroug & Maitournam 2015, *Selective
/// and reduced numerical integrations for NURBS-based isogeometric analysis*): p − 1 points where a spline is C^(p−1) across
/// both ends of an element, p next to the ends of the patch and to knots of higher multiplicity. The counts are empirical,
/// held by eigenvalues (`tests/verification/quadrature.rs`): with p points each way a single element has a field without
/// energy beside the rigid motions, in every degree, and degree 2 with one point inside is four times too soft on graded
/// meshes. On the baseline at 8°, 32 × 16 cubic elements, the moment is 285.841 N·mm, full quadrature gives 285.821 and a
/// fine mesh 285.686.
fn point_counts(quadrature: Quadrature, degree: usize, knots: &[f64]) -> Vec<usize> {
    let bounds = Spans::of(knots, degree).bounds;
    let is_smooth = |knot: f64| {
        let first = knots.partition_point(|other| *other < knot);
        knots.get(first + 1).is_some_and(|next| *next > knot)
    };
    let count = |[from, to]: &[f64; 2]| match quadrature {
        Quadrature::Reduced | Quadrature::Patch if bounds.len() == 1 => degree + 1,
        Quadrature::Full => degree + 1,
        Quadrature::Reduced => degree,
        Quadrature::Patch if is_smooth(*from) && is_smooth(*to) => (degree - 1).max(2),
        Quadrature::Patch => degree,
    };
    bounds.iter().map(count).collect()
}

/// One direction: basis functions at the Gauss points of each element.
struct Direction {
    first: Vec<usize>,
    /// Size in the parameter of each element.
    sizes: Vec<f64>,
    /// `weights[element][point]`: Gauss weights on [−1, 1].
    weights: Vec<Vec<f64>>,
    /// `basis[element][point]` as [`basis_derivatives`] fills it.
    basis: Vec<Vec<Vec<f64>>>,
}

impl Direction {
    fn new(mesh: &Mesh, direction: usize, spans: &Spans, counts: &[usize]) -> Self {
        let degree = mesh.degree[direction];
        let knots = &mesh.knots[direction];
        let rules: Vec<Vec<[f64; 2]>> = counts.iter().map(|count| gauss_legendre(*count)).collect();
        let at_points = |span: usize, [from, to]: [f64; 2], rule: &[[f64; 2]]| {
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
            weights: rules.iter().map(|rule| rule.iter().map(|[_, weight]| *weight).collect()).collect(),
            basis: (0..spans.count()).map(|e| at_points(spans.index[e], spans.bounds[e], &rules[e])).collect(),
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
    for (q1, weight1) in d1.weights[at[0]].iter().enumerate() {
        for (q2, weight2) in d2.weights[at[1]].iter().enumerate() {
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
