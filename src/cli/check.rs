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
use crate::spline::Elements;
use crate::study::{FinestCost, Forecast, StepCost, Summary};
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
    elements: Elements,
    degree: [usize; 2],
    unknowns: usize,
    refines: bool,
    finest: Option<FinestLine>,
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

/// The finest mesh that refining may end with, as a program reads it.
#[derive(Clone, Serialize)]
struct FinestLine {
    elements: Elements,
    unknowns: Option<usize>,
    memory_bytes: Option<u64>,
    step_s: Option<f64>,
}

impl Arguments {
    /// Checks the scene and prints what was found.
    pub(super) fn run(self) -> Result<(), Failure> {
        let threads = use_threads(self.threads.map(usize::from))?;
        let file = read_scene(&self.scene, &[])?;
        let scene = &file.scene;
        let name = path_in_line(&self.scene);
        let forecast = Forecast::of(scene).map_err(|refusal| file.written.refused(refusal))?;
        // What the mesh at the start takes: the finest is tried out after it.
        let memory = forecast.step.as_ref().and_then(|_| peak_memory());
        let finest = finest(scene, &forecast);
        match self.json {
            true => print_json(&line(&name, scene, &forecast, memory, finest)),
            false => print(&shown(&name, scene, &forecast, memory, finest, threads)),
        }
    }
}

/// What the finest mesh takes, where the mesh is refined.
fn finest(scene: &Scene, forecast: &Forecast) -> Option<FinestLine> {
    let mesh = forecast.finest.as_ref()?;
    let cost = mesh.cost(scene);
    let step =
        |cost: FinestCost| Some((1.0 + forecast.step.as_ref()?.as_ref().ok()?.iterations as f64) * cost.iteration_s);
    Some(FinestLine {
        elements: mesh.elements.clone(),
        unknowns: cost.map(|cost| cost.unknowns),
        memory_bytes: cost.and_then(|_| peak_memory()),
        step_s: cost.and_then(step),
    })
}

fn line<'l>(
    name: &'l str,
    scene: &Scene,
    forecast: &'l Forecast,
    memory_bytes: Option<u64>,
    finest: Option<FinestLine>,
) -> Line<'l> {
    let Forecast { size, elements, unknowns, step, load_steps, symmetric, odd, remarks, .. } = forecast;
    let done = step.as_ref().and_then(|step| step.as_ref().ok());
    Line {
        scene: name,
        box_mm: size.box_mm(),
        smallest_radius_mm: size.radius_mm,
        thickness_mm: size.thickness_mm,
        youngs_moduli_mpa: size.moduli_mpa,
        elements: elements.clone(),
        degree: scene.mesh.degree,
        unknowns: *unknowns,
        refines: finest.is_some(),
        finest,
        memory_bytes,
        load_steps: *load_steps,
        step_s: done.map(|step| step.wall_s),
        step_iterations: done.map(|step| step.iterations),
        step_fails: step.as_ref().and_then(|step| step.as_ref().err()).map(RunError::to_string),
        symmetric_in_u: symmetric[0],
        symmetric_in_v: symmetric[1],
        odd,
        remarks,
    }
}

fn shown(
    name: &str,
    scene: &Scene,
    forecast: &Forecast,
    memory: Option<u64>,
    finest: Option<FinestLine>,
    threads: usize,
) -> String {
    let Forecast { size, elements, unknowns, odd, remarks, .. } = forecast;
    let [p, q] = scene.mesh.degree;
    let shell = format!("{name}: {}", Summary::new(scene, &[]).shell);
    let mesh = format!(
        "{elements} = {} of degree {p}, {q}; {}{}",
        count(elements.count(), "element"),
        count(*unknowns, "unknown"),
        if finest.is_some() { ", at the start" } else { "" }
    );
    let at_start = if finest.is_some() { ", at the start" } else { "" };
    let unknown = if forecast.step.is_none() { "not tried out" } else { "not known on this system" };
    let memory = memory.map_or(unknown.to_owned(), |bytes| megabytes(bytes) + at_start);
    let mut rows = vec![
        ("size", size.to_string()),
        ("mesh", mesh),
        ("memory", memory),
        ("load step", load_steps(forecast, threads)),
    ];
    rows.extend(finest.map(|finest| ("refined", refined(&finest))));
    rows.push(("symmetry", symmetry(scene, forecast.symmetric)));
    rows.extend(remarks.iter().map(|remark| ("note", remark.clone())));
    match &odd[..] {
        [] => rows.push(("odd", "nothing".to_owned())),
        odd => rows.extend(odd.iter().map(|odd| ("odd", odd.clone()))),
    }
    let mut text: String = shell.lines().map(|line| wrapped("", line) + "\n").collect();
    let mut last = "";
    for (head, row) in &rows {
        let shown = if *head == last { "" } else { head };
        text += &wrapped(&format!("  {shown:<9}  "), row);
        text.push('\n');
        last = head;
    }
    text
}

fn megabytes(bytes: u64) -> String {
    format!("{} MB", significant((bytes as f64 / 1e6).round(), 3))
}

/// What the mesh may become, and what that takes.
fn refined(finest: &FinestLine) -> String {
    let FinestLine { elements, unknowns, memory_bytes, step_s } = finest;
    let parts = [
        unknowns.map(|unknowns| count(unknowns, "unknown")),
        memory_bytes.map(megabytes),
        step_s.map(|step_s| format!("{} a load step", time(step_s))),
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    let cost =
        if parts.is_empty() { ", more than is tried out here".to_owned() } else { format!(": {}", parts.join(", ")) };
    format!(
        "the mesh grows where the shell bends, to {elements} elements at most, which is the length limit everywhere{cost}; a run \
         takes from what is needed at the start to twice that"
    )
}

/// What a load step takes, and how many there are.
fn load_steps(forecast: &Forecast, threads: usize) -> String {
    let StepCost { iterations, wall_s, first_is_cut } = match &forecast.step {
        None => return "not tried out: the mesh is large, and one may take minutes and gigabytes".to_owned(),
        Some(Ok(step)) => *step,
        Some(Err(error)) => return format!("none can be done: {error}"),
    };
    let (iterations, threads) = (count(iterations, "iteration"), count(threads, "thread"));
    let cut = if first_is_cut { "; the first is too long and is cut" } else { "" };
    let at_start = if forecast.finest.is_some() { ", at the start" } else { "" };
    let step = format!("{} ({iterations} on {threads}{at_start}){cut}", time(wall_s));
    match forecast.load_steps {
        None => format!("{step}; by arc length, how many there are shows on the way"),
        Some(steps) => {
            let steps = steps.ceil();
            let whole =
                if forecast.finest.is_some() { String::new() } else { format!(", {} in all", time(steps * wall_s)) };
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
