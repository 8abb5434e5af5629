//! A path of equilibria as curves over its length, for the tests that follow one.

use foldline::record::{CriticalPoint, Outcome, Record, Report};
use foldline::scene::{ArcLength, ArcLengthWord, Scene, parse};

use crate::support::run;

/// Arc length with the scene's defaults.
pub const ARC_LENGTH: ArcLength =
    ArcLength { control: ArcLengthWord::ArcLength, longest_step: 4.0, shortest_step: 1e-4, most_steps: 2000 };

/// Equilibria along a path, in order.
pub struct Path {
    pub points: Vec<Report>,
    /// Every stage of the run.
    pub records: Vec<Record>,
}

impl Path {
    /// Runs a scene to its end; every equilibrium at the end of a solve.
    pub fn of(scene: Scene) -> Self {
        let records: Vec<Record> = run(scene).into_iter().map(|(_, record)| record).collect();
        let mut points: Vec<Report> = Vec::new();
        for Record { report, .. } in &records {
            if report.outcome == Outcome::Done && report.stage.finds_equilibrium() {
                // On a finer mesh the same step ends elsewhere.
                if points.last().is_some_and(|last| last.step == report.step) {
                    points.pop();
                }
                points.push(report.clone());
            }
        }
        Self { points, records }
    }

    pub fn parameter(&self) -> Vec<f64> {
        self.points.iter().map(|report| report.parameter).collect()
    }

    pub fn moment(&self) -> Vec<f64> {
        self.points.iter().map(|report| report.moment_n_mm).collect()
    }

    pub fn probe(&self, name: &str) -> Vec<f64> {
        let read = |report: &Report| report.probes.iter().find(|probe| probe.name == name).unwrap().value;
        self.points.iter().map(read).collect()
    }

    /// What was passed on the way, and at which point.
    pub fn passed(&self) -> Vec<(usize, CriticalPoint)> {
        (0..self.points.len()).filter_map(|at| Some((at, self.points[at].critical_point?))).collect()
    }

    /// Points at which the parameter turned back.
    pub fn limit_points(&self) -> Vec<usize> {
        self.passed().into_iter().filter(|(_, critical)| critical.limit_point).map(|(at, _)| at).collect()
    }

    fn length(&self) -> Vec<f64> {
        self.points.iter().map(|report| report.path_length_mm.unwrap()).collect()
    }

    /// `of` where `over` has a value, for each time that the points from `from` to `to` pass it; both are interpolated by
    /// the length of the path, through four points.
    pub fn where_is(&self, over: &[f64], value: f64, of: &[f64], [from, to]: [usize; 2]) -> Vec<f64> {
        let length = self.length();
        let crossed = |at: &usize| (over[*at] - value) * (over[at + 1] - value) <= 0.0;
        (from..to)
            .filter(crossed)
            .map(|at| {
                let first = at.saturating_sub(1).min(length.len().saturating_sub(4));
                let through = first..length.len().min(first + 4);
                let at_length =
                    |values: &[f64], s: f64| lagrange(&length[through.clone()], &values[through.clone()], s);
                let (mut low, mut high) = (length[at], length[at + 1]);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    let same_side = (at_length(over, middle) - value) * (over[at] - value) > 0.0;
                    *if same_side { &mut low } else { &mut high } = middle;
                }
                at_length(of, low)
            })
            .collect()
    }

    /// Largest value between two points, interpolated by the length of the path.
    pub fn top(&self, values: &[f64], [from, to]: [usize; 2]) -> f64 {
        let length = self.length();
        let at = (from..=to).max_by(|i, j| values[*i].total_cmp(&values[*j])).unwrap();
        let first = at.saturating_sub(2).min(length.len() - 4);
        let through = first..first + 4;
        let (low, high) = (length[at.saturating_sub(1)], length[(at + 1).min(length.len() - 1)]);
        let between = (0..=1000).map(|part| low + (high - low) * f64::from(part) / 1000.0);
        between.map(|s| lagrange(&length[through.clone()], &values[through.clone()], s)).fold(f64::MIN, f64::max)
    }
}

fn lagrange(abscissas: &[f64], values: &[f64], at: f64) -> f64 {
    let term = |i: usize| {
        let others = (0..abscissas.len()).filter(|j| *j != i);
        others.fold(values[i], |product, j| product * (at - abscissas[j]) / (abscissas[i] - abscissas[j]))
    };
    (0..abscissas.len()).map(term).sum()
}

/// Loads that follow the shell have a tangent that is not symmetric: by arc length the path leads where load steps lead.
#[test]
fn follower_loads_by_arc_length_end_where_load_steps_do() {
    let mut scene = parse(include_str!("scenes/follower-ring.toml"), "follower-ring.toml").unwrap();
    let by_load = run(scene.clone()).pop().unwrap().0;
    scene.continuation = Some(ARC_LENGTH);
    let by_path = run(scene).pop().unwrap().0;
    assert!((by_load.parameter - by_path.parameter).abs() < 1e-9);
    let pairs = || by_load.displacement.as_flattened().iter().zip(by_path.displacement.as_flattened());
    let largest = pairs().fold(0.0_f64, |most, (u, _)| most.max(u.abs()));
    assert!(largest > 1.0 && pairs().all(|(u, v)| (u - v).abs() < 1e-6 * largest));
}
