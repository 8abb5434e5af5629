//! The table of a sweep, as the terminal shows it.

use std::path::PathBuf;

use clap::Args;
use serde_json::Value;

use super::failure::Failure;
use super::output::{file_name, refuse_what_is_there, write_files};
use super::terminal::output_columns;
use super::wrapped::wrapped;
use crate::sweep::{Condition, Folder, Row, Table};
use crate::units::{count, significant};

/// Rows that are shown unless more are asked for.
const SHOWN: usize = 200;
/// Columns of a number with its sign and exponent.
const LEAST_WIDTH: usize = 9;
/// Significant digits.
const DIGITS: usize = 6;

/// What of the table is wanted, and how.
#[derive(Args, Clone, Debug, Default)]
pub(super) struct Chosen {
    /// Rows that meet a condition, such as 'peak_moment_n_mm>800' or ending=failed; may be repeated
    #[arg(long = "where", value_name = "CONDITION", value_parser = Condition::parse)]
    conditions: Vec<Condition>,
    /// Rows that are shown, at most [default: 200]
    #[arg(long, value_name = "N")]
    rows: Option<usize>,
    /// Write the table as CSV, with keys, costs and reasons
    #[arg(long, value_name = "FILE", value_parser = file_name())]
    csv: Option<PathBuf>,
    /// Write the table as Apache Parquet (where the program was built with `--features parquet`)
    #[arg(long, value_name = "FILE", value_parser = file_name())]
    parquet: Option<PathBuf>,
    /// Print a JSON object for each row
    #[arg(long)]
    json: bool,
}

impl Chosen {
    /// Whether a program reads the rows.
    pub(super) fn is_json(&self) -> bool {
        self.json
    }
}

/// The rows that are wanted, as text; files are written on the way.
pub(super) fn table_of(folder: &Folder, chosen: &Chosen) -> Result<String, Failure> {
    refuse_what_is_there(chosen.csv.iter().chain(&chosen.parquet))?;
    let mut table = Table::read(folder)?;
    let all = table.rows.len();
    table.retain(&chosen.conditions)?;
    if let Some(csv) = &chosen.csv {
        write_files(&[(csv.clone(), table.to_csv().into_bytes())])?;
    }
    if let Some(parquet) = &chosen.parquet {
        write_files(&[(parquet.clone(), as_parquet(&table)?)])?;
    }
    if chosen.json {
        return Ok(table.to_json_lines());
    }
    Ok(shown(&table, all, chosen.rows.unwrap_or(SHOWN)))
}

#[cfg(feature = "parquet")]
fn as_parquet(table: &Table) -> Result<Vec<u8>, Failure> {
    table.to_parquet().map_err(|source| Failure::Parquet { source: Box::new(source) })
}

#[cfg(not(feature = "parquet"))]
fn as_parquet(_: &Table) -> Result<Vec<u8>, Failure> {
    Err(Failure::NoParquet)
}

fn shown(table: &Table, all: usize, most: usize) -> String {
    let rows = &table.rows[..table.rows.len().min(most)];
    let mut text = blocks(table, rows, output_columns().unwrap_or(usize::MAX));
    if rows.len() < table.rows.len() {
        text += &wrapped(
            "",
            &format!("{} more: --rows N shows more, --csv FILE writes all", table.rows.len() - rows.len()),
        );
        text.push('\n');
    }
    let of = |ending: &str| table.rows.iter().filter(|row| row.ending() == ending).count();
    let endings = ["done", "failed", "refused", "to do"].map(|ending| (of(ending), ending));
    let endings: Vec<String> =
        endings.iter().filter(|(number, _)| *number > 0).map(|(number, ending)| format!("{number} {ending}")).collect();
    let of_all = if table.rows.len() < all { format!(" of {all}") } else { String::new() };
    text += &wrapped("", &format!("{}{of_all}: {}", count(table.rows.len(), "row"), endings.join(", ")));
    text.push('\n');
    text
}

/// The rows in blocks of as many columns as fit.
fn blocks(table: &Table, rows: &[Row], width: usize) -> String {
    let outputs: Vec<String> = table.head.outputs.iter().map(ToString::to_string).collect();
    let names: Vec<&str> = table.head.columns.iter().chain(&outputs).map(String::as_str).collect();
    let cells: Vec<Vec<String>> = rows.iter().map(|row| cells(table, row, &outputs)).collect();
    let widths: Vec<usize> = (0..names.len())
        .map(|column| {
            let of_cells = cells.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
            let of_head =
                head_lines(names[column], of_cells.max(LEAST_WIDTH)).iter().map(String::len).max().unwrap_or(0);
            of_cells.max(of_head)
        })
        .collect();
    let first = rows.iter().map(|row| row.task.number).max().unwrap_or(0).to_string().len().max(4) + 9;
    let mut text = String::new();
    let mut from = 0;
    while from < names.len() {
        let mut to = from;
        let mut used = first;
        while to < names.len() && (to == from || used + 2 + widths[to] <= width) {
            used += 2 + widths[to];
            to += 1;
        }
        text += &block(&names[from..to], &widths[from..to], first, rows, |row| &cells[row][from..to]);
        from = to;
    }
    text
}

fn block<'c>(
    names: &[&str],
    widths: &[usize],
    first: usize,
    rows: &[Row],
    cells: impl Fn(usize) -> &'c [String],
) -> String {
    let heads: Vec<Vec<String>> = names.iter().zip(widths).map(|(name, width)| head_lines(name, *width)).collect();
    let height = heads.iter().map(Vec::len).max().unwrap_or(0);
    let mut text = String::new();
    for line in 0..height {
        let lead = if line + 1 == height { "task" } else { "" };
        text += &format!("{lead:<first$}");
        for (head, width) in heads.iter().zip(widths) {
            let missing = height - head.len();
            let part = line.checked_sub(missing).map_or("", |line| &head[line]);
            text += &format!("  {part:>width$}");
        }
        text = text.trim_end().to_owned() + "\n";
    }
    for (index, row) in rows.iter().enumerate() {
        let number = row.task.number.to_string();
        let wide = first - 9;
        let ending = if row.task.is_reference && row.ending() == "done" { "refer." } else { row.ending() };
        text += &format!("{number:>wide$}  {ending:<7}");
        for (cell, width) in cells(index).iter().zip(widths) {
            text += &format!("  {cell:>width$}");
        }
        text = text.trim_end().to_owned() + "\n";
    }
    text
}

/// A name in lines of so many columns, broken behind dots and underscores.
fn head_lines(name: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for part in name.split_inclusive(['.', '_']) {
        match lines.last_mut() {
            Some(last) if last.is_empty() || last.len() + part.len() <= width => last.push_str(part),
            _ => lines.push(part.to_owned()),
        }
    }
    lines
}

fn cells(table: &Table, row: &Row, outputs: &[String]) -> Vec<String> {
    let own = row.task.values.iter().map(|value| match value {
        Value::Number(number) => {
            number.as_f64().map_or_else(|| number.to_string(), |number| significant(number, DIGITS))
        }
        Value::String(word) => word.clone(),
        value => value.to_string(),
    });
    debug_assert_eq!(row.task.values.len(), table.head.columns.len());
    let found =
        outputs.iter().map(|name| row.result(name).map_or_else(|| "–".to_owned(), |value| significant(value, DIGITS)));
    own.chain(found).collect()
}
