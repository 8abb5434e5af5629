//! Sums over elements: energy, residual and stiffness on control points.
//!
//! The order of sums is that of the [`Connectivity`](crate::model::Connectivity): threads work on strands of elements, strands of
//! one colour at once, each on its own slices of the sums, since they share no control point; colours follow each other.

use std::ops::Range;

use rayon::prelude::*;

pub use crate::equilibrium::kernel::Want;
use crate::equilibrium::kernel::{Build, ElementBuffers, integrate_element};
use crate::equilibrium::vector::length;
use crate::model::{At, BLOCK, BlockPattern, Blocks, Discretization, NaturalState, Strand, Tables};
use crate::shell::{add, sub};

/// Strain energy of the model at a displacement of the control points that `tables` act on, N·mm. `natural` is the state
/// without forces, where that is not the undeformed one. Summed in the order of [`Assembled::assemble`].
pub fn strain_energy(tables: &Tables, displacement: &[[f64; 3]], natural: Option<NaturalState>) -> f64 {
    let build = Build::detect();
    let strands = tables.connectivity.strands();
    let energies: Vec<f64> = strands
        .par_iter()
        .map_init(
            || buffers_for(tables, natural),
            |buffers, strand| {
                let mut energy = 0.0;
                for element in strand.elements.clone() {
                    gather(tables, displacement, element, buffers);
                    integrate_element(tables, element, Want::Energy, build, buffers);
                    energy += buffers.energy;
                }
                energy
            },
        )
        .collect();
    with_locked(energies.iter().sum(), natural)
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

/// Sums over all elements and terms; buffers are kept between calls.
#[derive(Debug, Default)]
pub struct Assembled {
    /// Energy that the model stores: strain energy, and what other terms store, N·mm.
    pub energy: f64,
    /// Euclidean norm of the elements' forces on their control points, before they are summed, N.
    pub element_forces: f64,
    /// Gradient of the strain energy with respect to the control points' displacements, N.
    pub residual: Vec<[f64; 3]>,
    /// Forces that loads and other terms exert on the control points, N; empty where there are none.
    pub external: Vec<[f64; 3]>,
    /// The part of these that terms exert which store energy: internal forces of the model; empty where there are none.
    pub internal: Vec<[f64; 3]>,
    /// Norm of the part of the residual that the free strain makes, N: a load in all but name. 0 where there is none.
    pub free_strain_forces: f64,
    /// Symmetric part of the tangent of the residual less the external forces, N/mm; empty where it is not asked for.
    pub stiffness: Blocks,
    /// Skew part; empty where there is none.
    pub skew: Blocks,
}

impl Assembled {
    /// Buffers for a mesh.
    pub fn new(discretization: &Discretization) -> Self {
        let stiffness = Blocks::zeros(&discretization.blocks);
        let residual = vec![[0.0; 3]; discretization.blocks.points()];
        Self { residual, stiffness, ..Self::default() }
    }

    /// Assembles residual and energy, and the stiffness where `want` says so, at a displacement of the control points and a
    /// value of the scene's parameter.
    pub fn assemble(&mut self, discretization: &Discretization, displacement: &[[f64; 3]], parameter: f64, want: Want) {
        let natural = discretization.free_strains.at(parameter);
        self.assemble_shell(discretization, displacement, natural, want);
        self.add_terms(discretization, displacement, parameter, want);
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
        let mut there = Self { residual, ..Self::default() };
        there.assemble_shell(discretization, displacement, natural, Want::Residual);
        there.residual.iter().zip(&self.residual).map(|(g1, g0)| sub(*g1, *g0)).collect()
    }

    fn add_terms(&mut self, discretization: &Discretization, displacement: &[[f64; 3]], parameter: f64, want: Want) {
        let Discretization { mesh, terms, blocks, .. } = discretization;
        (self.external, self.internal) = (Vec::new(), Vec::new());
        if !terms.is_empty() {
            let at = At { mesh, displacement, parameter };
            [self.external, self.internal] = terms.forces_apart(at);
            self.external.iter_mut().zip(&self.internal).for_each(|(sum, force)| *sum = add(*sum, *force));
            self.energy += terms.energy(at);
            if want == Want::Stiffness {
                self.skew = terms.add_tangent(at, blocks, &mut self.stiffness);
            }
        }
    }

    /// Energy, residual and stiffness of the shell, where this is the state without forces.
    pub(super) fn assemble_shell(
        &mut self,
        discretization: &Discretization,
        displacement: &[[f64; 3]],
        natural: Option<NaturalState>,
        want: Want,
    ) {
        self.residual.fill([0.0; 3]);
        if want == Want::Stiffness {
            self.stiffness.clear();
        }
        let part = Part { tables: &discretization.tables, blocks: &discretization.blocks, part: 0, natural };
        let sums = part.add(displacement, want, &mut self.residual, &mut self.stiffness);
        self.energy = with_locked(sums.energy, natural);
        self.element_forces = sums.squared_forces.sqrt();
    }

    /// Forces that do not balance: the residual less the external forces, N.
    pub fn forces(&self) -> Vec<[f64; 3]> {
        subtract(&self.residual, &self.external)
    }

    /// Whether the tangent has a skew part.
    pub(super) fn has_skew(&self) -> bool {
        !self.skew.is_empty()
    }

    /// The skew part times a field on the control points.
    pub(super) fn multiply_skew(&self, discretization: &Discretization, field: &[[f64; 3]]) -> Vec<[f64; 3]> {
        match self.has_skew() {
            true => self.skew.multiply(&discretization.blocks, -1.0, field),
            false => vec![[0.0; 3]; field.len()],
        }
    }

    /// Stiffness times a field on the control points.
    pub fn multiply(&self, discretization: &Discretization, field: &[[f64; 3]]) -> Vec<[f64; 3]> {
        self.stiffness.multiply(&discretization.blocks, 1.0, field)
    }
}

/// Elements with a part in a matrix on control points that other patches may share.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    /// Its elements.
    pub tables: &'a Tables,
    /// The matrix.
    pub blocks: &'a BlockPattern,
    /// Which part of that the elements are.
    pub part: usize,
    /// The state without forces, where that is not the undeformed one.
    pub natural: Option<NaturalState>,
}

impl Part<'_> {
    /// Adds up residual and stiffness at a displacement of the control points; the latter only where `want` says so.
    pub fn add(
        &self,
        displacement: &[[f64; 3]],
        want: Want,
        residual: &mut [[f64; 3]],
        stiffness: &mut Blocks,
    ) -> ElementSums {
        let connectivity = &self.tables.connectivity;
        let build = Build::detect();
        let mut totals = vec![ElementSums::default(); connectivity.strands().len()];
        for colour in connectivity.colours() {
            let strands: Vec<&Strand> = colour.iter().map(|index| &connectivity.strands()[*index]).collect();
            let of_blocks = if want == Want::Stiffness { &mut stiffness.values[..] } else { &mut [] };
            let rows = take_rows(&strands, self.blocks, residual, of_blocks);
            let sums: Vec<ElementSums> = strands
                .par_iter()
                .zip(rows)
                .map_init(
                    || buffers_for(self.tables, self.natural),
                    |buffers, (strand, mut rows)| {
                        let mut sums = ElementSums::default();
                        for element in strand.elements.clone() {
                            gather(self.tables, displacement, element, buffers);
                            integrate_element(self.tables, element, want, build, buffers);
                            self.scatter(element, want, buffers, &mut rows, &mut sums);
                        }
                        sums
                    },
                )
                .collect();
            colour.iter().zip(sums).for_each(|(index, sum)| totals[*index] = sum);
        }
        ElementSums {
            energy: totals.iter().map(|strand| strand.energy).sum(),
            squared_forces: totals.iter().map(|strand| strand.squared_forces).sum(),
        }
    }

    /// Adds an element's forces, and its blocks, to the rows of its strand.
    fn scatter(&self, element: usize, want: Want, buffers: &ElementBuffers, rows: &mut Rows, sums: &mut ElementSums) {
        let padded = self.tables.padded;
        sums.energy += buffers.energy;
        for (a, control) in self.tables.connectivity.controls(element).iter().enumerate() {
            let row = rows.residual(*control);
            for c in 0..3 {
                let force = buffers.residual[c * padded + a];
                row[c] += force;
                sums.squared_forces += force * force;
            }
        }
        if want == Want::Stiffness {
            self.scatter_blocks(element, &buffers.stiffness, rows);
        }
    }

    fn scatter_blocks(&self, element: usize, local: &[f64], rows: &mut Rows) {
        let padded = self.tables.padded;
        let controls = self.tables.connectivity.controls(element);
        let mut slots = self.blocks.slots(self.part, element);
        let ascending = controls.is_sorted();
        for (a, i) in controls.iter().enumerate() {
            let (of_this, others) = slots.split_at(controls.len() - a);
            slots = others;
            let row = rows.blocks(self.blocks, *i);
            for (b, slot) in (a..).zip(of_this).filter(|(b, _)| ascending || *i <= controls[*b]) {
                let block = &mut row[*slot as usize * BLOCK..][..BLOCK];
                for cd in 0..BLOCK {
                    block[cd] += local[(b * BLOCK + cd % 3 * 3 + cd / 3) * padded + a];
                }
            }
            // Of the others the mirror image is stored.
            for (b, slot) in (a..).zip(of_this).filter(|(b, _)| !ascending && *i > controls[*b]) {
                let block = &mut rows.blocks(self.blocks, controls[b])[*slot as usize * BLOCK..][..BLOCK];
                for cd in 0..BLOCK {
                    block[cd] += local[(b * BLOCK + cd) * padded + a];
                }
            }
        }
    }
}

/// Sums over elements.
#[derive(Clone, Copy, Debug, Default)]
pub struct ElementSums {
    /// Strain energy, N·mm.
    pub energy: f64,
    /// Squares of the elements' forces on their control points, N².
    pub squared_forces: f64,
}

/// A run of control points with their part of the sums.
struct Run<'a> {
    points: Range<usize>,
    residual: &'a mut [[f64; 3]],
    /// Their rows of blocks; empty where no stiffness is asked for.
    stiffness: &'a mut [f64],
}

/// What the elements of a strand add to: runs with growing numbers.
#[derive(Default)]
struct Rows<'a>(Vec<Run<'a>>);

impl<'a> Rows<'a> {
    fn run(&mut self, point: usize) -> &mut Run<'a> {
        let index = match self.0.len() {
            1 => 0,
            _ => self.0.partition_point(|run| run.points.end <= point),
        };
        &mut self.0[index]
    }

    fn residual(&mut self, point: usize) -> &mut [f64; 3] {
        let run = self.run(point);
        &mut run.residual[point - run.points.start]
    }

    /// Blocks of a control point's row.
    fn blocks(&mut self, pattern: &BlockPattern, point: usize) -> &mut [f64] {
        let run = self.run(point);
        let first = pattern.start(run.points.start);
        &mut run.stiffness[(pattern.start(point) - first) * BLOCK..(pattern.start(point + 1) - first) * BLOCK]
    }
}

/// Disjoint slices for strands that share no control point.
fn take_rows<'a>(
    strands: &[&Strand],
    pattern: &BlockPattern,
    mut residual: &'a mut [[f64; 3]],
    mut stiffness: &'a mut [f64],
) -> Vec<Rows<'a>> {
    let mut runs: Vec<(usize, Range<usize>)> = strands
        .iter()
        .enumerate()
        .flat_map(|(index, strand)| strand.runs.iter().map(move |run| (index, run.clone())))
        .collect();
    runs.sort_unstable_by_key(|(_, run)| run.start);
    let mut rows: Vec<Rows> = strands.iter().map(|_| Rows::default()).collect();
    let mut taken = 0;
    for (index, points) in runs {
        let (_, rest) = residual.split_at_mut(points.start - taken);
        let (of_this, rest) = rest.split_at_mut(points.len());
        residual = rest;
        let blocks = |from: usize, to: usize| (pattern.start(to) - pattern.start(from)) * BLOCK;
        let mut of_these: &mut [f64] = &mut [];
        if !stiffness.is_empty() {
            let (_, rest) = stiffness.split_at_mut(blocks(taken, points.start));
            (of_these, stiffness) = rest.split_at_mut(blocks(points.start, points.end));
        }
        taken = points.end;
        rows[index].0.push(Run { points, residual: of_this, stiffness: of_these });
    }
    rows
}

/// Copies the displacement of an element's control points into its buffers.
fn gather(tables: &Tables, displacement: &[[f64; 3]], element: usize, buffers: &mut ElementBuffers) {
    for (a, control) in tables.connectivity.controls(element).iter().enumerate() {
        for c in 0..3 {
            buffers.displacement[c * tables.padded + a] = displacement[*control][c];
        }
    }
}

/// g − f; `external` may be empty.
pub(super) fn subtract(internal: &[[f64; 3]], external: &[[f64; 3]]) -> Vec<[f64; 3]> {
    if external.is_empty() {
        return internal.to_vec();
    }
    internal.iter().zip(external).map(|(g, f)| [0, 1, 2].map(|c| g[c] - f[c])).collect()
}
