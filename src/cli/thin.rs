//! `foldline thin`: a log without the states between some load steps.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::Args;

use super::failure::Failure;
use super::output::{eprint, file_name, path_in_command, path_in_line, print};
use crate::journal::{ThinError, Thinned, thin};
use crate::units::count;

/// Write a smaller log that holds every stage and every report, but the states of some load steps alone
///
/// The chain of hashes stays as it is. A state that is not kept is made again, where it is needed, from the last kept one
/// before it; `resume` goes from the last one, which is always kept.
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// Log to read (MCAP)
    log: PathBuf,
    /// Log to write; never over another file
    #[arg(short, long, value_name = "NEW", value_parser = file_name())]
    output: PathBuf,
    /// Load steps whose last state is kept: every=10 for every tenth, 7 for one, 20..30 for those from 20 to 30; several with
    /// commas between
    #[arg(long, value_name = "STEPS")]
    keep: Steps,
}

impl Arguments {
    /// Thins the log and reports the result.
    pub(super) fn run(self) -> Result<(), Failure> {
        let Self { log, output, keep } = self;
        let thinned = thin(&log, &output, &keep.text, |step| keep.has(step)).map_err(|source| match source {
            ThinError::Read(crate::journal::ReadError::Io { source, .. }) => {
                Failure::Read { path: log.clone(), source }
            }
            source => Failure::WrongLog { log: log.clone(), source: Box::new(source) },
        })?;
        for (text, choice) in &keep.choices {
            not_kept(text, *choice, &thinned, &log).iter().for_each(|line| eprint(line));
        }
        let [before, after] = thinned.bytes.map(|bytes| bytes as f64 / 1e6);
        print(&format!(
            "{}: all {} stages, {} of them with their states; {after:.2} MB of {before:.2} MB\n",
            path_in_line(&output),
            thinned.commits,
            thinned.states
        ))
    }
}

/// The warning about load steps whose state was to be kept and is not in the log, or no longer.
fn not_kept(text: &str, choice: Choice, thinned: &Thinned, log: &Path) -> Option<String> {
    let (all, kept) = (&thinned.all_steps, &thinned.steps);
    let missed = all.difference(kept).filter(|step| choice.has(**step));
    match missed.clone().next() {
        Some(first) => Some(format!(
            "--keep {text}: the log was thinned before, and no longer has the state of {}, the first of them {first}. Such a state is \
             made again where it is needed, as by `foldline stability {} --step {first}`; to keep it, thin the log that this one was \
             made of",
            count(missed.count(), "load step"),
            path_in_command(log)
        )),
        None if kept.iter().any(|step| choice.has(*step)) => None,
        None => {
            let (first, last) = (all.first().unwrap_or(&0), all.last().unwrap_or(&0));
            Some(format!("--keep {text} keeps nothing: the load steps of the log go from {first} to {last}"))
        }
    }
}

/// Some load steps.
#[derive(Clone, Debug, PartialEq)]
struct Steps {
    text: String,
    /// Each as it was written.
    choices: Vec<(String, Choice)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Choice {
    Every(u64),
    FromTo(u64, u64),
}

impl Steps {
    fn has(&self, step: u64) -> bool {
        self.choices.iter().any(|(_, choice)| choice.has(step))
    }
}

impl Choice {
    fn has(self, step: u64) -> bool {
        match self {
            Choice::Every(each) => step.is_multiple_of(each),
            Choice::FromTo(from, to) => (from..=to).contains(&step),
        }
    }
}

impl FromStr for Steps {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.parse::<u64>().map_err(|_| format!("`{text}` is not the number of a load step"));
        let choice = |text: &str| match (text.split_once("every="), text.split_once("..")) {
            (Some(("", each)), _) => match number(each)? {
                0 => Err("every=0 keeps nothing: every=1 keeps the end of each step".to_owned()),
                each => Ok(Choice::Every(each)),
            },
            (_, Some((from, to))) => match (number(from)?, number(to)?) {
                (from, to) if from <= to => Ok(Choice::FromTo(from, to)),
                (from, to) => Err(format!("{from}..{to} has no load step in it: the smaller one comes first")),
            },
            _ => number(text).map(|step| Choice::FromTo(step, step)),
        };
        let parts = text.split(',').map(str::trim);
        let choices = parts.map(|part| Ok((part.to_owned(), choice(part)?))).collect::<Result<_, String>>()?;
        Ok(Self { text: text.to_owned(), choices })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_chosen_by_number_range_and_multiple() {
        let steps: Steps = "every=10, 3,5..7".parse().unwrap();
        let kept: Vec<u64> = (1..=20).filter(|step| steps.has(*step)).collect();
        assert_eq!(kept, [3, 5, 6, 7, 10, 20]);
        for wrong in ["", "every=0", "every=", "7..5", "-1", "one", "every=2;3"] {
            assert!(wrong.parse::<Steps>().is_err(), "{wrong}");
        }
    }
}
