//! `foldline recover`: the good part of a log as a log of its own.

use std::path::PathBuf;

use clap::Args;

use super::failure::Failure;
use super::output::{eprint, file_name, path_in_line, print};
use crate::history::mended;
use crate::journal::{Log, RecoverOutcome, recover, recover_mended};
use crate::units::count;

/// Exit code of a recovery that had to leave something behind.
const LOSSY: u8 = 3;

/// Write the good part of a damaged log to a new one; exit code 0 if nothing is lost, 3 if something is, 1 if all is
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// Log to read (MCAP)
    log: PathBuf,
    /// Log to write
    #[arg(short, long, value_name = "NEW", value_parser = file_name())]
    output: PathBuf,
    /// Run lost stages again where whole ones follow behind them; that they are the same is shown by the
    /// hashes of those
    #[arg(long)]
    remake: bool,
}

impl Arguments {
    /// Recovers the log and reports the result.
    pub(super) fn run(self) -> Result<u8, Failure> {
        let Self { log, output, remake } = self;
        let mut made = 0;
        let mend = |log: &Log| {
            let (mended, count) = mended(log, &[])?;
            made += count;
            Some(mended)
        };
        let outcome = if remake { recover_mended(&log, &output, mend) } else { recover(&log, &output) };
        let outcome = outcome.map_err(|source| Failure::WrongLog { log: log.clone(), source: Box::new(source) })?;
        // Where the mended log does not read as it should, the good part of the log itself is what is kept.
        if made > 0 && matches!(outcome, RecoverOutcome::Lossless { .. }) {
            eprint(&format!(
                "made again what was lost, {}: the stages behind follow on it; but how long it took is no longer known",
                count(made, "stage")
            ));
        }
        let stages = |number: u64| count(number as usize, "stage");
        let behind = |later: u64| match later {
            0 => String::new(),
            _ if remake => format!(", with {} behind what is lost", stages(later)),
            _ => format!(", with {} behind what is lost; --remake may run that again", stages(later)),
        };
        let new = path_in_line(&output);
        let (text, code) = match outcome {
            RecoverOutcome::Lossless { commits } => (format!("{new}: all {}\n", stages(commits)), 0),
            // Every stage is there, and something else is not.
            RecoverOutcome::Lossy { commits, dropped: 0, why, .. } => {
                (format!("{new}: all {}\n  but: {why}\n", stages(commits)), LOSSY)
            }
            RecoverOutcome::Lossy { commits, dropped, later_commits, why } => (
                format!(
                    "{new}: the first {}; {dropped} bytes left behind{}\n  because: {why}\n",
                    stages(commits),
                    behind(later_commits)
                ),
                LOSSY,
            ),
            RecoverOutcome::Hopeless { why, later_commits } => {
                let (log, behind) = (path_in_line(&log), behind(later_commits));
                (format!("nothing of {log} can be kept, and nothing was written{behind}\n  because: {why}\n"), 1)
            }
        };
        print(&text)?;
        Ok(code)
    }
}
