//! A user-defined sink: it passes every stage on to the journal, and keeps the equilibrium that stores most energy.
//!
//! ```text
//! cargo run --release --example own_sink
//! ```

use std::error::Error;
use std::path::Path;

use foldline::journal::{JournalWriter, Manifest};
use foldline::pipeline::{Run, Stages};
use foldline::record::{Outcome, Record, Sink, SinkError};
use foldline::scene::parse;
use foldline::state::State;

/// Hands every stage to the journal first, so that what it keeps is safe there as well.
struct MostStored {
    journal: JournalWriter,
    found: Option<State>,
}

impl Sink for MostStored {
    fn take(&mut self, state: &State, record: &Record) -> Result<(), SinkError> {
        self.journal.take(state, record)?;
        let is_equilibrium = record.report.stage.finds_equilibrium() && record.report.outcome == Outcome::Done;
        let stores_more = self.found.as_ref().is_none_or(|found| state.strain_energy_n_mm > found.strain_energy_n_mm);
        if is_equilibrium && stores_more {
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
    let mut sink = MostStored { journal, found: None };
    let mut stages = Stages::new(scene);
    let start = stages.start()?;
    Run::new(stages, start, None).to_end(Some(5.0), &|| false, &mut sink)?;
    sink.journal.close()?;
    if let Some(State { parameter, strain_energy_n_mm, .. }) = sink.found {
        println!("most energy at {parameter:.3}°: {strain_energy_n_mm:.3} N·mm");
    }
    Ok(())
}
