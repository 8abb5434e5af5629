//! `foldline converge`: a tape spring's path of equilibria on one mesh after another, error against run time.

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use clap::Args;

use super::columns::{Column, Columns};
use super::failure::Failure;
use super::output::{path_in_line, print, print_json};
use super::scene_file::{checked, read_scene};
use super::session::{open_archive, use_threads, watch_signals};
use super::terminal::output_columns;
use crate::scene::Scene;
use crate::study::{ConvergenceRow, Purpose, TaskError, converged, in_turn, path_scene};

/// Follow a tape spring past its limit point, down the unstable path and up the fold, on uniform meshes of every degree and
/// size asked for: peak, limit rotation and moments of each, with its run time
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// Scene of a tape spring whose ends turn (TOML), or the name of one of `foldline scenes`; its rotation gives how far up the fold the path is followed
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
        let archive = open_archive(&self.logs, threads)?;
        let table = columns(self.unstable_at, scenes.first().map_or(0.0, |scene| scene.load.target()));
        if !self.json {
            print(&table.head())?;
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
                false => print(&table.row(&row(&found))),
            }
        })
    }
}

fn columns(unstable_at: f64, target: f64) -> Columns {
    let all = vec![
        Column::of_numbers("degree", 6),
        Column::of_numbers("elements", 9),
        Column::of_numbers("unknowns", 8).rank(7),
        Column::of_numbers("peak N·mm", 9).behind(2),
        Column::of_numbers("at °", 8).rank(4),
        Column::of_numbers("limit °", 8).behind(2),
        Column::of_numbers("M N·mm", 8).rank(3),
        Column::of_numbers(format!("back at {unstable_at}°"), 12).behind(2).rank(2),
        Column::of_numbers("fold °", 8).behind(2).rank(5),
        Column::of_numbers("M N·mm", 8).rank(5),
        Column::of_numbers(format!("fold at {target}°"), 12).behind(2),
        Column::of_numbers("steps", 5).behind(2).rank(9),
        Column::of_numbers("iterations", 10).rank(8),
        Column::of_numbers("wall s", 7),
    ];
    Columns::fitting(all, output_columns())
}

fn row(row: &ConvergenceRow) -> [String; 14] {
    let number = |value: Option<f64>, digits: usize| {
        value.map_or_else(|| "none".to_owned(), |value| format!("{value:.digits$}"))
    };
    let [peak, peak_at] = [0, 1].map(|k| number(row.peak.map(|pair| pair[k]), 3));
    let [limit, limit_moment] = [(0, 4), (1, 3)].map(|(k, digits)| number(row.limit.map(|pair| pair[k]), digits));
    let [fold, fold_moment] = [(0, 4), (1, 3)].map(|(k, digits)| number(row.fold_begins.map(|pair| pair[k]), digits));
    let [n1, n2] = row.elements;
    [
        row.degree[0].to_string(),
        format!("{n1}×{n2}"),
        row.unknowns.to_string(),
        peak,
        peak_at,
        limit,
        limit_moment,
        number(row.unstable_n_mm, 3),
        fold,
        fold_moment,
        number(row.fold_n_mm, 3),
        row.steps.to_string(),
        row.iterations.to_string(),
        format!("{:.1}", row.wall_s),
    ]
}
