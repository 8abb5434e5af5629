//! Runs that look like runs and cost nothing: the journal does not ask where a state comes from.

use std::sync::Arc;

use foldline::journal::{Manifest, format::FORMAT_VERSION};
use foldline::record::{Commit, Outcome, Parameter, Record, Report};
use foldline::scene::Stage;
use foldline::state::{Hash, Patch, Rejection, State, StepControl};

/// Open uniform knots of `degree` with `elements` spans on [0, 1].
pub fn uniform_knots(degree: usize, elements: usize) -> Vec<f64> {
    let inner = (1..elements).map(|k| k as f64 / elements as f64);
    let ends = |value: f64| std::iter::repeat_n(value, degree + 1);
    ends(0.0).chain(inner).chain(ends(1.0)).collect()
}

/// Up and down again, by arithmetic that gives the same bits everywhere.
fn wave(x: f64) -> f64 {
    x / (1.0 + x * x)
}

/// A mesh with quadratic splines and these knots; its control points are made up.
pub fn mesh(knots: [Vec<f64>; 2]) -> Patch {
    let counts = [0, 1].map(|way| knots[way].len() - 3);
    let point = |k: usize| [k as f64, wave(k as f64), 1.0 - wave(k as f64), 1.0];
    Patch { degree: [2, 2], knots, control_points: (0..counts[0] * counts[1]).map(point).collect() }
}

/// The state that a run of `elements` × `elements` elements starts from.
pub fn start(elements: usize) -> State {
    State::undeformed(mesh([uniform_knots(2, elements), uniform_knots(2, elements)]))
}

fn moved(state: &State, by: f64) -> Vec<[f64; 3]> {
    let shift = |(k, u): (usize, &[f64; 3])| [u[0] + by * wave(k as f64), u[1] - by * by, u[2] + by / (k as f64 + 1.0)];
    state.displacement.iter().enumerate().map(shift).collect()
}

/// The stage that follows, and what it makes; a pure function, as stages are.
pub fn next(state: &State) -> (State, Report) {
    let (stage, step) = match state.stage {
        None | Some(Stage::ReEquilibrate) => (Stage::Solve, state.step + 1),
        Some(Stage::Solve) => (Stage::EvaluateIndicators, state.step),
        Some(Stage::EvaluateIndicators | Stage::SwitchBranch) if state.marked[0][0].is_empty() => {
            (Stage::Solve, state.step + 1)
        }
        Some(Stage::EvaluateIndicators | Stage::SwitchBranch) => (Stage::RefineKnots, state.step),
        Some(Stage::RefineKnots) => (Stage::ProjectDisplacements, state.step),
        Some(Stage::ProjectDisplacements | Stage::CoarsenKnots) => (Stage::ReEquilibrate, state.step),
    };
    let mut new = State { stage: Some(stage), step, ..state.clone() };
    match stage {
        Stage::Solve => {
            new.parameter += 0.7;
            new.displacement = moved(state, 0.01 * new.parameter);
            new.moment_n_mm = 100.0 * wave(new.parameter);
            new.strain_energy_n_mm = 50.0 * new.parameter * new.parameter;
            let rejection = (step % 4 == 3).then_some(Rejection::Jump);
            let jump_beyond = rejection.map(|_| new.parameter + 0.3);
            new.drive.control = StepControl { halvings: (step % 3) as i32, jump_beyond, rejection };
        }
        Stage::EvaluateIndicators if step % 3 == 0 && state.mesh.patches[0].knots[0].len() < 60 => {
            let spans = state.mesh.patches[0].knots[0].windows(2).filter(|pair| pair[0] < pair[1]);
            new.marked[0][0] = spans.take(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        }
        Stage::EvaluateIndicators => {}
        Stage::RefineKnots => {
            let mut knots = state.mesh.patches[0].knots.clone();
            knots[0].extend(&state.marked[0][0]);
            knots[0].sort_by(f64::total_cmp);
            new.refined = Some(Arc::new(mesh(knots).into()));
            new.marked[0][0].clear();
        }
        Stage::ProjectDisplacements => {
            new.mesh = new.refined.take().unwrap_or_else(|| state.mesh.clone());
            new.displacement = vec![[0.125 * state.parameter; 3]; new.mesh.point_count()];
        }
        Stage::ReEquilibrate | Stage::SwitchBranch | Stage::CoarsenKnots => new.displacement = moved(state, 1.0e-3),
    }
    let report = Report {
        step,
        stage,
        outcome: if new.drive.control.rejection.is_some() { Outcome::RejectedJump } else { Outcome::Done },
        driven_by: Parameter::Rotation,
        work_n_mm: 0.0,
        put_in_n_mm: 0.0,
        probes: vec![],
        connections: vec![],
        path_length_mm: None,
        critical_point: None,
        warnings: vec![],
        parameter: new.parameter,
        attempted_parameter: new.parameter + 0.1,
        moment_n_mm: new.moment_n_mm,
        strain_energy_n_mm: new.strain_energy_n_mm,
        elements: new.refined.as_ref().unwrap_or(&new.mesh).elements(),
        unknowns: 3 * new.displacement.len(),
        iterations: 4,
        factorizations: 5,
        negative_pivots: 0,
        residual: 1.0e-11 / step as f64,
        energy_released_n_mm: Some(0.0),
        jumped: false,
        rippled: false,
        marked: [new.marked[0][0].len(), new.marked[0][1].len()],
        largest_indicator: [0.1, 0.2],
        estimated_error: None,
    };
    (new, report)
}

pub fn scene_hash() -> Hash {
    blake3::hash(b"a scene")
}

/// Continues by `stages` stages behind `previous`, from `state`.
pub fn go_on(state: &State, previous: Option<&Commit>, stages: usize) -> Vec<(State, Record)> {
    let (mut state, mut previous) = (state.clone(), previous.copied());
    (0..stages)
        .map(|_| {
            let parent = state.hash();
            let (new, report) = next(&state);
            let commit = Commit::next(previous.as_ref(), report.stage, report.step, scene_hash(), parent, new.hash());
            state = new.clone();
            previous = Some(commit);
            (new, Record { report, commit, wall_s: 0.25, kept_s: 0.01 })
        })
        .collect()
}

/// A whole run from its start.
pub fn run(elements: usize, stages: usize) -> Vec<(State, Record)> {
    go_on(&start(elements), None, stages)
}

/// A manifest that is the same wherever the tests run.
pub fn manifest() -> Manifest {
    Manifest {
        format_version: FORMAT_VERSION,
        program_version: "0.1.0".to_owned(),
        scene_file: "pipelines/made-up.toml".to_owned(),
        scene_text: "# a made-up scene\n[geometry]\nkind = \"tape-spring\"\n".to_owned(),
        cpu: "x86_64".to_owned(),
        cpu_features: vec!["avx2".to_owned(), "fma".to_owned()],
        kernel: "avx2+fma".to_owned(),
        numerics: 1,
        threads: 2,
        host: "somewhere".to_owned(),
        started_unix_s: 1_700_000_000,
        first_ordinal: 0,
        same_scene: false,
        own_terms: Vec::new(),
    }
}
