//! `foldline stability`: the lowest eigenvalue of the stiffness along a run, and its mode.

use std::path::{Path, PathBuf};

use clap::Args;

use super::asked::{Asked, Ends};
use super::failure::{EXIT_CODES, Failure};
use super::log_file::scene_at;
use super::output::{file_name, path_in_line, print, print_as_it_is, refuse_what_is_there, write_files};
use super::pictured::cells_per_element;
use crate::history::{BucklingReport, StabilityReport, States, buckling_at, stability_at};
use crate::record::{Parameter, Record};
use crate::scene::Scene;
use crate::shell::{add, norm, scaled, sub};
use crate::state::State;
use crate::units::{count, place, significant, unsigned_zero};
use crate::view::{Marks, Picture, mesh_picture, mode_surface, viewpoint, vtu};

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
    /// This many modes of linear buckling about the equilibrium of --step (0: the undeformed shell), by the load factors at which they
    /// occur; in the folder of --output, buckling-1.svg and buckling-1.vtu and so on
    #[arg(long, value_name = "N", requires = "step", num_args = 0..=1, default_missing_value = "1")]
    buckling: Option<std::num::NonZero<usize>>,
}

impl Arguments {
    /// Finds the modes and prints them.
    pub(super) fn run(self) -> Result<(), Failure> {
        if let Some(folder) = &self.output {
            let modes = 1..=self.buckling.map_or(0, std::num::NonZero::get);
            let files: Vec<PathBuf> = modes.flat_map(|mode| mode_files(folder, &format!("buckling-{mode}"))).collect();
            let files = if files.is_empty() { mode_files(folder, "mode").to_vec() } else { files };
            refuse_what_is_there(&files)?;
        }
        let asked = Asked::open(&self.log)?;
        let Some(step) = self.step else { return self.all(&asked) };
        if let Some(count) = self.buckling {
            return self.buckle(&asked, step, count.get());
        }
        let index = self.end_of(&asked, step)?;
        let record = asked.log.record(index).map_err(asked.changed())?;
        let log = asked.log.part(index..index + 1).map_err(asked.changed())?;
        let (report, scene) = self.report(&mut States::of(&log), index)?;
        print(&in_full(&record, &report))?;
        match &self.output {
            Some(folder) => draw(folder, &scene, &record, &report),
            None => Ok(()),
        }
    }

    /// The stage whose equilibrium a load step ended with.
    fn end_of(&self, asked: &Asked, step: u64) -> Result<usize, Failure> {
        let mut ends = Ends::default();
        asked.stages_of_step(step)?.iter().for_each(|record| ends.take(record));
        let no_end = || Failure::NoSuchStep { log: self.log.clone(), step, known: asked.steps() };
        ends.stages().pop().ok_or_else(no_end)
    }

    /// Prints the modes of linear buckling about the end of a load step.
    fn buckle(&self, asked: &Asked, step: u64, count: usize) -> Result<(), Failure> {
        let index = match step {
            0 => None,
            _ => Some(self.end_of(asked, step)?),
        };
        let first = index.unwrap_or(0);
        let log = asked.log.part(first..first + 1).map_err(asked.changed())?;
        let scene = scene_at(&log, &self.log, first, &[])?;
        let failed = |source| Failure::Stability { log: self.log.clone(), index: first, source: Box::new(source) };
        let report = buckling_at(&mut States::of(&log), index, &scene, count).map_err(failed)?;
        print(&buckling_in_words(&scene, &report))?;
        let Some(folder) = &self.output else { return Ok(()) };
        let mut written = String::new();
        for (number, mode) in report.modes.modes.iter().enumerate() {
            let title = format!("Buckling mode {}, at {}", number + 1, at_factor(&scene, &report, mode.factor));
            let texts = drawn(&scene, &report.state, &mode.shape, &title, "linear buckling")?;
            written += &write_mode(folder, &format!("buckling-{}", number + 1), texts)?;
        }
        print_as_it_is(&written)
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

/// The parameter of the scene at a change of it from a state.
fn at_factor(scene: &Scene, report: &BucklingReport, factor: f64) -> String {
    let at = report.state.parameter + factor;
    Parameter::of(scene).shown(format!("{at:.5e}").parse().unwrap_or(at))
}

/// The modes of linear buckling, a line each.
fn buckling_in_words(scene: &Scene, report: &BucklingReport) -> String {
    let BucklingReport { state, modes, .. } = report;
    let about = match state.step {
        0 => "the undeformed shell".to_owned(),
        step => format!("load step {step}, {}", Parameter::of(scene).shown(state.parameter)),
    };
    let mut text = format!("linear buckling about {about}\n mode   {:>14}   moves most at\n", "at");
    for (number, mode) in modes.modes.iter().enumerate() {
        let at = significant(state.parameter + mode.factor, 7);
        text += &format!("{:>5}   {at:>14}   {}\n", number + 1, place(state.mesh.point(mode.largest_at)));
    }
    if modes.modes.is_empty() {
        text += "no mode was found as the load grows\n";
    }
    if modes.counted > modes.modes.len() {
        text += &format!(
            "{} lie at or below the last of these: they are a cluster; ask for more modes\n",
            count(modes.counted, "mode")
        );
    }
    if !modes.settled && !modes.modes.is_empty() {
        text += "these load factors had not settled to the digits shown when their iterations were over; ask for more modes\n";
    }
    if let Some(reversed) = modes.reversed {
        let at = significant(state.parameter + reversed, 7);
        text += &format!("under the reversed load the first mode lies near {at}\n");
    }
    if scene.symmetry.copies() > 1 {
        text += "a part of a symmetric shell is modelled: modes without its symmetry are not seen\n";
    }
    text
}

/// The shell with the mode added to its displacement.
fn draw(folder: &Path, scene: &Scene, record: &Record, report: &StabilityReport) -> Result<(), Failure> {
    let at = record.report.driven_by.shown_short(record.report.parameter);
    let title = format!("Mode of the lowest eigenvalue, {} N/mm", significant(report.mode.eigenvalue, 4));
    let texts =
        drawn(scene, &report.state, &report.mode.shape, &title, &format!("load step {}, {at}", record.report.step))?;
    print_as_it_is(&write_mode(folder, "mode", texts)?)
}

/// Writes the files of a mode; returns their paths, a line each.
fn write_mode(folder: &Path, name: &str, texts: [String; 2]) -> Result<String, Failure> {
    let files: Vec<_> = mode_files(folder, name).into_iter().zip(texts.map(String::into_bytes)).collect();
    write_files(&files)?;
    Ok(files.iter().map(|(path, _)| format!("{}\n", path_in_line(path))).collect())
}

/// A mode as a picture, and for ParaView.
fn drawn(scene: &Scene, state: &State, shape: &[[f64; 3]], title: &str, of: &str) -> Result<[String; 2], Failure> {
    let mesh = &state.mesh;
    let corner = mesh.point(0);
    let size = mesh.points().map(|point| norm(sub(point, corner))).fold(0.0, f64::max);
    let mode: Vec<[f64; 3]> = shape.iter().map(|mode| scaled(SHOWN_AMPLITUDE * size, *mode)).collect();
    let displacement = state.displacement.iter().zip(&mode).map(|(u, mode)| add(*u, *mode)).collect();
    let moved = State { displacement, ..state.clone() };
    let samples = mode_surface(scene, state, &mode, cells_per_element(mesh))?;
    let picture = Picture {
        direction: viewpoint(&samples),
        title: title.to_owned(),
        subtitle: format!(
            "{of}; a mode has no size: its motion is drawn as {:.0} % of the shell",
            100.0 * SHOWN_AMPLITUDE
        ),
        marks: Marks::of_mode(scene, state, &moved),
        ..Picture::default()
    };
    Ok([mesh_picture(&samples, &picture), vtu(&samples)])
}

/// The files of a mode.
fn mode_files(folder: &Path, name: &str) -> [PathBuf; 2] {
    ["svg", "vtu"].map(|ending| folder.join(format!("{name}.{ending}")))
}
