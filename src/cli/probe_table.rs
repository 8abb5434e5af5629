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

/// A row for each equilibrium, and a column for each of these probes, with its unit.
pub(super) fn probe_table(names: &[String], records: &[Record]) -> String {
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
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:>width$}"));
        cells.collect::<Vec<_>>().join("  ") + "\n"
    };
    rows.iter().map(line).collect()
}

fn reading_of<'r>(record: &'r Record, name: &str) -> Option<&'r Reading> {
    record.report.probes.iter().find(|found| found.name == name)
}

/// The equilibria as the lines of `run --json`, with the readings of all probes of the scene.
pub(super) fn json_lines(records: &[Record]) -> String {
    equilibria(records).map(|record| json_line(record) + "\n").collect()
}
