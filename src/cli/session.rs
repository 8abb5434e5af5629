//! A run under way: threads, signals, the log, and what is shown; shared by the commands that compute.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM, SIGXFSZ};
use signal_hook::flag;

use super::failure::{Failure, INTERRUPTED};
use super::output::{print, say};
use super::progress::{Manner, Shown};
use crate::journal::JournalWriter;
use crate::pipeline::{Ending, Record, Run};
use crate::scene::Scene;
use crate::study::Summary;
use crate::view::MeshHistory;

/// What a run is given beside its scene; none of it changes a state, except where the run stops.
pub(super) struct RunOptions {
    /// Where the log goes.
    pub(super) log: PathBuf,
    /// Threads of the assembly; `None` takes one for each core.
    pub(super) threads: Option<usize>,
    /// Rotation at which the run stops early, degrees.
    pub(super) until_deg: Option<f64>,
    /// How the run is shown.
    pub(super) manner: Manner,
}

impl RunOptions {
    /// Whether a person watches.
    pub(super) fn is_shown(&self) -> bool {
        matches!(self.manner, Manner::Live | Manner::Lines)
    }

    /// The last words of a run.
    pub(super) fn sum_up(&self, summary: &Summary) -> Result<(), Failure> {
        if self.manner != Manner::Json {
            print(&summary.to_string())?;
        }
        if self.is_shown() {
            say(&format!("every stage: foldline inspect {}", self.log.display()));
        }
        Ok(())
    }

    /// Sets up the threads; returns how many there are.
    pub(super) fn use_threads(&self) -> usize {
        use_threads(self.threads)
    }
}

/// Sets up so many threads, or one for each core; returns how many there are.
pub(super) fn use_threads(threads: Option<usize>) -> usize {
    // Fails only where the pool stands already, which is then the one to use.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build_global();
    rayon::current_num_threads()
}

/// Raised by the first SIGINT or SIGTERM; the second ends the process at once.
pub(super) fn watch_signals() -> Result<Arc<AtomicBool>, Failure> {
    let raised = Arc::new(AtomicBool::new(false));
    // A file size limit is then an error that names the log, instead of the end of the process.
    flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false))).map_err(|source| Failure::Signals { source })?;
    for signal in [SIGINT, SIGTERM] {
        flag::register_conditional_shutdown(signal, i32::from(INTERRUPTED), raised.clone())
            .and_then(|_| flag::register(signal, raised.clone()))
            .map_err(|source| Failure::Signals { source })?;
    }
    Ok(raised)
}

/// Runs to the end that the options name, with every stage logged and shown. Gives back the stages of this session.
pub(super) fn drive(
    mut run: Run,
    scene: &Scene,
    writer: JournalWriter,
    options: &RunOptions,
    raised: &AtomicBool,
) -> Result<Vec<Record>, Failure> {
    let start_deg = run.state().parameter;
    let writer = match scene.output.mesh_history {
        true => writer.with_viewer(Box::new(MeshHistory::new(scene))),
        false => writer,
    };
    let target_deg = options.until_deg.unwrap_or(scene.load.target());
    let mut sink = Shown::new(writer, options.manner, scene, [start_deg, target_deg]);
    let ending = run.to_end(options.until_deg, &|| raised.load(Ordering::Relaxed), &mut sink);
    let (writer, records) = sink.finish();
    let log = || options.log.clone();
    let keeps = writer.is_still_there();
    let closed = if matches!(ending, Ok(Ending::Finished)) { writer.finish() } else { writer.close() };
    let ending = ending.map_err(|source| Failure::Stopped { log: log(), keeps, source: Box::new(source) })?;
    closed.map_err(|source| Failure::WrongLog { log: log(), source: Box::new(source) })?;
    match ending {
        Ending::Interrupted => Err(Failure::Interrupted { log: log() }),
        Ending::Finished | Ending::Until => Ok(records),
    }
}
