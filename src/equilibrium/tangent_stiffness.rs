//! The tangent stiffness on the free unknowns, and its factor.

use crate::energy::Discretization;
use crate::equilibrium::assembly::Assembled;
use crate::equilibrium::gmres::gmres;
use crate::equilibrium::iterate::Effort;
use crate::equilibrium::pattern::{Pattern, couplings};
use crate::equilibrium::solve_error::SolveError;
use crate::equilibrium::sparse::{FactorError, NegativePivots, SparseSolver};
use crate::model::{Blocks, Placement};

/// Relative residual of a solution where the tangent has a skew part; Newton's convergence needs no less.
const SKEW_TOLERANCE: f64 = 1e-9;
/// Largest number of iterations of such a solution: the skew part comes from free edges alone, so that its rank, in
/// effect, is small.
const SKEW_ITERATIONS: usize = 100;

/// The matrix on the free unknowns: the map that fills it, and the solver that holds it.
#[derive(Debug)]
pub(super) struct TangentStiffness {
    pattern: Pattern,
    pub(super) solver: SparseSolver,
    /// Copy of the symmetric part of the matrix, which its factor overwrites; empty where there is no skew part.
    symmetric: Vec<f64>,
}

impl TangentStiffness {
    /// Creates the structure and the solver for a mesh.
    ///
    /// # Errors
    /// Where the factor does not fit in memory.
    pub(super) fn new(discretization: &Discretization) -> Result<Self, FactorError> {
        let solver = SparseSolver::new(&couplings(discretization))?;
        Ok(Self { pattern: Pattern::new(discretization, &solver), solver, symmetric: Vec::new() })
    }

    /// Forms the matrix at a point, Tᵀ K T and what the curvature of the supports adds. Where loads turn with the shell
    /// it is the symmetric part, of which a copy is kept. The factor before is lost.
    pub(super) fn form(&mut self, discretization: &Discretization, placement: &Placement, assembled: &Assembled) {
        self.pattern.fill(discretization, placement, &assembled.stiffness, self.solver.matrix_mut());
        self.solver.add(&placement.curvature(&assembled.forces()));
        self.symmetric = if assembled.has_skew() { self.solver.matrix_mut().to_vec() } else { Vec::new() };
    }

    /// Factors the matrix that was formed or filled in; this is not counted in the effort of a solve.
    pub(super) fn factorize_formed(&mut self) -> Result<NegativePivots, SolveError> {
        let factored = self.solver.factorize();
        factored.map_err(|cause| SolveError::Factor { cause, effort: Effort::default() })
    }

    /// Factors the sum A + λ B of two matrices with the structure of the stiffness, given by their values.
    ///
    /// # Errors
    /// Where a pivot is zero or not a number.
    pub(super) fn factorize_sum(&mut self, a: &[f64], factor: f64, b: &[f64]) -> Result<NegativePivots, SolveError> {
        let sums = a.iter().zip(b).map(|(a, b)| a + factor * b);
        self.solver.matrix_mut().iter_mut().zip(sums).for_each(|(value, sum)| *value = sum);
        self.factorize_formed()
    }

    /// Copies the matrix that was formed, which its factor will overwrite.
    pub(super) fn matrix(&mut self) -> Vec<f64> {
        self.solver.matrix_mut().to_vec()
    }

    /// Forms the matrix at a point and factors it.
    ///
    /// # Errors
    /// Where a pivot is zero or not a number.
    pub(super) fn factorize(
        &mut self,
        discretization: &Discretization,
        placement: &Placement,
        assembled: &Assembled,
    ) -> Result<NegativePivots, FactorError> {
        self.form(discretization, placement, assembled);
        self.solver.factorize()
    }

    /// Solves the whole system at a point where the tangent has a skew part, preconditioned by the factor of the
    /// symmetric part.
    pub(super) fn solve_whole(
        &self,
        discretization: &Discretization,
        placement: &Placement,
        assembled: &Assembled,
        right_hand_side: &[f64],
    ) -> Vec<f64> {
        let whole = |x: &[f64]| {
            let mut product = self.solver.multiply(&self.symmetric, x);
            let moved = placement.velocity(x, &[]);
            let skew = placement.restrict(&assembled.multiply_skew(discretization, &moved));
            product.iter_mut().zip(skew).for_each(|(a, b)| *a += b);
            product
        };
        gmres(right_hand_side, whole, |x| self.solver.solve(x), SKEW_TOLERANCE, SKEW_ITERATIONS)
    }

    /// Computes Tᵀ A T for blocks A, as the values of a matrix.
    pub(super) fn project(&self, discretization: &Discretization, placement: &Placement, blocks: &Blocks) -> Vec<f64> {
        let mut values = vec![0.0; self.solver.value_count()];
        self.pattern.fill(discretization, placement, blocks, &mut values);
        values
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::digest::Hash;
    use crate::energy::{At, Tangent, Term, TermSource, Want};
    use crate::equilibrium::{Configuration, Equilibrium, Workspace};
    use crate::model::{ModelError, Tables, starting_mesh};
    use crate::scene::{Scene, parse};
    use crate::spline::Mesh;

    /// A spring along z between two control points, N/mm.
    #[derive(Clone, Copy, Debug)]
    struct Tie([usize; 2], f64);

    impl TermSource for Tie {
        fn name(&self) -> &str {
            "tie"
        }

        fn hash(&self) -> Hash {
            Hash::from_bytes([0; 32])
        }

        fn on(&self, _: &Scene, _: &Mesh, _: &[Tables]) -> Result<Box<dyn Term>, ModelError> {
            Ok(Box::new(*self))
        }
    }

    impl Tie {
        fn stretch(&self, at: At) -> f64 {
            at.displacement[self.0[1]][2] - at.displacement[self.0[0]][2]
        }
    }

    impl Term for Tie {
        fn pairs(&self) -> Vec<[usize; 2]> {
            vec![self.0]
        }

        fn energy(&self, at: At) -> f64 {
            0.5 * self.1 * self.stretch(at).powi(2)
        }

        fn add_forces(&self, at: At, forces: &mut [[f64; 3]]) {
            let force = self.1 * self.stretch(at);
            forces[self.0[0]][2] += force;
            forces[self.0[1]][2] -= force;
        }

        fn has_tangent(&self) -> bool {
            true
        }

        fn add_tangent(&self, _: At, tangent: &mut Tangent) {
            for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let slope = if a == b { -self.1 } else { self.1 };
                tangent.add([self.0[a], self.0[b]], [[0.0; 3], [0.0; 3], [0.0, 0.0, slope]]);
            }
        }
    }

    const STIFFNESS: f64 = 0.3;

    /// A plate with a tie between two control points that are far apart, or without.
    fn plate(tied: bool) -> (Scene, Workspace, [usize; 2]) {
        let column = include_str!("../../tests/restart/column.toml");
        let bent = column.replace("[-1.43932, 0.0, 0.0]", "[0.0, 0.0, 0.2]");
        let mut scene = parse(&bent, "column.toml").unwrap();
        scene.mesh.elements = [12, 4];
        let mesh = Arc::new(starting_mesh(&scene).unwrap());
        let grid = mesh.lone().grid();
        let points = [grid.index([3, 2]), grid.index([grid.counts[0] - 3, grid.counts[1] - 1])];
        let own: Vec<Arc<dyn TermSource>> = vec![Arc::new(Tie(points, STIFFNESS))];
        let work = Workspace::with_terms(&scene, &mesh, if tied { &own } else { &[] }).unwrap();
        (scene, work, points)
    }

    /// The same matrix in strips, and in supernodes.
    fn of_both_kinds(discretization: &Discretization) -> [TangentStiffness; 2] {
        let couplings = couplings(discretization);
        let solvers = [SparseSolver::new(&couplings).unwrap(), SparseSolver::supernodal(&couplings).unwrap()];
        assert!(matches!(solvers, [SparseSolver::Strips(_), SparseSolver::Supernodal(_)]));
        solvers.map(|solver| TangentStiffness {
            pattern: Pattern::new(discretization, &solver),
            solver,
            symmetric: Vec::new(),
        })
    }

    /// The tie is a matrix of rank one, k e eᵀ, on the unknowns: (K + k e eᵀ)⁻¹ f = x − k z (e·x)/(1 + k e·z) with x = K⁻¹f and
    /// z = K⁻¹e (Sherman & Morrison 1950).
    #[test]
    fn points_far_apart_are_coupled_in_either_storage() {
        let mut solutions = Vec::new();
        for tied in [false, true] {
            let (_, work, points) = plate(tied);
            let discretization = work.discretization();
            let still = vec![[0.0; 3]; discretization.mesh.point_count()];
            let count = discretization.unknowns.count();
            let placement = discretization.unknowns.configure(&vec![0.0; count], 0.0);
            let mut assembled = Assembled::new(discretization);
            assembled.assemble(discretization, &still, 0.0, Want::Stiffness);
            let load: Vec<f64> = (0..count).map(|i| (i * 7919 % 1013) as f64 / 1013.0 - 0.5).collect();
            let mut ends = still.clone();
            (ends[points[0]][2], ends[points[1]][2]) = (-1.0, 1.0);
            let direction = placement.restrict(&ends);
            for mut tangent in of_both_kinds(discretization) {
                tangent.factorize(discretization, &placement, &assembled).unwrap();
                let solve = |mut vector: Vec<f64>| {
                    tangent.solver.solve(&mut vector);
                    vector
                };
                solutions.push([solve(load.clone()), solve(direction.clone()), direction.clone()]);
            }
        }
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let [[x, z, e], _, tied @ ..] = &solutions[..] else { unreachable!() };
        let share = STIFFNESS * product(e, x) / (1.0 + STIFFNESS * product(e, z));
        let scale = x.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        assert!((share * product(e, z)).abs() > 1e-3 * scale, "the tie matters");
        for [found, ..] in tied {
            for (i, found) in found.iter().enumerate() {
                assert!((found - (x[i] - share * z[i])).abs() < 1e-9 * scale, "{i}: {found}");
            }
        }
    }

    /// A solve far into bending ends in one shape on either storage, and the tie bears a part of the load.
    #[test]
    fn a_solve_ends_alike_in_either_storage() {
        let (mut shapes, mut stretches) = (Vec::new(), Vec::new());
        for tied in [true, false] {
            let (scene, mut work, points) = plate(tied);
            for tangent in of_both_kinds(&work.discretization) {
                work.tangent = tangent;
                let still = vec![[0.0; 3]; work.discretization.mesh.point_count()];
                let rest = Configuration { displacement: &still, turns: &[], parameter: 0.0, largest_force: 0.0 };
                let solved = Equilibrium::new(&scene, &mut work).advance(rest, 0.5, &mut |_| false).unwrap();
                let [one, other] = points.map(|point| solved.displacement[point][2]);
                stretches.push((other - one).abs());
                shapes.push(solved.displacement);
            }
        }
        let scale = shapes[0].as_flattened().iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        for (a, b) in shapes[0].as_flattened().iter().zip(shapes[1].as_flattened()) {
            assert!((a - b).abs() < 1e-6 * scale, "{a} {b}");
        }
        assert!(stretches[0] < 0.9 * stretches[2], "{stretches:?}");
    }
}
