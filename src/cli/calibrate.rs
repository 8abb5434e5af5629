//! `foldline calibrate`: the threshold at which a scene's mesh keeps an error.

use std::path::PathBuf;

use clap::Args;

use super::failure::Failure;
use super::output::{path_in_line, print, print_json};
use super::scene_file::{checked, read_scene};
use super::session::use_threads;
use super::terminal::output_columns;
use super::wrapped::wrapped;
use crate::record::Parameter;
use crate::scene::Scene;
use crate::study::{Calibrated, Calibration, CoarseIn, EndedBy, Verdict, calibrate, check_calibratable, fine_elements};

/// Find adapt.threshold as the paper does: run the start mesh beside a fine one until the error of the moment (or first
/// probe) passes 1 %, and take the largest indicator max|κ|h seen by then, for each direction
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// Scene (TOML) that refines its mesh, or the name of one of `foldline scenes`; its start mesh is the coarse one
    scene: PathBuf,
    /// The relative error at which to stop
    #[arg(long, value_name = "SHARE", default_value_t = 0.01)]
    error: f64,
    /// Elements of the fine mesh each way over the whole shell [default: the start mesh, halved to twice the length limit,
    /// up to 128 each way]
    #[arg(long, value_name = "N,M")]
    fine: Option<String>,
    /// Stop at this rotation (degrees) or load factor
    #[arg(long, value_name = "VALUE")]
    until: Option<f64>,
    /// Lay a setting over the scene, such as load.increment_deg=0.2; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Threads [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Print a JSON object
    #[arg(long)]
    json: bool,
}

impl Arguments {
    /// Calibrates, and prints the curves and what they tell.
    pub(super) fn run(self) -> Result<(), Failure> {
        use_threads(self.threads.map(usize::from))?;
        let text = read_scene(&self.scene, &[])?.text;
        let name = path_in_line(&self.scene);
        let scene = checked(&text, &name, &self.set)?;
        let failed = |source| Failure::Calibration { scene: name.clone(), source: Box::new(source) };
        check_calibratable(&scene).map_err(failed)?;
        if let Some(until) = self.until.filter(|until| *until > scene.load.target()) {
            return Err(Failure::UntilBeyondScene { until, scene: Box::new(scene) });
        }
        let fine = match &self.fine {
            Some(elements) => {
                let settings = [self.set.clone(), vec![format!("mesh.elements=[{elements}]")]].concat();
                checked(&text, &name, &settings)?.mesh.elements
            }
            None => fine_elements(&scene).map_err(failed)?,
        };
        let found = calibrate(&scene, fine, self.error, self.until).map_err(failed)?;
        match self.json {
            true => print_json(&found),
            false => print(&(table(&found, &scene) + &conclusion(&found))),
        }
    }
}

/// The three curves side by side, or below one another where a terminal is too narrow.
fn table(found: &Calibration, scene: &Scene) -> String {
    let (parameter, quantity) = match Parameter::of(scene) {
        Parameter::Rotation => ("rotation", "moment"),
        Parameter::LoadFactor => ("factor", "first probe"),
    };
    let [n1, n2] = found.fine;
    let what = format!(
        "error of the {quantity} against {n1}×{n2} elements, and the largest max|κ|h so far: of a mesh that is coarse along u \
         alone, along v alone, and both ways"
    );
    let mut text = wrapped("", &what) + "\n";
    let widths = [0, 1, 2].map(|curve| heads(curve).iter().map(|(_, width)| width + 1).sum::<usize>() + 1);
    let is_wide = output_columns().is_none_or(|columns| PARAMETER + widths.iter().sum::<usize>() <= columns);
    let blocks: &[&[usize]] = if is_wide { &[&[0, 1, 2]] } else { &[&[0, 1], &[2]] };
    let blocks = blocks.iter().map(|curves| block(found, parameter, curves));
    text.push_str(&blocks.collect::<Vec<_>>().join("\n"));
    text
}

/// Width of the parameters.
const PARAMETER: usize = 9;

/// The columns of a curve: the error, and the indicators of the directions in which its mesh is coarse.
fn heads(curve: usize) -> &'static [(&'static str, usize)] {
    match curve {
        0 => &[("error %", 9), ("r_u", 8)],
        1 => &[("error %", 9), ("r_v", 8)],
        _ => &[("error %", 8), ("r_u", 8), ("r_v", 8)],
    }
}

/// Some of the curves side by side.
fn block(found: &Calibration, parameter: &str, curves: &[usize]) -> String {
    let [mut titles, mut head] = [format!("{:>PARAMETER$}", ""), format!("{parameter:>PARAMETER$}")];
    for &curve in curves {
        let cells: String = heads(curve).iter().map(|&(head, width)| format!(" {head:>width$}")).collect();
        let title = title(["u", "v", "both"][curve], &found.coarse[curve]);
        titles += &format!(" {title:>0$}", cells.chars().count());
        head += &format!(" {cells}");
    }
    let mut text = format!("{titles}\n{head}\n");
    // Each ends where it passed the error, so that a parameter may be missing from some of them.
    let all = curves.iter().flat_map(|&curve| &found.coarse[curve].curve);
    let mut parameters: Vec<f64> = all.map(|point| point.parameter).collect();
    parameters.sort_by(f64::total_cmp);
    parameters.dedup();
    for parameter in parameters {
        let mut row = format!("{parameter:>PARAMETER$.3}");
        for &curve in curves {
            let point = found.coarse[curve].curve.iter().find(|point| point.parameter == parameter);
            row += " ";
            for &(head, width) in heads(curve) {
                let cell = point.map_or_else(String::new, |point| match head {
                    "r_u" => format!("{:.5}", point.indicator[0]),
                    "r_v" => format!("{:.5}", point.indicator[1]),
                    _ => format!("{:.3}", 100.0 * point.error),
                });
                row += &format!(" {cell:>width$}");
            }
        }
        text.push_str(&(row.trim_end().to_owned() + "\n"));
    }
    text
}

fn title(coarse_in: &str, one: &Calibrated) -> String {
    format!("{coarse_in}: {}×{}", one.elements[0], one.elements[1])
}

/// What each mesh tells, and the line for the scene where both directions passed the error: a bound is no threshold.
fn conclusion(found: &Calibration) -> String {
    let told: String = found.coarse.iter().map(|one| told(one, found.error)).collect();
    let [u, v] = [0, 1].map(|axis| match found.coarse[axis].verdict {
        Verdict::Passed { threshold } => Some(threshold[axis]),
        Verdict::AtLeast { .. } | Verdict::TooCoarse => None,
    });
    match u.zip(v) {
        Some((u, v)) => format!(
            "{told}threshold = [{u:.5}, {v:.5}]\n{}\n",
            wrapped(
                "",
                "This is of the start mesh and of what comes before a snap; behind one the length limit decides. To see what a \
                 run makes of it: foldline study SCENE --against REFERENCE"
            )
        ),
        None => format!("{told}no threshold for both directions: fewer start elements show more\n"),
    }
}

fn told(one: &Calibrated, error: f64) -> String {
    let (name, axes) = match one.coarse_in {
        CoarseIn::U => ("along u", 0..1),
        CoarseIn::V => ("along v", 1..2),
        CoarseIn::Both => ("both ways", 0..2),
    };
    let percent = 100.0 * error;
    let shown = |pair: [f64; 2]| {
        let each = axes.clone().map(|axis| format!("{} = {:.5}", ["r_u", "r_v"][axis], pair[axis]));
        each.collect::<Vec<_>>().join(", ")
    };
    match one.verdict {
        Verdict::Passed { threshold } => format!("{name}: passes {percent} % beyond {}\n", shown(threshold)),
        Verdict::AtLeast { threshold, ended_by } => {
            let end = match ended_by {
                EndedBy::Snap => "before the snap",
                EndedBy::End => "to the end",
            };
            format!("{name}: within {percent} % {end}: at least {}\n", shown(threshold))
        }
        Verdict::TooCoarse => format!(
            "{name}: over {percent} % at the first load step; nothing to calibrate:\n  \
             start with more elements (mesh.elements), or smaller increments\n"
        ),
    }
}
