//! A run made up for tests of what is shown: the moments of a fine reference solution of the baseline tape spring
//! (300 × 10 × 0.1 mm, 110°), one adaptive load step after another, with every kind of outcome.

use std::sync::Arc;

use foldline::record::{Commit, Outcome, Parameter, Record, Report, Warning};
use foldline::scene::{
    Adapt, EndRotation, Geometry, Indicator, LengthLimit, Load, Material, MeshSpec, NumbersIn, Output, Pose,
    Quadrature, Scene, Sense, Solver, Splitting, Stage, Symmetry, SyncPolicy,
};
use foldline::state::{DriveMemory, Hash, Mesh, Patch, State};

/// (rotation in degrees, moment in N·mm, strain energy in N·mm).
pub const CURVE: [(f64, f64, f64); 14] = [
    (0.8, 38.637491, 0.540188),
    (1.6, 76.628077, 2.151889),
    (2.4, 113.312930, 4.807741),
    (4.0, 180.327184, 13.054374),
    (5.6, 235.151220, 24.723235),
    (6.8, 265.813992, 35.250204),
    (8.0, 285.647315, 46.841047),
    (8.8, 291.695175, 54.917427),
    (9.6, 289.124724, 63.055972),
    (10.0, 26.568167, 32.526839),
    (12.0, 26.480951, 34.377134),
    (16.0, 26.784427, 38.090191),
    (18.0, 27.115282, 39.970959),
    (20.0, 27.541922, 41.878469),
];

/// The baseline, adaptive, as a quarter model.
pub fn scene() -> Scene {
    Scene {
        geometry: Geometry::TapeSpring { length_mm: 300.0, radius_mm: 10.0, arc_deg: 110.0 },
        material: Material::Isotropic {
            youngs_modulus_mpa: 131e3,
            poissons_ratio: 0.3,
            thickness_mm: 0.1,
            density_kg_m3: None,
            offset_mm: 0.0,
            thermal_expansion_per_k: None,
        },
        mesh: MeshSpec { degree: [3, 3], elements: [4, 4], quadrature: Quadrature::Full },
        pose: Pose::default(),
        shells: vec![],
        joints: vec![],
        bonds: vec![],
        imperfections: vec![],
        symmetry: Symmetry::Quarter,
        load: Load::EndRotation(EndRotation {
            sense: Sense::Opposite,
            rotation_deg: 20.0,
            increment_deg: 0.8,
            longest_increment_deg: None,
        }),
        supports: vec![],
        actions: vec![],
        probes: vec![],
        adapt: Some(Adapt {
            indicator: Indicator::BendingStrain([0.019; 2]),
            length_limit: LengthLimit::SqrtRadiusThickness,
            splitting: Splitting::Halves,
        }),
        solver: Solver {
            tolerance: 1e-7,
            max_iterations: 60,
            least_increment_deg: Some(1e-3),
            snap_tolerance_deg: Some(0.02),
        },
        continuation: None,
        pipeline: Stage::REFINING.to_vec(),
        output: Output { sync: SyncPolicy::EachSecond, mesh_history: false, units: NumbersIn::Keys },
        expect: None,
    }
}

/// Writes the records of a run, one stage after another.
pub struct Script {
    records: Vec<Record>,
    last: Report,
}

impl Script {
    /// A run that has not begun.
    pub fn new() -> Self {
        let last = Report {
            step: 0,
            driven_by: Parameter::Rotation,
            work_n_mm: 0.0,
            put_in_n_mm: 0.0,
            probes: vec![],
            connections: vec![],
            path_length_mm: None,
            critical_point: None,
            warnings: vec![],
            stage: Stage::Solve,
            outcome: Outcome::Done,
            parameter: 0.0,
            attempted_parameter: 0.0,
            moment_n_mm: 0.0,
            strain_energy_n_mm: 0.0,
            elements: [2, 2].into(),
            unknowns: 63,
            iterations: 0,
            factorizations: 0,
            negative_pivots: 0,
            residual: 0.0,
            energy_released_n_mm: Some(0.0),
            jumped: false,
            rippled: false,
            marked: [0, 0],
            largest_indicator: [0.0, 0.0],
            estimated_error: None,
        };
        Self { records: Vec::new(), last }
    }

    /// What was written.
    pub fn records(self) -> Vec<Record> {
        self.records
    }

    fn push(&mut self, report: Report, wall_s: f64) {
        let hash = |text: &str| -> Hash { blake3::hash(text.as_bytes()) };
        let previous = self.records.last().map(|record| record.commit);
        let parent = previous.map_or(hash("start"), |commit| commit.state_hash);
        let state = hash(&format!("state {}", self.records.len()));
        let commit = Commit::next(previous.as_ref(), report.stage, report.step, hash("scene"), parent, state);
        self.last = Report {
            iterations: 0,
            factorizations: 0,
            residual: 0.0,
            energy_released_n_mm: Some(0.0),
            jumped: false,
            rippled: false,
            marked: [0, 0],
            largest_indicator: [0.0, 0.0],
            estimated_error: None,
            outcome: Outcome::Done,
            warnings: vec![],
            ..report.clone()
        };
        self.records.push(Record { report, commit, wall_s, kept_s: 0.0 });
    }

    /// A solve that is rejected.
    pub fn rejected(&mut self, attempted_parameter: f64, outcome: Outcome) {
        let report = Report {
            step: self.last.step + 1,
            stage: Stage::Solve,
            outcome,
            attempted_parameter,
            iterations: 41,
            factorizations: 46,
            residual: 3.2e-3,
            ..self.last.clone()
        };
        self.push(report, 1.25);
        self.last.step -= 1;
    }

    /// A solve that is taken.
    pub fn solve(&mut self, (parameter, moment_n_mm, strain_energy_n_mm): (f64, f64, f64), jumped: bool) {
        let released = if jumped { self.last.strain_energy_n_mm - strain_energy_n_mm + 1.9 } else { 0.0 };
        let report = Report {
            step: self.last.step + 1,
            stage: Stage::Solve,
            parameter,
            attempted_parameter: parameter,
            moment_n_mm,
            strain_energy_n_mm,
            iterations: if jumped { 38 } else { 3 },
            factorizations: if jumped { 44 } else { 4 },
            residual: 2.1e-9,
            energy_released_n_mm: Some(released),
            jumped,
            ..self.last.clone()
        };
        self.push(report, if jumped { 2.5 } else { 0.125 });
    }

    /// Indicators that mark so many spans each way.
    pub fn evaluate(&mut self, marked: [usize; 2]) {
        let largest_indicator = marked.map(|spans| if spans > 0 { 0.0231 } else { 0.0172 });
        let report = Report { stage: Stage::EvaluateIndicators, marked, largest_indicator, ..self.last.clone() };
        self.push(report, 0.004);
    }

    /// The three stages of a refinement.
    pub fn refine(&mut self, elements: [usize; 2]) {
        let marked = [0, 1].map(|k| elements[k] - self.last.elements.each()[0][k]);
        self.push(Report { stage: Stage::RefineKnots, elements: elements.into(), marked, ..self.last.clone() }, 0.001);
        let unknowns = 3 * (elements[0] + 3) * (elements[1] + 3) - 12;
        self.push(Report { stage: Stage::ProjectDisplacements, unknowns, ..self.last.clone() }, 0.002);
        let report = Report {
            stage: Stage::ReEquilibrate,
            iterations: 4,
            factorizations: 4,
            residual: 6.5e-10,
            strain_energy_n_mm: self.last.strain_energy_n_mm - 1e-3,
            ..self.last.clone()
        };
        self.push(report, 0.25);
    }

    /// Warnings of the stage that was written last.
    pub fn warn(&mut self, warnings: &[Warning]) {
        let last = self.records.last_mut().expect("a stage");
        last.report.warnings.extend_from_slice(warnings);
    }

    /// A load step that needs no refinement.
    pub fn step(&mut self, point: (f64, f64, f64)) {
        self.solve(point, false);
        self.evaluate([0, 0]);
    }
}

/// The whole run: three refinements, a solve without equilibrium, a jump rejected twice and then taken.
pub fn records() -> Vec<Record> {
    let mut script = Script::new();
    script.step(CURVE[0]);
    script.step(CURVE[1]);
    script.solve(CURVE[2], false);
    script.evaluate([2, 2]);
    script.refine([4, 4]);
    script.evaluate([0, 0]);
    script.step(CURVE[3]);
    script.solve(CURVE[4], false);
    script.evaluate([4, 0]);
    script.refine([8, 4]);
    script.evaluate([2, 4]);
    script.refine([10, 8]);
    script.evaluate([0, 0]);
    script.rejected(7.2, Outcome::RejectedNoEquilibrium);
    for point in &CURVE[5..9] {
        script.step(*point);
    }
    script.rejected(10.4, Outcome::RejectedJump);
    script.rejected(10.0, Outcome::RejectedJump);
    let (_, moment, energy) = CURVE[9];
    script.solve((9.615, moment, energy), true);
    script.evaluate([6, 0]);
    script.refine([16, 8]);
    script.evaluate([0, 0]);
    for point in &CURVE[10..] {
        script.step(*point);
    }
    script.records()
}

/// A state to hand to a sink beside `record`; what is shown does not look into it.
pub fn state(record: &Record) -> State {
    State {
        mesh: Arc::new(Mesh::from(Patch {
            degree: [1, 1],
            knots: [vec![0.0, 0.0, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]],
            control_points: vec![[0.0, 0.0, 0.0, 1.0]; 4],
        })),
        displacement: vec![[0.0; 3]; 4],
        marked: vec![[vec![], vec![]]],
        refined: None,
        step: record.report.step,
        stage: Some(record.report.stage),
        turns: vec![],
        parameter: record.report.parameter,
        moment_n_mm: record.report.moment_n_mm,
        strain_energy_n_mm: record.report.strain_energy_n_mm,
        negative_pivots: record.report.negative_pivots,
        drive: DriveMemory::default(),
        largest_force_n: 0.0,
        refinement: None,
        superfluous: vec![[vec![], vec![]]],
        estimate: None,
    }
}

/// A run on a mesh that shows too little: energy that refining changes before the jump, blocked spans behind it.
pub fn coarse_records() -> Vec<Record> {
    let mut script = Script::new();
    script.step(CURVE[0]);
    for (point, energy_change) in [(CURVE[1], 0.121), (CURVE[2], -0.52)] {
        script.solve(point, false);
        script.evaluate([2, 2]);
        script.refine([4, 4]);
        let (parameter, elements) = (point.0, [4, 4].into());
        script.warn(&[Warning::EnergyChangedByRefining { parameter, elements, energy_change }]);
        script.evaluate([0, 0]);
    }
    script.step(CURVE[8]);
    script.solve(CURVE[9], true);
    script.warn(&[Warning::CoarseElements { parameter: CURVE[8].0, elements: [4, 4].into(), energy_share: 0.64 }]);
    script.evaluate([0, 0]);
    let (parameter, spans) = (CURVE[9].0, [1, 4]);
    script.warn(&[Warning::RefinementBlocked { parameter, spans, decay_lengths: 4.31, over_threshold: 93.2 }]);
    script.records()
}
