//! `foldline study`: error against run time of scenes and settings.

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use clap::Args;

use super::columns::{Column, Columns};
use super::failure::Failure;
use super::output::{eprint, file_name, path_in_line, print, print_json, say};
use super::scene_file::{checked, read_scene};
use super::session::{open_archive, use_threads, watch_signals};
use super::speed_ups;
use super::terminal::output_columns;
use crate::scene::Scene;
use crate::study::{
    AccuracyError, AccuracyRow, Measured, Purpose, TaskError, in_turn, is_comparable, is_one_structure,
};

/// Run scenes with one setting after another, and hold each against a reference: the error of its moment (or first probe)
/// before and after the first snap, with its run time; or run study files, which say all that themselves
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// Scenes (TOML), or names of `foldline scenes`; where there is no --against, study files or names of studies there
    #[arg(required = true, value_name = "SCENES")]
    scenes: Vec<PathBuf>,
    /// Scene of the reference, or its name: the same structure and increments on a mesh that leaves no doubt. Compared are the load steps
    /// that end where one of its does
    #[arg(long, value_name = "SCENE")]
    against: Option<PathBuf>,
    /// Values that a setting takes in turn, as a TOML list: 'mesh.quadrature=["full", "patch"]'; may be repeated, for all
    /// combinations
    #[arg(long, value_name = "KEY=LIST", value_parser = varied, requires = "against")]
    vary: Vec<Varied>,
    /// Lay a setting over every scene, the reference too, such as load.rotation_deg=20; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Folder for the logs of the runs, each named after the hash of its scene: those that are finished are read, not run again
    #[arg(long, value_name = "DIR", default_value = "checkpoints/studies")]
    logs: PathBuf,
    /// Threads [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Print a JSON object for each run
    #[arg(long)]
    json: bool,
    /// Write a page about the study files at the end: errors against run times, and tables
    #[arg(long, value_name = "FILE", conflicts_with = "against", value_parser = file_name())]
    report: Option<PathBuf>,
}

/// A setting with the values that it takes.
#[derive(Clone, Debug)]
struct Varied {
    key: String,
    values: Vec<String>,
}

fn varied(text: &str) -> Result<Varied, String> {
    let (key, list) = text.split_once('=').ok_or("write KEY=[VALUE, VALUE]")?;
    let table: toml::Table = toml::from_str(&format!("list = {list}")).map_err(|error| {
        format!("{} is not a TOML list ({}); names need quotes: '{key}=[\"one\", \"two\"]'", list, error.message())
    })?;
    match table.get("list") {
        Some(toml::Value::Array(values)) if values.is_empty() => Err(format!("{key} has no value to take")),
        Some(toml::Value::Array(values)) => {
            Ok(Varied { key: key.trim().to_string(), values: values.iter().map(toml::Value::to_string).collect() })
        }
        _ => Err(format!("write the values of {key} as a list: '{key}=[{list}]'")),
    }
}

/// One run of the study.
struct Case {
    scene_name: String,
    settings: Vec<String>,
    scene: Scene,
}

impl Arguments {
    /// Runs the reference and then every case; a row as soon as it is known.
    pub(super) fn run(self) -> Result<(), Failure> {
        let threads = use_threads(self.threads.map(usize::from))?;
        let Some(against) = &self.against else {
            let Self { scenes, set, logs, json, report, .. } = self;
            return speed_ups::run(&scenes, &set, &logs, threads, json, report.as_ref());
        };
        let cases = self.cases()?;
        let name = path_in_line(against);
        let reference = checked(&read_scene(against, &[])?.text, &name, &self.set)?;
        let failed = |case: String| move |source: AccuracyError| Failure::Study { case, source: Box::new(source) };
        for case in &cases {
            is_one_structure(&case.scene, &reference).map_err(failed(case.label()))?;
        }
        is_comparable(&reference, &reference).map_err(failed(name.clone()))?;
        if !self.json {
            eprint(&format!("reference: {name}"));
        }
        let raised = watch_signals()?;
        let archive = open_archive(&self.logs, threads)?;
        let scenes = std::iter::once(&reference).chain(cases.iter().map(|case| &case.scene));
        let runs: Vec<(&Scene, Purpose)> = scenes.map(|scene| (scene, Purpose::Time)).collect();
        let labels = cases.iter().map(Case::label).chain([name.clone()]);
        let table = columns(labels.map(|label| label.chars().count()).max().unwrap_or(0));
        let mut expected: Option<Measured> = None;
        let mut failures = 0;
        in_turn(&archive, &runs, &|| raised.load(Ordering::Relaxed), |index, done| {
            let scene = runs[index].0;
            let measured = match done {
                Err(TaskError::Interrupted) => return Err(Failure::StudyInterrupted),
                Err(error) => Err(AccuracyError::from(Box::new(error))),
                Ok(done) => {
                    is_comparable(scene, &reference).and_then(|()| Measured::of(scene, &done.records, done.wall_s))
                }
            };
            match (index.checked_sub(1).and_then(|case| cases.get(case)), &expected) {
                (Some(case), Some(expected)) => match measured.and_then(|found| found.against(expected)) {
                    Ok(found) => self.show(&case.scene_name, &case.settings, &found, &table),
                    Err(cause) => {
                        failures += 1;
                        self.show_failure(case, cause)
                    }
                },
                _ => {
                    let found = measured.map_err(failed(name.clone()))?;
                    if !self.json {
                        print(&head(&table, found.quantity()))?;
                    }
                    let own = found.against(&found).map_err(failed(name.clone()))?;
                    expected = Some(found);
                    self.show(&name, &[], &own, &table)
                }
            }
        })?;
        match failures {
            _ if raised.load(Ordering::Relaxed) => Err(Failure::StudyInterrupted),
            0 => Ok(()),
            failed => Err(Failure::StudyIncomplete { failed, of: cases.len() }),
        }
    }

    fn cases(&self) -> Result<Vec<Case>, Failure> {
        for (index, Varied { key, .. }) in self.vary.iter().enumerate() {
            let set = self.set.iter().any(|setting| setting.split('=').next().map(str::trim) == Some(key));
            if set || self.vary[..index].iter().any(|other| other.key == *key) {
                return Err(Failure::VariedTwice { key: key.clone() });
            }
        }
        let mut combinations: Vec<Vec<String>> = vec![vec![]];
        for Varied { key, values } in &self.vary {
            let longer = |settings: &Vec<String>| {
                let with = |value: &String| [settings.clone(), vec![format!("{key}={value}")]].concat();
                values.iter().map(with).collect::<Vec<_>>()
            };
            combinations = combinations.iter().flat_map(longer).collect();
        }
        let mut cases = Vec::new();
        for path in &self.scenes {
            let (scene_name, text) = (path_in_line(path), read_scene(path, &[])?.text);
            for settings in &combinations {
                let all = [self.set.clone(), settings.clone()].concat();
                let scene = checked(&text, &scene_name, &all)?;
                cases.push(Case { scene_name: scene_name.clone(), settings: settings.clone(), scene });
            }
        }
        Ok(cases)
    }

    /// A row for a run that gave none.
    fn show_failure(&self, case: &Case, cause: AccuracyError) -> Result<(), Failure> {
        let failure = Failure::Study { case: case.label(), source: Box::new(cause) };
        if self.json {
            return print_json(&serde_json::json!({
                "scene": case.scene_name, "settings": case.settings, "error": failure.in_full(),
            }));
        }
        print(&format!("{}  failed\n", case.label()))?;
        say(&failure);
        Ok(())
    }

    fn show(&self, scene: &str, settings: &[String], row: &AccuracyRow, table: &Columns) -> Result<(), Failure> {
        if self.json {
            #[derive(serde::Serialize)]
            struct Line<'l> {
                scene: &'l str,
                settings: &'l [String],
                #[serde(flatten)]
                row: &'l AccuracyRow,
            }
            return print_json(&Line { scene, settings, row });
        }
        print(&table.row(&cells(&label(scene, settings), row)))
    }
}

impl Case {
    fn label(&self) -> String {
        label(&self.scene_name, &self.settings)
    }
}

fn label(scene: &str, settings: &[String]) -> String {
    [&[scene.to_string()], settings].concat().join(" ")
}

fn columns(width: usize) -> Columns {
    let all = vec![
        Column::of_words("run", width),
        Column::of_numbers("elements", 9).behind(2).rank(1),
        Column::of_numbers("unknowns", 8).rank(3),
        Column::of_numbers("before", 8).behind(2),
        Column::of_numbers("snap", 9).rank(2),
        Column::of_numbers("after", 8),
        Column::of_numbers("compared", 8).behind(2).rank(4),
        Column::of_numbers("iterations", 10).rank(5),
        Column::of_numbers("factors", 7).rank(6),
        Column::of_numbers("wall s", 7),
    ];
    Columns::fitting(all, output_columns())
}

fn head(table: &Columns, quantity: &str) -> String {
    let what =
        format!("before, after: errors of {quantity} before and after the first snap, of its largest value there");
    format!("{what}\n{}", table.head())
}

fn cells(label: &str, row: &AccuracyRow) -> [String; 10] {
    let percent = |share: Option<f64>| share.map_or_else(String::new, |share| format!("{:.2} %", 100.0 * share));
    [
        label.to_owned(),
        row.elements.with_sign("×"),
        row.unknowns.to_string(),
        percent(row.error_before),
        row.jump_at.map_or_else(String::new, |at| format!("{at:.3}")),
        percent(row.error_after),
        format!("{}/{}", row.compared, row.steps),
        row.iterations.to_string(),
        row.factorizations.to_string(),
        format!("{:.2}", row.wall_s),
    ]
}
