//! Pictures of made-up runs and surfaces. `FOLDLINE_PICTURES=DIR` keeps them, to be looked at.

use foldline::record::Record;
use foldline::scene::{Material, Scene};
use foldline::view::{
    Picture, PlotError, PlottedRun, ViewDirection, curve_plot, mesh_picture, moment_rotation_plot, quantity_named, vtu,
};

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
        // The faces, and those of the colour bar.
        assert_eq!(svg.matches("<path fill=\"#").count(), 120 * 32 + 64);
    }
}

#[test]
fn folded_mesh_for_paraview() {
    let xml = vtu(&folded::samples(40.0));
    keep("mesh.vtu", &xml);
    assert!(xml.contains("NumberOfCells=\"3870\""));
}

/// A run as it is drawn.
fn run<'r>(name: &str, scene: &'r Scene, records: &'r [Record]) -> PlottedRun<'r> {
    PlottedRun { name: name.to_owned(), scene, records }
}

#[test]
fn moment_over_rotation() {
    let (scene, records) = (synthetic::scene(), synthetic::records());
    let svg = moment_rotation_plot(&[run("baseline", &scene, &records)], "baseline, adaptive").unwrap();
    keep("curve.svg", &svg);
    for words in ["end moment M (N·mm)", "rotation of each end θ (degrees)", "elements", "snap at 9.62°", "this run"]
    {
        assert!(svg.contains(words), "{words}");
    }
}

#[test]
fn moments_of_several_runs_with_the_law_where_it_holds_for_all() {
    let (scene, records, coarse) = (synthetic::scene(), synthetic::records(), synthetic::coarse_records());
    let mut thicker = scene.clone();
    if let Material::Isotropic { thickness_mm, .. } = &mut thicker.material {
        *thickness_mm = 0.12;
    }
    let of_one_spring = [run("fine", &scene, &records), run("coarse", &scene, &coarse)];
    let of_two = [run("fine", &scene, &records), run("thicker", &thicker, &coarse)];
    let [same, other] = [of_one_spring, of_two].map(|runs| moment_rotation_plot(&runs, "").unwrap());
    keep("curves.svg", &same);
    keep("curves-of-two-springs.svg", &other);
    for words in ["fine", "coarse", "jump", "Wuest 1954", "equal-energy plateau"] {
        assert_eq!(same.matches(&format!("\n{words}")).count(), 1, "{words}");
    }
    assert!(!same.contains("this run") && !other.contains("Wuest") && !other.contains("plateau"));
}

#[test]
fn any_quantity_over_any() {
    let (scene, records) = (synthetic::scene(), synthetic::records());
    let runs = [run("baseline", &scene, &records)];
    let quantity = |name: &str| quantity_named(&scene, name).unwrap();
    for [x, y] in [["rotation", "strain_energy"], ["-rotation", "moment"], ["time", "elements"], ["step", "iterations"]]
    {
        let [x, y] = [x, y].map(quantity);
        let svg = curve_plot(&runs, &x, &y, "baseline").unwrap();
        keep(&format!("{}-over-{}.svg", y.in_file_name(), x.in_file_name()), &svg);
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }
    let svg = curve_plot(&runs, &quantity("-rotation_deg"), &quantity("strain_energy"), "baseline").unwrap();
    for words in ["−rotation of each end θ (°)", "strain energy (N·mm)", "−10", "jump"] {
        assert!(svg.contains(&format!("\n{words}\n")), "{words}");
    }
    let nothing = curve_plot(&runs, &quantity("rotation"), &quantity("path_length"), "baseline").unwrap_err();
    assert_eq!(
        nothing.to_string(),
        "no equilibrium of baseline has both rotation and path_length: draw another quantity"
    );
}

#[test]
fn moment_over_rotation_of_a_run_that_has_just_begun() {
    let mut script = Script::new();
    script.step(CURVE[0]);
    let (scene, records) = (synthetic::scene(), script.records());
    let svg = moment_rotation_plot(&[run("baseline", &scene, &records)], "baseline").unwrap();
    keep("curve-begun.svg", &svg);
    assert!(svg.contains("this run") && !svg.contains("snap"));
}

#[test]
fn moment_over_rotation_of_nothing() {
    let scene = synthetic::scene();
    let error = moment_rotation_plot(&[run("baseline", &scene, &[])], "baseline").unwrap_err();
    assert!(matches!(error, PlotError::NoEquilibrium));
}
