//! What the tests share: scenes from `pipelines/`, and runs of them in memory.

use std::path::Path;

use foldline::pipeline::{Ending, Run, Stages};
use foldline::record::{MemorySink, Record, Report};
use foldline::scene::{Scene, Stage, parse};
use foldline::state::State;

/// A scene of `pipelines/` by file name.
pub fn scene(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("pipelines").join(name);
    let text = std::fs::read_to_string(&path).unwrap();
    parse(&text, name).unwrap_or_else(|error| panic!("{error}"))
}

/// A whole run of a scene; every stage is kept.
pub fn run(scene: Scene) -> Vec<(State, Record)> {
    let mut stages = Stages::new(scene);
    let start = stages.start().unwrap();
    let mut sink = MemorySink::default();
    let ending = Run::new(stages, start, None).to_end(None, &|| false, &mut sink).unwrap();
    assert_eq!(ending, Ending::Finished);
    sink.stages
}

/// The last stage of every load step that was taken: the equilibria on the meshes that the steps ended with.
pub fn steps(stages: &[(State, Record)]) -> Vec<&(State, Record)> {
    let settled = |index: &usize| {
        let here = stages[*index].1.report.step;
        stages.get(index + 1).is_none_or(|next| next.1.report.step > here)
            && stages[*index].0.drive.control.rejection.is_none()
    };
    (0..stages.len()).filter(settled).map(|index| &stages[index]).collect()
}

/// Stages of one kind.
pub fn of(stages: &[(State, Record)], stage: Stage) -> impl Iterator<Item = &(State, Record)> {
    stages.iter().filter(move |(_, record)| record.report.stage == stage)
}

/// What a probe reads at an equilibrium.
pub fn reading(report: &Report, name: &str) -> f64 {
    report.probes.iter().find(|probe| probe.name == name).unwrap_or_else(|| panic!("no probe {name}")).value
}
