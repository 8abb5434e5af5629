//! The assembled energy: its derivatives, rigid motions, the moment, and supports in every symmetry.

use std::sync::Arc;

use foldline::energy::{Discretization, Want, strain_energy};
use foldline::equilibrium::{Assembled, Configuration, Equilibrium, Workspace};
use foldline::model::starting_mesh;
use foldline::scene::{Geometry, Load, Scene, Sense, Symmetry};

use crate::support::scene;

fn small(symmetry: Symmetry, degree: [usize; 2]) -> Scene {
    let mut scene = scene("baseline.toml");
    scene.symmetry = symmetry;
    scene.mesh.degree = degree;
    scene.mesh.elements = [6, 4];
    scene
}

/// Reproducible numbers in [−1, 1].
fn noise(count: usize) -> Vec<f64> {
    let mut seed = 0x2545_f491_4f6c_dd1d_u64;
    (0..count)
        .map(|_| {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        })
        .collect()
}

fn flat(displacement: &[[f64; 3]]) -> Configuration<'_> {
    Configuration { displacement, turns: &[], parameter: 0.0, largest_force: 0.0 }
}

fn length(vector: &[f64]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Along random directions, at a deformed state with turned ends: energy → residual → stiffness, link by link, in the
/// free unknowns.
#[test]
fn residual_and_stiffness_are_derivatives_of_the_energy() {
    for (symmetry, degree) in [
        (Symmetry::None, [3, 3]),
        (Symmetry::Quarter, [3, 3]),
        (Symmetry::HalfLength, [2, 4]),
        (Symmetry::HalfArc, [5, 2]),
    ] {
        let scene = small(symmetry, degree);
        let mesh = Arc::new(starting_mesh(&scene).unwrap());
        let discretization = Discretization::new(&scene, &mesh).unwrap();
        let count = discretization.unknowns.count();
        let point: Vec<f64> = noise(count).iter().map(|x| 0.05 * x).collect();
        let placement = discretization.unknowns.configure(&point, 8.5);
        let moved = |q: &[f64]| discretization.unknowns.configure(q, 8.5).displacement();
        let direction = &noise(2 * count)[count..];
        let at = |step: f64| -> Vec<f64> { point.iter().zip(direction).map(|(q, d)| q + step * d).collect() };
        let energy = |step: f64| strain_energy(&discretization.shells[0].tables, &moved(&at(step)), None);
        let mut assembled = Assembled::new(&discretization);
        let mut gradient = |step: f64| {
            assembled.assemble(&discretization, &moved(&at(step)), 8.5, Want::Residual);
            placement.restrict(&assembled.residual)
        };
        let step = 1e-6;
        let slope = (energy(step) - energy(-step)) / (2.0 * step);
        let exact: f64 = gradient(0.0).iter().zip(direction).map(|(g, d)| g * d).sum();
        assert!((slope / exact - 1.0).abs() < 1e-6, "{symmetry:?} {degree:?}: {slope} {exact}");

        let change: Vec<f64> =
            gradient(step).iter().zip(gradient(-step)).map(|(a, b)| (a - b) / (2.0 * step)).collect();
        let mut assembled = Assembled::new(&discretization);
        assembled.assemble(&discretization, &placement.displacement(), 8.5, Want::Stiffness);
        let field = placement.velocity(direction, &[]);
        let product = placement.restrict(&assembled.multiply(&discretization, &field));
        let difference: Vec<f64> = product.iter().zip(&change).map(|(a, b)| a - b).collect();
        assert!(length(&difference) < 1e-6 * length(&product), "{symmetry:?} {degree:?}");
    }
}

/// A rigid motion of the whole shell stores no energy: strains of 1e-12 at most.
#[test]
fn rigid_motions_give_no_strain() {
    for arc_deg in [110.0, 350.0] {
        let mut scene = small(Symmetry::None, [3, 3]);
        let Geometry::TapeSpring { length_mm, radius_mm, .. } = scene.geometry else { panic!() };
        scene.geometry = Geometry::TapeSpring { length_mm, radius_mm, arc_deg };
        let mesh = Arc::new(starting_mesh(&scene).unwrap());
        let discretization = Discretization::new(&scene, &mesh).unwrap();
        let (sin, cos) = 1.1_f64.sin_cos();
        let motion = |[x, y, z]: [f64; 3]| [cos * x - sin * y + 5.0, sin * x + cos * y - 2.0, z + 1.0];
        let displacement: Vec<[f64; 3]> = mesh
            .points()
            .map(|point| {
                let moved = motion(point);
                [0, 1, 2].map(|c| moved[c] - point[c])
            })
            .collect();
        for element in 0..discretization.shells[0].tables.elements.len() {
            let strains = foldline::adapt::element_strains(&discretization.shells[0], &displacement, element);
            for strain in strains {
                // Physical strains: in units of the tangents.
                let [l1, l2] = strain.1;
                let units = [l1 * l1, l2 * l2, l1 * l2];
                for k in 0..3 {
                    assert!((strain.0.membrane[k] / units[k]).abs() < 1e-12, "{arc_deg}°: {:?}", strain.0);
                    assert!((strain.0.bending[k] / units[k]).abs() < 1e-12, "{arc_deg}°: {:?}", strain.0);
                }
            }
        }
    }
}

/// M = dΠ/dθ / 2 at fixed unknowns, and dΠ/dθ along the path, by finite differences.
#[test]
fn moment_is_the_derivative_of_the_energy_with_respect_to_the_rotation() {
    for (symmetry, sense) in
        [(Symmetry::None, Sense::Opposite), (Symmetry::Quarter, Sense::Opposite), (Symmetry::HalfArc, Sense::Equal)]
    {
        let mut scene = small(symmetry, [3, 3]);
        if let Load::EndRotation(load) = &mut scene.load {
            load.sense = sense;
        }
        scene.solver.tolerance = 1e-11;
        let mesh = Arc::new(starting_mesh(&scene).unwrap());
        let mut work = Workspace::new(&scene, &mesh).unwrap();
        let start = vec![[0.0; 3]; mesh.point_count()];
        let mut solve = |from: &[[f64; 3]], a: f64, b: f64| {
            let from = Configuration { displacement: from, turns: &[], parameter: a, largest_force: 0.0 };
            Equilibrium::new(&scene, &mut work).advance(from, b, &mut |_| false).unwrap()
        };
        let middle = solve(&start, 0.0, 1.0);
        let step = 1e-3;
        let (before, after) =
            (solve(&middle.displacement, 1.0, 1.0 - step), solve(&middle.displacement, 1.0, 1.0 + step));
        let slope = (after.balance.stored - before.balance.stored) / (2.0 * step).to_radians();
        assert!((0.5 * slope / middle.moment - 1.0).abs() < 1e-7, "{symmetry:?}: {} {}", 0.5 * slope, middle.moment);
    }
}

/// The parts of the shell agree with the whole on one mesh: the spaces differ only in how the end's second row is tied
/// at the plane of symmetry.
#[test]
fn symmetric_parts_agree_with_the_whole() {
    let moment = |symmetry| {
        let mut scene = small(symmetry, [3, 3]);
        scene.mesh.elements = [16, 8];
        let mesh = Arc::new(starting_mesh(&scene).unwrap());
        let mut work = Workspace::new(&scene, &mesh).unwrap();
        let start = vec![[0.0; 3]; mesh.point_count()];
        let solved = Equilibrium::new(&scene, &mut work).advance(flat(&start), 2.0, &mut |_| false).unwrap();
        solved.moment
    };
    let whole = moment(Symmetry::None);
    for part in [Symmetry::HalfLength, Symmetry::HalfArc, Symmetry::Quarter] {
        let share = moment(part) / whole - 1.0;
        assert!(share.abs() < 1e-3, "{part:?}: {share}");
    }
}

/// Arcs of several segments: the joints are tied, so the stiffness of the section is that of the closed form.
#[test]
fn wide_arcs_have_the_closed_form_stiffness() {
    for arc_deg in [80.0_f64, 160.0, 250.0, 350.0] {
        let mut scene = small(Symmetry::Quarter, [3, 3]);
        scene.geometry = Geometry::TapeSpring { length_mm: 300.0, radius_mm: 10.0, arc_deg };
        scene.mesh.elements = [16, 16];
        let mesh = Arc::new(starting_mesh(&scene).unwrap());
        let mut work = Workspace::new(&scene, &mesh).unwrap();
        let start = vec![[0.0; 3]; mesh.point_count()];
        let solved = Equilibrium::new(&scene, &mut work).advance(flat(&start), 0.001, &mut |_| false).unwrap();
        let arc = arc_deg.to_radians();
        let inertia = 100.0 * ((arc + arc.sin()) / 2.0 - 4.0 * (arc / 2.0).sin().powi(2) / arc);
        let exact = 2.0 * 131000.0 * inertia / 300.0;
        let share = solved.moment / 0.001_f64.to_radians() / exact - 1.0;
        // The rigid ends hold the section's shape, so the shell is a little stiffer than the beam; never softer.
        assert!((-0.001..0.01).contains(&share), "{arc_deg}°: {:.3} %", 100.0 * share);
    }
}
