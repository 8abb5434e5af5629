//! `foldline converge`: a tape spring's path of equilibria on one mesh after another, error against run time.

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use clap::Args;

use super::failure::Failure;
use super::output::{path_in_line, print, print_json};
use super::scene_file::{checked, read_scene};
use super::session::{use_threads, watch_signals};
use crate::scene::Scene;
use crate::study::{Archive, ConvergenceRow, Purpose, TaskError, converged, in_turn, path_scene};

/// Follow a tape spring past its limit point, down the unstable path and up the fold, on uniform meshes of every degree and
/// size asked for: peak, limit rotation and moments of each, with its run time
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// Scene of a tape spring whose ends turn (TOML); its rotation gives how far up the fold the path is followed
    scene: PathBuf,
    /// Degree both ways; may be repeated
    #[arg(long, value_name = "P", default_values_t = [3, 4], value_parser = clap::value_parser!(u16).range(2..=5))]
    degree: Vec<u16>,
    /// Elements each way over the whole shell; may be repeated
    #[arg(long, value_name = "N1,N2", default_values_t = ["32,8".to_string(), "64,16".to_string(), "128,32".to_string()])]
    elements: Vec<String>,
    /// Rotation, in degrees, at which the moment on the unstable path is read
    #[arg(long, value_name = "DEG", default_value_t = 7.0)]
    unstable_at: f64,
    /// Lay a setting over the scene, such as load.rotation_deg=10; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Folder for the logs of the runs, each named after the hash of its scene: those that are finished are read, not run again
    #[arg(long, value_name = "DIR", default_value = "checkpoints/studies")]
    logs: PathBuf,
    /// Print a JSON object for each mesh
    #[arg(long)]
    json: bool,
}

impl Arguments {
    /// Runs every mesh; a row as soon as it is known.
    pub(super) fn run(self) -> Result<(), Failure> {
        let text = read_scene(&self.scene, &[])?.text;
        let name = path_in_line(&self.scene);
        let mut scenes: Vec<Scene> = Vec::new();
        for degree in &self.degree {
            for elements in &self.elements {
                let mesh = [format!("mesh.degree=[{degree},{degree}]"), format!("mesh.elements=[{elements}]")];
                let settings: Vec<String> = self.set.iter().cloned().chain(mesh).collect();
                scenes.push(checked(&text, &name, &settings)?);
            }
        }
        let threads = use_threads(None)?;
        let raised = watch_signals()?;
        let scenes = scenes.iter().map(path_scene).collect::<Result<Vec<_>, _>>()?;
        let archive =
            Archive::open(&self.logs, threads).map_err(|source| Failure::Archive { source: Box::new(source) })?;
        if !self.json {
            print(&head(self.unstable_at, scenes.first().map_or(0.0, |scene| scene.load.target())))?;
        }
        let runs: Vec<(&Scene, Purpose)> = scenes.iter().map(|scene| (scene, Purpose::Time)).collect();
        let interrupted = || raised.load(Ordering::Relaxed);
        in_turn(&archive, &runs, &interrupted, |index, done| {
            let Scene { mesh, .. } = runs[index].0;
            let done = done.map_err(|error| match error {
                TaskError::Interrupted => Failure::StudyInterrupted,
                error => Failure::Convergence { degree: mesh.degree, elements: mesh.elements, source: Box::new(error) },
            })?;
            let found = converged(runs[index].0, &done, self.unstable_at);
            match self.json {
                true => print_json(&found),
                false => print(&row(&found)),
            }
        })
    }
}

fn head(unstable_at: f64, target: f64) -> String {
    let columns = [
        format!("{:>6} {:>9} {:>8}", "degree", "elements", "unknowns"),
        format!("{:>9} {:>8}", "peak N·mm", "at °"),
        format!("{:>8} {:>8}", "limit °", "M N·mm"),
        format!("{:>12}", format!("back at {unstable_at}°")),
        format!("{:>8} {:>8}", "fold °", "M N·mm"),
        format!("{:>12}", format!("fold at {target}°")),
        format!("{:>5} {:>10} {:>7}", "steps", "iterations", "wall s"),
    ];
    columns.join("  ") + "\n"
}

fn row(row: &ConvergenceRow) -> String {
    let number = |value: Option<f64>, width: usize, digits: usize| {
        value.map_or_else(|| format!("{:>width$}", "none"), |value| format!("{value:>width$.digits$}"))
    };
    let pair = |pair: Option<[f64; 2]>, widths: [usize; 2], digits: [usize; 2]| {
        [0, 1].map(|k| number(pair.map(|pair| pair[k]), widths[k], digits[k])).join(" ")
    };
    let [n1, n2] = row.elements;
    let columns = [
        format!("{:>6} {:>9} {:>8}", row.degree[0], format!("{n1}×{n2}"), row.unknowns),
        pair(row.peak, [9, 8], [3, 3]),
        pair(row.limit, [8, 8], [4, 3]),
        number(row.unstable_n_mm, 12, 3),
        pair(row.fold_begins, [8, 8], [4, 3]),
        number(row.fold_n_mm, 12, 3),
        format!("{:>5} {:>10} {:>7.1}", row.steps, row.iterations, row.wall_s),
    ];
    columns.join("  ") + "\n"
}
