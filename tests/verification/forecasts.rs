//! What `foldline check` forecasts against what runs took: unknowns exactly, memory and a load step within a factor of 2.
//!
//! Where a scene refines its mesh, the forecast is of the mesh at the start, and is compared with the first load steps on that,
//! without refinement. What the run took at most is then between that and what the finest mesh takes.

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use foldline::scene::{Load, Scene, Stage, parse};
use serde_json::Value;

/// Share within which a forecast of memory and time is.
const FACTOR: f64 = 2.0;
/// Memory of a run over that of its finest mesh: the journal, and meshes before and after a refinement side by side.
const BESIDE_FINEST: f64 = 1.5;
/// Seconds after which a run is stopped, and done again to where it came.
const LONGEST_S: u64 = 40;
/// Load steps of a run without refinement.
const STEPS_AT_START: f64 = 5.0;

/// What a command printed as JSON lines, and the most memory that it had, bytes.
struct Measured {
    lines: Vec<Value>,
    peak: f64,
    is_ended: bool,
}

/// Runs the program in a folder; on Linux its memory is known.
fn measured(folder: &Path, arguments: &[&str]) -> Measured {
    let out = folder.join("out.json");
    let mut child = Command::new(env!("CARGO_BIN_EXE_foldline"))
        .args(arguments)
        .args(["--threads", "1", "--json"])
        .current_dir(folder)
        .stdout(File::create(&out).unwrap())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let (begin, status) = (Instant::now(), format!("/proc/{}/status", child.id()));
    let (mut peak, mut is_ended) = (0.0, true);
    while child.try_wait().unwrap().is_none() {
        let status = fs::read_to_string(&status).unwrap_or_default();
        let known = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes = known.and_then(|line| line.trim().trim_end_matches("kB").trim().parse().ok());
        peak = kilobytes.map_or(peak, |kilobytes: f64| 1024.0 * kilobytes);
        if begin.elapsed() > Duration::from_secs(LONGEST_S) {
            is_ended = false;
            child.kill().unwrap();
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    let text = fs::read_to_string(&out).unwrap();
    Measured { lines: text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect(), peak, is_ended }
}

/// What is forecast of a scene and what was measured.
struct Row {
    name: String,
    unknowns: [f64; 2],
    memory: [f64; 2],
    step_s: [f64; 2],
    /// Memory of the finest mesh and of the whole run, where the mesh is refined.
    refined: Option<[f64; 2]>,
    is_ended: bool,
}

impl Row {
    /// Forecast over measured.
    fn ratios(&self) -> [f64; 2] {
        [self.memory, self.step_s].map(|[forecast, measured]| forecast / measured)
    }

    fn shown(&self) -> String {
        let [megabytes, took] = self.memory.map(|bytes| bytes / 1e6);
        let [step, stepped] = self.step_s.map(|seconds| 1e3 * seconds);
        let [memory, time] = self.ratios();
        let refined = self
            .refined
            .map_or(String::new(), |[finest, run]| format!("  run {:.0} MB, finest {:.0} MB", run / 1e6, finest / 1e6));
        let part = if self.is_ended { "" } else { "  (in part)" };
        let [unknowns, had] = self.unknowns;
        format!(
            "{:34} {unknowns:6} {had:6}  {megabytes:6.1} {took:6.1} {memory:5.2}  {step:8.2} {stepped:8.2} {time:5.2}{refined}{part}",
            self.name
        )
    }
}

/// Compares the forecast of a scene with a run of it; `None` where no run of it can begin or none of its steps can be done.
fn compared(name: &str, scene: &Scene) -> Option<Row> {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    fs::write(place.join("scene.toml"), scene.to_toml()).unwrap();
    let forecast = measured(place, &["check", "scene.toml"]).lines.pop()?;
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let mut run = measured(place, &["run", "scene.toml", "-o", "run.mcap"]);
    let mut at_start = None;
    if scene.adapt.is_some() {
        let on_one_mesh = |stage: &Stage| matches!(stage, Stage::Solve | Stage::SwitchBranch);
        let pipeline = scene.pipeline.iter().copied().filter(on_one_mesh).collect();
        let fixed = Scene { adapt: None, pipeline, ..scene.clone() };
        fs::write(place.join("fixed.toml"), fixed.to_toml()).unwrap();
        let until = (STEPS_AT_START * scene.load.increment()).min(scene.load.target()).to_string();
        at_start = Some(measured(place, &["run", "fixed.toml", "-o", "fixed.mcap", "--until", &until]));
    } else if !run.is_ended {
        // It ends by looking at what it came to, which takes most.
        let key = if matches!(scene.load, Load::EndRotation(_)) { "load.rotation_deg" } else { "load.factor" };
        let set = format!("{key}={}", STEPS_AT_START * scene.load.increment());
        run = Measured { is_ended: false, ..measured(place, &["run", "scene.toml", "-o", "part.mcap", "--set", &set]) };
    }
    let begun = at_start.as_ref().unwrap_or(&run);
    let finest = number(&forecast["finest"]["memory_bytes"]);
    Some(Row {
        name: name.to_owned(),
        unknowns: [number(&forecast["unknowns"]), number(&run.lines.first()?["unknowns"])],
        memory: [number(&forecast["memory_bytes"]), begun.peak],
        step_s: [number(&forecast["step_s"]), steps(&begun.lines)?],
        refined: at_start.is_some().then_some([finest, run.peak]),
        is_ended: run.is_ended,
    })
}

/// The median wall time of the load steps that ended in equilibrium, but for the first where there are others, seconds.
fn steps(lines: &[Value]) -> Option<f64> {
    let is_step = |line: &&Value| line["stage"] == "solve" && line["outcome"] == "done";
    let first = lines.first()?["wall_s"].as_f64();
    let mut times: Vec<f64> = lines.iter().skip(1).filter(is_step).filter_map(|line| line["wall_s"].as_f64()).collect();
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied().or(first)
}

/// All scenes that come with the program.
fn shipped() -> Vec<(String, Scene)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("pipelines");
    let mut scenes = Vec::new();
    for folder in ["", "verification/", "extreme/"] {
        let files = fs::read_dir(root.join(folder)).unwrap().map(|entry| entry.unwrap().path());
        for file in files.filter(|file| file.is_file()) {
            let name = format!("{folder}{}", file.file_stem().unwrap().to_str().unwrap());
            let text = fs::read_to_string(&file).unwrap();
            scenes.push((name, parse(&text, file.to_str().unwrap()).unwrap()));
        }
    }
    scenes.sort_by(|one, other| one.0.cmp(&other.0));
    scenes
}

/// Some minutes; other programs at work make times wrong: those named in FOLDLINE_SCENES alone are done again.
#[test]
#[ignore = "takes a quarter of an hour, and the machine for itself"]
fn check_forecasts_what_runs_take() {
    let chosen = std::env::var("FOLDLINE_SCENES").unwrap_or_default();
    let is_chosen = |name: &str| chosen.is_empty() || chosen.split(',').any(|part| name.ends_with(part));
    println!("{:34} {:>13}  {:>19}  {:>23}", "", "unknowns", "memory, MB", "load step, ms");
    let mut wrong = Vec::new();
    for (name, scene) in shipped().into_iter().filter(|(name, _)| is_chosen(name)) {
        let Some(row) = compared(&name, &scene) else {
            println!("{name:34} has no load step");
            continue;
        };
        println!("{}", row.shown());
        let is_off = |ratio: f64| !(1.0 / FACTOR..=FACTOR).contains(&ratio);
        let is_beyond = row.refined.is_some_and(|[finest, run]| run > BESIDE_FINEST * finest);
        if row.unknowns[0] != row.unknowns[1] || row.ratios().into_iter().any(is_off) || is_beyond {
            wrong.push(row.shown());
        }
    }
    assert!(wrong.is_empty(), "not as forecast:\n{}", wrong.join("\n"));
}

/// Times are left out: other tests run beside this one.
#[test]
fn check_forecasts_unknowns_and_memory() {
    if !Path::new("/proc/self/status").exists() {
        return;
    }
    let quick = ["verification/cured-plate", "verification/hinged-roof-12.7", "extreme/degree-2"];
    for (name, scene) in shipped().into_iter().filter(|(name, _)| quick.contains(&name.as_str())) {
        let row = compared(&name, &scene).unwrap();
        assert_eq!(row.unknowns[0], row.unknowns[1], "{name}");
        let [memory, _] = row.ratios();
        assert!((1.0 / FACTOR..=FACTOR).contains(&memory), "{}", row.shown());
    }
}
