//! A square cross-ply plate [0/90], cured flat and cooled: a saddle while it is small, and two cylinders once it is large.

use foldline::adapt::element_strains;
use foldline::energy::Discretization;
use foldline::record::Record;
use foldline::scene::{Geometry, Load, Scene, Stage};
use foldline::state::State;

use crate::support::{run, scene, steps};

/// Side of the plates that are followed by arc length, and thickness of each of the two plies, mm.
const SIDE: f64 = 100.0;
const PLY: f64 = 0.125;

/// Curvatures of the cylinder, M₁*/D₁₁*, and of the saddle, M₁*/(D₁₁* − D₁₂*), of the coupled laminate without membrane
/// forces: D* = D − B A⁻¹ B and M* = M_T − B A⁻¹ N_T of classical lamination theory, with two equal plies written out.
fn closed_form() -> [f64; 2] {
    let (e1, e2, nu, expansion, change) = (181e3, 10.3e3, 0.28, [0.02e-6, 22.5e-6], -150.0);
    let scale = 1.0 / (1.0 - nu * nu * e2 / e1);
    let [q11, q22, q12] = [scale * e1, scale * e2, scale * nu * e2];
    let along = (q11 * expansion[0] + q12 * expansion[1]) * change;
    let across = (q12 * expansion[0] + q22 * expansion[1]) * change;
    let [a11, a12] = [(q11 + q22) * PLY, 2.0 * q12 * PLY];
    let [d11, d12] = [(q11 + q22) * PLY.powi(3) / 3.0, 2.0 * q12 * PLY.powi(3) / 3.0];
    let b = (q22 - q11) * PLY * PLY / 2.0;
    let moment = (across - along) * PLY * PLY / 2.0 - b * (along + across) * PLY / (a11 + a12);
    let determinant = a11 * a11 - a12 * a12;
    let [d11, d12] = [d11 - b * b * a11 / determinant, d12 - b * b * a12 / determinant];
    [moment / d11, moment / (d11 - d12)]
}

/// κ₁₁ and κ₂₂ at the quadrature points of the elements that are at least this far from all edges.
fn curvatures(scene: &Scene, state: &State, margin: f64) -> Vec<[f64; 2]> {
    let discretization = Discretization::new(scene, &state.mesh).unwrap();
    let elements = discretization.shells[0].tables.elements;
    let Geometry::Plate { length_mm, .. } = scene.geometry else { panic!() };
    let inside = |index: usize, count: usize| {
        let size = length_mm / count as f64;
        index as f64 * size >= margin && (count - 1 - index) as f64 * size >= margin
    };
    (0..elements.len())
        .filter(|element| (0..2).all(|way| inside(elements.place(*element)[way], elements.counts[way])))
        .flat_map(|element| element_strains(&discretization.shells[0], &state.displacement, element))
        .map(|(strains, lengths)| [0, 1].map(|axis| strains.bending[axis] / (lengths[axis] * lengths[axis])))
        .collect()
}

fn with_side(mut scene: Scene, side: f64, elements: usize) -> Scene {
    scene.geometry = Geometry::Plate { length_mm: side, width_mm: side };
    scene.mesh.elements = [elements; 2];
    scene
}

fn mean(values: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|axis| values.iter().map(|value| value[axis]).sum::<f64>() / values.len() as f64)
}

#[test]
fn a_small_plate_is_a_saddle() {
    let scene = with_side(scene("verification/cured-plate.toml"), 5.0, 4);
    let stages = run(scene.clone());
    let [_, saddle] = closed_form();
    let (state, record) = stages.last().unwrap();
    assert_eq!(state.negative_pivots, 0);
    assert!(stages.iter().all(|(_, record)| !record.report.jumped && record.report.stage == Stage::Solve));
    let [k1, k2] = mean(&curvatures(&scene, state, 0.0));
    assert!((k1 / saddle - 1.0).abs() < 0.01 && (k2 / saddle + 1.0).abs() < 0.01, "{k1} {k2}, linear {saddle}");
    // What the layers keep in each other is stored, whatever the shape.
    assert!(record.report.strain_energy_n_mm > 0.0);
}

#[test]
fn a_large_plate_is_a_cylinder() {
    let scene = scene("verification/cured-plate.toml");
    let stages = run(scene.clone());
    let (state, _) = stages.last().unwrap();
    assert_eq!(state.negative_pivots, 0);
    let [cylinder, _] = closed_form();
    let edge_layer = (2.0 * PLY / cylinder.abs()).sqrt();
    let inside = curvatures(&scene, state, 4.0 * edge_layer);
    assert!(inside.len() > 100);
    // By symmetry, along x or along y.
    let along_x = inside[0][0].abs() > inside[0][1].abs();
    for [k1, k2] in inside {
        let [bent, straight] = if along_x { [k1, k2] } else { [-k2, k1] };
        assert!((bent / cylinder - 1.0).abs() < 0.02, "{bent} for {cylinder}");
        assert!(straight.abs() < 0.02 * cylinder.abs(), "{straight}");
    }
}

/// The path of the saddle continues beyond its bifurcation, which lies at a temperature that goes with the inverse square of
/// the side (von Kármán's equations know curvature · side²/thickness alone).
#[test]
fn the_saddle_goes_on_unstable() {
    let at = |side: f64| {
        let mut scene = with_side(scene("verification/cured-plate-saddle.toml"), side, 12);
        let Load::Steps(load) = &mut scene.load else { panic!() };
        load.increment *= (SIDE / side).powi(2);
        let stages = run(scene.clone());
        let found = stages.iter().find_map(|(state, record)| record.report.critical_point.map(|point| (state, point)));
        let (state, critical) = found.unwrap();
        assert_eq!((critical.limit_point, critical.pivots_changed), (false, 1));
        let (last, _) = stages.last().unwrap();
        assert!(last.parameter == 1.0 && last.negative_pivots > 0);
        let [k1, k2] = mean(&curvatures(&scene, last, 0.0));
        assert!((k1 + k2).abs() < 1e-3 * k1.abs(), "{k1} {k2}");
        state.parameter
    };
    let [large, half] = [SIDE, 0.5 * SIDE].map(at);
    assert!((half / large / 4.0 - 1.0).abs() < 0.01, "{half} {large}");
}

/// Where the load is stepped, the shell leaves the saddle at the bifurcation.
#[test]
fn steps_of_temperature_leave_the_saddle_where_it_turns_unstable() {
    let mut by_steps = with_side(scene("verification/cured-plate.toml"), SIDE, 12);
    by_steps.load.set_target(0.07);
    let Load::Steps(load) = &mut by_steps.load else { panic!() };
    load.increment = 0.02;
    let stages = run(by_steps);
    let [mut last_saddle, mut first_bent] = [0.0, f64::INFINITY];
    for (state, record) in steps(&stages) {
        let middle = record.report.probes[0].value.abs();
        if middle < 1e-3 {
            last_saddle = state.parameter;
        } else {
            first_bent = f64::min(first_bent, state.parameter);
        }
    }
    let mut by_path = with_side(scene("verification/cured-plate-saddle.toml"), SIDE, 12);
    by_path.load.set_target(0.07);
    let path = run(by_path);
    let critical = path.iter().find(|(_, record)| record.report.critical_point.is_some()).unwrap().0.parameter;
    assert!(last_saddle < critical * 1.05 && critical < first_bent * 1.001, "{last_saddle} {critical} {first_bent}");
}

/// From the cylinder along x, over two limit points and unstable shapes, into the cylinder along y.
#[test]
fn one_cylinder_snaps_into_the_other_by_arc_length() {
    let mut scene = scene("verification/cured-plate-snap.toml");
    scene.mesh.elements = [10; 2];
    let stages = run(scene.clone());
    let [cylinder, _] = closed_form();
    let points: Vec<&(State, Record)> = steps(&stages);
    let limits: Vec<f64> = points
        .iter()
        .filter(|(_, record)| record.report.critical_point.is_some_and(|critical| critical.limit_point))
        .map(|(state, _)| state.parameter)
        .collect();
    println!("limit points at {limits:?}");
    // Up to a force that pushes up, and back to one that pushes down.
    assert!(limits.len() >= 2 && limits[0] > 2.0 && limits.iter().any(|limit| *limit < 2.0), "{limits:?}");
    assert!(points.iter().any(|(state, _)| state.negative_pivots > 0));
    let (cured, _) = points.iter().find(|(state, _)| state.parameter == 1.0).unwrap();
    let (last, _) = points.last().unwrap();
    assert_eq!((cured.negative_pivots, last.negative_pivots, last.parameter), (0, 0, 4.0));
    let [k1, k2] = mean(&curvatures(&scene, cured, 20.0));
    assert!(k1 / cylinder > 0.9 && k2.abs() < 0.1 * k1.abs(), "{k1} {k2}");
    let [k1, k2] = mean(&curvatures(&scene, last, 20.0));
    assert!((-k2 / cylinder - 1.0).abs() < 0.02 && k1.abs() < 0.02 * k2.abs(), "{k1} {k2}");
}
