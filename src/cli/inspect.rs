//! `foldline inspect`: what a log holds.

use std::ops::Range;
use std::path::{Path, PathBuf};

use clap::Args;

use super::asked::Asked;
use super::failure::{EXIT_CODES, Failure};
use super::json_line::json_line;
use super::log_file::{Gathered, ReadLog, ask_long, first_and_last, read_log, read_through};
use super::mesh_table::mesh_table;
use super::output::{path_in_command, print, print_as_it_is};
use super::probe_table::probe_table;
use super::stage_csv::stage_csv;
use super::stage_table::{stage_table, step_in_full};
use super::terminal::output_columns;
use crate::history::{redefined_probes, remove_redefined, stages_of_step};
use crate::journal::{Log, LongLog, LongLogError};
use crate::record::Record;
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
    /// Print the stages as comma-separated values, a line each, with the names of --json
    #[arg(long, conflicts_with_all = ["json", "mesh"])]
    csv: bool,
    /// Show the meshes of the run, and the knots that came and went from one to the next
    #[arg(long, conflicts_with_all = ["json", "step", "probes"])]
    mesh: bool,
    /// Read the probes of the last scene again on every equilibrium: also on those that were run without them
    #[arg(long)]
    probes: bool,
}

impl Arguments {
    /// Reads the log and shows it.
    pub(super) fn run(self) -> Result<(), Failure> {
        let Self { log, step, json, csv, mesh, probes } = self;
        if json || csv {
            let stages = match step {
                Some(step) => stages_of(&log, step, probes)?,
                None if json && !probes => return print_lines_of_all(&log),
                None => every_record(&log, probes)?,
            };
            return print_as_it_is(&if json { lines(&stages) } else { stage_csv(&stages) });
        }
        print(&match step {
            Some(step) => step_in_full(&stages_of(&log, step, probes)?, step),
            None if mesh => mesh_table(&Asked::open(&log)?)?,
            None => overview(&log, probes)?,
        })
    }
}

/// The stages of a load step.
fn stages_of(path: &Path, step: u64, probes: bool) -> Result<Vec<Record>, Failure> {
    let of_step = |record: &&Record| record.report.step == step;
    let in_long = match probes {
        true => None,
        false => ask_long(path, |long| Ok((stages_of_step(long, step)?, steps_of(long)?)))?,
    };
    let (found, known) = match in_long {
        Some(found) => found,
        None if probes => {
            let (_, records) = with_probes_read_again(path)?;
            (records.iter().filter(of_step).cloned().collect(), first_and_last(records.iter()))
        }
        None => {
            let mut found = Vec::new();
            let mut known: Option<(u64, u64)> = None;
            read_through(path, |portion| {
                let records = || portion.entries().iter().map(|entry| &entry.record);
                found.extend(records().filter(of_step).cloned());
                if let Some((first, last)) = first_and_last(records()) {
                    known = Some((known.map_or(first, |(first, _)| first), last));
                }
            })?;
            (found, known)
        }
    };
    if found.is_empty() { Err(Failure::NoSuchStep { known, step, log: path.to_path_buf() }) } else { Ok(found) }
}

/// Every stage as JSON, portion by portion.
fn print_lines_of_all(path: &Path) -> Result<(), Failure> {
    let mut printed = Ok(());
    read_through(path, |portion| {
        if printed.is_ok() {
            let lines = portion.entries().iter().map(|entry| json_line(&entry.record) + "\n");
            printed = print_as_it_is(&lines.collect::<String>());
        }
    })?;
    printed
}

/// Every stage, with all of its probes.
fn every_record(path: &Path, probes: bool) -> Result<Vec<Record>, Failure> {
    match probes {
        true => Ok(with_probes_read_again(path)?.1),
        false => Asked::open(path)?.records(),
    }
}

fn lines(records: &[Record]) -> String {
    records.iter().map(|record| json_line(record) + "\n").collect()
}

/// The log with all of its stages, and the ordinals of those that have their states.
fn all_stages(path: &Path, probes: bool) -> Result<(ReadLog, Vec<Record>, Vec<usize>), Failure> {
    let mut states = Vec::new();
    let mut keep_states = |log: &Log, ordinals: Range<usize>| {
        states.extend(ordinals.filter(|ordinal| log.keeps_state(*ordinal)));
    };
    if probes {
        let (read, records) = with_probes_read_again(path)?;
        keep_states(&read.log, 0..records.len());
        return Ok((read, records, states));
    }
    let mut gathered = Gathered::default();
    let read = read_through(path, |portion| {
        let from = gathered.records.len();
        gathered.take(portion);
        keep_states(portion.log(), from..gathered.records.len());
    })?;
    remove_redefined(&redefined_probes(&read.log), &mut gathered.records);
    Ok((read, gathered.records, states))
}

/// Every stage as a table, with what they come to.
fn overview(path: &Path, probes: bool) -> Result<String, Failure> {
    let (read, records, states) = all_stages(path, probes)?;
    let older = read.older_scene().map_or_else(String::new, |line| line + "\n");
    let summary = Summary::new(&read.scene, &records);
    let mut text = format!("{}\n{}{older}{summary}", stage_table(&records, output_columns()), read.mixed());
    let names: Vec<String> = read.scene.probes.iter().map(|probe| probe.name.clone()).collect();
    if probes && !names.is_empty() {
        text += &format!(
            "\nprobes of the last scene on every equilibrium\n{}",
            probe_table(&names, &records, output_columns())
        );
    } else if !probes && !redefined_probes(&read.log).is_empty() {
        text +=
            &format!("\nthe last probes on every equilibrium: foldline inspect {} --probes\n", path_in_command(path));
    }
    if let Some(kept) = read.log.thinned() {
        text += &format!("\nthinned ({kept}); stages with their state: {}\n", ranges(&states));
    }
    if !read.is_finished() {
        text += &format!("\nunfinished; continue with: foldline resume {}\n", path_in_command(path));
    }
    Ok(text)
}

/// Every stage with the probes of the last scene, read on the states, which takes the whole log.
fn with_probes_read_again(path: &Path) -> Result<(ReadLog, Vec<Record>), Failure> {
    let read = read_log(path)?;
    let records = read.records_of_scene(path)?;
    Ok((read, records))
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
