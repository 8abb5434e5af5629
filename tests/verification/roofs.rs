//! Hinged roofs through snap-through and snap-back (Sze, Liu & Lo 2004, section 3.8), and what holds of any path.

use foldline::scene::{Action, ActionKind, Component, Hold, Load, Probe, ProbeKind, Reaction, Region, Scene, Support};

use crate::path::{ARC_LENGTH, Path};
use crate::support::{run, scene};

fn roof(name: &str) -> Scene {
    scene(&format!("verification/{name}.toml"))
}

/// Load over its largest, and deflection, mm.
fn published() -> Vec<[f64; 2]> {
    let text = include_str!("sze2004_3_8_hinged_roof_h12.7.csv");
    let rows = text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    rows.map(|line| {
        let (load, deflection) = line.split_once(',').unwrap();
        [load.parse().unwrap(), deflection.parse().unwrap()]
    })
    .collect()
}

/// Every row of the table at its load, on its side of the limit points.
#[test]
fn snap_through() {
    let path = Path::of(roof("hinged-roof-12.7-snap"));
    let (load, deflection) = (path.parameter(), path.probe("w_c").iter().map(|w| -w).collect::<Vec<f64>>());
    let limits = path.limit_points();
    assert_eq!(limits.len(), 2, "{:?}", path.passed());
    let last = load.len() - 1;
    assert!((load[last] - 1.0835).abs() < 1e-9);

    let rows = published();
    let largest = rows[rows.len() - 1][1];
    let index_of = |better: fn(f64, f64) -> bool| {
        (1..rows.len() - 1)
            .find(|k| better(rows[*k][0], rows[k - 1][0]) && better(rows[*k][0], rows[k + 1][0]))
            .unwrap()
    };
    let (highest, lowest) = (index_of(|a, b| a > b), index_of(|a, b| a < b));
    let branches = [[0, limits[0]], [limits[0] - 1, limits[1]], [limits[1] - 1, last]];
    let mut worst = 0.0_f64;
    for (k, [row_load, row_deflection]) in rows.iter().enumerate() {
        // A row at a limit point may lie on either side of it.
        let sides = match k {
            k if k == highest => 0..2,
            k if k == lowest => 1..3,
            k => [0..1, 1..2, 2..3][usize::from(k > highest) + usize::from(k > lowest)].clone(),
        };
        let found: Vec<f64> =
            sides.clone().flat_map(|side| path.where_is(&load, *row_load, &deflection, branches[side])).collect();
        if found.is_empty() && (k == highest || k == lowest) {
            // A published limit load that this path does not quite reach, where the deflection at a load is undefined: the
            // load at its deflection, to the three digits of the table.
            let loads = path.where_is(&deflection, *row_deflection, &load, [0, last]);
            assert!(loads.iter().any(|found| (found / row_load - 1.0).abs() < 0.005), "{row_load}: {loads:?}");
            continue;
        }
        let off = found.iter().map(|w| ((w - row_deflection) / largest).abs()).fold(f64::INFINITY, f64::min);
        assert!(
            off < 0.015,
            "{:.2} % of the largest deflection at {row_load}, {row_deflection} mm: {found:?}",
            100.0 * off
        );
        worst = worst.max(off);
    }
    println!("worst difference {:.2} % of the largest deflection", 100.0 * worst);
    // Between the limit points the path is unstable, before and behind it is stable.
    for (at, report) in path.points.iter().enumerate() {
        let between = (limits[0]..limits[1]).contains(&at);
        assert_eq!(report.negative_pivots > 0, between, "step {}: {} pivots", report.step, report.negative_pivots);
    }
}

/// Half as thick, deflection and load both go back, and the load changes sign.
#[test]
fn snap_back() {
    let path = Path::of(roof("hinged-roof-6.35-snap"));
    let (load, deflection) = (path.parameter(), path.probe("w_c").iter().map(|w| -w).collect::<Vec<f64>>());
    let last = load.len() - 1;
    assert!((load[last] - 1.0).abs() < 1e-9);
    let limits = path.limit_points();
    assert!(limits.len() >= 2, "{:?}", path.passed());
    let (first, lowest) = (limits[0], (0..=last).min_by(|i, j| load[*i].total_cmp(&load[*j])).unwrap());
    let top = path.top(&load, [0, first]);
    assert!((0.195..0.197).contains(&top), "first limit load {top}");
    let bottom = -path.top(&load.iter().map(|value| -value).collect::<Vec<f64>>(), [first, last]);
    assert!((-0.131..-0.127).contains(&bottom), "lowest load {bottom}");
    assert!(limits.iter().any(|limit| limit.abs_diff(lowest) <= 1), "and there is a limit point there");
    // The deflection has a limit point after that of the load, and another before the lowest load.
    let back = (first..lowest).max_by(|i, j| deflection[*i].total_cmp(&deflection[*j])).unwrap();
    let on = (back..last).min_by(|i, j| deflection[*i].total_cmp(&deflection[*j])).unwrap();
    assert!(first < back && back < on && on < last, "{first} {back} {on} {last}");
    assert!(deflection[back] - deflection[on] > 1.0, "from {} back to {} mm", deflection[back], deflection[on]);
    assert!(path.points[last].negative_pivots == 0 && path.points[0].negative_pivots == 0);
    // Work of the load is the strain energy, all along the path; in parts of the largest energy.
    let largest = path.points.iter().map(|report| report.strain_energy_n_mm).fold(0.0, f64::max);
    let mut work = 0.0;
    for report in &path.points {
        work += report.work_n_mm;
        let off = (work - report.strain_energy_n_mm) / largest;
        assert!(off.abs() < 0.01, "work {work} against {} in step {}", report.strain_energy_n_mm, report.step);
    }
}

fn coarse() -> Scene {
    let mut scene = roof("hinged-roof-12.7-snap");
    scene.mesh.elements = [4, 4];
    scene
}

/// Steps of any length follow the same path.
#[test]
fn the_path_does_not_depend_on_the_steps() {
    let follow = |longest_step: f64, increment: f64| {
        let mut scene = coarse();
        scene.continuation.as_mut().unwrap().longest_step = longest_step;
        let Load::Steps(steps) = &mut scene.load else { panic!() };
        steps.increment = increment;
        Path::of(scene)
    };
    let paths = [follow(1.0, 0.02), follow(4.0, 0.02), follow(4.0, 0.08)];
    assert!(paths[0].points.len() > paths[1].points.len() && paths[1].points.len() > paths[2].points.len());
    // The scene's snap tolerance: critical points are located to it.
    let tolerance = 1e-3;
    let critical: Vec<Vec<(f64, bool, i64)>> = paths
        .iter()
        .map(|path| {
            let load = path.parameter();
            path.passed().iter().map(|(at, found)| (load[*at], found.limit_point, found.pivots_changed)).collect()
        })
        .collect();
    for other in &critical[1..] {
        assert_eq!(other.len(), critical[0].len(), "{critical:?}");
        for (a, b) in critical[0].iter().zip(other) {
            assert_eq!((a.1, a.2), (b.1, b.2), "{critical:?}");
            assert!((a.0 - b.0).abs() <= 2.0 * tolerance, "{critical:?}");
        }
    }
    let tops = paths.iter().map(|path| path.top(&path.parameter(), [0, path.limit_points()[0]]));
    let tops: Vec<f64> = tops.collect();
    assert!(tops.iter().all(|top| (top - tops[0]).abs() < tolerance), "{tops:?}");
    // And end at the same equilibrium.
    let ends: Vec<f64> = paths.iter().map(|path| *path.probe("w_c").last().unwrap()).collect();
    assert!(ends.iter().all(|end| (end / ends[0] - 1.0).abs() < 1e-4), "{ends:?}");
}

/// A load that follows the shell: the limit point of the path lies where load control finds the jump.
#[test]
fn a_follower_load_has_one_limit_point() {
    let mut by_length = coarse();
    by_length.actions = vec![Action {
        name: "pressure".into(),
        shell: None,
        kind: ActionKind::Pressure { pressure_mpa: -0.03, follower: true },
        history: by_length.actions[0].history.clone(),
    }];
    by_length.load.set_target(0.6);
    let Load::Steps(steps) = &mut by_length.load else { panic!() };
    (steps.increment, steps.snap_tolerance) = (0.1, 1e-3);
    let mut by_load = by_length.clone();
    by_load.continuation = None;

    let stages = run(by_load);
    let jump = stages.iter().position(|(_, record)| record.report.jumped).expect("a jump");
    let beyond = stages[jump].0.parameter;
    let below = stages[..jump].iter().map(|(state, _)| state.parameter).fold(0.0, f64::max);
    assert!(beyond - below <= 1e-3);

    let path = Path::of(by_length);
    let (first, critical) = path.passed()[0];
    assert!(critical.limit_point && critical.pivots_changed == 1, "{critical:?}");
    let top = path.top(&path.parameter(), [0, first]);
    // The tolerance once more, for the points of the path between which the top is interpolated.
    assert!(below - 1e-3 <= top && top <= beyond + 1e-3, "{top}, and by load control {below} to {beyond}");
    let ends = [path.points.last().unwrap(), &stages.last().unwrap().1.report];
    let [one, other] = ends.map(|report| report.strain_energy_n_mm);
    assert!((one / other - 1.0).abs() < 1e-5, "and both end at the same equilibrium: {one} {other}");
}

/// A motion that is given passes its limit points as a force does: the curves of force over deflection are one.
#[test]
fn a_given_motion_goes_back() {
    let mut by_force = roof("hinged-roof-6.35-snap");
    by_force.mesh.elements = [4, 4];
    let mut by_motion = by_force.clone();
    by_motion.actions.clear();
    by_motion.supports.push(Support {
        name: "crown".into(),
        on: Region::Point([0.5, 0.5]),
        shell: 0,
        also: vec![],
        hold: Hold::Displacement { displacement_mm: [None, None, Some(-30.0)] },
        history: by_force.actions[0].history.clone(),
    });
    by_motion.probes = vec![Probe {
        name: "force".into(),
        shell: 0,
        kind: ProbeKind::Reaction { support: "crown".into(), component: Reaction::ForceZ },
    }];
    by_force.probes = vec![Probe {
        name: "w_c".into(),
        shell: 0,
        kind: ProbeKind::Displacement { on: [0.5, 0.5], component: Component::Z },
    }];
    by_motion.continuation = Some(ARC_LENGTH);

    let (force, motion) = (Path::of(by_force), Path::of(by_motion));
    let limits = motion.limit_points();
    assert!(limits.len() >= 2, "{:?}", motion.passed());
    let parameter = motion.parameter();
    let deflection: Vec<f64> = parameter.iter().map(|share| 30.0 * share).collect();
    let exerted: Vec<f64> = motion.probe("force").iter().map(|force| -force / 3000.0).collect();
    let (loads, w) = (force.parameter(), force.probe("w_c").iter().map(|w| -w).collect::<Vec<f64>>());
    // Every point of the one lies on the other: at its deflection some part of the other carries its force.
    let last = loads.len() - 1;
    for (at, [w_here, force_here]) in deflection.iter().zip(&exerted).map(|(w, f)| [*w, *f]).enumerate() {
        let found = force.where_is(&w, w_here, &loads, [0, last]);
        // At the turns of the deflection a force may have none of exactly this one.
        let nearest = found.iter().map(|load| (load - force_here).abs()).fold(f64::INFINITY, f64::min);
        let near_limit = limits.iter().any(|limit| at.abs_diff(*limit) <= 2);
        let first_point = w_here < w[0];
        assert!(nearest < 0.002 || near_limit || first_point, "{force_here} at {w_here} mm: {found:?}");
    }
    // The limit points of the motion are the turns of the deflection under the force.
    let top = motion.top(&deflection, [0, limits[0]]);
    let turn = (1..last).find(|at| w[*at] > w[at - 1] && w[*at] > w[at + 1]).unwrap();
    let under_force = force.top(&w, [turn - 1, turn + 1]);
    assert!((top / under_force - 1.0).abs() < 5e-3, "{top} {under_force}");
}
