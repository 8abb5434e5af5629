//! A sink of one's own: it sees every stage beside the journal, and keeps the least stable equilibrium.
//!
//! ```text
//! cargo run --release --example own_sink
//! ```

use std::error::Error;
use std::path::Path;

use foldline::journal::{JournalWriter, Manifest};
use foldline::pipeline::{Run, Stages};
use foldline::record::{Record, Sink, SinkError};
use foldline::scene::parse;
use foldline::state::State;

/// Hands every stage to the journal first, so that what it keeps is safe there as well.
struct LeastStable {
    journal: JournalWriter,
    found: Option<State>,
}

impl Sink for LeastStable {
    fn take(&mut self, state: &State, record: &Record) -> Result<(), SinkError> {
        self.journal.take(state, record)?;
        if self.found.as_ref().is_none_or(|found| state.negative_pivots > found.negative_pivots) {
            self.found = Some(state.clone());
        }
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let file = "pipelines/baseline-quarter.toml";
    let text = std::fs::read_to_string(file)?;
    let scene = parse(&text, file)?;
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("run.mcap");
    let journal = JournalWriter::create(&path, &Manifest::here(Path::new(file), &text, 1), scene.output.sync)?;
    let mut sink = LeastStable { journal, found: None };
    let mut stages = Stages::new(scene);
    let start = stages.start()?;
    Run::new(stages, start, None).to_end(Some(5.0), &|| false, &mut sink)?;
    sink.journal.close()?;
    if let Some(State { parameter, negative_pivots, .. }) = sink.found {
        println!("least stable at {parameter:.3}°: {negative_pivots} negative pivots");
    }
    Ok(())
}
