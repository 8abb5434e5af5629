//! What the journal costs: measured and printed, not asserted, because other work on the machine decides as well.
//!
//! ```text
//! cargo test --release --test restart cost -- --ignored --nocapture
//! ```

use std::time::{Duration, Instant};

use foldline::journal::{JournalWriter, Manifest};
use foldline::pipeline::{MemorySink, Run, Stages};
use foldline::scene::SyncPolicy;

/// The stages of a run are made first and written afterwards, so that each is timed without the other.
#[test]
#[ignore = "runs the baseline, some ten seconds"]
fn the_journal_beside_the_run() {
    let scene = crate::support::scene("baseline.toml");
    let mut stages = Stages::new(scene.clone());
    let start = stages.start().unwrap();
    let mut sink = MemorySink::default();
    let began = Instant::now();
    Run::new(stages, start, None).to_end(None, &|| false, &mut sink).unwrap();
    let run = began.elapsed();
    println!("the run: {run:?}, {} stages", sink.stages.len());

    let folder = tempfile::tempdir().unwrap();
    for (name, policy) in
        [("at-end", SyncPolicy::AtEnd), ("each-second", SyncPolicy::EachSecond), ("each-stage", SyncPolicy::EachStage)]
    {
        let path = folder.path().join(format!("{name}.mcap"));
        let manifest = Manifest::here(&path, &scene.to_toml(), 2);
        let mut writer = JournalWriter::create(&path, &manifest, policy).unwrap();
        let (began, mut longest) = (Instant::now(), Duration::ZERO);
        for (state, record) in &sink.stages {
            let began = Instant::now();
            writer.commit(state, record).unwrap();
            longest = longest.max(began.elapsed());
        }
        let commits = began.elapsed();
        writer.finish().unwrap();
        let (all, megabytes) = (began.elapsed(), std::fs::metadata(&path).unwrap().len() as f64 / 1e6);
        let share = |time: Duration| 100.0 * time.as_secs_f64() / run.as_secs_f64();
        println!("{name}: commits {commits:?} ({:.2} %), with the end {all:?} ({:.2} %)", share(commits), share(all));
        println!("    longest commit {longest:?}; {megabytes:.2} MB");
    }
}
