//! `foldline inspect`: what a log holds.

use std::path::PathBuf;

use clap::Args;

use super::failure::{EXIT_CODES, Failure};
use super::json_line::json_line;
use super::log_file::{Gathered, ask_long, read_log, read_through};
use super::output::print;
use super::stage_table::{stage_table, step_in_full};
use crate::history::{keep_apart, redefined_probes, stages_of_step};
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
    /// Read the probes of the last scene anew on every equilibrium: also on those that were run without them
    #[arg(long)]
    probes: bool,
}

impl Arguments {
    /// Reads the log and shows it.
    pub(super) fn run(self) -> Result<(), Failure> {
        let Self { log, step, json, probes } = self;
        if let Some(step) = step.filter(|_| !probes)
            && let Some((found, known)) = ask_long(&log, |long| Ok((stages_of_step(long, step)?, steps_of(long)?)))?
        {
            return match found.is_empty() {
                true => Err(Failure::NoSuchStep { known, step, log }),
                false => show_step(&found, step, json),
            };
        }
        let wanted_step = |record: &Record| step.is_none_or(|step| record.report.step == step);
        let (mut gathered, mut lines, mut wanted, mut states) =
            (Gathered::default(), String::new(), Vec::new(), Vec::new());
        let read = match probes {
            true => {
                // Probes are read on states, which takes the whole log.
                let read = read_log(&log)?;
                gathered.records = read.records_of_scene(&log, true)?;
                states = (0..gathered.records.len()).filter(|ordinal| read.log.keeps_state(*ordinal)).collect();
                wanted = gathered.records.iter().filter(|record| wanted_step(record)).cloned().collect();
                lines = wanted.iter().map(|record| json_line(record) + "\n").collect();
                read
            }
            false => read_through(&log, |portion| {
                gathered.take(portion);
                let records = portion.entries().iter().map(|entry| &entry.record);
                match step {
                    Some(_) => wanted.extend(records.filter(|record| wanted_step(record)).cloned()),
                    None if json => records.for_each(|record| lines += &(json_line(record) + "\n")),
                    None => {
                        let ordinals = records.map(|record| record.commit.ordinal as usize);
                        states.extend(ordinals.filter(|ordinal| portion.log().keeps_state(*ordinal)));
                    }
                }
            })?,
        };
        match step {
            Some(step) if wanted.is_empty() => return Err(Failure::NoSuchStep { known: gathered.steps(), step, log }),
            Some(step) => return show_step(&wanted, step, json),
            None if json => return print(&lines),
            None => {}
        }
        let mut records = gathered.records;
        if !probes {
            keep_apart(&redefined_probes(&read.log), &mut records);
        }
        let older = read.older_scene().map_or_else(String::new, |line| line + "\n");
        let summary = Summary::new(&read.scene, &records);
        let mut text = format!("{}\n{}{older}{summary}", stage_table(&records), read.mixed());
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
