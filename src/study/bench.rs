//! How fast the kernels are, compared with what the machine can do: each figure also as a fraction of a limit measured in the
//! same run.
//!
//! Limits: the floating-point rate of a dense product (faer), for the assembly and the factorization; the rate of a
//! memory copy, for the solve, which reads the factor twice, and for the residual, which reads the tables of functions
//! and points; each on as many threads as the kernel can use. What lies in the caches beats the copy, which does not. An
//! iteration is given as the time that assembly, factorization and solve would take at their limits.
//! Floating-point operations are those that the method needs (the upper half of Fᵀ H F with the Hessian's own cost left
//! out, the squares of the column counts of the factor), not those that padding adds.

use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use crate::equilibrium::{Configuration, DenseProduct, Equilibrium, KernelRun, SolveError, Workspace, WorkspaceError};
use crate::model::{ModelError, starting_mesh};
use crate::pipeline::RunError;
use crate::scene::Scene;
use crate::spline::Elements;
use crate::study::timed_run::timed_run;

/// Size of the dense product.
const PRODUCT_SIZE: usize = 1024;
/// Doubles of the memory copy: far beyond any cache.
const COPY_LEN: usize = 16 * 1024 * 1024;
/// Rotation of the deformed state, degrees.
const ROTATION_DEG: f64 = 4.0;

/// One measured figure.
#[derive(Clone, Debug, Serialize)]
pub struct Figure {
    /// Name of what was timed.
    pub name: &'static str,
    /// Name of the scene file.
    pub scene: String,
    /// Elements each way.
    pub elements: Elements,
    /// Degree each way.
    pub degree: [usize; 2],
    /// Integration rule.
    pub quadrature: String,
    /// Number of threads.
    pub threads: usize,
    /// Number of free unknowns.
    pub unknowns: usize,
    /// Median time, ms; of a whole run its only one.
    pub median_ms: f64,
    /// Share of the limit that bounds it; `None` where none is measured.
    pub fraction_of_peak: Option<f64>,
}

/// Why nothing could be measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BenchError {
    /// The scene cannot be made discrete.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The equations do not fit in memory, or the scene not the mesh.
    #[error(transparent)]
    Workspace(#[from] WorkspaceError),
    /// The deformed state was not found.
    #[error("no equilibrium to time at")]
    Solve(#[from] SolveError),
    /// A whole run failed.
    #[error("the run stopped")]
    Run(#[from] Box<RunError>),
}

/// Times the kernels on the scene's own starting mesh, deformed, `repeats` times each.
///
/// # Errors
/// Where the scene has no deformed state to time at.
pub fn kernel_figures(scene: &Scene, name: &str, repeats: usize) -> Result<Vec<Figure>, BenchError> {
    let mesh = Arc::new(starting_mesh(scene)?);
    let mut work = Workspace::new(scene, &mesh)?;
    let flat = vec![[0.0; 3]; mesh.point_count()];
    let start = Configuration { displacement: &flat, turns: &[], parameter: 0.0, largest_force: 0.0 };
    let target = ROTATION_DEG.min(scene.load.target());
    let solved = Equilibrium::new(scene, &mut work).advance(start, target, &mut |_| false)?;
    let unknowns = work.discretization().unknowns.count();
    let figure = |name: &'static str, seconds: f64, fraction_of_peak: Option<f64>| Figure {
        name,
        scene: String::new(),
        elements: mesh.elements(),
        degree: scene.mesh.degree,
        quadrature: scene.mesh.quadrature.name().to_string(),
        threads: rayon::current_num_threads(),
        unknowns,
        median_ms: 1e3 * seconds,
        fraction_of_peak,
    };
    let threads = rayon::current_num_threads();
    let mut dense = DenseProduct::new(PRODUCT_SIZE);
    let product = median(repeats, || dense.run());
    let flops_per_s = 2.0 * (PRODUCT_SIZE as f64).powi(3) / product;
    let copy = copy_seconds(repeats, 1);
    let bytes_per_s = |threads: usize| 16.0 * COPY_LEN as f64 / copy_seconds(repeats, threads);

    let deformed = Configuration {
        displacement: &solved.displacement,
        turns: &solved.turns,
        parameter: target,
        largest_force: 0.0,
    };
    let mut kernels = KernelRun::new(&mut work, deformed)?;
    let cost = kernels.cost();
    let sharing = threads.min(cost.factor_threads);
    let (all_bytes_per_s, sharing_bytes_per_s) = (bytes_per_s(threads), bytes_per_s(sharing));
    let assemble = median(repeats, || kernels.assemble());
    let residual = median(repeats, || kernels.residual());
    let factor = factor_seconds(repeats, &mut kernels)?;
    let solve = median(repeats, || kernels.solve());
    let iteration = median(repeats, || kernels.newton_iteration());
    let of_flops = |flops: f64, seconds: f64, cores: usize| Some(flops / seconds / (flops_per_s * cores as f64));
    let solve_limit = 2.0 * cost.factor_bytes / sharing_bytes_per_s;
    let at_limits =
        (cost.assembly_flops / threads as f64 + cost.factor_flops / sharing as f64) / flops_per_s + solve_limit;
    let figures = vec![
        figure("dense-product", product, Some(1.0)),
        figure("copy", copy, Some(1.0)),
        figure("assemble", assemble, of_flops(cost.assembly_flops, assemble, threads)),
        figure("residual", residual, Some(cost.table_bytes / residual / all_bytes_per_s)),
        figure("factor", factor, of_flops(cost.factor_flops, factor, sharing)),
        figure("solve", solve, Some(solve_limit / solve)),
        figure("newton-iteration", iteration, Some(at_limits / iteration)),
    ];
    Ok(figures.into_iter().map(|figure| Figure { scene: name.to_string(), ..figure }).collect())
}

/// Times a whole run of a scene, without a log.
///
/// # Errors
/// Where the run stops before its end.
pub fn run_figure(scene: &Scene, name: &str) -> Result<Figure, BenchError> {
    let (records, seconds) = timed_run::<BenchError>(scene)?;
    let last = records.last().map(|record| &record.report);
    Ok(Figure {
        name: "run",
        scene: name.to_string(),
        elements: last.map_or([0, 0].into(), |report| report.elements.clone()),
        degree: scene.mesh.degree,
        quadrature: scene.mesh.quadrature.name().to_string(),
        threads: rayon::current_num_threads(),
        unknowns: last.map_or(0, |report| report.unknowns),
        median_ms: 1e3 * seconds,
        fraction_of_peak: None,
    })
}

/// Numeric factorization alone: what it takes the place of is formed again before each call.
fn factor_seconds(repeats: usize, kernels: &mut KernelRun) -> Result<f64, SolveError> {
    let mut times = Vec::new();
    for _ in 0..=repeats.max(1) {
        kernels.assemble();
        kernels.form();
        let begin = Instant::now();
        kernels.factor()?;
        times.push(begin.elapsed().as_secs_f64());
    }
    // The first one warms up.
    Ok(middle(times.split_off(1)))
}

/// A copy of [`COPY_LEN`] numbers, shared out to threads.
fn copy_seconds(repeats: usize, threads: usize) -> f64 {
    let from = vec![1.0_f64; COPY_LEN];
    let mut to = vec![0.0_f64; COPY_LEN];
    let part = COPY_LEN.div_ceil(threads);
    median(repeats, || {
        let parts = to.par_chunks_mut(part).zip(std::hint::black_box(&from).par_chunks(part));
        parts.for_each(|(to, from)| to.copy_from_slice(from));
        std::hint::black_box(&mut to);
    })
}

/// Median of the times of `repeats` calls, after one that warms up.
fn median<R>(repeats: usize, mut call: impl FnMut() -> R) -> f64 {
    std::hint::black_box(call());
    let times: Vec<f64> = (0..repeats.max(1))
        .map(|_| {
            let begin = Instant::now();
            std::hint::black_box(call());
            begin.elapsed().as_secs_f64()
        })
        .collect();
    middle(times)
}

fn middle(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
