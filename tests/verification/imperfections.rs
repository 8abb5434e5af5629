//! Imperfect geometry against closed forms and statistics.

use std::collections::HashSet;

use foldline::energy::{At, Terms};
use foldline::equilibrium::{Configuration, Workspace, linear_buckling};
use foldline::model::{ImperfectionError, ModelError, perfect_on, starting_mesh};
use foldline::pipeline::{Stages, imperfect_mesh};
use foldline::scene::{Scene, parse};
use foldline::spline::{Mesh, mid_surface_point};
use foldline::state::State;
use rayon::ThreadPoolBuilder;

use crate::support::{run, scene, steps};

fn read(text: &str) -> Scene {
    parse(text, "imperfect.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// A scene with an imperfection, or several.
fn imperfect(scene: &Scene, tables: &str) -> Scene {
    let text = scene.to_toml();
    let at = text.find("[load]").unwrap();
    read(&format!("{}{tables}\n{}", &text[..at], &text[at..]))
}

fn mesh(scene: &Scene) -> Mesh {
    imperfect_mesh(scene, &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(scene: &Scene) -> ImperfectionError {
    match imperfect_mesh(scene, &[]) {
        Err(ModelError::Imperfection(error)) => error,
        other => panic!("{other:?}"),
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|c| (a[c] - b[c]).powi(2)).sum::<f64>().sqrt()
}

/// Offset of a patch from the perfect one at a place.
fn offset(scene: &Scene, mesh: &Mesh, patch: usize, at: [f64; 2]) -> [f64; 3] {
    let perfect = perfect_on(scene, mesh).unwrap();
    let [is, was] = [mesh, &*perfect].map(|mesh| mid_surface_point(&mesh.patches[patch], &[], at).position);
    [0, 1, 2].map(|c| is[c] - was[c])
}

/// Euler's column, clamped below, pushed by a dead force of one Euler load on a section that may turn.
fn column() -> Scene {
    let euler = std::f64::consts::PI.powi(2) * 70_000.0 * 5.0 * 0.5_f64.powi(3) / 12.0 / (4.0 * 100.0 * 100.0);
    read(&format!(
        "[geometry]\nkind = \"plate\"\nlength_mm = 100.0\nwidth_mm = 5.0\n\
         [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70000.0\npoissons_ratio = 0.0\nthickness_mm = 0.5\n\
         [mesh]\nelements = [12, 1]\n[load]\nkind = \"steps\"\nfactor = 0.9\nincrement = 0.1\n\
         [[support]]\nname = \"root\"\nkind = \"clamped\"\non = \"u-start\"\n\
         [[support]]\nname = \"tip\"\nkind = \"rigid\"\non = \"u-end\"\nx_mm = \"free\"\nz_mm = \"free\"\nrotation_y_deg = \"free\"\n\
         [[action]]\nkind = \"section-force\"\nsection = \"tip\"\nforce_n = [-{euler}, 0.0, 0.0]\n\
         [[probe]]\nname = \"tip\"\nkind = \"displacement\"\non = [1.0, 0.5]\ncomponent = \"z\"\n"
    ))
}

fn tip(scene: &Scene) -> Vec<(f64, f64)> {
    let stages = run(scene.clone());
    steps(&stages).iter().map(|(state, record)| (state.parameter, record.report.probes[0].value)).collect()
}

/// A bow in the shape of the first mode grows by 1/(1 − P/P_cr): the deflection is w₀ (P/P_cr)/(1 − P/P_cr). Where the bow is small the
/// theory is exact but for the shortening, P/EA = 5e-6, which the nearness of P_cr makes ten times as much.
#[test]
fn a_bowed_column_deflects_as_southwell_says() {
    let perfect = column();
    let start = Stages::new(perfect.clone()).start().unwrap();
    let mut work = Workspace::new(&perfect, &start.mesh).unwrap();
    let critical = linear_buckling(&mut work, Configuration::of(&start), 1).unwrap().modes[0].factor;
    for amplitude in [0.02_f64, -0.02] {
        let bowed =
            imperfect(&perfect, &format!("[[imperfection]]\nkind = \"modes\"\nmodes = [1]\namplitude = {amplitude}\n"));
        let bow = offset(&bowed, &mesh(&bowed), 0, [1.0, 0.5])[2];
        assert!((bow.abs() - 0.5 * amplitude.abs()).abs() < 1e-12, "thicknesses: {bow}");
        // The sense is that of the amplitude.
        assert_eq!(bow > 0.0, offset(&bowed, &mesh(&bowed), 0, [0.7, 0.5])[2] > 0.0);
        for (load, found) in tip(&bowed) {
            let expected = bow * (load / critical) / (1.0 - load / critical);
            assert!((found / expected - 1.0).abs() < 2e-4, "{load}: {found} {expected}");
        }
        // A half wave is 1 − cos πx/2L.
        for x in [0.25, 0.5, 0.75] {
            let expected = bow * (1.0 - (std::f64::consts::FRAC_PI_2 * x).cos());
            assert!((offset(&bowed, &mesh(&bowed), 0, [x, 0.5])[2] / expected - 1.0).abs() < 1e-3);
        }
    }
    let [one, other] = [0.02, -0.02].map(|amplitude| {
        let bowed =
            imperfect(&perfect, &format!("[[imperfection]]\nkind = \"modes\"\nmodes = [1]\namplitude = {amplitude}\n"));
        offset(&bowed, &mesh(&bowed), 0, [1.0, 0.5])[2]
    });
    assert!((one + other).abs() < 1e-12);
}

/// A perfect column stays straight up to its bifurcation and is unstable beyond; a bowed one bends from the start, and is stable all
/// the way.
#[test]
fn an_imperfect_column_has_no_bifurcation() {
    let mut perfect = column();
    perfect.load.set_target(1.2);
    let negative = |scene: &Scene| {
        let stages = run(scene.clone());
        let last = steps(&stages).last().unwrap().1.clone();
        (last.report.negative_pivots, last.report.probes[0].value)
    };
    let (unstable, straight) = negative(&perfect);
    assert_eq!(unstable, 1);
    assert!(straight.abs() < 1e-6);
    let bowed = imperfect(&perfect, "[[imperfection]]\nkind = \"modes\"\nmodes = [1]\namplitude = 0.5\n");
    let stages = run(bowed);
    let mut before = 0.0;
    for (state, record) in steps(&stages) {
        assert_eq!(record.report.negative_pivots, 0, "at {}", state.parameter);
        let deflection = record.report.probes[0].value.abs();
        assert!(deflection > before, "it grows all the way");
        before = deflection;
    }
    // The elastica: K(k) = π/2 √1.2 has k = 0.559, and w/L = 2k/K = 0.649 (Timoshenko & Gere, section 2.7); the bow adds to it.
    assert!((before / 100.0 - 0.649).abs() < 5e-3, "{before}");
}

/// The boom of the shipped scene on a coarse mesh.
fn boom() -> Scene {
    let mut boom = scene("structures/trac-boom.toml");
    boom.shells.iter_mut().for_each(|shell| shell.mesh.elements = [8, 6]);
    boom.load.set_target(0.1);
    boom
}

const FIELD: &str =
    "[[imperfection]]\nname = \"field\"\nkind = \"random-field\"\nseed = 3\ncorrelation_mm = 60.0\ndeviation = 0.5\n";
const MODES: &str =
    "[[imperfection]]\nname = \"modes\"\nkind = \"modes\"\nmodes = [1, 2, 4]\namplitude = 0.5\nseed = 5\n";

/// The imperfect geometry is the reference: shells, bonds and joints are at rest in it.
#[test]
fn an_imperfect_structure_is_free_of_stress() {
    let mut frame = scene("structures/right-angle-frame.toml");
    // Edges with different elements are held together by penalties.
    frame.shells[1].mesh.elements = [8, 3];
    frame.shells[0].mesh.elements = [8, 2];
    for (scene, tables) in [(boom(), FIELD.to_owned() + MODES), (frame, FIELD.replace("60.0", "80.0"))] {
        let scene = imperfect(&scene, &tables);
        let start = Stages::new(scene.clone()).start().unwrap();
        let work = Workspace::new(&scene, &start.mesh).unwrap();
        let still = vec![[0.0; 3]; start.mesh.point_count()];
        let stiff = |forces: Vec<[f64; 3]>| forces.into_iter().flatten().fold(0.0_f64, |most, f| most.max(f.abs()));
        let discretization = work.discretization();
        let at = At { mesh: &start.mesh, displacement: &still, parameter: 0.0 };
        let largest = stiff(discretization.terms.forces(at)).max(stiff(work.forces(Configuration::of(&start))));
        // E t is 13100 N/mm: rounding of lengths of 100 mm is 1e-10 N.
        assert!(largest < 1e-8, "{largest}");
        assert!(work.energy(&still, 0.0) < 1e-18, "{}", work.energy(&still, 0.0));
    }
}

/// What is glued is glued, however the shells are bent: the bond of the imperfect boom has the points of the perfect one.
#[test]
fn a_bond_holds_the_same_area() {
    let pairs = |scene: &Scene, mesh: &Mesh| {
        let terms = Terms::on(scene, mesh, &[]).unwrap();
        terms.pairs().into_iter().collect::<HashSet<_>>()
    };
    let perfect = boom();
    let scene = imperfect(&perfect, &FIELD.replace("0.5", "2.0"));
    let mesh = mesh(&scene);
    assert_ne!(mesh, starting_mesh(&perfect).unwrap());
    assert_eq!(pairs(&scene, &mesh), pairs(&perfect, &starting_mesh(&perfect).unwrap()));
}

/// Shells that share control points go on doing so, and joints whose edges have other elements stay within rounding of the field.
#[test]
fn joined_shells_stay_together() {
    let frame = scene("structures/right-angle-frame.toml");
    let scene = imperfect(&frame, &FIELD.replace("60.0", "40.0"));
    let mesh = mesh(&scene);
    for k in 0..=20 {
        let v = f64::from(k) / 20.0;
        let [one, other] =
            [(0, [1.0, v]), (1, [0.0, v])].map(|(patch, at)| mid_surface_point(&mesh.patches[patch], &[], at));
        assert!(distance(one.position, other.position) < 1e-13, "{v}: {}", distance(one.position, other.position));
        assert!(distance(offset(&scene, &mesh, 0, [1.0, v]), [0.0; 3]) > 1e-3, "the edge itself moves");
    }
    let apart = "[[imperfection]]\nname = \"dent\"\nkind = \"grid\"\nshell = \"arm\"\nu = [0.0, 0.5, 1.0]\nv = [0.0, 1.0]\n\
                 offsets_mm = [0.1, 0.1, 0.0, 0.0, 0.0, 0.0]\n";
    let error = refused(&imperfect(&frame, apart));
    assert!(matches!(error, ImperfectionError::Parts { off_mm, .. } if (off_mm - 0.1).abs() < 1e-12), "{error}");
}

/// The same on one thread and on two, from any stage on, and another for another seed.
#[test]
fn a_seed_gives_one_chain() {
    let scene = imperfect(&boom(), &(FIELD.to_owned() + MODES));
    let on = |threads: usize, scene: &Scene| {
        ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| run(scene.clone()))
    };
    let hashes =
        |stages: &[(State, foldline::record::Record)]| stages.iter().map(|(state, _)| state.hash()).collect::<Vec<_>>();
    let (one, two) = (on(1, &scene), on(2, &scene));
    assert_eq!(hashes(&one), hashes(&two));
    for from in 0..one.len() - 1 {
        let mut stages = Stages::new(scene.clone());
        let (next, _) = stages.run(one[from + 1].1.report.stage, &one[from].0, &mut |_| {}).unwrap();
        assert_eq!(next.hash(), one[from + 1].0.hash(), "stage {}", from + 1);
    }
    let meshes: HashSet<_> = [("seed = 3", "seed = 4"), ("seed = 5", "seed = 6"), ("seed = 5", "seed = 5")]
        .map(|(is, other)| mesh(&imperfect(&boom(), &(FIELD.to_owned() + MODES).replace(is, other))).hash())
        .into_iter()
        .collect();
    assert_eq!(meshes.len(), 3);
    // A scene as the log keeps it is the same scene.
    let again = read(&scene.to_toml());
    assert_eq!((again.hash(), mesh(&again).hash()), (scene.hash(), mesh(&scene).hash()));
}

/// A mesh that refines itself keeps its imperfect geometry, and every stage follows from the one before.
#[test]
fn a_mesh_that_refines_stays_imperfect() {
    let mut frame = scene("structures/right-angle-frame.toml");
    frame.shells.iter_mut().for_each(|shell| shell.mesh.elements = [4, 1]);
    frame.load.set_target(0.5);
    let text = imperfect(&frame, &FIELD.replace("60.0", "150.0")).to_toml().replacen(
        "[pipeline]\nstages = [\"solve\"]\n",
        "",
        1,
    );
    let scene = read(
        &(text
            + "[adapt]\nthreshold = 0.05\nlength_limit_mm = 5.0\n[pipeline]\nstages = [\"solve\", \"evaluate-indicators\", \"refine-knots\", \"project-displacements\", \"re-equilibrate\"]\n"),
    );
    let stages = run(scene.clone());
    let (first, last) = (mesh(&scene), &stages.last().unwrap().0.mesh);
    assert!(last.elements().count() > first.elements().count());
    for (patch, at) in [(0, [0.3, 0.4]), (1, [0.9, 0.1])] {
        let [a, b] = [&first, &**last].map(|mesh| mid_surface_point(&mesh.patches[patch], &[], at).position);
        assert!(distance(a, b) < 1e-12);
        assert!(distance(offset(&scene, last, patch, at), offset(&scene, &first, patch, at)) < 1e-12);
    }
    for from in (0..stages.len() - 1).step_by(3) {
        let (next, _) =
            Stages::new(scene.clone()).run(stages[from + 1].1.report.stage, &stages[from].0, &mut |_| {}).unwrap();
        assert_eq!(next.hash(), stages[from + 1].0.hash(), "stage {}", from + 1);
    }
}

/// A panel whose mesh gets finer shows the same field, with the order of the spline: an error of h⁴ for cubics.
#[test]
fn a_field_does_not_hang_on_the_mesh() {
    let panel = |elements: usize| {
        let text = format!(
            "[geometry]\nkind = \"cylinder-panel\"\nlength_mm = 60.0\nradius_mm = 40.0\narc_deg = 80.0\n\
             [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70000.0\npoissons_ratio = 0.3\nthickness_mm = 0.5\n\
             [mesh]\ndegree = [3, 3]\nelements = [{elements}, {elements}]\n{}[load]\nkind = \"steps\"\nfactor = 1.0\nincrement = 1.0\n\
             [[support]]\nkind = \"clamped\"\non = \"u-start\"\n[[action]]\nkind = \"pressure\"\npressure_mpa = 0.001\n",
            FIELD.replace("60.0", "25.0")
        );
        read(&text)
    };
    let fine = panel(96);
    let exact = mesh(&fine);
    let error = |elements: usize| {
        let (scene, mut most) = (panel(elements), 0.0_f64);
        let mesh = mesh(&scene);
        for k in 0..200 {
            let at = [(f64::from(k) * 0.618).fract(), (f64::from(k) * 0.414).fract()];
            let [a, b] = [&mesh, &exact].map(|mesh| mid_surface_point(&mesh.patches[0], &[], at).position);
            most = most.max(distance(a, b));
        }
        most
    };
    let errors = [6, 12, 24].map(error);
    println!("{errors:?}");
    assert!(errors[1] < errors[0] / 8.0 && errors[2] < errors[1] / 8.0, "{errors:?}");
    assert!(errors[2] < 1e-3 * 0.25, "a thousandth of the deviation: {errors:?}");
}

/// The spline of the panel has the variance and the correlation of the field: over 400 seeds, of 9 waves' worth of places each.
#[test]
fn the_surface_has_the_variance_and_the_correlation() {
    const SEEDS: u32 = 400;
    let plate = |seed: u32| {
        read(&format!(
            "[geometry]\nkind = \"plate\"\nlength_mm = 100.0\nwidth_mm = 100.0\n\
             [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70000.0\npoissons_ratio = 0.3\nthickness_mm = 0.5\n\
             [mesh]\nelements = [12, 12]\n[[imperfection]]\nkind = \"random-field\"\nseed = {seed}\ncorrelation_mm = 30.0\ndeviation = 0.2\n\
             [load]\nkind = \"steps\"\nfactor = 1.0\nincrement = 1.0\n\
             [[support]]\nkind = \"clamped\"\non = \"u-start\"\n[[action]]\nkind = \"pressure\"\npressure_mpa = 0.001\n"
        ))
    };
    let places = [0.1, 0.25, 0.4, 0.7].map(|u| [u, 0.3]);
    let mut products = [0.0; 4];
    for seed in 0..SEEDS {
        let mesh = mesh(&plate(seed));
        let heights = places.map(|at| mid_surface_point(&mesh.patches[0], &[], at).position[2] / 0.1);
        (0..4).for_each(|k| products[k] += heights[0] * heights[k] / f64::from(SEEDS));
    }
    // The mean of 400 products is off by up to √(2/400) = 7 % in the standard deviation; four of them are allowed.
    for (product, apart) in products.into_iter().zip([0.0_f64, 15.0, 30.0, 60.0]) {
        let expected = (-(apart / 30.0).powi(2)).exp();
        assert!(
            (product - expected).abs() < 4.0 * (2.0 / f64::from(SEEDS)).sqrt(),
            "{product} at {apart}, not {expected}"
        );
    }
}

/// A plate with the sagitta of a cylinder measured on it is the cylinder: as a cantilever it is as stiff as one that is drawn.
#[test]
fn a_measured_cylinder_is_a_cylinder() {
    let (radius, width, points) = (30.0_f64, 40.0, 41);
    let places: Vec<f64> = (0..points).map(|k| f64::from(k) / f64::from(points - 1)).collect();
    let sagitta: Vec<f64> =
        places.iter().map(|v| (radius * radius - (width * (v - 0.5)).powi(2)).sqrt() - radius).collect();
    let arc = 2.0 * (0.5 * width / radius).asin().to_degrees();
    let text = |geometry: &str, imperfection: &str| {
        read(&format!(
            "{geometry}[material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70000.0\npoissons_ratio = 0.3\nthickness_mm = 1.0\n\
             [mesh]\ndegree = [3, 3]\nelements = [12, 24]\n{imperfection}[load]\nkind = \"steps\"\nfactor = 1.0\nincrement = 1.0\n\
             [[support]]\nkind = \"clamped\"\non = \"u-start\"\n[[support]]\nname = \"end\"\nkind = \"rigid\"\non = \"u-end\"\nx_mm = \"free\"\nz_mm = \"free\"\nrotation_y_deg = \"free\"\n\
             [[action]]\nkind = \"section-force\"\nsection = \"end\"\nforce_n = [0.0, 0.0, 0.01]\n"
        ))
    };
    let grid = format!(
        "[[imperfection]]\nname = \"sagitta\"\nkind = \"grid\"\nu = [0.0, 1.0]\nv = {places:?}\noffsets_mm = {:?}\n",
        [&sagitta[..], &sagitta[..]].concat()
    );
    let measured = text("[geometry]\nkind = \"plate\"\nlength_mm = 100.0\nwidth_mm = 40.0\n", &grid);
    let drawn = text(
        &format!("[geometry]\nkind = \"cylinder-panel\"\nlength_mm = 100.0\nradius_mm = {radius}\narc_deg = {arc}\n"),
        "",
    );
    let mesh = mesh(&measured);
    // 5/384 h⁴ f⁗ of cubics on elements of 1.7 mm is 9e-5 mm where the cylinder is steepest; at ends it is some times that.
    for k in 0..=50 {
        let [_, y, z] = mid_surface_point(&mesh.patches[0], &[], [0.37, f64::from(k) / 50.0]).position;
        assert!(((y - 0.5 * width).hypot(z + radius) - radius).abs() < 5e-4, "{y} {z}");
    }
    let energy = |scene: &Scene| run(scene.clone()).pop().unwrap().1.report.strain_energy_n_mm;
    let (one, other) = (energy(&measured), energy(&drawn));
    assert!((one / other - 1.0).abs() < 2e-3, "{one} {other}");
    let mut flat = measured.clone();
    flat.imperfections.clear();
    assert!(energy(&flat) > 10.0 * one, "a plate is much softer");
}

/// A square plate under the same pressure on two sides has modes in pairs; which two of their sums are found hangs on rounding, and what
/// the imperfection takes does not.
#[test]
fn modes_of_one_load_factor_do_not_hang_on_rounding() {
    let plate = |modulus: f64, mode: usize| {
        read(&format!(
            "[geometry]\nkind = \"plate\"\nlength_mm = 50.0\nwidth_mm = 50.0\n\
             [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = {modulus}\npoissons_ratio = 0.3\nthickness_mm = 0.5\n\
             [mesh]\nelements = [8, 8]\n[[imperfection]]\nkind = \"modes\"\nmodes = [{mode}]\namplitude = 1.0\n\
             [load]\nkind = \"steps\"\nfactor = 1.0\nincrement = 1.0\n\
             [[support]]\non = \"u-start\"\nkind = \"displacement\"\nx_mm = 0.001\nz_mm = 0.0\n[[support]]\non = \"u-end\"\nkind = \"displacement\"\nx_mm = -0.001\nz_mm = 0.0\n\
             [[support]]\non = \"v-start\"\nkind = \"displacement\"\ny_mm = 0.001\nz_mm = 0.0\n[[support]]\non = \"v-end\"\nkind = \"displacement\"\ny_mm = -0.001\nz_mm = 0.0\n"
        ))
    };
    let start = |scene: &Scene| starting_mesh(scene).unwrap();
    let mut perfect = plate(70_000.0, 1);
    perfect.imperfections.clear();
    let state = Stages::new(perfect.clone()).start().unwrap();
    let mut work = Workspace::new(&perfect, &state.mesh).unwrap();
    let found = linear_buckling(&mut work, Configuration::of(&state), 3).unwrap().modes;
    assert!((found[1].factor / found[2].factor - 1.0).abs() < 1e-9, "a pair");
    assert!(found[1].factor / found[0].factor > 2.0);
    for mode in [1, 2, 3] {
        // One digit of the last place.
        let [one, other] = [70_000.0, 70_000.0 * (1.0 + 3e-16)].map(|modulus| {
            let scene = plate(modulus, mode);
            let moved = mesh(&scene);
            moved.points().zip(start(&scene).points()).map(|(is, was)| is[2] - was[2]).collect::<Vec<f64>>()
        });
        let most = one.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(most < 1e-6, "mode {mode}: {most}");
    }
}

#[test]
fn imperfections_that_cannot_be_are_refused() {
    // A part that stands for the whole keeps its planes: a field does not, modes do.
    let half = "[geometry]\nkind = \"plate\"\nlength_mm = 50.0\nwidth_mm = 20.0\n\
                [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70000.0\npoissons_ratio = 0.3\nthickness_mm = 0.5\n\
                [mesh]\nelements = [6, 4]\n[load]\nkind = \"steps\"\nfactor = 1.0\nincrement = 1.0\n\
                [[support]]\non = \"u-start\"\nkind = \"displacement\"\nx_mm = 0.01\ny_mm = 0.0\nz_mm = 0.0\n[[support]]\nname = \"middle\"\non = \"u-end\"\nkind = \"symmetric\"\n";
    let half = read(half);
    let error = refused(&imperfect(&half, FIELD));
    assert!(matches!(&error, ImperfectionError::OffPlane { support, .. } if support == "middle"), "{error}");
    let bowed = imperfect(&half, "[[imperfection]]\nkind = \"modes\"\nmodes = [1]\namplitude = 1.0\n");
    assert!(Stages::new(bowed.clone()).start().is_ok());
    assert!(offset(&bowed, &mesh(&bowed), 0, [1.0, 0.5])[2].abs() > 0.4);
    let quarter = imperfect(&scene("baseline-quarter.toml"), FIELD);
    assert!(matches!(refused(&quarter), ImperfectionError::OffPlane { .. }));

    let column = column();
    let with = |table: &str| refused(&imperfect(&column, table));
    let error = with("[[imperfection]]\nkind = \"modes\"\nmodes = [200]\namplitude = 1.0\n");
    assert!(matches!(error, ImperfectionError::NoSuchMode { mode: 200, .. }), "{error}");
    let error = with("[[imperfection]]\nkind = \"modes\"\nmodes = [1]\namplitude = 20.0\n");
    assert!(matches!(error, ImperfectionError::TooLarge { limit_mm, .. } if (limit_mm - 5.0).abs() < 1e-9), "{error}");
    let error = with("[[imperfection]]\nkind = \"random-field\"\nseed = 1\ncorrelation_mm = 0.5\ndeviation = 2.0\n");
    assert!(matches!(error, ImperfectionError::NoShell { .. }), "{error}");
    let mut pulled = column.clone();
    pulled.actions[0].kind = foldline::scene::ActionKind::SectionForce { section: "tip".into(), force_n: [0.0; 3] };
    let error = refused(&imperfect(&pulled, "[[imperfection]]\nkind = \"modes\"\nmodes = [1]\namplitude = 1.0\n"));
    assert!(matches!(error, ImperfectionError::NoModes { .. }), "{error}");
}

/// A log says how imperfect its geometry is, and what of it the mesh does not show.
#[test]
fn what_is_imperfect_is_said() {
    let remarks = |tables: &str| {
        let mut stages = Stages::new(imperfect(&column(), tables));
        let start = stages.start().unwrap();
        stages.remarks(&start).unwrap()
    };
    let [bow] = &remarks("[[imperfection]]\nkind = \"modes\"\nmodes = [1]\namplitude = 0.5\n")[..] else { panic!() };
    assert!(bow.contains("up to 0.5 thicknesses, 0.25 mm, off the perfect one, at (100, "), "{bow}");
    let [_, lost] = &remarks(
        "[[imperfection]]\nname = \"fine\"\nkind = \"random-field\"\nseed = 1\ncorrelation_mm = 6.0\ndeviation = 0.02\n",
    )[..] else {
        panic!()
    };
    assert!(lost.contains("% of imperfection \"fine\""), "{lost}");
    assert!(remarks("").is_empty());
}

/// A closed tube stays closed and smooth across its seam, and shells that a smooth joint ties have as many derivatives as before.
#[test]
fn ties_hold_in_an_imperfect_surface() {
    let material =
        "[material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70000.0\npoissons_ratio = 0.3\nthickness_mm = 0.5\n";
    let rest = "[load]\nkind = \"steps\"\nfactor = 1.0\nincrement = 1.0\n[[action]]\nkind = \"pressure\"\npressure_mpa = 0.001\n";
    let field = FIELD.replace("60.0", "30.0");
    let tube = read(&format!(
        "[geometry]\nkind = \"cylinder-panel\"\nlength_mm = 60.0\nradius_mm = 20.0\narc_deg = 360.0\nseam = \"smooth\"\n{material}\
         [mesh]\nelements = [6, 12]\n{field}[[support]]\nkind = \"clamped\"\non = \"u-start\"\n{rest}"
    ));
    assert!(Stages::new(tube.clone()).start().is_ok());
    let mesh_of_tube = mesh(&tube);
    for k in 0..=10 {
        let u = f64::from(k) / 10.0;
        let [start, end] = [0.0, 1.0].map(|v| mid_surface_point(&mesh_of_tube.patches[0], &[], [u, v]));
        assert!(distance(start.position, end.position) < 1e-13);
        let normal = |d: [[f64; 3]; 5]| {
            let n = [0, 1, 2].map(|c| d[0][(c + 1) % 3] * d[1][(c + 2) % 3] - d[0][(c + 2) % 3] * d[1][(c + 1) % 3]);
            n.map(|x| x / distance(n, [0.0; 3]))
        };
        assert!(distance(normal(start.derivatives), normal(end.derivatives)) < 1e-12, "{u}");
    }
    let halves = read(&format!(
        "{material}[mesh]\ndegree = [4, 3]\nelements = [4, 3]\n\
         [[shell]]\nname = \"one\"\n[shell.geometry]\nkind = \"plate\"\nlength_mm = 20.0\nwidth_mm = 10.0\n\
         [[shell]]\nname = \"two\"\nposition_mm = [20.0, 0.0, 0.0]\n[shell.geometry]\nkind = \"plate\"\nlength_mm = 20.0\nwidth_mm = 10.0\n\
         [[joint]]\nkind = \"smooth\"\nedges = [\"one.u-end\", \"two.u-start\"]\n{field}\
         [[support]]\nkind = \"clamped\"\non = \"u-start\"\nshell = \"one\"\n{}",
        rest.replace("kind = \"pressure\"", "kind = \"pressure\"\nshell = \"two\"")
    ));
    let unknowns = |scene: &Scene| {
        let mut stages = Stages::new(scene.clone());
        let start = stages.start().unwrap();
        (stages.unknowns(&start).unwrap(), Terms::on(scene, &start.mesh, &[]).unwrap().pairs().len())
    };
    let mut perfect = halves.clone();
    perfect.imperfections.clear();
    // As many unknowns: every tie of the perfect one. No joint has an energy.
    assert_eq!(unknowns(&halves), unknowns(&perfect));
}
