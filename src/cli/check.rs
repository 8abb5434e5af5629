//! `foldline check`: what a scene is, what a run of it takes, and what looks odd, before the run.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::failure::{EXIT_CODES, Failure};
use super::output::{path_in_line, print, print_json};
use super::scene_file::read_scene;
use super::session::use_threads;
use super::wrapped::wrapped;
use crate::pipeline::RunError;
use crate::scene::{Scene, Symmetry};
use crate::spline::Grid;
use crate::study::{Forecast, StepCost, Summary};
use crate::units::{count, duration, significant};

/// Check a scene before its run: its size, what a load step takes on the mesh that it starts with (the first are done to
/// see), in which planes it is its own mirror image, and what looks odd
#[derive(Args, Debug)]
#[command(after_help = EXIT_CODES)]
pub(super) struct Arguments {
    /// Scene file (TOML), or the name of one of `foldline scenes`
    scene: PathBuf,
    /// Threads [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Print a JSON object
    #[arg(long)]
    json: bool,
}

/// What a program reads.
#[derive(Serialize)]
struct Line<'l> {
    scene: &'l str,
    box_mm: [f64; 3],
    smallest_radius_mm: Option<f64>,
    thickness_mm: f64,
    youngs_moduli_mpa: [f64; 2],
    elements: [usize; 2],
    degree: [usize; 2],
    unknowns: usize,
    refines: bool,
    memory_bytes: Option<u64>,
    load_steps: Option<f64>,
    step_s: Option<f64>,
    step_iterations: Option<usize>,
    step_fails: Option<String>,
    symmetric_in_u: bool,
    symmetric_in_v: bool,
    odd: &'l [String],
    remarks: &'l [String],
}

impl Arguments {
    /// Checks the scene and prints what was found.
    pub(super) fn run(self) -> Result<(), Failure> {
        let threads = use_threads(self.threads.map(usize::from))?;
        let scene = read_scene(&self.scene, &[])?.scene;
        let name = path_in_line(&self.scene);
        let forecast = Forecast::of(&scene)?;
        let memory = peak_memory();
        match self.json {
            true => print_json(&line(&name, &scene, &forecast, memory)),
            false => print(&shown(&name, &scene, &forecast, memory, threads)),
        }
    }
}

fn line<'l>(name: &'l str, scene: &Scene, forecast: &'l Forecast, memory_bytes: Option<u64>) -> Line<'l> {
    let Forecast { size, elements, unknowns, step, load_steps, refines, symmetric, odd, remarks, .. } = forecast;
    Line {
        scene: name,
        box_mm: size.box_mm,
        smallest_radius_mm: size.radius_mm,
        thickness_mm: size.thickness_mm,
        youngs_moduli_mpa: size.moduli_mpa,
        elements: *elements,
        degree: scene.mesh.degree,
        unknowns: *unknowns,
        refines: *refines,
        memory_bytes,
        load_steps: *load_steps,
        step_s: step.as_ref().ok().map(|step| step.wall_s),
        step_iterations: step.as_ref().ok().map(|step| step.iterations),
        step_fails: step.as_ref().err().map(RunError::to_string),
        symmetric_in_u: symmetric[0],
        symmetric_in_v: symmetric[1],
        odd,
        remarks,
    }
}

fn shown(name: &str, scene: &Scene, forecast: &Forecast, memory: Option<u64>, threads: usize) -> String {
    let Forecast { size, elements: [n1, n2], unknowns, refines, odd, remarks, .. } = forecast;
    let [p, q] = scene.mesh.degree;
    let shell = format!("{name}: {}", Summary::new(scene, &[]).shell);
    let mesh = format!(
        "{n1} × {n2} = {} of degree {p}, {q}; {}{}",
        count(Grid::new([*n1, *n2]).len(), "element"),
        count(*unknowns, "unknown"),
        if *refines { "; the mesh is refined on the way, and what follows is of the one at the start" } else { "" }
    );
    let memory = memory.map_or("not known on this system".to_owned(), |bytes| {
        let megabytes = significant((bytes as f64 / 1e6).round(), 3);
        format!("{megabytes} MB")
    });
    let mut rows = vec![
        ("size", size.to_string()),
        ("mesh", mesh),
        ("memory", memory),
        ("load step", load_steps(forecast, threads)),
        ("symmetry", symmetry(scene, forecast.symmetric)),
    ];
    rows.extend(remarks.iter().map(|remark| ("note", remark.clone())));
    match &odd[..] {
        [] => rows.push(("odd", "nothing".to_owned())),
        odd => rows.extend(odd.iter().map(|odd| ("odd", odd.clone()))),
    }
    let mut text = wrapped("", &shell) + "\n";
    let mut last = "";
    for (head, row) in &rows {
        let shown = if *head == last { "" } else { head };
        text += &wrapped(&format!("  {shown:<9}  "), row);
        text.push('\n');
        last = head;
    }
    text
}

/// What a load step takes, and how many there are.
fn load_steps(forecast: &Forecast, threads: usize) -> String {
    let StepCost { iterations, wall_s, first_is_cut } = match &forecast.step {
        Ok(step) => *step,
        Err(error) => return format!("none can be done: {error}"),
    };
    let (iterations, threads) = (count(iterations, "iteration"), count(threads, "thread"));
    let cut = if first_is_cut { "; the first is too long and is cut" } else { "" };
    let step = format!("{} ({iterations} on {threads}){cut}", time(wall_s));
    match forecast.load_steps {
        None => format!("{step}; by arc length, how many there are shows on the way"),
        Some(steps) => {
            let steps = steps.ceil();
            let whole = if forecast.refines { String::new() } else { format!(", {} in all", time(steps * wall_s)) };
            format!("{step}; at least {steps} to the target{whole}")
        }
    }
}

/// Seconds in words, or milliseconds where they are few.
fn time(seconds: f64) -> String {
    if seconds < 1.0 { format!("{} ms", significant(1e3 * seconds, 2)) } else { duration(seconds) }
}

/// In which planes the shell is its own mirror image, and what may be modelled instead.
fn symmetry(scene: &Scene, symmetric: [bool; 2]) -> String {
    let is_spring = scene.end_rotation().is_some();
    let (lines, part) = match symmetric {
        [false, false] if is_spring && scene.symmetry != Symmetry::None => return "is used".to_owned(),
        [false, false] => return "none in u = 0.5 or v = 0.5".to_owned(),
        [true, false] => ("u = 0.5", ("half", "half-length")),
        [false, true] => ("v = 0.5", ("half", "half-arc")),
        [true, true] => ("u = 0.5 and v = 0.5", ("quarter", "quarter")),
    };
    let way = match is_spring {
        true => {
            let cut = if scene.symmetry == Symmetry::None { part.1 } else { "quarter" };
            format!("`part = \"{cut}\"` in [symmetry] models that part")
        }
        false => format!(
            "a {} of the shell, with `kind = \"symmetric\"` supports where it is cut, does for the whole",
            part.0
        ),
    };
    format!("in {lines}: {way}, unless shapes that are not symmetric matter")
}

/// The most memory that this process has had, bytes; known on Linux, from /proc.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = peak.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(1024 * kilobytes)
}
