//! Shape functions and the undeformed shell at every quadrature point of a mesh.

use rayon::prelude::*;

use crate::model::connectivity::{Connectivity, starts};
use crate::model::member::{Member, members};
use crate::model::quadrature::{Counts, PointCounts};
use crate::scene::{Material, Scene};
use crate::shell::{PointBatch, PointReference, StretchingBatch, gauss_legendre};
use crate::spline::{
    Grid, Mesh, Patch, Spans, basis_derivatives, basis_derivatives_len, find_span, quotient_derivatives,
    tensor_derivatives,
};

/// Multiple that numbers of basis functions are padded to, so that kernels work on whole vectors of any width.
pub(crate) const LANES: usize = 8;

/// Number of points that kernels work on at once.
pub(crate) const BATCH: usize = 4;

/// Shape functions and undeformed points of a mesh. Elements are ordered with the second direction fastest, points
/// within an element likewise.
#[derive(Debug)]
pub struct Tables {
    /// Grid that numbers the elements.
    pub elements: Grid,
    /// Control points of the elements, and the order of sums over them.
    pub connectivity: Connectivity,
    /// Number of functions of an element, (p₁ + 1)(p₂ + 1).
    pub functions_per_element: usize,
    /// Number of functions of an element, padded to a multiple of 8; the padding holds zeros.
    pub padded: usize,
    /// Points of the energy: of all of it, or of bending alone where stretching has points of its own.
    pub points: PointTable<PointBatch, 5>,
    /// Points of stretching, where it has points of its own.
    pub stretching: Option<PointTable<StretchingBatch, 2>>,
    /// Undeformed length of each element through its middle in each direction, mm.
    pub lengths: Vec<[f64; 2]>,
}

/// Quadrature points, and the first `ROWS` derivatives (,1 ,2 ,11 ,22 ,12) of the functions there.
#[derive(Debug)]
pub struct PointTable<Batch, const ROWS: usize> {
    /// Points of element e: `point_start[e]..point_start[e + 1]`.
    point_start: Vec<usize>,
    /// Batches of element e: `batch_start[e]..batch_start[e + 1]`.
    batch_start: Vec<usize>,
    padded: usize,
    /// Derivatives of the functions, `functions[(point · ROWS + k) · padded + a]`: derivative k of function a = a₁ (p₂
    /// + 1) + a₂.
    pub functions: Vec<f64>,
    /// Undeformed points, element by element.
    pub references: Vec<PointReference>,
    /// Undeformed points in batches of four, the last of an element with the rest.
    pub batches: Vec<Batch>,
}

impl<Batch, const ROWS: usize> PointTable<Batch, ROWS> {
    /// Builds the table of elements with `counts` Gauss points; `references` are made from the whole points by `part`,
    /// and batches from those by `batch`. Also returns what `of_element` makes of each element's whole points.
    fn new<T: Send>(
        geometry: &Geometry,
        counts: &Counts,
        part: impl Fn(PointReference) -> PointReference + Sync,
        batch: impl Fn(&[PointReference]) -> Batch + Sync,
        of_element: impl Fn(&[ElementPoint]) -> T + Sync,
    ) -> (Self, Vec<T>)
    where
        Batch: Send,
    {
        let directions = [0, 1]
            .map(|direction| Direction::new(geometry.mesh, direction, &geometry.spans[direction], &counts[direction]));
        let elements = geometry.elements();
        let count = elements.len();
        let points_of = |element: usize| {
            let [e1, e2] = elements.place(element);
            counts[0][e1] * counts[1][e2]
        };
        let point_start = starts((0..count).map(points_of));
        let batch_start = starts((0..count).map(|element| points_of(element).div_ceil(BATCH)));
        let padded = geometry.padded();
        let mut functions = vec![0.0; point_start[count] * ROWS * padded];
        let mut rest = &mut functions[..];
        let mut of_elements = Vec::with_capacity(count);
        for element in 0..count {
            let (of_this, others) = rest.split_at_mut(points_of(element) * ROWS * padded);
            of_elements.push(of_this);
            rest = others;
        }
        let built: Vec<(Vec<PointReference>, Vec<Batch>, T)> = of_elements
            .into_par_iter()
            .enumerate()
            .map(|(element, out)| {
                let points = element_points::<ROWS>(geometry, &directions, elements.place(element), out);
                let made = of_element(&points);
                let references: Vec<PointReference> = points.into_iter().map(|point| part(point.reference)).collect();
                let batches = references.chunks(BATCH).map(&batch).collect();
                (references, batches, made)
            })
            .collect();
        let mut table =
            Self { point_start, batch_start, padded, functions, references: Vec::new(), batches: Vec::new() };
        let mut all_made = Vec::with_capacity(count);
        for (references, batches, made) in built {
            table.references.extend(references);
            table.batches.extend(batches);
            all_made.push(made);
        }
        (table, all_made)
    }

    /// Number of bytes that an assembly reads.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.functions[..]) + size_of_val(&self.batches[..])
    }

    /// Derivatives of the functions at all points of an element: points · ROWS · `padded` numbers.
    pub fn element_functions(&self, element: usize) -> &[f64] {
        let size = ROWS * self.padded;
        &self.functions[self.point_start[element] * size..self.point_start[element + 1] * size]
    }

    /// Undeformed points of an element.
    pub fn element_points(&self, element: usize) -> &[PointReference] {
        &self.references[self.point_start[element]..self.point_start[element + 1]]
    }

    /// Undeformed points of an element in batches of four.
    pub fn element_batches(&self, element: usize) -> &[Batch] {
        &self.batches[self.batch_start[element]..self.batch_start[element + 1]]
    }
}

impl Tables {
    /// Builds the tables for the scene's quadrature and material on a mesh.
    pub fn new(scene: &Scene, mesh: &Patch) -> Self {
        Self::on_elements_of(scene, mesh, mesh)
    }

    /// Builds the tables of each shell of a structure.
    pub fn of_structure(scene: &Scene, mesh: &Mesh) -> Vec<Self> {
        let points = mesh.point_count();
        members(scene, mesh).iter().map(|member| Self::of_member(member, member.patch, points)).collect()
    }

    /// Builds the tables of a shell of a structure, on the numbers that control points have in the structure, where `finer` is
    /// the shell's patch or has knots inserted ([`Self::on_elements_of`]); `points` is the number of all control points.
    pub(crate) fn of_member(member: &Member, finer: &Patch, points: usize) -> Self {
        let mut tables = Self::on_elements_of(&member.scene, member.patch, finer);
        tables.connectivity = tables.connectivity.shifted(points, member.points.start);
        tables
    }

    /// Builds the tables of the functions of `mesh` at the quadrature points of the elements of `finer`, which is
    /// `mesh` with knots inserted. They give the energy of a displacement on `mesh` integrated over the elements of
    /// `finer`.
    pub fn on_elements_of(scene: &Scene, mesh: &Patch, finer: &Patch) -> Self {
        let geometry = Geometry::new(scene, mesh, finer);
        let counts = PointCounts::of(scene, finer);
        let bending_alone = counts.stretching.is_some();
        let part = |point: PointReference| if bending_alone { point.bending_alone() } else { point };
        let (points, lengths) = PointTable::new(&geometry, &counts.bending, part, PointBatch::new, element_lengths);
        let stretching = counts.stretching.map(|counts| {
            let alone = PointReference::stretching_alone;
            PointTable::new(&geometry, &counts, alone, StretchingBatch::new, |_| ()).0
        });
        let first = [0, 1]
            .map(|direction| geometry.spans[direction].index.iter().map(|s| s - mesh.degree[direction]).collect());
        Self {
            elements: geometry.elements(),
            connectivity: Connectivity::of_tensor_product(mesh, &first),
            functions_per_element: geometry.functions(),
            padded: geometry.padded(),
            points,
            stretching,
            lengths,
        }
    }
}

/// The functions of a mesh on elements that may be finer than its own, from which points are made.
struct Geometry<'a> {
    material: &'a Material,
    mesh: &'a Patch,
    /// Elements in each direction, with the knot spans of `mesh` that they lie in.
    spans: [Spans; 2],
}

impl<'a> Geometry<'a> {
    fn new(scene: &'a Scene, mesh: &'a Patch, finer: &Patch) -> Self {
        let spans = [0, 1].map(|direction| {
            let mut spans = Spans::of(&finer.knots[direction], mesh.degree[direction]);
            for (index, [from, to]) in spans.index.iter_mut().zip(&spans.bounds) {
                *index = find_span(&mesh.knots[direction], mesh.degree[direction], 0.5 * (from + to));
            }
            spans
        });
        Self { material: &scene.material, mesh, spans }
    }

    fn elements(&self) -> Grid {
        Grid::new(self.spans.each_ref().map(Spans::count))
    }

    fn functions(&self) -> usize {
        (self.mesh.degree[0] + 1) * (self.mesh.degree[1] + 1)
    }

    fn padded(&self) -> usize {
        self.functions().next_multiple_of(LANES)
    }
}

/// Basis functions of one direction at the Gauss points of each element.
struct Direction {
    first: Vec<usize>,
    /// Size of each element in the parameter.
    sizes: Vec<f64>,
    /// Gauss weights on [−1, 1], `weights[element][point]`.
    weights: Vec<Vec<f64>>,
    /// Basis functions, `basis[element][point]` as [`basis_derivatives`] fills it.
    basis: Vec<Vec<Vec<f64>>>,
}

impl Direction {
    fn new(mesh: &Patch, direction: usize, spans: &Spans, counts: &[usize]) -> Self {
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

/// A quadrature point, and its contributions to the lengths of its element in each direction.
struct ElementPoint {
    reference: PointReference,
    lengths: [f64; 2],
}

/// Computes the lengths of an element through its middle in each direction, mm.
fn element_lengths(points: &[ElementPoint]) -> [f64; 2] {
    let mut lengths = [0.0; 2];
    for point in points {
        (0..2).for_each(|k| lengths[k] += point.lengths[k]);
    }
    lengths
}

/// Fills the first `ROWS` derivatives of an element's functions; returns its points.
fn element_points<const ROWS: usize>(
    geometry: &Geometry,
    directions: &[Direction; 2],
    at: [usize; 2],
    out: &mut [f64],
) -> Vec<ElementPoint> {
    let (mesh, padded) = (geometry.mesh, geometry.padded());
    let [d1, d2] = directions;
    let [p1, p2] = mesh.degree;
    let grid = mesh.grid();
    let (size1, size2) = (d1.sizes[at[0]], d2.sizes[at[1]]);
    let mut points: Vec<ElementPoint> = Vec::new();
    for (q1, weight1) in d1.weights[at[0]].iter().enumerate() {
        for (q2, weight2) in d2.weights[at[1]].iter().enumerate() {
            let (along, across) = (&d1.basis[at[0]][q1], &d2.basis[at[1]][q2]);
            let weighted = |a1: usize, a2: usize| {
                let control = mesh.control_points[grid.index([d1.first[at[0]] + a1, d2.first[at[1]] + a2])];
                (control, tensor_derivatives(along, across, mesh.degree, [a1, a2]).map(|value| value * control[3]))
            };
            let mut sums = [0.0; 6];
            for a1 in 0..=p1 {
                for a2 in 0..=p2 {
                    let (_, product) = weighted(a1, a2);
                    (0..6).for_each(|k| sums[k] += product[k]);
                }
            }
            let base = points.len() * ROWS * padded;
            let mut derivatives = [[0.0; 3]; 5];
            for a1 in 0..=p1 {
                for a2 in 0..=p2 {
                    let (control, product) = weighted(a1, a2);
                    let rational = quotient_derivatives(product, sums);
                    for k in 0..ROWS {
                        out[base + k * padded + a1 * (p2 + 1) + a2] = rational[k + 1];
                    }
                    for k in 0..5 {
                        for c in 0..3 {
                            derivatives[k][c] += rational[k + 1] * control[c] / control[3];
                        }
                    }
                }
            }
            let weight = 0.25 * weight1 * weight2;
            let reference = PointReference::new(derivatives, geometry.material, weight * size1 * size2);
            let [length1, length2] = reference.tangent_lengths();
            points.push(ElementPoint { reference, lengths: [weight * size1 * length1, weight * size2 * length2] });
        }
    }
    points
}
