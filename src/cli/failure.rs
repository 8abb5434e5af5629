//! What can stop a command, in words, with the exit code for scripts.

use std::io;
use std::path::PathBuf;

use crate::history::{ConditionError, NothingKept, ReplayError, SnapError, StabilityError};
use crate::model::ModelError;
use crate::printable::{one_line, word};
use crate::record::Parameter;
use crate::scene::{Scene, Stage};
use crate::study::{AccuracyError, BenchError, CalibrationError, NotASpring, TaskError};
use crate::sweep::SweepError;
use crate::units::{count, rounded};
use crate::view::{AnimationError, PlotError, SamplesError};

/// Stopped by a signal; nothing is wrong.
pub(super) const INTERRUPTED: u8 = 75;

/// Below the options in `--help`.
pub(super) const EXIT_CODES: &str = "\
Exit codes:
   0  done
   1  failed; what was logged before is kept
   2  wrong arguments, a wrong scene, or no such file; nothing was started
  75  interrupted by SIGINT, SIGTERM, SIGHUP, SIGUSR1 or SIGXCPU, after the stage in hand;
      `foldline resume LOG` continues where it stopped";

/// Why a command did not do what it was asked to.
#[derive(Debug, thiserror::Error)]
pub(super) enum Failure {
    #[error("cannot read {}", path.display())]
    Read { path: PathBuf, source: io::Error },
    #[error(
        "cannot read {}: there is no such file, and no scene of that name comes with the program{}; `foldline scenes` lists those",
        path.display(), offered(nearest)
    )]
    NoSuchSceneFile { path: PathBuf, nearest: Vec<&'static str> },
    #[error("no scene that comes with the program has `{filter}` in its name; `foldline scenes` lists them")]
    NoShippedScene { filter: String },
    #[error("{} is no scene: {reason}", path.display())]
    NotText { path: PathBuf, reason: String },
    #[error("{} exists and is not overwritten: {found}", log.display())]
    LogIsThere { log: PathBuf, found: String },
    #[error("{place}: {reason}")]
    WrongSetting { place: String, reason: String },
    #[error("cannot write {}", path.display())]
    Write { path: PathBuf, source: io::Error },
    #[error("{} is a study, and others of these are logs: a page is of logs or of studies; write one of each", study.display())]
    StudyAmongLogs { study: PathBuf },
    #[error("{} exists and is not overwritten: remove it, or choose another place for what is written", path.display())]
    InTheWay { path: PathBuf },
    #[error("cannot write to standard output")]
    Print { source: io::Error },
    /// Everything that is wrong with a scene, rendered with its lines.
    #[error("{rendered}")]
    WrongScene { rendered: String },
    #[error(
        "--until {} is beyond the {} that the scene asks for; raise `{}` there",
        rounded(*until), Parameter::of(scene).shown(scene.load.target()),
        if scene.end_rotation().is_some() { "load.rotation_deg" } else { "load.factor" }
    )]
    UntilBeyondScene { until: f64, scene: Box<Scene> },
    #[error("cannot use the log {}", log.display())]
    WrongLog { log: PathBuf, source: Box<dyn std::error::Error + Send + Sync> },
    #[error("{} has no load step {step}; {}", log.display(), known_steps(*known))]
    NoSuchStep { log: PathBuf, step: u64, known: Option<(u64, u64)> },
    #[error("the run stopped{}", if *keeps { format!("; {} keeps every stage before", log.display()) } else { String::new() })]
    Stopped { log: PathBuf, keeps: bool, source: Box<dyn std::error::Error + Send + Sync> },
    #[error("interrupted; continue with: foldline resume {}", word(&log.to_string_lossy()))]
    Interrupted { log: PathBuf },
    #[error(transparent)]
    Plot(#[from] PlotError),
    #[error(transparent)]
    Samples(#[from] SamplesError),
    #[error(transparent)]
    Animation(#[from] AnimationError),
    #[error("{frames} frames are more than the {most} of an animation: take fewer load steps with --every {enough}")]
    TooManyFrames { frames: usize, most: usize, enough: u64 },
    #[error("no help on `{topic}`; there is help on {}{}", known.join(", "), did_you_mean(topic, known))]
    NoSuchTopic { topic: String, known: Vec<String> },
    #[error("no field `{field}`; there are {}{}", known.join(", "), did_you_mean(field, known))]
    NoSuchField { field: String, known: Vec<String> },
    #[error("{} has no `{quantity}` to draw; there are {}{}", log.display(), known.join(", "), did_you_mean(quantity, known))]
    NoSuchQuantity { log: PathBuf, quantity: String, known: Vec<String> },
    #[error("{option} is for the mesh, which is drawn of one log, and {logs} are given")]
    MeshOfOneLog { option: &'static str, logs: usize },
    #[error(
        "these logs have no curve in common, since the ends of some turn and those of others do not: choose one with --x and --y"
    )]
    NoCommonCurve,
    #[error(
        "{} has no shell \"{name}\"; {}",
        log.display(),
        match &known[..] {
            [] => "it has one shell, which has no name: leave --shell out".to_owned(),
            known => format!("there are {}: choose one with --shell, or leave that out for all of them", known.join(", ")),
        }
    )]
    NoSuchShell { log: PathBuf, name: String, known: Vec<String> },
    #[error("--shell is given, and what viewers are shown has all shells: leave it out")]
    ShellForViewers,
    #[error("{} has no probe to draw the load factor over: choose a curve with --x and --y", log.display())]
    NoProbe { log: PathBuf },
    #[error(
        "{} is one file, and {steps} load steps are chosen: name a folder, or one step with --steps", file.display()
    )]
    StepsInOneFile { file: PathBuf, steps: usize },
    #[error(
        "{} is one file, and the load steps lie on {meshes} meshes: name a folder, or steps on one mesh with --steps", file.display()
    )]
    MeshesInOneFile { file: PathBuf, meshes: usize },
    #[error("{fields} fields are chosen, and one colours the mesh: name one with --fields")]
    FieldsForViewers { fields: usize },
    #[error("--times is for viewers of MCAP: leave it out, or write `--to mcap`")]
    TimesOfNoViewer,
    #[error("not one thread can be made")]
    Threads { source: Box<dyn std::error::Error + Send + Sync> },
    #[error("cannot watch for signals")]
    Signals { source: io::Error },
    #[error("{} holds no scene", log.display())]
    NoScene { log: PathBuf },
    #[error(
        "the scene that stage {ordinal} of {} was run with is lost; `foldline run SCENE -o {} --resume` with that scene's file brings it back",
        log.display(), word(&log.to_string_lossy())
    )]
    SceneLost { log: PathBuf, ordinal: usize },
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error(transparent)]
    NothingKept(#[from] NothingKept),
    #[error("the log {} cannot be resumed", log.display())]
    Resume { log: PathBuf, source: Box<dyn std::error::Error + Send + Sync> },
    #[error("load step {step} of {} has no {stage}; it has {}", log.display(), known.join(", "))]
    NoSuchStage { log: PathBuf, step: u64, stage: Stage, known: Vec<String> },
    #[error("stage {ordinal} ({stage} of step {step}) cannot be run again")]
    Replay { ordinal: u64, stage: Stage, step: u64, source: Box<ReplayError> },
    #[error(transparent)]
    Condition(#[from] ConditionError),
    #[error(transparent)]
    Snap(#[from] Box<SnapError>),
    #[error(
        "{path} is part of the states in the log: it has no effect on a stage that is run again from one; run the changed scene instead"
    )]
    NoEffect { path: String },
    #[error("the log cannot be started")]
    CannotStart { source: Box<dyn std::error::Error + Send + Sync> },
    #[error("nothing can be timed")]
    Bench { source: Box<BenchError> },
    #[error("degree {}, {} × {} elements gave nothing", degree[0], elements[0], elements[1])]
    Convergence { degree: [usize; 2], elements: [usize; 2], source: Box<TaskError> },
    #[error(transparent)]
    NotASpring(#[from] NotASpring),
    #[error("{scene} cannot be calibrated")]
    Calibration { scene: String, source: Box<CalibrationError> },
    #[error("{failed} of {of} runs gave nothing to compare")]
    StudyIncomplete { failed: usize, of: usize },
    /// Rendered as an error of a scene is.
    #[error("wrong study")]
    WrongStudy { rendered: String },
    #[error("no run of a study can be kept")]
    Archive { source: Box<TaskError> },
    #[error("interrupted; the same command continues the study, and does no finished run again")]
    StudyInterrupted,
    #[error("{key} is set more than once: give all its values in one list")]
    VariedTwice { key: String },
    #[error("{case} gave nothing to compare")]
    Study { case: String, source: Box<AccuracyError> },
    #[error(transparent)]
    Sweep(#[from] SweepError),
    #[error(
        "{} has not been begun: `foldline sweep run {}` does, and a folder is named by itself", sweep.display(), word(&sweep.to_string_lossy())
    )]
    NoSweep { sweep: PathBuf },
    #[cfg(feature = "parquet")]
    #[error("the table cannot be written as Parquet")]
    Parquet { source: Box<dyn std::error::Error + Send + Sync> },
    #[cfg(not(feature = "parquet"))]
    #[error(
        "this program was built without Parquet: `cargo install --path . --features parquet` builds one with it, and --csv is always there"
    )]
    NoParquet,
    #[error("{} is a sweep over designs, and a scene is wanted: foldline sweep run {}", file.display(), word(&file.to_string_lossy()))]
    IsSweep { file: PathBuf },
    #[error(
        "{rows} rows are more than the {most} that a page holds: choose some with --where, or write all with `sweep status --csv`"
    )]
    TooManyRows { rows: usize, most: usize },
    #[error("interrupted; continue with: foldline sweep resume {}", word(&folder.to_string_lossy()))]
    SweepInterrupted { folder: PathBuf },
    #[error("{} left, for reasons of the machine and not of their scenes; continue with: foldline sweep resume {}", count(*left, "task"), word(&folder.to_string_lossy()))]
    SweepLeft { left: usize, folder: PathBuf },
    #[error("task {number} of the sweep is not done, for a reason of the machine and not of its scene")]
    SweepTask { number: usize, source: Box<TaskError> },
    #[error(
        "task {number} was interrupted after the stage in hand; it goes on in the next turn of its job, or with: {}",
        way_on(folder)
    )]
    TaskInterrupted { number: usize, folder: PathBuf },
    #[error("task {number} is in the hands of another process, which has not ended it in a minute")]
    TaskHeld { number: usize, source: Box<TaskError> },
    #[error("{} left; submit what is left with: {}", count(*left, "task"), way_on(folder))]
    CollectedLess { left: usize, folder: PathBuf },
    #[error(
        "there is no `{program}` here: submit where Slurm's programs are, or write the scripts alone with --dry-run"
    )]
    NoSlurm { program: &'static str },
    #[error("`{program}` cannot be started")]
    SlurmNotAsked { program: &'static str, source: io::Error },
    #[error("Slurm refused `{command}`: {}", if said.is_empty() { "it gave no reason" } else { said })]
    SlurmRefused { command: String, said: String },
    #[error("the stability of stage {index} of {} cannot be found", log.display())]
    Stability { log: PathBuf, index: usize, source: Box<StabilityError> },
    #[error("{}; there is {}", none_chosen(filter.as_deref(), folder), if known.is_empty() { "none".to_owned() } else { known.join(", ") })]
    NoSuchScene { filter: Option<String>, folder: PathBuf, known: Vec<String> },
    #[error("no stage of {} meets the condition `{condition}`", log.display())]
    NeverHolds { log: PathBuf, condition: String },
}

impl Failure {
    /// The exit code, as listed in [`EXIT_CODES`].
    pub(super) fn exit_code(&self) -> u8 {
        match self {
            Failure::Read { .. }
            | Failure::LogIsThere { .. }
            | Failure::WrongSetting { .. }
            | Failure::NoSuchSceneFile { .. }
            | Failure::NoShippedScene { .. }
            | Failure::NotText { .. }
            | Failure::InTheWay { .. }
            | Failure::StudyAmongLogs { .. }
            | Failure::WrongScene { .. }
            | Failure::UntilBeyondScene { .. }
            | Failure::NoSuchStep { .. }
            | Failure::NoSuchStage { .. }
            | Failure::NoEffect { .. }
            | Failure::CannotStart { .. }
            | Failure::Model(_)
            | Failure::Condition(_)
            | Failure::VariedTwice { .. }
            | Failure::WrongStudy { .. }
            | Failure::NoSuchTopic { .. }
            | Failure::NoSuchField { .. }
            | Failure::NoSuchQuantity { .. }
            | Failure::MeshOfOneLog { .. }
            | Failure::NoCommonCurve
            | Failure::TooManyFrames { .. }
            | Failure::NoProbe { .. }
            | Failure::NoSuchShell { .. }
            | Failure::ShellForViewers
            | Failure::StepsInOneFile { .. }
            | Failure::MeshesInOneFile { .. }
            | Failure::FieldsForViewers { .. }
            | Failure::TimesOfNoViewer
            | Failure::NoSweep { .. }
            | Failure::NoSlurm { .. }
            | Failure::NoSuchScene { .. } => 2,
            Failure::Sweep(error) if !matches!(error, SweepError::Write { .. }) => 2,
            #[cfg(not(feature = "parquet"))]
            Failure::NoParquet => 2,
            Failure::NotASpring(_) | Failure::IsSweep { .. } | Failure::TooManyRows { .. } => 2,
            // A wrong scene as well.
            Failure::Convergence { source, .. } if matches!(**source, TaskError::Model(_)) => 2,
            Failure::Calibration { source, .. }
                if !matches!(**source, CalibrationError::Run { .. } | CalibrationError::NothingInCommon) =>
            {
                2
            }
            Failure::Study { source, .. }
                if matches!(
                    **source,
                    AccuracyError::NothingMeasured
                        | AccuracyError::AlongPath { .. }
                        | AccuracyError::OtherStructure { .. }
                ) || matches!(&**source, AccuracyError::Task(task) if matches!(**task, TaskError::Model(_))) =>
            {
                2
            }
            Failure::Interrupted { .. }
            | Failure::StudyInterrupted
            | Failure::SweepInterrupted { .. }
            | Failure::TaskInterrupted { .. }
            | Failure::TaskHeld { .. } => INTERRUPTED,
            _ => 1,
        }
    }

    /// The failure and what is below it, a line each.
    pub(super) fn in_full(&self) -> String {
        let mut text = match self {
            // A line for each change, or lines of a file.
            Failure::NothingKept(_) | Failure::LogIsThere { .. } | Failure::Sweep(_) => self.to_string(),
            _ => one_line(&self.to_string()).into_owned(),
        };
        let mut cause = std::error::Error::source(self);
        while let Some(error) = cause {
            text.push_str(&format!("\n  because: {}", one_line(&error.to_string())));
            cause = error.source();
        }
        text
    }
}

/// Names in place of a wrong one, in words.
fn offered(nearest: &[&str]) -> String {
    match nearest {
        [] => String::new(),
        names => format!(" (the nearest: {})", names.join(", ")),
    }
}

fn none_chosen(filter: Option<&str>, folder: &std::path::Path) -> String {
    match filter {
        Some(filter) => format!("no scene in {} has `{filter}` in its name", folder.display()),
        None => format!("no scene in {}", folder.display()),
    }
}

/// How a sweep goes on that was submitted to Slurm.
fn way_on(folder: &std::path::Path) -> String {
    format!("foldline sweep resume {} --slurm", folder.display())
}

fn known_steps(known: Option<(u64, u64)>) -> String {
    match known {
        Some((first, last)) => format!("it has {first} to {last}"),
        None => "it holds no stage yet".to_string(),
    }
}

fn did_you_mean(topic: &str, known: &[String]) -> String {
    let likely = known.iter().min_by_key(|name| strsim::damerau_levenshtein(topic, name));
    match likely {
        Some(name) if strsim::damerau_levenshtein(topic, name) <= 2 => format!("; did you mean `{name}`?"),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_stand_below() {
        let source = io::Error::new(io::ErrorKind::NotFound, "no such file");
        let failure = Failure::Read { path: "a.toml".into(), source };
        assert_eq!(failure.in_full(), "cannot read a.toml\n  because: no such file");
        assert_eq!(failure.exit_code(), 2);
    }

    #[test]
    fn a_step_that_is_not_there_says_which_are() {
        let failure = Failure::NoSuchStep { log: "a.mcap".into(), step: 9, known: Some((1, 4)) };
        assert_eq!(failure.in_full(), "a.mcap has no load step 9; it has 1 to 4");
        assert_eq!(failure.exit_code(), 2);
    }

    #[test]
    fn interruption_says_how_to_go_on() {
        let failure = Failure::Interrupted { log: "a.mcap".into() };
        assert_eq!(failure.in_full(), "interrupted; continue with: foldline resume a.mcap");
        assert_eq!(failure.exit_code(), 75);
    }
}
