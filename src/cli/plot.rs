//! `foldline plot`: pictures from logs.

use std::path::{Path, PathBuf};

use clap::Args;

use super::animated::animation;
use super::failure::{EXIT_CODES, Failure};
use super::log_file::first_and_last;
use super::output::{file_name, path_in_line, print_as_it_is, write_files};
use super::pictured::{Look, pictured};
use super::plotted::{Chosen, PlottedLog, curve};
use crate::history::States;
use crate::record::Report;
use crate::view::{ViewDirection, mesh_picture, vtu};

/// Draw the moment–rotation curve, or the load factor over the first probe, and the deformed mesh of a log; of several logs their
/// curves in one picture
#[derive(Args, Debug)]
#[command(after_help = EXIT_CODES)]
pub(super) struct Arguments {
    /// Logs to read (MCAP); the mesh is drawn of one
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,
    /// Folder for moment-rotation.svg (other shells: load-probe.svg, the load factor over the first probe), mesh.svg and
    /// mesh.vtu [default: the first log's name without .mcap]
    #[arg(short, long, value_name = "DIR", value_parser = file_name())]
    output: Option<PathBuf>,
    /// Draw a curve over this instead (Y-over-X.svg, without the mesh): a probe, or a number of the reports such as rotation,
    /// load_factor, strain_energy, elements or time; with a minus in front, its other sign; a wrong name lists all of them
    /// [default: the rotation or the load factor]
    #[arg(long, value_name = "QUANTITY", allow_hyphen_values = true, conflicts_with_all = ["step", "view", "field"])]
    x: Option<String>,
    /// Draw this upwards [default: the moment or the load factor]
    #[arg(long, value_name = "QUANTITY", allow_hyphen_values = true, conflicts_with_all = ["step", "view", "field"])]
    y: Option<String>,
    /// Show the mesh at the end of this load step [default: the last one]
    #[arg(long, value_name = "K")]
    step: Option<u64>,
    /// Look at the mesh from this side: degrees about z from x towards y, degrees above the xy-plane [default: -62,24; a structure of
    /// several shells from where all of them are seen]
    #[arg(long, value_name = "AZIMUTH,ELEVATION", value_parser = direction, allow_hyphen_values = true)]
    view: Option<ViewDirection>,
    /// Colour the mesh by this field, such as bending_moment.11, energy_density or displacement (its length); a wrong name lists
    /// all of them [default: the larger bending strain]
    #[arg(long, value_name = "FIELD[.COMPONENT]")]
    field: Option<String>,
    /// Draw the mesh over the load steps instead, as an animation (mesh.gif): one view, and colours over the values of all steps
    #[arg(long, conflicts_with_all = ["x", "y", "step"])]
    animate: bool,
    /// Animate every N-th load step, and the last [default: up to 40 that are evenly spread, and those around jumps]
    #[arg(long, value_name = "N", requires = "animate", value_parser = clap::value_parser!(u64).range(1..))]
    every: Option<u64>,
}

/// A file with its content.
type File = (String, Vec<u8>);

impl Arguments {
    /// Reads the logs, draws, and names the files.
    pub(super) fn run(mut self) -> Result<(), Failure> {
        let folder = self.output.take().unwrap_or_else(|| self.logs[0].with_extension(""));
        let chosen = Chosen { x: self.x.take(), y: self.y.take() };
        let files = match &self.logs[..] {
            [log] if self.animate => vec![("mesh.gif".to_owned(), animation(log, self.every, &self.look())?)],
            [log] if chosen.is_none() => self.curve_and_mesh(log, &chosen)?,
            logs => {
                self.refuse_what_is_of_one_log()?;
                curve(&PlottedLog::read_all(logs, &chosen)?, &chosen)?.into_iter().collect()
            }
        };
        let files: Vec<_> = files.into_iter().map(|(file, content)| (folder.join(file), content)).collect();
        write_files(&files)?;
        print_as_it_is(&files.iter().map(|(path, _)| format!("{}\n", path_in_line(path))).collect::<String>())
    }

    /// How the mesh is shown.
    fn look(&self) -> Look<'_> {
        Look { direction: self.view, field: self.field.as_deref() }
    }

    /// What only the mesh of one log has a use for.
    fn refuse_what_is_of_one_log(&self) -> Result<(), Failure> {
        let given = [
            ("--animate", self.animate),
            ("--step", self.step.is_some()),
            ("--view", self.view.is_some()),
            ("--field", self.field.is_some()),
        ];
        match given.into_iter().find(|(_, is_given)| *is_given) {
            Some((option, _)) => Err(Failure::MeshOfOneLog { option, logs: self.logs.len() }),
            None => Ok(()),
        }
    }

    /// The pictures of one log. Everything is drawn before anything is written.
    fn curve_and_mesh(&self, log: &Path, chosen: &Chosen) -> Result<Vec<File>, Failure> {
        let mut shown = None;
        let plotted = PlottedLog::read(log, chosen, |portion| {
            let is_wanted = |report: &Report| self.step.is_none_or(|step| report.step == step);
            if let Some(last) = portion.entries().iter().rfind(|entry| is_wanted(&entry.record.report)) {
                let ordinal = last.record.commit.ordinal as usize;
                shown = Some((ordinal, last.record.report.clone(), portion.log().state(ordinal)));
            }
        })?;
        let Some((ordinal, report, state)) = shown else {
            return Err(match self.step {
                Some(step) => {
                    let known = first_and_last(plotted.records.iter());
                    Failure::NoSuchStep { log: log.to_path_buf(), step, known }
                }
                None => crate::view::PlotError::NoEquilibrium.into(),
            });
        };
        let logs = [plotted];
        let mut files: Vec<File> = curve(&logs, chosen)?.into_iter().collect();
        let [PlottedLog { read, .. }] = logs;
        // States that the log has not are made from those that it has.
        let read = if state.is_err() { read.whole(log)? } else { read };
        let unusable = |source| Failure::WrongLog { log: log.to_path_buf(), source: Box::new(source) };
        let state = state.or_else(|_| States::of(&read.log).at(ordinal)).map_err(unusable)?;
        let (samples, picture) = pictured(log, &read.scene, &state, &report, &self.look())?;
        files.push(("mesh.svg".to_owned(), mesh_picture(&samples, &picture).into_bytes()));
        files.push(("mesh.vtu".to_owned(), vtu(&samples).into_bytes()));
        Ok(files)
    }
}

/// "AZIMUTH,ELEVATION".
fn direction(text: &str) -> Result<ViewDirection, String> {
    let numbers = text.split_once(',').map(|(azimuth, elevation)| (azimuth.trim().parse(), elevation.trim().parse()));
    match numbers {
        Some((Ok(azimuth_deg), Ok(elevation_deg))) if f64::is_finite(azimuth_deg + elevation_deg) => {
            Ok(ViewDirection { azimuth_deg, elevation_deg })
        }
        _ => Err("two numbers of degrees are wanted, such as -62,24".to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions() {
        assert_eq!(direction("-62, 24"), Ok(ViewDirection { azimuth_deg: -62.0, elevation_deg: 24.0 }));
        for wrong in ["", "1", "1,", "a,b", "inf,0", "1,2,3"] {
            assert!(direction(wrong).is_err(), "{wrong}");
        }
    }
}
