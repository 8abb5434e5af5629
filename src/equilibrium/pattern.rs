//! From the blocks on control points to the sparse matrix on free unknowns: K_q = Tᵀ K T.
//!
//! Built once per mesh. Almost every block belongs to two control points whose components are unknowns of their own,
//! and is copied; the others (supports, symmetry, joints) go through their directions.

use rayon::prelude::*;

use crate::energy::Discretization;
use crate::equilibrium::sparse::{Couplings, SparseSolver};
use crate::model::{BLOCK, Blocks, Placement};

/// Number of entries of the matrix that a thread fills at a time.
const SHARE: usize = 1 << 14;

/// Map from the blocks on control points to the entries of the matrix.
#[derive(Debug)]
pub struct Pattern {
    /// Index of the number in the blocks that is copied to each entry of the matrix; [`NOWHERE`] where there is none.
    sources: Vec<u32>,
    projected: Vec<ProjectedBlock>,
}

/// Index of no number: beyond all blocks and every matrix.
const NOWHERE: u32 = u32::MAX;

/// Block of control points of which at least one is constrained.
#[derive(Debug)]
struct ProjectedBlock {
    block: usize,
    points: [usize; 2],
    /// Entry of the matrix for each pair of entries, row-major; `NOWHERE` where the transposed entry is stored instead.
    targets: Vec<u32>,
}

/// Finds the free unknowns that meet in the matrix: those of control points that have a block.
pub fn couplings(discretization: &Discretization) -> Couplings {
    let unknowns = &discretization.unknowns;
    let of_point = |point| unknowns.entries_of(point).iter().map(|entry| entry.coordinate).collect();
    Couplings {
        unknowns: unknowns.count(),
        groups: (0..discretization.blocks.points()).map(of_point).collect(),
        pairs: discretization.blocks.pairs().collect(),
    }
}

impl Pattern {
    /// Creates the map for a matrix that a solver holds for these [`couplings`].
    pub fn new(discretization: &Discretization, solver: &SparseSolver) -> Self {
        let mut pattern = Self { sources: vec![NOWHERE; solver.value_count()], projected: Vec::new() };
        for (block, points) in discretization.blocks.pairs().enumerate() {
            pattern.map_block(discretization, solver, block * BLOCK, points);
        }
        pattern
    }

    fn map_block(&mut self, discretization: &Discretization, solver: &SparseSolver, block: usize, points: [usize; 2]) {
        let unknowns = &discretization.unknowns;
        let [i, j] = points;
        let stored = |a: usize, b: usize| i != j || a >= b;
        if unknowns.is_regular(i) && unknowns.is_regular(j) {
            let (a, b) = (unknowns.entries_of(i)[0].coordinate, unknowns.entries_of(j)[0].coordinate);
            for k in (0..BLOCK).filter(|k| stored(k / 3, k % 3)) {
                self.sources[target(solver, a + k / 3, b + k % 3) as usize] = (block + k) as u32;
            }
            return;
        }
        let targets = unknowns
            .entries_of(i)
            .iter()
            .enumerate()
            .flat_map(|(x, a)| unknowns.entries_of(j).iter().enumerate().map(move |(y, b)| (x, a, y, b)))
            .map(|(x, a, y, b)| if stored(x, y) { target(solver, a.coordinate, b.coordinate) } else { NOWHERE })
            .collect();
        self.projected.push(ProjectedBlock { block, points, targets });
    }

    /// Fills in the values of the matrix.
    pub fn fill(&self, discretization: &Discretization, placement: &Placement, blocks: &Blocks, values: &mut [f64]) {
        let shares = values.par_chunks_mut(SHARE).zip(self.sources.par_chunks(SHARE));
        shares.for_each(|(values, sources)| {
            for (value, source) in values.iter_mut().zip(sources) {
                *value = blocks.values.get(*source as usize).copied().unwrap_or(0.0);
            }
        });
        let unknowns = &discretization.unknowns;
        for projected in &self.projected {
            let block = &blocks.values[projected.block..][..BLOCK];
            let [i, j] = projected.points;
            let mut targets = projected.targets.iter();
            for (a, left) in unknowns.entries_of(i).iter().zip(placement.directions_of(i)) {
                for (b, right) in unknowns.entries_of(j).iter().zip(placement.directions_of(j)) {
                    let Some(&target) = targets.next() else { continue };
                    if target == NOWHERE {
                        continue;
                    }
                    let mut value = 0.0;
                    for c in 0..3 {
                        for d in 0..3 {
                            value += left[c] * block[3 * c + d] * right[d];
                        }
                    }
                    // An unknown that two points share meets itself in their block and in the transposed block.
                    let twice = i != j && a.coordinate == b.coordinate;
                    values[target as usize] += if twice { 2.0 * value } else { value };
                }
            }
        }
    }
}

fn target(solver: &SparseSolver, a: usize, b: usize) -> u32 {
    // A solver holds fewer than 2³² values.
    solver.offset_of(a, b) as u32
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::energy::Want;
    use crate::equilibrium::assembly::Assembled;
    use crate::model::starting_mesh;
    use crate::scene::{Geometry, Symmetry, parse};

    /// K_q d against Tᵀ (K (T d)), which goes through none of the targets: in every symmetry, and on an arc with
    /// joints.
    #[test]
    fn the_matrix_is_the_projected_stiffness() {
        for (symmetry, arc_deg) in [
            (Symmetry::None, 110.0),
            (Symmetry::HalfLength, 110.0),
            (Symmetry::HalfArc, 110.0),
            (Symmetry::Quarter, 110.0),
            (Symmetry::None, 300.0),
            (Symmetry::Quarter, 350.0),
        ] {
            let mut scene = parse(include_str!("../../pipelines/baseline.toml"), "baseline.toml").unwrap();
            scene.symmetry = symmetry;
            scene.geometry = Geometry::TapeSpring { length_mm: 100.0, radius_mm: 10.0, arc_deg };
            scene.mesh.elements = [6, 6];
            let mesh = Arc::new(starting_mesh(&scene).unwrap());
            let discretization = Discretization::new(&scene, &mesh).unwrap();
            let count = discretization.unknowns.count();
            let vector =
                |seed: usize| (0..count).map(|i| ((i * 7919 + seed) % 1013) as f64 / 1013.0 - 0.5).collect::<Vec<_>>();
            let state: Vec<f64> = vector(5).iter().map(|x| 0.02 * x).collect();
            let placement = discretization.unknowns.configure(&state, 17.0);
            let mut assembled = Assembled::new(&discretization);
            assembled.assemble(&discretization, &placement.displacement(), 0.0, Want::Stiffness);

            let direction = vector(11);
            let field = placement.velocity(&direction, &[]);
            let expected = placement.restrict(&assembled.multiply(&discretization, &field));

            let couplings = couplings(&discretization);
            let solvers = [SparseSolver::new(&couplings).unwrap(), SparseSolver::supernodal(&couplings).unwrap()];
            let scale = expected.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            for solver in solvers {
                let pattern = Pattern::new(&discretization, &solver);
                let mut values = vec![0.0; solver.value_count()];
                pattern.fill(&discretization, &placement, &assembled.stiffness, &mut values);
                let product = solver.multiply(&values, &direction);
                for (a, b) in product.iter().zip(&expected) {
                    assert!((a - b).abs() < 1e-11 * scale, "{symmetry:?} {arc_deg}°: {a} {b}");
                }
            }
        }
    }

    /// A plate that is long in v takes as much work as one that is long in u: unknowns are numbered along the longer way.
    #[test]
    fn the_longer_way_does_not_matter() {
        let flops = |elements: [usize; 2]| {
            let text = include_str!("../../tests/restart/column.toml");
            let mut scene = parse(text, "column.toml").unwrap();
            scene.mesh.elements = elements;
            let mesh = Arc::new(starting_mesh(&scene).unwrap());
            let discretization = Discretization::new(&scene, &mesh).unwrap();
            SparseSolver::new(&couplings(&discretization)).unwrap().flops()
        };
        let (along, across) = (flops([40, 4]), flops([4, 40]));
        // Numbered along the shorter direction a band would be six times as wide, with 36 times the work.
        assert!(across < 1.5 * along && along < 3.0 * across, "{along:e} {across:e}");
    }
}
