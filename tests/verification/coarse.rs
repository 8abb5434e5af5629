//! Meshes that cannot show what the shell does are said to be coarse, and those of the shipped scenes are not.

use foldline::adapt::Halved;
use foldline::equilibrium::{Configuration, Equilibrium, Workspace, linear_buckling};
use foldline::pipeline::{Run, Stages};
use foldline::record::{MemorySink, Record, Warning};
use foldline::scene::{LengthLimit, Quadrature, Scene, Stage, parse};
use foldline::study::Summary;

use crate::support::{run, scene};

fn records(scene: &Scene) -> Vec<Record> {
    run(scene.clone()).into_iter().map(|(_, record)| record).collect()
}

fn warnings(records: &[Record]) -> Vec<Warning> {
    records.iter().flat_map(|record| record.report.warnings.clone()).collect()
}

/// Quadratic elements on 4 x 4: half of them have the energy of the others, and they seem to snap at half the rotation.
#[test]
fn an_energy_that_refining_changes_casts_doubt_on_the_peak() {
    let mut scene = scene("baseline.toml");
    scene.mesh.degree = [2, 2];
    scene.mesh.quadrature = Quadrature::Patch;
    scene.load.set_target(5.2);
    let records = records(&scene);
    let found = warnings(&records);
    let changed = |warning: &Warning| matches!(warning, Warning::EnergyChangedByRefining { energy_change, .. } if energy_change.abs() > 0.4);
    assert!(found.iter().any(changed), "{found:?}");
    assert!(Summary::new(&scene, &records).peak_in_doubt);
}

/// The same with full quadrature and no refinement: too stiff to flatten, so that it never snaps.
#[test]
fn elements_that_lock_are_coarse() {
    let mut scene = scene("baseline-uniform.toml");
    scene.mesh.degree = [2, 2];
    scene.mesh.elements = [4, 4];
    scene.mesh.quadrature = Quadrature::Full;
    let found = warnings(&records(&scene));
    let [Warning::CoarseElements { elements, energy_share, .. }] = &found[..] else { panic!("{found:?}") };
    assert!(*elements == [2, 2] && *energy_share > 0.2);
}

fn pulled_cylinder() -> Scene {
    parse(include_str!("scenes/pulled-cylinder.toml"), "pulled-cylinder.toml").unwrap()
}

/// An open cylinder pulled at two points (Sze, Liu & Lo 2004, section 3.6; R/t = 53), compared with 32 x 48 quartic elements:
/// with a limit of √(R t) it is 6.3 % off and says so; with the default for such shells 1.6 %.
#[test]
fn refinement_that_the_limit_blocks_is_said() {
    const PULLED_OUT_MM: f64 = 2.73173;
    let mut scene = pulled_cylinder();
    let deflection = |records: &[Record]| {
        records.iter().rev().find_map(|record| record.report.probes.first()).unwrap().value / PULLED_OUT_MM - 1.0
    };
    let is_blocked = |warning: &Warning| match warning {
        Warning::RefinementBlocked { over_threshold, .. } => *over_threshold > 50.0,
        _ => false,
    };
    let by_default = records(&scene);
    assert!(deflection(&by_default).abs() < 0.02, "{}", deflection(&by_default));
    assert!(!warnings(&by_default).iter().any(is_blocked));
    scene.adapt.as_mut().unwrap().length_limit = LengthLimit::SqrtRadiusThickness;
    let blocked = records(&scene);
    assert!(deflection(&blocked).abs() > 0.05);
    assert!(warnings(&blocked).iter().any(is_blocked), "{:?}", warnings(&blocked));
}

/// The same without refinement, and with refinement that stops at the first small load: coarse either way.
#[test]
fn a_refinement_at_a_small_load_does_not_silence_the_end() {
    let is_coarse = |warning: &Warning| matches!(warning, Warning::CoarseElements { parameter: 1.0, .. });
    let mut blocked = pulled_cylinder();
    blocked.adapt.as_mut().unwrap().length_limit = LengthLimit::SqrtRadiusThickness;
    let mut uniform = pulled_cylinder();
    uniform.adapt = None;
    uniform.pipeline = vec![Stage::Solve];
    for scene in [blocked, uniform] {
        let found = warnings(&records(&scene));
        assert!(found.iter().any(is_coarse), "{found:?}");
    }
}

#[test]
fn shipped_scenes_print_no_warning() {
    for name in [
        "baseline-quarter.toml",
        "baseline-uniform.toml",
        "verification/rolled-cantilever.toml",
        "verification/cantilever-end-shear.toml",
        "verification/laminated-plate.toml",
        "verification/hinged-roof-12.7.toml",
        "verification/hinged-roof-6.35-snap.toml",
    ] {
        assert_eq!(warnings(&records(&scene(name))), [], "{name}");
    }
}

/// What halving is said to release is what it releases: a tape spring at small rotations, where first order is all.
#[test]
fn halving_is_foreseen() {
    let mut scene = scene("baseline-uniform.toml");
    scene.mesh.elements = [4, 4];
    scene.load.set_target(0.4);
    let (state, _) = run(scene.clone()).pop().unwrap();
    let foreseen = Halved::of(&scene, &[], &state, 0).unwrap().halving();
    let finer = std::sync::Arc::new(state.mesh.halved());
    let displacement = foldline::adapt::project_displacements(&state.mesh, &finer, &state.displacement);
    let mut work = Workspace::new(&scene, &finer).unwrap();
    let at = Configuration { displacement: &displacement, ..Configuration::of(&state) };
    let found = Equilibrium::new(&scene, &mut work).relax(at, &mut |_| false).unwrap();
    let model = found.balance.stored / scene.symmetry.copies() as f64;
    let released = foreseen.integrated - model;
    assert!(released > 0.0 && (foreseen.released / released - 1.0).abs() < 0.02, "{} {released}", foreseen.released);
}

/// A column of quadratic elements that is pushed aside a little, next to the load at which it buckles on the halved mesh: finding
/// equilibrium there would release about all of its energy, all of it in the mode that buckles, and says nothing of the elements.
#[test]
fn a_mode_that_is_critical_tells_nothing_of_elements() {
    let column = |elements: usize| {
        parse(
            &format!(
                "[geometry]\nkind = \"plate\"\nlength_mm = 100.0\nwidth_mm = 5.0\n\
                 [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70000.0\npoissons_ratio = 0.0\nthickness_mm = 0.5\n\
                 [mesh]\ndegree = 2\nelements = [{elements}, 1]\nquadrature = \"full\"\n\
                 [load]\nkind = \"steps\"\nfactor = 1.0\nincrement = 1.0\n\
                 [[support]]\nname = \"root\"\nkind = \"clamped\"\non = \"u-start\"\n\
                 [[support]]\nname = \"tip\"\nkind = \"rigid\"\non = \"u-end\"\nx_mm = \"free\"\nz_mm = \"free\"\n\
                 rotation_y_deg = \"free\"\n\
                 [[action]]\nkind = \"section-force\"\nsection = \"tip\"\nforce_n = [-1.0, 0.0, 1e-7]\n"
            ),
            "column.toml",
        )
        .unwrap()
    };
    let finer = column(8);
    let start = Stages::new(finer.clone()).start().unwrap();
    let mut work = Workspace::new(&finer, &start.mesh).unwrap();
    let critical = linear_buckling(&mut work, Configuration::of(&start), 1).unwrap().modes[0].factor;
    let mut scene = column(4);
    scene.load.set_target((1.0 - 1e-5) * critical);
    let (state, _) = run(scene.clone()).pop().unwrap();
    let [all, rest] = [0, 1].map(|modes| Halved::of(&scene, &[], &state, modes).unwrap().halving().released);
    assert!(all > 0.0 && rest.abs() < 0.01 * all, "{all} {rest}");
}

/// A report tells of its state alone: stages that are run again say the same.
#[test]
fn warnings_are_those_of_the_state() {
    let mut scene = scene("baseline-uniform.toml");
    scene.mesh.degree = [2, 2];
    scene.mesh.elements = [4, 4];
    scene.mesh.quadrature = Quadrature::Full;
    scene.load.set_target(1.2);
    let stages = run(scene.clone());
    let [.., (before, _), (_, last)] = &stages[..] else { panic!("two steps") };
    let mut sink = MemorySink::default();
    let mut again = Run::new(Stages::new(scene), before.clone(), None);
    again.advance(&mut sink).unwrap();
    assert_eq!(last.report.stage, Stage::Solve);
    assert_eq!(sink.stages[0].1.report.warnings, last.report.warnings);
}

/// A ring under pressure that follows: 3 E I/R³, the load factor 1 here (Timoshenko & Gere, Theory of Elastic Stability,
/// section 7.4). A quarter of it, with planes of symmetry at both ends.
fn ring(degree: usize, elements: usize) -> Scene {
    let text = format!(
        r#"
        geometry = {{ kind = "cylinder-panel", length_mm = 5, radius_mm = 50, arc_deg = 90 }}
        material = {{ kind = "isotropic", youngs_modulus_mpa = 70000, poissons_ratio = 0, thickness_mm = 0.1 }}
        mesh = {{ degree = {degree}, elements = [1, {elements}] }}
        load = {{ kind = "steps", increment = 0.1, factor = 3 }}
        support = [
            {{ on = "u-start", kind = "fixed", hold = ["x"] }},
            {{ on = "v-start", kind = "symmetric" }},
            {{ on = "v-end", kind = "symmetric" }},
        ]
        action = [{{ kind = "pressure", pressure_mpa = -1.4e-4, follower = true }}]
        "#
    );
    parse(&text, "ring.toml").unwrap()
}

/// The membrane is exact before the ring buckles, so that no energy tells.
#[test]
fn elements_that_are_too_stiff_to_buckle_are_said() {
    let found = warnings(&records(&ring(2, 16)));
    let [Warning::LateBuckling { parameter, halved, .. }] = found[..] else { panic!("{found:?}") };
    assert!(parameter > 2.0 && (1.0..1.2).contains(&halved), "{found:?}");
    assert_eq!(warnings(&records(&ring(3, 16))), []);
}

/// A tube under pressure, clamped at its ends: all its energy is in the membrane, and the bending at the edge,
/// κ = 2 β² w with β⁴ = 3 (1 − ν²)/(R t)² and w = p R²/(E t) (Timoshenko & Woinowsky-Krieger, section 115), is lost on
/// elements that are several times as long as its layer, 1/β = 1.7 mm.
#[test]
fn a_probe_that_the_elements_miss_is_said() {
    const KAPPA_PER_MM: f64 = 2.0 * 0.330_454_5 * 1e-3;
    let tube = |along: usize| {
        let text = format!(
            r#"
            geometry = {{ kind = "cylinder-panel", length_mm = 100, radius_mm = 50, arc_deg = 90 }}
            material = {{ kind = "isotropic", youngs_modulus_mpa = 70000, poissons_ratio = 0.3, thickness_mm = 0.1 }}
            mesh = {{ degree = 3, elements = [{along}, 8] }}
            load = {{ kind = "steps", increment = 1 }}
            support = [
                {{ on = "u-start", kind = "clamped" }},
                {{ on = "u-end", kind = "symmetric" }},
                {{ on = "v-start", kind = "symmetric" }},
                {{ on = "v-end", kind = "symmetric" }},
            ]
            action = [{{ kind = "pressure", pressure_mpa = 0.0028 }}]
            probe = [{{ name = "edge", kind = "bending-strain" }}]
            "#
        );
        warnings(&records(&parse(&text, "tube.toml").unwrap()))
    };
    let found = tube(16);
    let [Warning::ProbeOff { value, halved, .. }] = found[..] else { panic!("{found:?}") };
    assert!(value < halved && halved < KAPPA_PER_MM, "{value} {halved} {KAPPA_PER_MM}");
    assert_eq!(tube(128), []);
}

/// A strip that is pulled out by a third: E = (λ² − 1)/2.
#[test]
fn strains_that_the_law_is_not_meant_for_are_said() {
    let pulled = |by_mm: f64| {
        let text = format!(
            r#"
            geometry = {{ kind = "plate", length_mm = 30, width_mm = 10 }}
            material = {{ kind = "isotropic", youngs_modulus_mpa = 1000, poissons_ratio = 0, thickness_mm = 1 }}
            mesh = {{ degree = 2, elements = [2, 2] }}
            load = {{ kind = "steps", increment = 0.5 }}
            support = [
                {{ on = "u-start", kind = "clamped" }},
                {{ on = "u-end", kind = "displacement", x_mm = {by_mm} }},
            ]
            "#
        );
        warnings(&records(&parse(&text, "strip.toml").unwrap()))
    };
    let found = pulled(10.0);
    let [Warning::LargeStrains { strain, .. }] = found[..] else { panic!("{found:?}") };
    assert!((strain - (16.0 / 9.0 - 1.0) / 2.0).abs() < 1e-6, "{strain}");
    assert_eq!(pulled(1.0), []);
}

/// Of two strips that are joined, the second one is pulled out.
#[test]
fn large_strains_name_the_shell_that_has_them() {
    let text = "[[shell]]\nname = \"one\"\n[shell.geometry]\nkind = \"plate\"\nlength_mm = 30.0\nwidth_mm = 10.0\n\
         [[shell]]\nname = \"two\"\nposition_mm = [30.0, 0.0, 0.0]\n[shell.geometry]\nkind = \"plate\"\nlength_mm = 30.0\n\
         width_mm = 10.0\n[[joint]]\nkind = \"hinge\"\nedges = [\"one.u-end\", \"two.u-start\"]\n\
         [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 1.0\npoissons_ratio = 0.0\nthickness_mm = 1.0\n\
         [mesh]\ndegree = 2\nelements = [2, 2]\n[load]\nkind = \"steps\"\nincrement = 0.5\n\
         [[support]]\nname = \"a\"\nshell = \"one\"\non = \"u-start\"\nkind = \"clamped\"\n\
         [[support]]\nname = \"b\"\nshell = \"two\"\non = \"u-start\"\nkind = \"hinged\"\n\
         [[support]]\nname = \"c\"\nshell = \"two\"\non = \"u-end\"\nkind = \"displacement\"\nx_mm = 10.0\ny_mm = 0.0\nz_mm = 0.0\n";
    let found = warnings(&records(&parse(text, "strips.toml").unwrap()));
    let large = found.iter().find(|warning| matches!(warning, Warning::LargeStrains { .. })).unwrap();
    assert!(matches!(large, Warning::LargeStrains { shell: Some(shell), .. } if shell == "two"), "{large:?}");
    assert!(large.in_words().contains(" of \"two\": the law"), "{}", large.in_words());
}
