//! `foldline bench`: how fast the kernels and whole runs are, compared with what the machine can do.

use std::path::PathBuf;

use clap::Args;

use super::columns::{Column, Columns};
use super::failure::Failure;
use super::output::{path_in_line, print, print_json};
use super::scene_file::{checked, read_scene};
use super::session::use_threads;
use super::terminal::output_columns;
use crate::scene::Scene;
use crate::study::{BenchError, Figure, kernel_figures, run_figure};

/// The scene that is timed where none is named.
const BASELINE: &str = include_str!("../../pipelines/baseline.toml");

/// The text below the options in the help.
const LIMITS: &str = "\
The column `limit` is the share of what the machine does at best, measured in the same run: for assemble and factor the \
rate of operations of a dense product on one thread, times the threads that can work on them (a factorization is shared \
by two); for residual and solve the rate of a memory copy on those threads, which data that fit in the caches beat; for \
an iteration the time that its pieces would take at their limits. Elements are those of the part that is modelled.";

/// Time the kernels on a uniform mesh, and whole runs of scenes, each as a fraction of what the machine can do
#[derive(Args, Debug)]
#[command(after_help = LIMITS)]
pub(super) struct Arguments {
    /// Scenes to run whole (TOML), or names of `foldline scenes`; the kernels are timed on the first [default: the baseline's kernels alone]
    scenes: Vec<PathBuf>,
    /// Elements each way over the whole shell, for the kernels
    #[arg(long, value_name = "N1,N2", default_value = "128,16")]
    elements: String,
    /// Lay a setting over the scenes, such as mesh.quadrature=reduced; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Threads [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Calls of each kernel, of which the median counts
    #[arg(long, value_name = "N", default_value_t = 15, value_parser = clap::value_parser!(u16).range(1..))]
    repeats: u16,
    /// Print a JSON object for each figure
    #[arg(long)]
    json: bool,
}

impl Arguments {
    /// Times the kernels and whole runs and prints the figures.
    pub(super) fn run(self) -> Result<(), Failure> {
        use_threads(self.threads.map(usize::from))?;
        let mut scenes: Vec<(String, Scene)> = Vec::new();
        for path in &self.scenes {
            let name = path_in_line(path);
            let text = read_scene(path, &[])?.text;
            scenes.push((name.clone(), checked(&text, &name, &self.set)?));
        }
        let elements = format!("mesh.elements=[{}]", self.elements);
        let settings: Vec<String> = self.set.iter().cloned().chain([elements]).collect();
        let (name, kernels) = match self.scenes.first() {
            Some(path) => {
                let name = path_in_line(path);
                (name.clone(), checked(&read_scene(path, &[])?.text, &name, &settings)?)
            }
            None => ("baseline".to_string(), checked(BASELINE, "baseline", &settings)?),
        };
        let failed = |source: BenchError| Failure::Bench { source: Box::new(source) };
        let figures = kernel_figures(&kernels, &name, usize::from(self.repeats)).map_err(failed)?;
        let names = scenes.iter().map(|(name, _)| name).chain([&name]);
        let table = columns(names.map(|name| name.chars().count()).max().unwrap_or(0));
        if !self.json {
            print(&table.head())?;
        }
        self.show(&table, &figures)?;
        for (name, scene) in &scenes {
            self.show(&table, &[run_figure(scene, name).map_err(failed)?])?;
        }
        Ok(())
    }

    fn show(&self, table: &Columns, figures: &[Figure]) -> Result<(), Failure> {
        if self.json {
            return figures.iter().try_for_each(print_json);
        }
        print(&figures.iter().map(|figure| row(table, figure)).collect::<String>())
    }
}

/// The columns; the last has names of so many characters.
fn columns(widest: usize) -> Columns {
    let all = vec![
        Column::of_words("figure", 17),
        Column::of_numbers("median ms", 12),
        Column::of_numbers("limit", 6),
        Column::of_numbers("elements", 9).rank(1),
        Column::of_numbers("degree", 7).rank(3),
        Column::of_numbers("threads", 8).rank(6),
        Column::of_numbers("quadrature", 11).rank(5),
        Column::of_numbers("unknowns", 9).rank(4),
        Column::of_words("scene", widest).behind(2).rank(2),
    ];
    Columns::fitting(all, output_columns())
}

fn row(table: &Columns, figure: &Figure) -> String {
    let [p1, p2] = figure.degree;
    table.row(&[
        figure.name.to_string(),
        format!("{:.3}", figure.median_ms),
        figure.fraction_of_peak.map_or_else(String::new, |share| format!("{:.0} %", 100.0 * share)),
        figure.elements.with_sign("×"),
        format!("{p1}×{p2}"),
        figure.threads.to_string(),
        figure.quadrature.to_string(),
        figure.unknowns.to_string(),
        figure.scene.to_string(),
    ])
}
