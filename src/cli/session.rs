//! A run under way: threads, signals, the log, and what is shown; shared by the commands that compute.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};

use rayon::{ThreadBuilder, ThreadPoolBuilder};
use signal_hook::flag;

use super::failure::{Failure, INTERRUPTED};
use super::output::{eprint, path_in_command, print};
use super::progress::{ProgressSink, ProgressStyle};
use super::settings::Settings;
use crate::journal::JournalWriter;
use crate::pipeline::{Ending, Run};
use crate::platform::signals;
use crate::record::Record;
use crate::scene::Scene;
use crate::study::{Archive, Summary};
use crate::view::MeshHistory;

/// What a run is given besides its scene; none of it changes a state, except where the run stops.
pub(super) struct RunOptions {
    /// Where the log goes.
    pub(super) log: PathBuf,
    /// Threads of the assembly; `None` takes one for each core.
    pub(super) threads: Option<usize>,
    /// Rotation at which the run stops early, degrees.
    pub(super) until: Option<f64>,
    /// How the run is shown.
    pub(super) style: ProgressStyle,
}

impl RunOptions {
    /// Whether a person watches.
    pub(super) fn is_shown(&self) -> bool {
        matches!(self.style, ProgressStyle::Live | ProgressStyle::Lines)
    }

    /// Prints what a person reads and a program does not.
    pub(super) fn show(&self, text: &str) -> Result<(), Failure> {
        if self.style == ProgressStyle::Json { Ok(()) } else { print(text) }
    }

    /// The last words of a run of whose log only the stages from `first` on were read: numbers of a part would be taken for those
    /// of the run.
    pub(super) fn end_of_long(&self, first: usize, stages: usize) -> Result<(), Failure> {
        let log = path_in_command(&self.log);
        self.show(&format!(
            "{stages} stages in the log, of which those before stage {first} were not read again: no summary. Summary and every stage: \
             foldline inspect {log}; that all of them are as they were written: foldline verify {log}\n"
        ))
    }

    /// The last words of a run.
    pub(super) fn sum_up(&self, summary: &Summary) -> Result<(), Failure> {
        self.show(&summary.to_string())?;
        if self.is_shown() {
            eprint(&format!("every stage: foldline inspect {}", path_in_command(&self.log)));
        }
        Ok(())
    }

    /// Sets up the threads; returns how many there are.
    pub(super) fn use_threads(&self) -> Result<usize, Failure> {
        use_threads(self.threads)
    }
}

/// Sets up so many threads, or one for each core; returns how many there are. Where they cannot be made, everything is
/// done on the one that there is, with the same results.
pub(super) fn use_threads(threads: Option<usize>) -> Result<usize, Failure> {
    let threads = match threads {
        None => Settings::read()?.threads.map(usize::from),
        chosen => chosen,
    };
    let wanted = threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    let failed = |source| Failure::Threads { source: Box::new(source) };
    let waiting = if wanted > 1 { waiting_threads(wanted).map(Some) } else { Ok(None) };
    if let Err(error) = &waiting {
        eprint(&format!("warning: threads cannot be made ({error}): everything is done on one, with the same results"));
    }
    let pool = ThreadPoolBuilder::new();
    match waiting.ok().flatten() {
        // What one of them is given to do it takes, so that this cannot fail half-way.
        Some(hand) => pool
            .num_threads(wanted)
            .spawn_handler(|work| hand.send(work).map_err(|_| io::ErrorKind::BrokenPipe.into()))
            .build_global(),
        None => pool.num_threads(1).use_current_thread().build_global(),
    }
    .map_err(failed)?;
    Ok(rayon::current_num_threads())
}

/// So many threads, each waiting for the work of one of a pool; they end where they are given none.
fn waiting_threads(count: usize) -> io::Result<Sender<ThreadBuilder>> {
    let (hand, take) = channel::<ThreadBuilder>();
    let take = Arc::new(Mutex::new(take));
    for _ in 0..count {
        let take = take.clone();
        std::thread::Builder::new().spawn(move || {
            let work = take.lock().unwrap_or_else(PoisonError::into_inner).recv();
            if let Ok(work) = work {
                work.run();
            }
        })?;
    }
    Ok(hand)
}

/// Opens the folder of the logs of a suite's runs, which take so many threads each.
pub(super) fn open_archive(folder: &Path, threads: usize) -> Result<Archive, Failure> {
    Archive::open(folder, threads).map_err(|source| Failure::Archive { source: Box::new(source) })
}

/// Makes a limit on the size of files an error that names the file, instead of the end of the process.
pub(super) fn outlive_file_limits() -> Result<(), Failure> {
    let failed = |source| Failure::Signals { source };
    let Some(signal) = signals::FILE_TOO_LARGE else { return Ok(()) };
    flag::register(signal, Arc::new(AtomicBool::new(false))).map(|_| ()).map_err(failed)
}

/// Raised by each signal that asks for an end; a second SIGINT or SIGTERM ends the process at once.
pub(super) fn watch_signals() -> Result<Arc<AtomicBool>, Failure> {
    watch(signals::STOP)
}

/// The same for a job of a cluster, which may be sent SIGTERM many times for one cause: a second SIGINT alone ends the process at once.
pub(super) fn watch_signals_that_repeat() -> Result<Arc<AtomicBool>, Failure> {
    watch(signals::STOP_BY_HAND)
}

/// Raised by each signal that asks for an end; a second one of `at_once` ends the process at once.
fn watch(at_once: &[i32]) -> Result<Arc<AtomicBool>, Failure> {
    let failed = |source| Failure::Signals { source };
    let raised = Arc::new(AtomicBool::new(false));
    for signal in at_once {
        flag::register_conditional_shutdown(*signal, i32::from(INTERRUPTED), raised.clone()).map_err(failed)?;
    }
    // The others may come again for the same cause: from the shell after the terminal, or with each second of time.
    for signal in signals::STOP.iter().chain(signals::ALSO_STOP) {
        if Some(*signal) != signals::HANG_UP || !is_ignored(*signal) {
            flag::register(*signal, raised.clone()).map_err(failed)?;
        }
    }
    Ok(raised)
}

/// Whether this process was started with a signal ignored, as `nohup` does; known on Linux, from /proc.
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask >> (signal - 1) & 1 == 1
}

/// Runs to the end that the options name, with every stage logged and shown. Gives back the stages of this session.
pub(super) fn drive(
    mut run: Run,
    scene: &Scene,
    writer: JournalWriter,
    options: &RunOptions,
    raised: &AtomicBool,
) -> Result<Vec<Record>, Failure> {
    let start = run.state().parameter;
    let writer = match scene.output.mesh_history {
        true => writer.with_viewer(Box::new(MeshHistory::new(scene))),
        false => writer,
    };
    let target = options.until.unwrap_or(scene.load.target());
    let mut sink = ProgressSink::new(writer, options.style, scene, [start, target]);
    let ending = run.to_end(options.until, &|| raised.load(Ordering::Relaxed), &mut sink);
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

/// A rotation that somebody could mean.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        Ok(_) => {
            Err("a rotation or a load factor above 0 is wanted; by arc length it counts on both sides of 0".to_string())
        }
        Err(_) => Err("a number is wanted, such as 12.5: degrees, or a load factor".to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_are_positive_numbers() {
        assert_eq!(positive("12.5"), Ok(12.5));
        for wrong in ["0", "-1", "inf", "nan", "", "ten"] {
            assert!(positive(wrong).is_err(), "{wrong}");
        }
    }
}
