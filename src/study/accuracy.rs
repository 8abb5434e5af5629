//! Error against run time: a run beside a reference run of the same structure.
//!
//! Both are compared at the load steps that end at the same parameter. Before the first jump of either the difference is a
//! share of the reference's largest value there, after the first jumps of both one of its largest value there; between the
//! two they stand on different branches, and what differs is where they jump.

use std::time::Instant;

use serde::Serialize;

use crate::model::ModelError;
use crate::pipeline::{Parameter, Record, Run, RunError, Sink, SinkError, Stages};
use crate::scene::Scene;
use crate::state::State;
use crate::study::path::{PathPoint, equilibrium_path, snaps};

/// Parameters closer than this, relatively, are one.
const SAME: f64 = 1e-9;

/// A run, as far as it is compared: moment, or first probe, over the parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Parameter and value at the end of each load step.
    curve: Vec<(f64, f64)>,
    /// Parameters before and behind the first jump.
    jump: Option<[f64; 2]>,
    elements: [usize; 2],
    unknowns: usize,
    iterations: usize,
    factorizations: usize,
    wall_s: f64,
}

/// A run beside the reference.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AccuracyRow {
    /// Elements (along u, along v) of the model at the end.
    pub elements: [usize; 2],
    /// Free unknowns at the end.
    pub unknowns: usize,
    /// Load steps that both runs have.
    pub compared: usize,
    /// Largest difference before the first jump, as a share of the reference's largest value there.
    pub error_before: Option<f64>,
    /// Parameter of the first equilibrium behind the first jump.
    pub jump_at: Option<f64>,
    /// Largest difference behind it, as a share of the reference's largest value there.
    pub error_after: Option<f64>,
    /// Newton iterations.
    pub iterations: usize,
    /// Numeric factorizations.
    pub factorizations: usize,
    /// Wall time, seconds, with nothing logged.
    pub wall_s: f64,
}

/// Why runs cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum AccuracyError {
    /// The scene cannot be made discrete.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The run stopped.
    #[error("the run stopped")]
    Run(#[from] Box<RunError>),
    /// Nothing to compare.
    #[error("the scene has no moment and no probe to compare: turn its ends, or write a [[probe]]")]
    NothingMeasured,
    /// No load step ends where one of the reference does.
    #[error("no load step ends at the same {what} as one of the reference: give both the same increment")]
    NothingInCommon {
        /// What is driven.
        what: &'static str,
    },
}

/// Keeps what was reported, and no states.
#[derive(Default)]
struct Records(Vec<Record>);

impl Sink for Records {
    fn take(&mut self, _: &State, record: &Record) -> Result<(), SinkError> {
        self.0.push(record.clone());
        Ok(())
    }
}

/// Runs a scene to its end.
///
/// # Errors
/// Where the run stops before, or measures nothing.
pub fn measure(scene: &Scene) -> Result<Measured, AccuracyError> {
    let stages = Stages::new(scene.clone());
    let start = stages.start()?;
    let mut records = Records::default();
    let begin = Instant::now();
    Run::new(stages, start, None).to_end(None, &|| false, &mut records).map_err(Box::new)?;
    let wall_s = begin.elapsed().as_secs_f64();
    let Records(records) = records;
    let value = |point: &PathPoint| match Parameter::of(scene) {
        Parameter::Rotation => Some(point.moment_n_mm),
        Parameter::LoadFactor => point.probe,
    };
    let path = equilibrium_path(&records);
    let curve: Option<Vec<_>> = path.iter().map(|point| Some((point.parameter, value(point)?))).collect();
    let last = records.last().map(|record| &record.report);
    Ok(Measured {
        curve: curve.ok_or(AccuracyError::NothingMeasured)?,
        jump: snaps(&records).first().map(|snap| [snap.before_deg, snap.after_deg]),
        elements: last.map_or([0, 0], |report| report.elements),
        unknowns: last.map_or(0, |report| report.unknowns),
        iterations: records.iter().map(|record| record.report.iterations).sum(),
        factorizations: records.iter().map(|record| record.report.factorizations).sum(),
        wall_s,
    })
}

impl Measured {
    /// Beside a reference.
    ///
    /// # Errors
    /// Where they have no load step in common.
    pub fn against(&self, reference: &Measured, what: &'static str) -> Result<AccuracyRow, AccuracyError> {
        let jumps = [self.jump, reference.jump];
        let smooth_to = jumps.iter().flatten().fold(f64::INFINITY, |least, [before, _]| least.min(*before));
        let beyond = jumps.iter().flatten().fold(f64::NEG_INFINITY, |most, [_, behind]| most.max(*behind));
        let is_same = |a: f64, b: f64| (a - b).abs() <= SAME * a.abs().max(b.abs());
        let pairs: Vec<(f64, f64, f64)> = self
            .curve
            .iter()
            .filter_map(|(at, value)| {
                let (_, expected) = reference.curve.iter().find(|(other, _)| is_same(*at, *other))?;
                Some((*at, *value, *expected))
            })
            .collect();
        if pairs.is_empty() {
            return Err(AccuracyError::NothingInCommon { what });
        }
        let jumped = jumps.iter().any(Option::is_some);
        Ok(AccuracyRow {
            elements: self.elements,
            unknowns: self.unknowns,
            compared: pairs.len(),
            error_before: worst(pairs.iter().filter(|(at, ..)| *at <= smooth_to)),
            jump_at: self.jump.map(|[_, behind]| behind),
            error_after: worst(pairs.iter().filter(|(at, ..)| jumped && *at > beyond)),
            iterations: self.iterations,
            factorizations: self.factorizations,
            wall_s: self.wall_s,
        })
    }
}

/// Largest difference as a share of the largest value expected.
fn worst<'p>(pairs: impl Iterator<Item = &'p (f64, f64, f64)>) -> Option<f64> {
    let (mut difference, mut scale) = (0.0_f64, 0.0_f64);
    for (_, value, expected) in pairs {
        difference = difference.max((value - expected).abs());
        scale = scale.max(expected.abs());
    }
    (scale > 0.0).then_some(difference / scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(curve: &[(f64, f64)], jump: Option<[f64; 2]>) -> Measured {
        let (elements, unknowns) = ([4, 4], 100);
        Measured { curve: curve.to_vec(), jump, elements, unknowns, iterations: 1, factorizations: 1, wall_s: 1.0 }
    }

    #[test]
    fn branches_are_compared_apart() {
        let reference = measured(&[(1.0, 10.0), (2.0, 20.0), (3.0, 5.0), (4.0, 5.0)], Some([2.0, 2.1]));
        // Jumps later: at 3 it stands on the other branch.
        let run = measured(&[(1.0, 10.5), (1.5, 99.0), (2.0, 20.2), (3.0, 30.0), (4.0, 5.1)], Some([3.0, 3.1]));
        let row = run.against(&reference, "rotation").unwrap();
        assert_eq!((row.compared, row.jump_at), (4, Some(3.1)));
        assert!((row.error_before.unwrap() - 0.5 / 20.0).abs() < 1e-12);
        assert!((row.error_after.unwrap() - 0.1 / 5.0).abs() < 1e-12);
    }

    #[test]
    fn without_a_jump_all_is_before() {
        let reference = measured(&[(1.0, 10.0), (2.0, 20.0)], None);
        let row = measured(&[(1.0, 10.0), (2.0, 19.0)], None).against(&reference, "rotation").unwrap();
        assert_eq!((row.error_before, row.error_after), (Some(0.05), None));
        assert!(matches!(
            measured(&[(1.5, 10.0)], None).against(&reference, "rotation"),
            Err(AccuracyError::NothingInCommon { .. })
        ));
    }
}
