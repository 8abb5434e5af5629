//! What a sweep shows while it continues: a line that changes in place, a line for each task, or JSON.

use std::time::Instant;

use indicatif::{ProgressBar, ProgressDrawTarget};
use serde_json::json;

use super::output::{eprint, path_in_line, print_json};
use super::terminal::{can_overwrite, error_columns};
use super::wrapped::{fitted, wrapped};
use crate::printable::in_full;
use crate::study::TaskError;
use crate::sweep::{Ending, Folder, Head, Outcome, Task};
use crate::units::{count, duration, significant};

/// The progress of a sweep.
pub(super) struct SweepProgress<'h> {
    head: &'h Head,
    bar: Option<ProgressBar>,
    json: bool,
    begin: Instant,
    tasks: usize,
    ended: usize,
    failed: usize,
    told: Told,
    waits: bool,
}

/// What became of tasks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Told {
    /// On record.
    pub(super) ended: usize,
    /// Not on record, for reasons of the machine or the caller.
    pub(super) left: usize,
    /// In the hands of another process.
    pub(super) elsewhere: usize,
}

impl std::ops::AddAssign for Told {
    fn add_assign(&mut self, other: Self) {
        self.ended += other.ended;
        self.left += other.left;
        self.elsewhere += other.elsewhere;
    }
}

/// Says what is going to be done.
pub(super) fn say_head(head: &Head, tasks: usize, folder: &Folder) {
    let known = head.tasks - tasks;
    let known = if known > 0 { format!(", {known} of them on record") } else { String::new() };
    let line = format!("{}: {}{known} → {}", head.title, count(head.tasks, "task"), path_in_line(folder.path()));
    eprint(&wrapped("", &line));
}

impl<'h> SweepProgress<'h> {
    /// Begins with so many tasks; `waits` where it was said already that another process is waited for.
    pub(super) fn new(head: &'h Head, tasks: usize, json: bool, waits: bool) -> Self {
        let bar = (!json && can_overwrite() && tasks > 0).then(|| {
            let bar = ProgressBar::with_draw_target(Some(tasks as u64), ProgressDrawTarget::stderr());
            bar.enable_steady_tick(std::time::Duration::from_millis(200));
            bar.set_style(
                indicatif::ProgressStyle::with_template("{msg}")
                    .unwrap_or_else(|_| indicatif::ProgressStyle::default_bar()),
            );
            bar
        });
        Self { head, bar, json, begin: Instant::now(), tasks, ended: 0, failed: 0, told: Told::default(), waits }
    }

    /// Shows what came of a task.
    pub(super) fn take(&mut self, task: &Task, outcome: &Outcome) {
        self.ended += 1;
        let named = name_of(self.head, task);
        match outcome {
            Outcome::OnRecord(record) => {
                self.told.ended += 1;
                self.failed += usize::from(record.ending != Ending::Done);
                if self.json {
                    // Whoever reads may have gone; the record is kept.
                    let _ = print_json(&json!({ "task": task, "record": record }));
                } else if record.ending != Ending::Done {
                    let reason =
                        record.reason.as_deref().unwrap_or_default().lines().next().unwrap_or_default().to_owned();
                    self.say(&wrapped("", &format!("task {} ({named}): {reason}", task.number)));
                } else if self.bar.is_none() {
                    self.say(&fitted(&self.line(&named), error_columns()));
                }
            }
            Outcome::Left(error) if error.is_of_other_writer() => {
                if !self.waits && self.told.elsewhere == 0 {
                    self.say(&wrapped("", &format!("task {} ({named}) and maybe others are in the hands of another process, which is waited for", task.number)));
                }
                self.told.elsewhere += 1;
            }
            Outcome::Left(TaskError::Interrupted) => self.told.left += 1,
            Outcome::Left(error) => {
                self.told.left += 1;
                self.say(&wrapped("", &format!("task {} ({named}) is left: {}", task.number, in_full(error))));
            }
        }
        if let Some(bar) = &self.bar {
            bar.set_message(fitted(&self.line(&named), error_columns()));
        }
    }

    /// Ends what is shown; gives back what became of the tasks.
    pub(super) fn finish(self) -> Told {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
        self.told
    }

    fn line(&self, named: &str) -> String {
        let failed = if self.failed > 0 { format!(", {} failed", self.failed) } else { String::new() };
        let rest = self.tasks - self.ended;
        let time = self.begin.elapsed().as_secs_f64() / self.ended.max(1) as f64 * rest as f64;
        let time = if rest > 0 { format!(", {} left", duration(time)) } else { String::new() };
        format!("{}/{}{failed}{time}  {named}", self.ended, self.tasks)
    }

    fn say(&self, line: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| eprint(line)),
            None => eprint(line),
        }
    }
}

/// A task by its values: the last parts of the keys suffice.
fn name_of(head: &Head, task: &Task) -> String {
    let part = |(key, value): (&String, &serde_json::Value)| {
        let value = value.as_f64().map_or_else(|| value.to_string(), |number| significant(number, 6));
        format!("{} {value}", key.rsplit('.').next().unwrap_or(key))
    };
    let values: Vec<String> = head.columns.iter().zip(&task.values).map(part).collect();
    let what = if task.is_reference { "reference, " } else { "" };
    format!("{what}{}", values.join(", "))
}
