//! Where something stands or acts, and how it grows: the keys `on` and `history` of the arrays of tables.

use super::data::{Edge, Geometry, History, ParametricDirection, Place};
use super::fault::Checked;
use super::table::Table;

/// Where something is: an edge, a point or a line.
pub(super) fn place(table: &Table<'_, '_>) -> Checked<Place> {
    let remedy = "write an edge (\"u-start\", \"u-end\", \"v-start\", \"v-end\"), a point (`on = [1.0, 0.5]`, fractions of u and v), or a line (`on = \"u=0.5\"`)";
    let Some(entry) = table.entry("on") else { return Err(table.missing("on", remedy)) };
    let at = entry.value_place();
    let Some(text) = entry.value.get_ref().as_str() else {
        let [u, v] = point(table)?;
        return Ok(Place::Point([u, v]));
    };
    let edges = [("u-start", Edge::UStart), ("u-end", Edge::UEnd), ("v-start", Edge::VStart), ("v-end", Edge::VEnd)];
    if let Some((_, edge)) = edges.iter().find(|(name, _)| *name == text) {
        return Ok(Place::Edge(*edge));
    }
    if let Some((direction, value)) = text.split_once('=') {
        let direction = match direction.trim() {
            "u" => Some(ParametricDirection::U),
            "v" => Some(ParametricDirection::V),
            _ => None,
        };
        if let (Some(direction), Ok(value)) = (direction, value.trim().parse::<f64>()) {
            if 0.0 < value && value < 1.0 {
                return Ok(Place::Line(direction, value));
            }
            let remedy = "a line lies strictly between 0 and 1; at 0 and 1 are the edges, such as \"u-start\"";
            return Err(table.wrong(Some(&at), format!("there is no line {text}"), remedy));
        }
    }
    Err(table.wrong(Some(&at), format!("`on` cannot be \"{text}\""), remedy))
}

/// A point, by its fractions of u and v.
pub(super) fn point(table: &Table<'_, '_>) -> Checked<[f64; 2]> {
    let at: [f64; 2] = table.tuple("on", "[1.0, 0.5]")?;
    if at.iter().any(|fraction| !(0.0..=1.0).contains(fraction)) {
        let problem = format!("there is no point ({}, {})", at[0], at[1]);
        return Err(table.wrong(table.place_of("on").as_ref(), problem, "fractions of u and v run from 0 to 1"));
    }
    Ok(at)
}

/// A whole edge.
pub(super) fn edge(table: &Table<'_, '_>, what: &str) -> Checked<Edge> {
    match place(table)? {
        Place::Edge(edge) => Ok(edge),
        _ => Err(table.wrong(
            table.place_of("on").as_ref(),
            format!("{what} needs a whole edge"),
            "write `on = \"u-start\"`, \"u-end\", \"v-start\" or \"v-end\"",
        )),
    }
}

/// How a factor follows the load factor.
pub(super) fn history(table: &Table<'_, '_>) -> Checked<History> {
    let rows: Vec<[f64; 2]> = table.maybe_rows("history", "[[0.0, 0.0], [1.0, 1.0]]")?.unwrap_or_default();
    if rows.windows(2).any(|pair| pair[1][0] <= pair[0][0]) || rows.first().is_some_and(|row| row[0] < 0.0) {
        let remedy = "each row is [load factor, factor]; load factors start at 0 or later and grow from row to row";
        return Err(table.wrong(
            table.place_of("history").as_ref(),
            "the load factors of `history` do not grow",
            remedy,
        ));
    }
    if rows.first().is_some_and(|row| row[0] == 0.0 && row[1] != 0.0) {
        let remedy = "the run starts from the undeformed shell: the factor at load factor 0 must be 0";
        return Err(table.wrong(table.place_of("history").as_ref(), "`history` does not start from rest", remedy));
    }
    Ok(History(rows))
}

/// Where a plane of symmetry may lie.
pub(super) fn edge_or_line(table: &Table<'_, '_>) -> Checked<Place> {
    match place(table)? {
        on @ (Place::Edge(_) | Place::Line(..)) => Ok(on),
        _ => Err(table.wrong(
            table.place_of("on").as_ref(),
            "a plane of symmetry needs a whole edge or line",
            "write an edge, such as `on = \"u-start\"`, or a line inside, such as `on = \"u=0.5\"`",
        )),
    }
}

/// Refuses the word `radial` where the shape has neither axis nor centre.
pub(super) fn has_centre(table: &Table<'_, '_>, key: &str, geometry: &Geometry) -> Checked<()> {
    if geometry.away_from_centre([0.0; 3]).is_some() {
        return Ok(());
    }
    let shape = if matches!(geometry, Geometry::Plate { .. }) { "a plate" } else { "a nurbs surface" };
    Err(table.wrong(
        table.place_of(key).as_ref(),
        format!("{shape} has no axis and no centre that \"radial\" could be away from"),
        "write \"normal\", or use components in x, y and z",
    ))
}
