//! What a stage reports of what it did: a function of model and state.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::record::{ConnectionReading, CriticalPoint, Reading, Warning};
use crate::scene::{Parameter, Scene, Stage};
use crate::spline::Elements;
use crate::state::State;
use crate::units::figure;

/// What a stage did and the numbers of the state that it made. It depends on model and state alone, on no clock and no
/// machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "WrittenReport", into = "WrittenReport")]
pub struct Report {
    /// Load step, from 1.
    pub step: u64,
    /// The stage that ran.
    pub stage: Stage,
    /// Whether the stage did what it set out to do; a solve that was rejected leaves the state where it was.
    pub outcome: Outcome,
    /// What the parameter is.
    pub driven_by: Parameter,
    /// Parameter of the state.
    pub parameter: f64,
    /// Parameter that the stage worked at; differs from `parameter` where a solve was rejected, and where a refined mesh jumped
    /// and the run returned to before that.
    pub attempted_parameter: f64,
    /// Turning ends: end moment, N·mm.
    pub moment_n_mm: f64,
    /// Strain energy of the whole shell, and what terms of the caller's own store, N·mm.
    pub strain_energy_n_mm: f64,
    /// Work in this stage of loads and given motions (forces by their means before and after, strokes of the loads along the
    /// way of the solve), and of changes of the natural state and of what terms store with the parameter (the mean of what they
    /// put in before and after), N·mm.
    pub work_n_mm: f64,
    /// Energy that these changes would have put in, had the shell stayed before or after, whichever is more, N·mm; 0 where there
    /// are none.
    pub put_in_n_mm: f64,
    /// Elements (along u, along v) of the model; of several shells those of each.
    pub elements: Elements,
    /// Free unknowns of the model.
    pub unknowns: usize,
    /// Newton iterations.
    pub iterations: usize,
    /// Numeric factorizations.
    pub factorizations: usize,
    /// Negative pivots of the tangent stiffness at the state; 0 where it is a stable equilibrium.
    pub negative_pivots: u64,
    /// |residual| at the end of the stage over the forces that it is compared with; 0 where it is rounding.
    pub residual: f64,
    /// Energy that a jump, a ripple or leaving an unstable equilibrium (switch-branch) released in this stage, N·mm; 0 where
    /// there was none, and `None` where it is not known.
    pub energy_released_n_mm: Option<f64>,
    /// Whether the shell jumped in this stage.
    pub jumped: bool,
    /// Whether it jumped by so little that refining the mesh changes more: a ripple of the mesh, taken where it was met.
    pub rippled: bool,
    /// Knot spans marked each way (evaluate-indicators).
    pub marked: [usize; 2],
    /// Largest indicator max|κ|h each way (evaluate-indicators), dimensionless.
    pub largest_indicator: [f64; 2],
    /// Estimated error of the measured quantity that the mesh causes by its spans in each direction, relative
    /// (evaluate-indicators, where a tolerance asks for it and the estimate before no longer holds).
    pub estimated_error: Option<[f64; 2]>,
    /// The scene's probes at a new equilibrium; empty after other stages.
    pub probes: Vec<Reading>,
    /// The joints and bonds of a structure that store energy, at a new equilibrium; empty after other stages.
    pub connections: Vec<ConnectionReading>,
    /// Arc length: length of the path so far, mm.
    pub path_length_mm: Option<f64>,
    /// Arc length: what the step passed, where it is located.
    pub critical_point: Option<CriticalPoint>,
    /// Where the mesh cannot show what the shell does.
    pub warnings: Vec<Warning>,
}

impl Report {
    /// Parameter that the run returned from in this stage, since the refined mesh jumps before it.
    pub fn returned_from(&self) -> Option<f64> {
        let returned = self.stage == Stage::ReEquilibrate && self.attempted_parameter != self.parameter;
        returned.then_some(self.attempted_parameter)
    }

    /// The report of a state, on a mesh with so many free unknowns; the stage fills in what it did.
    pub(crate) fn of(scene: &Scene, state: &State, unknowns: usize) -> Self {
        Self {
            step: state.step,
            stage: state.stage.unwrap_or(Stage::Solve),
            outcome: Outcome::Done,
            driven_by: Parameter::of(scene),
            parameter: state.parameter,
            attempted_parameter: state.parameter,
            moment_n_mm: state.moment_n_mm,
            strain_energy_n_mm: state.strain_energy_n_mm,
            work_n_mm: 0.0,
            put_in_n_mm: 0.0,
            elements: state.mesh.elements(),
            unknowns,
            iterations: 0,
            factorizations: 0,
            negative_pivots: state.negative_pivots,
            residual: 0.0,
            energy_released_n_mm: Some(0.0),
            jumped: false,
            rippled: false,
            marked: [0, 0],
            largest_indicator: [0.0; 2],
            estimated_error: None,
            probes: Vec::new(),
            connections: Vec::new(),
            path_length_mm: state.drive.path().map(|path| path.travelled_mm),
            critical_point: None,
            warnings: Vec::new(),
        }
    }
}

/// Describes the energy that a jump released, with this number of decimals, or why it is not known.
pub fn released_in_words(energy_n_mm: Option<f64>, loads_follow: bool, decimals: usize) -> String {
    match energy_n_mm {
        Some(energy) => format!("released {} N·mm", figure(energy, decimals)),
        None if loads_follow => "energy released not known: the loads have no potential".into(),
        None => "energy released not known: less than the rule of work resolves".into(),
    }
}

fn is_nothing(energy: &f64) -> bool {
    *energy == 0.0
}

/// A report in the form of its JSON, which names the parameter and leaves out what the scene has no use for.
#[derive(Clone, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "Report")]
pub struct WrittenReport {
    /// Load step, from 1.
    step: u64,
    /// The stage that ran.
    stage: Stage,
    /// Whether the stage did what it set out to do; a solve that was rejected leaves the state where it was.
    outcome: Outcome,
    /// Turning ends: rotation of each end in the state, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    rotation_deg: Option<f64>,
    /// Turning ends: rotation that the stage worked at; differs from `rotation_deg` where a solve was rejected, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    attempted_rotation_deg: Option<f64>,
    /// Turning ends: end moment, N·mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    moment_n_mm: Option<f64>,
    /// Other scenes: load factor of the state.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    load_factor: Option<f64>,
    /// Other scenes: load factor that the stage worked at.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    attempted_load_factor: Option<f64>,
    /// Strain energy of the whole shell, N·mm.
    strain_energy_n_mm: f64,
    /// Work in this stage of loads and given motions (forces by their means before and after, strokes of the loads along the
    /// way of the solve), and of changes of the natural state (the mean of what they put in before and after), N·mm.
    #[serde(default)]
    work_n_mm: f64,
    /// Energy that changes of the natural state would have put in, had the shell stayed before or after, whichever is more,
    /// N·mm; only where something changes it.
    #[serde(default, skip_serializing_if = "is_nothing")]
    put_in_n_mm: f64,
    /// Elements (along u, along v) of the model.
    elements: Elements,
    /// Free unknowns of the model.
    unknowns: usize,
    /// Newton iterations.
    iterations: usize,
    /// Numeric factorizations.
    factorizations: usize,
    /// Negative pivots of the tangent stiffness at the state; 0 where it is a stable equilibrium.
    negative_pivots: u64,
    /// |residual| at the end of the stage over the forces that it is compared with; 0 where it is rounding.
    residual: f64,
    /// Energy that a jump released in this stage, N·mm; 0 where nothing jumped, and left out where it is not known: less than
    /// the rule of work resolves, or under loads that have no potential.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    energy_released_n_mm: Option<f64>,
    /// Whether the shell jumped in this stage.
    jumped: bool,
    /// Whether it jumped by so little that refining the mesh changes more: a ripple of the mesh, not located.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    rippled: bool,
    /// Knot spans marked each way (evaluate-indicators).
    marked: [usize; 2],
    /// Largest indicator max|κ|h each way (evaluate-indicators), dimensionless.
    largest_indicator: [f64; 2],
    /// Estimated error of the measured quantity that the mesh causes by its spans in each direction, relative
    /// (evaluate-indicators, where a tolerance asks for it).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 2]")]
    estimated_error: Option<[f64; 2]>,
    /// The scene's probes at a new equilibrium.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    probes: Vec<Reading>,
    /// The joints and bonds of a structure that store energy, at a new equilibrium.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    connections: Vec<ConnectionReading>,
    /// Continuation by arc length: length of the path so far (root mean square displacements), mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    path_length_mm: Option<f64>,
    /// Continuation by arc length: the limit point or bifurcation that the step passed, where it is located.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "CriticalPoint")]
    critical_point: Option<CriticalPoint>,
    /// Where the mesh cannot show what the shell does; only where there is such a thing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    warnings: Vec<Warning>,
}

impl From<WrittenReport> for Report {
    fn from(written: WrittenReport) -> Self {
        let driven_by = if written.load_factor.is_some() { Parameter::LoadFactor } else { Parameter::Rotation };
        Self {
            step: written.step,
            stage: written.stage,
            outcome: written.outcome,
            driven_by,
            parameter: written.load_factor.or(written.rotation_deg).unwrap_or(f64::NAN),
            attempted_parameter: written.attempted_load_factor.or(written.attempted_rotation_deg).unwrap_or(f64::NAN),
            moment_n_mm: written.moment_n_mm.unwrap_or(0.0),
            strain_energy_n_mm: written.strain_energy_n_mm,
            work_n_mm: written.work_n_mm,
            put_in_n_mm: written.put_in_n_mm,
            elements: written.elements,
            unknowns: written.unknowns,
            iterations: written.iterations,
            factorizations: written.factorizations,
            negative_pivots: written.negative_pivots,
            residual: written.residual,
            energy_released_n_mm: written.energy_released_n_mm,
            jumped: written.jumped,
            rippled: written.rippled,
            marked: written.marked,
            largest_indicator: written.largest_indicator,
            estimated_error: written.estimated_error,
            probes: written.probes,
            connections: written.connections,
            path_length_mm: written.path_length_mm,
            critical_point: written.critical_point,
            warnings: written.warnings,
        }
    }
}

impl From<Report> for WrittenReport {
    fn from(report: Report) -> Self {
        let turning = |value: f64| (report.driven_by == Parameter::Rotation).then_some(value);
        let stepping = |value: f64| (report.driven_by == Parameter::LoadFactor).then_some(value);
        Self {
            rotation_deg: turning(report.parameter),
            attempted_rotation_deg: turning(report.attempted_parameter),
            moment_n_mm: turning(report.moment_n_mm),
            load_factor: stepping(report.parameter),
            attempted_load_factor: stepping(report.attempted_parameter),
            step: report.step,
            stage: report.stage,
            outcome: report.outcome,
            strain_energy_n_mm: report.strain_energy_n_mm,
            work_n_mm: report.work_n_mm,
            put_in_n_mm: report.put_in_n_mm,
            elements: report.elements,
            unknowns: report.unknowns,
            iterations: report.iterations,
            factorizations: report.factorizations,
            negative_pivots: report.negative_pivots,
            residual: report.residual,
            energy_released_n_mm: report.energy_released_n_mm,
            jumped: report.jumped,
            rippled: report.rippled,
            marked: report.marked,
            largest_indicator: report.largest_indicator,
            estimated_error: report.estimated_error,
            probes: report.probes,
            connections: report.connections,
            path_length_mm: report.path_length_mm,
            critical_point: report.critical_point,
            warnings: report.warnings,
        }
    }
}

/// How a stage ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Outcome {
    /// The stage did its work.
    Done,
    /// Solve: the increment jumped and will be halved until the jump is located.
    RejectedJump,
    /// Solve: no equilibrium was found; the increment, or the step along the path, will be halved.
    RejectedNoEquilibrium,
    /// Solve: the step passed a limit point or a bifurcation, and will be halved until that is located.
    RejectedCriticalPoint,
    /// Solve: the path turned too far, or the step ended on another branch; it will be halved.
    RejectedSharpTurn,
}
