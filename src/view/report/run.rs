//! What the page shows of a run.

use std::collections::BTreeMap;

use serde::Serialize;

use super::shape::Shape;
use crate::record::{Parameter, Record};
use crate::scene::Scene;
use crate::spline::Elements;
use crate::study::{Summary, TapeSpring, equilibrium_path};

/// A run, as the page has it.
#[derive(Clone, Debug, Serialize)]
pub struct ReportedRun {
    /// Its name.
    name: String,
    /// The summary, as the program prints it.
    summary: String,
    /// The text of its scene.
    scene: String,
    /// Hashes, program and machine: a name and a value each.
    origin: Vec<(String, String)>,
    /// Name of the parameter, with its unit.
    parameter: &'static str,
    /// Name of what is drawn over it, with its unit.
    quantity: String,
    points: Vec<Point>,
    /// What the curve is compared with.
    laws: Vec<Law>,
    /// The largest moment before the first jump: parameter and moment.
    peak: Option<[f64; 2]>,
    snaps: Vec<String>,
    stages: Vec<Stage>,
    shape: Option<Shape>,
}

/// What a log tells of itself.
#[derive(Clone, Debug, Default)]
pub struct Told {
    /// Name of the log.
    pub name: String,
    /// The text of its scene.
    pub scene_text: String,
    /// Hashes, program and machine: a name and a value each.
    pub origin: Vec<(String, String)>,
}

/// The last equilibrium of a load step, with the size of its mesh and the time until then.
#[derive(Clone, Debug, Serialize)]
struct Point {
    step: u64,
    at: f64,
    value: Option<f64>,
    energy: f64,
    elements: Elements,
    unknowns: usize,
    stable: bool,
    jumped: bool,
    critical: Option<String>,
    wall_s: f64,
    iterations: usize,
}

/// A curve of theory.
#[derive(Clone, Debug, Serialize)]
struct Law {
    name: &'static str,
    /// Parameter and moment.
    points: Vec<[f64; 2]>,
}

/// The work of one kind of stage.
#[derive(Clone, Debug, Serialize)]
struct Stage {
    name: &'static str,
    runs: usize,
    iterations: usize,
    factorizations: usize,
    wall_s: f64,
}

impl ReportedRun {
    /// Gathers what the page shows of the records of a run of `scene`.
    pub fn new(scene: &Scene, records: &[Record], told: Told, shape: Option<Shape>) -> Self {
        let summary = Summary::new(scene, records);
        let turns = scene.end_rotation().is_some();
        let quantity = match scene.probes.first() {
            _ if turns => "moment of each end (N·mm)".to_owned(),
            Some(probe) => {
                let reading = records.iter().rev().find_map(|record| record.report.probes.first());
                format!("{} ({})", probe.name, reading.map_or("", |reading| reading.unit.as_ref()))
            }
            None => "strain energy (N·mm)".to_owned(),
        };
        let stages = summary.work.iter().map(|work| Stage {
            name: work.stage.name(),
            runs: work.runs,
            iterations: work.iterations,
            factorizations: work.factorizations,
            wall_s: work.wall_s,
        });
        let snaps = summary.snaps.iter().map(|snap| {
            let released =
                snap.energy_released_n_mm.map_or(String::new(), |energy| format!(", released {energy:.4} N·mm"));
            let [from, to] = [snap.before, snap.after].map(|at| Parameter::of(scene).shown_short(at));
            format!("{from} to {to}: {:.3} → {:.3}{released}", snap.moment_before_n_mm, snap.moment_after_n_mm)
        });
        Self {
            name: told.name,
            summary: summary.to_string(),
            scene: told.scene_text,
            origin: told.origin,
            parameter: match Parameter::of(scene) {
                Parameter::Rotation => "rotation of each end (°)",
                Parameter::LoadFactor => "load factor",
            },
            quantity,
            points: points(records, turns, scene.probes.is_empty()),
            laws: laws(scene),
            peak: summary.peak.filter(|_| turns).map(|peak| [peak.parameter, peak.moment_n_mm]),
            snaps: snaps.collect(),
            stages: stages.collect(),
            shape,
        }
    }

    /// What the curve of the run is drawn of and over.
    pub fn axes(&self) -> (&str, &str) {
        (self.parameter, &self.quantity)
    }
}

/// Wuest's law for uniform curvature and the plateau of equal energy, where they are theory of the scene.
fn laws(scene: &Scene) -> Vec<Law> {
    const POINTS: u32 = 200;
    let Some(spring) = TapeSpring::of_scene(scene) else { return Vec::new() };
    let to = scene.load.target();
    let at = |i: u32| f64::from(i) / f64::from(POINTS) * to;
    let law = (0..=POINTS).map(at).map(|rotation| [rotation, spring.moment_at_rotation(rotation)]).collect();
    let plateau = spring.plateau().map(|plateau| plateau.moment_n_mm);
    let plateau = plateau.map(|moment| Law { name: "equal energy", points: vec![[0.0, moment], [to, moment]] });
    [Law { name: "Wuest 1954, uniform curvature", points: law }].into_iter().chain(plateau).collect()
}

/// What a run came to by the end of a load step.
#[derive(Clone, Copy, Default)]
struct Spent {
    wall_s: f64,
    iterations: usize,
    unknowns: usize,
}

fn points(records: &[Record], turns: bool, unprobed: bool) -> Vec<Point> {
    let mut spent = Spent::default();
    let mut by_step: BTreeMap<u64, Spent> = BTreeMap::new();
    for Record { report, wall_s, .. } in records {
        spent = Spent {
            wall_s: spent.wall_s + wall_s,
            iterations: spent.iterations + report.iterations,
            unknowns: report.unknowns,
        };
        by_step.insert(report.step, spent);
    }
    equilibrium_path(records)
        .iter()
        .map(|point| {
            let Spent { wall_s, iterations, unknowns } = by_step.get(&point.step).copied().unwrap_or_default();
            Point {
                step: point.step,
                at: point.parameter,
                value: match (turns, unprobed) {
                    (true, _) => Some(point.moment_n_mm),
                    (false, true) => Some(point.strain_energy_n_mm),
                    (false, false) => point.probe,
                },
                energy: point.strain_energy_n_mm,
                elements: point.elements.clone(),
                unknowns,
                stable: point.negative_pivots == 0,
                jumped: point.jumped,
                critical: point.passed.map(|passed| passed.critical.in_words()),
                wall_s,
                iterations,
            }
        })
        .collect()
}
