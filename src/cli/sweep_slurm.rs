//! A sweep on a cluster with Slurm: what of it is submitted, and how far that is.

use std::collections::BTreeSet;
use std::path::PathBuf;

use clap::Args;

use super::failure::Failure;
use super::output::{eprint, path_in_line, print, print_as_it_is, print_json};
use super::session::open_archive;
use super::slurm::{asked_max_array_size, queued, sbatch};
use crate::sweep::{
    Array, Folder, JobOptions, Role, Script, Submission, Submissions, Submitted, Task, USUAL_MAX_ARRAY_SIZE, Work,
    keep_list, keep_script, shell_word, to_do,
};
use crate::units::count;

/// How a sweep is submitted.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "On a cluster")]
pub(super) struct SlurmArguments {
    /// Submit the tasks to Slurm instead of doing them here: job arrays, and a job behind them that collects the table
    #[arg(long, conflicts_with = "tasks")]
    slurm: bool,
    /// Write the batch scripts and show how they would be submitted
    #[arg(long, requires = "slurm")]
    dry_run: bool,
    /// Partition [default: Slurm's]
    #[arg(long, value_name = "P", requires = "slurm", value_parser = one_word)]
    partition: Option<String>,
    /// Limit of time for each job; what it interrupts goes on in the same job's next turn [default: Slurm's]
    #[arg(long, value_name = "[DAYS-]HH:MM:SS", requires = "slurm", value_parser = one_word)]
    time: Option<String>,
    /// Account [default: Slurm's]
    #[arg(long, value_name = "A", requires = "slurm", value_parser = one_word)]
    account: Option<String>,
    /// Memory of each job, MB [default: Slurm's]
    #[arg(long, value_name = "MB", requires = "slurm", value_parser = clap::value_parser!(u64).range(1..))]
    memory: Option<u64>,
    /// Tasks of each job, one after another; more where Slurm allows fewer jobs than that
    #[arg(long, value_name = "K", requires = "slurm", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    per_job: u32,
    /// Jobs at a time, at most [default: as many as Slurm has room for]
    #[arg(long, value_name = "N", requires = "slurm", value_parser = clap::value_parser!(u32).range(1..))]
    at_most: Option<u32>,
    /// Another option for sbatch, such as --sbatch='--qos=long'; may be repeated
    #[arg(long, value_name = "OPTION", requires = "slurm", allow_hyphen_values = true)]
    sbatch: Vec<String>,
}

fn one_word(text: &str) -> Result<String, String> {
    match text.is_empty() || text.chars().any(|c| c.is_whitespace() || c.is_control()) {
        true => Err("one word is wanted, as sbatch takes it".to_owned()),
        false => Ok(text.to_owned()),
    }
}

/// An array that is to be submitted.
struct Wanted {
    role: Role,
    keys: Vec<String>,
}

impl SlurmArguments {
    /// Whether the sweep goes to Slurm.
    pub(super) fn are_wanted(&self) -> bool {
        self.slurm
    }

    /// Submits what is neither on record nor in the queue.
    pub(super) fn submit(&self, folder: &Folder, threads: usize, json: bool) -> Result<(), Failure> {
        let options = JobOptions {
            partition: self.partition.clone(),
            time: self.time.clone(),
            account: self.account.clone(),
            memory_mb: self.memory,
            threads,
            at_most: self.at_most.map(|most| most as usize),
            lines: self.sbatch.clone(),
        };
        let mut all = Submissions::of(folder)?;
        let in_queue = match self.dry_run {
            true => BTreeSet::new(),
            false => {
                let jobs: Vec<u64> = all.jobs().map(|(_, job)| job.job).collect();
                all.keys_in(&queued(&jobs)?, folder)?
            }
        };
        refused_on_record(folder)?;
        let wanted = wanted(&to_do(folder)?, &in_queue);
        if wanted.is_empty() {
            let why = if in_queue.is_empty() {
                "all tasks are on record".to_owned()
            } else {
                format!("{} in the queue, all others on record", count(in_queue.len(), "task"))
            };
            eprint(&format!("nothing to submit: {why}"));
            return Ok(());
        }
        let max_array_size = match asked_max_array_size() {
            Err(_) if self.dry_run => None,
            asked => asked?,
        };
        let number = all.submissions.iter().map(|one| one.number).max().unwrap_or(0) + 1;
        let here = folder.path().canonicalize();
        let here = here.map_err(|source| Failure::Read { path: folder.path().to_path_buf(), source })?;
        let program = std::env::current_exe().map_err(|source| Failure::Read { path: "foldline".into(), source })?;
        let script = Script { program: &program, folder: &here, options: &options };
        let scripts =
            self.written(&Folder::at(&here), script, number, &wanted, max_array_size.unwrap_or(USUAL_MAX_ARRAY_SIZE))?;
        if self.dry_run {
            return print_as_it_is(&by_hand(&scripts));
        }
        all.submissions.push(Submission { number, jobs: Vec::new() });
        let submitted = submitted(folder, &mut all, &scripts)?;
        match json {
            true => print_json(&submitted),
            false => print(&in_words(folder, &submitted, &wanted)),
        }
    }

    /// Writes the lists and the scripts, in the order in which they are submitted.
    fn written(
        &self,
        folder: &Folder,
        script: Script<'_>,
        number: usize,
        wanted: &[Wanted],
        max_array_size: usize,
    ) -> Result<Vec<(Role, Array, PathBuf)>, Failure> {
        let mut scripts = Vec::new();
        for Wanted { role, keys } in wanted {
            let array = Array::of(keys.len(), self.per_job as usize, max_array_size, folder.path())?;
            let list = keep_list(folder, number, *role, keys)?;
            let text = script.of_array(*role, array, &list)?;
            scripts.push((*role, array, keep_script(folder, number, *role, &text)?));
        }
        let none = Array { elements: 0, per_element: 0 };
        let collecting = keep_script(folder, number, Role::Collect, &script.of_collecting()?)?;
        scripts.push((Role::Collect, none, collecting));
        Ok(scripts)
    }
}

/// Wrong scenes need no job to be put on record.
fn refused_on_record(folder: &Folder) -> Result<(), Failure> {
    let (head, scene_text) = (folder.head()?, folder.scene_text()?);
    let archive = open_archive(&folder.logs(), 1)?;
    let work = Work::new(&head, &scene_text, &archive);
    for task in to_do(folder)?.iter().filter(|task| task.refused.is_some()) {
        let record = work.of(task, &|| true).map_err(|source| Failure::Archive { source: Box::new(source) })?;
        folder.keep_record(&record)?;
    }
    Ok(())
}

/// Keys of what is to be submitted, each once, references first.
fn wanted(tasks: &[Task], in_queue: &BTreeSet<String>) -> Vec<Wanted> {
    let mut seen = in_queue.clone();
    let mut arrays = Vec::new();
    for (role, is_reference) in [(Role::References, true), (Role::Tasks, false)] {
        let own = tasks.iter().filter(|task| task.is_reference == is_reference);
        let keys: Vec<String> = own.map(|task| task.key.clone()).filter(|key| seen.insert(key.clone())).collect();
        if !keys.is_empty() {
            arrays.push(Wanted { role, keys });
        }
    }
    arrays
}

/// Submits scripts, each to begin after the one before; every number is kept before the next one is asked for.
fn submitted(
    folder: &Folder,
    all: &mut Submissions,
    scripts: &[(Role, Array, PathBuf)],
) -> Result<Submission, Failure> {
    let mut after = None;
    for (role, Array { elements, per_element }, script) in scripts {
        let job = sbatch(script, after)?;
        after = Some(job);
        if let Some(last) = all.submissions.last_mut() {
            last.jobs.push(Submitted { role: *role, job, elements: *elements, per_element: *per_element });
        }
        all.keep(folder)?;
    }
    Ok(all.submissions.last().cloned().unwrap_or(Submission { number: 0, jobs: Vec::new() }))
}

/// The lines that submit scripts from a shell.
fn by_hand(scripts: &[(Role, Array, PathBuf)]) -> String {
    let mut after = String::new();
    let mut text = String::new();
    for (role, _, script) in scripts {
        let script = shell_word(&script.display().to_string());
        text += &format!("{role}=$(sbatch --parsable{after} {script})\n");
        after = format!(" --dependency=afterany:${role}");
    }
    text
}

fn in_words(folder: &Folder, submission: &Submission, wanted: &[Wanted]) -> String {
    let mut text = String::new();
    for Submitted { role, job, elements, per_element } in &submission.jobs {
        let own = wanted.iter().find(|wanted| wanted.role == *role);
        text += &match own {
            Some(Wanted { keys, .. }) => {
                let each = if *per_element > 1 { format!(", {per_element} each") } else { String::new() };
                let what = if *role == Role::References { "reference" } else { "task" };
                format!("job {job}: {} in {}{each}\n", count(keys.len(), what), count(*elements, "element"))
            }
            None => format!("job {job}: collects {}/table.csv\n", path_in_line(folder.path())),
        };
    }
    text + &format!("how far they are: foldline sweep status {}\n", path_in_line(folder.path()))
}

/// How far the jobs of a sweep are, in a line; `None` where nothing was submitted.
pub(super) fn queue_line(folder: &Folder) -> Result<Option<String>, Failure> {
    let all = Submissions::of(folder)?;
    let jobs: Vec<u64> = all.jobs().map(|(_, job)| job.job).collect();
    if jobs.is_empty() {
        return Ok(None);
    }
    let Ok(queue) = queued(&jobs) else {
        let named: Vec<String> = jobs.iter().map(u64::to_string).collect();
        let (jobs, verb) = if named.len() == 1 { ("job", "was") } else { ("jobs", "were") };
        return Ok(Some(format!(
            "Slurm: {jobs} {} {verb} submitted; it cannot be asked from here\n",
            named.join(", ")
        )));
    };
    let elements = || queue.iter().filter(|one| one.element.is_some());
    let waiting = elements().filter(|one| one.waits()).count();
    let running = elements().count() - waiting;
    let collecting = if queue.len() > elements().count() { ", then the table is collected" } else { "" };
    Ok(Some(match queue.is_empty() {
        true => "Slurm: none of the jobs is left in the queue\n".to_owned(),
        false => format!("Slurm: {} waiting, {running} running{collecting}\n", count(waiting, "element")),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn task(key: &str, is_reference: bool) -> Task {
        Task { number: 0, key: key.to_owned(), values: vec![], is_reference, reference: None, refused: None }
    }

    #[test]
    fn what_is_in_the_queue_is_not_submitted_again() {
        let tasks = [task("r", true), task("a", false), task("b", false), task("a", false), task("c", false)];
        let keys = |in_queue: &[&str]| -> Vec<Vec<String>> {
            let in_queue = in_queue.iter().map(|key| (*key).to_owned()).collect();
            wanted(&tasks, &in_queue).into_iter().map(|wanted| wanted.keys).collect()
        };
        assert_eq!(keys(&[]), [vec!["r"], vec!["a", "b", "c"]]);
        assert_eq!(keys(&["r", "b"]), [vec!["a", "c"]]);
        assert!(keys(&["r", "a", "b", "c"]).is_empty());
    }

    #[test]
    fn a_dry_run_shows_lines_that_a_shell_takes() {
        let array = Array { elements: 3, per_element: 1 };
        let scripts = [
            (Role::References, array, PathBuf::from("/f/slurm/1-references.sh")),
            (Role::Tasks, array, PathBuf::from("/f/slurm/1-tasks.sh")),
            (Role::Collect, array, PathBuf::from("/f/slurm/1-collect.sh")),
        ];
        assert_eq!(
            by_hand(&scripts),
            "references=$(sbatch --parsable /f/slurm/1-references.sh)\n\
             tasks=$(sbatch --parsable --dependency=afterany:$references /f/slurm/1-tasks.sh)\n\
             collect=$(sbatch --parsable --dependency=afterany:$tasks /f/slurm/1-collect.sh)\n"
        );
    }
}
