//! What each stage did, in a line, as `foxglove.Log` messages for the log panel of a viewer; its warnings as warnings.

use serde::Serialize;

use super::Timestamp;
use crate::record::{Outcome, Parameter, Record, Report, released_in_words};
use crate::scene::Stage;
use crate::units::{count, reading};

/// A message.
#[derive(Serialize)]
pub(super) struct LogLine {
    timestamp: Timestamp,
    level: u8,
    message: String,
    name: &'static str,
    file: &'static str,
    line: u32,
}

const INFO: u8 = 2;
const WARNING: u8 = 3;

/// The lines about a stage: what it did, then its warnings.
pub(super) fn log_lines(record: &Record, loads_follow: bool, time_ns: u64) -> Vec<LogLine> {
    let report = &record.report;
    let line = |level: u8, message: String| LogLine {
        timestamp: Timestamp::of_ns(time_ns),
        level,
        message,
        name: report.stage.name(),
        file: "",
        line: 0,
    };
    let warnings = report.warnings.iter().map(|warning| line(WARNING, warning.in_words()));
    let level = if report.returned_from().is_some() { WARNING } else { INFO };
    std::iter::once(line(level, in_words(report, loads_follow))).chain(warnings).collect()
}

/// What a stage did.
fn in_words(report: &Report, loads_follow: bool) -> String {
    let at = |parameter: f64| report.driven_by.shown_short(parameter);
    let mut words = format!("load step {}, {}, {}", report.step, report.stage.name(), at(report.parameter));
    if report.driven_by == Parameter::Rotation {
        words += &format!(", {} N·mm", reading(report.moment_n_mm, 3).trim());
    }
    let tried = at(report.attempted_parameter);
    match report.outcome {
        Outcome::Done => {}
        Outcome::RejectedJump => words += &format!(": jumps before {tried}, halved to locate that"),
        Outcome::RejectedNoEquilibrium => words += &format!(": no equilibrium found at {tried}, halved"),
        Outcome::RejectedCriticalPoint => words += &format!(": a critical point before {tried}, halved to locate that"),
        Outcome::RejectedSharpTurn => words += &format!(": the path turns too far before {tried}, halved"),
    }
    if let Some(from) = report.returned_from() {
        words += &format!(": the refined mesh jumps, back from {}", at(from));
    }
    if report.jumped {
        words += &format!(": snapped, {}", released_in_words(report.energy_released_n_mm, loads_follow, 3));
    }
    if report.stage == Stage::EvaluateIndicators {
        let marked = report.marked.iter().zip(["u", "v"]).filter(|(spans, _)| **spans > 0);
        marked.for_each(|(spans, way)| words += &format!(", {} to refine along {way}", count(*spans, "span")));
    }
    if report.iterations > 0 {
        words += &format!(", {}", count(report.iterations, "iteration"));
    }
    words + &format!(", {} elements", report.elements)
}
