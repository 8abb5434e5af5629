//! Meshes refined by the error that they cause: estimates against converged values, tolerances that are kept, knots taken out.

use foldline::adapt::{Coarsened, DirectionalError, Enriched, project_displacements};
use foldline::model::starting_patch;
use foldline::record::Record;
use foldline::scene::{Adapt, Indicator, LengthLimit, Scene, Splitting, Stage, parse};
use foldline::state::State;
use foldline::study::{equilibrium_path, snaps};

use crate::benchmarks::read;
use crate::support::{of, run, scene, steps};

/// The moment of the baseline at 8°, N·mm, by independent solvers.
const AT_8: f64 = 285.78;

fn by_error(mut scene: Scene, tolerance: f64) -> Scene {
    let indicator = Indicator::Error(tolerance);
    scene.adapt = Some(Adapt { indicator, length_limit: LengthLimit::Thickness, splitting: Splitting::Halves });
    scene.pipeline = Stage::REFINING.to_vec();
    scene
}

fn quarter(degree: [usize; 2], elements: [usize; 2], target: f64, increment: f64) -> Scene {
    let mut quarter = scene("baseline-quarter.toml");
    (quarter.mesh.degree, quarter.mesh.elements) = (degree, elements);
    quarter.load.set_target(target);
    let foldline::scene::Load::EndRotation(load) = &mut quarter.load else { panic!("its ends turn") };
    load.increment_deg = increment;
    quarter
}

fn moment_at(stages: &[(State, Record)], parameter: f64) -> f64 {
    let settled = steps(stages);
    settled.iter().find(|(state, _)| (state.parameter - parameter).abs() < 1e-9).unwrap().0.moment_n_mm
}

/// What halving the spans of one direction would change of the moment.
fn error_of(scene: &Scene, state: &State, direction: usize) -> DirectionalError {
    let mut enriched = Enriched::new(scene, &[], &state.mesh, direction).unwrap();
    let measured = enriched.error_of(state, state.moment_n_mm, &|work, at| Ok(work.end_moment(scene, at)));
    measured.unwrap().unwrap()
}

/// On uniform meshes that are off by 0.8 and 0.1 % the two directions together foresee the error, with its sign, and the shares
/// of the spans make up the energy where the arc has too few.
#[test]
fn the_estimate_is_the_error_of_the_moment() {
    for (degree, elements, off) in [([3, 3], [16, 8], 0.008), ([3, 3], [8, 8], 0.01), ([4, 4], [8, 4], 0.002)] {
        let mut uniform = quarter(degree, elements, 8.0, 2.0);
        (uniform.adapt, uniform.pipeline) = (None, vec![Stage::Solve]);
        let stages = run(uniform.clone());
        let state = &stages.last().unwrap().0;
        let errors = [0, 1].map(|direction| error_of(&uniform, state, direction));
        let foreseen = errors.iter().map(|error| error.measured).sum::<f64>();
        let found = AT_8 - state.moment_n_mm;
        println!("{degree:?} {elements:?}: {found:.3} found, {foreseen:.3} foreseen, of {:.2}", state.moment_n_mm);
        assert!(found.abs() > 0.2 * off * AT_8, "{degree:?} {elements:?} is off by {found}");
        assert!((foreseen / found - 1.0).abs() < 0.25, "{degree:?} {elements:?}: {foreseen} foreseen, {found} found");
        if (degree, elements) == ([3, 3], [16, 8]) {
            let [_, across] = errors;
            let shares: f64 = across.shares.iter().sum();
            assert!((0.8..1.2).contains(&(shares / across.energy)), "{shares} of {}", across.energy);
        }
    }
}

/// Whatever mesh the run starts with, coarser than that of the paper or finer.
#[test]
fn a_tolerance_is_kept_before_the_snap() {
    for tolerance in [0.01, 0.001] {
        for (degree, elements) in [([3, 5], [4, 2]), ([3, 3], [2, 4]), ([4, 4], [6, 10])] {
            let stages = run(by_error(quarter(degree, elements, 8.8, 0.8), tolerance));
            let off = moment_at(&stages, 8.0) / AT_8 - 1.0;
            println!("{tolerance} {degree:?} {elements:?}: {off:.5}");
            assert!(off.abs() < tolerance + 2e-5, "{tolerance}, {degree:?} from {elements:?}: {off}");
        }
    }
}

/// The deflection of a cantilever under a shear force (Sze, Liu & Lo 2004), by its first probe.
#[test]
fn a_tolerance_is_kept_by_a_probe() {
    let mut cantilever = read("cantilever-end-shear");
    (cantilever.mesh.degree, cantilever.mesh.elements) = ([3, 3], [1, 1]);
    let w = cantilever.probes.iter().position(|probe| probe.name == "w").unwrap();
    cantilever.probes.swap(0, w);
    let stages = run(by_error(cantilever, 0.002));
    let (_, record) = steps(&stages).into_iter().next_back().unwrap();
    let last = of(&stages, Stage::Solve).chain(of(&stages, Stage::ReEquilibrate)).map(|(_, record)| record);
    let found = last.filter(|record| record.report.step == stages.last().unwrap().1.report.step).last().unwrap();
    let off = found.report.probes[0].value / 6.698 - 1.0;
    assert!(off.abs() < 0.003, "{off} on {:?}", record.report.elements);
}

/// Knots come in behind the snap and leave again where the fold has grown over them; the moment stays that of the fold.
#[test]
fn knots_leave_a_fold_that_has_grown() {
    let mut folding = by_error(quarter([3, 5], [4, 4], 52.0, 0.4), 0.01);
    folding.pipeline.push(Stage::CoarsenKnots);
    let stages = run(folding);
    let elements = |(state, _): &(State, Record)| state.mesh.elements().count();
    let coarsened = stages.windows(2).filter(|pair| pair[1].1.report.stage == Stage::CoarsenKnots);
    let counts: Vec<[usize; 2]> = coarsened.map(|pair| [elements(&pair[0]), elements(&pair[1])]).collect();
    assert!(!counts.is_empty() && counts.iter().all(|[before, after]| after < before), "{counts:?}");
    let moment = stages.last().unwrap().0.moment_n_mm;
    assert!((moment / 28.3 - 1.0).abs() < 0.015, "{moment}");
}

/// A coarse mesh passes the limit point of the baseline, which a finer one jumps at: the run returns to before it, and locates the
/// jump where independent solvers have it. What the coarse mesh found beyond is no part of the path.
#[test]
fn a_jump_on_refining_is_located_on_the_finer_mesh() {
    let mut bending = parse(include_str!("../restart/tolerance.toml"), "tolerance.toml").unwrap();
    bending.load.set_target(12.0);
    bending.solver.snap_tolerance_deg = Some(0.02);
    let records: Vec<Record> = run(bending).into_iter().map(|(_, record)| record).collect();
    let returned = records.iter().position(|record| record.report.returned_from().is_some()).expect("it returns");
    let jumped = records.iter().position(|record| record.report.jumped).unwrap();
    println!("from {:?} to {}", records[returned].report.returned_from(), records[returned].report.parameter);
    assert!(returned < jumped && records[jumped].report.stage == Stage::Solve);
    assert!(records[returned].report.returned_from().unwrap() > records[returned].report.parameter + 0.5);
    let path = equilibrium_path(&records);
    assert!(path.windows(2).all(|pair| pair[0].parameter <= pair[1].parameter));
    let snap = snaps(&records)[0];
    assert!(snap.after - snap.before < 0.021, "{snap:?}");
    assert!((snap.after - 9.906).abs() < 0.1, "{snap:?}");
}

/// What a coarser space can show comes back exactly, with weights and in both directions; knots of the start do not leave.
#[test]
fn what_the_coarser_space_can_show_is_not_changed() {
    let start = starting_patch(&quarter([3, 4], [4, 4], 8.0, 2.0)).unwrap();
    let inserted = [vec![0.1, 0.3, 0.6], vec![0.2, 0.9]];
    let finer = start.with_knots(&inserted);
    let displacement: Vec<[f64; 3]> = (0..start.control_points.len())
        .map(|i| [(i % 5) as f64, ((3 * i) % 7) as f64, -0.5 * (i % 3) as f64])
        .collect();
    let refined = project_displacements(&start.clone().into(), &finer.clone().into(), &displacement);
    let coarsened = Coarsened::new(&finer, &inserted, &start).unwrap();
    assert_eq!(coarsened.patch.knots, start.knots);
    for (found, given) in coarsened.approximated(&refined).as_flattened().iter().zip(displacement.as_flattened()) {
        assert!((found - given).abs() < 1e-10, "{found} for {given}");
    }
    let of_start = [vec![0.5], vec![]];
    assert!(Coarsened::new(&finer, &of_start, &start).is_none(), "{:?}", start.knots[0]);
}
