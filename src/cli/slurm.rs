//! Slurm's programs, called: what they print is read in [`crate::sweep`].

use std::io::ErrorKind;
use std::path::Path;
use std::process::Command;

use super::failure::Failure;
use crate::sweep::{END_FORMAT, QUEUE_FORMAT, Queued, job_number, max_array_size, shell_word, time_left};

/// Seconds before the end of its time within which a job is told of it: Slurm may be a minute early.
const TOLD_WITHIN_S: u64 = 120;

/// Submits a batch script that is to begin once other jobs have ended, however they did; gives back the number of its job.
pub(super) fn sbatch(script: &Path, after: Option<u64>) -> Result<u64, Failure> {
    let mut arguments = vec!["--parsable".to_owned()];
    arguments.extend(after.map(|job| format!("--dependency=afterany:{job}")));
    arguments.push(script.display().to_string());
    let printed = said("sbatch", &arguments)?;
    job_number(&printed).ok_or_else(|| Failure::SlurmRefused {
        command: line("sbatch", &arguments),
        said: format!("no number of a job, but {printed:?}"),
    })
}

/// Slurm's own limit of arrays.
pub(super) fn asked_max_array_size() -> Result<Option<usize>, Failure> {
    said("scontrol", &["show", "config"].map(str::to_owned)).map(|printed| max_array_size(&printed))
}

/// What of these jobs has not ended.
pub(super) fn queued(jobs: &[u64]) -> Result<Vec<Queued>, Failure> {
    if jobs.is_empty() {
        return Ok(Vec::new());
    }
    let numbers = jobs.iter().map(u64::to_string).collect::<Vec<_>>().join(",");
    let arguments = ["--noheader", "--array", &format!("--jobs={numbers}"), &format!("--format={QUEUE_FORMAT}")];
    match said("squeue", &arguments.map(str::to_owned)) {
        // Slurm forgets jobs that have ended a while ago, and says so where it knows none of them.
        Err(Failure::SlurmRefused { said, .. }) if said.contains("Invalid job id") => Ok(Vec::new()),
        printed => printed.map(|printed| Queued::all_of(&printed)),
    }
}

/// The job that this process runs in.
#[derive(Debug)]
pub(super) struct OwnJob {
    /// As Slurm's programs take it: with its number in the array.
    name: String,
    /// How often it was put back into the queue.
    pub(super) restarts: u32,
}

impl OwnJob {
    /// Reads the environment; `None` where this is no job.
    pub(super) fn of_environment() -> Option<Self> {
        let set = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
        let of_array = || Some(format!("{}_{}", set("SLURM_ARRAY_JOB_ID")?, set("SLURM_ARRAY_TASK_ID")?));
        let name = of_array().or_else(|| set("SLURM_JOB_ID"))?;
        let restarts = set("SLURM_RESTART_COUNT").and_then(|count| count.parse().ok()).unwrap_or(0);
        Some(Self { name, restarts })
    }

    /// Seconds until its time is over, where it runs and that is near. A job that Slurm ends itself, for another one or at a request,
    /// runs no longer for Slurm, or is far from its limit.
    pub(super) fn seconds_to_limit(&self) -> Option<u64> {
        let arguments = ["--noheader", &format!("--jobs={}", self.name), &format!("--format={END_FORMAT}")];
        let left = match said("squeue", &arguments.map(str::to_owned)) {
            Ok(printed) => time_left(&printed),
            // Newer versions of Slurm tell the job itself.
            Err(_) => {
                let end = std::env::var("SLURM_JOB_END_TIME").ok().and_then(|end| end.parse::<u64>().ok());
                let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
                end.map(|end| end.saturating_sub(now.as_secs()))
            }
        };
        left.filter(|left| *left <= TOLD_WITHIN_S)
    }

    /// Asks Slurm to put it back into the queue, which ends it.
    pub(super) fn requeue(&self) -> Result<(), Failure> {
        said("scontrol", &["requeue".to_owned(), self.name.clone()]).map(|_| ())
    }
}

/// What one of Slurm's programs prints.
fn said(program: &'static str, arguments: &[String]) -> Result<String, Failure> {
    let output = Command::new(program).args(arguments).output().map_err(|source| match source.kind() {
        ErrorKind::NotFound => Failure::NoSlurm { program },
        _ => Failure::SlurmNotAsked { program, source },
    })?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
    Err(Failure::SlurmRefused { command: line(program, arguments), said })
}

/// A command as a shell takes it.
fn line(program: &str, arguments: &[String]) -> String {
    let words = arguments.iter().map(|word| shell_word(word));
    std::iter::once(program.to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}
