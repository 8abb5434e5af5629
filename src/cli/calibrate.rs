//! `foldline calibrate`: the threshold at which a scene's mesh keeps an error.

use std::path::PathBuf;

use clap::Args;

use super::failure::Failure;
use super::output::{path_in_line, print, print_json};
use super::scene_file::{checked, read_scene};
use super::session::use_threads;
use crate::record::Parameter;
use crate::scene::Scene;
use crate::study::{Calibrated, Calibration, CoarseIn, EndedBy, Verdict, calibrate, check_calibratable, fine_elements};

/// Find adapt.threshold as the paper does: run the start mesh beside a fine one until the error of the moment (or first
/// probe) passes 1 %, and take the largest indicator max|κ|h seen by then, for each direction
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// Scene (TOML) that refines its mesh; its start mesh is the coarse one
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

/// The three curves side by side.
fn table(found: &Calibration, scene: &Scene) -> String {
    let (parameter, quantity) = match Parameter::of(scene) {
        Parameter::Rotation => ("rotation", "moment"),
        Parameter::LoadFactor => ("factor", "first probe"),
    };
    let [n1, n2] = found.fine;
    let mut text = format!(
        "error of the {quantity} against {n1}×{n2} elements, and the largest max|κ|h so far:\n\
         of a mesh that is coarse along u alone, along v alone, and both ways\n\
         {:>9}  {:>18}  {:>18}  {:>26}\n{parameter:>9}  {:>9} {:>8}  {:>9} {:>8}  {:>8} {:>8} {:>8}\n",
        "",
        title("u", &found.coarse[0]),
        title("v", &found.coarse[1]),
        title("both", &found.coarse[2]),
        "error %",
        "r_u",
        "error %",
        "r_v",
        "error %",
        "r_u",
        "r_v"
    );
    // Each ends where it passed the error, so that a parameter may be missing from some of the three.
    let mut parameters: Vec<f64> = found.coarse.iter().flat_map(|one| &one.curve).map(|p| p.parameter).collect();
    parameters.sort_by(f64::total_cmp);
    parameters.dedup();
    for parameter in parameters {
        let [u, v, both] = found.coarse.each_ref().map(|one| one.curve.iter().find(|p| p.parameter == parameter));
        let error = |share: f64| format!("{:.3}", 100.0 * share);
        let u = u.map_or_else(Default::default, |p| [error(p.error), format!("{:.5}", p.indicator[0])]);
        let v = v.map_or_else(Default::default, |p| [error(p.error), format!("{:.5}", p.indicator[1])]);
        let both = both.map_or_else(Default::default, |p| {
            [error(p.error), format!("{:.5}", p.indicator[0]), format!("{:.5}", p.indicator[1])]
        });
        let row = format!(
            "{parameter:>9.3}  {:>9} {:>8}  {:>9} {:>8}  {:>8} {:>8} {:>8}",
            u[0], u[1], v[0], v[1], both[0], both[1], both[2]
        );
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
            "{told}threshold = [{u:.5}, {v:.5}]\n\
             This is of the start mesh and of what comes before a snap; behind one the length limit\n\
             decides. To see what a run makes of it: foldline study SCENE --against REFERENCE\n"
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
