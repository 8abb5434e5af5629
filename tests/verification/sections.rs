//! What hangs on rigid sections: springs and point masses.

use std::sync::Arc;

use foldline::energy::{At, Discretization, Tangent, Term};
use foldline::equilibrium::{Configuration, Workspace, linear_buckling};
use foldline::model::starting_mesh;
use foldline::pipeline::Stages;
use foldline::record::Report;
use foldline::scene::{Scene, parse};
use foldline::state::State;

use crate::support::{reading, run};

/// Length of the strip, mm.
const L: f64 = 100.0;
/// Bending stiffness of the strip, 10 mm wide and 1 mm thick, N·mm².
const EI: f64 = 175_000.0;

/// A strip along x without Poisson's effect, and what is said of it.
fn strip(rest: &str) -> Scene {
    let text = format!(
        "[geometry]\nkind = \"plate\"\nlength_mm = 100.0\nwidth_mm = 10.0\n\
         [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 210000.0\npoissons_ratio = 0.0\nthickness_mm = 1.0\ndensity_kg_m3 = 1e-6\n\
         [mesh]\ndegree = [4, 2]\nelements = [8, 1]\n[load]\nkind = \"steps\"\nfactor = 1.0\nincrement = 0.25\n{rest}"
    );
    parse(&text, "strip.toml").unwrap_or_else(|error| panic!("{error}"))
}

fn end(scene: Scene) -> (State, Report) {
    let (state, record) = run(scene).pop().unwrap();
    (state, record.report)
}

fn is_near(found: f64, expected: f64, share: f64) {
    assert!((found / expected - 1.0).abs() < share, "{found} against {expected}");
}

/// Forces are derivatives of energies and tangents of forces, at a curved edge and at a straight one, also where the control points do
/// not move as a rigid body.
#[test]
fn springs_and_weights_are_consistent() {
    let panel = "[geometry]\nkind = \"cylinder-panel\"\nlength_mm = 10.0\nradius_mm = 8.0\narc_deg = 60.0\n\
                 [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70e3\npoissons_ratio = 0.3\nthickness_mm = 0.4\n\
                 [mesh]\nelements = [3, 4]\n[load]\nkind = \"steps\"\nincrement = 1.0\n[[support]]\nname = \"root\"\non = \"u-start\"\nkind = \"clamped\"\n";
    for edge in ["u-end", "v-end"] {
        let root =
            if edge == "u-end" { "" } else { "[[support]]\nname = \"side\"\non = \"v-start\"\nkind = \"hinged\"\n" };
        let head = match edge {
            "u-end" => panel.to_owned(),
            _ => panel.replace("on = \"u-start\"\nkind = \"clamped\"", "on = [0.0, 0.5]\nkind = \"hinged\""),
        };
        let text = format!(
            "{head}{root}[[support]]\nname = \"tip\"\nkind = \"rigid\"\non = \"{edge}\"\nx_mm = \"free\"\ny_mm = \"free\"\nz_mm = \"free\"\n\
             rotation_x_deg = \"free\"\nrotation_y_deg = \"free\"\nrotation_z_deg = \"free\"\nreference_mm = [12.0, 3.0, 9.0]\n\
             [[spring]]\nname = \"spring\"\nsection = \"tip\"\ntranslation_n_per_mm = [3.0, 2.0, 5.0]\nrotation_n_mm_per_deg = [4.0, 1.0, 2.0]\n\
             [[mass]]\nname = \"mass\"\nsection = \"tip\"\nmass_kg = 0.5\nat_mm = [14.0, 1.0, 6.0]\n\
             [[action]]\nkind = \"gravity\"\nacceleration_m_s2 = [1.0, -2.0, -9.0]\n"
        );
        let scene = parse(&text, "panel.toml").unwrap_or_else(|error| panic!("{error}"));
        let discretization = Discretization::new(&scene, &Arc::new(starting_mesh(&scene).unwrap())).unwrap();
        let hung: Vec<&dyn Term> = discretization.terms.iter().filter(|term| term.has_tangent()).collect();
        assert_eq!(hung.len(), 2, "a spring and a weight");
        hung.into_iter().for_each(|term| is_consistent(&discretization, term));
    }
}

fn is_consistent(discretization: &Discretization, term: &dyn Term) {
    let mesh = &*discretization.mesh;
    let field = |seed: f64| -> Vec<[f64; 3]> {
        let value = |i: usize| 0.4 * (((i + 1) as f64 * seed).fract() - 0.5);
        (0..mesh.point_count()).map(|i| [0, 1, 2].map(|c| value(3 * i + c))).collect()
    };
    let (shape, way) = (field(0.618_033_988_75), field(0.732_050_807_57));
    let moved = |step: f64| -> Vec<[f64; 3]> {
        shape.iter().zip(&way).map(|(u, d)| [0, 1, 2].map(|c| u[c] + step * d[c])).collect()
    };
    let step = 1e-5;
    let [plus, here, minus] = [step, 0.0, -step].map(moved);
    let at = |displacement| At { mesh, displacement, parameter: 0.7 };
    let forces = |displacement| {
        let mut forces = vec![[0.0; 3]; mesh.point_count()];
        term.add_forces(at(displacement), &mut forces);
        forces
    };
    let product = |a: &[[f64; 3]], b: &[[f64; 3]]| -> f64 {
        a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| a * b).sum()
    };
    let stored = term.factors(0.7).is_empty();
    let change = match stored {
        true => term.energy(at(&minus)) - term.energy(at(&plus)),
        false => 0.7 * term.strokes(mesh, &minus, &plus)[0],
    };
    is_near(change / (2.0 * step), product(&forces(&here), &way), 1e-7);
    let [stiffness, _] = Tangent::of(term, at(&here), &discretization.blocks);
    let found = stiffness.multiply(&discretization.blocks, 1.0, &way);
    let (after, before) = (forces(&plus), forces(&minus));
    let exact: Vec<[f64; 3]> =
        after.iter().zip(&before).map(|(a, b)| [0, 1, 2].map(|c| (b[c] - a[c]) / (2.0 * step))).collect();
    let size = exact.as_flattened().iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    assert!(size > 0.0);
    for (found, exact) in found.as_flattened().iter().zip(exact.as_flattened()) {
        assert!((found - exact).abs() < 1e-6 * size, "{found} {exact}");
    }
}

/// A cantilever whose tip stands on a spring as stiff as itself bends half as far: δ = F/(3EI/L³ + k).
#[test]
fn a_spring_under_the_tip_carries_its_share() {
    let k = 3.0 * EI / L.powi(3);
    let (_, report) = end(strip(&format!(
        "[[support]]\nname = \"root\"\nkind = \"clamped\"\non = \"u-start\"\n\
         [[support]]\nname = \"tip\"\nkind = \"rigid\"\non = \"u-end\"\nx_mm = \"free\"\nz_mm = \"free\"\nrotation_y_deg = \"free\"\n\
         [[spring]]\nname = \"prop\"\nsection = \"tip\"\ntranslation_n_per_mm = [0.0, 0.0, {k}]\n\
         [[action]]\nkind = \"section-force\"\nsection = \"tip\"\nforce_n = [0.0, 0.0, 0.1]\n\
         [[probe]]\nname = \"w\"\nkind = \"displacement\"\non = [1.0, 0.5]\ncomponent = \"z\"\n\
         [[probe]]\nname = \"prop\"\nkind = \"reaction\"\nsupport = \"prop\"\ncomponent = \"force-z\"\n\
         [[probe]]\nname = \"root\"\nkind = \"reaction\"\nsupport = \"root\"\ncomponent = \"force-z\"\n\
         [[probe]]\nname = \"middle\"\nkind = \"section-moment\"\non = \"u=0.5\"\ncomponent = \"y\"\n"
    )));
    is_near(reading(&report, "w"), 0.1 / (2.0 * k), 1e-4);
    is_near(reading(&report, "prop"), -0.05, 1e-4);
    is_near(reading(&report, "root"), -0.05, 1e-4);
    is_near(reading(&report, "middle"), -0.05 * 0.5 * L, 1e-3);
    // What the spring stores is counted.
    is_near(report.strain_energy_n_mm, 0.5 * 0.1 * reading(&report, "w"), 1e-4);
}

/// A strip bent to an arc of 60° by a moment, whose root turns by another 60° against its spring: φ = M/c at any angle.
#[test]
fn a_hinge_with_a_spring_turns_by_the_moment_over_its_stiffness() {
    let angle = std::f64::consts::FRAC_PI_3;
    let moment = EI * angle / L;
    let per_degree = moment / 60.0;
    let (_, report) = end(strip(&format!(
        "[[support]]\nname = \"root\"\nkind = \"rigid\"\non = \"u-start\"\nrotation_y_deg = \"free\"\n\
         [[spring]]\nname = \"hinge\"\nsection = \"root\"\nrotation_n_mm_per_deg = [0.0, {per_degree}, 0.0]\n\
         [[action]]\nkind = \"edge-moment\"\non = \"u-end\"\nmoment_n = {}\n\
         [[probe]]\nname = \"x\"\nkind = \"displacement\"\non = [1.0, 0.5]\ncomponent = \"x\"\n\
         [[probe]]\nname = \"z\"\nkind = \"displacement\"\non = [1.0, 0.5]\ncomponent = \"z\"\n\
         [[probe]]\nname = \"hinge\"\nkind = \"reaction\"\nsupport = \"hinge\"\ncomponent = \"moment-y\"\n",
        moment / 10.0
    )));
    is_near(reading(&report, "hinge"), -moment, 1e-6);
    let radius = L / angle;
    let x = radius * ((2.0 * angle).sin() - angle.sin());
    let z = radius * ((2.0 * angle).cos() - angle.cos());
    assert!((reading(&report, "x") + L - x).abs() < 1e-3 * L, "{} {x}", reading(&report, "x") + L);
    assert!((reading(&report, "z") - z).abs() < 1e-3 * L, "{} {z}", reading(&report, "z"));
    is_near(report.strain_energy_n_mm, 0.5 * moment * (2.0 * angle), 1e-4);
}

/// A column whose foot turns against a spring of c = EI/L buckles at k L tan(k L) = c L/EI: k L = 0.860334, P = 0.740174 EI/L².
#[test]
fn a_column_on_a_spring_buckles() {
    let per_degree = EI / L * std::f64::consts::PI / 180.0;
    let scene = strip(&format!(
        "[[support]]\nname = \"root\"\nkind = \"rigid\"\non = \"u-start\"\nrotation_y_deg = \"free\"\n\
         [[spring]]\nname = \"foot\"\nsection = \"root\"\nrotation_n_mm_per_deg = [0.0, {per_degree}, 0.0]\n\
         [[action]]\nkind = \"line-force\"\non = \"u-end\"\nforce_n_per_mm = [-0.1, 0.0, 0.0]\n"
    ));
    let state = Stages::new(scene.clone()).start().unwrap();
    let mut work = Workspace::new(&scene, &state.mesh).unwrap();
    let found = linear_buckling(&mut work, Configuration::of(&state), 1).unwrap();
    is_near(found.modes[0].factor, 0.740_174 * EI / (L * L), 1e-3);
}

/// A mass off the tip of a strip that bends far: the root carries its weight at the place that it has moved to.
#[test]
fn the_weight_of_a_mass_acts_where_the_mass_has_moved_to() {
    let [ahead, above] = [10.0, 20.0];
    let (state, report) = end(strip(
        "[[support]]\nname = \"root\"\nkind = \"clamped\"\non = \"u-start\"\n\
         [[support]]\nname = \"tip\"\nkind = \"rigid\"\non = \"u-end\"\nx_mm = \"free\"\nz_mm = \"free\"\nrotation_y_deg = \"free\"\n\
         [[mass]]\nname = \"payload\"\nsection = \"tip\"\nmass_kg = 4.0\nat_mm = [110.0, 5.0, 20.0]\n\
         [[action]]\nkind = \"gravity\"\nacceleration_m_s2 = [0.0, 0.0, -10.0]\n\
         [[probe]]\nname = \"x\"\nkind = \"displacement\"\non = [1.0, 0.5]\ncomponent = \"x\"\n\
         [[probe]]\nname = \"force\"\nkind = \"reaction\"\nsupport = \"root\"\ncomponent = \"force-z\"\n\
         [[probe]]\nname = \"moment\"\nkind = \"reaction\"\nsupport = \"root\"\ncomponent = \"moment-y\"\n",
    ));
    let weight = 40.0;
    let angle = state.turns[0][1];
    assert!(angle > 0.5, "it bends far: {angle}");
    let x = L + reading(&report, "x") + ahead * angle.cos() + above * angle.sin();
    is_near(reading(&report, "force"), weight, 1e-6);
    is_near(reading(&report, "moment"), -weight * x, 1e-6);
}

#[test]
fn what_cannot_be_meant_is_refused() {
    let root = "[[support]]\nname = \"root\"\nkind = \"clamped\"\non = \"u-start\"\n";
    let tip = "[[support]]\nname = \"tip\"\nkind = \"rigid\"\non = \"u-end\"\nz_mm = \"free\"\n";
    let load = "[[action]]\nkind = \"line-force\"\non = \"u-end\"\nforce_n_per_mm = [0.0, 0.0, 0.1]\n";
    for (spring, words) in [
        ("section = \"tap\"\ntranslation_n_per_mm = [0.0, 0.0, 1.0]", "the rigid sections are \"root\", \"tip\""),
        ("section = \"tip\"", "without stiffness"),
        ("section = \"tip\"\ntranslation_n_per_mm = [1.0, 0.0, 0.0]", "does not move along x"),
        ("section = \"tip\"\nrotation_n_mm_per_deg = [0.0, 1.0, 0.0]", "does not move about y"),
        ("section = \"tip\"\ntranslation_n_per_mm = [0.0, 0.0, -1.0]", "negative stiffness"),
        ("name = \"tip\"\nsection = \"tip\"\ntranslation_n_per_mm = [0.0, 0.0, 1.0]", "has the same name"),
    ] {
        let geometry = "[geometry]\nkind = \"plate\"\nlength_mm = 100.0\nwidth_mm = 10.0\n[material]\nkind = \"isotropic\"\n\
                        youngs_modulus_mpa = 210000.0\npoissons_ratio = 0.0\nthickness_mm = 1.0\n[mesh]\nelements = [8, 1]\n\
                        [load]\nkind = \"steps\"\nfactor = 1.0\nincrement = 0.25\n";
        let error = parse(&format!("{geometry}{root}{tip}[[spring]]\n{spring}\n{load}"), "scene.toml").unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
    }
}
