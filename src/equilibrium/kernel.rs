//! Energy, residual and stiffness of one element.
//!
//! With F_k(a) the k-th derivative of basis function a at a quadrature point, g the gradient (5 × 3) and H the Hessian
//! (15 × 15) of the point's energy: r(a, c) = Σ_k F_k(a) g(k, c) and K(a c, b d) = Σ_kl F_k(a) H(k c, l d) F_l(b),
//! formed as P(l, d) = Σ_k F_k(a) H(k c, l d) and then Σ_l P(l, d) F_l(b) with the basis function index b contiguous.
//! Only blocks b ≥ a (rounded down to a whole vector) are formed.

use crate::model::{LANES, Tables};
use crate::shell::{Hessian, PointReference};

type Lane = [f64; LANES];
/// Columns of the Hessian with its padding.
const HALF_ROW: usize = 16;

/// Local arrays of one element. `M` vectors of [`LANES`] basis functions.
pub struct ElementBuffers {
    /// `displacement[c · padded + a]`.
    pub displacement: Vec<f64>,
    /// `residual[c · padded + a]`.
    pub residual: Vec<f64>,
    /// `stiffness[((a · 3 + c) · 3 + d) · padded + b]`, valid for b ≥ a.
    pub stiffness: Vec<f64>,
    /// Strain energy.
    pub energy: f64,
    /// Fᵀ H at a point: row `a · 3 + c`.
    half: Vec<[f64; HALF_ROW]>,
}

impl ElementBuffers {
    /// Buffers for `padded` basis functions.
    pub fn new(padded: usize) -> Self {
        Self {
            displacement: vec![0.0; 3 * padded],
            residual: vec![0.0; 3 * padded],
            stiffness: vec![0.0; 9 * padded * padded],
            energy: 0.0,
            half: vec![[0.0; HALF_ROW]; 3 * padded],
        }
    }
}

/// How much of an element is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Want {
    /// Energy only.
    Energy,
    /// Energy and residual.
    Residual,
    /// Energy, residual and stiffness.
    Stiffness,
}

/// Whether this machine runs the AVX2 + FMA build of the kernel; the other build gives results that differ in rounding.
pub fn has_fma_kernel() -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma")
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        false
    }
}

/// Integrates an element into its buffers. `fma` must come from [`has_fma_kernel`].
pub fn integrate_element(tables: &Tables, element: usize, want: Want, fma: bool, buffers: &mut ElementBuffers) {
    let functions = tables.element_functions(element);
    let points = tables.element_points(element);
    macro_rules! dispatch {
        ($($vectors:literal),*) => {
            match tables.padded / LANES {
                $($vectors => run::<$vectors>(functions, points, want, fma, buffers),)*
                other => unreachable!("degrees 2 to 5 have 3 to 9 vectors of basis functions, not {other}"),
            }
        };
    }
    dispatch!(3, 4, 5, 6, 7, 8, 9);
}

fn run<const M: usize>(
    functions: &[f64],
    points: &[PointReference],
    want: Want,
    fma: bool,
    buffers: &mut ElementBuffers,
) {
    #[cfg(target_arch = "x86_64")]
    if fma {
        // SAFETY: `fma` says that the processor has AVX2 and FMA.
        unsafe { integrate_fma::<M>(functions, points, want, buffers) };
        return;
    }
    let _ = fma;
    integrate::<M, false>(functions, points, want, buffers);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn integrate_fma<const M: usize>(
    functions: &[f64],
    points: &[PointReference],
    want: Want,
    buffers: &mut ElementBuffers,
) {
    integrate::<M, true>(functions, points, want, buffers);
}

/// a b + c, rounded once or twice.
#[inline(always)]
fn multiply_add<const FMA: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FMA { a.mul_add(b, c) } else { a * b + c }
}

#[inline(always)]
fn integrate<const M: usize, const FMA: bool>(
    functions: &[f64],
    points: &[PointReference],
    want: Want,
    buffers: &mut ElementBuffers,
) {
    buffers.energy = 0.0;
    buffers.residual.fill(0.0);
    if want == Want::Stiffness {
        buffers.stiffness.fill(0.0);
    }
    let mut hessian: Hessian = [[0.0; 16]; 15];
    for (point, functions) in points.iter().zip(functions.chunks_exact(5 * LANES * M)) {
        let lanes = functions.as_chunks::<LANES>().0;
        let u = displacement_derivatives::<M, FMA>(lanes, &buffers.displacement);
        let gradient = match want {
            Want::Energy => {
                buffers.energy += point.energy(&u);
                continue;
            }
            Want::Residual => {
                let (energy, gradient) = point.gradient(&u);
                buffers.energy += energy;
                gradient
            }
            Want::Stiffness => {
                let (energy, gradient) = point.hessian(&u, &mut hessian);
                buffers.energy += energy;
                contract::<M, FMA>(lanes, &hessian, &mut buffers.half, &mut buffers.stiffness);
                gradient
            }
        };
        let residual = buffers.residual.as_chunks_mut::<LANES>().0;
        for c in 0..3 {
            for m in 0..M {
                let sum = &mut residual[c * M + m];
                for k in 0..5 {
                    for i in 0..LANES {
                        sum[i] = multiply_add::<FMA>(gradient[k][c], lanes[k * M + m][i], sum[i]);
                    }
                }
            }
        }
    }
}

/// u,₁ u,₂ u,₁₁ u,₂₂ u,₁₂ at a point.
#[inline(always)]
fn displacement_derivatives<const M: usize, const FMA: bool>(lanes: &[Lane], displacement: &[f64]) -> [[f64; 3]; 5] {
    let displacement = displacement.as_chunks::<LANES>().0;
    let mut u = [[0.0; 3]; 5];
    for k in 0..5 {
        for c in 0..3 {
            let mut sum = [0.0; LANES];
            for m in 0..M {
                for i in 0..LANES {
                    sum[i] = multiply_add::<FMA>(lanes[k * M + m][i], displacement[c * M + m][i], sum[i]);
                }
            }
            u[k][c] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
        }
    }
    u
}

/// Adds Fᵀ H F to the stiffness. `half` takes Fᵀ H of all functions first: formed one by one in registers it was
/// compiled to scalar code, which took as long as all the rest.
#[inline(always)]
fn contract<const M: usize, const FMA: bool>(
    lanes: &[Lane],
    hessian: &Hessian,
    half: &mut [[f64; HALF_ROW]],
    stiffness: &mut [f64],
) {
    for (a, rows) in half.chunks_exact_mut(3).enumerate() {
        let f = [0, 1, 2, 3, 4].map(|k| lanes[k * M + a / LANES][a % LANES]);
        for (c, row) in rows.iter_mut().enumerate() {
            for q in 0..HALF_ROW {
                let mut sum = f[0] * hessian[c][q];
                sum = multiply_add::<FMA>(f[1], hessian[3 + c][q], sum);
                sum = multiply_add::<FMA>(f[2], hessian[6 + c][q], sum);
                sum = multiply_add::<FMA>(f[3], hessian[9 + c][q], sum);
                row[q] = multiply_add::<FMA>(f[4], hessian[12 + c][q], sum);
            }
        }
    }
    let lanes = &lanes[..5 * M];
    let stiffness = stiffness.as_chunks_mut::<LANES>().0;
    for (ac, p) in half.iter().enumerate() {
        let vector = ac / (3 * LANES);
        for d in 0..3 {
            let w = [p[d], p[3 + d], p[6 + d], p[9 + d], p[12 + d]];
            let row = &mut stiffness[(ac * 3 + d) * M..][..M];
            for m in vector..M {
                let mut sum = row[m];
                for i in 0..LANES {
                    sum[i] = multiply_add::<FMA>(w[0], lanes[m][i], sum[i]);
                    sum[i] = multiply_add::<FMA>(w[1], lanes[M + m][i], sum[i]);
                    sum[i] = multiply_add::<FMA>(w[2], lanes[2 * M + m][i], sum[i]);
                    sum[i] = multiply_add::<FMA>(w[3], lanes[3 * M + m][i], sum[i]);
                    sum[i] = multiply_add::<FMA>(w[4], lanes[4 * M + m][i], sum[i]);
                }
                row[m] = sum;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::starting_mesh;
    use crate::scene::parse;

    /// The build for AVX2 and FMA against the portable one, and the upper half against a plain double sum.
    #[test]
    fn fast_paths_agree_with_slow_ones() {
        for degree in [[2, 2], [3, 3], [2, 4], [5, 5]] {
            let mut scene = parse(include_str!("../../pipelines/baseline.toml"), "baseline.toml").unwrap();
            scene.mesh.degree = degree;
            let tables = Tables::new(&scene, &starting_mesh(&scene).unwrap());
            let padded = tables.padded;
            let functions = (degree[0] + 1) * (degree[1] + 1);
            let integrate = |fma: bool| {
                let mut buffers = ElementBuffers::new(padded);
                for c in 0..3 {
                    for a in 0..functions {
                        buffers.displacement[c * padded + a] = 0.1 * ((a * 31 + c * 17) % 13) as f64 - 0.6;
                    }
                }
                integrate_element(&tables, 5, Want::Stiffness, fma, &mut buffers);
                buffers
            };
            let plain = integrate(false);
            if has_fma_kernel() {
                let fast = integrate(true);
                let scale = plain.stiffness.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
                assert!((fast.energy / plain.energy - 1.0).abs() < 1e-12);
                for (a, b) in fast.stiffness.iter().zip(&plain.stiffness) {
                    assert!((a - b).abs() < 1e-12 * scale, "{degree:?}: {a} {b}");
                }
            }
            check_against_double_sum(&tables, &plain, functions);
        }
    }

    fn check_against_double_sum(tables: &Tables, buffers: &ElementBuffers, functions: usize) {
        let padded = tables.padded;
        let scale = buffers.stiffness.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        for (a, c, b, d) in [(0, 0, functions - 1, 2), (1, 1, 1, 1), (2, 0, 4, 1), (functions - 2, 2, functions - 1, 0)]
        {
            let mut expected = 0.0;
            for (q, point) in tables.element_points(5).iter().enumerate() {
                let f = |k: usize, a: usize| tables.element_functions(5)[(q * 5 + k) * padded + a];
                let mut u = [[0.0; 3]; 5];
                for k in 0..5 {
                    for e in 0..3 {
                        u[k][e] = (0..functions).map(|i| f(k, i) * buffers.displacement[e * padded + i]).sum();
                    }
                }
                let mut hessian: Hessian = [[0.0; 16]; 15];
                point.hessian(&u, &mut hessian);
                for k in 0..5 {
                    for l in 0..5 {
                        expected += f(k, a) * hessian[3 * k + c][3 * l + d] * f(l, b);
                    }
                }
            }
            let found = buffers.stiffness[((a * 3 + c) * 3 + d) * padded + b];
            assert!((found - expected).abs() < 1e-12 * scale, "({a}, {c}) ({b}, {d}): {found} {expected}");
        }
    }
}
