//! What the journal costs: measured and printed, not asserted, because other work on the machine decides as well.
//!
//! ```text
//! cargo test --release --test restart cost -- --ignored --nocapture
//! ```

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use foldline::journal::{JournalWriter, Manifest};
use foldline::pipeline::{Run, Stages};
use foldline::record::{MemorySink, Sink};
use foldline::scene::SyncPolicy;

/// How often the log is written under each policy; the policies take turns.
const ROUNDS: usize = 15;

const POLICIES: [(&str, SyncPolicy); 3] =
    [("at-end", SyncPolicy::AtEnd), ("each-second", SyncPolicy::EachSecond), ("each-stage", SyncPolicy::EachStage)];

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
    let mut times = POLICIES.map(|_| [Vec::new(), Vec::new()]);
    for round in 0..ROUNDS {
        for ((name, policy), [wall, cpu]) in POLICIES.iter().zip(&mut times) {
            let path = folder.path().join(format!("{name}-{round}.mcap"));
            let manifest = Manifest::here(&path, &scene.to_toml(), 2);
            let (began, cpu_began) = (Instant::now(), on_cpu());
            let mut writer = JournalWriter::create(&path, &manifest, *policy).unwrap();
            for (state, record) in &sink.stages {
                writer.take(state, record).unwrap();
            }
            writer.finish().unwrap();
            wall.push(began.elapsed());
            cpu.push(on_cpu() - cpu_began);
            fs::remove_file(path).unwrap();
        }
    }
    for ((name, _), times) in POLICIES.iter().zip(&mut times) {
        let [wall, cpu] = times.each_mut().map(|times| {
            times.sort();
            let median = times[ROUNDS / 2];
            let share = 100.0 * median.as_secs_f64() / run.as_secs_f64();
            format!("{median:?} ({:?} a stage, {share:.2} % of the run)", median / sink.stages.len() as u32)
        });
        println!("{name}: wall {wall}, on the processor {cpu}");
    }
}

/// Time that this thread has had a processor.
fn on_cpu() -> Duration {
    let told = fs::read_to_string(Path::new("/proc/thread-self/schedstat")).unwrap_or_default();
    Duration::from_nanos(told.split(' ').next().and_then(|nanos| nanos.parse().ok()).unwrap_or(0))
}
