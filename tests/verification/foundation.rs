//! An energy of one's own: an elastic foundation, ½ k w² on every mm² of the undeformed shell.

use std::f64::consts::PI;
use std::sync::Arc;

use foldline::equilibrium::{Assembled, Balance, Equilibrium, Standing, Want, Workspace};
use foldline::model::{At, ModelError, Tables, Tangent, Term, TermSource, starting_mesh};
use foldline::pipeline::{MemorySink, Record, Run, Stages};
use foldline::scene::{Scene, parse};
use foldline::shell::gauss_legendre;
use foldline::spline::{Mesh, Spans, evaluate_surface, mid_surface_point};
use foldline::state::Hash;

/// Of stiffness k, N/mm³, under a plate in the plane z = 0.
#[derive(Debug)]
struct Foundation(f64);

impl TermSource for Foundation {
    fn name(&self) -> &str {
        "elastic foundation"
    }

    fn hash(&self) -> Hash {
        blake3::hash(&self.0.to_le_bytes())
    }

    fn on(&self, _: &Scene, mesh: &Mesh, _: &Tables) -> Result<Box<dyn Term>, ModelError> {
        let [along, across] = [0, 1].map(|way| {
            let spans = Spans::of(&mesh.knots[way], mesh.degree[way]).bounds.into_iter();
            let rule = gauss_legendre(mesh.degree[way] + 1);
            let in_span = |[from, to]: [f64; 2]| rule.clone().into_iter().map(move |[x, w]| [from, to, x, w]);
            let point = |[from, to, x, w]: [f64; 4]| (0.5 * (from + to + (to - from) * x), 0.5 * (to - from) * w);
            spans.flat_map(in_span).map(point).collect::<Vec<_>>()
        });
        let pairs = along.iter().flat_map(|one| across.iter().map(move |other| (one, other)));
        let spring = |((u, one), (v, other)): (&(f64, f64), &(f64, f64))| {
            let (first, [values, ..]) = evaluate_surface(mesh, [*u, *v]);
            let [a1, a2, ..] = mid_surface_point(mesh, &[], [*u, *v]).derivatives;
            let shares = mesh.window(first).zip(values).collect();
            Spring { shares, stiffness: self.0 * one * other * (a1[0] * a2[1] - a1[1] * a2[0]) }
        };
        Ok(Box::new(Bed(pairs.map(spring).collect())))
    }
}

/// The foundation on a mesh.
#[derive(Debug)]
struct Bed(Vec<Spring>);

#[derive(Debug)]
struct Spring {
    /// Control points with their functions.
    shares: Vec<(usize, f64)>,
    /// N/mm.
    stiffness: f64,
}

impl Spring {
    fn deflection(&self, at: At) -> f64 {
        self.shares.iter().map(|(point, share)| share * at.displacement[*point][2]).sum()
    }
}

impl Term for Bed {
    fn energy(&self, at: At) -> f64 {
        self.0.iter().map(|spring| 0.5 * spring.stiffness * spring.deflection(at).powi(2)).sum()
    }

    fn add_forces(&self, at: At, forces: &mut [[f64; 3]]) {
        for spring in &self.0 {
            let force = spring.stiffness * spring.deflection(at);
            spring.shares.iter().for_each(|(point, share)| forces[*point][2] -= share * force);
        }
    }

    fn has_tangent(&self) -> bool {
        true
    }

    fn add_tangent(&self, _: At, tangent: &mut Tangent) {
        for Spring { shares, stiffness } in &self.0 {
            for (i, one) in shares {
                for (j, other) in shares {
                    tangent.add([*i, *j], [[0.0; 3], [0.0; 3], [0.0, 0.0, -stiffness * one * other]]);
                }
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
    let mut stages = Stages::with_terms(scene, vec![Arc::new(Foundation(foundation))]);
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
            probe = [{{ name = "w", kind = "displacement", on = [0.0, 0.5], component = "z" }}]
            "#,
            0.5 * force / WIDTH
        ),
    );
    let records = run_on(k, scene);
    let report = &records.last().unwrap().report;
    let expected = force * beta / (2.0 * k * WIDTH);
    assert!((report.probes[0].value / expected - 1.0).abs() < 1e-3, "{} {expected}", report.probes[0].value);
    assert!((report.work_n_mm / report.strain_energy_n_mm - 1.0).abs() < 1e-3, "{report:?}");
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
    let mut work = Workspace::with_terms(&scene, &mesh, &own).unwrap();
    let field = |seed: f64| -> Vec<[f64; 3]> {
        let value = |i: usize| ((i as f64 + 1.0) * seed).fract() - 0.5;
        (0..mesh.control_points.len()).map(|i| [0, 1, 2].map(|c| 0.1 * value(3 * i + c))).collect()
    };
    let (shape, direction) = (field(0.618_033_988_75), field(0.732_050_807_57));
    let at = |step: f64| -> Vec<[f64; 3]> {
        shape.iter().zip(&direction).map(|(u, d)| [0, 1, 2].map(|c| u[c] + step * d[c])).collect()
    };
    let step = 1e-5;
    let energy = |step: f64| work.energy(&at(step), 0.0);
    let slope = (energy(step) - energy(-step)) / (2.0 * step);
    let mut forces =
        |step: f64| work.forces(Standing { displacement: &at(step), turns: &[], parameter: 0.0, largest_force: 0.0 });
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
    let still = vec![[0.0; 3]; mesh.control_points.len()];
    let rest = Standing { displacement: &still, turns: &[], parameter: 0.0, largest_force: 0.0 };
    let solved = Equilibrium::new(&scene, &mut work).advance(rest, 1.0, &mut |_| false).unwrap();
    let Balance { stored, of_terms, work: done, .. } = &solved.balance;
    // The force, which stores nothing, is the first term.
    let [0.0, bed] = of_terms[..] else { panic!("{of_terms:?}") };
    let at = At { mesh: &mesh, displacement: &solved.displacement, parameter: 1.0 };
    let shell = work.energy(&solved.displacement, 1.0) - work.discretization().terms.energy(at);
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
