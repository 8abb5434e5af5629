//! A run as it is drawn: the equilibria of its path, with what the run had spent by the end of their load steps.

use super::PlotError;
use crate::record::{CriticalPoint, Outcome, Record, Report};
use crate::scene::Scene;
use crate::study::records_on_path;

/// A run to be drawn.
#[derive(Clone, Debug)]
pub struct PlottedRun<'r> {
    /// What the legend calls it.
    pub name: String,
    /// The scene that it is a run of.
    pub scene: &'r Scene,
    /// Its stages.
    pub records: &'r [Record],
}

/// An equilibrium on the path of a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlottedPoint<'r> {
    pub(super) report: &'r Report,
    pub(super) jumped: bool,
    pub(super) passed: Option<CriticalPoint>,
    /// What the run came to by the end of the load step.
    pub(super) so_far: Spent,
    /// What the load step itself took.
    pub(super) in_step: Spent,
}

/// What stages came to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spent {
    pub(super) wall_s: f64,
    pub(super) iterations: f64,
    pub(super) factorizations: f64,
    pub(super) work_n_mm: f64,
    /// `None` from the first jump on whose energy is not known.
    pub(super) released_n_mm: Option<f64>,
    /// That of the last evaluation.
    pub(super) largest_indicator: Option<f64>,
    /// That of the last estimate.
    pub(super) estimated_error: Option<f64>,
}

impl Spent {
    const NOTHING: Self = Self {
        wall_s: 0.0,
        iterations: 0.0,
        factorizations: 0.0,
        work_n_mm: 0.0,
        released_n_mm: Some(0.0),
        largest_indicator: None,
        estimated_error: None,
    };

    fn with(self, Record { report, wall_s, .. }: &Record) -> Self {
        let larger = |[one, other]: [f64; 2]| one.max(other);
        let is_done = report.outcome == Outcome::Done;
        let evaluated = (report.largest_indicator != [0.0; 2]).then_some(larger(report.largest_indicator));
        Self {
            wall_s: self.wall_s + wall_s,
            iterations: self.iterations + report.iterations as f64,
            factorizations: self.factorizations + report.factorizations as f64,
            work_n_mm: self.work_n_mm + if is_done { report.work_n_mm } else { 0.0 },
            released_n_mm: match is_done {
                true => self.released_n_mm.zip(report.energy_released_n_mm).map(|(before, now)| before + now),
                false => self.released_n_mm,
            },
            largest_indicator: evaluated.or(self.largest_indicator),
            estimated_error: report.estimated_error.map(larger).or(self.estimated_error),
        }
    }
}

impl<'r> PlottedRun<'r> {
    /// The equilibria of the path.
    ///
    /// # Errors
    /// Where there is none yet.
    pub(super) fn points(&self) -> Result<Vec<PlottedPoint<'r>>, PlotError> {
        let mut so_far = Spent::NOTHING;
        // In the order of the steps; a map would take twice the memory of a long run.
        let mut by_step: Vec<(u64, [Spent; 2])> = Vec::new();
        for record in self.records {
            so_far = so_far.with(record);
            let step = record.report.step;
            let in_step = by_step.pop_if(|(last, _)| *last == step).map_or(Spent::NOTHING, |(_, [_, in_step])| in_step);
            by_step.push((step, [so_far, in_step.with(record)]));
        }
        let spent_by = |step: u64| {
            let place = by_step.binary_search_by_key(&step, |(step, _)| *step);
            place.map_or([Spent::NOTHING; 2], |place| by_step[place].1)
        };
        let point = |on: crate::study::OnPath<'r>| {
            let report = &on.record.report;
            let [so_far, in_step] = spent_by(report.step);
            PlottedPoint { report, jumped: on.jumped, passed: on.passed.map(|(passed, _)| passed), so_far, in_step }
        };
        let points: Vec<_> = records_on_path(self.records).into_iter().map(point).collect();
        if points.is_empty() { Err(PlotError::NoEquilibrium) } else { Ok(points) }
    }
}
