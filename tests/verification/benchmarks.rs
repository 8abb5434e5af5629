//! Published benchmarks and closed forms on scenes of `pipelines/verification`.

use std::f64::consts::PI;

use foldline::pipeline::{Run, Stages};
use foldline::record::{MemorySink, Report};
use foldline::scene::{
    Edge, Geometry, Hold, Load, LoadSteps, Motion, NurbsPatch, Probe, ProbeKind, Reaction, Region, Scene, parse,
};
use foldline::state::State;

pub fn read(name: &str) -> Scene {
    let path = format!("{}/pipelines/verification/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    parse(&std::fs::read_to_string(&path).unwrap(), &path).unwrap_or_else(|error| panic!("{error}"))
}

/// Runs to a load factor, from the start or from a state before it.
fn run_to(scene: &Scene, from: Option<State>, factor: f64) -> (State, Report) {
    let mut scene = scene.clone();
    scene.load.set_target(factor);
    let mut stages = Stages::new(scene);
    let start = from.unwrap_or_else(|| stages.start().unwrap_or_else(|error| panic!("{error}")));
    let mut sink = MemorySink::default();
    Run::new(stages, start, None).to_end(None, &|| false, &mut sink).unwrap_or_else(|error| panic!("{error}"));
    let reading = sink.stages.iter().rev().find(|(_, record)| !record.report.probes.is_empty());
    let report = reading.or(sink.stages.last()).map(|(_, record)| record.report.clone()).unwrap();
    (sink.stages.pop().unwrap().0, report)
}

fn probe(report: &Report, name: &str) -> f64 {
    report.probes.iter().find(|probe| probe.name == name).unwrap_or_else(|| panic!("no probe {name}")).value
}

pub fn table(text: &str) -> Vec<Vec<f64>> {
    let numbers = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
    text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).map(numbers).collect()
}

/// Tip of the strip rolled to a full circle, for each degree: within 0.1 % of the length of the exact place.
#[test]
fn rolled_cantilever() {
    for degree in 2..=5 {
        let mut scene = read("rolled-cantilever");
        scene.mesh.degree = [degree; 2];
        scene.mesh.elements = if degree == 2 { [64, 1] } else { [24, 1] };
        let mut state = None;
        for factor in [0.25_f64, 0.5, 0.75, 1.0] {
            let (next, report) = run_to(&scene, state, factor);
            let angle = 2.0 * PI * factor;
            let [u, w] = [12.0 * (angle.sin() / angle - 1.0), 12.0 * (1.0 - angle.cos()) / angle];
            let off = (probe(&report, "u") - u).hypot(probe(&report, "w") - w) / 12.0;
            assert!(off < 1e-3, "degree {degree}, factor {factor}: {off}");
            assert_eq!(report.negative_pivots, 0);
            let moment = 50.0 / 3.0 * PI * factor;
            assert!((probe(&report, "root moment") / moment - 1.0).abs() < 1e-6, "the root holds the moment");
            state = Some(next);
        }
    }
}

/// The same strip as a NURBS surface that lies askew in space: the tip moves as in the plane, turned.
#[test]
fn rolled_cantilever_askew() {
    let along = [2.0 / 3.0, 2.0 / 3.0, 1.0 / 3.0];
    let across = [-2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0];
    let normal = [1.0 / 3.0, -2.0 / 3.0, 2.0 / 3.0];
    let point = |u: f64, v: f64| [0, 1, 2].map(|c| 12.0 * u * along[c] + v * across[c]);
    let mut scene = read("rolled-cantilever");
    scene.geometry = Geometry::Nurbs(NurbsPatch {
        degrees: [1, 1],
        knots_u: vec![0.0, 0.0, 1.0, 1.0],
        knots_v: vec![0.0, 0.0, 1.0, 1.0],
        control_points_mm: vec![point(0.0, 0.0), point(0.0, 1.0), point(1.0, 0.0), point(1.0, 1.0)],
        weights: vec![1.0; 4],
        seam: None,
    });
    scene.mesh.elements = [24, 1];
    let components = [foldline::scene::Component::X, foldline::scene::Component::Y, foldline::scene::Component::Z];
    scene.probes = components
        .into_iter()
        .map(|component| Probe {
            name: format!("{component:?}"),
            shell: 0,
            kind: ProbeKind::Displacement { on: [1.0, 0.5], component },
        })
        .collect();
    let (_, report) = run_to(&scene, None, 1.0);
    let moved: Vec<f64> = report.probes.iter().map(|probe| probe.value).collect();
    let part = |axis: [f64; 3]| (0..3).map(|c| moved[c] * axis[c]).sum::<f64>();
    let off = (part(along) + 12.0).hypot(part(normal)).hypot(part(across)) / 12.0;
    assert!(off < 1e-3, "{moved:?}");
}

#[test]
fn cantilever_under_end_shear() {
    let (_, report) = run_to(&read("cantilever-end-shear"), None, 1.0);
    // Sze, Liu & Lo 2004, table 1: three digits after the point.
    assert!((probe(&report, "w") - 6.698).abs() < 0.003 && (probe(&report, "u") + 3.286).abs() < 0.003);
}

#[test]
fn slit_annular_plate() {
    let scene = read("slit-annular-plate");
    let mut state = None;
    for row in table(include_str!("sze2004_3_3_slit_annular_plate.csv")) {
        let (next, report) = run_to(&scene, state, row[0]);
        for (name, value) in [("W_A", row[1]), ("W_B", row[2])] {
            let off = probe(&report, name) / value - 1.0;
            assert!(off.abs() < 0.015, "{name} at {}: {:.2} %", row[0], 100.0 * off);
        }
        state = Some(next);
    }
}

/// Up to the limit load; differences in parts of the largest deflection of the whole table.
#[test]
fn hinged_roof() {
    let scene = read("hinged-roof-12.7");
    let rows = table(include_str!("sze2004_3_8_hinged_roof_h12.7.csv"));
    let largest = rows[rows.len() - 1][1];
    let mut state = None;
    for row in &rows[..9] {
        let (next, report) = run_to(&scene, state, row[0]);
        let off = (-probe(&report, "w_c") - row[1]) / largest;
        assert!(off.abs() < 0.01, "at {}: {:.2} % of {largest} mm", row[0], 100.0 * off);
        state = Some(next);
    }
}

/// Navier's double series for a simply supported cross-ply plate.
#[test]
fn laminated_plate() {
    let (_, report) = run_to(&read("laminated-plate"), None, 1.0);
    let (e1, e2, nu, g) = (175e3, 7e3, 0.25, 3.5e3);
    let scale = 1.0 / (1.0 - nu * nu * e2 / e1);
    // 0° plies from 1/4 to 1/2 of the thickness of 1 mm, 90° plies inside.
    let (outer, inner) = (2.0 * (0.125 - 0.015625) / 3.0, 2.0 * 0.015625 / 3.0);
    let d11 = scale * (e1 * outer + e2 * inner);
    let d22 = scale * (e2 * outer + e1 * inner);
    let (d12, d66) = (scale * nu * e2 * (outer + inner), g * (outer + inner));
    let (size, pressure) = (100.0, 1e-5);
    let mut w = 0.0;
    for m in (1..60).step_by(2) {
        for n in (1..60).step_by(2) {
            let (m, n) = (f64::from(m), f64::from(n));
            let load = 16.0 * pressure / (PI * PI * m * n);
            let stiff = PI.powi(4) / f64::powi(size, 4)
                * (d11 * m.powi(4) + 2.0 * (d12 + 2.0 * d66) * m * m * n * n + d22 * n.powi(4));
            w += load / stiff * (m * PI / 2.0).sin() * (n * PI / 2.0).sin();
        }
    }
    let off = probe(&report, "w") / w - 1.0;
    assert!(off.abs() < 1e-3, "{} instead of {w}", probe(&report, "w"));
}

/// A section that is given all six motions returns six reactions in equilibrium with those of the far end.
#[test]
fn six_motions_six_reactions() {
    let mut scene = read("rolled-cantilever");
    scene.geometry =
        Geometry::CylinderPanel { length_mm: 60.0, radius_mm: 20.0, arc_deg: 120.0, from_deg: None, seam: None };
    scene.mesh.elements = [6, 6];
    scene.actions.clear();
    scene.solver.tolerance = 1e-11;
    scene.load = Load::Steps(LoadSteps {
        factor: 1.0,
        increment: 0.5,
        longest_increment: None,
        least_increment: 1e-6,
        snap_tolerance: 1e-3,
    });
    let mut end = scene.supports[0].clone();
    end.name = "end".into();
    end.on = Region::Edge(Edge::UEnd);
    let pole = Some([0.0, 0.0, 0.0]);
    let motions = [0.05, -0.1, 0.2, 1.0, -0.5, 0.8].map(Motion::Given);
    end.hold = Hold::Rigid { motions, reference_mm: pole, normals_turn: true };
    scene.supports.push(end);
    let all =
        [Reaction::ForceX, Reaction::ForceY, Reaction::ForceZ, Reaction::MomentX, Reaction::MomentY, Reaction::MomentZ];
    scene.probes.clear();
    for support in ["root", "end"] {
        for component in all {
            let kind = ProbeKind::Reaction { support: support.into(), component };
            scene.probes.push(Probe { name: format!("{support} {component:?}"), shell: 0, kind });
        }
    }
    let (_, report) = run_to(&scene, None, 1.0);
    let values: Vec<f64> = report.probes.iter().map(|probe| probe.value).collect();
    let (root, end) = values.split_at(6);
    let force = (0..3).map(|c| end[c].abs()).fold(0.0, f64::max);
    for c in 0..3 {
        assert!((root[c] + end[c]).abs() < 1e-8 * force, "force {c}: {} {}", root[c], end[c]);
    }
    // Moments about the origin: the far end's is about the centroid of its edge, the section's about the origin moved.
    let half = 60.0_f64.to_radians();
    let poles = [[0.0, 0.0, 20.0 * half.sin() / half], [0.05, -0.1, 0.2]];
    let about_origin = |values: &[f64], [x, y, z]: [f64; 3]| {
        let [fx, fy, fz] = [values[0], values[1], values[2]];
        [values[3] + y * fz - z * fy, values[4] + z * fx - x * fz, values[5] + x * fy - y * fx]
    };
    let (a, b) = (about_origin(root, poles[0]), about_origin(end, poles[1]));
    let scale = 60.0 * force;
    for c in 0..3 {
        assert!((a[c] + b[c]).abs() < 1e-8 * scale, "moment {c}: {} {}", a[c], b[c]);
    }
}

/// A section with free motions moves as statics asks: only its given turn does work, and no other reaction is left.
#[test]
fn free_motions_of_a_section_carry_nothing() {
    let mut scene = read("rolled-cantilever");
    scene.actions.clear();
    let mut end = scene.supports[0].clone();
    end.name = "end".into();
    end.on = Region::Edge(Edge::UEnd);
    let motions = [Motion::FREE, Motion::FREE, Motion::FREE, Motion::FREE, Motion::Given(-90.0), Motion::FREE];
    end.hold = Hold::Rigid { motions, reference_mm: None, normals_turn: true };
    scene.supports.push(end);
    for component in [Reaction::ForceX, Reaction::ForceZ, Reaction::MomentX, Reaction::MomentY] {
        let kind = ProbeKind::Reaction { support: "end".into(), component };
        scene.probes.push(Probe { name: format!("{component:?}"), shell: 0, kind });
    }
    let (state, report) = run_to(&scene, None, 1.0);
    // Pure bending to a quarter circle: M = E I φ / L.
    let moment = -1.2e6 * 0.001 / 12.0 * (PI / 2.0) / 12.0;
    assert!((probe(&report, "MomentY") / moment - 1.0).abs() < 1e-3, "{}", probe(&report, "MomentY"));
    for name in ["ForceX", "ForceZ", "MomentX"] {
        assert!(probe(&report, name).abs() < 1e-5 * moment.abs(), "{name} {}", probe(&report, name));
    }
    assert_eq!(state.turns.len(), 1);
    let angle = PI / 2.0;
    assert!((probe(&report, "w") - 12.0 * (1.0 - angle.cos()) / angle).abs() < 0.012);
}

/// Energy-norm error of an arch under a small end force against mesh width, degree by degree: order p − 1.
#[test]
fn observed_orders() {
    let energy = |degree: usize, elements: usize| {
        let mut scene = read("rolled-cantilever");
        scene.geometry =
            Geometry::CylinderPanel { length_mm: 2.0, radius_mm: 10.0, arc_deg: 90.0, from_deg: None, seam: None };
        if let foldline::scene::Material::Isotropic { thickness_mm, .. } = &mut scene.material {
            *thickness_mm = 1.0;
        }
        scene.mesh.degree = [2, degree];
        scene.mesh.elements = [1, elements];
        scene.supports[0].on = Region::Edge(Edge::VStart);
        scene.actions[0].kind = foldline::scene::ActionKind::LineForce {
            on: Region::Edge(Edge::VEnd),
            force_n_per_mm: [0.0, 0.0, 1e-3].into(),
        };
        scene.probes.clear();
        scene.solver.tolerance = 1e-12;
        scene.load = Load::Steps(LoadSteps {
            factor: 1.0,
            increment: 1.0,
            longest_increment: None,
            least_increment: 1e-6,
            snap_tolerance: 1e-3,
        });
        run_to(&scene, None, 1.0).1.strain_energy_n_mm
    };
    let exact = energy(5, 32);
    for (degree, coarse) in [(2, 16), (3, 6), (4, 4), (5, 4)] {
        let error = |elements: usize| ((exact - energy(degree, elements)).abs() / exact).sqrt();
        let (wide, narrow) = (error(coarse), error(2 * coarse));
        let order = (wide / narrow).log2();
        println!("degree {degree}: {wide:.2e} on {coarse}, {narrow:.2e} on {} elements, order {order:.2}", 2 * coarse);
        assert!(order > degree as f64 - 1.0 - 0.1, "degree {degree}: order {order}");
    }
}

/// What the supports leave free is found before the first solve, and named.
#[test]
fn free_rigid_motions_are_named() {
    let mut scene = read("rolled-cantilever");
    let hinged =
        |components: [bool; 3]| Hold::Displacement { displacement_mm: components.map(|held| held.then_some(0.0)) };
    let cases = [
        (Region::Edge(Edge::UStart), [true, true, true], "it can turn about an axis along y through"),
        (Region::Edge(Edge::UStart), [true, false, true], "it can move along y"),
        (Region::Point([0.0, 0.0]), [true, true, true], "it can turn about an axis along"),
        (Region::Line(foldline::scene::ParametricDirection::U, 0.5), [false, true, true], "it can move along x"),
    ];
    for (on, components, words) in cases {
        scene.supports[0].on = on;
        scene.supports[0].hold = hinged(components);
        let error = Stages::new(scene.clone()).start().unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    scene.supports[0].on = Region::Edge(Edge::UStart);
    scene.supports[0].hold = Hold::Symmetric;
    let error = Stages::new(scene.clone()).start().unwrap_err().to_string();
    assert!(error.contains("it can move along"), "{error}");
}

/// Any scene refines, each axis on its own, and two runs to it by half are the run at once, to the bit.
#[test]
fn refinement_in_any_scene() {
    let mut scene = read("cantilever-end-shear");
    scene.mesh.elements = [2, 1];
    scene.adapt = Some(foldline::scene::Adapt {
        indicator: foldline::scene::Indicator::BendingStrain([0.1, 0.1]),
        length_limit: foldline::scene::LengthLimit::Millimetres([0.4, 0.4]),
        splitting: foldline::scene::Splitting::Halves,
    });
    scene.pipeline = foldline::scene::Stage::REFINING.to_vec();
    let (state, report) = run_to(&scene, None, 1.0);
    let (half, _) = run_to(&scene, None, 0.5);
    assert_eq!(run_to(&scene, Some(half), 1.0).0.hash(), state.hash());
    assert!(
        state.mesh.lone().element_counts()[0] >= 8 && state.mesh.lone().element_counts()[1] == 1,
        "{:?}",
        report.elements
    );
    assert!((probe(&report, "w") - 6.698).abs() < 0.01, "{}", probe(&report, "w"));
}

/// The end rotation of a tape spring, written with supports of its own, is the same problem to the last digits.
#[test]
fn a_tape_spring_in_other_words() {
    let turning = parse(include_str!("../../pipelines/baseline-uniform.toml"), "x.toml").unwrap();
    let mut turning = Scene { mesh: foldline::scene::MeshSpec { elements: [8, 4], ..turning.mesh.clone() }, ..turning };
    turning.symmetry = foldline::scene::Symmetry::None;
    turning.load.set_target(2.0);
    let mut scene = read("rolled-cantilever");
    scene.geometry = turning.geometry.clone();
    scene.material = turning.material.clone();
    scene.mesh = turning.mesh.clone();
    scene.actions.clear();
    let zero = Motion::Given(0.0);
    let end = |name: &str, edge: Edge, slide: Motion, turn: f64| foldline::scene::Support {
        name: name.into(),
        on: Region::Edge(edge),
        shell: 0,
        also: vec![],
        hold: Hold::Rigid {
            motions: [slide, zero, zero, zero, Motion::Given(turn), zero],
            reference_mm: None,
            normals_turn: true,
        },
        history: foldline::scene::History::default(),
    };
    scene.supports = vec![end("one", Edge::UStart, Motion::FREE, 2.0), end("two", Edge::UEnd, zero, -2.0)];
    let kind = ProbeKind::Reaction { support: "one".into(), component: Reaction::MomentY };
    scene.probes = vec![Probe { name: "M".into(), shell: 0, kind }];
    scene.load = Load::Steps(LoadSteps {
        factor: 1.0,
        increment: 0.2,
        longest_increment: None,
        least_increment: 1e-6,
        snap_tolerance: 1e-3,
    });
    let (_, report) = run_to(&scene, None, 1.0);
    let (_, turned) = run_to(&turning, None, 2.0);
    assert!(
        (probe(&report, "M") / turned.moment_n_mm - 1.0).abs() < 1e-6,
        "{} {}",
        probe(&report, "M"),
        turned.moment_n_mm
    );
    assert!((report.strain_energy_n_mm / turned.strain_energy_n_mm - 1.0).abs() < 1e-9);
}

/// A history that ends where the run does is no path that ends before.
#[test]
fn a_path_reaches_the_end_of_its_histories() {
    let text = r#"
        [geometry]
        kind = "plate"
        length_mm = 10.0
        width_mm = 1.0
        [material]
        kind = "isotropic"
        youngs_modulus_mpa = 1.2e6
        poissons_ratio = 0.0
        thickness_mm = 0.1
        [mesh]
        elements = [8, 1]
        [load]
        kind = "steps"
        increment = 0.1
        [continuation]
        control = "arc-length"
        [[support]]
        on = "u-start"
        kind = "clamped"
        [[action]]
        on = "u-end"
        kind = "line-force"
        force_n_per_mm = [0.0, 0.0, 2.0]
        HISTORY
        [[probe]]
        name = "w"
        kind = "displacement"
        on = [1.0, 0.5]
        component = "z"
    "#;
    let last = |history: &str| {
        let stages = crate::support::run(parse(&text.replace("HISTORY", history), "strip.toml").unwrap());
        let (state, record) = stages.last().unwrap().clone();
        assert_eq!(state.parameter, 1.0);
        record.report.probes[0].value
    };
    let proportional = last("");
    assert!((last("history = [[0.0, 0.0], [1.0, 1.0]]") / proportional - 1.0).abs() < 1e-5);
    assert!((last("history = [[0.0, 0.0], [0.5, 2.0], [1.0, 1.0]]") / proportional - 1.0).abs() < 1e-5);
}
