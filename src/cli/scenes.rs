//! `foldline scenes`: what comes with the program.

use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::output::{print, print_json};
use super::shipped::{SHIPPED, Shipped};
use super::terminal::prose_columns;
use super::wrapped::wrapped;

/// List the scenes that come with the program; each can be named wherever a scene file can
#[derive(Args, Debug)]
#[command(after_help = USES)]
pub(super) struct Arguments {
    /// List only those whose names contain this
    filter: Option<String>,
    /// Print a JSON object for each, with its text
    #[arg(long)]
    json: bool,
}

/// Below the options in `--help`.
const USES: &str = "\
  foldline run baseline              run one; a file of that name is taken first
  foldline new baseline -o own.toml  write its text, to be changed
  foldline extremes                  run all of extreme/, and see that each ends as it states
  foldline study studies/length      run a study, of which there are three
  foldline sweep run sweeps/roof-snap  run a sweep over designs, of which there are four";

/// What a program reads of one.
#[derive(Serialize)]
struct Line {
    name: &'static str,
    shows: String,
    text: &'static str,
}

impl Arguments {
    /// Lists them, those of a folder together.
    pub(super) fn run(self) -> Result<(), Failure> {
        let is_chosen = |shipped: &&Shipped| self.filter.as_ref().is_none_or(|part| shipped.name.contains(&part[..]));
        let chosen: Vec<&Shipped> = SHIPPED.iter().filter(is_chosen).collect();
        if let (Some(filter), true) = (&self.filter, chosen.is_empty()) {
            return Err(Failure::NoShippedScene { filter: filter.clone() });
        }
        if self.json {
            return chosen.iter().try_for_each(|Shipped { name, text }| {
                let shows = Shipped { name, text }.summary();
                print_json(&Line { name, shows, text })
            });
        }
        let groups = chosen.chunk_by(|one, other| folder(one.name) == folder(other.name));
        print(&groups.map(block).collect::<Vec<_>>().join("\n"))
    }
}

fn folder(name: &str) -> Option<&str> {
    name.rsplit_once('/').map(|(folder, _)| folder)
}

/// Each of one folder with what it shows: beside its name, or below it where the names leave less than half the columns.
fn block(group: &[&Shipped]) -> String {
    let widest = group.iter().map(|shipped| shipped.name.chars().count()).max().unwrap_or(0);
    let is_beside = 2 * (widest + 2) <= prose_columns();
    let line = |shipped: &&Shipped| match is_beside {
        true => wrapped(&format!("{:<widest$}  ", shipped.name), &shipped.summary()) + "\n",
        false => format!("{}\n{}\n", shipped.name, wrapped("    ", &shipped.summary())),
    };
    group.iter().map(line).collect()
}
