//! Linear buckling about an equilibrium: load factors and modes.
//!
//! With the rate v of the displacement with the parameter λ by linear theory, the tangent stiffness changes by λ K_σ, the stiffness
//! of the stresses that v causes in the geometry of the equilibrium: those of shells (membrane and bending), joints, bonds, loads that turn
//! with the shell, and of forces on sections that turn. Modes are those of K φ = −λ K_σ φ. Deformation before buckling is left
//! out: the whole derivative of the tangent along v is another problem.
//!
//! At a point the tangent is linear in the stresses: K_σ is its Hessian with stress-free strains that are smaller by the strains of v, less
//! the Hessian itself.
//!
//! The eigenvalues are found by subspace iteration with K⁻¹K_σ in the inner product of K (Bathe, *Finite Element Procedures*, 2nd ed.,
//! section 11.6), and counted: K + λ K_σ has as many negative pivots as there are modes below λ (Sylvester), so that no mode of a
//! cluster is missed.

use nalgebra::DMatrix;

use crate::energy::{At, Discretization, Shell};
use crate::equilibrium::assembly::subtract;
use crate::equilibrium::configuration::Configuration;
use crate::equilibrium::equations::Equations;
use crate::equilibrium::solve_error::SolveError;
use crate::equilibrium::tangent_stiffness::TangentStiffness;
use crate::equilibrium::vector::{product, scale_to_one};
use crate::equilibrium::workspace::Workspace;
use crate::model::{BLOCK, Blocks, PointTable};
use crate::shell::{Hessian, PointReference, add, dot, norm, scaled};

/// Largest number of iterations of the subspace.
const MAX_ITERATIONS: usize = 300;
/// Relative change of the eigenvalues that are asked for below which they have settled.
const SETTLED: f64 = 1e-9;
/// The same, up to which they are not said to be unsettled.
const SHOWN: f64 = 1e-7;
/// Vectors beyond twice the number of modes that is asked for.
const MORE: usize = 6;
/// Motion by which strains are differentiated, relative to the size of the element: their curvature leaves the square of it.
const SLIGHTLY: f64 = 1e-4;
/// How far beyond a load factor the modes below it are counted, relative.
const BEYOND: f64 = 1e-6;

/// A matrix by its values, times a vector.
type Product<'a> = dyn Fn(&[f64], &[f64]) -> Vec<f64> + 'a;
/// A right hand side, replaced by the solution.
type Solution<'a> = dyn Fn(&mut Vec<f64>) + 'a;

/// A mode of linear buckling.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct BucklingMode {
    /// Change of the scene's parameter at which it buckles.
    pub factor: f64,
    /// Displacement of the control points, scaled to a largest length of 1.
    pub shape: Vec<[f64; 3]>,
    /// Control point that moves most.
    pub largest_at: usize,
}

/// The lowest modes of linear buckling.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct BucklingModes {
    /// Modes under a growing parameter, the lowest first.
    pub modes: Vec<BucklingMode>,
    /// Number of modes up to the last of these, by the pivots of the stiffness there.
    pub counted: usize,
    /// Change of the parameter of the first mode in the other sense, if one was met.
    pub reversed: Option<f64>,
    /// Whether the load factors have settled, to a change of 1e-7.
    pub settled: bool,
}

/// Why there is no linear buckling of a state.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BucklingError {
    /// The stiffness has no factor.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The state is not stable.
    #[error(
        "the equilibrium has {negative} negative pivots: it is not stable, and buckling is told of stable ones; take a load step before it"
    )]
    Unstable {
        /// Number of negative pivots.
        negative: usize,
    },
    /// Nothing changes with the parameter.
    #[error("nothing moves as the load factor grows, and nothing can buckle")]
    Still,
}

/// Finds the lowest modes of linear buckling about an equilibrium.
///
/// # Errors
/// Where the stiffness has no factor, the state is not stable, or nothing depends on the parameter.
pub fn linear_buckling(work: &mut Workspace, at: Configuration, count: usize) -> Result<BucklingModes, BucklingError> {
    let mut equations = Equations::of(work, at);
    let point = equations.at_configuration(at)?;
    let negative = point.iterate.negative_pivots;
    if negative > 0 {
        return Err(BucklingError::Unstable { negative });
    }
    let rates: Vec<f64> = equations.solve(&point, &point.gradient_rate).into_iter().map(|rate| -rate).collect();
    let placement = &point.here.placement;
    let velocity = placement.velocity(&rates, &point.given_rates);
    if velocity.iter().all(|moved| norm(*moved) == 0.0) {
        return Err(BucklingError::Still);
    }
    let Equations { discretization, tangent, assembled, .. } = equations;
    let moment = At { mesh: &discretization.mesh, displacement: at.displacement, parameter: at.parameter };
    let stress = stress_stiffness(discretization, moment, &velocity);
    let mut stress_matrix = tangent.project(discretization, placement, &stress);
    // Forces on sections that turn: internal ones less loads, per unit of the parameter.
    let stiff = assembled.multiply(discretization, &velocity);
    let forces = subtract(&stiff, &discretization.terms.rates(moment));
    for (one, other, value) in placement.curvature(&forces) {
        stress_matrix[tangent.solver.offset_of(one, other)] += value;
    }
    tangent.form(discretization, placement, assembled);
    let stiffness = tangent.matrix();
    let free = rates.len();
    let mut block = (2 * count + MORE).min(free);
    let mut shift = 0.0;
    loop {
        let shifted: Vec<f64> = stiffness.iter().zip(&stress_matrix).map(|(k, s)| k + shift * s).collect();
        tangent.solver.matrix_mut().copy_from_slice(&shifted);
        tangent.factorize_formed()?;
        let product_with = |values: &[f64], vector: &[f64]| tangent.solver.multiply(values, vector);
        let solve = |vector: &mut Vec<f64>| tangent.solver.solve(vector);
        let matrices = [&stiffness[..], &stress_matrix[..]];
        let (found, settled) = Subspace::new(free, block).settled((count, shift), matrices, &product_with, &solve);
        let mut positive: Vec<&(f64, Vec<f64>)> = found.iter().filter(|(factor, _)| *factor > 0.0).collect();
        positive.sort_by(|one, other| one.0.total_cmp(&other.0));
        positive.truncate(count);
        // Where more modes of the reversed load lie nearer to 0 than the subspace holds, it has too few of the load itself.
        if shift == 0.0 && positive.len() < count && found.len() > positive.len() {
            let near = found.iter().map(|(factor, _)| factor.abs()).fold(f64::INFINITY, f64::min);
            let known = (positive.len(), count);
            if let Some(amid) = amid_first(tangent, (&stiffness, &stress_matrix), near, known)? {
                shift = amid;
                continue;
            }
        }
        let last = positive.last().map(|(factor, _)| *factor);
        let counted = match last {
            None => 0,
            Some(last) => tangent.factorize_sum(&stiffness, (1.0 + BEYOND) * last, &stress_matrix)?.count,
        };
        // A cluster that the subspace did not hold whole: a larger one does.
        if counted > positive.len() && block < free {
            block = (2 * block).min(free);
            if block < 16 * (count + MORE) {
                continue;
            }
        }
        let modes = positive.into_iter().map(|(factor, vector)| {
            let mut shape = placement.velocity(vector, &[]);
            let (largest_at, _) = scale_to_one(&mut shape);
            BucklingMode { factor: *factor, shape, largest_at }
        });
        let reversed = found.iter().map(|(factor, _)| *factor).filter(|factor| *factor < 0.0).reduce(f64::max);
        return Ok(BucklingModes { modes: modes.collect(), counted, reversed, settled });
    }
}

/// Finds a load factor with `count` modes below twice it, or with more than `known` where there are not so many up to [`FARTHEST`] times
/// `near`, by counting pivots from `near` on; `None` where there are no more at all. Modes of the reversed load lie farther from it than
/// these.
fn amid_first(
    tangent: &mut TangentStiffness,
    (stiffness, stress): (&[f64], &[f64]),
    near: f64,
    (known, count): (usize, usize),
) -> Result<Option<f64>, SolveError> {
    let mut below = |factor: f64| tangent.factorize_sum(stiffness, factor, stress).map(|negative| negative.count);
    if !(near.is_finite() && near > 0.0) {
        return Ok(None);
    }
    // The farthest factor that has no more below it, and the nearest one that has enough.
    let (mut few, mut enough, mut most) = (0.0, None, known);
    let mut factor = near;
    while enough.is_none() && factor <= FARTHEST * near {
        let now = below(factor)?;
        match now {
            now if now >= count => enough = Some(factor),
            now if now > most => (few, most) = (factor, now),
            _ if most == known => few = factor,
            _ => {}
        }
        factor *= 2.0;
    }
    let Some(mut enough) = enough else { return Ok((most > known).then_some(0.5 * few)) };
    for _ in 0..HALVINGS {
        let middle = 0.5 * (few + enough);
        match below(middle)? {
            now if now >= count => enough = middle,
            _ => few = middle,
        }
    }
    Ok(Some(0.5 * enough))
}

/// Largest load factor that is searched, relative to that of the reversed load.
const FARTHEST: f64 = 1e6;
/// Halvings of the stretch in which the last load factor that is asked for lies.
const HALVINGS: usize = 5;

/// Vectors that turn towards the modes with the smallest load factors.
struct Subspace {
    vectors: Vec<Vec<f64>>,
}

impl Subspace {
    /// Creates start vectors, the same in every run, without any symmetry.
    fn new(free: usize, block: usize) -> Self {
        let value =
            |k: usize, i: usize| ((i + 1) as f64 * (0.618_033_988_75 + 0.171_572_875_25 * k as f64)).fract() - 0.5;
        Self { vectors: (0..block).map(|k| (0..free).map(|i| value(k, i)).collect()).collect() }
    }

    /// Iterates with the matrix at a shift until the first `count` positive factors have settled; returns factors and modes, the ones
    /// nearest to the shift first, and whether they have.
    fn settled(
        mut self,
        (count, shift): (usize, f64),
        [stiffness, stress]: [&[f64]; 2],
        multiply: &Product,
        solve: &Solution,
    ) -> (Vec<(f64, Vec<f64>)>, bool) {
        let mut last: Vec<f64> = Vec::new();
        let (mut factors, mut is_settled) = (Vec::new(), false);
        for _ in 0..MAX_ITERATIONS {
            for vector in &mut self.vectors {
                let mut next = multiply(stress, vector);
                next.iter_mut().for_each(|value| *value = -*value);
                solve(&mut next);
                *vector = next;
            }
            factors = self.project([stiffness, stress], shift, multiply);
            let mut lowest: Vec<f64> = factors.iter().copied().filter(|factor| *factor > 0.0).collect();
            lowest.sort_by(f64::total_cmp);
            lowest.truncate(count);
            let changed = |share: f64| {
                let pairs = lowest.iter().zip(&last);
                lowest.len() != last.len()
                    || pairs.into_iter().any(|(now, before)| (now - before).abs() > share * now.abs())
            };
            is_settled = !lowest.is_empty() && !changed(SHOWN);
            if is_settled && !changed(SETTLED) {
                break;
            }
            last = lowest;
        }
        (factors.into_iter().zip(self.vectors).collect(), is_settled)
    }

    /// Turns the vectors into the best approximations of modes among their sums (Rayleigh and Ritz), orthonormal in K, and returns
    /// their load factors, the ones nearest to the shift first.
    fn project(&mut self, matrices: [&[f64]; 2], shift: f64, multiply: &Product) -> Vec<f64> {
        let size = self.vectors.len();
        let [k, s] = matrices.map(|matrix| {
            let images: Vec<Vec<f64>> = self.vectors.iter().map(|vector| multiply(matrix, vector)).collect();
            let form = |i: usize, j: usize| {
                0.5 * (product(&self.vectors[i], &images[j]) + product(&self.vectors[j], &images[i]))
            };
            DMatrix::from_fn(size, size, form)
        });
        // In an orthonormal basis of the span; directions that are lost to rounding are left out.
        let scales: Vec<f64> = (0..size).map(|i| 1.0 / k[(i, i)].max(f64::MIN_POSITIVE).sqrt()).collect();
        let scaled_k = DMatrix::from_fn(size, size, |i, j| scales[i] * k[(i, j)] * scales[j]);
        let eigen = scaled_k.symmetric_eigen();
        let largest = eigen.eigenvalues.max();
        let kept: Vec<usize> = (0..size).filter(|i| eigen.eigenvalues[*i] > 1e-13 * largest).collect();
        let basis = DMatrix::from_fn(size, kept.len(), |i, column| {
            scales[i] * eigen.eigenvectors[(i, kept[column])] / eigen.eigenvalues[kept[column]].sqrt()
        });
        let reduced = basis.transpose() * &s * &basis;
        let inner = (0.5 * (&reduced + reduced.transpose())).symmetric_eigen();
        let factor = |column: usize| -1.0 / inner.eigenvalues[column];
        let mut order: Vec<usize> = (0..kept.len()).collect();
        order.sort_by(|a, b| (factor(*a) - shift).abs().total_cmp(&(factor(*b) - shift).abs()));
        let turned = &basis * &inner.eigenvectors;
        let free = self.vectors.first().map_or(0, Vec::len);
        let combined = |column: usize| {
            let mut sum = vec![0.0; free];
            for (i, vector) in self.vectors.iter().enumerate() {
                let share = turned[(i, column)];
                sum.iter_mut().zip(vector).for_each(|(sum, value)| *sum += share * value);
            }
            sum
        };
        let vectors: Vec<Vec<f64>> = order.iter().map(|column| combined(*column)).collect();
        self.vectors = vectors;
        order.into_iter().map(factor).collect()
    }
}

/// Computes the stiffness of the stresses that a rate of the displacement causes, on the control points.
fn stress_stiffness(discretization: &Discretization, at: At, velocity: &[[f64; 3]]) -> Blocks {
    let mut blocks = Blocks::zeros(&discretization.blocks);
    for shell in &discretization.shells {
        add_shell(discretization, shell, &shell.tables.points, at, velocity, &mut blocks);
        if let Some(stretching) = &shell.tables.stretching {
            add_shell(discretization, shell, stretching, at, velocity, &mut blocks);
        }
    }
    discretization.terms.add_stress_stiffness(at, velocity, &discretization.blocks, &mut blocks);
    blocks
}

/// Derivatives of a field at a quadrature point.
type Derivatives = [[f64; 3]; 5];

fn add_shell<Batch, const ROWS: usize>(
    discretization: &Discretization,
    shell: &Shell,
    table: &PointTable<Batch, ROWS>,
    at: At,
    velocity: &[[f64; 3]],
    blocks: &mut Blocks,
) {
    let (tables, pattern) = (&shell.tables, &discretization.blocks);
    let padded = tables.padded;
    let natural = shell.free_strains.at(at.parameter);
    for element in 0..tables.connectivity.elements() {
        let controls = tables.connectivity.controls(element);
        let mut local = vec![[[0.0; 3]; 3]; controls.len() * controls.len()];
        for (q, reference) in table.element_points(element).iter().enumerate() {
            let point = natural.map_or(*reference, |natural| reference.under(&natural.strain));
            let functions = &table.element_functions(element)[q * ROWS * padded..][..ROWS * padded];
            let derivatives = |field: &[[f64; 3]]| -> Derivatives {
                let mut sums = [[0.0; 3]; 5];
                for (k, row) in functions.chunks(padded).enumerate() {
                    for (control, share) in controls.iter().zip(row) {
                        sums[k] = add(sums[k], scaled(*share, field[*control]));
                    }
                }
                sums
            };
            let difference = stress_hessian(&point, &derivatives(at.displacement), &derivatives(velocity));
            add_point(&mut local, controls.len(), functions, padded, &difference);
        }
        for (a, i) in controls.iter().enumerate() {
            for (b, j) in controls.iter().enumerate().filter(|(_, j)| *j >= i) {
                let Some(block) = pattern.block(*i, *j) else { unreachable!("control points of an element meet") };
                let values = blocks.block_mut(block);
                (0..BLOCK).for_each(|cd| values[cd] += local[a * controls.len() + b][cd / 3][cd % 3]);
            }
        }
    }
}

/// The part of the Hessian of a point that the stresses of a rate make, per unit of it.
fn stress_hessian(point: &PointReference, u: &Derivatives, rate: &Derivatives) -> Hessian {
    let size = rate.iter().map(|vector| dot(*vector, *vector)).sum::<f64>().sqrt();
    let lengths = point.tangent_lengths();
    let step = SLIGHTLY * lengths[0].min(lengths[1]) / size.max(f64::MIN_POSITIVE);
    let moved = |sign: f64| [0, 1, 2, 3, 4].map(|k| add(u[k], scaled(sign * step, rate[k])));
    let strains = point.strain_rates(&moved(1.0), &moved(-1.0), 2.0 * step);
    let (mut with, mut without): (Hessian, Hessian) = ([[0.0; 16]; 15], [[0.0; 16]; 15]);
    point.stressed(&strains).hessian(u, &mut with);
    point.hessian(u, &mut without);
    for (row, other) in with.iter_mut().zip(&without) {
        row.iter_mut().zip(other).for_each(|(value, other)| *value -= other);
    }
    with
}

/// Adds Σ N_k(a) H_kc,ld N_l(b) of a point for all pairs of control points.
fn add_point(local: &mut [[[f64; 3]; 3]], count: usize, functions: &[f64], padded: usize, hessian: &Hessian) {
    let rows: Vec<&[f64]> = functions.chunks(padded).collect();
    for b in 0..count {
        let mut half = [[0.0; 3]; 15];
        for (row, half) in hessian.iter().zip(&mut half) {
            for (l, functions) in rows.iter().enumerate() {
                (0..3).for_each(|d| half[d] += row[3 * l + d] * functions[b]);
            }
        }
        for a in 0..count {
            let sum = &mut local[a * count + b];
            for (k, functions) in rows.iter().enumerate() {
                for c in 0..3 {
                    (0..3).for_each(|d| sum[c][d] += functions[a] * half[3 * k + c][d]);
                }
            }
        }
    }
}
