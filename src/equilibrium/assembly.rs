//! Sums over elements: energy, residual and stiffness on control points.
//!
//! The stiffness on control points is stored as a stencil: control point i = i₁ n₂ + i₂ has a 3 × 3 block for each j =
//! i + (d₁, d₂) with j ≥ i that it can share an element with: d₁ = 0, 0 ≤ d₂ ≤ p₂, or 0 < d₁ ≤ p₁, −p₂ ≤ d₂ ≤ p₂.
//!
//! Threads work on columns of elements (all elements with the same place along the length). A column touches p₁ + 1
//! rows of control points; columns p₁ + 1 apart share none, so they are one colour and run at once, each on its own
//! slice. Colours follow each other. Every sum is therefore formed in one order, whatever the number of threads.

use rayon::prelude::*;

use crate::equilibrium::descent::length;
pub use crate::equilibrium::kernel::Want;
use crate::equilibrium::kernel::{Build, ElementBuffers, integrate_element};
use crate::model::{Discretization, NaturalState, Tables};
use crate::shell::sub;
use crate::spline::Mesh;

/// Strain energy of the model at a displacement on `mesh`, N·mm; `tables` may have other elements than `mesh`
/// ([`Tables::on_elements_of`]). `natural` is the state without forces, where that is not the undeformed one. Summed in
/// the order of [`Assembled::assemble`].
pub fn strain_energy(mesh: &Mesh, tables: &Tables, displacement: &[[f64; 3]], natural: Option<NaturalState>) -> f64 {
    let build = Build::detect();
    let columns: Vec<f64> = (0..tables.elements[0])
        .into_par_iter()
        .map_init(
            || buffers_for(tables, natural),
            |buffers, column| {
                let mut energy = 0.0;
                for across in 0..tables.elements[1] {
                    gather(mesh, tables, displacement, [column, across], buffers);
                    integrate_element(tables, column * tables.elements[1] + across, Want::Energy, build, buffers);
                    energy += buffers.energy;
                }
                energy
            },
        )
        .collect();
    with_locked(columns.iter().sum(), natural)
}

fn buffers_for(tables: &Tables, natural: Option<NaturalState>) -> ElementBuffers {
    let mut buffers = ElementBuffers::new(tables.padded);
    buffers.free = natural.map(|natural| natural.strain);
    buffers
}

/// Energy of the points, and that which layers keep in each other.
fn with_locked(energy: f64, natural: Option<NaturalState>) -> f64 {
    natural.map_or(energy, |natural| energy + natural.locked_n_mm)
}

/// Offsets (d₁, d₂) of the stencil, in storage order.
pub fn stencil(degree: [usize; 2]) -> Vec<[isize; 2]> {
    let [p1, p2] = degree.map(|p| p as isize);
    let same_row = (0..=p2).map(|d2| [0, d2]);
    same_row.chain((1..=p1).flat_map(|d1| (-p2..=p2).map(move |d2| [d1, d2]))).collect()
}

/// Blocks of a control point.
pub fn stencil_len(degree: [usize; 2]) -> usize {
    degree[1] + 1 + degree[0] * (2 * degree[1] + 1)
}

/// Sums over all elements; buffers are kept between calls.
#[derive(Debug)]
pub struct Assembled {
    /// Strain energy of the model, N·mm.
    pub energy: f64,
    /// Euclidean norm of the elements' forces on their control points, before they are summed, N.
    pub element_forces: f64,
    /// Gradient of the energy with respect to the control points' displacements, N.
    pub residual: Vec<[f64; 3]>,
    /// Norm of the part of the residual that the free strain makes, N: a load in all but name. 0 where there is none.
    pub free_strain_forces: f64,
    /// `stiffness[(i · stencil_len + slot) · 9 + 3 c + d]`, N/mm.
    pub stiffness: Vec<f64>,
}

impl Assembled {
    /// Buffers for a mesh.
    pub fn new(discretization: &Discretization) -> Self {
        let count = discretization.mesh.control_points.len();
        let stiffness = vec![0.0; count * stencil_len(discretization.mesh.degree) * 9];
        let residual = vec![[0.0; 3]; count];
        Self { energy: 0.0, element_forces: 0.0, residual, free_strain_forces: 0.0, stiffness }
    }

    /// Assembles residual and energy, and the stiffness where `want` says so, at a displacement of the control points and a
    /// value of the scene's parameter.
    pub fn assemble(&mut self, discretization: &Discretization, displacement: &[[f64; 3]], parameter: f64, want: Want) {
        let natural = discretization.free_strains.at(parameter);
        self.assemble_from(discretization, displacement, natural, want);
        self.free_strain_forces = match natural {
            Some(_) => length(&self.change_of_forces(discretization, displacement, None)),
            None => 0.0,
        };
    }

    /// What internal forces change by where the shell stays at the displacement that it was assembled at and its natural
    /// state becomes another one, N. They are linear in the free strain.
    pub(super) fn change_of_forces(
        &self,
        discretization: &Discretization,
        displacement: &[[f64; 3]],
        natural: Option<NaturalState>,
    ) -> Vec<[f64; 3]> {
        let residual = vec![[0.0; 3]; displacement.len()];
        let mut there =
            Self { energy: 0.0, element_forces: 0.0, residual, free_strain_forces: 0.0, stiffness: Vec::new() };
        there.assemble_from(discretization, displacement, natural, Want::Residual);
        there.residual.iter().zip(&self.residual).map(|(g1, g0)| sub(*g1, *g0)).collect()
    }

    /// The same where this is the state without forces.
    fn assemble_from(
        &mut self,
        discretization: &Discretization,
        displacement: &[[f64; 3]],
        natural: Option<NaturalState>,
        want: Want,
    ) {
        let mesh = &discretization.mesh;
        let tables = &discretization.tables;
        let degree = mesh.degree;
        let n2 = mesh.control_counts()[1];
        let colours = degree[0] + 1;
        let row_stiffness = if want == Want::Stiffness { n2 * stencil_len(degree) * 9 } else { 0 };
        let build = Build::detect();
        self.residual.fill([0.0; 3]);
        if want == Want::Stiffness {
            self.stiffness.par_chunks_mut(row_stiffness).for_each(|row| row.fill(0.0));
        }
        let first = &tables.first[0];
        let mut totals = vec![ColumnSums::default(); first.len()];
        for colour in 0..colours.min(first.len()) {
            let columns: Vec<usize> = (colour..first.len()).step_by(colours).collect();
            let residuals = take_rows(&mut self.residual, n2, colours, columns.iter().map(|e| first[*e]));
            let stiffnesses = take_rows(&mut self.stiffness, row_stiffness, colours, columns.iter().map(|e| first[*e]));
            let sums: Vec<ColumnSums> = columns
                .par_iter()
                .zip(residuals)
                .zip(stiffnesses)
                .map_init(
                    || buffers_for(tables, natural),
                    |buffers, ((column, residual), stiffness)| {
                        let mut rows = Rows { residual, stiffness };
                        assemble_column(discretization, displacement, *column, want, build, buffers, &mut rows)
                    },
                )
                .collect();
            for (column, sum) in columns.iter().zip(sums) {
                totals[*column] = sum;
            }
        }
        self.energy = with_locked(totals.iter().map(|column| column.energy).sum(), natural);
        self.element_forces = totals.iter().map(|column| column.squared_forces).sum::<f64>().sqrt();
    }

    /// Stiffness times a field on the control points.
    pub fn multiply(&self, discretization: &Discretization, field: &[[f64; 3]]) -> Vec<[f64; 3]> {
        multiply_stencil(discretization, &self.stiffness, 1.0, field)
    }
}

/// Blocks of the stencil times a field on the control points; the blocks that are not stored are the transposes of those
/// that are, times `mirrored`: 1 where they are symmetric, −1 where they are skew.
pub fn multiply_stencil(
    discretization: &Discretization,
    blocks: &[f64],
    mirrored: f64,
    field: &[[f64; 3]],
) -> Vec<[f64; 3]> {
    let n2 = discretization.mesh.control_counts()[1];
    let offsets = stencil(discretization.mesh.degree);
    let mut product = vec![[0.0; 3]; field.len()];
    for i in 0..field.len() {
        for (slot, offset) in offsets.iter().enumerate() {
            let Some(j) = neighbour(i, *offset, n2, field.len()) else { continue };
            let block = &blocks[(i * offsets.len() + slot) * 9..][..9];
            for c in 0..3 {
                for d in 0..3 {
                    product[i][c] += block[3 * c + d] * field[j][d];
                    if j != i {
                        product[j][d] += mirrored * (block[3 * c + d] * field[i][c]);
                    }
                }
            }
        }
    }
    product
}

/// Control point at an offset of the stencil from `i`, where there is one.
pub fn neighbour(i: usize, offset: [isize; 2], n2: usize, count: usize) -> Option<usize> {
    let column = (i % n2) as isize + offset[1];
    let j = i as isize + offset[0] * n2 as isize + offset[1];
    (0 <= column && column < n2 as isize && j < count as isize).then_some(j as usize)
}

/// Slot of the block of two control points i ≤ j that share an element.
pub fn neighbour_slot(degree: [usize; 2], n2: usize, i: usize, j: usize) -> usize {
    let [_, p2] = degree;
    let rows = j / n2 - i / n2;
    match rows {
        0 => j - i,
        _ => p2 + 1 + (rows - 1) * (2 * p2 + 1) + p2 + j % n2 - i % n2,
    }
}

/// Disjoint slices of `height` rows from each of the ascending `starts`.
fn take_rows<T>(mut data: &mut [T], row: usize, height: usize, starts: impl Iterator<Item = usize>) -> Vec<&mut [T]> {
    let mut taken = 0;
    let mut slices = Vec::new();
    for start in starts {
        let (_, rest) = data.split_at_mut((start - taken) * row);
        let (slice, rest) = rest.split_at_mut(height * row);
        slices.push(slice);
        data = rest;
        taken = start + height;
    }
    slices
}

/// Sums over a column of elements.
#[derive(Clone, Copy, Default)]
struct ColumnSums {
    energy: f64,
    squared_forces: f64,
}

/// The rows of control points that a column of elements adds to.
struct Rows<'a> {
    residual: &'a mut [[f64; 3]],
    stiffness: &'a mut [f64],
}

fn assemble_column(
    discretization: &Discretization,
    displacement: &[[f64; 3]],
    column: usize,
    want: Want,
    build: Build,
    buffers: &mut ElementBuffers,
    rows: &mut Rows,
) -> ColumnSums {
    let tables = &discretization.tables;
    let [p1, p2] = discretization.mesh.degree;
    let n2 = discretization.mesh.control_counts()[1];
    let padded = tables.padded;
    let functions = (p1 + 1) * (p2 + 1);
    let mut sums = ColumnSums::default();
    for across in 0..tables.elements[1] {
        let first = tables.first[1][across];
        gather(&discretization.mesh, tables, displacement, [column, across], buffers);
        integrate_element(tables, column * tables.elements[1] + across, want, build, buffers);
        sums.energy += buffers.energy;
        for a in 0..functions {
            let row = &mut rows.residual[(a / (p2 + 1)) * n2 + first + a % (p2 + 1)];
            for c in 0..3 {
                let force = buffers.residual[c * padded + a];
                row[c] += force;
                sums.squared_forces += force * force;
            }
        }
        if want == Want::Stiffness {
            scatter_stiffness([p1, p2], n2, first, padded, &buffers.stiffness, rows.stiffness);
        }
    }
    sums
}

/// Copies the displacement of an element's control points into its buffers.
fn gather(mesh: &Mesh, tables: &Tables, displacement: &[[f64; 3]], element: [usize; 2], buffers: &mut ElementBuffers) {
    let [p1, p2] = mesh.degree;
    let n2 = mesh.control_counts()[1];
    let first = [tables.first[0][element[0]], tables.first[1][element[1]]];
    for a in 0..(p1 + 1) * (p2 + 1) {
        let point = (first[0] + a / (p2 + 1)) * n2 + first[1] + a % (p2 + 1);
        for c in 0..3 {
            buffers.displacement[c * tables.padded + a] = displacement[point][c];
        }
    }
}

/// Adds an element's blocks b ≥ a to the stencil of the column's rows.
fn scatter_stiffness(degree: [usize; 2], n2: usize, first: usize, padded: usize, local: &[f64], rows: &mut [f64]) {
    let [p1, p2] = degree;
    let slots = stencil_len(degree);
    for a1 in 0..=p1 {
        for a2 in 0..=p2 {
            let a = a1 * (p2 + 1) + a2;
            let point = &mut rows[(a1 * n2 + first + a2) * slots * 9..][..slots * 9];
            for b1 in a1..=p1 {
                let from = if b1 == a1 { a2 } else { 0 };
                for b2 in from..=p2 {
                    let b = b1 * (p2 + 1) + b2;
                    let slot = if b1 == a1 { b2 - a2 } else { p2 + 1 + (b1 - a1 - 1) * (2 * p2 + 1) + p2 + b2 - a2 };
                    for cd in 0..9 {
                        point[slot * 9 + cd] += local[(b * 9 + cd % 3 * 3 + cd / 3) * padded + a];
                    }
                }
            }
        }
    }
}
