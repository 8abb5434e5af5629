//! `foldline recover`: the good part of a log as a log of its own.

use std::path::PathBuf;

use clap::Args;

use super::failure::Failure;
use super::output::{file_name, print, say};
use crate::history::mended;
use crate::journal::{Log, RecoverOutcome, recover_mended};
use crate::units::count;

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
    /// Run lost stages again where whole ones stand behind them, which then follow on them; that they are the same say the
    /// hashes of those
    #[arg(long)]
    remake: bool,
}

impl Arguments {
    /// Recovers and says what became of it.
    pub(super) fn run(self) -> Result<u8, Failure> {
        let Self { log, output, remake } = self;
        let (mut made, mut hint) = (0, "");
        let mend = |log: &Log| {
            if !remake {
                hint = "; --remake may run that again";
                return None;
            }
            let (mended, count) = mended(log, &[])?;
            made += count;
            Some(mended)
        };
        let outcome = recover_mended(&log, &output, mend)
            .map_err(|source| Failure::WrongLog { log: log.clone(), source: Box::new(source) })?;
        // Where the mended log does not read as it should, the good part of the log itself is what is kept.
        let made = if matches!(outcome, RecoverOutcome::Lossless { .. }) || !remake { made } else { 0 };
        if made > 0 {
            say(&format!(
                "{} made again that were lost: the stages behind follow on what they came to; but how long they took is not known any more",
                count(made, "stage")
            ));
        }
        let new = output.display();
        let (text, code) = match outcome {
            RecoverOutcome::Lossless { commits } => (format!("{new}: all {commits} stages\n"), 0),
            RecoverOutcome::Lossy { commits, dropped, later_commits, why } => (
                format!(
                    "{new}: the first {commits} stages; {dropped} bytes left behind, with {later_commits} stages that have lost \
                     what they follow on{hint}\n  because: {why}\n"
                ),
                LOSSY,
            ),
            RecoverOutcome::Hopeless { why } => {
                let log = log.display();
                (format!("nothing of {log} can be kept, and nothing was written{hint}\n  because: {why}\n"), 1)
            }
        };
        print(&text)?;
        Ok(code)
    }
}
