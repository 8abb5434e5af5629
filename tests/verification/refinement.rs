//! Refinement is exact: the projected state is the same state.

use foldline::energy::strain_energy;
use foldline::model::Tables;
use foldline::scene::Stage;

use crate::support::{run, scene};

#[test]
fn projecting_keeps_the_energy_and_re_equilibrating_lowers_it() {
    let mut quarter = scene("baseline-quarter.toml");
    quarter.load.set_target(12.0);
    let stages = run(quarter.clone());
    let mut refinements = 0;
    for index in 1..stages.len() {
        let (state, record) = &stages[index];
        let before = &stages[index - 1].0;
        match record.report.stage {
            Stage::ProjectDisplacements => {
                let change = state.strain_energy_n_mm / before.strain_energy_n_mm - 1.0;
                assert!(change.abs() < 1e-12, "step {}: {change:e}", state.step);
                refinements += 1;
            }
            Stage::ReEquilibrate => {
                assert!(state.strain_energy_n_mm <= before.strain_energy_n_mm * (1.0 + 1e-12), "step {}", state.step)
            }
            // What refining changes is quadrature alone: the same displacement, integrated on both sets of points.
            Stage::RefineKnots => {
                let old = 4.0 * strain_energy(&Tables::new(&quarter, before.mesh.lone()), &before.displacement, None);
                assert!((old / before.strain_energy_n_mm - 1.0).abs() < 1e-12);
                assert_eq!(state.displacement, before.displacement);
            }
            _ => {}
        }
    }
    assert!(refinements >= 10, "{refinements} refinements");
}

#[test]
fn a_uniform_scene_runs_nothing_but_solves() {
    let mut uniform = scene("baseline-uniform.toml");
    uniform.mesh.elements = [8, 4];
    uniform.load.set_target(2.0);
    let stages = run(uniform);
    assert!(stages.iter().all(|(_, record)| record.report.stage == Stage::Solve));
    assert!(stages.iter().all(|(state, _)| state.mesh == stages[0].0.mesh));
}
