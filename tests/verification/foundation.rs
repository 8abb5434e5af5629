//! Shells on an elastic foundation, and with other energies of one's own.

use std::f64::consts::PI;
use std::sync::Arc;

use foldline::energy::{At, Balance, Tangent, Term, TermSource, Want};
use foldline::equilibrium::{Assembled, Configuration, Equilibrium, Workspace};
use foldline::model::{ModelError, Tables, starting_mesh};
use foldline::pipeline::{Run, Stages};
use foldline::record::{MemorySink, Record};
use foldline::scene::{Scene, Stage, parse};
use foldline::spline::Mesh;
use foldline::state::Hash;

use crate::elastic_foundation::Foundation;

/// A spring along x from one end of the first direction to the other, spread evenly over the control points of both ends: evenly
/// over the edges where these are one element.
#[derive(Clone, Copy, Debug)]
struct Tie {
    /// N/mm.
    stiffness: f64,
    /// How far its own length grows with the parameter, mm.
    growth: f64,
    /// Whether its tangent holds both ends: only then is that symmetric.
    at_once: bool,
}

impl Tie {
    fn of(stiffness: f64) -> Self {
        Self { stiffness, growth: 0.0, at_once: true }
    }
}

impl TermSource for Tie {
    fn name(&self) -> &str {
        "tie"
    }

    fn hash(&self) -> Hash {
        blake3::hash(&self.stiffness.to_le_bytes())
    }

    fn on(&self, _: &Scene, mesh: &Mesh, _: &[Tables]) -> Result<Box<dyn Term>, ModelError> {
        let grid = mesh.lone().grid();
        let ends: Vec<[usize; 2]> =
            grid.line(0, 0).zip(grid.line(0, grid.counts[0] - 1)).map(|(a, b)| [a, b]).collect();
        let each = Tie { stiffness: self.stiffness / ends.len() as f64, ..*self };
        Ok(Box::new(Ties { ends, each }))
    }
}

#[derive(Debug)]
struct Ties {
    ends: Vec<[usize; 2]>,
    each: Tie,
}

impl Ties {
    fn stretches(&self, at: At) -> impl Iterator<Item = ([usize; 2], f64)> {
        let own = self.each.growth * at.parameter;
        self.ends.iter().map(move |[a, b]| ([*a, *b], at.displacement[*b][0] - at.displacement[*a][0] - own))
    }
}

impl Term for Ties {
    fn pairs(&self) -> Vec<[usize; 2]> {
        self.ends.clone()
    }

    fn energy(&self, at: At) -> f64 {
        self.stretches(at).map(|(_, stretch)| 0.5 * self.each.stiffness * stretch * stretch).sum()
    }

    fn add_forces(&self, at: At, forces: &mut [[f64; 3]]) {
        for ([a, b], stretch) in self.stretches(at) {
            forces[a][0] += self.each.stiffness * stretch;
            forces[b][0] -= self.each.stiffness * stretch;
        }
    }

    fn add_rates(&self, _: At, rates: &mut [[f64; 3]]) {
        for [a, b] in &self.ends {
            rates[*a][0] -= self.each.stiffness * self.each.growth;
            rates[*b][0] += self.each.stiffness * self.each.growth;
        }
    }

    fn has_tangent(&self) -> bool {
        true
    }

    fn add_tangent(&self, _: At, tangent: &mut Tangent) {
        let slope = |value: f64| [[value, 0.0, 0.0], [0.0; 3], [0.0; 3]];
        for [a, b] in self.ends.iter().copied() {
            tangent.add([a, a], slope(-self.each.stiffness));
            tangent.add([a, b], slope(self.each.stiffness));
            if self.each.at_once {
                tangent.add([b, a], slope(self.each.stiffness));
                tangent.add([b, b], slope(-self.each.stiffness));
            }
        }
    }
}

const YOUNGS_MODULUS: f64 = 70_000.0;
const WIDTH: f64 = 4.0;
const THICKNESS: f64 = 1.0;
/// E I of the strip.
const BENDING_STIFFNESS: f64 = YOUNGS_MODULUS * WIDTH / 12.0;

/// A strip along x.
fn strip(length: f64, elements: usize, rest: &str) -> Scene {
    let text = format!(
        r#"
        geometry = {{ kind = "plate", length_mm = {length}, width_mm = {WIDTH} }}
        material = {{ kind = "isotropic", youngs_modulus_mpa = {YOUNGS_MODULUS}, poissons_ratio = 0, thickness_mm = {THICKNESS} }}
        mesh = {{ degree = 4, elements = [{elements}, 1] }}
        {rest}
        "#
    );
    parse(&text, "strip.toml").unwrap()
}

fn run_on(foundation: f64, scene: Scene) -> Vec<Record> {
    run_with(vec![Arc::new(Foundation(foundation))], scene)
}

fn run_with(own: Vec<Arc<dyn TermSource>>, scene: Scene) -> Vec<Record> {
    let mut stages = Stages::with_terms(scene, own);
    let start = stages.start().unwrap();
    let mut sink = MemorySink::default();
    Run::new(stages, start, None).to_end(None, &|| false, &mut sink).unwrap();
    sink.stages.into_iter().map(|(_, record)| record).collect()
}

/// A long strip under a force in its middle sinks by P β/(2 k b) there, β⁴ = k b/(4 E I) (Hetényi, *Beams on Elastic Foundation*,
/// section 3); half of it is modelled. What force and foundation do adds up.
#[test]
fn a_beam_on_it_has_the_deflection_of_the_closed_form() {
    let (k, force) = (0.02, 0.5);
    let beta = (k * WIDTH / (4.0 * BENDING_STIFFNESS)).powf(0.25);
    let scene = strip(
        12.0 / beta,
        32,
        &format!(
            r#"
            load = {{ kind = "steps", increment = 1 }}
            support = [
                {{ on = "u-start", kind = "symmetric" }},
                {{ on = "u-end", kind = "fixed", hold = ["y", "z"] }},
            ]
            action = [{{ kind = "line-force", on = "u-start", force_n_per_mm = [0, 0, {}] }}]
            probe = [
                {{ name = "w", kind = "displacement", on = [0.0, 0.5], component = "z" }},
                {{ name = "m", kind = "section-moment", on = "u=0.05", component = "y" }},
                {{ name = "n", kind = "section-moment", on = "u=0.15", component = "y" }},
            ]
            "#,
            0.5 * force / WIDTH
        ),
    );
    let records = run_on(k, scene);
    let report = &records.last().unwrap().report;
    let [deflection, moments @ ..] = &report.probes[..] else { panic!("{report:?}") };
    let expected = force * beta / (2.0 * k * WIDTH);
    assert!((deflection.value / expected - 1.0).abs() < 1e-3, "{} {expected}", deflection.value);
    // P/(4 β) e^(−β x) (cos β x − sin β x).
    for (moment, x) in moments.iter().zip([0.6_f64, 1.8]) {
        let expected = force / (4.0 * beta) * (-x).exp() * (x.cos() - x.sin());
        assert!((moment.value.abs() - expected.abs()).abs() < 1e-3 * force / (4.0 * beta), "{moment:?} {expected}");
    }
    assert!((report.work_n_mm / report.strain_energy_n_mm - 1.0).abs() < 1e-3, "{report:?}");
}

/// A plate that only a foundation holds against a load sinks as a whole, by p/k, and carries nothing. Nothing but points hold it
/// in its plane.
#[test]
fn a_plate_may_lie_on_it_alone() {
    let scene = |pressure: f64, support: &str| {
        strip(
            10.0,
            3,
            &format!(
                r#"
                load = {{ kind = "steps", increment = 1 }}
                support = [{support}]
                action = [{{ kind = "area-force", force_n_per_mm2 = [0, 0, {pressure}] }}]
                probe = [{{ name = "w", kind = "displacement", on = [1.0, 0.0], component = "z" }}]
                "#
            ),
        )
    };
    let in_plane =
        r#"{ on = [0, 0], kind = "fixed", hold = ["x", "y"] }, { on = [1, 0], kind = "fixed", hold = ["y"] }"#;
    let report = run_on(3.0, scene(0.06, in_plane)).pop().unwrap().report;
    assert!((report.probes[0].value - 0.02).abs() < 1e-9, "{report:?}");
    assert!((report.work_n_mm / report.strain_energy_n_mm - 1.0).abs() < 1e-9);
    let start = |scene: Scene| {
        let own: Vec<Arc<dyn TermSource>> = vec![Arc::new(Foundation(3.0))];
        Stages::with_terms(scene, own).start().unwrap_err()
    };
    let refused = |pressure: f64, support: &str| start(scene(pressure, support));
    // What neither holds is refused, and what both do.
    let mut alone = scene(0.06, in_plane);
    alone.supports.clear();
    assert!(matches!(start(alone), ModelError::FreeMotion { .. }));
    let one = refused(0.06, r#"{ on = [0, 0], kind = "fixed", hold = ["x", "y"] }"#);
    assert!(
        matches!(&one, ModelError::FreeMotion { motion, .. } if motion.contains("turn about an axis along z")),
        "{one}"
    );
    let both = format!(r#"{in_plane}, {{ kind = "rigid-motions", name = "mean" }}"#);
    assert!(matches!(refused(0.06, &both), ModelError::Unbalanced { .. }));
    let error = refused(0.0, &both);
    assert!(matches!(&error, ModelError::HeldByTerms { support, .. } if support == "mean"), "{error}");
}

/// A hinged strip under a thrust buckles in m half waves at the least of E I a² + k b/a², a = m π/L (Timoshenko & Gere, section
/// 2.10): here in three.
#[test]
fn a_strip_on_it_buckles_at_the_load_of_the_closed_form() {
    let length = 100.0_f64;
    // Three half waves where this ratio, 72 here, is between 2² 3² and 3² 4².
    let k = 72.0 * PI.powi(4) * BENDING_STIFFNESS / (WIDTH * length.powi(4));
    let thrust = |m: f64| {
        let a = m * PI / length;
        BENDING_STIFFNESS * a * a + k * WIDTH / (a * a)
    };
    let (least, waves) = (1..8).map(|m| (thrust(f64::from(m)), m)).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    assert_eq!(waves, 3);
    let scene = strip(
        length,
        24,
        &format!(
            r#"
            load = {{ kind = "steps", increment = 0.1, factor = 1.1 }}
            support = [
                {{ on = "u-start", kind = "fixed" }},
                {{ on = "u-end", kind = "fixed", hold = ["y", "z"] }},
            ]
            action = [{{ kind = "line-force", on = "u-end", force_n_per_mm = [{}, 0, 0] }}]
            "#,
            -least / WIDTH
        ),
    );
    let passed = |record: &&Record| record.report.critical_point.is_some() || record.report.jumped;
    let records = run_on(k, scene);
    let critical = records.iter().find(passed).unwrap();
    assert!((critical.report.parameter - 1.0).abs() < 5e-3, "{}", critical.report.parameter);
}

/// A bar that two forces pull apart, along x.
fn bar(length: f64, force: f64, rest: &str) -> Scene {
    strip(
        length,
        24,
        &format!(
            r#"support = [{{ kind = "rigid-motions" }}]
            action = [
                {{ kind = "line-force", on = "u-start", force_n_per_mm = [{}, 0, 0] }},
                {{ kind = "line-force", on = "u-end", force_n_per_mm = [{}, 0, 0] }},
            ]
            probe = [
                {{ name = "one", kind = "displacement", on = [0, 0.5], component = "x" }},
                {{ name = "other", kind = "displacement", on = [1, 0.5], component = "x" }},
            ]
            {rest}"#,
            -force / WIDTH,
            force / WIDTH
        ),
    )
}

/// With a spring from end to end it grows by P/(E A/L + k).
#[test]
fn a_tie_from_end_to_end_bears_its_part() {
    let (length, force) = (100.0, 0.02);
    let stiffness = YOUNGS_MODULUS * WIDTH * THICKNESS / length;
    let scene = bar(length, force, r#"load = { kind = "steps", increment = 1 }"#);
    let report = run_with(vec![Arc::new(Tie::of(2.0 * stiffness))], scene).pop().unwrap().report;
    let found = report.probes[1].value - report.probes[0].value;
    let expected = force / (3.0 * stiffness);
    assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
    assert!(report.iterations <= 3, "{report:?}");
}

/// Where the spring's own length grows by g with the parameter, all that bar and spring store it has put in, and the forces:
/// ½ g² E A/L k/(E A/L + k) without these. Step by step, and along the path.
#[test]
fn what_the_parameter_puts_in_is_work() {
    let (length, growth) = (100.0, 1e-4);
    let stiffness = YOUNGS_MODULUS * WIDTH * THICKNESS / length;
    for drive in ["", r#"continuation = { control = "arc-length" }"#] {
        for force in [1e-9, 0.1] {
            let scene = bar(length, force, &format!("load = {{ kind = \"steps\", increment = 0.25 }}\n{drive}"));
            let own: Vec<Arc<dyn TermSource>> = vec![Arc::new(Tie { growth, ..Tie::of(2.0 * stiffness) })];
            let records = run_with(own, scene);
            let reports = || records.iter().map(|record| &record.report);
            let work: f64 = reports().map(|report| report.work_n_mm).sum();
            let stored = records.last().unwrap().report.strain_energy_n_mm;
            assert!((work / stored - 1.0).abs() < 1e-5, "{work} {stored}");
            assert!(reports().all(|report| !report.jumped && report.negative_pivots == 0));
            if force < 1e-6 {
                let expected = 0.5 * growth * growth * stiffness * 2.0 / 3.0;
                assert!((stored / expected - 1.0).abs() < 1e-4, "{stored} {expected}");
            }
        }
    }
}

/// A tangent that is not symmetric, and does not say so, does not lose its half in silence.
#[test]
#[should_panic(expected = "the tangent of the term \"tie\" is not symmetric, by")]
fn a_skew_tangent_that_hides_is_refused() {
    let scene = strip(
        10.0,
        3,
        r#"load = { kind = "steps", increment = 1 }
        support = [{ on = "u-start", kind = "clamped" }]
        action = [{ kind = "line-force", on = "u-end", force_n_per_mm = [0, 0, 0.01] }]"#,
    );
    let own: Vec<Arc<dyn TermSource>> = vec![Arc::new(Tie { at_once: false, ..Tie::of(1.0) })];
    let mesh = Arc::new(starting_mesh(&scene).unwrap());
    let work = Workspace::with_terms(&scene, &mesh, &own).unwrap();
    let still = vec![[0.0; 3]; mesh.point_count()];
    Assembled::new(work.discretization()).assemble(work.discretization(), &still, 0.0, Want::Stiffness);
}

/// A section moment is refused where a term does not say what of it acts on one side.
#[test]
fn a_section_moment_asks_every_term_for_its_part() {
    let scene = strip(
        10.0,
        3,
        r#"load = { kind = "steps", increment = 1 }
        support = [{ on = "u-start", kind = "clamped" }]
        action = [{ kind = "line-force", on = "u-end", force_n_per_mm = [0, 0, 0.01] }]
        probe = [{ name = "m", kind = "section-moment", on = "u=0.5", component = "y" }]"#,
    );
    let mut stages = Stages::with_terms(scene, vec![Arc::new(Tie::of(1.0))]);
    let start = stages.start().unwrap();
    let error = stages.run(Stage::Solve, &start, &mut |_| {}).unwrap_err().to_string();
    assert!(error.contains("step 1, solve: a section moment") && error.contains("the term \"tie\""), "{error}");
}

/// Energy, forces and stiffness with it are derivatives of each other.
#[test]
fn it_stands_in_the_sums() {
    let scene = strip(
        10.0,
        3,
        r#"load = { kind = "steps", increment = 1 }
        support = [{ on = "u-start", kind = "clamped" }]
        action = [{ kind = "force", on = [1, 1], force_n = [0, 0, 1] }]"#,
    );
    let own: Vec<Arc<dyn TermSource>> = vec![Arc::new(Foundation(3.0))];
    let mesh = Arc::new(starting_mesh(&scene).unwrap());
    let work = Workspace::with_terms(&scene, &mesh, &own).unwrap();
    let field = |seed: f64| -> Vec<[f64; 3]> {
        let value = |i: usize| ((i as f64 + 1.0) * seed).fract() - 0.5;
        (0..mesh.point_count()).map(|i| [0, 1, 2].map(|c| 0.1 * value(3 * i + c))).collect()
    };
    let (shape, direction) = (field(0.618_033_988_75), field(0.732_050_807_57));
    let at = |step: f64| -> Vec<[f64; 3]> {
        shape.iter().zip(&direction).map(|(u, d)| [0, 1, 2].map(|c| u[c] + step * d[c])).collect()
    };
    let step = 1e-5;
    let energy = |step: f64| work.energy(&at(step), 0.0);
    let slope = (energy(step) - energy(-step)) / (2.0 * step);
    let forces = |step: f64| {
        work.forces(Configuration { displacement: &at(step), turns: &[], parameter: 0.0, largest_force: 0.0 })
    };
    let product = |a: &[[f64; 3]], b: &[[f64; 3]]| -> f64 {
        a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| a * b).sum()
    };
    let exact = product(&forces(0.0), &direction);
    assert!((slope / exact - 1.0).abs() < 1e-6, "{slope} {exact}");
    let (plus, minus) = (forces(step), forces(-step));
    let found: Vec<[f64; 3]> =
        plus.iter().zip(&minus).map(|(a, b)| [0, 1, 2].map(|c| (a[c] - b[c]) / (2.0 * step))).collect();
    let mut assembled = Assembled::new(work.discretization());
    assembled.assemble(work.discretization(), &shape, 0.0, Want::Stiffness);
    let exact = assembled.multiply(work.discretization(), &direction);
    let scale = product(&exact, &exact).sqrt();
    let off: Vec<[f64; 3]> = exact.iter().zip(&found).map(|(a, b)| [0, 1, 2].map(|c| a[c] - b[c])).collect();
    assert!(product(&off, &off).sqrt() < 1e-6 * scale);
}

/// A solve under a force says what the shell stores and what the foundation does, and that force did both.
#[test]
fn the_balance_of_a_solve_tells_it_apart() {
    let scene = strip(
        10.0,
        3,
        r#"load = { kind = "steps", increment = 1 }
        support = [{ on = "u-start", kind = "clamped" }]
        action = [{ kind = "line-force", on = "u-end", force_n_per_mm = [0, 0, 0.01] }]"#,
    );
    let own: Vec<Arc<dyn TermSource>> = vec![Arc::new(Foundation(3.0))];
    let mesh = Arc::new(starting_mesh(&scene).unwrap());
    let mut work = Workspace::with_terms(&scene, &mesh, &own).unwrap();
    let still = vec![[0.0; 3]; mesh.point_count()];
    let rest = Configuration { displacement: &still, turns: &[], parameter: 0.0, largest_force: 0.0 };
    let solved = Equilibrium::new(&scene, &mut work).advance(rest, 1.0, &mut |_| false).unwrap();
    let Balance { stored, of_terms, work: done, .. } = &solved.balance;
    // The shell, the force, which stores nothing, and the foundation.
    let [shell, 0.0, bed] = of_terms[..] else { panic!("{of_terms:?}") };
    assert!(bed > 0.1 * stored && shell > 0.0, "{bed} {shell}");
    assert!(((bed + shell) / stored - 1.0).abs() < 1e-12);
    // The means of the factors make of work over a straight way what a linear shell stores.
    assert!((done / stored - 1.0).abs() < 1e-3, "{done} {stored}");
}

/// What a run is made with stands in its hashes.
#[test]
fn it_is_part_of_the_identity() {
    let scene = || {
        strip(
            10.0,
            3,
            r#"load = { kind = "steps", increment = 1 }
            support = [{ on = "u-start", kind = "clamped" }]
        action = [{ kind = "force", on = [1, 1], force_n = [0, 0, 1] }]"#,
        )
    };
    let with = |k: f64| Stages::with_terms(scene(), vec![Arc::new(Foundation(k))]).hash();
    assert_eq!(Stages::new(scene()).hash(), scene().hash());
    assert_eq!(with(1.0), with(1.0));
    assert!(with(1.0) != with(2.0) && with(1.0) != scene().hash());
}
