//! `foldline study STUDY`: the runs of a study file, their errors and times, and the speed-ups over uniform meshes.

use std::cell::Cell;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use serde_json::{Value, json};

use super::columns::{Column, Columns};
use super::failure::Failure;
use super::output::{eprint, path_in_line, print, print_json, refuse_what_is_there, write_files};
use super::scene_file::{NamedText, read_named, rendered};
use super::session::{open_archive, watch_signals};
use super::shipped::Shipped;
use super::terminal::output_columns;
use crate::printable::in_full;
use crate::scene::Scene;
use crate::study::{
    AccuracyRow, Archive, Done, Errors, Measured, MeshPoint, Planned, Purpose, Role, SpeedUp, Structure, StudyError,
    StudyFile, TaskError, error_of_finer, in_turn, is_comparable, speed_up,
};
use crate::units::significant;
use crate::view::study_page;

/// Width of names of runs in tables.
const NAME: usize = 22;

/// Studies that are being run.
struct Running<'r> {
    archive: Archive,
    interrupted: &'r dyn Fn() -> bool,
    json: bool,
    failed: usize,
    runs: usize,
    /// What was found so far, as JSON has it.
    rows: Vec<Value>,
}

/// A run with its errors against the reference.
struct Found {
    role: Role,
    label: String,
    point: MeshPoint,
}

/// Runs study files one after another, with settings laid over all their scenes. All of them are checked before the first run.
/// `page` is written at their end.
pub(super) fn run(
    files: &[PathBuf],
    set: &[String],
    logs: &Path,
    threads: usize,
    json: bool,
    page: Option<&PathBuf>,
) -> Result<(), Failure> {
    refuse_what_is_there(page)?;
    let raised = watch_signals()?;
    let studies = files.iter().map(|file| planned(file, set)).collect::<Result<Vec<_>, _>>()?;
    let archive = open_archive(logs, threads)?;
    let interrupted = || raised.load(Ordering::Relaxed);
    let mut running = Running { archive, interrupted: &interrupted, json, failed: 0, runs: 0, rows: Vec::new() };
    for (study, planned) in &studies {
        if !json {
            print(&format!("{}\n", study.title))?;
        }
        for (structure, planned) in study.structure.iter().zip(planned) {
            running.structure(study, structure, planned)?;
        }
    }
    if let Some(page) = page {
        let titles: Vec<&str> = studies.iter().map(|(study, _)| &study.title[..]).collect();
        write_files(&[(page.clone(), study_page(&titles.join("; "), &running.rows).into_bytes())])?;
        eprint(&format!("the page of the study: {}", path_in_line(page)));
    }
    match running.failed {
        0 => Ok(()),
        failed => Err(Failure::StudyIncomplete { failed, of: running.runs }),
    }
}

/// Reads what a run measures; `None` where it was interrupted.
fn measured(planned: &Planned, reference: &Scene, done: Result<Done, TaskError>) -> Result<Option<Measured>, String> {
    is_comparable(&planned.scene, reference).map_err(|error| in_full(&error))?;
    let done = match done {
        Err(TaskError::Interrupted) => return Ok(None),
        done => done.map_err(|error| in_full(&error))?,
    };
    let measured = Measured::of(&planned.scene, &done.records, done.wall_s);
    measured.map(Some).map_err(|error| in_full(&error))
}

/// Reads a study, with the runs of each of its structures.
fn planned(file: &Path, set: &[String]) -> Result<(StudyFile, Vec<Vec<Planned>>), Failure> {
    let NamedText { text, file: place, is_shipped } = read_named(file)?;
    let mut study = StudyFile::parse(&text, &path_in_line(file)).map_err(|error| wrong(&error))?;
    study.settings.extend_from_slice(set);
    let folder = place.parent().unwrap_or(Path::new(""));
    let read = |path: &Path| match is_shipped {
        true => Shipped::at(path).map(|scene| scene.text.to_owned()).ok_or(ErrorKind::NotFound.into()),
        false => std::fs::read_to_string(path),
    };
    let planned = study.structure.iter().map(|structure| study.runs(structure, folder, &read));
    let planned = planned.collect::<Result<Vec<_>, _>>().map_err(|error| wrong(&error))?;
    Ok((study, planned))
}

impl Running<'_> {
    /// Does the runs of a structure and shows what they found.
    fn structure(&mut self, study: &StudyFile, structure: &Structure, planned: &[Planned]) -> Result<(), Failure> {
        let mut reference: Option<Measured> = None;
        let mut found: Vec<Found> = Vec::new();
        let mut own: Option<Errors> = None;
        let [reference_scene, ..] = planned else { return Ok(()) };
        let runs: Vec<(&Scene, Purpose)> = planned.iter().map(|run| (&run.scene, run.role.purpose())).collect();
        let (archive, interrupted) = (self.archive.clone(), self.interrupted);
        // Without the reference nothing is known of the others.
        let is_over = Cell::new(false);
        in_turn(&archive, &runs, &|| is_over.get() || interrupted(), |index, done| {
            if is_over.get() {
                return Ok(());
            }
            let planned = &planned[index];
            self.runs += 1;
            let compared = measured(planned, &reference_scene.scene, done).and_then(|measured| {
                let Some(measured) = measured else { return Ok(None) };
                let row = measured.against(reference.as_ref().unwrap_or(&measured));
                row.map(|row| Some((row, measured))).map_err(|error| in_full(&error))
            });
            let (row, measured) = match compared {
                Ok(Some(found)) => found,
                Ok(None) => return Err(Failure::StudyInterrupted),
                Err(why) => {
                    self.failed += 1;
                    self.show_failure(structure, planned, &why)?;
                    is_over.set(planned.role == Role::Reference);
                    return Ok(());
                }
            };
            let errors = [row.error_before, row.error_after];
            match planned.role {
                Role::Reference => {
                    self.show_head(structure, measured.quantity())?;
                    reference = Some(measured);
                }
                Role::Coarser => {
                    let [finer, coarser] = structure.reference;
                    own = Some(error_of_finer(errors, finer, coarser, study.reference.degree));
                }
                Role::Uniform(_) | Role::Adaptive(_) => {
                    let point = MeshPoint { wall_s: row.wall_s, errors };
                    found.push(Found { role: planned.role, label: planned.label.clone(), point });
                }
            }
            self.show(structure, planned, &row, own.unwrap_or_default())?;
            if let (Role::Coarser, Some(own)) = (planned.role, own) {
                self.show_own(structure, own)?;
            }
            Ok(())
        })?;
        // Without it no error of the others is known.
        own.map_or(Ok(()), |own| self.show_speed_ups(study, structure, &found, own))
    }

    /// Takes a row, and prints it where JSON is wanted; returns whether it was.
    fn told(&mut self, row: Value) -> Result<bool, Failure> {
        if self.json {
            print_json(&row)?;
        }
        self.rows.push(row);
        Ok(self.json)
    }

    fn show_head(&self, structure: &Structure, quantity: &str) -> Result<(), Failure> {
        if self.json {
            return Ok(());
        }
        print(&format!(
            "\n{}: errors of {quantity} before the first snap and behind it, of its largest value there\n{}",
            structure.name,
            columns().head()
        ))
    }

    /// A row. Errors below those of the reference itself are not told apart.
    fn show(
        &mut self,
        structure: &Structure,
        planned: &Planned,
        row: &AccuracyRow,
        own: Errors,
    ) -> Result<(), Failure> {
        let timed = planned.role.purpose() == Purpose::Time;
        let role = match planned.role {
            Role::Reference => "reference",
            Role::Coarser => "coarser-reference",
            Role::Uniform(_) => "uniform",
            Role::Adaptive(_) => "adaptive",
        };
        let hash = planned.scene.hash().to_string();
        if self.told(json!({
            "structure": structure.name, "run": planned.label, "role": role, "scene": hash,
            "degree": planned.scene.mesh.degree, "row": row,
        }))? {
            return Ok(());
        }
        let percent = |error: Option<f64>, own: Option<f64>| match (error, own) {
            _ if planned.role == Role::Reference => String::new(),
            (Some(error), Some(own)) if timed && error < own => format!("<{:.2} %", 100.0 * own),
            (Some(error), _) => format!("{:.2} %", 100.0 * error),
            (None, _) => String::new(),
        };
        let seconds = |time: f64| if timed { format!("{time:.2}") } else { String::new() };
        print(&columns().row(&[
            planned.label.clone(),
            row.elements.with_sign("×"),
            row.unknowns.to_string(),
            percent(row.error_before, own[0]),
            row.jump_at.map_or_else(String::new, |at| format!("{at:.3}")),
            percent(row.error_after, own[1]),
            row.steps.to_string(),
            row.iterations.to_string(),
            row.factorizations.to_string(),
            seconds(row.mesh_s),
            seconds(row.wall_s),
        ]))
    }

    /// What the reference itself is off by.
    fn show_own(&mut self, structure: &Structure, own: Errors) -> Result<(), Failure> {
        if self.told(json!({ "structure": structure.name, "error_of_reference": own }))? {
            return Ok(());
        }
        let percent = |own: Option<f64>, place: &str| {
            own.map(|own| format!("{} % {place} the snap", significant(100.0 * own, 2)))
        };
        let off: Vec<String> = [percent(own[0], "before"), percent(own[1], "behind")].into_iter().flatten().collect();
        print(&format!("  so that the reference is off by {}\n", off.join(", ")))
    }

    fn show_failure(&mut self, structure: &Structure, planned: &Planned, why: &str) -> Result<(), Failure> {
        if self.told(json!({ "structure": structure.name, "run": planned.label, "error": why }))? {
            return Ok(());
        }
        print(&format!("{:<NAME$} failed\n", planned.label))?;
        eprint(&format!("{}, {}: {why}", structure.name, planned.label));
        Ok(())
    }

    fn show_speed_ups(
        &mut self,
        study: &StudyFile,
        structure: &Structure,
        found: &[Found],
        own: Errors,
    ) -> Result<(), Failure> {
        let columns = study.columns();
        let numbers = columns.iter().map(|column| Column::of_numbers(*column, 13).rank(2));
        let all = std::iter::once(Column::of_words("speed-up over uniform", NAME)).chain(numbers);
        let table =
            Columns::fitting(all.chain([Column::of_numbers("published", 10).rank(1)]).collect(), output_columns());
        let families_of = |column: &str| -> Vec<Vec<MeshPoint>> {
            let of_column = study.uniform.iter().enumerate();
            let of_column = of_column.filter(|(_, family)| family.columns.iter().any(|name| name == column));
            let meshes = |number| found.iter().filter(move |found| found.role == Role::Uniform(number));
            of_column.map(|(number, _)| meshes(number).map(|found| found.point).collect()).collect()
        };
        if !self.json {
            print(&table.head())?;
        }
        for adaptive in found.iter().filter(|found| matches!(found.role, Role::Adaptive(_))) {
            let of_columns: Vec<Option<SpeedUp>> =
                columns.iter().map(|column| speed_up(&adaptive.point, &families_of(column), own)).collect();
            let named: serde_json::Map<_, _> =
                columns.iter().zip(&of_columns).map(|(name, found)| (name.to_string(), json!(found))).collect();
            if self.told(json!({
                "structure": structure.name, "run": adaptive.label, "speed_up": named, "published": structure.published,
            }))? {
                continue;
            }
            let published = structure.published.map_or_else(String::new, |ratio| format!("{ratio:.1}"));
            let name = std::iter::once(adaptive.label.clone());
            let cells: Vec<String> = name.chain(of_columns.iter().map(in_words)).chain([published]).collect();
            print(&table.row(&cells))?;
        }
        Ok(())
    }
}

/// The columns of the runs of a structure.
fn columns() -> Columns {
    let all = vec![
        Column::of_words("run", NAME),
        Column::of_numbers("mesh", 7).rank(1),
        Column::of_numbers("unknowns", 8).rank(4),
        Column::of_numbers("before", 8),
        Column::of_numbers("snap", 7).rank(3),
        Column::of_numbers("behind", 8),
        Column::of_numbers("steps", 5).rank(5),
        Column::of_numbers("iters", 5).rank(6),
        Column::of_numbers("factors", 7).rank(8),
        Column::of_numbers("mesh s", 6).rank(7),
        Column::of_numbers("wall s", 6),
    ];
    Columns::fitting(all, output_columns())
}

/// A wrong study as a wrong scene is shown: with the place in its text, which may hold anything.
fn wrong(error: &StudyError) -> Failure {
    let printable = |text: String| text.replace(|c: char| c.is_control() && c != '\n', "\u{fffd}");
    let said = printable(format!("error: {error}"));
    let rendered = match error {
        StudyError::Scene { source, .. } => {
            format!("{}in the runs of {}", rendered(source), printable(error.to_string()))
        }
        StudyError::Syntax { .. } => {
            format!("{said}\n   = help: a scene is run with `--against REFERENCE`; `pipelines/studies/` has studies")
        }
        StudyError::Wrong { .. } => said,
        StudyError::NoScene { source, .. } => format!("{said}: {source}"),
    };
    Failure::WrongStudy { rendered }
}

fn in_words(found: &Option<SpeedUp>) -> String {
    match found {
        Some(SpeedUp { at_least, at_most: None }) => format!("> {at_least:.1}"),
        Some(SpeedUp { at_least, at_most: Some(at_most) }) if *at_least <= 0.0 => format!("< {at_most:.1}"),
        Some(SpeedUp { at_least, at_most: Some(at_most) }) if at_least < at_most => {
            format!("{at_least:.1} to {at_most:.1}")
        }
        Some(SpeedUp { at_least, .. }) => format!("{at_least:.1}"),
        None => "-".to_owned(),
    }
}
