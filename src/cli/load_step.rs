//! The stages of one load step, gathered into one line.

use crate::record::{CriticalPoint, Outcome, Parameter, Record, Report, released_in_words};
use crate::scene::{Scene, Stage};
use crate::spline::Elements;
use crate::units::{count, duration, reading};

/// A load step that found an equilibrium, with what it took to find it.
#[derive(Clone, Debug)]
pub(super) struct LoadStep {
    /// What its last stage reported.
    report: Report,
    elements_before: Elements,
    iterations: usize,
    wall_s: f64,
    /// Solves rejected on the way: without equilibrium, for a jump or an unstable shape on the way, for a critical point, for a sharp turn.
    rejected: [usize; 4],
    /// What the step passed on its path.
    passed: Option<CriticalPoint>,
    /// Energy released where it jumped, as far as it is known.
    released_n_mm: Option<Option<f64>>,
    loads_follow: bool,
    /// Whether a ripple of the mesh was passed.
    rippled: bool,
    /// Parameter that the run returned from, since the refined mesh jumps before it.
    returned_from: Option<f64>,
}

impl LoadStep {
    /// One line: step, rotation, moment, elements, iterations, time, and what else happened.
    pub(super) fn line(&self) -> String {
        let Report { step, parameter, moment_n_mm, ref elements, .. } = self.report;
        let reached = match self.report.driven_by {
            Parameter::Rotation => format!("{parameter:>8.3}°  {:>9} N·mm", reading(moment_n_mm, 3)),
            Parameter::LoadFactor => {
                let probe = self.report.probes.first();
                let shown =
                    probe.map(|probe| format!("  {} {:>11} {}", probe.name, reading(probe.value, 5), probe.unit));
                format!("factor {parameter:>8.4}{}", shown.unwrap_or_default())
            }
        };
        let elements = elements.to_string();
        let mut line = format!(
            "step {step:>4}  {reached}  {elements:>9}  {:>3} {:<10}  {:>8}",
            self.iterations,
            if self.iterations == 1 { "iteration" } else { "iterations" },
            duration(self.wall_s)
        );
        for event in self.events() {
            line.push_str("  ");
            line.push_str(&event);
        }
        line
    }

    /// Refinement, jump, rejected solves, instability: in words, where they happened.
    pub(super) fn events(&self) -> Vec<String> {
        let mut events = Vec::new();
        if let Some(released) = self.released_n_mm {
            events.push(format!("snapped, {}", released_in_words(released, self.loads_follow, 2)));
        }
        if self.rippled {
            events.push("a ripple of the mesh".to_string());
        }
        if self.elements_before != self.report.elements {
            events.push(format!("refined from {}", self.elements_before));
        }
        if let Some(parameter) = self.returned_from {
            events.push(format!(
                "back from {}, before which this mesh jumps",
                self.report.driven_by.shown_short(parameter)
            ));
        }
        if self.report.negative_pivots > 0 {
            events.push(format!("not stable ({})", count(self.report.negative_pivots as usize, "negative pivot")));
        }
        if let Some(passed) = self.passed {
            events.push(format!("passed {}", passed.in_words()));
        }
        let [no_equilibrium, jump, critical, turn] = self.rejected;
        if no_equilibrium > 0 {
            events.push(format!("after {} without equilibrium", count(no_equilibrium, "solve")));
        }
        if jump > 0 {
            let why = if self.released_n_mm.is_some() { "too far past the jump" } else { "unstable on the way" };
            events.push(format!("after {} {why}", count(jump, "solve")));
        }
        if critical > 0 {
            events.push(format!("after {} past a critical point ahead", count(critical, "solve")));
        }
        if turn > 0 {
            events.push(format!("after {} round too sharp a turn", count(turn, "solve")));
        }
        events
    }

    /// Whether it is worth a line of its own above a live one.
    pub(super) fn is_eventful(&self) -> bool {
        self.released_n_mm.is_some()
            || self.passed.is_some()
            || self.elements_before != self.report.elements
            || self.report.negative_pivots > 0
    }
}

/// Gathers stages until a load step is over.
#[derive(Debug)]
pub(super) struct Gatherer {
    refines: bool,
    loads_follow: bool,
    last_stage: Option<Stage>,
    elements: Option<Elements>,
    pending_rejections: [usize; 4],
    pending_iterations: usize,
    pending_wall_s: f64,
    open: Option<LoadStep>,
}

impl Gatherer {
    /// Creates a gatherer for runs of `scene`.
    pub(super) fn new(scene: &Scene) -> Self {
        Self {
            refines: scene.pipeline.contains(&Stage::RefineKnots),
            loads_follow: scene.loads_follow(),
            last_stage: scene.pipeline.last().copied(),
            elements: None,
            pending_rejections: [0; 4],
            pending_iterations: 0,
            pending_wall_s: 0.0,
            open: None,
        }
    }

    /// Takes a stage, and gives the load steps that are over now: none, the one before, the one that this stage ends.
    pub(super) fn take(&mut self, record: &Record) -> Vec<LoadStep> {
        let report = &record.report;
        let mut over = Vec::new();
        if report.stage == Stage::Solve {
            over.extend(self.open.take());
            if report.outcome == Outcome::Done {
                self.open = Some(LoadStep {
                    report: report.clone(),
                    elements_before: self.elements.clone().unwrap_or_else(|| report.elements.clone()),
                    iterations: std::mem::take(&mut self.pending_iterations),
                    wall_s: std::mem::take(&mut self.pending_wall_s),
                    rejected: std::mem::take(&mut self.pending_rejections),
                    released_n_mm: None,
                    loads_follow: self.loads_follow,
                    rippled: report.rippled,
                    passed: report.critical_point,
                    returned_from: None,
                });
            }
        }
        self.elements = Some(report.elements.clone());
        match report.outcome {
            Outcome::Done => {}
            Outcome::RejectedNoEquilibrium => self.pending_rejections[0] += 1,
            Outcome::RejectedJump => self.pending_rejections[1] += 1,
            Outcome::RejectedCriticalPoint => self.pending_rejections[2] += 1,
            Outcome::RejectedSharpTurn => self.pending_rejections[3] += 1,
        }
        match &mut self.open {
            Some(step) => {
                // Only an equilibrium has readings of the probes.
                let probes = std::mem::take(&mut step.report.probes);
                step.report = report.clone();
                if step.report.probes.is_empty() {
                    step.report.probes = probes;
                }
                step.iterations += report.iterations;
                step.returned_from = report.returned_from().or(step.returned_from);
                step.wall_s += record.wall_s;
                if report.jumped {
                    let before = step.released_n_mm.unwrap_or(Some(0.0));
                    let both = before.zip(report.energy_released_n_mm);
                    step.released_n_mm = Some(both.map(|(before, now)| before + now));
                }
            }
            None => {
                self.pending_iterations += report.iterations;
                self.pending_wall_s += record.wall_s;
            }
        }
        if self.ends_step(report) {
            over.extend(self.open.take());
        }
        over
    }

    /// The step that was still open when the run ended.
    pub(super) fn finish(&mut self) -> Option<LoadStep> {
        self.open.take()
    }

    fn ends_step(&self, report: &Report) -> bool {
        if self.refines {
            report.stage == Stage::EvaluateIndicators && report.marked == [0, 0]
        } else {
            Some(report.stage) == self.last_stage
        }
    }
}
