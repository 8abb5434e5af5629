//! What equilibrium and released energy are held against: forces that are there where reactions vanish, and the work of
//! moments that turn with the shell.

use foldline::equilibrium::{Equilibrium, Standing, Workspace};
use foldline::pipeline::{Record, Stages};
use foldline::scene::{Scene, Stage, parse};
use foldline::state::State;

use crate::support::{run, steps};

fn scene(name: &str, text: &str) -> Scene {
    parse(text, name).unwrap_or_else(|error| panic!("{error}"))
}

/// Reactions and residual together, N: internal forces less loads on all control points.
fn forces(scene: &Scene, state: &State) -> f64 {
    let mut work = Workspace::new(scene, &state.mesh).unwrap();
    work.forces(Standing::of(state)).iter().flatten().map(|force| force * force).sum::<f64>().sqrt()
}

/// Newton iterations of every load step that went on.
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
