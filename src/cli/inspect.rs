//! `foldline inspect`: what a log holds.

use std::path::PathBuf;

use clap::Args;

use super::failure::{EXIT_CODES, Failure};
use super::json_line::json_line;
use super::log_file::{Stages, ask_long, read_through};
use super::output::print;
use super::stage_table::{stage_table, step_in_full};
use crate::history::stages_of_step;
use crate::journal::{LongLog, LongLogError};
use crate::pipeline::Record;
use crate::study::Summary;

/// Show the stages of a log
#[derive(Args, Debug)]
#[command(after_help = EXIT_CODES)]
pub(super) struct Arguments {
    /// Log to read (MCAP)
    log: PathBuf,
    /// Show everything about the stages of this load step
    #[arg(long, value_name = "K")]
    step: Option<u64>,
    /// Print a JSON object for each stage
    #[arg(long)]
    json: bool,
}

impl Arguments {
    /// Reads the log and shows it.
    pub(super) fn run(self) -> Result<(), Failure> {
        let Self { log, step, json } = self;
        if let Some(step) = step
            && let Some((found, known)) = ask_long(&log, |long| Ok((stages_of_step(long, step)?, steps_of(long)?)))?
        {
            return match found.is_empty() {
                true => Err(Failure::NoSuchStep { known, step, log }),
                false => show_step(&found, step, json),
            };
        }
        let (mut stages, mut lines, mut wanted, mut states) =
            (Stages::default(), String::new(), Vec::new(), Vec::new());
        let read = read_through(&log, |portion| {
            stages.take(portion);
            let records = portion.entries().iter().map(|entry| &entry.record);
            match step {
                Some(step) => wanted.extend(records.filter(|record| record.report.step == step).cloned()),
                None if json => records.for_each(|record| lines += &(json_line(record) + "\n")),
                None => {
                    let ordinals = records.map(|record| record.commit.ordinal as usize);
                    states.extend(ordinals.filter(|ordinal| portion.log().keeps_state(*ordinal)));
                }
            }
        })?;
        match step {
            Some(step) if wanted.is_empty() => return Err(Failure::NoSuchStep { known: stages.steps(), step, log }),
            Some(step) => return show_step(&wanted, step, json),
            None if json => return print(&lines),
            None => {}
        }
        let mut text = stage_table(&stages.records);
        text += &format!("\n{}", Summary::new(&read.scene, &stages.records));
        if let Some(kept) = read.log.thinned() {
            text += &format!("\nthinned ({kept}); stages with their state: {}\n", ranges(&states));
        }
        if !read.is_finished() {
            text += &format!("\nunfinished; go on with: foldline resume {}\n", log.display());
        }
        print(&text)
    }
}

/// First and last load step of a long log.
fn steps_of(long: &LongLog) -> Result<Option<(u64, u64)>, LongLogError> {
    let last = long.tail().entries().last().map(|entry| entry.record.report.step);
    Ok(Some(long.record(0)?.report.step).zip(last))
}

/// Numbers in order, those that follow on one another as ranges.
fn ranges(numbers: &[usize]) -> String {
    let runs = numbers.chunk_by(|before, after| before + 1 == *after);
    let shown = runs.map(|run| match run {
        [.., last] if run.len() > 1 => format!("{}–{last}", run[0]),
        _ => run[0].to_string(),
    });
    shown.collect::<Vec<_>>().join(", ")
}

fn show_step(records: &[Record], step: u64, json: bool) -> Result<(), Failure> {
    let lines = || records.iter().map(|record| json_line(record) + "\n").collect();
    print(&if json { lines() } else { step_in_full(records, step) })
}
