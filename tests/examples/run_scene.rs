//! Runs a scene in memory and prints the moment over the rotation.
//!
//! ```text
//! cargo run --release --example run_scene [SCENE.toml]
//! ```

use std::error::Error;
use std::path::PathBuf;

use foldline::pipeline::{Run, Stages};
use foldline::record::{MemorySink, Outcome};
use foldline::scene::parse;

fn main() -> Result<(), Box<dyn Error>> {
    let path =
        std::env::args_os().nth(1).map_or_else(|| PathBuf::from("pipelines/baseline-quarter.toml"), PathBuf::from);
    let scene = parse(&std::fs::read_to_string(&path)?, &path.display().to_string())?;
    let mut stages = Stages::new(scene);
    let start = stages.start()?;
    let mut sink = MemorySink::default();
    // To 5°, or to the scene's own target where that comes first.
    Run::new(stages, start, None).to_end(Some(5.0), &|| false, &mut sink)?;
    for (state, record) in &sink.stages {
        // A step that refined ends with the equilibrium on the finer mesh.
        if record.report.stage.finds_equilibrium() && record.report.outcome == Outcome::Done {
            println!("{:>7.3}  {:>9.3} N·mm  {:?} elements", state.parameter, state.moment_n_mm, state.mesh.elements());
        }
    }
    Ok(())
}
