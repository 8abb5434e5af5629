//! A sweep as jobs of Slurm: batch scripts as text, and what Slurm's programs print.
//!
//! An array's element does some tasks of a list, one after another. Its script ends in `exec`, since Slurm sends the signal before
//! the end of the time to the script's own process alone, and one of a shell does not reach the program that it waits for.
//! Elements are numbered from 1 on; the largest number that Slurm allows is one below its `MaxArraySize`.

use std::fmt::{self, Display, Formatter};
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::error::SweepError;

/// What Slurm's `MaxArraySize` is unless it is set.
pub const USUAL_MAX_ARRAY_SIZE: usize = 1001;

/// Seconds between the signal and the end of a job's time: longer than most stages take.
const WARNING_S: u32 = 30;

/// What a job is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// Does the runs that others are compared with.
    References,
    /// Does all others.
    Tasks,
    /// Collects the table.
    Collect,
}

impl Display for Role {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Role::References => "references",
            Role::Tasks => "tasks",
            Role::Collect => "collect",
        })
    }
}

/// What jobs ask for.
#[derive(Clone, Debug, Default)]
pub struct JobOptions {
    /// Partition, where it is not the default one.
    pub partition: Option<String>,
    /// Limit of time for each job, as Slurm writes it.
    pub time: Option<String>,
    /// Account.
    pub account: Option<String>,
    /// Memory of each job, MB.
    pub memory_mb: Option<u64>,
    /// Threads of each task.
    pub threads: usize,
    /// Elements at a time, at most.
    pub at_most: Option<usize>,
    /// More options of `sbatch`, a line each.
    pub lines: Vec<String>,
}

/// A job array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Array {
    /// Number of elements.
    pub elements: usize,
    /// Tasks of each; the last one may have fewer.
    pub per_element: usize,
}

impl Array {
    /// An array for so many tasks: `wanted` for each element, or more where Slurm does not allow as many elements.
    ///
    /// # Errors
    /// Where it allows none; with the sweep's folder.
    pub fn of(tasks: usize, wanted: usize, max_array_size: usize, folder: &Path) -> Result<Self, SweepError> {
        let most = max_array_size.saturating_sub(1);
        if most == 0 {
            let problem = format!("this Slurm allows no job arrays: its MaxArraySize is {max_array_size}");
            return Err(wrong(folder, problem));
        }
        let per_element = wanted.max(1).max(tasks.div_ceil(most));
        Ok(Self { elements: tasks.div_ceil(per_element), per_element })
    }
}

/// What a script runs, and where.
#[derive(Clone, Copy, Debug)]
pub struct Script<'s> {
    /// The program, by its whole path.
    pub program: &'s Path,
    /// Folder of the sweep, by its whole path.
    pub folder: &'s Path,
    /// What its jobs ask for.
    pub options: &'s JobOptions,
}

impl Script<'_> {
    /// The script of an array whose elements do the tasks of a list.
    ///
    /// # Errors
    /// Where what stands in it cannot be written in one.
    pub fn of_array(&self, role: Role, array: Array, list: &Path) -> Result<String, SweepError> {
        let Array { elements, per_element } = array;
        let at_most = self.options.at_most.map_or_else(String::new, |most| format!("%{most}"));
        let own = [
            format!("--array=1-{elements}{at_most}"),
            format!("--cpus-per-task={}", self.options.threads.max(1)),
            format!("--requeue --open-mode=append --signal=B:TERM@{WARNING_S}"),
        ];
        let head = self.head(role, "%A_%a", &own)?;
        let [program, folder, list] = [self.program, self.folder, list].map(|path| self.quoted(path));
        Ok(format!(
            "{head}\n# The shell gives way to the program, so that Slurm's signals reach it.\n\
             exec {} sweep task {} --list {} \\\n    --from $(( (SLURM_ARRAY_TASK_ID - 1) * {per_element} + 1 )) --count {per_element} --threads {}\n",
            program?,
            folder?,
            list?,
            self.options.threads.max(1)
        ))
    }

    /// The script of the job that collects the table.
    ///
    /// # Errors
    /// Where what stands in it cannot be written in one.
    pub fn of_collecting(&self) -> Result<String, SweepError> {
        let own = ["--cpus-per-task=1".to_owned(), "--requeue --open-mode=append".to_owned()];
        let head = self.head(Role::Collect, "%j-%A", &own)?;
        Ok(format!("{head}\nexec {} sweep collect {}\n", self.quoted(self.program)?, self.quoted(self.folder)?))
    }

    /// The options for `sbatch`; those of the user come last, and win.
    fn head(&self, role: Role, output: &str, own: &[String]) -> Result<String, SweepError> {
        let JobOptions { partition, time, account, memory_mb, lines, .. } = self.options;
        let given = |name: &str, value: &Option<String>| value.as_ref().map(|value| format!("--{name}={value}"));
        let folder = self.text_of(self.folder)?.replace('%', "%%");
        let mut all = vec![format!("--job-name=foldline-{role}"), format!("--output=\"{folder}/slurm/{output}.out\"")];
        all.push("--nodes=1 --ntasks=1".to_owned());
        all.extend(given("partition", partition));
        all.extend(given("time", time));
        all.extend(given("account", account));
        all.extend(memory_mb.map(|memory| format!("--mem={memory}M")));
        all.extend_from_slice(own);
        all.extend(lines.iter().map(|line| line.trim().trim_start_matches("#SBATCH").trim().to_owned()));
        if let Some(broken) = all.iter().find(|line| line.contains(['\n', '\r', '\0'])) {
            return Err(wrong(self.folder, format!("an option of sbatch is one line, and this is more: {broken:?}")));
        }
        let lines: String = all.iter().map(|line| format!("#SBATCH {line}\n")).collect();
        Ok(format!("#!/bin/sh\n{lines}"))
    }

    /// A path in the options, between double quotes, where Slurm has no way of writing some characters.
    fn text_of<'p>(&self, path: &'p Path) -> Result<&'p str, SweepError> {
        let text = path.to_str().filter(|text| !text.contains(['"', '\\', '\n', '\r']));
        text.ok_or_else(|| {
            let problem = format!(
                "{path:?} cannot be written in a batch script: choose a folder without quotes, backslashes, line breaks \
                 and bytes that are no text, with --folder"
            );
            wrong(self.folder, problem)
        })
    }

    /// A path as the shell reads it.
    fn quoted(&self, path: &Path) -> Result<String, SweepError> {
        Ok(shell_word(self.text_of(path)?))
    }
}

fn wrong(folder: &Path, problem: String) -> SweepError {
    SweepError::Wrong { file: folder.display().to_string(), problem }
}

/// A word that a shell takes as it is.
pub fn shell_word(text: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-+=:@%,".contains(c);
    if !text.is_empty() && text.chars().all(is_plain) {
        return text.to_owned();
    }
    format!("'{}'", text.replace('\'', "'\\''"))
}

/// The number of a job, as `sbatch --parsable` prints it: alone, or before the name of a cluster.
pub fn job_number(printed: &str) -> Option<u64> {
    printed.trim().split(';').next()?.parse().ok()
}

/// `MaxArraySize`, as `scontrol show config` prints it.
pub fn max_array_size(printed: &str) -> Option<usize> {
    let value = printed.lines().find_map(|line| line.trim().strip_prefix("MaxArraySize"))?;
    value.trim().strip_prefix('=')?.trim().parse().ok()
}

/// An element of an array, or a job, that Slurm has not ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Queued {
    /// Number of the job, or of the array that it belongs to.
    pub job: u64,
    /// Its number in the array.
    pub element: Option<usize>,
    /// Slurm's word for how far it is.
    pub state: String,
}

/// What `squeue` is asked to print of each: the job or array, the number in the array, the state.
pub const QUEUE_FORMAT: &str = "%F|%K|%T";

impl Queued {
    /// Reads what `squeue --noheader --array --format=…` prints with [`QUEUE_FORMAT`]; other lines are none.
    pub fn all_of(printed: &str) -> Vec<Self> {
        let read = |line: &str| {
            let [job, element, state] = line.trim().split('|').collect::<Vec<_>>()[..] else { return None };
            Some(Self { job: job.parse().ok()?, element: element.parse().ok(), state: state.to_owned() })
        };
        printed.lines().filter_map(read).collect()
    }

    /// Whether it has not begun, or is to begin again.
    pub fn waits(&self) -> bool {
        !["RUNNING", "COMPLETING", "SUSPENDED", "STOPPED"].contains(&self.state.as_str())
    }
}

/// What `squeue` is asked to print of a job about its end: its state, and what is left of its time.
pub const END_FORMAT: &str = "%T|%L";

/// Seconds that are left of the time of a job that runs, as `squeue` prints it with [`END_FORMAT`]. `None` where it runs no longer, as when
/// Slurm has put it back into the queue or ended it itself, and where its time has no limit.
pub fn time_left(printed: &str) -> Option<u64> {
    let (state, left) = printed.trim().lines().next()?.split_once('|')?;
    if state != "RUNNING" {
        return None;
    }
    // [days-]hours:minutes:seconds, of which the first ones may be missing.
    let (days, clock) =
        left.split_once('-').map_or((Some(0_u64), left), |(days, clock)| (days.parse::<u64>().ok(), clock));
    let parts = clock.split(':').map(|part| part.parse::<u64>().ok());
    let seconds = parts.reduce(|sum, part| sum?.checked_mul(60)?.checked_add(part?)).flatten()?;
    seconds.checked_add(days?.checked_mul(86_400)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_array_is_larger_than_slurm_allows() {
        let array = |tasks, wanted, most| {
            let Array { elements, per_element } = Array::of(tasks, wanted, most, Path::new("f")).unwrap();
            (elements, per_element)
        };
        assert_eq!(array(20, 1, 1001), (20, 1));
        assert_eq!(array(20, 3, 1001), (7, 3));
        assert_eq!(array(1000, 1, 1001), (1000, 1));
        assert_eq!(array(1001, 1, 1001), (501, 2));
        assert_eq!(array(1_000_000, 1, 1001), (1000, 1000));
        assert_eq!(array(1_000_000, 7, 4_000_001), (142_858, 7));
        assert!(Array::of(1, 1, 0, Path::new("f")).is_err() && Array::of(1, 1, 1, Path::new("f")).is_err());
    }

    #[test]
    fn a_script_ends_in_the_program() {
        let options = JobOptions {
            partition: Some("low".to_owned()),
            time: Some("01:00:00".to_owned()),
            account: Some("shells".to_owned()),
            memory_mb: Some(500),
            threads: 2,
            at_most: Some(4),
            lines: vec!["#SBATCH --qos=long".to_owned()],
        };
        let script =
            Script { program: Path::new("/opt/foldline"), folder: Path::new("/data/my sweep 5%"), options: &options };
        let array = Array { elements: 7, per_element: 3 };
        let text = script.of_array(Role::Tasks, array, Path::new("/data/my sweep 5%/slurm/1-tasks.txt")).unwrap();
        assert_eq!(
            text,
            "#!/bin/sh\n#SBATCH --job-name=foldline-tasks\n#SBATCH --output=\"/data/my sweep 5%%/slurm/%A_%a.out\"\n\
             #SBATCH --nodes=1 --ntasks=1\n#SBATCH --partition=low\n#SBATCH --time=01:00:00\n#SBATCH --account=shells\n#SBATCH --mem=500M\n\
             #SBATCH --array=1-7%4\n#SBATCH --cpus-per-task=2\n#SBATCH --requeue --open-mode=append --signal=B:TERM@30\n#SBATCH --qos=long\n\n\
             # The shell gives way to the program, so that Slurm's signals reach it.\n\
             exec /opt/foldline sweep task '/data/my sweep 5%' --list '/data/my sweep 5%/slurm/1-tasks.txt' \\\n    \
             --from $(( (SLURM_ARRAY_TASK_ID - 1) * 3 + 1 )) --count 3 --threads 2\n"
        );
        let collecting = script.of_collecting().unwrap();
        assert!(collecting.ends_with("\nexec /opt/foldline sweep collect '/data/my sweep 5%'\n"), "{collecting}");
        let odd = Script { folder: Path::new("/data/a\"b"), ..script };
        assert!(odd.of_collecting().unwrap_err().to_string().contains("--folder"));
        let options = JobOptions { lines: vec!["--qos=a\nrm -r /".to_owned()], ..JobOptions::default() };
        assert!(Script { options: &options, ..script }.of_collecting().is_err());
    }

    #[test]
    fn words_stay_words_in_a_shell() {
        assert_eq!(shell_word("/a/b-1.txt"), "/a/b-1.txt");
        assert_eq!(shell_word("it's $HOME"), "'it'\\''s $HOME'");
        assert_eq!(shell_word(""), "''");
    }

    #[test]
    fn what_slurm_prints_is_read() {
        assert_eq!(
            (job_number("12\n"), job_number("12;lab\n"), job_number("sbatch: error")),
            (Some(12), Some(12), None)
        );
        let config = "MailProg = /bin/mail\nMaxArraySize            = 10001\nMaxDBDMsgs = 4\n";
        assert_eq!((max_array_size(config), max_array_size("")), (Some(10001), None));
        let queued = Queued::all_of("12|3|RUNNING\n12|4|PENDING\n14|N/A|PENDING\nslurm_load_jobs error\n");
        let brief: Vec<_> = queued.iter().map(|one| (one.job, one.element, one.waits())).collect();
        assert_eq!(brief, [(12, Some(3), false), (12, Some(4), true), (14, None, true)]);
    }

    #[test]
    fn the_time_that_is_left_is_read_of_jobs_that_run() {
        for (printed, expected) in [
            ("RUNNING|1:57\n", Some(117)),
            ("RUNNING|0:00", Some(0)),
            ("RUNNING|2:00:05", Some(7205)),
            ("RUNNING|1-00:00:10", Some(86_410)),
            ("RUNNING|UNLIMITED", None),
            ("RUNNING|INVALID", None),
            ("RUNNING|NOT_SET", None),
            ("COMPLETING|0:20", None),
            ("PENDING|10:00", None),
            ("", None),
        ] {
            assert_eq!(time_left(printed), expected, "{printed}");
        }
    }
}
