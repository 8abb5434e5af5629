//! `foldline scenes`: what comes with the program.

use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::output::{print, print_json};
use super::shipped::{SHIPPED, Shipped};
use super::terminal::prose_columns;

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

/// A line for each of one folder.
fn block(group: &[&Shipped]) -> String {
    let widest = group.iter().map(|shipped| shipped.name.chars().count()).max().unwrap_or(0);
    let line = |shipped: &&Shipped| {
        format!(
            "{:<widest$}  {}\n",
            shipped.name,
            shortened(&shipped.summary(), prose_columns().saturating_sub(widest + 2))
        )
    };
    group.iter().map(line).collect()
}

/// A text where it is short enough; or else the longest beginning of it that ends with a clause, or at least with a word.
fn shortened(text: &str, most: usize) -> String {
    let fits = |part: &&str| part.chars().count() <= most;
    let before = |mark: &'static str| text.match_indices(mark).map(|(at, _)| &text[..at]).filter(fits).last();
    if fits(&text) {
        return text.to_owned();
    }
    let clause = [": ", "; ", " (", ", "].into_iter().filter_map(before).max_by_key(|part| part.len());
    clause.map(str::to_owned).or_else(|| Some(format!("{}…", before(" ")?))).unwrap_or_default()
}
