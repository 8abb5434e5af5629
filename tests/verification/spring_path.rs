//! The tape spring's path of equilibria past its limit rotation, back along the unstable part, and up the fold.

use foldline::record::Record;
use foldline::scene::{ArcLength, Scene, Stage};
use foldline::state::State;

use crate::path::{ARC_LENGTH, Path};
use crate::support::{run, scene, steps};

const LAST_DEG: f64 = 12.0;

/// A quarter of the baseline up to 12°.
fn quarter() -> Scene {
    let mut scene = scene("baseline-quarter.toml");
    scene.load.set_target(LAST_DEG);
    scene
}

/// Its like on one mesh, fine enough for a smooth path.
fn uniform() -> Scene {
    let mut scene = quarter();
    scene.adapt = None;
    scene.pipeline = vec![Stage::Solve];
    scene.mesh.elements = [24, 8];
    scene
}

fn by_length(scene: &Scene, longest_step: f64) -> Scene {
    let limits = ArcLength { longest_step, ..ARC_LENGTH };
    Scene { continuation: Some(limits), ..scene.clone() }
}

/// Under a prescribed rotation: the bracket of the snap, and rotation and moment of the steps behind it.
fn by_rotation(stages: &[(State, Record)]) -> ([f64; 2], Vec<[f64; 2]>) {
    let snap = stages.iter().position(|(_, record)| record.report.jumped).expect("a snap");
    let beyond = stages[snap].0.parameter;
    let below = stages[..snap].iter().map(|(state, _)| state.parameter).filter(|at| *at < beyond).fold(0.0, f64::max);
    let after = steps(stages).into_iter().map(|(state, _)| [state.parameter, state.moment_n_mm]);
    ([below, beyond], after.filter(|[rotation, _]| *rotation >= 10.4 - 1e-9).collect())
}

/// The path comes up the fold to the moments that the rotation-controlled run has after its snap.
fn check_fold(path: &Path, folded: &[[f64; 2]]) {
    assert!(folded.len() >= 5, "{folded:?}");
    let (rotation, moment) = (path.parameter(), path.moment());
    let last = rotation.len() - 1;
    let limits = path.limit_points();
    let begins = *limits.iter().min_by(|i, j| rotation[**i].total_cmp(&rotation[**j])).unwrap();
    for [at, expected] in folded {
        let found = match path.where_is(&rotation, *at, &moment, [begins, last])[..] {
            [found, ..] => found,
            [] if (at - LAST_DEG).abs() < 1e-9 => moment[last],
            [] => panic!("the path does not come back to {at}°"),
        };
        assert!((found / expected - 1.0).abs() < 0.005, "{found} and {expected} N·mm at {at}°");
    }
}

/// On one mesh both runs know the same equilibria: both ends of the unstable path agree with the run that snaps.
#[test]
fn both_ends_agree_with_a_run_by_rotation() {
    let scene = uniform();
    let ([below, beyond], folded) = by_rotation(&run(scene.clone()));
    assert!(beyond - below <= 0.01);
    // Short steps, between which moments are interpolated well.
    let path = Path::of(by_length(&scene, 1.0));
    let (rotation, limits) = (path.parameter(), path.limit_points());
    let first = limits[0];
    let limit = path.top(&rotation, [0, first]);
    // The snap tolerance is that of both.
    assert!(below - 0.01 <= limit && limit <= beyond + 0.01, "{limit}°, and by rotation {below}° to {beyond}°");
    check_fold(&path, &folded);

    // One mode is soft on the way back; before the limit point and up the fold the shell is stable.
    let [first, begins] = limits[..] else { panic!("{:?}", path.passed()) };
    assert!(rotation[begins] < 8.0, "the fold opens far below the snap: {}°", rotation[begins]);
    for (at, report) in path.points.iter().enumerate() {
        let expected = u64::from((first..begins).contains(&at));
        assert_eq!(report.negative_pivots, expected, "step {} at {}°", report.step, report.parameter);
    }
    for (at, passed) in path.passed() {
        assert!(passed.limit_point && passed.pivots_changed.abs() == 1, "step {}: {passed:?}", path.points[at].step);
    }

    // Work of both ends against strain energy, all along the path.
    let (mut work, mut before) = (0.0, [0.0, 0.0]);
    for report in &path.points {
        let here = [report.parameter.to_radians(), report.moment_n_mm];
        work += (here[1] + before[1]) * (here[0] - before[0]);
        before = here;
        let off = work / report.strain_energy_n_mm - 1.0;
        assert!(off.abs() < 0.01, "step {}: work {work}, energy {}", report.step, report.strain_energy_n_mm);
    }
}

/// The mesh refines on the way, and the path continues: to the same limit, and to the same fold.
#[test]
fn refined_on_the_way() {
    let scene = quarter();
    let stages = run(scene.clone());
    let ([below, _], folded) = by_rotation(&stages);
    let path = Path::of(by_length(&scene, 4.0));
    let first = path.limit_points()[0];
    let meshes = |from: usize, to: usize| {
        let elements: std::collections::BTreeSet<String> =
            path.points[from..to].iter().map(|report| report.elements.to_string()).collect();
        elements.len()
    };
    assert!(meshes(0, first) >= 4 && meshes(first, path.points.len()) >= 4, "refined before and behind the limit");
    // The meshes are not the same; the limit rotation is 9.90° ± 0.05° on either.
    let limit = path.top(&path.parameter(), [0, first]);
    assert!((limit - 9.90).abs() < 0.05 && (limit - below).abs() < 0.05, "{limit}° and {below}°");
    check_fold(&path, &folded);
    let back = path.points[first..].iter().filter(|report| report.parameter < 9.0);
    assert!(back.clone().any(|report| report.negative_pivots == 1));
    assert!(back.clone().all(|report| report.negative_pivots <= 1), "the unstable path has one soft mode");
}
