//! Error against run time: a run compared with a reference run of the same structure.
//!
//! Both are compared at the load steps that end at the same parameter, before their first jumps and behind them: the largest
//! difference, as a share of the largest value of the reference on that side. Where one has jumped and the other has not they
//! are on different branches, and what differs is where they jump.

use serde::Serialize;

use crate::record::{Parameter, Record};
use crate::scene::{Drive, Reach, Scene, Stage};
use crate::spline::Elements;
use crate::study::archive::TaskError;
use crate::study::path::{PathPoint, equilibrium_path, snaps};

/// Parameters closer than this, relatively, are one.
pub(super) const SAME: f64 = 1e-9;

/// The results of a run that are compared with others: moment, or first probe, against the parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    curve: Vec<CurvePoint>,
    /// Parameter of the first equilibrium behind the first jump.
    jump_at: Option<f64>,
    /// What the parameter is.
    what: &'static str,
    /// Name of the quantity that is compared.
    quantity: String,
    steps: u64,
    elements: Elements,
    unknowns: usize,
    iterations: usize,
    factorizations: usize,
    wall_s: f64,
    mesh_s: f64,
}

/// The end of a load step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CurvePoint {
    pub(super) parameter: f64,
    pub(super) value: f64,
    /// Whether the shell has jumped before, or to get here.
    pub(super) behind: bool,
}

/// The errors of one run, relative to a reference run.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct AccuracyRow {
    /// Elements (along u, along v) of the model at the end.
    pub elements: Elements,
    /// Free unknowns at the end.
    pub unknowns: usize,
    /// What is compared: the moment of turning ends, or the name of the first probe with its unit.
    pub quantity: String,
    /// Number of threads.
    pub threads: usize,
    /// Number of load steps.
    pub steps: u64,
    /// Load steps that the reference has too.
    pub compared: usize,
    /// Largest difference before the first jump, as a share of the largest value of the reference there.
    pub error_before: Option<f64>,
    /// Parameter of the first equilibrium behind the first jump.
    pub jump_at: Option<f64>,
    /// Largest difference behind it, as a share of the largest value of the reference there.
    pub error_after: Option<f64>,
    /// Newton iterations.
    pub iterations: usize,
    /// Numeric factorizations.
    pub factorizations: usize,
    /// Wall time, seconds.
    pub wall_s: f64,
    /// Wall time of the stages that change the mesh or say how, with the solves on new meshes, seconds.
    pub mesh_s: f64,
}

/// Why runs cannot be compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AccuracyError {
    /// The run is not done.
    #[error(transparent)]
    Task(#[from] Box<TaskError>),
    /// The run has nothing that can be compared.
    #[error("the scene has no moment and no probe to compare: turn its ends, or write a [[probe]]")]
    NothingMeasured,
    /// Another structure than the reference.
    #[error("it is another structure than the reference, so that nothing shows how accurate it is: {}", differences.join("; "))]
    OtherStructure {
        /// Keys with the value of the reference and its own.
        differences: Vec<String>,
    },
    /// Another quantity than that of the reference.
    #[error("it measures {own}, and the reference {other}: give both the same first [[probe]]")]
    OtherQuantity {
        /// The quantity that this run measures.
        own: String,
        /// What the reference measures.
        other: String,
    },
    /// A parameter that goes back is not the same place on the path.
    #[error(
        "by arc length a path passes one {what} more than once: compare runs under load control (of tape springs, `foldline converge` compares paths)"
    )]
    AlongPath {
        /// What drives the run.
        what: &'static str,
    },
    /// No load step ends where one of the reference does.
    #[error("no load step ends at the same {what} as one of the reference: give both the same increment")]
    NothingInCommon {
        /// What drives the run.
        what: &'static str,
    },
}

/// Checks that two scenes describe one structure, as far as their keys show: geometry, material, sense of the bending.
///
/// # Errors
/// Where they differ.
pub fn is_one_structure(scene: &Scene, reference: &Scene) -> Result<(), AccuracyError> {
    let decides = |path: &str| {
        ["geometry", "material", "load.sense"].iter().any(|part| path == *part || path.starts_with(&format!("{part}.")))
    };
    let differences = reference.differences(scene).into_iter();
    let differences = differences.filter(|difference| difference.reach != Reach::Free && decides(&difference.path));
    let differences: Vec<String> = differences.map(|difference| difference.to_string()).collect();
    match differences.is_empty() {
        true => Ok(()),
        false => Err(AccuracyError::OtherStructure { differences }),
    }
}

/// Checks that the results of two scenes can be compared, as far as that is known before they are run.
///
/// # Errors
/// Where they describe other structures, or one of them measures nothing that compares.
pub fn is_comparable(scene: &Scene, reference: &Scene) -> Result<(), AccuracyError> {
    is_one_structure(scene, reference)?;
    parameter_of(scene).and(parameter_of(reference)).map(|_| ())
}

/// What drives a run that can be compared with others at the same value of it.
fn parameter_of(scene: &Scene) -> Result<&'static str, AccuracyError> {
    let what = match Parameter::of(scene) {
        Parameter::Rotation => "rotation",
        Parameter::LoadFactor => "load factor",
    };
    if Drive::of(scene).follows_path() {
        return Err(AccuracyError::AlongPath { what });
    }
    if Parameter::of(scene) == Parameter::LoadFactor && scene.probes.is_empty() {
        return Err(AccuracyError::NothingMeasured);
    }
    Ok(what)
}

/// Whether a stage is there for the mesh alone.
fn is_of_mesh(stage: Stage) -> bool {
    !matches!(stage, Stage::Solve | Stage::SwitchBranch)
}

/// The moment of turning ends, or else the first probe, at the end of each load step, and once more before a jump that a
/// finer mesh set off there.
fn curve(path: &[PathPoint], parameter: Parameter) -> Vec<CurvePoint> {
    let mut behind = false;
    let mut curve = Vec::new();
    for point in path {
        behind |= point.jumped;
        let value = match parameter {
            Parameter::Rotation => point.moment_n_mm,
            Parameter::LoadFactor => point.probe.unwrap_or(0.0),
        };
        curve.push(CurvePoint { parameter: point.parameter, value, behind });
    }
    curve
}

impl Measured {
    /// Reads the results of a finished run from what it reported; it took `wall_s` seconds.
    ///
    /// # Errors
    /// Where the scene measures nothing that can be compared.
    pub fn of(scene: &Scene, records: &[Record], wall_s: f64) -> Result<Self, AccuracyError> {
        let what = parameter_of(scene)?;
        let last = records.last().map(|record| &record.report);
        Ok(Measured {
            curve: curve(&equilibrium_path(records), Parameter::of(scene)),
            jump_at: snaps(records).first().map(|snap| snap.after),
            what,
            quantity: match records.iter().find_map(|record| record.report.probes.first()) {
                Some(reading) if Parameter::of(scene) == Parameter::LoadFactor => {
                    format!("{} ({})", reading.name, reading.unit)
                }
                _ => "moment (N·mm)".to_string(),
            },
            steps: last.map_or(0, |report| report.step),
            elements: last.map_or([0, 0].into(), |report| report.elements.clone()),
            unknowns: last.map_or(0, |report| report.unknowns),
            iterations: records.iter().map(|record| record.report.iterations).sum(),
            factorizations: records.iter().map(|record| record.report.factorizations).sum(),
            wall_s,
            mesh_s: records
                .iter()
                .filter(|record| is_of_mesh(record.report.stage))
                .fold(0.0, |sum, record| sum + record.wall_s),
        })
    }

    /// Name of the quantity that is compared: the moment of turning ends, or the name of the first probe with its unit.
    pub fn quantity(&self) -> &str {
        &self.quantity
    }

    /// Compares the run with a reference.
    ///
    /// # Errors
    /// Where they have no load step in common.
    pub fn against(&self, reference: &Measured) -> Result<AccuracyRow, AccuracyError> {
        if self.quantity != reference.quantity {
            let (own, other) = (self.quantity.clone(), reference.quantity.clone());
            return Err(AccuracyError::OtherQuantity { own, other });
        }
        let is_same = |a: f64, b: f64| (a - b).abs() <= SAME * a.abs().max(b.abs());
        let pairs: Vec<(CurvePoint, f64)> = self
            .curve
            .iter()
            .filter_map(|point| {
                let same =
                    |other: &&CurvePoint| is_same(other.parameter, point.parameter) && other.behind == point.behind;
                Some((*point, reference.curve.iter().find(same)?.value))
            })
            .collect();
        if pairs.is_empty() {
            return Err(AccuracyError::NothingInCommon { what: self.what });
        }
        let error = |behind: bool| {
            let on_side = pairs.iter().filter(|(point, _)| point.behind == behind);
            let difference = on_side.map(|(point, expected)| (point.value - expected).abs()).reduce(f64::max)?;
            let of_reference = reference.curve.iter().filter(|point| point.behind == behind);
            let scale = of_reference.map(|point| point.value.abs()).fold(0.0, f64::max);
            (scale > 0.0).then_some(difference / scale)
        };
        Ok(AccuracyRow {
            elements: self.elements.clone(),
            unknowns: self.unknowns,
            quantity: self.quantity.clone(),
            threads: rayon::current_num_threads(),
            steps: self.steps,
            compared: pairs.len(),
            error_before: error(false),
            jump_at: self.jump_at,
            error_after: error(true),
            iterations: self.iterations,
            factorizations: self.factorizations,
            wall_s: self.wall_s,
            mesh_s: self.mesh_s,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Parameter, value, and whether it is behind a jump.
    fn measured(points: &[(f64, f64, bool)]) -> Measured {
        let of = |&(parameter, value, behind): &(f64, f64, bool)| CurvePoint { parameter, value, behind };
        let curve: Vec<CurvePoint> = points.iter().map(of).collect();
        let jump_at = curve.iter().find(|point| point.behind).map(|point| point.parameter);
        let (elements, unknowns, what, quantity) = ([4, 4].into(), 100, "rotation", "moment".to_string());
        let steps = curve.len() as u64;
        Measured {
            curve,
            jump_at,
            what,
            quantity,
            steps,
            elements,
            unknowns,
            iterations: 1,
            factorizations: 1,
            wall_s: 1.0,
            mesh_s: 0.0,
        }
    }

    #[test]
    fn branches_are_compared_apart() {
        let reference =
            measured(&[(1.0, 10.0, false), (2.0, 20.0, false), (3.0, 5.0, true), (4.0, 5.0, true), (5.0, 6.0, true)]);
        // Jumps later: at 3 it is on the other branch. The fold is largest at 5, which it does not reach.
        let run = measured(&[
            (1.0, 10.5, false),
            (1.5, 99.0, false),
            (2.0, 20.2, false),
            (3.0, 30.0, false),
            (4.0, 5.1, true),
        ]);
        let row = run.against(&reference).unwrap();
        assert_eq!((row.compared, row.jump_at), (3, Some(4.0)));
        assert!((row.error_before.unwrap() - 0.5 / 20.0).abs() < 1e-12);
        assert!((row.error_after.unwrap() - 0.1 / 6.0).abs() < 1e-12);
    }

    /// A jump that a finer mesh sets off: two equilibria at one rotation, on either side of it.
    #[test]
    fn a_run_has_no_error_against_itself() {
        let run = measured(&[(1.0, 10.0, false), (2.0, 20.0, false), (2.0, 5.0, true), (3.0, 5.0, true)]);
        let row = run.against(&run).unwrap();
        assert_eq!((row.compared, row.error_before, row.error_after), (4, Some(0.0), Some(0.0)));
    }

    #[test]
    fn without_a_jump_all_is_before() {
        let reference = measured(&[(1.0, 10.0, false), (2.0, 20.0, false)]);
        let row = measured(&[(1.0, 10.0, false), (2.0, 19.0, false)]).against(&reference).unwrap();
        assert_eq!((row.error_before, row.error_after), (Some(0.05), None));
        let nothing = measured(&[(1.5, 10.0, false)]).against(&reference);
        assert!(matches!(nothing, Err(AccuracyError::NothingInCommon { .. })));
    }
}
