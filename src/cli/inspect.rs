//! `foldline inspect`: what a log holds.

use std::path::PathBuf;

use clap::Args;

use super::failure::{EXIT_CODES, Failure};
use super::json_line::json_line;
use super::log_file::read_log;
use super::output::print;
use super::stage_table::{stage_table, step_in_full};
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
        let read = read_log(&log)?;
        let records = read.records();
        let wanted: Vec<Record> =
            records.iter().filter(|record| step.is_none_or(|step| record.report.step == step)).cloned().collect();
        if let (Some(step), true) = (step, wanted.is_empty()) {
            return Err(Failure::NoSuchStep { known: read.steps(), step, log });
        }
        if json {
            return print(&wanted.iter().map(|record| json_line(record) + "\n").collect::<String>());
        }
        if let Some(step) = step {
            return print(&step_in_full(&wanted, step));
        }
        let mut text = format!("{}\n{}", stage_table(&records), Summary::new(&read.scene, &records));
        if !read.is_finished() {
            text.push_str(&format!("\nunfinished; go on with: foldline resume {}\n", log.display()));
        }
        print(&text)
    }
}
