//! `foldline verify`: everything that can be checked about a log.

use std::path::PathBuf;

use clap::Args;

use super::failure::Failure;
use super::output::{path_in_line, print};
use crate::journal::{Level, verify};

/// Check every hash, the chain, the order and the completeness of a log; exit code 1 if anything is wrong
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// Log to check (MCAP)
    log: PathBuf,
}

impl Arguments {
    /// Lists all findings, and reports whether the log is good.
    pub(super) fn run(self) -> Result<u8, Failure> {
        let unreadable = |source| Failure::Read { path: self.log.clone(), source };
        std::fs::metadata(&self.log).map_err(unreadable)?;
        let findings = verify(&self.log);
        let lines = findings.iter().map(|finding| {
            let level = match finding.level {
                Level::Info => "info",
                Level::Warning => "warning",
                Level::Error => "error",
            };
            format!("{level:<8} {}: {}\n", finding.place, finding.text)
        });
        let wrong = findings.iter().filter(|finding| finding.level > Level::Info).count();
        let verdict = match wrong {
            0 => "good".to_owned(),
            1 => "1 thing is wrong".to_owned(),
            _ => format!("{wrong} things are wrong"),
        };
        print(&(lines.collect::<String>() + &format!("{}: {verdict}\n", path_in_line(&self.log))))?;
        Ok(u8::from(wrong > 0))
    }
}
