//! `foldline replay`: runs stages of a log again and holds the outcome against the log.

use std::path::PathBuf;

use clap::Args;

use super::asked::Asked;
use super::failure::Failure;
use super::log_file::{say_other_numerics, scene_at};
use super::output::{file_name, print, refuse_what_is_there};
use super::scene_file::stage_named;
use super::session::use_threads;
use super::trace;
use crate::equilibrium::Iterate;
use crate::history::{Comparison, ReplayError, Replayed, States, Verdict, replay_stage, verdict};
use crate::journal::TraceRow;
use crate::pipeline::Stages;
use crate::record::Commit;
use crate::scene::{Scene, Stage};
use crate::spline::Mesh;
use crate::units::count;

/// Run stages of a log again, from the state before each, and compare every bit
#[derive(Args, Debug)]
#[command(after_help = REPLAY_CODES)]
pub(super) struct Arguments {
    /// Log to read (MCAP)
    log: PathBuf,
    /// Load step
    #[arg(long, value_name = "K", required_unless_present = "from_scratch")]
    step: Option<u64>,
    /// One stage of the step, such as solve or re-equilibrate [default: all of them]
    #[arg(long, value_name = "S", value_parser = stage_named, requires = "step")]
    stage: Option<Stage>,
    /// Every stage of the log
    #[arg(long, conflicts_with = "step")]
    from_scratch: bool,
    /// Lay a setting over the scene, such as solver.max_iterations=200; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Write every Newton iterate to FILE.mcap and FILE.csv, neither of which may be there
    #[arg(long, value_name = "FILE", value_parser = file_name())]
    trace: Option<PathBuf>,
    /// Threads; the result is the same on any number of them [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

const REPLAY_CODES: &str = "\
Exit codes:
  0  every bit is the same
  1  failed: a stage could not be run again for another reason than its own
  2  wrong arguments, or no such stage
  3  the same within tolerance
  4  different";

impl Arguments {
    /// Replays; the worst verdict is the exit code.
    pub(super) fn run(self) -> Result<u8, Failure> {
        use_threads(self.threads.map(usize::from))?;
        if let Some(file) = &self.trace {
            refuse_what_is_there(&trace::files(file))?;
        }
        let asked = Asked::open(&self.log)?;
        say_other_numerics(asked.log.end());
        let mut rows: Vec<TraceRow> = Vec::new();
        let worst = self.replay_chosen(&asked, &mut rows);
        // What led to a stage that cannot be run again is what the trace is for.
        if worst.is_ok() || !rows.is_empty() {
            self.write_trace(&rows)?;
        }
        worst
    }

    fn replay_chosen(&self, asked: &Asked, rows: &mut Vec<TraceRow>) -> Result<u8, Failure> {
        let chosen = self.chosen(asked)?;
        let mut stages = None;
        let mut worst = 0;
        for part in asked.log.parts(&chosen) {
            let (log, indices) = part.map_err(asked.changed())?;
            let mut states = States::of(&log);
            for index in indices {
                worst = worst.max(self.replay(&mut states, *index, &mut stages, rows)?);
            }
        }
        Ok(worst)
    }

    /// Replays a stage, reports the result, and returns the exit code.
    fn replay(
        &self,
        states: &mut States,
        index: usize,
        stages: &mut Option<Stages>,
        rows: &mut Vec<TraceRow>,
    ) -> Result<u8, Failure> {
        // Each stretch of a log with the scene that it was run with.
        let scene = scene_at(states.log(), &self.log, index, &self.set)?;
        self.check_settings(&scene_at(states.log(), &self.log, index, &[])?, &scene)?;
        let stages = match stages.take().filter(|stages| *stages.scene() == scene) {
            Some(same) => stages.insert(same),
            None => stages.insert(Stages::new(scene)),
        };
        let Some(commit) = states.log().entry(index).map(|entry| entry.record.commit) else { return Ok(0) };
        let mut observer = |mesh: &Mesh, iterate: &Iterate| {
            if self.trace.is_some() {
                rows.push(trace::row(&commit, mesh, iterate));
            }
        };
        let (ordinal, stage, step) = (commit.ordinal, commit.stage, commit.step);
        match replay_stage(states, index, stages, &mut observer) {
            Ok(replayed) => {
                let verdict = verdict(&replayed.comparison);
                print(&line(&verdict, &replayed, ordinal))?;
                Ok(code(&verdict))
            }
            // It did not fail when the log was written.
            Err(ReplayError::Stage(error)) => {
                print(&format!("{ordinal:>5}  step {step} {stage}: different: it fails now: {error}\n"))?;
                Ok(code(&Verdict::Different(String::new())))
            }
            Err(source) => Err(Failure::Replay { ordinal, stage, step, source: Box::new(source) }),
        }
    }

    /// Settings of what a state already holds would be ignored in silence.
    fn check_settings(&self, logged: &Scene, set: &Scene) -> Result<(), Failure> {
        let fixed = |path: &str| {
            ["geometry.", "mesh.degree", "mesh.elements", "symmetry."].iter().any(|it| path.starts_with(it))
        };
        match logged.differences(set).into_iter().find(|difference| fixed(&difference.path)) {
            Some(difference) => Err(Failure::NoEffect { path: difference.path.to_string() }),
            None => Ok(()),
        }
    }

    fn write_trace(&self, rows: &[TraceRow]) -> Result<(), Failure> {
        match &self.trace {
            Some(file) => print(&trace::write(file, rows)?),
            None => Ok(()),
        }
    }

    /// Indices of the stages to run again.
    fn chosen(&self, asked: &Asked) -> Result<Vec<usize>, Failure> {
        let Some(step) = self.step else { return Ok((0..asked.log.commits()).collect()) };
        let of_step: Vec<Commit> = asked.stages_of_step(step)?.iter().map(|record| record.commit).collect();
        let is_asked_for = |commit: &&Commit| self.stage.is_none_or(|stage| commit.stage == stage);
        let chosen: Vec<usize> = of_step.iter().filter(is_asked_for).map(|commit| commit.ordinal as usize).collect();
        match self.stage {
            Some(stage) if chosen.is_empty() => {
                let mut known: Vec<String> = of_step.iter().map(|commit| commit.stage.name().to_string()).collect();
                known.dedup();
                Err(Failure::NoSuchStage { log: self.log.clone(), step, stage, known })
            }
            _ => Ok(chosen),
        }
    }
}

fn code(verdict: &Verdict) -> u8 {
    match verdict {
        Verdict::BitIdentical => 0,
        Verdict::WithinTolerance(_) => 3,
        Verdict::Different(_) => 4,
    }
}

fn line(verdict: &Verdict, replayed: &Replayed, ordinal: u64) -> String {
    let report = &replayed.report;
    let what = match verdict {
        Verdict::BitIdentical => "bit-identical".to_string(),
        Verdict::WithinTolerance(worst) => format!(
            "within tolerance: {} agrees to {}{}{}",
            worst.field,
            bits(worst.agreeing_bits),
            place(worst.place),
            further(&replayed.comparison)
        ),
        Verdict::Different(what) => format!("different: {what}"),
    };
    let iterations = match report.iterations {
        0 => String::new(),
        iterations => format!(", {}", count(iterations, "iteration")),
    };
    format!("{ordinal:>5}  step {} {}{iterations}: {what}\n", report.step, report.stage)
}

/// The fields that differ less than the worst one.
fn further(comparison: &Comparison) -> String {
    let Comparison::Numbers(differences) = comparison else { return String::new() };
    let further: Vec<String> =
        differences.iter().skip(1).map(|it| format!("{} to {}", it.field, bits(it.agreeing_bits))).collect();
    if further.is_empty() { String::new() } else { format!("; {}", further.join(", ")) }
}

fn bits(agreeing: f64) -> String {
    if agreeing.is_finite() { format!("{agreeing:.1} bits") } else { "all bits but the sign of zero".to_string() }
}

/// Where on the surface.
pub(super) fn place(place: Option<([usize; 2], [f64; 3])>) -> String {
    place.map_or_else(String::new, |([i, j], [x, y, z])| {
        format!(" at control point ({i}, {j}), undeformed at ({x:.2}, {y:.2}, {z:.2}) mm")
    })
}
