//! A stage as one line of JSON, the same from `run --json` and `inspect --json`.

use serde::Serialize;

use crate::record::{Record, Report};

/// The fields of a line, in their order: the place in the run, the report, what it took, the hashes.
#[derive(Serialize)]
struct Line<'a> {
    ordinal: u64,
    #[serde(flatten)]
    report: &'a Report,
    wall_s: f64,
    state_hash: String,
    parent_hash: String,
    chain_hash: String,
}

/// Formats a finished stage as one JSON object without a line break: all fields of [`Report`] with `ordinal`, `wall_s`,
/// and the hashes of the state, of the state before it and of the chain so far, as 64 hexadecimal digits. Numbers that
/// are not finite are `null`.
pub fn json_line(record: &Record) -> String {
    let commit = &record.commit;
    let line = Line {
        ordinal: commit.ordinal,
        report: &record.report,
        wall_s: record.wall_s,
        state_hash: commit.state_hash.to_string(),
        parent_hash: commit.parent_hash.to_string(),
        chain_hash: commit.chain_hash.to_string(),
    };
    serde_json::to_string(&line).expect("plain numbers and strings under string keys are JSON")
}
