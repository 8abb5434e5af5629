//! `foldline stability`: the lowest eigenvalue of the stiffness along a run, and its mode.

use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::{EXIT_CODES, Failure};
use super::log_file::{read_log, scene_at};
use super::output::{file_name, path_in_line, print, refuse_what_is_there, write_files};
use super::plot::cells_per_element;
use crate::history::{StabilityReport, States, stability_at};
use crate::pipeline::{Outcome, Record};
use crate::scene::Scene;
use crate::shell::{add, norm, scaled, sub};
use crate::units::{count, place, unsigned_zero};
use crate::view::{Picture, deformed_surface, mesh_picture, vtu};

/// Largest motion of a mode in its picture, relative to the size of the shell.
const SHOWN_AMPLITUDE: f64 = 0.05;

/// Say how stable the equilibria of a log are: lowest eigenvalue of the tangent stiffness, and its mode
#[derive(Args, Debug)]
#[command(after_help = EXIT_CODES)]
pub(super) struct Arguments {
    /// Log to read (MCAP)
    log: PathBuf,
    /// Only the equilibrium that this load step ended with, with its mode
    #[arg(long, value_name = "K")]
    step: Option<u64>,
    /// Folder for mode.svg and mode.vtu: the shell of --step with the mode added, as large as 5 % of the shell
    #[arg(short, long, value_name = "DIR", requires = "step", value_parser = file_name())]
    output: Option<PathBuf>,
}

impl Arguments {
    /// Finds the modes and prints them.
    pub(super) fn run(self) -> Result<(), Failure> {
        if let Some(folder) = &self.output {
            refuse_what_is_there(&pictures(folder))?;
        }
        let read = read_log(&self.log)?;
        let records = read.records();
        let ends = ends_of_steps(&records);
        let mut states = States::of(&read.log);
        let Some(step) = self.step else {
            print(HEAD)?;
            // Each as soon as it is known: a long log takes its time.
            return ends.into_iter().try_for_each(|index| {
                let (report, _) = self.report(&mut states, index)?;
                print(&row(&records[index], &report))
            });
        };
        let found = ends.into_iter().find(|index| records[*index].report.step == step);
        let no_step = || Failure::NoSuchStep { log: self.log.clone(), step, known: read.steps() };
        let index = found.ok_or_else(no_step)?;
        let (report, scene) = self.report(&mut states, index)?;
        print(&in_full(&records[index], &report))?;
        match &self.output {
            Some(folder) => draw(folder, &scene, &records[index], &report),
            None => Ok(()),
        }
    }

    fn report(&self, states: &mut States, index: usize) -> Result<(StabilityReport, Scene), Failure> {
        let scene = scene_at(states.log(), &self.log, index, &[])?;
        let failed = |source| Failure::Stability { log: self.log.clone(), index, source: Box::new(source) };
        Ok((stability_at(states, index, &scene).map_err(failed)?, scene))
    }
}

/// The last equilibrium of each load step.
fn ends_of_steps(records: &[Record]) -> Vec<usize> {
    let mut ends: Vec<usize> = Vec::new();
    for (index, Record { report, .. }) in records.iter().enumerate() {
        if report.outcome != Outcome::Done || !report.stage.finds_equilibrium() {
            continue;
        }
        if ends.last().is_some_and(|last| records[*last].report.step == report.step) {
            ends.pop();
        }
        ends.push(index);
    }
    ends
}

const HEAD: &str = " step   parameter   negative pivots   lowest eigenvalue N/mm\n";

fn row(record: &Record, report: &StabilityReport) -> String {
    let pivots = record.report.negative_pivots;
    let note = if pivots > 0 { "  not stable" } else { "" };
    format!(
        "{:>5}   {:>9.4}   {pivots:>15}   {:>22.6e}{note}\n",
        record.report.step, record.report.parameter, report.mode.eigenvalue
    )
}

fn in_full(record: &Record, report: &StabilityReport) -> String {
    let stable = if record.report.negative_pivots == 0 { "stable" } else { "not stable" };
    let at = place(report.mode_at);
    let [u, v, w] = report.mode.shape[report.mode.largest_at].map(unsigned_zero);
    format!(
        "load step {}, {} at {}: {stable}, {}\n\
         lowest eigenvalue    {:.6e} N/mm (for a motion of 1 mm root mean square)\n\
         its mode             moves most at {at}, towards ({u:.2}, {v:.2}, {w:.2})\n",
        record.report.step,
        record.report.stage,
        record.report.driven_by.shown(record.report.parameter),
        count(record.report.negative_pivots as usize, "negative pivot"),
        report.mode.eigenvalue
    )
}

/// The shell with the mode added to its displacement.
fn draw(folder: &Path, scene: &Scene, record: &Record, report: &StabilityReport) -> Result<(), Failure> {
    let mesh = &report.state.mesh;
    let points = mesh.points();
    let first = mesh.control_points[0];
    let corner = [0, 1, 2].map(|c| first[c] / first[3]);
    let size = points.map(|point| norm(sub(point, corner))).fold(0.0, f64::max);
    let moved: Vec<[f64; 3]> = report
        .state
        .displacement
        .iter()
        .zip(&report.mode.shape)
        .map(|(u, mode)| add(*u, scaled(SHOWN_AMPLITUDE * size, *mode)))
        .collect();
    let samples = deformed_surface(scene, mesh, &moved, cells_per_element(mesh))?;
    let at = record.report.driven_by.shown(record.report.parameter);
    let picture = Picture {
        title: format!("Softest mode, load step {}", record.report.step),
        subtitle: format!("at {at}, eigenvalue {:.3e} N/mm; not to scale", report.mode.eigenvalue),
        ..Picture::default()
    };
    let texts = [mesh_picture(&samples, &picture), vtu(&samples)];
    let files: Vec<_> = pictures(folder).into_iter().zip(texts.map(String::into_bytes)).collect();
    write_files(&files)?;
    print(&files.iter().map(|(path, _)| format!("{}\n", path_in_line(path))).collect::<String>())
}

/// The files of a mode.
fn pictures(folder: &Path) -> [PathBuf; 2] {
    ["mode.svg", "mode.vtu"].map(|file| folder.join(file))
}
