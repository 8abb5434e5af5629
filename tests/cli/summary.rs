//! The summary of whole, partial and odd runs.

use foldline::record::{Outcome, Record};
use foldline::scene::{EndRotation, Load, Scene, Sense, Symmetry};
use foldline::study::{PeakFound, Summary};

use crate::synthetic::{self, CURVE, Script};

fn text(scene: &Scene, records: &[Record]) -> String {
    Summary::new(scene, records).to_string()
}

#[test]
fn whole_run() {
    insta::assert_snapshot!(text(&synthetic::scene(), &synthetic::records()));
}

#[test]
fn run_without_a_jump() {
    let mut script = Script::new();
    CURVE[..5].iter().for_each(|point| script.step(*point));
    insta::assert_snapshot!(text(&Scene { symmetry: Symmetry::None, ..synthetic::scene() }, &script.records()));
}

#[test]
fn run_that_is_past_the_peak_and_has_not_jumped() {
    let mut script = Script::new();
    CURVE[..9].iter().for_each(|point| script.step(*point));
    insta::assert_snapshot!(text(&synthetic::scene(), &script.records()));
}

#[test]
fn run_of_one_step() {
    let mut script = Script::new();
    script.solve(CURVE[0], false);
    insta::assert_snapshot!(text(&synthetic::scene(), &script.records()));
}

#[test]
fn run_that_jumps_in_its_first_step() {
    let mut script = Script::new();
    script.solve(CURVE[9], true);
    insta::assert_snapshot!(text(&synthetic::scene(), &script.records()));
}

#[test]
fn run_without_an_equilibrium() {
    let mut script = Script::new();
    script.rejected(0.8, Outcome::RejectedNoEquilibrium);
    insta::assert_snapshot!(text(&synthetic::scene(), &script.records()));
}

#[test]
fn run_that_has_not_begun() {
    insta::assert_snapshot!(text(&synthetic::scene(), &[]));
}

#[test]
fn equal_sense_folded_far_from_the_ends() {
    let mut scene = synthetic::scene();
    scene.load = Load::EndRotation(EndRotation {
        sense: Sense::Equal,
        rotation_deg: 60.0,
        increment_deg: 0.4,
        longest_increment_deg: None,
    });
    scene.geometry = foldline::scene::Geometry::TapeSpring { length_mm: 300.0, radius_mm: 12.5, arc_deg: 90.5 };
    let mut script = Script::new();
    script.step((2.0, 60.0, 2.0));
    script.step((4.0, 90.0, 6.0));
    script.solve((4.5, 14.0, 3.0), true);
    for (i, moment) in [14.6, 15.1, 15.3, 15.5, 15.6].into_iter().enumerate() {
        script.step((20.0 + 10.0 * i as f64, moment, 12.0));
    }
    insta::assert_snapshot!(text(&scene, &script.records()));
}

#[test]
fn run_that_stands_on_an_unstable_equilibrium() {
    let mut script = Script::new();
    script.step(CURVE[0]);
    let mut records = script.records();
    records.iter_mut().for_each(|record| record.report.negative_pivots = 1);
    insta::assert_snapshot!(text(&synthetic::scene(), &records));
}

#[test]
fn numbers_of_the_whole_run() {
    let summary = Summary::new(&synthetic::scene(), &synthetic::records());
    let stiffness = summary.initial_stiffness_n_mm.unwrap();
    assert!((stiffness / 2771.9 - 1.0).abs() < 0.01, "{stiffness}");
    let peak = summary.peak.unwrap();
    assert!(
        peak.found == PeakFound::Parabola
            && (peak.moment_n_mm - 292.0).abs() < 0.5
            && (peak.parameter - 9.1).abs() < 0.2
    );
    let [snap] = summary.snaps[..] else { panic!("{:?}", summary.snaps) };
    assert_eq!((snap.before, snap.after), (9.6, 9.615));
    assert_eq!(snap.moment_before_n_mm, 289.124724);
    let fold = summary.fold.unwrap();
    assert_eq!((fold.points, fold.range_deg), (2, [18.0, 20.0]));
    assert_eq!(summary.load_steps, 14);
    assert_eq!(summary.rejections, 3);
}

#[test]
fn a_fall_in_stages_is_one_jump() {
    let mut script = Script::new();
    CURVE[..9].iter().for_each(|point| script.step(*point));
    script.solve((9.615, 51.98, 40.0), true);
    script.evaluate([6, 0]);
    script.refine([8, 2]);
    script.step(CURVE[11]);
    let mut records = script.records();
    let last_in_step = records.len() - 3;
    let report = &mut records[last_in_step].report;
    (report.jumped, report.energy_released_n_mm, report.moment_n_mm) = (true, Some(7.5), 26.57);
    let summary = Summary::new(&synthetic::scene(), &records);
    let [snap] = summary.snaps[..] else { panic!("{:?}", summary.snaps) };
    assert_eq!((snap.before, snap.after), (9.6, 9.615));
    assert_eq!((snap.moment_before_n_mm, snap.moment_after_n_mm), (289.124724, 26.57));
    assert!((snap.energy_released_n_mm.unwrap() - (63.055972 - 40.0 + 1.9 + 7.5)).abs() < 1e-9);
    let path = foldline::study::equilibrium_path(&records);
    assert_eq!(path.iter().filter(|point| point.jumped).count(), 1);
    assert_eq!(path.len(), 11);
}

#[test]
fn run_on_a_mesh_that_is_too_coarse() {
    insta::assert_snapshot!(text(&synthetic::scene(), &synthetic::coarse_records()));
}

/// Ripples of the mesh are no snaps: one line counts them, and the balance knows what they released.
#[test]
fn ripples_are_summed_in_one_line() {
    let mut script = Script::new();
    CURVE[..9].iter().for_each(|point| script.step(*point));
    let mut records = script.records();
    let smooth = Summary::new(&synthetic::scene(), &records);
    for (index, released) in [(4, Some(1.5e-3)), (6, Some(0.5e-3)), (8, None)] {
        let report = &mut records[index].report;
        (report.rippled, report.energy_released_n_mm) = (true, released);
    }
    let summary = Summary::new(&synthetic::scene(), &records);
    assert_eq!((summary.ripples, summary.snaps.len()), ((3, 2e-3), 0));
    let accounted = |summary: &Summary| summary.balance.unwrap().accounted_n_mm();
    assert!((accounted(&summary) - accounted(&smooth) - 2e-3).abs() < 1e-12);
    let line = summary.to_string().lines().find(|line| line.contains("ripples")).unwrap().to_owned();
    assert_eq!(
        line.trim(),
        "ripples            3 of the mesh, each less than refining the mesh changes, released 2.00e-3 N·mm in all"
    );
}
