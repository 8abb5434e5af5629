//! Bifurcations, and runs that leave the branch that became unstable: Euler's column, and the tape spring bent the other
//! way.

use foldline::record::{Record, Report};
use foldline::scene::{ActionKind, ArcLength, Scene, Stage, Symmetry, parse};
use foldline::state::State;
use foldline::study::Summary;

use crate::path::{ARC_LENGTH, Path};
use crate::support::{of, run, scene, steps};

const LENGTH_MM: f64 = 100.0;
/// π² E I / 4 L² of the strip, over the width of 10 mm, N/mm.
const EULER_N_PER_MM: f64 = 9.869_604_401_089_358 * 70000.0 / 12.0 / (4.0 * LENGTH_MM * LENGTH_MM);

/// A strip held at one end, pressed along its length; the load factor is in Euler loads.
fn column(target: f64) -> Scene {
    let mut column = parse(include_str!("../restart/column.toml"), "column.toml").unwrap();
    column.continuation = None;
    column.mesh.elements = [16, 1];
    column.load.set_target(target);
    let ActionKind::LineForce { force_n_per_mm, .. } = &mut column.actions[0].kind else { panic!() };
    *force_n_per_mm = [-EULER_N_PER_MM, 0.0, 0.0].into();
    column
}

/// Deflection of the tip over the length under a multiple of Euler's load (elastica of an inextensible column): with the
/// complete elliptic integral K, K(k) = (π/2)√P and w/L = 2k/K(k).
fn elastica(load: f64) -> f64 {
    let integral = |k: f64| {
        let (mut a, mut b) = (1.0, (1.0 - k * k).sqrt());
        for _ in 0..40 {
            (a, b) = (0.5 * (a + b), f64::sqrt(a * b));
        }
        std::f64::consts::FRAC_PI_2 / a
    };
    let wanted = std::f64::consts::FRAC_PI_2 * load.sqrt();
    let (mut low, mut high) = (0.0, 0.999);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        *if integral(middle) < wanted { &mut low } else { &mut high } = middle;
    }
    2.0 * low / integral(low)
}

fn tip(report: &Report) -> f64 {
    report.probes.iter().find(|probe| probe.name == "tip").unwrap().value
}

/// Without a stage that leaves it, a run follows the straight branch, and says that it is not stable.
#[test]
fn a_straight_column_says_that_it_is_not_stable() {
    let mut scene = column(1.25);
    scene.pipeline = vec![Stage::Solve];
    let stages = run(scene.clone());
    for (state, record) in steps(&stages) {
        assert!(tip(&record.report).abs() < 1e-6 * LENGTH_MM);
        // The straight column is shorter by P/EA: 2e-4, which changes Euler's load by as much.
        if (state.parameter - 1.0).abs() > 0.005 {
            assert_eq!(record.report.negative_pivots, u64::from(state.parameter > 1.0), "at {}", state.parameter);
        }
    }
    let last = steps(&stages).last().unwrap().1.report.negative_pivots;
    assert_eq!(last, 1);
    let records: Vec<Record> = stages.into_iter().map(|(_, record)| record).collect();
    let text = Summary::new(&scene, &records).to_string();
    assert!(text.contains("the last equilibrium is not stable: its stiffness has 1 negative pivot"), "{text}");
}

/// The branch that it leaves to is the elastica.
#[test]
fn a_column_leaves_for_the_elastica() {
    let scene = column(1.25);
    let stages = run(scene);
    assert_eq!(of(&stages, Stage::SwitchBranch).count(), 1);
    let mut bent = 0;
    for (state, record) in steps(&stages) {
        assert_eq!(record.report.negative_pivots, 0, "at {}", state.parameter);
        if state.parameter > 1.005 {
            let (found, exact) = (tip(&record.report).abs() / LENGTH_MM, elastica(state.parameter));
            assert!((found / exact - 1.0).abs() < 0.01, "{found} and {exact} at {}", state.parameter);
            bent += 1;
        }
    }
    assert!(bent >= 1);
    // It is cheap: the soft mode takes some tens of factorizations, not hundreds.
    let (_, switch) = of(&stages, Stage::SwitchBranch).next().unwrap();
    assert!(switch.report.factorizations < 100, "{} factorizations", switch.report.factorizations);
}

/// Along the path the load of the bifurcation is Euler's, and behind it the path is that of the bent column.
#[test]
fn a_path_leaves_for_the_elastica() {
    let mut scene = column(1.2);
    scene.continuation = Some(ArcLength { longest_step: 1e5, ..ARC_LENGTH });
    let stages = run(scene);
    let (at, (before, passed)) =
        stages.iter().enumerate().find(|(_, (_, record))| record.report.critical_point.is_some()).unwrap();
    let critical = passed.report.critical_point.unwrap();
    assert!(critical.is_bifurcation() && !critical.limit_point && critical.pivots_changed == 1, "{critical:?}");
    assert!((before.parameter - 1.0).abs() < 0.002, "Euler's load is {}", before.parameter);
    let (left, switch) = &stages[at + 1];
    assert_eq!(switch.report.stage, Stage::SwitchBranch);
    assert_eq!((left.negative_pivots, left.step), (0, before.step));
    for (state, record) in steps(&stages).into_iter().filter(|(state, _)| state.parameter > 1.005) {
        let (found, exact) = (tip(&record.report).abs() / LENGTH_MM, elastica(state.parameter));
        assert!((found / exact - 1.0).abs() < 0.01, "{found} and {exact} at {}", state.parameter);
        assert_eq!(record.report.negative_pivots, 0);
    }
}

/// Difference of the lift of control points that mirror each other in mid-length and in the apex line, mm.
fn asymmetry(state: &State) -> [f64; 2] {
    let [n1, n2] = state.mesh.patches[0].control_counts();
    let lift = |i: usize, j: usize| state.displacement[i * n2 + j][2];
    let mut worst = [0.0_f64; 2];
    for i in 0..n1 {
        for j in 0..n2 {
            worst[0] = worst[0].max((lift(i, j) - lift(n1 - 1 - i, j)).abs());
            worst[1] = worst[1].max((lift(i, j) - lift(i, n2 - 1 - j)).abs());
        }
    }
    worst
}

/// Equal-sense bending: two modes become soft at some 1.6°, and the run continues, stable, twisted, with less energy than the
/// symmetric path has there.
#[test]
fn equal_sense_bending_leaves_for_the_twisting_branch() {
    let mut full = scene("equal-sense.toml");
    full.load.set_target(2.0);
    let stages = run(full.clone());
    let settled = steps(&stages);
    assert!(settled.iter().all(|(state, _)| state.negative_pivots == 0), "every step ends stable");

    // The symmetric path: a quarter model can take no other.
    let mut quarter = full.clone();
    (quarter.symmetry, quarter.pipeline) = (Symmetry::Quarter, vec![Stage::Solve]);
    let symmetric = run(quarter);
    let symmetric_energy = |rotation: f64| {
        let found = symmetric.iter().find(|(state, _)| (state.parameter - rotation).abs() < 1e-9);
        found.unwrap_or_else(|| panic!("no {rotation}°")).0.strain_energy_n_mm
    };
    let thickness = full.material.thickness_mm();
    let twisted = |state: &State| asymmetry(state).into_iter().fold(0.0, f64::max) > thickness;
    let first = settled.iter().position(|(state, _)| twisted(state)).expect("a twisted shape");
    let bifurcation = [settled[first - 1].0.parameter, settled[first].0.parameter];
    assert!(bifurcation[0] > 1.4 && bifurcation[1] < 1.8, "twists between {bifurcation:?}°");
    for (state, _) in &settled[..first - 1] {
        assert!(asymmetry(state).into_iter().all(|off| off < 0.1 * thickness), "{:?}", asymmetry(state));
    }
    for rotation in [1.75, 2.0] {
        let (state, _) = settled.iter().find(|(state, _)| (state.parameter - rotation).abs() < 1e-9).unwrap();
        let (twisted_energy, energy) = (state.strain_energy_n_mm, symmetric_energy(rotation));
        assert!(twisted_energy < energy * (1.0 - 1e-4), "{twisted_energy} and {energy} at {rotation}°");
        assert!(twisted(state), "{:?} mm at {rotation}°", asymmetry(state));
    }
}

/// By arc length the full model stays on the symmetric path, passes both bifurcations and says that it is not stable.
#[test]
fn the_symmetric_path_has_two_negative_pivots() {
    let mut full = scene("equal-sense.toml");
    full.load.set_target(1.75);
    full.pipeline = vec![Stage::Solve];
    full.continuation = Some(ARC_LENGTH);
    full.mesh.elements = [24, 6];
    let path = Path::of(full.clone());
    let passed = path.passed();
    let rotation = path.parameter();
    assert!(passed.iter().all(|(_, critical)| !critical.limit_point), "{passed:?}");
    assert!(passed.iter().all(|(at, _)| (1.4..1.8).contains(&rotation[*at])), "{passed:?}");
    assert_eq!(passed.iter().map(|(_, critical)| critical.pivots_changed).sum::<i64>(), 2, "{passed:?}");
    let last = path.points.last().unwrap();
    assert_eq!(last.negative_pivots, 2);
    let text = Summary::new(&full, &path.records).to_string();
    assert!(text.contains("the last equilibrium is not stable: its stiffness has 2 negative pivots"), "{text}");
}
