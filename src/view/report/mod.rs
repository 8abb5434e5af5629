//! A report: one page that holds runs whole, to be opened from disk without a network: curves, the deformed shell to be turned and
//! played, work of the stages, scene and hashes.
//!
//! | file | what |
//! |---|---|
//! | `run` | what the page shows of a run |
//! | `shape` | the deformed shell over the load steps |
//! | `page.html`, `page.js`, `study.html`, `study.js`, `sweep.html`, `sweep.js`, `page.css` | the pages of runs, of a study, of a sweep; the looks of all |
//! | `vendor` | libraries that it is drawn with, and their licences |

mod run;
mod shape;

pub use run::{ReportedRun, Told};
pub use shape::{FrameAt, Shape, chosen_frames};

use serde::Serialize;
use serde_json::Value;

use super::drawing::escaped;
use crate::printable::one_line;
use crate::sweep::{Quantity, Row, Table};

const STYLE: &str = include_str!("page.css");
const CHARTS: &str = include_str!("vendor/chart.js");
const SOLIDS: &str = include_str!("vendor/three.js");

/// The page of some runs, as HTML text.
///
/// # Errors
/// Where a number of a run cannot be written as JSON.
pub fn report_page(title: &str, runs: &[ReportedRun]) -> Result<String, serde_json::Error> {
    let data = serde_json::to_string(runs)?;
    Ok(filled(include_str!("page.html"), title, &data, include_str!("page.js")))
}

/// The page of a study: errors against run times, and tables. `rows` are what `foldline study --json` prints.
pub fn study_page(title: &str, rows: &[Value]) -> String {
    filled(include_str!("study.html"), title, &Value::from(rows).to_string(), include_str!("study.js"))
}

/// The page of a sweep: response curves and surfaces, distributions, parallel coordinates and a table of the tasks, each with its log, whose
/// links begin with `logs`; `command` makes a page of one.
///
/// # Errors
/// Where a value of the table cannot be written as JSON.
pub fn sweep_page(table: &Table, logs: &str, command: &str) -> Result<String, serde_json::Error> {
    let columns = table.columns();
    // The name of a log is its task's key.
    let kept: Vec<usize> = (0..columns.len()).filter(|index| columns[*index] != "key").collect();
    let values = |row: &Row| {
        let values = table.values(row);
        kept.iter().map(|index| values[*index].clone()).collect()
    };
    let data = SweepData {
        columns: kept.iter().map(|index| columns[*index].clone()).collect(),
        varies: &table.head.columns,
        outputs: &table.head.outputs,
        rows: table.rows.iter().map(values).collect(),
        logs,
        command,
    };
    let data = serde_json::to_string(&data)?;
    Ok(filled(include_str!("sweep.html"), &table.head.title, &data, include_str!("sweep.js")))
}

/// What the page of a sweep reads.
#[derive(Serialize)]
struct SweepData<'t> {
    columns: Vec<String>,
    varies: &'t [String],
    outputs: &'t [Quantity],
    rows: Vec<Vec<Value>>,
    logs: &'t str,
    command: &'t str,
}

/// A page with its title, styles, libraries, data and script in their places.
fn filled(page: &str, title: &str, data: &str, script: &str) -> String {
    // No text of a scene or a log can end the element that holds the data.
    let data = data.replace('<', "\\u003c");
    let title = escaped(&one_line(title));
    let part = |name: &str| match name {
        "title" => &title[..],
        "style" => STYLE,
        "charts" => CHARTS,
        "solids" => SOLIDS,
        "script" => script,
        _ => &data[..],
    };
    let mut text = String::with_capacity(data.len() + CHARTS.len() + SOLIDS.len());
    for piece in page.split("{{") {
        match piece.split_once("}}") {
            None => text.push_str(piece),
            Some((name, rest)) => {
                text.push_str(part(name));
                text.push_str(rest);
            }
        }
    }
    text
}
