//! What of a sweep was given to Slurm: its jobs by their numbers, and which task which element has.
//!
//! | file | what |
//! |---|---|
//! | `slurm.json` | all submissions |
//! | `slurm/N-ROLE.sh`, `slurm/N-ROLE.txt` | batch scripts of the N-th submission; the keys of its tasks, a line each |
//! | `slurm/JOB_ELEMENT.out` | what an element printed |
//!
//! Lists hold keys and not numbers: those stay what they are where the sweep is changed.

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::error::SweepError;
use super::folder::Folder;
use super::slurm::{Queued, Role};

const FILE: &str = "slurm.json";

/// A job that was submitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Submitted {
    /// What it is for.
    pub role: Role,
    /// Its number.
    pub job: u64,
    /// Elements of the array; 0 where it is none.
    pub elements: usize,
    /// Tasks of each element.
    pub per_element: usize,
}

/// Jobs that were submitted together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Submission {
    /// Its number in the sweep, from 1 on.
    pub number: usize,
    /// The jobs.
    pub jobs: Vec<Submitted>,
}

/// All submissions of a sweep.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Submissions {
    /// From the first to the last.
    pub submissions: Vec<Submission>,
}

impl Submissions {
    /// Reads those of a folder; none where nothing was submitted.
    ///
    /// # Errors
    /// Where they cannot be read.
    pub fn of(folder: &Folder) -> Result<Self, SweepError> {
        let path = folder.path().join(FILE);
        match fs::read(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(Self::default()),
            Err(source) => Err(SweepError::Read { path, source }),
            Ok(text) => serde_json::from_slice(&text).map_err(|why| SweepError::Damaged {
                path,
                what: "list of Slurm's jobs",
                problem: why.to_string(),
            }),
        }
    }

    /// Writes them.
    ///
    /// # Errors
    /// Where they cannot be written.
    pub fn keep(&self, folder: &Folder) -> Result<(), SweepError> {
        folder.write(FILE, &serde_json::to_vec_pretty(self).unwrap_or_default())
    }

    /// All jobs, with the submission of each.
    pub fn jobs(&self) -> impl Iterator<Item = (usize, &Submitted)> {
        self.submissions.iter().flat_map(|all| all.jobs.iter().map(|job| (all.number, job)))
    }

    /// Keys of the tasks that Slurm still has.
    ///
    /// # Errors
    /// Where a list cannot be read.
    pub fn keys_in(&self, queue: &[Queued], folder: &Folder) -> Result<BTreeSet<String>, SweepError> {
        let mut keys = BTreeSet::new();
        for (number, job) in self.jobs().filter(|(_, job)| job.elements > 0) {
            let elements: Vec<usize> =
                queue.iter().filter(|one| one.job == job.job).filter_map(|one| one.element).collect();
            if elements.is_empty() {
                continue;
            }
            let path = list_path(folder, number, job.role);
            let text = fs::read_to_string(&path).map_err(|source| SweepError::Read { path, source })?;
            let lines: Vec<&str> = text.lines().collect();
            let parts = elements.iter().filter_map(|element| lines.chunks(job.per_element.max(1)).nth(element - 1));
            keys.extend(parts.flatten().map(|key| (*key).to_owned()));
        }
        Ok(keys)
    }
}

/// Where a file for Slurm lies: of a role in a submission, with this ending.
fn path_of(folder: &Folder, number: usize, role: Role, ending: &str) -> PathBuf {
    folder.path().join("slurm").join(format!("{number}-{role}.{ending}"))
}

/// Where the keys of the tasks of a job lie.
pub fn list_path(folder: &Folder, number: usize, role: Role) -> PathBuf {
    path_of(folder, number, role, "txt")
}

/// Writes the keys of the tasks of a job; gives back where they lie.
///
/// # Errors
/// Where they cannot be written.
pub fn keep_list(folder: &Folder, number: usize, role: Role, keys: &[String]) -> Result<PathBuf, SweepError> {
    let text: String = keys.iter().map(|key| format!("{key}\n")).collect();
    kept(folder, list_path(folder, number, role), &text)
}

/// Writes a batch script; gives back where it lies.
///
/// # Errors
/// Where it cannot be written.
pub fn keep_script(folder: &Folder, number: usize, role: Role, text: &str) -> Result<PathBuf, SweepError> {
    kept(folder, path_of(folder, number, role, "sh"), text)
}

fn kept(folder: &Folder, path: PathBuf, text: &str) -> Result<PathBuf, SweepError> {
    let beside = folder.path().join("slurm");
    fs::create_dir_all(&beside).map_err(|source| SweepError::Write { path: beside.clone(), source })?;
    let name = path.strip_prefix(folder.path()).unwrap_or(&path).to_string_lossy().into_owned();
    folder.write(&name, text.as_bytes())?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tasks_in_the_queue_are_known_by_their_elements() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::at(place.path());
        assert_eq!(Submissions::of(&folder).unwrap(), Submissions::default());
        let keys: Vec<String> = (1..=7).map(|number| format!("key{number}")).collect();
        keep_list(&folder, 1, Role::Tasks, &keys).unwrap();
        let array = Submitted { role: Role::Tasks, job: 12, elements: 3, per_element: 3 };
        let collecting = Submitted { role: Role::Collect, job: 15, elements: 0, per_element: 0 };
        let all = Submissions { submissions: vec![Submission { number: 1, jobs: vec![array, collecting] }] };
        all.keep(&folder).unwrap();
        let all = Submissions::of(&folder).unwrap();
        let queue = Queued::all_of("12|1|RUNNING\n12|3|PENDING\n15|N/A|PENDING\n99|2|RUNNING\n12|9|PENDING\n");
        let found: Vec<String> = all.keys_in(&queue, &folder).unwrap().into_iter().collect();
        assert_eq!(found, ["key1", "key2", "key3", "key7"]);
        assert!(all.keys_in(&[], &folder).unwrap().is_empty());
    }
}
