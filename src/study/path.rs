//! The equilibrium path of a run: which of its stages are points of the moment–rotation curve, and where it jumped.

use crate::record::{CriticalPoint, Outcome, Record, Report};
use crate::spline::Elements;

/// A point of the moment–rotation curve: the last equilibrium of a load step.
#[derive(Clone, Debug, PartialEq)]
pub struct PathPoint {
    /// Load step.
    pub step: u64,
    /// Rotation of each end, degrees.
    pub parameter: f64,
    /// End moment of the whole section, N·mm.
    pub moment_n_mm: f64,
    /// Strain energy of the whole shell, N·mm.
    pub strain_energy_n_mm: f64,
    /// Elements (along the length, along the arc) of the model.
    pub elements: Elements,
    /// Negative pivots of the tangent stiffness: 0 where the equilibrium is stable.
    pub negative_pivots: u64,
    /// Whether the shell jumped to get here.
    pub jumped: bool,
    /// Value of the scene's first probe.
    pub probe: Option<f64>,
    /// What the path passed in this load step.
    pub passed: Option<Passed>,
}

/// A critical point on the path, with the first equilibrium behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passed {
    /// The critical point.
    pub critical: CriticalPoint,
    /// Parameter at the critical point.
    pub parameter: f64,
    /// End moment of the whole section, N·mm.
    pub moment_n_mm: f64,
    /// Value of the scene's first probe.
    pub probe: Option<f64>,
}

/// A jump from one equilibrium to another, with all that followed in the same load step: on finer meshes the shell may
/// jump further.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snap {
    /// Rotation of the last equilibrium before the jump, degrees.
    pub before: f64,
    /// Rotation of the first equilibrium after the jump, degrees; the same where a finer mesh set the jump off.
    pub after: f64,
    /// Moment before the jump, N·mm.
    pub moment_before_n_mm: f64,
    /// Moment at the end of the load step that jumped, N·mm.
    pub moment_after_n_mm: f64,
    /// Energy that the jump released, and any on finer meshes in the same load step, N·mm; `None` where it is not known.
    pub energy_released_n_mm: Option<f64>,
}

/// An equilibrium of the path of a run, in the record of its stage.
#[derive(Clone, Copy, Debug)]
pub struct OnPath<'r> {
    /// The record.
    pub record: &'r Record,
    /// Whether the shell jumped to get here.
    pub jumped: bool,
    /// What the path passed in this load step, and the first equilibrium behind it.
    pub passed: Option<(CriticalPoint, &'r Report)>,
}

/// Extracts the equilibria of the path: the last one of every load step, and where a step jumped after it had found one (on a
/// finer mesh), the one before the jump too. What a coarser mesh found where the finer one jumps before it is no part of it.
pub fn records_on_path(records: &[Record]) -> Vec<OnPath<'_>> {
    let mut path: Vec<OnPath> = Vec::new();
    for record in equilibria(records) {
        let report = &record.report;
        if report.returned_from().is_some() {
            while path.last().is_some_and(|last| last.record.report.parameter >= report.parameter && !last.jumped) {
                path.pop();
            }
        }
        let same_step = path.last().is_some_and(|last| last.record.report.step == report.step);
        let jumped_before = same_step && path.last().is_some_and(|last| last.jumped);
        let mut passed_before = None;
        if same_step && (jumped_before || !report.jumped) {
            passed_before = path.pop().and_then(|last| last.passed);
        }
        let passed = report.critical_point.map(|critical| (critical, report)).or(passed_before);
        path.push(OnPath { record, jumped: report.jumped || jumped_before, passed });
    }
    path
}

/// Extracts the moment–rotation curve from the equilibria of the path.
pub fn equilibrium_path(records: &[Record]) -> Vec<PathPoint> {
    records_on_path(records).iter().map(PathPoint::of).collect()
}

impl PathPoint {
    fn of(OnPath { record, jumped, passed }: &OnPath) -> Self {
        let report = &record.report;
        let probe = |report: &Report| report.probes.first().map(|reading| reading.value);
        Self {
            step: report.step,
            parameter: report.parameter,
            moment_n_mm: report.moment_n_mm,
            strain_energy_n_mm: report.strain_energy_n_mm,
            elements: report.elements.clone(),
            negative_pivots: report.negative_pivots,
            jumped: *jumped,
            probe: probe(report),
            passed: passed.map(|(critical, report)| Passed {
                critical,
                parameter: report.parameter,
                moment_n_mm: report.moment_n_mm,
                probe: probe(report),
            }),
        }
    }
}

/// Extracts the jumps of a run, in order, at most one for each load step. A jump in the first solve of `records` counts
/// from the unloaded shell.
pub fn snaps(records: &[Record]) -> Vec<Snap> {
    let mut before = (0.0, 0.0);
    let mut snaps: Vec<(u64, Snap)> = Vec::new();
    for report in equilibria(records).map(|record| &record.report) {
        match snaps.last_mut().filter(|(step, _)| *step == report.step) {
            Some((_, snap)) => {
                snap.moment_after_n_mm = report.moment_n_mm;
                let more = snap.energy_released_n_mm.zip(report.energy_released_n_mm);
                snap.energy_released_n_mm = more.map(|(before, now)| before + now);
            }
            None if report.jumped => {
                let snap = Snap {
                    before: before.0,
                    after: report.parameter,
                    moment_before_n_mm: before.1,
                    moment_after_n_mm: report.moment_n_mm,
                    energy_released_n_mm: report.energy_released_n_mm,
                };
                snaps.push((report.step, snap));
            }
            None => {}
        }
        before = (report.parameter, report.moment_n_mm);
    }
    snaps.into_iter().map(|(_, snap)| snap).collect()
}

/// The records of the stages that ended in an equilibrium.
pub fn equilibria(records: &[Record]) -> impl Iterator<Item = &Record> {
    records.iter().filter(|record| {
        let Record { report, .. } = record;
        report.outcome == Outcome::Done && report.stage.finds_equilibrium()
    })
}
