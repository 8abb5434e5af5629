//! How a factor follows the load factor: the key `history` of supports and actions.

use super::data::History;
use super::fault::Checked;
use super::table::Table;

/// The history of a table.
pub(super) fn history(table: &Table) -> Checked<History> {
    let rows: Vec<[f64; 2]> = table.get::<Option<_>>("history").unwrap_or_default();
    if rows.windows(2).any(|pair| pair[1][0] <= pair[0][0]) || rows.first().is_some_and(|row| row[0] < 0.0) {
        let remedy = "each row is [load factor, factor]; load factors start at 0 or later and grow from row to row";
        return Err(table.wrong_at("history", "the load factors of `history` do not grow", remedy));
    }
    if rows.first().is_some_and(|row| row[0] == 0.0 && row[1] != 0.0) {
        let remedy = "the run starts from the undeformed shell: the factor at load factor 0 must be 0";
        return Err(table.wrong_at("history", "`history` does not start from rest", remedy));
    }
    Ok(History(rows))
}
