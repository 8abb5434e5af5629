//! What of a run can be compared with another run, or against numbers: its dimensionless curve, the digits of its last result,
//! its peak.

use crate::record::{Outcome, Parameter, Record};
use crate::scene::{Expectation, Geometry, Material, Scene, Stage};
use crate::study::extremes_fault::ExtremeFault;

/// Curves that differ by less, relative to the largest value, are one.
const SAME_CURVE: f64 = 1e-9;
/// Values of the parameter that differ by less, relatively, are one.
const SAME_PARAMETER: f64 = 1e-12;
/// Bits of the significand of a double.
const ALL_BITS: f64 = 53.0;

/// Every equilibrium of a run: the parameter, and the moment (other scenes: the strain energy) over E t³, which has the
/// same unit whatever lengths and forces are measured in.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve {
    points: Vec<(f64, f64)>,
}

impl Curve {
    /// Collects the curve of a run of `scene` from its records.
    pub fn of<'r>(scene: &Scene, records: impl Iterator<Item = &'r Record>) -> Self {
        let scale = modulus(&scene.material) * scene.material.thickness_mm().powi(3);
        let point = |Record { report, .. }: &Record| {
            let value = match report.driven_by {
                Parameter::Rotation => report.moment_n_mm,
                Parameter::LoadFactor => report.strain_energy_n_mm,
            };
            (report.parameter, value / scale)
        };
        Self { points: records.filter(|record| is_equilibrium(record)).map(point).collect() }
    }

    /// Returns where the curves differ, if they do, as a fault.
    pub fn differs_from(&self, theirs: &Self, other: &str) -> Option<ExtremeFault> {
        let pairs = || self.points.iter().zip(&theirs.points);
        let same = |((a, _), (b, _)): &(&(f64, f64), &(f64, f64))| (a - b).abs() <= SAME_PARAMETER * a.abs();
        let common = pairs().take_while(same).count();
        let (ours, their_count) = (self.points.len(), theirs.points.len());
        let other = other.to_owned();
        if common < ours.max(their_count) || ours == 0 {
            let parameter = common.checked_sub(1).map_or(0.0, |last| self.points[last].0);
            return Some(ExtremeFault::OtherSteps { other, theirs: their_count, ours, parameter });
        }
        let largest = theirs.points.iter().fold(0.0_f64, |most, (_, value)| most.max(value.abs()));
        let apart = |((parameter, a), (_, b)): (&(f64, f64), &(f64, f64))| (*parameter, (a - b).abs() / largest);
        let worst = pairs().map(apart).reduce(|a, b| if a.1 >= b.1 || a.1.is_nan() { a } else { b })?;
        // What is not a number is no agreement.
        let agrees = worst.1 <= SAME_CURVE;
        let (parameter, difference) = worst;
        (!agrees).then_some(ExtremeFault::OtherCurve { other, parameter, difference, most: SAME_CURVE })
    }
}

/// A modulus that scales with all others.
fn modulus(material: &Material) -> f64 {
    match material {
        Material::Isotropic { youngs_modulus_mpa, .. } => *youngs_modulus_mpa,
        Material::Orthotropic { law, .. } => law.youngs_modulus_1_mpa,
        Material::Laminate { plies, .. } => plies.first().map_or(f64::NAN, |ply| ply.law.youngs_modulus_1_mpa),
    }
}

/// Whether a stage ended in an equilibrium.
pub(super) fn is_equilibrium(record: &Record) -> bool {
    record.report.outcome == Outcome::Done && record.report.stage.finds_equilibrium()
}

/// Work of loads and given motions less the change of strain energy over all load steps that did not jump, relative to
/// the largest strain energy: what the rules of work are off by, and any energy that the equations lose. Refinement
/// changes the energy at fixed load and does no work; what it changes is not counted.
pub(super) fn energy_balance<'r>(records: impl Iterator<Item = &'r Record>) -> Option<f64> {
    let (mut surplus, mut largest, mut before) = (0.0, 0.0_f64, 0.0);
    for Record { report, .. } in records.filter(|record| record.report.outcome == Outcome::Done) {
        let after = report.strain_energy_n_mm;
        if report.stage == Stage::Solve && !report.jumped {
            surplus += report.work_n_mm - (after - before);
        }
        largest = largest.max(after.abs());
        before = after;
    }
    (largest > 0.0).then_some(surplus / largest)
}

/// The scene with one length of its geometry a unit in the last place larger.
pub(super) fn nudged(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    let length = match &mut scene.geometry {
        Geometry::TapeSpring { radius_mm, .. }
        | Geometry::CylinderPanel { radius_mm, .. }
        | Geometry::SphereZone { radius_mm, .. } => Some(radius_mm),
        Geometry::Plate { length_mm, .. } | Geometry::Profile { length_mm, .. } => Some(length_mm),
        Geometry::Annulus { outer_radius_mm, .. } => Some(outer_radius_mm),
        Geometry::Nurbs(patch) => {
            patch.control_points_mm.iter_mut().flatten().max_by(|a, b| a.abs().total_cmp(&b.abs()))
        }
    };
    if let Some(length) = length {
        *length = if *length < 0.0 { length.next_down() } else { length.next_up() };
    }
    scene
}

/// Leading bits in which the results of two runs agree, at the last equilibrium that both have: −log₂ of their relative
/// difference.
pub(super) fn significant_bits<'r>(
    records: impl Iterator<Item = &'r Record>,
    others: impl Iterator<Item = &'r Record>,
) -> Option<f64> {
    let ours: Vec<(f64, f64)> = records.filter(|record| is_equilibrium(record)).map(result).collect();
    let theirs: Vec<(f64, f64)> = others.filter(|record| is_equilibrium(record)).map(result).collect();
    let (a, b) = ours.iter().rev().find_map(|(parameter, a)| {
        let same = |(other, _): &&(f64, f64)| (parameter - other).abs() <= SAME_PARAMETER * parameter.abs();
        theirs.iter().rev().find(same).map(|(_, b)| (*a, *b))
    })?;
    if a == b {
        return Some(ALL_BITS);
    }
    Some((-((a - b).abs() / a.abs().max(b.abs())).log2()).clamp(0.0, ALL_BITS))
}

/// The largest relative error of a run against what a scene states: of the largest result before the first jump, and of the
/// last one. `None` where it states neither, or the run has none.
pub(super) fn largest_error<'r>(expected: &Expectation, records: impl Iterator<Item = &'r Record>) -> Option<f64> {
    let equilibria: Vec<&Record> = records.filter(|record| is_equilibrium(record)).collect();
    let smooth = equilibria.iter().take_while(|record| !record.report.jumped);
    let peak = smooth.map(|record| result(record).1).max_by(|a, b| a.abs().total_cmp(&b.abs()));
    let last = equilibria.last().map(|record| result(record).1);
    let pairs = [expected.peak.zip(peak), expected.last.zip(last)];
    pairs.into_iter().flatten().map(|(right, found)| (found / right - 1.0).abs()).reduce(f64::max)
}

/// Parameter and result of an equilibrium: the moment, or the first probe, or the strain energy.
fn result(Record { report, .. }: &Record) -> (f64, f64) {
    let value = match (report.driven_by, report.probes.first()) {
        (Parameter::Rotation, _) => report.moment_n_mm,
        (Parameter::LoadFactor, Some(probe)) => probe.value,
        (Parameter::LoadFactor, None) => report.strain_energy_n_mm,
    };
    (report.parameter, value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::{Run, Stages};
    use crate::record::MemorySink;
    use crate::scene::parse;

    fn records() -> Vec<Record> {
        let mut scene = parse(include_str!("../../pipelines/baseline-quarter.toml"), "baseline-quarter.toml").unwrap();
        scene.load.set_target(0.8);
        let mut stages = Stages::new(scene);
        let start = stages.start().unwrap();
        let mut sink = MemorySink::default();
        Run::new(stages, start, None).to_end(None, &|| false, &mut sink).unwrap();
        sink.stages.into_iter().map(|(_, record)| record).collect()
    }

    fn curve(points: &[(f64, f64)]) -> Curve {
        Curve { points: points.to_vec() }
    }

    #[test]
    fn curves_part_where_steps_or_values_do() {
        let one = curve(&[(0.4, 1.0), (0.8, 2.0)]);
        assert_eq!(one.differs_from(&one, "b"), None);
        assert_eq!(one.differs_from(&curve(&[(0.4, 1.0 + 1e-9), (0.8, 2.0)]), "b"), None);
        let differs = |points: &[(f64, f64)]| one.differs_from(&curve(points), "b");
        assert!(matches!(
            differs(&[(0.4, 1.0), (0.8, 2.0 + 3e-9)]),
            Some(ExtremeFault::OtherCurve { parameter: 0.8, .. })
        ));
        assert!(matches!(differs(&[(0.4, 1.0), (0.8, f64::NAN)]), Some(ExtremeFault::OtherCurve { .. })));
        assert!(matches!(differs(&[(0.4, 1.0)]), Some(ExtremeFault::OtherSteps { parameter: 0.4, .. })));
        assert!(matches!(differs(&[(0.4, 1.0), (0.7, 2.0)]), Some(ExtremeFault::OtherSteps { parameter: 0.4, .. })));
        assert!(curve(&[]).differs_from(&curve(&[]), "b").is_some(), "nothing agrees with nothing");
    }

    #[test]
    fn bits_are_those_that_agree() {
        let ours = records();
        assert_eq!(significant_bits(ours.iter(), ours.iter()), Some(53.0));
        let mut theirs = ours.clone();
        let last = theirs.iter_mut().rfind(|record| is_equilibrium(record)).unwrap();
        last.report.moment_n_mm *= 1.0 + 1.0 / 1024.0;
        let bits = significant_bits(ours.iter(), theirs.iter()).unwrap();
        assert!((bits - 10.0).abs() < 0.01, "{bits}");
        assert_eq!(significant_bits(ours.iter(), [].iter()), None);
    }

    #[test]
    fn the_error_is_that_of_the_peak_and_of_the_last_result() {
        let records = records();
        let equilibria: Vec<&Record> = records.iter().filter(|record| is_equilibrium(record)).collect();
        let [.., before, last] = equilibria[..] else { panic!("two equilibria") };
        let (before, last) = (before.report.moment_n_mm, last.report.moment_n_mm);
        let error =
            |peak, end| largest_error(&Expectation { peak, last: end, ..Expectation::default() }, records.iter());
        assert_eq!(error(None, None), None);
        assert_eq!(error(Some(last), Some(last)), Some(0.0));
        assert!((error(Some(last / 1.1), Some(last)).unwrap() - 0.1).abs() < 1e-12);
        let mut snapped = records.clone();
        snapped.iter_mut().rfind(|record| is_equilibrium(record)).unwrap().report.jumped = true;
        let expected = Expectation { peak: Some(before), last: Some(last), ..Expectation::default() };
        assert_eq!(largest_error(&expected, snapped.iter()), Some(0.0));
    }

    #[test]
    fn work_that_is_lost_shows_in_the_balance() {
        let mut records = records();
        let right = energy_balance(records.iter()).unwrap();
        assert!(right.abs() < 1e-3, "{right}");
        let last = records.iter_mut().rfind(|record| record.report.stage == Stage::Solve).unwrap();
        last.report.work_n_mm += 0.1 * last.report.strain_energy_n_mm;
        let wrong = energy_balance(records.iter()).unwrap();
        assert!((wrong - right - 0.1).abs() < 1e-2, "{wrong}");
    }
}
