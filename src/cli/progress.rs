//! What a run shows while it continues: a live line on a terminal, a plain line for each load step otherwise, JSON lines
//! for programs, or nothing.

use std::io::{self, ErrorKind, Write};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget};

use super::json_line::json_line;
use super::load_step::Gatherer;
use super::output::{escaped, printable};
use super::terminal::{can_overwrite, error_columns};
use super::wrapped::fitted;
use crate::record::{Outcome, Parameter, Record, Report, Sink, SinkError};
use crate::scene::Scene;
use crate::state::State;
use crate::units::{count, rounded};

/// How the progress of a run is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgressStyle {
    /// Nothing.
    Quiet,
    /// A line that changes in place, on standard error.
    Live,
    /// A line for each load step with an equilibrium, on standard error.
    Lines,
    /// A JSON object for each stage, on standard output.
    Json,
}

impl ProgressStyle {
    /// The style that the arguments `--quiet` and `--json` choose; a live line only on a terminal that can write
    /// over one.
    pub fn of(quiet: bool, json: bool) -> Self {
        match (quiet, json) {
            (_, true) => ProgressStyle::Json,
            (true, _) => ProgressStyle::Quiet,
            _ if can_overwrite() => ProgressStyle::Live,
            _ => ProgressStyle::Lines,
        }
    }
}

/// A sink that shows the progress of a run: it hands every stage to an inner sink first, so that what is shown is also
/// kept.
pub struct ProgressSink<'a, S> {
    inner: S,
    display: Display<'a>,
    records: Vec<Record>,
    /// Kinds of warnings that were shown.
    warned: Vec<&'static str>,
}

enum Display<'a> {
    Quiet,
    Live {
        bar: ProgressBar,
        target: f64,
        gatherer: Gatherer,
    },
    Lines {
        out: Box<dyn Write + 'a>,
        /// Columns that a line may have.
        columns: Option<usize>,
        gatherer: Gatherer,
    },
    /// `None` after the reader has closed its end.
    Json(Option<Box<dyn Write + 'a>>),
}

impl<'a, S: Sink> ProgressSink<'a, S> {
    /// Creates a sink that shows a run of `scene` on the streams of this process; the run leads from parameter `start`
    /// (0, or where it is resumed) to `target`.
    pub fn new(inner: S, style: ProgressStyle, scene: &Scene, [start, target]: [f64; 2]) -> Self {
        let gatherer = Gatherer::new(scene);
        let display = match style {
            ProgressStyle::Quiet => Display::Quiet,
            ProgressStyle::Live => {
                Display::Live { bar: live_bar(Parameter::of(scene), target, start), target, gatherer }
            }
            ProgressStyle::Lines => Display::Lines { out: Box::new(io::stderr()), columns: error_columns(), gatherer },
            ProgressStyle::Json => Display::Json(Some(Box::new(io::stdout()))),
        };
        Self { inner, display, records: Vec::new(), warned: Vec::new() }
    }

    /// Creates a sink that writes the lines of [`ProgressStyle::Lines`] to `out`.
    pub fn lines(inner: S, scene: &Scene, out: impl Write + 'a) -> Self {
        let display = Display::Lines { out: Box::new(out), columns: None, gatherer: Gatherer::new(scene) };
        Self { inner, display, records: Vec::new(), warned: Vec::new() }
    }

    /// Creates a sink that writes the lines of [`ProgressStyle::Json`] to `out`.
    pub fn json(inner: S, out: impl Write + 'a) -> Self {
        Self { inner, display: Display::Json(Some(Box::new(out))), records: Vec::new(), warned: Vec::new() }
    }

    /// Ends the display, however the run ended, and returns the inner sink and the records of the stages that were
    /// shown.
    pub fn finish(mut self) -> (S, Vec<Record>) {
        match &mut self.display {
            Display::Live { bar, gatherer, .. } => {
                if let Some(step) = gatherer.finish().filter(|step| step.is_eventful()) {
                    bar.println(printable(&fitted(&step.line(), error_columns())));
                }
                bar.finish_and_clear();
            }
            Display::Lines { out, columns, gatherer } => {
                if let Some(step) = gatherer.finish() {
                    write_or_forget(out, &fitted(&step.line(), *columns));
                }
            }
            Display::Json(_) | Display::Quiet => {}
        }
        (self.inner, self.records)
    }

    fn show(&mut self, record: &Record) -> Result<(), SinkError> {
        let warnings = self.new_warnings(record);
        match &mut self.display {
            Display::Quiet => {}
            Display::Live { bar, target, gatherer } => {
                for step in gatherer.take(record).into_iter().filter(|step| step.is_eventful()) {
                    bar.println(printable(&fitted(&step.line(), error_columns())));
                }
                warnings.iter().for_each(|line| bar.println(printable(&fitted(line, error_columns()))));
                bar.set_position(thousandths(record.report.parameter));
                bar.set_prefix(live_prefix(record.report.driven_by, record.report.parameter, *target));
                bar.set_message(live_message(&record.report));
            }
            Display::Lines { out, columns, gatherer } => {
                for step in gatherer.take(record) {
                    write_or_forget(out, &fitted(&step.line(), *columns));
                }
                warnings.iter().for_each(|line| write_or_forget(out, &fitted(line, *columns)));
            }
            Display::Json(out) => {
                let Some(open) = out else { return Ok(()) };
                match writeln!(open, "{}", escaped(json_line(record))).and_then(|()| open.flush()) {
                    Ok(()) => {}
                    // The reader has seen enough. The log is what the run is for, so it continues.
                    Err(error) if error.kind() == ErrorKind::BrokenPipe => *out = None,
                    Err(error) => {
                        let context = format!(
                            "cannot write stage {} as a JSON line; the log has it, and the run can be resumed",
                            record.commit.ordinal
                        );
                        return Err(SinkError { context, source: Some(Box::new(error)) });
                    }
                }
            }
        }
        Ok(())
    }
}

impl<S> ProgressSink<'_, S> {
    /// Lines for warnings of kinds that were not shown before; how often each was reported is in the summary.
    fn new_warnings(&mut self, record: &Record) -> Vec<String> {
        let mut lines = Vec::new();
        for warning in &record.report.warnings {
            if !self.warned.contains(&warning.name()) {
                self.warned.push(warning.name());
                let at = record.report.driven_by.shown_short(warning.parameter());
                lines.push(format!("warning at {at}: {}", warning.in_words()));
            }
        }
        lines
    }
}

impl<S: Sink> Sink for ProgressSink<'_, S> {
    fn take(&mut self, state: &State, record: &Record) -> Result<(), SinkError> {
        self.inner.take(state, record)?;
        self.records.push(record.clone());
        self.show(record)
    }
}

/// Progress is worth nothing if nobody reads it: a closed stream does not stop a run.
fn write_or_forget(out: &mut dyn Write, line: &str) {
    let _ = writeln!(out, "{}", printable(line));
}

/// Rotation as a position of the bar.
fn thousandths(parameter: f64) -> u64 {
    (parameter * 1000.0).max(0.0) as u64
}

fn live_bar(driven_by: Parameter, target: f64, start: f64) -> ProgressBar {
    let template = "{prefix}  {bar:10}  {wide_msg}  {elapsed}, {eta} left";
    let style =
        indicatif::ProgressStyle::with_template(template).unwrap_or_else(|_| indicatif::ProgressStyle::default_bar());
    let bar = ProgressBar::with_draw_target(Some(thousandths(target)), ProgressDrawTarget::stderr())
        .with_style(style.progress_chars("━╸─"))
        .with_prefix(live_prefix(driven_by, start, target))
        .with_position(thousandths(start));
    bar.reset_eta();
    // It takes a thread, and does not bear that there is none.
    if std::thread::Builder::new().spawn(|| {}).is_ok() {
        bar.enable_steady_tick(Duration::from_millis(200));
    }
    bar
}

/// The text before the bar.
fn live_prefix(driven_by: Parameter, parameter: f64, target: f64) -> String {
    match driven_by {
        Parameter::Rotation => format!("{parameter:.3}° of {}°", rounded(target)),
        Parameter::LoadFactor => format!("{parameter:.4} of {}", rounded(target)),
    }
}

/// The text after the bar: the last stage and the numbers of the state that it made.
fn live_message(report: &Report) -> String {
    let Report { stage, moment_n_mm, elements, .. } = report;
    let degree = if report.driven_by == Parameter::Rotation { "°" } else { "" };
    let outcome = match report.outcome {
        Outcome::Done if report.iterations > 0 => format!(", {}", count(report.iterations, "iteration")),
        Outcome::Done => String::new(),
        Outcome::RejectedJump => {
            format!(" rejected at {:.3}{degree}: unstable on the way", report.attempted_parameter)
        }
        Outcome::RejectedCriticalPoint => {
            format!(" rejected at {:.3}{degree}: past a critical point", report.attempted_parameter)
        }
        Outcome::RejectedSharpTurn => {
            format!(" rejected at {:.3}{degree}: too sharp a turn", report.attempted_parameter)
        }
        Outcome::RejectedNoEquilibrium => {
            format!(" rejected at {:.3}{degree}: no equilibrium", report.attempted_parameter)
        }
    };
    let elements = elements.with_sign("×");
    match report.driven_by {
        Parameter::Rotation => format!("{moment_n_mm:.2} N·mm  {elements}  {stage}{outcome}"),
        Parameter::LoadFactor => format!("{elements}  {stage}{outcome}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Stage;

    #[test]
    fn live_line() {
        let mut report = Report {
            step: 7,
            stage: Stage::Solve,
            outcome: Outcome::Done,
            driven_by: Parameter::Rotation,
            work_n_mm: 0.0,
            put_in_n_mm: 0.0,
            probes: vec![],
            connections: vec![],
            path_length_mm: None,
            critical_point: None,
            warnings: vec![],
            parameter: 9.6,
            attempted_parameter: 9.615,
            moment_n_mm: 289.1247,
            strain_energy_n_mm: 63.0,
            elements: [16, 8].into(),
            unknowns: 615,
            iterations: 5,
            factorizations: 5,
            negative_pivots: 0,
            residual: 1e-9,
            energy_released_n_mm: Some(0.0),
            jumped: false,
            rippled: false,
            marked: [0, 0],
            largest_indicator: [0.0, 0.0],
            estimated_error: None,
        };
        assert_eq!(live_prefix(Parameter::Rotation, report.parameter, 20.0), "9.600° of 20°");
        assert_eq!(live_message(&report), "289.12 N·mm  16×8  solve, 5 iterations");
        report.outcome = Outcome::RejectedJump;
        assert_eq!(live_message(&report), "289.12 N·mm  16×8  solve rejected at 9.615°: unstable on the way");
        report = Report { outcome: Outcome::Done, stage: Stage::RefineKnots, iterations: 0, ..report };
        assert_eq!(live_message(&report), "289.12 N·mm  16×8  refine-knots");
    }
}
