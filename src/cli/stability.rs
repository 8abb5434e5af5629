//! `foldline stability`: the lowest eigenvalue of the stiffness along a run, and its mode.

use std::path::{Path, PathBuf};

use clap::Args;

use super::asked::{Asked, Ends};
use super::failure::{EXIT_CODES, Failure};
use super::log_file::scene_at;
use super::output::{file_name, path_in_line, print, print_as_it_is, refuse_what_is_there, write_files};
use super::pictured::cells_per_element;
use crate::history::{StabilityReport, States, stability_at};
use crate::record::Record;
use crate::scene::Scene;
use crate::shell::{add, norm, scaled, sub};
use crate::state::State;
use crate::units::{count, place, significant, unsigned_zero};
use crate::view::{Marks, Picture, mesh_picture, mode_surface, vtu};

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
    /// Folder for mode.svg and mode.vtu: the shell of --step moved by the mode, whose size is arbitrary: it is drawn as 5 % of the
    /// shell
    #[arg(short, long, value_name = "DIR", requires = "step", value_parser = file_name())]
    output: Option<PathBuf>,
}

impl Arguments {
    /// Finds the modes and prints them.
    pub(super) fn run(self) -> Result<(), Failure> {
        if let Some(folder) = &self.output {
            refuse_what_is_there(&pictures(folder))?;
        }
        let asked = Asked::open(&self.log)?;
        let Some(step) = self.step else { return self.all(&asked) };
        let mut ends = Ends::default();
        asked.stages_of_step(step)?.iter().for_each(|record| ends.take(record));
        let no_end = || Failure::NoSuchStep { log: self.log.clone(), step, known: asked.steps() };
        let index = ends.stages().pop().ok_or_else(no_end)?;
        let record = asked.log.record(index).map_err(asked.changed())?;
        let log = asked.log.part(index..index + 1).map_err(asked.changed())?;
        let (report, scene) = self.report(&mut States::of(&log), index)?;
        print(&in_full(&record, &report))?;
        match &self.output {
            Some(folder) => draw(folder, &scene, &record, &report),
            None => Ok(()),
        }
    }

    fn all(&self, asked: &Asked) -> Result<(), Failure> {
        let ends = asked.ends()?;
        print(HEAD)?;
        for part in asked.log.parts(&ends.stages()) {
            let (log, indices) = part.map_err(asked.changed())?;
            let mut states = States::of(&log);
            for (index, entry) in indices.iter().filter_map(|index| Some((*index, log.entry(*index)?))) {
                // Each as soon as it is known: a long log takes its time.
                print(&row(&entry.record, &self.report(&mut states, index)?.0))?;
            }
        }
        Ok(())
    }

    fn report(&self, states: &mut States, index: usize) -> Result<(StabilityReport, Scene), Failure> {
        let scene = scene_at(states.log(), &self.log, index, &[])?;
        let failed = |source| Failure::Stability { log: self.log.clone(), index, source: Box::new(source) };
        Ok((stability_at(states, index, &scene).map_err(failed)?, scene))
    }
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
    let corner = mesh.point(0);
    let size = mesh.points().map(|point| norm(sub(point, corner))).fold(0.0, f64::max);
    let mode: Vec<[f64; 3]> = report.mode.shape.iter().map(|mode| scaled(SHOWN_AMPLITUDE * size, *mode)).collect();
    let displacement = report.state.displacement.iter().zip(&mode).map(|(u, mode)| add(*u, *mode)).collect();
    let moved = State { displacement, ..report.state.clone() };
    let samples = mode_surface(scene, &report.state, &mode, cells_per_element(mesh))?;
    let at = record.report.driven_by.shown_short(record.report.parameter);
    let eigenvalue = significant(report.mode.eigenvalue, 4);
    let picture = Picture {
        title: format!("Mode of the lowest eigenvalue, {eigenvalue} N/mm"),
        subtitle: format!(
            "load step {}, {at}; a mode has no size: its motion is drawn as {:.0} % of the shell",
            record.report.step,
            100.0 * SHOWN_AMPLITUDE
        ),
        marks: Marks::of_mode(scene, &report.state, &moved),
        ..Picture::default()
    };
    let texts = [mesh_picture(&samples, &picture), vtu(&samples)];
    let files: Vec<_> = pictures(folder).into_iter().zip(texts.map(String::into_bytes)).collect();
    write_files(&files)?;
    print_as_it_is(&files.iter().map(|(path, _)| format!("{}\n", path_in_line(path))).collect::<String>())
}

/// The files of a mode.
fn pictures(folder: &Path) -> [PathBuf; 2] {
    ["mode.svg", "mode.vtu"].map(|file| folder.join(file))
}
