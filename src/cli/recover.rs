//! `foldline recover`: the good part of a log as a log of its own.

use std::path::PathBuf;

use clap::Args;

use super::failure::Failure;
use super::output::{file_name, print};
use crate::journal::{RecoverOutcome, recover};

/// Exit code of a recovery that had to leave something behind.
const LOSSY: u8 = 3;

/// Write the good part of a damaged log to a new one; exit code 0 if nothing is lost, 3 if something is, 1 if all is
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// Log to read (MCAP)
    log: PathBuf,
    /// Log to write
    #[arg(short, long, value_name = "NEW", value_parser = file_name)]
    output: PathBuf,
}

impl Arguments {
    /// Recovers and says what became of it.
    pub(super) fn run(self) -> Result<u8, Failure> {
        let Self { log, output } = self;
        let outcome = recover(&log, &output)
            .map_err(|source| Failure::WrongLog { log: log.clone(), source: Box::new(source) })?;
        let new = output.display();
        let (text, code) = match outcome {
            RecoverOutcome::Lossless { commits } => (format!("{new}: all {commits} stages\n"), 0),
            RecoverOutcome::Lossy { commits, dropped, later_commits, why } => (
                format!(
                    "{new}: the first {commits} stages; {dropped} bytes left behind, with {later_commits} stages that have lost \
                     what they follow on\n  because: {why}\n"
                ),
                LOSSY,
            ),
            RecoverOutcome::Hopeless { why } => {
                (format!("nothing of {} can be kept, and nothing was written\n  because: {why}\n", log.display()), 1)
            }
        };
        print(&text)?;
        Ok(code)
    }
}
