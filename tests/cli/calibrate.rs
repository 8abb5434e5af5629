//! `foldline calibrate`: against the same from separate runs, bounds that are said, what it refuses.

use foldline::pipeline::{Run, Stages};
use foldline::record::MemorySink;
use foldline::scene::parse_with_settings;
use serde_json::Value;

use crate::program::Sandbox;

const SMALL: &str = include_str!("../restart/small.toml");

/// Moment and largest indicator so far, each way, at the end of every load step of a run on a mesh that stays.
fn alone(elements: &str) -> Vec<(f64, [f64; 2])> {
    let elements = format!("mesh.elements={elements}");
    let settings = ["load.rotation_deg=4.0", "adapt.threshold=1e9", &elements];
    let mut stages = Stages::new(parse_with_settings(SMALL, "small.toml", &settings).unwrap());
    let start = stages.start().unwrap();
    let mut sink = MemorySink::default();
    Run::new(stages, start, None).to_end(None, &|| false, &mut sink).unwrap();
    let reports = sink.stages.iter().map(|(_, record)| &record.report);
    let mut largest = [0.0_f64; 2];
    let evaluated = reports.filter(|report| report.stage.name() == "evaluate-indicators");
    let steps = evaluated.map(|report| {
        largest = [0, 1].map(|axis| largest[axis].max(report.largest_indicator[axis]));
        (report.moment_n_mm, largest)
    });
    steps.collect()
}

/// Each coarse mesh has the errors and indicators of the same mesh run by itself, and a bound where it never passes.
#[test]
fn each_direction_is_as_from_runs_of_its_own() {
    let place = Sandbox::new();
    place.write("small.toml", SMALL.as_bytes());
    let said = place.foldline("calibrate small.toml --fine 16,8 --until 4 --error 0.9 --json");
    let found: Value = serde_json::from_str(&said.ends(0).out).unwrap();
    let fine = alone("[16, 8]");
    assert_eq!(fine.len(), 2);
    for (index, elements) in ["[4, 8]", "[16, 4]", "[4, 4]"].into_iter().enumerate() {
        let (one, coarse) = (&found["coarse"][index], alone(elements));
        let curve = one["curve"].as_array().unwrap();
        assert_eq!(curve.len(), 2);
        let mut largest = 0.0_f64;
        for (point, (coarse, fine)) in curve.iter().zip(coarse.iter().zip(&fine)) {
            largest = largest.max(fine.0.abs());
            let error = (coarse.0 - fine.0).abs() / largest;
            assert!((point["error"].as_f64().unwrap() - error).abs() < 1e-9);
            for axis in 0..2 {
                assert!((point["indicator"][axis].as_f64().unwrap() / coarse.1[axis] - 1.0).abs() < 1e-9);
            }
        }
        assert_eq!((one["verdict"].as_str(), one["ended_by"].as_str()), (Some("at-least"), Some("end")));
        assert_eq!(one["threshold"], curve[1]["indicator"]);
    }
}

#[test]
fn bounds_are_said() {
    let place = Sandbox::new();
    place.write("small.toml", SMALL.as_bytes());
    let bounded = place.foldline("calibrate small.toml --fine 16,8 --until 4 --error 0.9").ends(0);
    assert!(!bounded.out.contains("threshold = "), "a bound is no threshold");
    let bounded = bounded.says(&["within 90 % to the end: at least r_u = ", "no threshold for both directions"]);
    assert!(bounded.out.lines().all(|line| line.chars().count() <= 80), "{}", bounded.out);
    let coarse = place.foldline("calibrate small.toml --fine 16,8 --until 2 --error 1e-9").ends(0);
    let coarse = coarse.says(&["at the first load step; nothing to calibrate", "more elements"]);
    assert!(!coarse.out.contains("threshold = "), "{}", coarse.out);
}

#[test]
fn what_cannot_be_calibrated_is_refused() {
    let place = Sandbox::new();
    place.write("small.toml", SMALL.as_bytes());
    place.write("along.toml", include_str!("../restart/path.toml").as_bytes());
    let uniform = SMALL.split("[adapt]").next().unwrap();
    place.write("uniform.toml", uniform.as_bytes());
    let says = |arguments: &str, pieces: &[&str]| {
        place.foldline(&format!("calibrate {arguments}")).ends(2).says(pieces);
    };
    says("along.toml", &["by arc length", "without [continuation]"]);
    says("uniform.toml", &["the scene refines nothing", "write [adapt]"]);
    says("small.toml --fine 16,4", &["16 × 4 elements is not finer both ways than the start mesh of 4 × 4"]);
    says("small.toml --error 2", &["an error of 2 is none that a mesh could pass"]);
    says("small.toml --until 90", &["--until 90 is beyond"]);
}
