//! What equilibrium and released energy are compared with: forces that are there where reactions vanish, and the work of
//! moments that turn with the shell.

use std::f64::consts::PI;

use foldline::equilibrium::{Configuration, Workspace};
use foldline::record::Record;
use foldline::scene::{Scene, parse};
use foldline::state::State;

use crate::support::{run, steps};

fn scene(name: &str, text: &str) -> Scene {
    parse(text, name).unwrap_or_else(|error| panic!("{error}"))
}

/// Reactions and residual together, N: internal forces less loads on all control points.
fn forces(scene: &Scene, state: &State) -> f64 {
    let work = Workspace::new(scene, &state.mesh).unwrap();
    work.forces(Configuration::of(state)).iter().flatten().map(|force| force * force).sum::<f64>().sqrt()
}

/// Newton iterations of every load step that continued.
fn iterations(stages: &[(State, Record)]) -> Vec<usize> {
    steps(stages).iter().map(|(_, record)| record.report.iterations).collect()
}

/// Unloading to nothing is a step like any other, though every force goes to zero; on nothing it takes none.
#[test]
fn a_plate_is_unloaded_to_nothing_in_steps_like_any_other() {
    let scene = scene("unloaded-plate.toml", include_str!("scenes/unloaded-plate.toml"));
    let stages = run(scene.clone());
    let iterations = iterations(&stages);
    let (loading, unloading) = iterations.split_at(10);
    let most = *loading.iter().max().unwrap();
    assert!(unloading.iter().all(|taken| *taken <= most), "{iterations:?}");
    let (last, _) = stages.last().unwrap();
    assert!(forces(&scene, last) < 1e-9 * last.largest_force_n);
    let largest = last.displacement.iter().flatten().fold(0.0, |most: f64, u| most.max(u.abs()));
    assert!(largest < 1e-6, "{largest} mm are left");
}

/// A shell under stress without loads or reactions reaches its equilibrium in steps like any other.
#[test]
fn a_self_stressed_shell_is_let_go() {
    let scene = scene("self-stressed-free.toml", include_str!("scenes/self-stressed-free.toml"));
    let stages = run(scene.clone());
    let (last, record) = stages.last().unwrap();
    assert!((last.parameter, record.report.negative_pivots) == (2.0, 0));
    assert!(last.strain_energy_n_mm > 1.0, "it stays under stress: {} N·mm", last.strain_energy_n_mm);
    assert!(forces(&scene, last) < 1e-6 * last.largest_force_n, "nothing acts, and nothing is carried");
    assert!(stages.iter().all(|(_, record)| record.report.iterations < scene.solver.max_iterations));
}

/// What `solver.tolerance` says of reactions where they are most sensitive to what is left of the residual.
#[test]
fn the_tolerance_bounds_the_error_of_a_twisted_plate() {
    let text = include_str!("scenes/lifted-and-twisted-plate.toml");
    let moments = |tolerance: f64| -> Vec<[f64; 2]> {
        let mut scene = scene("lifted-and-twisted-plate.toml", text);
        scene.solver.tolerance = tolerance;
        let probes = |(state, record): &(State, Record)| [state.parameter, record.report.probes[0].value];
        steps(&run(scene)).into_iter().map(probes).collect()
    };
    let converged = moments(1e-11);
    for tolerance in [1e-5, 1e-6, 1e-7] {
        let found = moments(tolerance);
        let exact = |factor: f64| converged.iter().find(|[other, _]| *other == factor).map(|[_, moment]| *moment);
        let pairs =
            found.iter().filter_map(|[factor, moment]| exact(*factor).map(|exact| (moment / exact - 1.0).abs()));
        let errors: Vec<f64> = pairs.collect();
        assert!(errors.len() >= 15, "only {} load steps in common", errors.len());
        let worst = errors.into_iter().fold(0.0, f64::max);
        assert!(worst <= 100.0 * tolerance, "{worst:e} at a tolerance of {tolerance:e}");
    }
}

/// At a stable jump energy is released: what the moment does, by the angle through which the edge turned, less what is
/// stored. A rule along the chord between both shapes takes the work of a turn for its opposite.
#[test]
fn a_jump_under_a_moment_releases_energy() {
    let mut scene = scene("edge-moment-jump.toml", include_str!("scenes/edge-moment-jump.toml"));
    scene.load.set_target(0.8);
    let stages = run(scene.clone());
    let jumps: Vec<usize> = (0..stages.len()).filter(|index| stages[*index].1.report.jumped).collect();
    assert!(!jumps.is_empty());
    for index in jumps {
        let ((before, _), (after, record)) = (&stages[index - 1], &stages[index]);
        let released = record.report.energy_released_n_mm.unwrap();
        assert!(record.report.negative_pivots == 0 && released > 0.0, "{released}");
        // Between the shapes alone an angle is known up to whole turns.
        let work = Workspace::new(&scene, &before.mesh).unwrap();
        let loads = &work.discretization().terms;
        let strokes = loads.strokes(&before.mesh, &before.displacement, &after.displacement);
        let [wrapped, turn] = [loads.work(&strokes, after.parameter), 2.0 * PI * after.parameter * MOMENT];
        let done = after.strain_energy_n_mm + released - before.strain_energy_n_mm;
        let turns = (done - wrapped) / turn;
        assert!((turns - turns.round()).abs() < 0.05, "{done} N·mm, {wrapped} and {turns} turns");
    }
}

/// Of the panel's end: 1.6815 N·mm per mm on an arc of 75° of radius 10 mm.
const MOMENT: f64 = 1.681_481_481_481_481_6 * 10.0 * 75.0 * PI / 180.0;
