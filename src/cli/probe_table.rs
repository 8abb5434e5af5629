//! What probes measure on the equilibria of a log, be they in it or read again.

use super::json_line::json_line;
use crate::record::{Parameter, Reading, Record};
use crate::scene::Scene;
use crate::study::equilibria;
use crate::units::reading;

/// Names of the probes that are new or measure something else.
pub(super) fn new_probes(was: &Scene, is: &Scene) -> Vec<String> {
    is.probes.iter().filter(|probe| !was.probes.contains(probe)).map(|probe| probe.name.clone()).collect()
}

/// A row for each equilibrium, and a column for each of these probes, with its unit; in blocks below one another where a
/// terminal has too few `columns`.
pub(super) fn probe_table(names: &[String], records: &[Record], columns: Option<usize>) -> String {
    let driven_by = equilibria(records).next().map(|record| record.report.driven_by);
    let at = if driven_by == Some(Parameter::LoadFactor) { "factor" } else { "θ °" };
    let mut rows = vec![vec!["step".to_owned(), at.to_owned()]];
    rows[0].extend(names.iter().map(|name| {
        let unit = equilibria(records).find_map(|record| reading_of(record, name)).map_or("", |found| &found.unit);
        format!("{name} {unit}")
    }));
    rows.extend(equilibria(records).map(|record| {
        let cell = |name: &String| reading_of(record, name).map_or(String::new(), |found| reading(found.value, 6));
        let place = [record.report.step.to_string(), format!("{:.3}", record.report.parameter)];
        place.into_iter().chain(names.iter().map(cell)).collect()
    }));
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..rows[0].len()).map(width).collect();
    let line = |row: &Vec<String>, chosen: &[usize]| {
        let cells = [0, 1].iter().chain(chosen).map(|&column| format!("{:>1$}", row[column], widths[column]));
        cells.collect::<Vec<_>>().join("  ") + "\n"
    };
    let blocks = blocks(&widths, columns);
    let block = |chosen: &Vec<usize>| rows.iter().map(|row| line(row, chosen)).collect::<String>();
    blocks.iter().map(block).collect::<Vec<_>>().join("\n")
}

/// The columns behind the first two in as many blocks as it takes for each to fit beside those.
fn blocks(widths: &[usize], columns: Option<usize>) -> Vec<Vec<usize>> {
    let room = columns.map_or(usize::MAX, |columns| columns.saturating_sub(widths[0] + 2 + widths[1]));
    let mut blocks: Vec<Vec<usize>> = Vec::new();
    let mut taken = 0;
    for column in 2..widths.len() {
        taken += 2 + widths[column];
        match blocks.last_mut().filter(|_| taken <= room) {
            Some(block) => block.push(column),
            None => {
                taken = 2 + widths[column];
                blocks.push(vec![column]);
            }
        }
    }
    blocks
}

fn reading_of<'r>(record: &'r Record, name: &str) -> Option<&'r Reading> {
    record.report.probes.iter().find(|found| found.name == name)
}

/// The equilibria as the lines of `run --json`, with the readings of all probes of the scene.
pub(super) fn json_lines(records: &[Record]) -> String {
    equilibria(records).map(|record| json_line(record) + "\n").collect()
}
