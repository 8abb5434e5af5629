//! `foldline sweep`: tables over designs.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use clap::{Args, Subcommand};

use super::failure::{EXIT_CODES, Failure};
use super::output::{
    eprint, file_name, path_in_command, path_in_line, print, print_as_it_is, refuse_what_is_there, write_files,
};
use super::scene_file::{NamedText, read_named};
use super::session::{open_archive, watch_signals};
use super::settings::Settings;
use super::shipped::Shipped;
use super::sweep_progress::{SweepProgress, Told, say_head};
use super::sweep_slurm::{SlurmArguments, queue_line};
use super::sweep_table::{Chosen, table_of};
use super::sweep_task::{CollectArguments, TaskArguments};
use super::wrapped::wrapped;
use crate::study::{EngineError, Workers};
use crate::sweep::{
    Condition, Folder, Head, Outcome, Plan, SweepError, SweepFile, Table, Task, TaskRecord, Work, do_tasks,
    planned_from, to_do,
};
use crate::units::{count, duration};
use crate::view::{PlotError, sweep_page};

/// Rows that a browser can be asked to hold.
const MOST_ON_A_PAGE: usize = 200_000;

/// As long as no task ends, another process is waited for.
const PATIENCE: Duration = Duration::from_secs(600);

/// Between two looks whether another process is through with a task.
const BETWEEN_LOOKS: Duration = Duration::from_secs(1);

/// Run a scene over many designs and collect what each run shows, in a table
#[derive(Args, Debug)]
pub(super) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand, Debug)]
enum Command {
    Run(RunArguments),
    Resume(ResumeArguments),
    Status(StatusArguments),
    Report(ReportArguments),
    Task(TaskArguments),
    Collect(CollectArguments),
}

/// Do all tasks of a sweep that are not done yet, on this machine or as jobs of Slurm
#[derive(Args, Debug)]
#[command(after_help = EXIT_CODES)]
struct RunArguments {
    /// Sweep file (TOML), or the name of one of `foldline scenes`
    sweep: PathBuf,
    /// Folder for its plan, logs and table [default: checkpoints/sweeps/NAME]
    #[arg(long, value_name = "DIR")]
    folder: Option<PathBuf>,
    #[command(flatten)]
    pool: PoolArguments,
    #[command(flatten)]
    slurm: SlurmArguments,
}

/// Continue a sweep from its folder alone, as it was planned
#[derive(Args, Debug)]
#[command(after_help = EXIT_CODES)]
struct ResumeArguments {
    /// Folder of the sweep
    folder: PathBuf,
    #[command(flatten)]
    pool: PoolArguments,
    #[command(flatten)]
    slurm: SlurmArguments,
}

#[derive(Args, Debug)]
struct PoolArguments {
    /// Tasks at a time [default: one for each core, where there is memory for them]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    tasks: Option<u16>,
    /// Threads of each task
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: u16,
    /// Do tasks again that failed, or have no error against their reference
    #[arg(long)]
    retry: bool,
    /// Print a JSON object for each task; with --slurm, the numbers of the jobs
    #[arg(long)]
    json: bool,
}

/// Show the table of a sweep as far as it is done, and how far its jobs are where it was submitted
#[derive(Args, Debug)]
struct StatusArguments {
    /// Folder of the sweep, or its file
    sweep: PathBuf,
    #[command(flatten)]
    chosen: Chosen,
}

/// Write a page about a sweep that needs no network: response curves and surfaces, distributions, parallel coordinates, and the
/// table, each task with a link to its log
#[derive(Args, Debug)]
struct ReportArguments {
    /// Folder of the sweep, or its file
    sweep: PathBuf,
    /// Rows that meet a condition, such as 'peak_moment_n_mm>800' or ending=done; may be repeated
    #[arg(long = "where", value_name = "CONDITION", value_parser = Condition::parse)]
    conditions: Vec<Condition>,
    /// Page to write [default: report.html in the sweep's folder, or report.1.html and so on where that is there]
    #[arg(short, long, value_name = "FILE", value_parser = file_name())]
    output: Option<PathBuf>,
}

impl Arguments {
    /// Does what is asked for.
    pub(super) fn run(self) -> Result<(), Failure> {
        match self.command {
            Command::Run(arguments) => {
                let folder = planned(&arguments.sweep, arguments.folder.as_deref())?;
                arguments.pool.run(&folder, &arguments.slurm)
            }
            Command::Resume(arguments) => arguments.pool.run(&Folder::at(&arguments.folder), &arguments.slurm),
            Command::Status(arguments) => arguments.run(),
            Command::Report(arguments) => report(arguments),
            Command::Task(arguments) => arguments.run(),
            Command::Collect(arguments) => arguments.run(),
        }
    }
}

impl StatusArguments {
    /// Prints the table, and how far the jobs are.
    fn run(self) -> Result<(), Failure> {
        let folder = folder_of(&self.sweep)?;
        print_table(&folder, &self.chosen)?;
        match queue_line(&folder)?.filter(|_| !self.chosen.is_json()) {
            Some(line) => print(&line),
            None => Ok(()),
        }
    }
}

/// Where a sweep of this name is kept.
fn default_folder(file: &Path) -> Result<PathBuf, Failure> {
    let logs = Settings::read()?.logs.unwrap_or_else(|| PathBuf::from("checkpoints"));
    Ok(logs.join("sweeps").join(file.file_stem().unwrap_or(file.as_os_str())))
}

/// The folder that an argument means: a folder, or that of a file.
fn folder_of(sweep: &Path) -> Result<Folder, Failure> {
    let folder = Folder::at(sweep);
    if folder.holds_sweep() {
        return Ok(folder);
    }
    let source = Source::read(sweep)?;
    let folder = Folder::at(&default_folder(&source.file)?);
    if !folder.holds_sweep() {
        return Err(Failure::NoSweep { sweep: sweep.to_path_buf() });
    }
    if !source.is_planned(&folder.head()?) {
        let again = format!(
            "the plan is of an earlier {}: `foldline sweep run {}` plans again",
            path_in_line(sweep),
            path_in_command(sweep)
        );
        eprint(&wrapped("warning: ", &again));
    }
    Ok(folder)
}

/// A sweep as it is written, with the scene that it varies.
struct Source {
    parsed: SweepFile,
    text: String,
    scene_text: String,
    scene_name: String,
    /// Where it is, or would be if it did not come with the program.
    file: PathBuf,
}

impl Source {
    fn read(sweep: &Path) -> Result<Self, Failure> {
        let NamedText { text, file, is_shipped } = read_named(sweep)?;
        let parsed = SweepFile::parse(&text, &path_in_line(sweep))?;
        let beside = file.parent().unwrap_or(Path::new("")).join(&parsed.scene);
        let (scene_text, scene_file) = match Shipped::at(&beside) {
            Some(scene) if is_shipped => (scene.text.to_owned(), scene.file()),
            _ if beside.is_file() => (read_named(&beside)?.text, beside),
            _ => read_named(Path::new(&parsed.scene)).map(|found| (found.text, found.file))?,
        };
        Ok(Self { parsed, text, scene_text, scene_name: scene_file.display().to_string(), file })
    }

    /// Whether a plan is of this very sweep.
    fn is_planned(&self, head: &Head) -> bool {
        head.planned_from == planned_from(&self.text, &self.scene_text, &self.scene_name)
    }

    fn plan(&self) -> Result<Plan, SweepError> {
        let file = self.file.canonicalize().unwrap_or_else(|_| self.file.clone());
        let names = [&file.display().to_string()[..], &self.scene_name];
        Plan::of(&self.parsed, [&self.text, &self.scene_text], names)
    }
}

/// Plans a sweep and keeps the plan in its folder.
fn planned(sweep: &Path, folder: Option<&Path>) -> Result<Folder, Failure> {
    let source = Source::read(sweep)?;
    let folder = Folder::at(&folder.map_or_else(|| default_folder(&source.file), |folder| Ok(folder.to_path_buf()))?);
    // A plan that was left half written, or changed by hand, is made again.
    if !folder.head().is_ok_and(|head| source.is_planned(&head)) {
        folder.keep(&source.plan()?)?;
    }
    Ok(folder)
}

fn print_table(folder: &Folder, chosen: &Chosen) -> Result<(), Failure> {
    print(&table_of(folder, chosen)?)
}

fn report(arguments: ReportArguments) -> Result<(), Failure> {
    let folder = folder_of(&arguments.sweep)?;
    let output = arguments.output.unwrap_or_else(|| free_name(folder.path()));
    refuse_what_is_there([&output])?;
    let mut table = Table::read(&folder)?;
    table.retain(&arguments.conditions)?;
    if table.rows.len() > MOST_ON_A_PAGE {
        return Err(Failure::TooManyRows { rows: table.rows.len(), most: MOST_ON_A_PAGE });
    }
    let command = format!("foldline report {} -o page.html", path_in_command(&folder.logs().join("LOG")));
    let page = sweep_page(&table, &links(&folder.logs(), &output), &command);
    let page = page.map_err(|cause| PlotError::Drawing(cause.to_string()))?;
    write_files(&[(output.clone(), page.into_bytes())])?;
    print_as_it_is(&format!("{}\n", path_in_line(&output)))
}

/// report.html, or the first report.N.html that is free.
fn free_name(folder: &Path) -> PathBuf {
    let names = (1..).map(|number| format!("report.{number}.html"));
    let mut names = std::iter::once("report.html".to_owned()).chain(names).map(|name| folder.join(name));
    names.find(|name| !name.exists()).unwrap_or_else(|| folder.join("report.html"))
}

/// What the links of a page to logs begin with: a path from the page where the logs lie below its folder, else a whole one.
fn links(logs: &Path, page: &Path) -> String {
    let whole = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    let beside = page.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (logs, beside) = (whole(logs), whole(beside));
    match logs.strip_prefix(&beside) {
        Ok(below) => format!("{}/", in_address(below)),
        Err(_) => format!("file://{}/", in_address(&logs)),
    }
}

/// A path as a part of an address (RFC 3986).
fn in_address(path: &Path) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte);
    let text = path.to_string_lossy();
    text.bytes().map(|byte| if plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") }).collect()
}

impl PoolArguments {
    fn run(self, folder: &Folder, slurm: &SlurmArguments) -> Result<(), Failure> {
        let raised = watch_signals()?;
        let (head, scene_text) = (folder.head()?, folder.scene_text()?);
        if self.retry {
            let rows = folder.rows()?.into_iter();
            let short = rows.filter(|row| row.record.as_ref().is_some_and(TaskRecord::is_short));
            let keys: Vec<String> = short.map(|row| row.task.key).collect();
            folder.forget(keys.iter().map(String::as_str))?;
        }
        if slurm.are_wanted() {
            return slurm.submit(folder, usize::from(self.threads), self.json);
        }
        let begin = Instant::now();
        let threads = usize::from(self.threads);
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let workers = Workers { tasks: self.tasks.map_or(cores.div_ceil(threads), usize::from), threads };
        let archive = open_archive(&folder.logs(), threads)?;
        let work = Work::new(&head, &scene_text, &archive);
        let interrupted = || raised.load(Ordering::Relaxed);
        let mut tasks = to_do(folder)?;
        if !self.json {
            say_head(&head, tasks.len(), folder);
        }
        let mut told = Told::default();
        let (mut waits, mut ended) = (false, (0, Instant::now()));
        while !tasks.is_empty() {
            let mut progress = SweepProgress::new(&head, tasks.len(), self.json, waits);
            let take = |task: &Task, outcome: &Outcome| progress.take(task, outcome);
            let done = do_tasks(folder, &work, &tasks, workers, &interrupted, take);
            told += progress.finish();
            done.map_err(|error| match error {
                EngineError::Take(error) => Failure::Sweep(error),
                error => Failure::Threads { source: Box::new(error) },
            })?;
            if interrupted() {
                return Err(Failure::SweepInterrupted { folder: folder.path().to_path_buf() });
            }
            ended = if told.ended > ended.0 { (told.ended, Instant::now()) } else { ended };
            if told.left > 0 || told.elsewhere == 0 || ended.1.elapsed() > PATIENCE {
                break;
            }
            // What another process has in hand it puts on record, or leaves.
            std::thread::sleep(BETWEEN_LOOKS);
            tasks = to_do(folder)?;
            (told.elsewhere, waits) = (0, true);
        }
        if !self.json {
            print_table(folder, &Chosen::default())?;
            eprint(&format!("{} in {}", count(told.ended, "task"), duration(begin.elapsed().as_secs_f64())));
        }
        match told.left + told.elsewhere {
            0 => Ok(()),
            left => Err(Failure::SweepLeft { left, folder: folder.path().to_path_buf() }),
        }
    }
}
