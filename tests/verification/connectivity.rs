//! Patches that share control points, assembled into one matrix.

use foldline::energy::{Discretization, ShellElements, Want};
use foldline::equilibrium::Assembled;
use foldline::model::{BlockPattern, Blocks, Tables, starting_patch};
use foldline::scene::{Quadrature, Scene};
use foldline::spline::Patch;
use std::sync::Arc;

use crate::support::scene;

/// A tape spring with a knot of full multiplicity at half its length: what two patches that share a row are as well.
fn creased() -> (Scene, Patch) {
    let mut scene = scene("baseline.toml");
    scene.mesh.quadrature = Quadrature::Full;
    scene.mesh.elements = [6, 4];
    let mesh = starting_patch(&scene).unwrap();
    let again = mesh.degree[0] - mesh.knots[0].iter().filter(|knot| **knot == 0.5).count();
    (scene, mesh.with_knots(&[vec![0.5; again], vec![]]))
}

/// The part of a mesh before or beyond u = 1/2, and its first row of control points.
fn half(mesh: &Patch, beyond: bool) -> (Patch, usize) {
    let degree = mesh.degree[0];
    let mut along: Vec<f64> =
        mesh.knots[0].iter().copied().filter(|knot| *knot == 0.5 || (*knot > 0.5) == beyond).collect();
    along.insert(if beyond { 0 } else { along.len() }, 0.5);
    let rows = along.len() - degree - 1;
    let first = if beyond { mesh.control_counts()[0] - rows } else { 0 };
    let control_points = (first..first + rows).flat_map(|row| mesh.grid().line(0, row));
    let control_points = control_points.map(|point| mesh.control_points[point]).collect();
    (Patch { degree: mesh.degree, knots: [along, mesh.knots[1].clone()], control_points }, first)
}

#[test]
fn two_patches_that_share_a_row_are_one() {
    let (scene, mesh) = creased();
    let count = mesh.control_points.len();
    let displacement: Vec<[f64; 3]> = (0..count)
        .map(|i| [0, 1, 2].map(|c| 0.05 * (((3 * i + c + 1) as f64 * 0.732_050_807_57).fract() - 0.5)))
        .collect();

    let whole = Discretization::new(&scene, &Arc::new(mesh.clone().into())).unwrap();
    let mut expected = Assembled::new(&whole);
    expected.assemble(&whole, &displacement, 0.0, Want::Stiffness);

    // Also with control points numbered the other way round, so that numbers fall within the elements.
    for reversed in [false, true] {
        let number = |k: usize| if reversed { count - 1 - k } else { k };
        let tables = [false, true].map(|beyond| {
            let (part, first) = half(&mesh, beyond);
            let numbers: Vec<usize> =
                (0..part.control_points.len()).map(|k| number(mesh.grid().index([first, 0]) + k)).collect();
            let tables = Tables::new(&scene, &part);
            Tables { connectivity: tables.connectivity.renumbered(count, &numbers), ..tables }
        });
        let blocks = BlockPattern::new(&tables.each_ref().map(|tables| &tables.connectivity), &[]);
        let numbered =
            |field: &dyn Fn(usize) -> [f64; 3]| -> Vec<[f64; 3]> { (0..count).map(|k| field(number(k))).collect() };
        let moved = numbered(&|k| displacement[k]);
        let (mut residual, mut stiffness) = (vec![[0.0; 3]; count], Blocks::zeros(&blocks));
        let sums = [0, 1].map(|part| {
            let part = ShellElements { tables: &tables[part], blocks: &blocks, part, natural: None };
            part.add(&moved, Want::Stiffness, &mut residual, &mut stiffness)
        });
        let energy = sums[0].energy + sums[1].energy;

        assert!((energy / expected.energy - 1.0).abs() < 1e-12, "{energy} {}", expected.energy);
        let close = |found: &[[f64; 3]], expected: &[[f64; 3]]| {
            let scale = expected.iter().flatten().fold(0.0_f64, |most, value| most.max(value.abs()));
            let found = numbered(&|k| found[k]);
            let pairs = found.iter().zip(expected).flat_map(|(a, b)| [0, 1, 2].map(|c| (a[c] - b[c]).abs()));
            assert!(pairs.fold(0.0, f64::max) < 1e-12 * scale);
        };
        close(&residual, &expected.residual);
        let field: Vec<[f64; 3]> = (0..count).map(|k| displacement[(7 * k + 3) % count]).collect();
        let product = stiffness.multiply(&blocks, 1.0, &numbered(&|k| field[k]));
        close(&product, &expected.multiply(&whole, &field));
    }
}
