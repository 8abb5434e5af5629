//! The shell as a term: sums of energy, residual and stiffness over its elements.
//!
//! The order of sums is that of the [`Connectivity`](crate::model::Connectivity): threads work on strands of elements, strands of
//! one colour at once, each on its own slices of the sums, since they share no control point; colours follow each other.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use crate::energy::kernel::{Build, ElementBuffers, Want, integrate_element};
use crate::energy::term::{At, Tangent, Term};
use crate::model::{BLOCK, BlockPattern, Blocks, FreeStrains, NaturalState, Strand, Tables};
use crate::shell::sub;

/// The shell on a mesh: strain energy between its natural state and the deformed one.
///
/// Energy, forces and tangent share most of their work: [`Self::elements`] sums several of them at once, and gives the
/// same numbers as the methods of [`Term`] one by one.
#[derive(Debug)]
pub struct Shell {
    /// Shape functions and undeformed shell at the quadrature points.
    pub tables: Tables,
    /// Strains that have no energy, over the parameter.
    pub free_strains: FreeStrains,
    /// Pattern of the matrix that its elements are a part of.
    pub blocks: Arc<BlockPattern>,
    /// Index of that part: the place of the shell in the structure.
    pub part: usize,
}

impl Shell {
    /// Elements of the shell, where `natural` is the state without forces (`None`: the undeformed state).
    #[doc(hidden)]
    pub fn elements(&self, natural: Option<NaturalState>) -> ShellElements<'_> {
        ShellElements { tables: &self.tables, blocks: &self.blocks, part: self.part, natural }
    }

    /// Computes the gradient of the strain energy, N, where `natural` is the state without forces.
    fn residual(&self, displacement: &[[f64; 3]], natural: Option<NaturalState>) -> Vec<[f64; 3]> {
        let mut residual = vec![[0.0; 3]; displacement.len()];
        let elements = self.elements(natural);
        elements.add(displacement, Want::Residual, &mut residual, &mut Blocks::default());
        residual
    }
}

impl Term for Shell {
    fn energy(&self, at: At) -> f64 {
        strain_energy(&self.tables, at.displacement, self.free_strains.at(at.parameter))
    }

    fn add_forces(&self, at: At, forces: &mut [[f64; 3]]) {
        let residual = self.residual(at.displacement, self.free_strains.at(at.parameter));
        forces.iter_mut().zip(residual).for_each(|(sum, force)| *sum = sub(*sum, force));
    }

    fn has_tangent(&self) -> bool {
        true
    }

    fn add_tangent(&self, at: At, tangent: &mut Tangent) {
        let mut residual = vec![[0.0; 3]; at.displacement.len()];
        let elements = self.elements(self.free_strains.at(at.parameter));
        elements.add(at.displacement, Want::Stiffness, &mut residual, tangent.stiffness_of(&self.blocks));
    }

    fn add_rates(&self, at: At, rates: &mut [[f64; 3]]) {
        // Forces are linear in the free strain.
        let Some(beyond) = self.free_strains.beyond(at.parameter) else { return };
        let there = self.residual(at.displacement, Some(beyond));
        let here = self.residual(at.displacement, self.free_strains.at(at.parameter));
        for (sum, (there, here)) in rates.iter_mut().zip(there.into_iter().zip(here)) {
            *sum = sub(*sum, sub(there, here));
        }
    }

    fn put_in(&self, from: At, to: f64) -> f64 {
        // Strain energy changes with its natural state alone.
        let natural = |parameter: f64| self.free_strains.at(parameter);
        match (natural(from.parameter), natural(to)) {
            (None, None) => 0.0,
            states => {
                let [before, after] =
                    <[_; 2]>::from(states).map(|natural| strain_energy(&self.tables, from.displacement, natural));
                after - before
            }
        }
    }
}

/// Computes the strain energy of the model at a displacement of the control points that `tables` act on, N·mm.
/// `natural` is the state without forces, where that is not the undeformed one. Sums have the order of
/// [`ShellElements::add`].
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

/// Energy of the points plus the energy that layers lock in each other, N·mm.
pub(crate) fn with_locked(energy: f64, natural: Option<NaturalState>) -> f64 {
    natural.map_or(energy, |natural| energy + natural.locked_n_mm)
}

/// Elements of a shell, and where they add to a matrix on control points that other patches may share.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct ShellElements<'a> {
    /// Tables of the elements.
    pub tables: &'a Tables,
    /// Pattern of the matrix.
    pub blocks: &'a BlockPattern,
    /// Index of the part of the pattern that these elements make.
    pub part: usize,
    /// State without forces, where that is not the undeformed one.
    pub natural: Option<NaturalState>,
}

impl ShellElements<'_> {
    /// Adds residual and stiffness at a displacement of the control points, the latter only where `want` says so.
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
            // Blocks below the diagonal are stored as their transposes.
            for (b, slot) in (a..).zip(of_this).filter(|(b, _)| !ascending && *i > controls[*b]) {
                let block = &mut rows.blocks(self.blocks, controls[b])[*slot as usize * BLOCK..][..BLOCK];
                for cd in 0..BLOCK {
                    block[cd] += local[(b * BLOCK + cd) * padded + a];
                }
            }
        }
    }
}

/// Sums over elements beyond those on control points.
#[doc(hidden)]
#[derive(Clone, Copy, Debug, Default)]
pub struct ElementSums {
    /// Strain energy, N·mm.
    pub energy: f64,
    /// Sum of the squares of the elements' forces on their control points, N².
    pub squared_forces: f64,
}

/// A run of successive control points with their part of the sums.
struct Run<'a> {
    points: Range<usize>,
    residual: &'a mut [[f64; 3]],
    /// Rows of blocks of these control points; empty where no stiffness is asked for.
    stiffness: &'a mut [f64],
}

/// Slices that the elements of a strand add to: runs in ascending order.
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

    /// Blocks in the row of a control point.
    fn blocks(&mut self, pattern: &BlockPattern, point: usize) -> &mut [f64] {
        let run = self.run(point);
        let first = pattern.start(run.points.start);
        &mut run.stiffness[(pattern.start(point) - first) * BLOCK..(pattern.start(point + 1) - first) * BLOCK]
    }
}

/// Splits the sums into disjoint slices for strands that share no control point.
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
