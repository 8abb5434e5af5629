//! The stages of a log as comma-separated values, for spreadsheets and data frames.

use serde_json::Value;

use super::json_line::json_line;
use crate::record::Record;

/// The columns before those of the probes: where each stands in the JSON of a stage, `.0` along the length and `.1` along the arc.
const COLUMNS: [&str; 36] = [
    "ordinal",
    "step",
    "stage",
    "outcome",
    "rotation_deg",
    "attempted_rotation_deg",
    "moment_n_mm",
    "load_factor",
    "attempted_load_factor",
    "strain_energy_n_mm",
    "work_n_mm",
    "put_in_n_mm",
    "elements.0",
    "elements.1",
    "unknowns",
    "iterations",
    "factorizations",
    "negative_pivots",
    "residual",
    "energy_released_n_mm",
    "jumped",
    "rippled",
    "marked.0",
    "marked.1",
    "largest_indicator.0",
    "largest_indicator.1",
    "estimated_error.0",
    "estimated_error.1",
    "path_length_mm",
    "critical_point.limit_point",
    "critical_point.pivots_changed",
    "warnings",
    "wall_s",
    "state_hash",
    "parent_hash",
    "chain_hash",
];

/// A line of names and a line for each stage; a column `probes.NAME` for each probe, and what is not there is blank.
pub fn stage_csv(records: &[Record]) -> String {
    let mut probes: Vec<&str> = Vec::new();
    for reading in records.iter().flat_map(|record| &record.report.probes) {
        if !probes.contains(&&*reading.name) {
            probes.push(&reading.name);
        }
    }
    let names = COLUMNS.map(str::to_owned).into_iter().chain(probes.iter().map(|name| format!("probes.{name}")));
    let mut csv = line(names);
    for record in records {
        let stage: Value = serde_json::from_str(&json_line(record)).unwrap_or_default();
        let cells = COLUMNS.iter().map(|column| cell(stage.pointer(&format!("/{}", column.replace('.', "/")))));
        let readings = probes.iter().map(|name| {
            let found = record.report.probes.iter().find(|reading| reading.name == *name);
            cell(found.map(|reading| reading.value.into()).as_ref())
        });
        csv += &line(cells.chain(readings));
    }
    csv
}

/// A value as JSON has it, without quotes; of warnings their kinds.
fn cell(value: Option<&Value>) -> String {
    match value {
        None | Some(Value::Null) => String::new(),
        Some(Value::String(text)) => text.clone(),
        Some(Value::Array(warnings)) => {
            let kinds: Vec<&str> = warnings.iter().filter_map(|warning| warning["kind"].as_str()).collect();
            kinds.join(" ")
        }
        Some(value) => value.to_string(),
    }
}

/// Cells with commas between; those that hold one or a quote are quoted (RFC 4180).
fn line(cells: impl Iterator<Item = String>) -> String {
    let quoted = cells.map(|cell| match cell.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", cell.replace('"', "\"\"")),
        false => cell,
    });
    quoted.collect::<Vec<_>>().join(",") + "\n"
}
