//! Tasks of a sweep as jobs of a cluster do them, and the table collected of them.

use std::collections::HashMap;
use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use clap::Args;

use super::failure::Failure;
use super::output::{eprint, path_in_line, print};
use super::session::{open_archive, use_threads, watch_signals_that_repeat};
use super::slurm::OwnJob;
use crate::study::{TaskError, guarded};
use crate::sweep::{Folder, SweepError, Table, Task, Work};
use crate::units::count;

/// How long another process that writes the log is waited for.
const PATIENCE: Duration = Duration::from_secs(60);

/// Between two looks whether it is through, and whether a signal came.
const BETWEEN_LOOKS: Duration = Duration::from_millis(200);

/// What is left of a job's time when it asks for its next turn though a stage is still in hand.
const LAST_S: u64 = 8;

/// Turns of a job that may be spent on waiting for another process before that is a failure.
const MOST_TURNS: u32 = 100;

/// Below the options of `sweep task`.
const TASK_EXIT_CODES: &str = "\
Exit codes:
   0  on record: done, failed or refused
   1  not on record, for a reason that is none of its own, such as a full disk
   2  wrong arguments, or no such sweep or task
  75  interrupted after the stage in hand, or in the hands of another process for a minute; the
      same command continues, as a job of Slurm does by itself at the end of its time";

/// Do one task of a sweep, or some of a list, as a job of a cluster does; what is on record is not done again
#[derive(Args, Debug)]
#[command(after_help = TASK_EXIT_CODES)]
pub(super) struct TaskArguments {
    /// Folder of the sweep
    folder: PathBuf,
    /// Number of the task
    #[arg(required_unless_present = "list", conflicts_with = "list")]
    number: Option<usize>,
    /// File with the keys of tasks, a line each
    #[arg(long, value_name = "FILE")]
    list: Option<PathBuf>,
    /// First line of the list that is done
    #[arg(long, value_name = "N", requires = "list", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    from: u32,
    /// Lines of the list that are done, one after another [default: all]
    #[arg(long, value_name = "K", requires = "list")]
    count: Option<u32>,
    /// Threads
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: u16,
}

/// Gather what is on record of the tasks of a sweep, and write the table as table.csv in its folder
#[derive(Args, Debug)]
pub(super) struct CollectArguments {
    /// Folder of the sweep
    folder: PathBuf,
}

impl TaskArguments {
    /// Does the tasks until a signal comes.
    pub(super) fn run(self) -> Result<(), Failure> {
        let raised = watch_signals_that_repeat()?;
        let threads = use_threads(Some(usize::from(self.threads)))?;
        let folder = Folder::at(&self.folder);
        let (head, scene_text, tasks) = (folder.head()?, folder.scene_text()?, folder.tasks()?);
        let chosen = self.chosen(&folder, &tasks)?;
        let archive = open_archive(&folder.logs(), threads)?;
        let work = Work::new(&head, &scene_text, &archive);
        let turn = Turn::begin(raised);
        chosen.into_iter().try_for_each(|task| turn.do_task(&folder, &work, task))
    }

    /// The tasks that are asked for.
    fn chosen<'t>(&self, folder: &Folder, tasks: &'t [Task]) -> Result<Vec<&'t Task>, Failure> {
        let Some(list) = &self.list else {
            let number = self.number.unwrap_or(0);
            let no_such = || SweepError::NoSuchTask { folder: folder.path().to_path_buf(), count: tasks.len(), number };
            return Ok(vec![number.checked_sub(1).and_then(|index| tasks.get(index)).ok_or_else(no_such)?]);
        };
        let text = fs::read_to_string(list).map_err(|source| Failure::Read { path: list.clone(), source })?;
        let most = self.count.map_or(usize::MAX, |count| count as usize);
        let keys = text.lines().map(str::trim).skip(self.from as usize - 1).take(most);
        let known: HashMap<&str, &Task> = tasks.iter().map(|task| (task.key.as_str(), task)).collect();
        let found = keys.filter_map(|key| {
            if !known.contains_key(key) {
                eprint(&format!("task {key} is no longer part of the sweep, which was changed: it is left out"));
            }
            known.get(key).copied()
        });
        Ok(found.collect())
    }
}

/// What this process may do until its job's time is over.
struct Turn {
    raised: Arc<AtomicBool>,
    next: Arc<NextTurn>,
}

/// The next turn of the job, where this is one: asked for once.
struct NextTurn {
    job: Option<OwnJob>,
    /// Stages that were done, and tasks that were put on record.
    progress: AtomicUsize,
    is_asked_for: Mutex<bool>,
}

impl Turn {
    /// Begins to watch the time.
    fn begin(raised: Arc<AtomicBool>) -> Self {
        let next =
            NextTurn { job: OwnJob::of_environment(), progress: AtomicUsize::new(0), is_asked_for: false.into() };
        let turn = Self { raised, next: Arc::new(next) };
        if turn.next.job.is_some() {
            let (raised, next) = (turn.raised.clone(), turn.next.clone());
            // Where there can be no other thread, the task itself asks after its stage.
            let _ = thread::Builder::new().spawn(move || {
                while !raised.load(Ordering::Relaxed) {
                    thread::sleep(BETWEEN_LOOKS);
                }
                // A stage that outlives the time takes this process with it.
                if let Some(left) = next.seconds_to_limit() {
                    thread::sleep(Duration::from_secs(left.saturating_sub(LAST_S)));
                    next.ask();
                }
            });
        }
        turn
    }

    fn is_over(&self) -> bool {
        self.raised.load(Ordering::Relaxed)
    }

    /// Does a task unless it is on record. Where another process has it in hand, that is waited for.
    fn do_task(&self, folder: &Folder, work: &Work<'_>, task: &Task) -> Result<(), Failure> {
        let begin = Instant::now();
        let is_on_record = || folder.record(&task.key).is_some_and(|record| record.answers(task, &work.head().outputs));
        loop {
            if is_on_record() {
                return Ok(());
            }
            if self.is_over() {
                return Err(self.interrupted(folder, task));
            }
            match work.record(task, guarded(|| work.of(task, &self.counted()))) {
                Ok(record) => {
                    self.next.progress.fetch_add(1, Ordering::Relaxed);
                    return Ok(folder.keep_record(&record)?);
                }
                Err(TaskError::Interrupted) => return Err(self.interrupted(folder, task)),
                Err(error) if error.is_of_other_writer() && begin.elapsed() < PATIENCE => thread::sleep(BETWEEN_LOOKS),
                Err(error) if error.is_of_other_writer() => return Err(self.held(task, error)),
                // Whoever took the log over may have come to the end.
                Err(_) if is_on_record() => {}
                Err(error) => {
                    return Err(Failure::SweepTask { number: task.number, source: Box::new(error) });
                }
            }
        }
    }

    /// Whether to stop, as is asked before every stage; the one before is then done.
    fn counted(&self) -> impl Fn() -> bool {
        let asked = std::cell::Cell::new(false);
        move || {
            if asked.replace(true) {
                self.next.progress.fetch_add(1, Ordering::Relaxed);
            }
            self.is_over()
        }
    }

    fn interrupted(&self, folder: &Folder, task: &Task) -> Failure {
        if self.next.seconds_to_limit().is_some() {
            self.next.ask();
        }
        Failure::TaskInterrupted { number: task.number, folder: folder.path().to_path_buf() }
    }

    fn held(&self, task: &Task, error: TaskError) -> Failure {
        let source = Box::new(error);
        match &self.next.job {
            Some(job) if job.restarts < MOST_TURNS => {
                self.next.ask_anyway();
                Failure::TaskHeld { number: task.number, source }
            }
            Some(_) => Failure::SweepTask { number: task.number, source },
            None => Failure::TaskHeld { number: task.number, source },
        }
    }
}

impl NextTurn {
    fn seconds_to_limit(&self) -> Option<u64> {
        self.job.as_ref()?.seconds_to_limit()
    }

    /// Asks for the next turn, unless this one brought nothing: the next would not, either.
    fn ask(&self) {
        if self.progress.load(Ordering::Relaxed) == 0 {
            eprint(
                "not one stage was done in the time of this job, and it is not put back into the queue: submit the sweep again with a longer --time",
            );
            return;
        }
        self.ask_anyway();
    }

    fn ask_anyway(&self) {
        let mut is_asked_for = self.is_asked_for.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(job) = self.job.as_ref().filter(|_| !*is_asked_for) {
            *is_asked_for = true;
            if let Err(failure) = job.requeue() {
                eprint(&format!("this job cannot be put back into the queue: {}", failure.in_full()));
            }
        }
    }
}

impl CollectArguments {
    /// Writes the table; tasks that are left are an error.
    pub(super) fn run(self) -> Result<(), Failure> {
        let folder = Folder::at(&self.folder);
        let table = Table { head: folder.head()?, rows: folder.gather()? };
        let csv = folder.keep_csv(&table.to_csv())?;
        let left = table.rows.iter().filter(|row| row.record.is_none()).count();
        print(&format!(
            "{} of {} → {}\n",
            table.rows.len() - left,
            count(table.rows.len(), "row"),
            path_in_line(&csv)
        ))?;
        if left > 0 { Err(Failure::CollectedLess { left, folder: self.folder }) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_counts_stages_and_not_looks() {
        let next = NextTurn { job: None, progress: AtomicUsize::new(0), is_asked_for: false.into() };
        let turn = Turn { raised: Arc::default(), next: Arc::new(next) };
        let interrupted = turn.counted();
        assert!(!interrupted());
        assert_eq!(turn.next.progress.load(Ordering::Relaxed), 0);
        assert!(!interrupted() && !interrupted());
        assert_eq!(turn.next.progress.load(Ordering::Relaxed), 2);
        turn.raised.store(true, Ordering::Relaxed);
        assert!(interrupted());
    }
}
