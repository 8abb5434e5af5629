//! A report: one page that holds runs whole, to be opened from disk without a network: curves, the deformed shell to be turned and
//! played, work of the stages, scene and hashes.
//!
//! | file | what |
//! |---|---|
//! | `run` | what the page shows of a run |
//! | `shape` | the deformed shell over the load steps |
//! | `page.html`, `page.css`, `page.js` | the page |
//! | `vendor` | libraries that it is drawn with, and their licences |

mod run;
mod shape;

pub use run::{ReportedRun, Told};
pub use shape::{FrameAt, Shape, chosen_frames};

use crate::printable::one_line;

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");
const CHARTS: &str = include_str!("vendor/chart.js");
const SOLIDS: &str = include_str!("vendor/three.js");

/// The page of some runs, as HTML text.
///
/// # Errors
/// Where a number of a run cannot be written as JSON.
pub fn report_page(title: &str, runs: &[ReportedRun]) -> Result<String, serde_json::Error> {
    // No text of a scene or a log can end the element that holds the data.
    let data = serde_json::to_string(runs)?.replace('<', "\\u003c");
    let title = super::mesh_picture::escaped(&one_line(title));
    let parts = [("title", &title[..]), ("style", STYLE), ("charts", CHARTS), ("solids", SOLIDS), ("script", SCRIPT)];
    let mut page = String::with_capacity(data.len() + CHARTS.len() + SOLIDS.len() + 40_000);
    for piece in PAGE.split("{{") {
        match piece.split_once("}}") {
            None => page.push_str(piece),
            Some((name, rest)) => {
                let part = parts.iter().find(|(known, _)| *known == name).map_or(&data[..], |(_, part)| part);
                page.push_str(part);
                page.push_str(rest);
            }
        }
    }
    Ok(page)
}
