//! The lowest eigenvalue of the stiffness against a dense computation, and from mesh to mesh.

use std::sync::Arc;

use foldline::energy::{Discretization, Want};
use foldline::equilibrium::{Assembled, Configuration, SoftMode, Workspace, soft_mode};
use foldline::record::Outcome;
use foldline::scene::{Scene, parse};
use foldline::spline::Patch;
use foldline::state::State;
use nalgebra::{Cholesky, DMatrix, SymmetricEigen};

use crate::support::{run, scene};

/// The thin roof on a small mesh: its path has points with up to four negative pivots.
fn roof() -> Scene {
    let mut scene = scene("verification/hinged-roof-6.35-snap.toml");
    scene.mesh.elements = [4, 4];
    scene
}

/// ∫N dξ over the parameter domain of each function of a knot vector, by the midpoint rule on its spans (exact enough: the
/// sum is 1), as a share of the domain.
fn shares(knots: &[f64], degree: usize) -> Vec<f64> {
    const PARTS: usize = 400;
    let count = knots.len() - degree - 1;
    let length = knots[knots.len() - 1] - knots[0];
    let mut shares = vec![0.0; count];
    for span in knots.windows(2).filter(|pair| pair[1] > pair[0]) {
        let width = (span[1] - span[0]) / PARTS as f64;
        for part in 0..PARTS {
            let at = span[0] + (part as f64 + 0.5) * width;
            for (i, share) in shares.iter_mut().enumerate() {
                *share += basis(knots, i, degree, at) * width / length;
            }
        }
    }
    shares
}

/// Cox–de Boor.
fn basis(knots: &[f64], i: usize, degree: usize, at: f64) -> f64 {
    if degree == 0 {
        return f64::from(u8::from(knots[i] <= at && at < knots[i + 1]));
    }
    let share = |numerator: f64, denominator: f64| if denominator > 0.0 { numerator / denominator } else { 0.0 };
    share(at - knots[i], knots[i + degree] - knots[i]) * basis(knots, i, degree - 1, at)
        + share(knots[i + degree + 1] - at, knots[i + degree + 1] - knots[i + 1]) * basis(knots, i + 1, degree - 1, at)
}

/// Eigenvalues of K φ = μ M φ at a state, ascending.
fn dense(scene: &Scene, state: &State) -> Vec<f64> {
    let discretization = Discretization::new(scene, &state.mesh).unwrap();
    let unknowns = &discretization.unknowns;
    let free = unknowns.of_displacement(&state.displacement, &state.turns, state.parameter);
    let placement = unknowns.configure(&free, state.parameter);
    let mut assembled = Assembled::new(&discretization);
    assembled.assemble(&discretization, &state.displacement, state.parameter, Want::Stiffness);
    let Patch { knots, degree, .. } = state.mesh.lone();
    let [along, across] = [0, 1].map(|way| shares(&knots[way], degree[way]));
    let count = unknowns.count();
    let (mut stiffness, mut mass) = (DMatrix::zeros(count, count), DMatrix::zeros(count, count));
    for column in 0..count {
        let mut unit = vec![0.0; count];
        unit[column] = 1.0;
        let motion = placement.velocity(&unit, &[]);
        let weighted: Vec<[f64; 3]> = motion
            .iter()
            .enumerate()
            .map(|(point, u)| u.map(|x| x * along[point / across.len()] * across[point % across.len()]))
            .collect();
        let forces = placement.restrict(&assembled.multiply(&discretization, &motion));
        let inertia = placement.restrict(&weighted);
        for row in 0..count {
            (stiffness[(row, column)], mass[(row, column)]) = (forces[row], inertia[row]);
        }
    }
    let root = Cholesky::new(mass).expect("a positive definite mass").l();
    let half = root.solve_lower_triangular(&stiffness).unwrap();
    let reduced = root.solve_lower_triangular(&half.transpose()).unwrap();
    let symmetric = 0.5 * (&reduced + reduced.transpose());
    let mut values: Vec<f64> = SymmetricEigen::new(symmetric).eigenvalues.iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

fn soft(scene: &Scene, state: &State) -> SoftMode {
    let mut work = Workspace::new(scene, &state.mesh).unwrap();
    soft_mode(&mut work, Configuration::of(state)).unwrap()
}

#[test]
fn the_lowest_eigenvalue_is_the_dense_one() {
    let scene = roof();
    let mut seen = [0; 4];
    for (state, record) in run(scene.clone()) {
        let pivots = state.negative_pivots as usize;
        let report = &record.report;
        // Three states of each kind: stable, one negative pivot, two, and more.
        let kind = pivots.min(3);
        if report.outcome != Outcome::Done || seen[kind] == 3 {
            continue;
        }
        seen[kind] += 1;
        let exact = dense(&scene, &state);
        assert_eq!(exact.iter().filter(|value| **value < 0.0).count(), pivots, "step {}", report.step);
        let mode = soft(&scene, &state);
        // Relative to the eigenvalue, or to what rounding leaves of it where it is nearly zero.
        let scale = exact[0].abs().max(1e-9 * exact[exact.len() - 1]);
        let off = (mode.eigenvalue - exact[0]) / scale;
        assert!(off.abs() < 1e-6, "step {}, {pivots} pivots: {} and {}", report.step, mode.eigenvalue, exact[0]);
        assert!(mode.factorizations <= 60, "step {}: {} factorizations", report.step, mode.factorizations);
        check_shape(&mode);
    }
    assert!(seen.iter().all(|count| *count > 0), "states with 0, 1, 2, 3 and more negative pivots: {seen:?}");
}

/// The largest motion is 1, and where it is said to be.
fn check_shape(mode: &SoftMode) {
    let lengths: Vec<f64> = mode.shape.iter().map(|u| u.iter().map(|x| x * x).sum::<f64>().sqrt()).collect();
    assert!((lengths[mode.largest_at] - 1.0).abs() < 1e-12);
    assert!(lengths.iter().all(|length| *length <= 1.0 + 1e-12));
}

/// The same shell on a mesh and on its refinement: an eigenvalue of the shell, and not of its mesh.
#[test]
fn the_lowest_eigenvalue_hardly_depends_on_the_mesh() {
    let eigenvalue = |elements: [usize; 2], load: f64| {
        let mut scene = scene("verification/hinged-roof-12.7.toml");
        scene.mesh.elements = elements;
        scene.load.set_target(load);
        let (state, _) = run(scene.clone()).pop().unwrap();
        soft(&scene, &state).eigenvalue
    };
    for load in [0.1, 0.5] {
        let [coarse, fine] = [eigenvalue([8, 8], load), eigenvalue([16, 16], load)];
        assert!(coarse > 0.0 && (fine / coarse - 1.0).abs() < 0.03, "at {load}: {coarse} and {fine} N/mm");
    }
    // Inserting knots into the undeformed shell changes nothing but the space.
    let scene = scene("verification/hinged-roof-12.7.toml");
    let start = foldline::pipeline::Stages::new(scene.clone()).start().unwrap();
    let mesh = Arc::new(start.mesh.halved());
    let finer = State { displacement: vec![[0.0; 3]; mesh.point_count()], mesh, ..start.clone() };
    let [coarse, fine] = [&start, &finer].map(|state| soft(&scene, state).eigenvalue);
    assert!((fine / coarse - 1.0).abs() < 0.03, "{coarse} and {fine} N/mm");
}

/// Near Euler's load the lowest eigenvalue of a column falls by what the load adds to its geometric stiffness.
#[test]
fn the_eigenvalue_of_a_column_falls_with_its_load() {
    let eigenvalue = |load: f64| {
        let mut column = parse(include_str!("../restart/column.toml"), "column.toml").unwrap();
        column.continuation = None;
        column.pipeline = vec![foldline::scene::Stage::Solve];
        column.mesh.elements = [16, 1];
        column.load.set_target(load);
        let (state, _) = run(column.clone()).pop().unwrap();
        soft(&column, &state).eigenvalue
    };
    // Buckling mode w = 1 − cos(πx/2L): P ∫w'² dx = P (π/2L)² L/2, and the mean of w² is 3/2 − 4/π.
    let slope = |a: f64, b: f64| (eigenvalue(b) - eigenvalue(a)) / (b - a);
    let quarter_wave = std::f64::consts::FRAC_PI_2 / 100.0;
    let expected = -14.3932 * quarter_wave.powi(2) * 50.0 / (1.5 - 4.0 / std::f64::consts::PI);
    let found = slope(0.98, 0.99);
    assert!((found / expected - 1.0).abs() < 0.05, "{found} and {expected} N/mm for an Euler load");
    assert!(eigenvalue(0.99) > 0.0 && eigenvalue(1.01) < 0.0);
}
