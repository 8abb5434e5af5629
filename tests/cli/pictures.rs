//! Pictures of made-up runs and surfaces. `FOLDLINE_PICTURES=DIR` keeps them, to be looked at.

use foldline::view::{Picture, PlotError, ViewDirection, mesh_picture, moment_rotation_plot, vtu};

use crate::folded;
use crate::synthetic::{self, CURVE, Script};

/// Writes a picture where somebody wants to look at it.
fn keep(name: &str, text: &str) {
    if let Some(folder) = std::env::var_os("FOLDLINE_PICTURES") {
        std::fs::write(std::path::Path::new(&folder).join(name), text).unwrap();
    }
}

#[test]
fn folded_mesh() {
    let picture = Picture {
        title: "baseline, step 42".into(),
        subtitle: "θ 40.000°, M 28.31 N·mm, 20 × 8 elements".into(),
        ..Picture::default()
    };
    for (name, rotation, direction) in [
        ("mesh-40.svg", 40.0, ViewDirection::default()),
        ("mesh-80.svg", 80.0, ViewDirection::default()),
        ("mesh-top.svg", 20.0, ViewDirection { azimuth_deg: -90.0, elevation_deg: 90.0 }),
        ("mesh-end.svg", 10.0, ViewDirection { azimuth_deg: -20.0, elevation_deg: 35.0 }),
    ] {
        let samples = folded::samples(rotation);
        let svg = mesh_picture(&samples, &Picture { direction, ..picture.clone() });
        keep(name, &svg);
        assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains("inf"));
        assert_eq!(svg.matches("<path fill=\"#").count(), 120 * 32);
    }
}

#[test]
fn folded_mesh_for_paraview() {
    let xml = vtu(&folded::samples(40.0));
    keep("mesh.vtu", &xml);
    assert!(xml.contains("NumberOfCells=\"3870\""));
}

#[test]
fn moment_over_rotation() {
    let svg = moment_rotation_plot(&synthetic::scene(), &synthetic::records(), "baseline, adaptive").unwrap();
    keep("curve.svg", &svg);
    for words in ["end moment M (N·mm)", "rotation of each end θ (degrees)", "elements", "snap at 9.62°", "this run"]
    {
        assert!(svg.contains(words), "{words}");
    }
}

#[test]
fn moment_over_rotation_of_a_run_that_has_just_begun() {
    let mut script = Script::new();
    script.step(CURVE[0]);
    let svg = moment_rotation_plot(&synthetic::scene(), &script.records(), "baseline").unwrap();
    keep("curve-begun.svg", &svg);
    assert!(svg.contains("this run") && !svg.contains("snap"));
}

#[test]
fn moment_over_rotation_of_nothing() {
    let error = moment_rotation_plot(&synthetic::scene(), &[], "baseline").unwrap_err();
    assert!(matches!(error, PlotError::NoEquilibrium));
}
