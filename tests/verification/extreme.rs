//! Quick scenes of `pipelines/extreme/` end as they state; `foldline extremes` runs them all.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use foldline::pipeline::{Run, RunError, StageError, Stages};
use foldline::record::MemorySink;
use foldline::scene::{ExpectedOutcome, Scene};
use foldline::study::{Archive, ExtremesSuite};

use crate::support::scene;

fn scenes() -> BTreeMap<String, Scene> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("pipelines/extreme");
    let names = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names.map(|name| (name.clone(), scene(&format!("extreme/{name}")))).collect()
}

fn end_as_stated(scenes: BTreeMap<String, Scene>, names: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let archive = Archive::open(folder.path(), rayon::current_num_threads()).unwrap();
    let mut suite = ExtremesSuite::new(scenes, Duration::from_secs(120), archive);
    for name in names {
        let row = suite.run(name).unwrap();
        assert!(row.as_stated, "{name}: {:?} {:?}", row.outcome, row.faults);
    }
}

#[test]
fn quick_scenes() {
    end_as_stated(
        scenes(),
        &["arc-020.toml", "increments-1e-6.toml", "length-over-radius-002.toml", "one-element-degree-2.toml"],
    );
}

/// The same spring in metres, micrometres, and with other moduli, and the same roof: dimensionless curves agree to 1e-9
/// at every equilibrium, here of the path up to the jump; the suite goes through it.
#[test]
fn no_tolerance_knows_a_unit() {
    let mut scenes = scenes();
    for scene in scenes.values_mut().filter(|scene| scene.end_rotation().is_some()) {
        let target = scene.load.target();
        scene.load.set_target(target.min(5.6));
        // What they state is of the whole way.
        let expected = scene.expect.as_mut().unwrap();
        (expected.peak, expected.last) = (None, None);
    }
    let names: Vec<String> = scenes
        .iter()
        .filter(|(_, scene)| scene.expect.as_ref().is_some_and(|expect| expect.same_as.is_some()))
        .map(|(name, _)| name.clone())
        .collect();
    assert_eq!(names.len(), 6);
    end_as_stated(scenes, &names.iter().map(String::as_str).collect::<Vec<_>>());
}

#[test]
fn every_scene_says_how_it_ends_and_why() {
    for (name, scene) in scenes() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("pipelines/extreme").join(&name);
        let text = std::fs::read_to_string(path).unwrap();
        let expected = scene.expect.unwrap();
        let is_held = expected.peak.or(expected.last).is_some();
        assert!(text.starts_with("# ") && (is_held || expected.outcome != ExpectedOutcome::Finished), "{name}");
    }
}

/// Slope at the hinge, greatest moment: κ_B L of the elastica without curvature at its hinge whose other end is at the
/// same height. θ'' = λ² cos θ with s from 0 to 1, κ(0) = 0, z(1) = 0, by the classical Runge–Kutta method.
fn greatest_moment() -> f64 {
    let shoot = |square: f64, slope: f64| {
        let steps = 200;
        let step = 1.0 / f64::from(steps);
        let rate = |y: [f64; 3]| [y[1], square * y[0].cos(), y[0].sin()];
        let along = |y: [f64; 3], k: [f64; 3], h: f64| [y[0] + h * k[0], y[1] + h * k[1], y[2] + h * k[2]];
        (0..steps).fold([slope, 0.0, 0.0], |y, _| {
            let k1 = rate(y);
            let k2 = rate(along(y, k1, 0.5 * step));
            let k3 = rate(along(y, k2, 0.5 * step));
            let k4 = rate(along(y, k3, step));
            [0, 1, 2].map(|i| y[i] + step / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
        })
    };
    let moment = |slope: f64| {
        // From the straight strip on, the first force that brings the end to the height of the hinge.
        let (mut low, mut high) = (1.0, 1.0);
        while shoot(high, slope)[2] < 0.0 {
            (low, high) = (high, high + 0.25);
        }
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if shoot(middle, slope)[2] < 0.0 { low = middle } else { high = middle }
        }
        shoot(low, slope)[1]
    };
    (60..100).map(|hundredth| moment(-0.01 * f64::from(hundredth))).fold(0.0, f64::max)
}

/// The run stops where theory says that the load can be carried no further, and keeps what it has.
#[test]
fn a_load_that_nothing_carries_stops_the_run_at_its_limit() {
    let scene = scene("extreme/no-equilibrium.toml");
    let mut stages = Stages::new(scene);
    let start = stages.start().unwrap();
    let mut sink = MemorySink::default();
    let mut run = Run::new(stages, start, None);
    let error = run.to_end(None, &|| false, &mut sink).unwrap_err();
    assert!(matches!(error, RunError::Stage(StageError::JumpNotFollowed { .. })), "{error}");
    // m = κ EI/L with EI = 1000 N·mm per width and L = 100 mm.
    let limit = 10.0 * greatest_moment();
    assert!((limit - 52.8).abs() < 0.05, "{limit}");
    let reached = run.state().parameter;
    assert!((reached / limit - 1.0).abs() < 1e-3, "stopped at {reached}, theory {limit}");
    assert_eq!(sink.stages.last().unwrap().0, *run.state());
    assert_eq!(run.state().negative_pivots, 0);
}
