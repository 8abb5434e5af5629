//! Scenes at and beyond the edge, each run to see whether it ends as its `[expect]` states, with what the numbers are
//! worth: residuals, balance of work and energy, condition and symmetry of the stiffness, digits that survive.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use serde::Serialize;

use crate::equilibrium::{Condition, Configuration, Equilibrium, SymmetryError, Workspace};
use crate::record::Record;
use crate::scene::{Expectation, ExpectedOutcome, Scene};
use crate::state::State;
use crate::study::archive::Archive;
use crate::study::engine::panic_or;
use crate::study::extremes_curve::{Curve, energy_balance, is_equilibrium, largest_error, nudged, significant_bits};
use crate::study::extremes_fault::ExtremeFault;
use crate::study::extremes_run::{Done, ExtremeEnd};

/// Work that smooth steps may do beyond what goes into strain energy, as a share of the largest strain energy: a step
/// that is off by 1 % of the energy counts as a jump and is cut, and smooth steps stay far below.
const MOST_UNACCOUNTED: f64 = 0.02;
/// Error of a symmetric stiffness that is rounding.
const MOST_ASYMMETRY: f64 = 1e-12;
/// What running an equilibrium again from its state may change of its energy, relatively.
const STANDS: f64 = 1e-9;

/// The results of one scene of a suite. Numbers are `None` where the scene did not get so far.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExtremeRow {
    /// Name of the scene.
    pub scene: String,
    /// How it ended.
    pub outcome: ExtremeEnd,
    /// The error that ended it.
    pub message: Option<String>,
    /// Whether it ended as it states, and nothing else is wrong with it.
    pub as_stated: bool,
    /// The faults that were found.
    pub faults: Vec<ExtremeFault>,
    /// Largest relative error of what the scene states: see [`Expectation::peak`] and [`Expectation::last`].
    pub error: Option<f64>,
    /// Why that may be large, as the scene states it.
    pub inexact: Option<String>,
    /// Load steps with an equilibrium.
    pub load_steps: usize,
    /// Newton iterations, those of solves that were rejected included.
    pub iterations: usize,
    /// Largest |residual| of all equilibria over the forces that it is compared with.
    pub worst_residual: Option<f64>,
    /// Work less the change of strain energy over all smooth load steps, relative to the largest strain energy. Jumps
    /// release energy and refinement changes it at fixed load: neither is counted on either side.
    pub energy_balance: Option<f64>,
    /// Largest over smallest magnitude of the eigenvalues of the stiffness at the last equilibrium.
    pub condition: Option<f64>,
    /// Error of the symmetry of the stiffness there; see [`SymmetryError`].
    pub symmetry_error: Option<f64>,
    /// Bits of the last moment (other scenes: first probe, or strain energy) that survive where a length of the
    /// geometry changes by one unit in its last place; at most 53.
    pub significant_bits: Option<f64>,
    /// Wall time of the run, seconds.
    pub wall_s: f64,
}

impl ExtremeRow {
    fn new(scene: &str, outcome: ExtremeEnd) -> Self {
        Self {
            scene: scene.to_owned(),
            message: outcome.message().map(str::to_owned),
            outcome,
            as_stated: false,
            faults: Vec::new(),
            error: None,
            inexact: None,
            load_steps: 0,
            iterations: 0,
            worst_residual: None,
            energy_balance: None,
            condition: None,
            symmetry_error: None,
            significant_bits: None,
            wall_s: 0.0,
        }
    }
}

/// A set of scenes by name, which may refer to each other.
#[derive(Debug)]
pub struct ExtremesSuite {
    scenes: BTreeMap<String, Scene>,
    /// Curves of scenes that ran.
    curves: BTreeMap<String, Curve>,
    /// Time for one run of a scene.
    limit: Duration,
    /// Logs of the runs.
    archive: Archive,
}

impl ExtremesSuite {
    /// Creates a suite of scenes by their file names; each run may take `limit`, and has a log in `archive`.
    pub fn new(scenes: BTreeMap<String, Scene>, limit: Duration, archive: Archive) -> Self {
        Self { scenes, curves: BTreeMap::new(), limit, archive }
    }

    /// Runs a scene and checks its results; `None` where the suite has none of this name. A panic ends that scene
    /// alone.
    pub fn run(&mut self, name: &str) -> Option<ExtremeRow> {
        let scene = self.scenes.get(name)?.clone();
        let begin = Instant::now();
        Some(panic_or(|| self.examine(name, &scene)).unwrap_or_else(|message| {
            let mut row = ExtremeRow::new(name, ExtremeEnd::Panicked { message });
            row.faults.push(ExtremeFault::Panicked);
            row.wall_s = begin.elapsed().as_secs_f64();
            row
        }))
    }

    fn examine(&mut self, name: &str, scene: &Scene) -> ExtremeRow {
        let done = Done::of(scene, self.limit, &self.archive);
        let mut row = ExtremeRow::new(name, done.end.clone());
        let expectation = scene.expect.clone().unwrap_or_default();
        if !done.end.is(expectation.outcome) {
            row.faults.push(ExtremeFault::EndedOtherwise {
                expected: expectation.outcome,
                limit_s: self.limit.as_secs_f64(),
            });
        }
        row.wall_s = done.wall_s;
        row.iterations = done.stages.iter().map(|(_, record)| record.report.iterations).sum();
        let equilibria: Vec<&(State, Record)> = done.stages.iter().filter(|stage| is_equilibrium(&stage.1)).collect();
        let mut steps: Vec<u64> = equilibria.iter().map(|(_, record)| record.report.step).collect();
        steps.dedup();
        row.load_steps = steps.len();
        row.faults.extend(done.lost());
        if let Some((state, record)) = equilibria.last() {
            row.worst_residual = equilibria.iter().map(|(_, record)| record.report.residual).reduce(worse);
            row.energy_balance = energy_balance(done.records());
            diagnose(scene, state, &mut row);
            stands(scene, state, record, &mut row);
            let again = Done::of(&nudged(scene), self.limit, &self.archive);
            if again.end.name() != done.end.name() {
                row.faults.push(ExtremeFault::NudgedEndedOtherwise { ended: again.end.name() });
            }
            row.significant_bits = significant_bits(done.records(), again.records());
        } else if !matches!(expectation.outcome, ExpectedOutcome::Refused) {
            row.faults.push(ExtremeFault::NoStep);
        }
        judge_numbers(scene, &done, &mut row);
        row.error = largest_error(&expectation, done.records());
        row.inexact = expectation.inexact.clone();
        let most = expectation.within;
        row.faults.extend(row.error.filter(is_beyond(most)).map(|error| ExtremeFault::Inexact { error, most }));
        let curve = Curve::of(scene, done.records());
        if let Some(other) = &expectation.same_as {
            row.faults.extend(self.compare(&curve, other));
        }
        self.curves.insert(name.to_owned(), curve);
        row.as_stated = row.faults.is_empty();
        row
    }

    /// Compares a curve with that of another scene.
    fn compare(&mut self, curve: &Curve, other: &str) -> Option<ExtremeFault> {
        if !self.curves.contains_key(other) {
            let Some(scene) = self.scenes.get(other) else {
                return Some(ExtremeFault::NoOtherScene { other: other.to_owned() });
            };
            let done = Done::of(scene, self.limit, &self.archive);
            self.curves.insert(other.to_owned(), Curve::of(scene, done.records()));
        }
        curve.differs_from(&self.curves[other], other)
    }
}

/// Whether a number is more than the most, or none.
fn is_beyond(most: f64) -> impl Fn(&f64) -> bool {
    move |value| value.is_nan() || *value > most
}

/// The larger, and not a number where one of the two is not.
fn worse(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

/// Condition and symmetry of the stiffness at an equilibrium.
fn diagnose(scene: &Scene, state: &State, row: &mut ExtremeRow) {
    let Ok(mut work) = Workspace::new(scene, &state.mesh) else { return };
    match Condition::at(&mut work, Configuration::of(state)) {
        Ok(condition) => row.condition = Some(condition.number()),
        Err(cause) => row.faults.push(ExtremeFault::NoFactor { cause: Box::new(cause) }),
    }
    let symmetry = SymmetryError::at(&mut work, Configuration::of(state)).largest();
    row.symmetry_error = Some(symmetry);
    if symmetry.is_nan() || symmetry > MOST_ASYMMETRY {
        row.faults.push(ExtremeFault::NotSymmetric { error: symmetry, most: MOST_ASYMMETRY });
    }
}

/// An equilibrium is confirmed where its state alone gives it again, within an iteration.
fn stands(scene: &Scene, state: &State, record: &Record, row: &mut ExtremeRow) {
    let Ok(mut work) = Workspace::new(scene, &state.mesh) else { return };
    let again = Equilibrium::new(scene, &mut work).relax(Configuration::of(state), &mut |_| false);
    let energy = record.report.strain_energy_n_mm;
    let same = again.as_ref().is_ok_and(|again| {
        again.effort.iterations <= 1 && (again.balance.stored - energy).abs() <= STANDS * energy.abs()
    });
    if !same {
        row.faults.push(ExtremeFault::NotFoundAgain { step: record.report.step });
    }
}

/// Results that are not numbers, and results that are worth nothing.
fn judge_numbers(scene: &Scene, done: &Done, row: &mut ExtremeRow) {
    for (state, record) in &done.stages {
        let report = &record.report;
        let shape = state.displacement.iter().chain(&state.turns).flatten();
        let probes = report.probes.iter().map(|probe| &probe.value);
        let results = [&report.parameter, &report.moment_n_mm, &report.strain_energy_n_mm, &report.work_n_mm];
        let residual = is_equilibrium(record).then_some(&report.residual);
        if !shape.chain(probes).chain(results).chain(residual).all(|value| value.is_finite()) {
            row.faults.push(ExtremeFault::NotANumber { step: report.step, stage: report.stage });
            break;
        }
    }
    let tolerance = scene.solver.tolerance;
    if let Some(residual) = row.worst_residual.filter(|residual| residual.is_nan() || *residual > tolerance) {
        row.faults.push(ExtremeFault::OutOfBalance { residual, tolerance });
    }
    if let Some(balance) = row.energy_balance.filter(|balance| balance.is_nan() || balance.abs() > MOST_UNACCOUNTED) {
        row.faults.push(ExtremeFault::EnergyOutOfBalance { balance, most: MOST_UNACCOUNTED });
    }
    let least = scene.expect.as_ref().map_or(Expectation::LEAST_BITS, |expect| expect.least_bits) as f64;
    if let Some(bits) = row.significant_bits.filter(|bits| bits.is_nan() || *bits < least) {
        row.faults.push(ExtremeFault::Noise { bits, least });
    }
    if let Some(condition) = row.condition.filter(|condition| !condition.is_finite()) {
        row.faults.push(ExtremeFault::Singular { condition });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::parse;

    fn scene() -> Scene {
        let mut scene = parse(include_str!("../../pipelines/baseline-quarter.toml"), "baseline-quarter.toml").unwrap();
        scene.load.set_target(0.8);
        scene
    }

    fn suite(scenes: BTreeMap<String, Scene>, limit: Duration, folder: &tempfile::TempDir) -> ExtremesSuite {
        ExtremesSuite::new(scenes, limit, Archive::open(folder.path(), 1).unwrap())
    }

    fn row(scene: Scene) -> ExtremeRow {
        let folder = tempfile::tempdir().unwrap();
        let scenes = BTreeMap::from([("a.toml".to_owned(), scene)]);
        suite(scenes, Duration::from_secs(60), &folder).run("a.toml").unwrap()
    }

    #[test]
    fn a_panic_ends_its_scene_alone() {
        let mut beyond = scene();
        // No kernel is made for it, and no scene file can ask for it.
        beyond.mesh.degree = [7, 7];
        let scenes = BTreeMap::from([("a.toml".to_owned(), beyond), ("b.toml".to_owned(), scene())]);
        let folder = tempfile::tempdir().unwrap();
        let mut suite = suite(scenes, Duration::from_secs(60), &folder);
        let panicked = suite.run("a.toml").unwrap();
        assert!(matches!(panicked.outcome, ExtremeEnd::Panicked { .. }) && !panicked.as_stated);
        assert!(panicked.message.is_some_and(|message| !message.is_empty()));
        assert!(suite.run("b.toml").unwrap().as_stated);
        assert_eq!(suite.run("c.toml"), None);
    }

    #[test]
    fn a_scene_that_ends_otherwise_is_not_as_stated() {
        assert!(row(scene()).as_stated);
        let mut wrong = scene();
        wrong.expect = Some(Expectation { outcome: ExpectedOutcome::NoEquilibrium, ..Expectation::default() });
        let found = row(wrong);
        assert!(matches!(found.faults[..], [ExtremeFault::EndedOtherwise { .. }]), "{:?}", found.faults);
    }

    #[test]
    fn a_result_farther_off_than_stated_is_a_fault() {
        let expecting = |last, within| Scene {
            expect: Some(Expectation { last: Some(last), within, ..Expectation::default() }),
            ..scene()
        };
        let found = row(expecting(1.0, Expectation::MOST_ERROR));
        assert!(matches!(found.faults[..], [ExtremeFault::Inexact { .. }]), "{:?}", found.faults);
        // 2EI/L for 0.8 degrees; the section flattens by less than 2 %.
        assert!(row(expecting(2771.9 * 0.8_f64.to_radians(), Expectation::MOST_ERROR)).as_stated);
        let found = row(expecting(1.0, 100.0));
        assert!(found.as_stated && found.error.unwrap() > 1.0, "{found:?}");
    }

    #[test]
    fn time_that_runs_out_is_no_end() {
        let scenes = BTreeMap::from([("a.toml".to_owned(), scene())]);
        let folder = tempfile::tempdir().unwrap();
        let found = suite(scenes, Duration::ZERO, &folder).run("a.toml").unwrap();
        assert_eq!(found.outcome, ExtremeEnd::OutOfTime);
        assert!(!found.as_stated);
    }

    #[test]
    fn the_curve_of_another_spring_is_another_curve() {
        let mut thicker = scene();
        let crate::scene::Material::Isotropic { poissons_ratio, .. } = &mut thicker.material else { panic!() };
        *poissons_ratio = 0.31;
        thicker.expect = Some(Expectation { same_as: Some("b.toml".to_owned()), ..Expectation::default() });
        let scenes = BTreeMap::from([("a.toml".to_owned(), thicker.clone()), ("b.toml".to_owned(), scene())]);
        let folder = tempfile::tempdir().unwrap();
        let found = suite(scenes, Duration::from_secs(60), &folder).run("a.toml").unwrap();
        assert!(matches!(found.faults[..], [ExtremeFault::OtherCurve { .. }]), "{:?}", found.faults);
        let found = row(thicker);
        assert!(matches!(found.faults[..], [ExtremeFault::NoOtherScene { .. }]), "{:?}", found.faults);
    }

    #[test]
    fn what_is_not_a_number_is_the_worse() {
        assert_eq!([1.0, 3.0, 2.0].into_iter().reduce(worse), Some(3.0));
        assert!([1.0, f64::NAN, 2.0].into_iter().reduce(worse).unwrap().is_nan());
    }
}
