//! The loop over tasks: so many at a time, each on threads of its own, and a row of each as soon as it is done.
//!
//! Sweeps over designs go through it; suites whose times count (studies of error against time, paths on one mesh after another) do
//! their tasks in turn, on all threads. What a suite makes of a run is its measure; a row is what the measure found, or why it found
//! nothing. A panic in one task ends that task alone.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

use crate::scene::Scene;
use crate::study::archive::{Archive, Done, Purpose, TaskError};
use crate::study::room::Room;

/// How tasks share a machine.
#[derive(Clone, Copy, Debug)]
pub struct Workers {
    /// Tasks at a time.
    pub tasks: usize,
    /// Threads of each.
    pub threads: usize,
}

/// What a worker hands over: what came of a task by its number, or why it has no threads.
type Handed<R> = Result<(usize, Result<R, TaskError>), ThreadPoolBuildError>;

/// Why the loop ended before its last task.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EngineError<E: std::error::Error + 'static> {
    /// The threads of a task cannot be made.
    #[error("threads cannot be made for the tasks; ask for fewer tasks at a time")]
    Threads(#[from] ThreadPoolBuildError),
    /// What takes the rows could not.
    #[error(transparent)]
    Take(E),
}

impl Workers {
    /// Does the tasks `0..count` in their order and hands what came of each to `take`, on the thread of the caller and in the order
    /// in which they end. A task begins when there is `room` for the bytes that `bytes` says it takes; no task begins after
    /// `interrupted`.
    ///
    /// # Errors
    /// Where threads cannot be made, and what `take` returns: tasks that have begun are still done then.
    pub fn run<R: Send, E: std::error::Error + 'static>(
        self,
        count: usize,
        interrupted: &(dyn Fn() -> bool + Sync),
        room: &Room,
        bytes: &(dyn Fn(usize) -> u64 + Sync),
        measure: &(dyn Fn(usize) -> Result<R, TaskError> + Sync),
        mut take: impl FnMut(usize, Result<R, TaskError>) -> Result<(), E>,
    ) -> Result<(), EngineError<E>> {
        let next = AtomicUsize::new(0);
        let is_over = AtomicBool::new(false);
        let stops = || is_over.load(Ordering::Relaxed) || interrupted();
        let one = |index: usize| {
            guarded(|| {
                let _held = room.take(bytes(index));
                // It may have waited long.
                if stops() { Err(TaskError::Interrupted) } else { measure(index) }
            })
        };
        // Rows are taken one by one: where that is slow, tasks wait.
        let (hand, rows) = sync_channel(self.tasks);
        let work = |hand: SyncSender<Handed<R>>| {
            let threads = match self.pool() {
                Ok(threads) => threads,
                Err(error) => return drop(hand.send(Err(error))),
            };
            while !stops() {
                let index = next.fetch_add(1, Ordering::Relaxed);
                if index >= count || hand.send(Ok((index, threads.install(|| one(index))))).is_err() {
                    break;
                }
            }
        };
        std::thread::scope(|scope| {
            let work = &work;
            for _ in 0..self.tasks.clamp(1, count.max(1)) {
                let hand = hand.clone();
                scope.spawn(move || work(hand));
            }
            drop(hand);
            let mut taken = Ok(());
            for row in rows {
                // What others still have in hand is theirs to keep.
                if taken.is_ok() {
                    taken =
                        row.map_err(Into::into).and_then(|(index, row)| take(index, row).map_err(EngineError::Take));
                    is_over.fetch_or(taken.is_err(), Ordering::Relaxed);
                }
            }
            taken
        })
    }

    /// The threads of one task; where it has one alone, that is the thread of its worker.
    fn pool(self) -> Result<ThreadPool, ThreadPoolBuildError> {
        let builder = ThreadPoolBuilder::new().num_threads(self.threads.max(1));
        if self.threads <= 1 { builder.use_current_thread().build() } else { builder.build() }
    }
}

/// Does the runs of scenes one after another on the threads of the caller, each in its log, and hands each to `take` as soon as it
/// has ended. None begins after `interrupted`: that is what comes of the others.
///
/// # Errors
/// What `take` returns: no run begins behind it.
pub fn in_turn<E>(
    archive: &Archive,
    runs: &[(&Scene, Purpose)],
    interrupted: &dyn Fn() -> bool,
    mut take: impl FnMut(usize, Result<Done, TaskError>) -> Result<(), E>,
) -> Result<(), E> {
    for (index, (scene, purpose)) in runs.iter().enumerate() {
        let done = if interrupted() {
            Err(TaskError::Interrupted)
        } else {
            guarded(|| archive.done(scene, *purpose, interrupted))
        };
        take(index, done)?;
    }
    Ok(())
}

/// Does a task whose panic is its own affair.
///
/// # Errors
/// Those of the task, and its panic.
pub fn guarded<R>(task: impl FnOnce() -> Result<R, TaskError>) -> Result<R, TaskError> {
    panic_or(task).unwrap_or_else(|message| Err(TaskError::Panicked { message }))
}

/// Does some work, and gives back what it panicked with, if it did.
pub(super) fn panic_or<R>(work: impl FnOnce() -> R) -> Result<R, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| {
        let said = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
        said.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_default()
    })
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;

    fn rows(workers: Workers, count: usize, measure: &(dyn Fn(usize) -> usize + Sync)) -> Vec<(usize, Option<usize>)> {
        let mut rows = Vec::new();
        let measured = |index| Ok(measure(index));
        let taken = workers.run(count, &|| false, &Room::unlimited(), &|_| 0, &measured, |index, ended| {
            rows.push((index, ended.ok()));
            Ok::<(), Infallible>(())
        });
        taken.unwrap();
        rows.sort_unstable();
        rows
    }

    #[test]
    fn every_task_is_done_once_however_many_are_done_at_a_time() {
        for workers in
            [Workers { tasks: 1, threads: 1 }, Workers { tasks: 4, threads: 1 }, Workers { tasks: 2, threads: 3 }]
        {
            for count in [0, 1, 3, 100] {
                let expected: Vec<(usize, Option<usize>)> =
                    (0..count).map(|index| (index, Some(index * index))).collect();
                assert_eq!(rows(workers, count, &|index| index * index), expected, "{workers:?}");
            }
        }
    }

    #[test]
    fn a_task_sees_its_own_threads() {
        let seen = rows(Workers { tasks: 2, threads: 3 }, 5, &|_| rayon::current_num_threads());
        assert!(seen.iter().all(|(_, threads)| *threads == Some(3)), "{seen:?}");
        let seen = rows(Workers { tasks: 2, threads: 1 }, 5, &|_| rayon::current_num_threads());
        assert!(seen.iter().all(|(_, threads)| *threads == Some(1)), "{seen:?}");
    }

    #[test]
    fn a_panic_ends_its_task_alone() {
        for workers in [Workers { tasks: 1, threads: 1 }, Workers { tasks: 2, threads: 1 }] {
            let found = rows(workers, 6, &|index| if index == 2 { panic!("on purpose") } else { index });
            assert_eq!(
                found.iter().filter(|(_, found)| found.is_none()).map(|(index, _)| *index).collect::<Vec<_>>(),
                [2]
            );
        }
    }

    #[test]
    fn what_is_interrupted_begins_no_more_tasks() {
        let done = AtomicUsize::new(0);
        let interrupted = || done.load(Ordering::Relaxed) >= 3;
        let count = |_, _| -> Result<(), Infallible> { Ok(()) };
        let begun = |_| Ok(done.fetch_add(1, Ordering::Relaxed));
        Workers { tasks: 2, threads: 1 }.run(1000, &interrupted, &Room::unlimited(), &|_| 0, &begun, count).unwrap();
        assert!(done.load(Ordering::Relaxed) <= 4);
    }

    #[test]
    fn a_row_that_cannot_be_taken_ends_the_loop() {
        let begun = AtomicUsize::new(0);
        let measure = |_| Ok(begun.fetch_add(1, Ordering::Relaxed));
        let full = |_, _| Err(std::io::Error::other("no room"));
        let ended = Workers { tasks: 2, threads: 1 }.run(1000, &|| false, &Room::unlimited(), &|_| 0, &measure, full);
        assert!(matches!(ended, Err(EngineError::Take(_))));
        assert!(begun.load(Ordering::Relaxed) < 20);
    }
}
