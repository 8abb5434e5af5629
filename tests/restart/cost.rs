//! What the journal costs: measured and printed, not asserted, because other work on the machine decides as well.
//!
//! ```text
//! cargo test --release --test restart cost -- --ignored --nocapture
//! ```

use std::time::{Duration, Instant};

use foldline::journal::{JournalWriter, Manifest};
use foldline::pipeline::{Record, Run, Sink, SinkError, Stages};
use foldline::scene::SyncPolicy;
use foldline::state::State;

/// A sink with a clock around it.
struct Timed {
    inner: JournalWriter,
    spent: Duration,
    longest: Duration,
}

impl Sink for Timed {
    fn take(&mut self, state: &State, record: &Record) -> Result<(), SinkError> {
        let began = Instant::now();
        self.inner.take(state, record)?;
        let took = began.elapsed();
        self.spent += took;
        self.longest = self.longest.max(took);
        Ok(())
    }
}

#[test]
#[ignore = "runs the quarter of the baseline three times, about half a minute"]
fn the_journal_beside_the_run() {
    let folder = tempfile::tempdir().unwrap();
    for (name, policy) in
        [("each-second", SyncPolicy::EachSecond), ("at-end", SyncPolicy::AtEnd), ("each-stage", SyncPolicy::EachStage)]
    {
        let scene = crate::support::scene("baseline-quarter.toml");
        let path = folder.path().join(format!("{name}.mcap"));
        let manifest = Manifest::here(&path, &scene.to_toml(), 2);
        let began = Instant::now();
        let stages = Stages::new(scene);
        let start = stages.start().unwrap();
        let inner = JournalWriter::create(&path, &manifest, policy).unwrap();
        let mut sink = Timed { inner, spent: Duration::ZERO, longest: Duration::ZERO };
        Run::new(stages, start, None).to_end(None, &|| false, &mut sink).unwrap();
        let closing = Instant::now();
        sink.inner.finish().unwrap();
        let (spent, whole) = (sink.spent + closing.elapsed(), began.elapsed());
        let share = 100.0 * spent.as_secs_f64() / whole.as_secs_f64();
        let megabytes = std::fs::metadata(&path).unwrap().len() as f64 / 1e6;
        println!("{name}: {spent:?} of {whole:?} in the journal, {share:.2} %; {megabytes:.2} MB");
        println!("    longest commit {:?}", sink.longest);
    }
}
