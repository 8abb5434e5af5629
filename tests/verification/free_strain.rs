//! Offset surfaces, changes of temperature and of natural curvature against closed forms.

use std::f64::consts::PI;
use std::sync::Arc;

use foldline::energy::{Discretization, Want, strain_energy};
use foldline::equilibrium::Assembled;
use foldline::model::starting_mesh;
use foldline::record::Report;
use foldline::scene::{Scene, parse};

use crate::support::run;

fn scene(text: &str) -> Scene {
    parse(text, "test.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// The report of the last equilibrium, of which nothing is to be said: where a shell takes its natural shape, its strain energy
/// is rounding, and so is what halving the elements changes of it.
fn end_of(text: &str) -> Report {
    let report = run(scene(text)).pop().unwrap().1.report;
    assert_eq!(report.warnings, []);
    report
}

fn probe(report: &Report, name: &str) -> f64 {
    report.probes.iter().find(|probe| probe.name == name).unwrap_or_else(|| panic!("no probe {name}")).value
}

fn near(found: f64, exact: f64, tolerance: f64) {
    assert!((found / exact - 1.0).abs() < tolerance, "{found} for {exact}: {:.2e}", found / exact - 1.0);
}

/// A strip along x, clamped at x = 0, with probes at the other end.
fn strip(length: f64, width: f64, material: &str, rest: &str) -> String {
    format!(
        "[geometry]\nkind = \"plate\"\nlength_mm = {length:?}\nwidth_mm = {width:?}\n[material]\n{material}\n\
         [mesh]\nelements = [24, 2]\n[load]\nkind = \"steps\"\nincrement = 0.25\n\
         [[support]]\nname = \"root\"\non = \"u-start\"\nkind = \"clamped\"\n{rest}\n{}{}{}",
        displacement("u", [1.0, 0.5], "x"),
        displacement("v", [1.0, 1.0], "y"),
        displacement("w", [1.0, 0.5], "z"),
    )
}

fn displacement(name: &str, on: [f64; 2], component: &str) -> String {
    format!("[[probe]]\nname = \"{name}\"\nkind = \"displacement\"\non = {on:?}\ncomponent = \"{component}\"\n")
}

/// Three corners of a plate, which hold no deformation.
const THREE_CORNERS: &str = "
[[support]]
name = \"corner\"
on = [0.0, 0.0]
kind = \"hinged\"
[[support]]
name = \"corner along x\"
on = [1.0, 0.0]
kind = \"fixed\"
hold = [\"y\", \"z\"]
[[support]]
name = \"corner along y\"
on = [0.0, 1.0]
kind = \"fixed\"
hold = [\"z\"]
";

/// Isotropic layers without lateral strain, so that a strip of them is a beam.
const BEAM_LAYER: &str = "poissons_ratio_12 = 0.0\nshear_modulus_12_mpa = 30000.0\nyoungs_modulus_2_mpa = 70000.0\n\
                          thermal_expansion_2_per_k = 0.0";

/// Where the end of a strip of this length is that is bent to an arc of a circle: along it, and up.
fn arc(curvature: f64, length: f64) -> [f64; 2] {
    let angle = curvature * length;
    [angle.sin() / curvature, (1.0 - angle.cos()) / curvature]
}

/// Energy, gradient and stiffness of a whole model under free strains agree, as in [`super::assembly`].
#[test]
fn gradient_and_stiffness_are_derivatives_under_free_strain() {
    let scene = scene(
        "[geometry]\nkind = \"cylinder-panel\"\nlength_mm = 10.0\nradius_mm = 8.0\narc_deg = 60.0\n\
         [material]\nkind = \"laminate\"\noffset_mm = 0.1\nyoungs_modulus_1_mpa = 140e3\nyoungs_modulus_2_mpa = 10e3\n\
         poissons_ratio_12 = 0.3\nshear_modulus_12_mpa = 5e3\nthermal_expansion_1_per_k = 1e-6\n\
         thermal_expansion_2_per_k = 30e-6\n[[ply]]\nthickness_mm = 0.2\nangle_deg = 20.0\n\
         [[ply]]\nthickness_mm = 0.3\nangle_deg = -50.0\n\
         [mesh]\nelements = [3, 4]\n[load]\nkind = \"steps\"\nincrement = 1.0\n\
         [[support]]\non = \"u-start\"\nkind = \"clamped\"\n\
         [[action]]\nkind = \"temperature\"\nchange_k = -500.0\n\
         [[action]]\nkind = \"natural-curvature\"\nchange_per_mm = [0.02, -0.05, 0.01]\n",
    );
    let mesh = Arc::new(starting_mesh(&scene).unwrap());
    let discretization = Discretization::new(&scene, &mesh).unwrap();
    let noise = |count: usize, seed: usize| -> Vec<f64> {
        (0..count).map(|i| ((i * 7919 + seed * 104_729) % 1013) as f64 / 1013.0 - 0.5).collect()
    };
    let (count, parameter) = (discretization.unknowns.count(), 0.7);
    let (point, direction) = (noise(count, 1), noise(count, 2));
    let at = |step: f64| {
        let free: Vec<f64> = point.iter().zip(&direction).map(|(q, d)| 0.1 * q + step * d).collect();
        discretization.unknowns.configure(&free, parameter).displacement()
    };
    let placement = discretization.unknowns.configure(&point, parameter);
    let natural = discretization.shells[0].free_strains.at(parameter);
    let energy = |step: f64| strain_energy(&discretization.shells[0].tables, &at(step), natural);
    let mut assembled = Assembled::new(&discretization);
    let mut gradient = |step: f64| {
        assembled.assemble(&discretization, &at(step), parameter, Want::Residual);
        placement.restrict(&assembled.residual)
    };
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let step = 1e-6;
    near((energy(step) - energy(-step)) / (2.0 * step), product(&gradient(0.0), &direction), 1e-6);
    let change: Vec<f64> = gradient(step).iter().zip(gradient(-step)).map(|(a, b)| (a - b) / (2.0 * step)).collect();
    assembled.assemble(&discretization, &at(0.0), parameter, Want::Stiffness);
    let stiff = placement.restrict(&assembled.multiply(&discretization, &placement.velocity(&direction, &[])));
    let off: Vec<f64> = stiff.iter().zip(&change).map(|(a, b)| a - b).collect();
    assert!(product(&off, &off).sqrt() < 1e-6 * product(&stiff, &stiff).sqrt());
}

/// A free plate that is heated grows without stress, whatever surface it is seen from.
#[test]
fn a_free_plate_expands() {
    for offset in [0.0, 0.4] {
        let report = end_of(&format!(
            "[geometry]\nkind = \"plate\"\nlength_mm = 40.0\nwidth_mm = 20.0\n[material]\nkind = \"isotropic\"\n\
             youngs_modulus_mpa = 70e3\npoissons_ratio = 0.3\nthickness_mm = 0.8\noffset_mm = {offset:?}\n\
             thermal_expansion_per_k = 23e-6\n[mesh]\nelements = [4, 3]\n[load]\nkind = \"steps\"\nincrement = 0.5\n\
             {THREE_CORNERS}[[action]]\nkind = \"temperature\"\nchange_k = 100.0\n{}{}\
             [[probe]]\nname = \"reaction\"\nkind = \"reaction\"\nsupport = \"corner\"\ncomponent = \"force-x\"\n",
            displacement("u", [1.0, 1.0], "x"),
            displacement("v", [1.0, 1.0], "y"),
        ));
        // The square of the stretch is 1 + 2 α ΔT.
        let stretch = (1.0 + 2.0 * 23e-6 * 100.0_f64).sqrt() - 1.0;
        near(probe(&report, "u"), 40.0 * stretch, 1e-6);
        near(probe(&report, "v"), 20.0 * stretch, 1e-6);
        // What a plate that is held stores, and what it pushes with.
        let held = 70e3 / 0.7 * (23e-6 * 100.0_f64).powi(2) * 0.8 * 800.0;
        let force = 70e3 / 0.7 * 23e-6 * 100.0 * 0.8 * 20.0;
        assert!(report.strain_energy_n_mm.abs() < 1e-12 * held, "{}", report.strain_energy_n_mm);
        assert!(probe(&report, "reaction").abs() < 1e-9 * force, "{}", probe(&report, "reaction"));
        assert!(!report.jumped && report.energy_released_n_mm == Some(0.0));
    }
}

/// A half cylinder that is heated grows and keeps its shape: all lengths by the same share.
#[test]
fn a_free_half_cylinder_keeps_its_shape() {
    let report = end_of(&format!(
        "[geometry]\nkind = \"cylinder-panel\"\nlength_mm = 30.0\nradius_mm = 20.0\narc_deg = 180.0\n\
         [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70e3\npoissons_ratio = 0.3\nthickness_mm = 0.2\n\
         thermal_expansion_per_k = 1e-6\n[mesh]\nelements = [3, 12]\n[load]\nkind = \"steps\"\nincrement = 1.0\n\
         [[support]]\non = \"v-start\"\nkind = \"symmetric\"\n[[support]]\non = \"v-end\"\nkind = \"symmetric\"\n\
         [[support]]\non = \"u-start\"\nkind = \"symmetric\"\n\
         [[support]]\non = [0.0, 0.5]\nkind = \"fixed\"\nhold = [\"y\"]\n\
         [[action]]\nkind = \"temperature\"\nchange_k = 10.0\n{}{}{}",
        displacement("length", [1.0, 0.5], "x"),
        displacement("top", [1.0, 0.5], "z"),
        displacement("side", [1.0, 1.0], "y"),
    ));
    near(probe(&report, "length"), 30.0 * 1e-5, 1e-4);
    near(probe(&report, "top"), 20.0 * 1e-5, 1e-4);
    near(probe(&report, "side"), 20.0 * 1e-5, 1e-4);
}

/// A bar between walls pushes with E α ΔT t for each unit of width.
#[test]
fn a_bar_between_walls_pushes() {
    let material = "kind = \"isotropic\"\nyoungs_modulus_mpa = 70e3\npoissons_ratio = 0.3\nthickness_mm = 1.0\n\
                    thermal_expansion_per_k = 23e-6";
    let report = end_of(&format!(
        "[geometry]\nkind = \"plate\"\nlength_mm = 30.0\nwidth_mm = 10.0\n[material]\n{material}\n\
         [mesh]\nelements = [6, 2]\n[load]\nkind = \"steps\"\nincrement = 0.5\n\
         [[support]]\nname = \"wall\"\non = \"u-start\"\nkind = \"fixed\"\nhold = [\"x\", \"z\"]\n\
         [[support]]\non = \"u-end\"\nkind = \"fixed\"\nhold = [\"x\", \"z\"]\n\
         [[support]]\non = [0.0, 0.5]\nkind = \"fixed\"\nhold = [\"y\"]\n\
         [[action]]\nkind = \"temperature\"\nchange_k = 1.0\n\
         [[probe]]\nname = \"push\"\nkind = \"reaction\"\nsupport = \"wall\"\ncomponent = \"force-x\"\n"
    ));
    near(probe(&report, "push"), 70e3 * 23e-6 * 10.0, 1e-6);
}

/// Timoshenko 1925, *Analysis of bi-metal thermostats*, eq. 4: with m and n the ratios of thickness and modulus,
/// k h = 6 (α₂ − α₁) ΔT (1 + m)² / (3 (1 + m)² + (1 + m n)(m² + 1/(m n))).
#[test]
fn a_bimetal_strip_curls() {
    let (m, n, thickness) = (0.5, 1.0 / 3.0, 0.03);
    let [lower, upper] = [thickness * m / (1.0 + m), thickness / (1.0 + m)];
    let change = 2e-5 * 20.0;
    let curvature = 6.0 * change * (1.0_f64 + m).powi(2)
        / (thickness * (3.0 * (1.0_f64 + m).powi(2) + (1.0 + m * n) * (m * m + 1.0 / (m * n))));
    for offset in [0.0, 0.015] {
        let material = format!(
            "kind = \"laminate\"\noffset_mm = {offset:?}\nyoungs_modulus_1_mpa = 210e3\nthermal_expansion_1_per_k = 0.0\n\
             {BEAM_LAYER}\n[[ply]]\nthickness_mm = {lower:?}\nyoungs_modulus_1_mpa = 70e3\n\
             thermal_expansion_1_per_k = 2e-5\n[[ply]]\nthickness_mm = {upper:?}"
        );
        let action = "[[action]]\nkind = \"temperature\"\nchange_k = 20.0\n";
        let report = end_of(&strip(60.0, 4.0, &material, action));
        // The lower layer gets longer: the strip bends up, by 0.77 radians.
        let [along, up] = arc(curvature, 60.0);
        let off = (probe(&report, "u") - (along - 60.0)).hypot(probe(&report, "w") - up);
        assert!(curvature * 60.0 > 0.7 && off < 1e-3 * 60.0, "offset {offset}: {off}");
        assert!(!report.jumped);
    }
}

/// A flat strip that is naturally a circle rolls up, and stores nothing once it has.
#[test]
fn a_strip_rolls_to_its_natural_circle() {
    let material = "kind = \"isotropic\"\nyoungs_modulus_mpa = 70e3\npoissons_ratio = 0.3\nthickness_mm = 0.1";
    let curvature = -1.8 * PI / 60.0;
    let action = format!("[[action]]\nkind = \"natural-curvature\"\nchange_per_mm = [{curvature:?}, 0.0, 0.0]\n");
    let report = end_of(&strip(60.0, 4.0, material, &action));
    let [along, up] = arc(-curvature, 60.0);
    let off = (probe(&report, "u") - (along - 60.0)).hypot(probe(&report, "w") - up);
    assert!(off < 1e-3 * 60.0, "{off}");
    let flat = 0.5 * 70e3 * 1e-3 / (12.0 * 0.91) * curvature * curvature * 240.0;
    assert!(report.strain_energy_n_mm < 1e-4 * flat, "{} of {flat}", report.strain_energy_n_mm);
    assert!(!report.jumped, "{:?}", report.energy_released_n_mm);
}

/// A force at the end of a strip acts on the surface of the geometry: with its lever arm about the middle.
#[test]
fn an_eccentric_force_bends() {
    for (offset, force) in [(0.5, 1e-3), (-0.3, 1e-3)] {
        let material = format!(
            "kind = \"isotropic\"\nyoungs_modulus_mpa = 70e3\npoissons_ratio = 0.0\nthickness_mm = 1.0\noffset_mm = {offset:?}"
        );
        let action =
            format!("[[action]]\nkind = \"line-force\"\non = \"u-end\"\nforce_n_per_mm = [{force:?}, 0.0, 0.0]\n");
        let report = end_of(&strip(60.0, 4.0, &material, &action));
        near(probe(&report, "w"), -0.5 * force * offset * 3600.0 / (70e3 / 12.0), 1e-3);
        // Stretched at the middle, and by the turn of the end.
        let stretch = force * 60.0 / 70e3 + offset * force * offset * 60.0 / (70e3 / 12.0);
        near(probe(&report, "u"), stretch, 1e-2);
    }
}

/// A laminate under transverse load bends alike whatever surface of it is drawn, to the error of the mesh at its edges.
#[test]
fn the_surface_drawn_does_not_matter() {
    let ends = [0.0, 0.25, -0.5].map(|offset| {
        let material = format!(
            "kind = \"laminate\"\noffset_mm = {offset:?}\nyoungs_modulus_1_mpa = 140e3\nyoungs_modulus_2_mpa = 10e3\n\
             poissons_ratio_12 = 0.3\nshear_modulus_12_mpa = 5e3\n[[ply]]\nthickness_mm = 0.5\nangle_deg = 30.0\n\
             [[ply]]\nthickness_mm = 0.5\nangle_deg = -60.0"
        );
        let action = "[[action]]\nkind = \"line-force\"\non = \"u-end\"\nforce_n_per_mm = [0.0, 0.0, 1e-4]\n";
        let report = end_of(&strip(40.0, 10.0, &material, action).replace("[24, 2]", "[24, 8]"));
        [probe(&report, "w"), report.strain_energy_n_mm]
    });
    for [deflection, energy] in &ends[1..] {
        near(*deflection, ends[0][0], 1e-3);
        near(*energy, ends[0][1], 1e-3);
    }
}
