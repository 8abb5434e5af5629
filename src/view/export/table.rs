//! Fields at points as a table: comma-separated values, and JSON with units.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use rayon::prelude::*;
use serde::Serialize;

use super::instant::Instant;
use super::whole_shell::WholeShell;
use crate::spline::{Grid, Spans, mid_surface_point};
use crate::view::fields::Field;

/// A point of an element, with the values of fields there.
struct Row<'a> {
    /// Name of the shell of a structure.
    shell: Option<&'a str>,
    element: [usize; 2],
    parameters: [f64; 2],
    undeformed_mm: [f64; 3],
    deformed_mm: [f64; 3],
    /// The components of each field.
    values: Vec<Vec<f64>>,
}

/// Points on a grid of `points` each way over every element with its borders, the second direction fastest. Neighbours have points
/// of their own where they meet: fields may jump.
fn rows<'a>(shells: &[WholeShell<'a>], fields: &[Field], points: usize) -> Vec<Row<'a>> {
    shells.iter().flat_map(|shell| rows_of(shell, fields, points)).collect()
}

fn rows_of<'a>(shell: &WholeShell<'a>, fields: &[Field], points: usize) -> Vec<Row<'a>> {
    let mesh = shell.undeformed();
    let spans = [0, 1].map(|direction| Spans::of(&mesh.knots[direction], mesh.degree[direction]));
    let (elements, grid) = (Grid::new([0, 1].map(|direction| spans[direction].count())), Grid::new([points; 2]));
    let of_element = |element: [usize; 2]| {
        let bounds = [0, 1].map(|direction| spans[direction].bounds[element[direction]]);
        (0..grid.len()).map(move |index| {
            let share = grid.place(index).map(|place| place as f64 / (points - 1) as f64);
            let parameters = [0, 1].map(|direction| {
                let [from, to] = bounds[direction];
                from + (to - from) * share[direction]
            });
            let point = shell.at_in(bounds, parameters);
            let value = |field: &Field| {
                let value = point.value(field);
                // A zero without a sign.
                value[..field.components.len()].iter().copied().map(|number| number + 0.0).collect()
            };
            let [undeformed_mm, deformed_mm] =
                [mesh, shell.deformed()].map(|mesh| mid_surface_point(mesh, &[], parameters).position);
            let values = fields.iter().map(value).collect();
            Row { shell: shell.name(), element, parameters, undeformed_mm, deformed_mm, values }
        })
    };
    (0..elements.len()).into_par_iter().flat_map_iter(|element| of_element(elements.place(element))).collect()
}

/// Formats fields as comma-separated values with a line of names first: element and parameters (u, v), undeformed and deformed
/// position in mm, and the components of each field, at `points` each way over every element (at least 2). Rows of a structure
/// begin with the name of their shell. Where a field has no value there is `NaN`.
pub fn csv(shells: &[WholeShell], fields: &[Field], points: usize) -> String {
    let column = |field: &Field, component: &str| match component {
        "" => field.name.clone(),
        _ => format!("{}_{component}", field.name),
    };
    let of_field = |field: &Field| field.components.iter().map(|name| column(field, name)).collect::<Vec<_>>();
    let places =
        ["element_u", "element_v", "u", "v", "x0_mm", "y0_mm", "z0_mm", "x_mm", "y_mm", "z_mm"].map(String::from);
    let front = shells.iter().any(|shell| shell.name().is_some()).then(|| "shell".to_owned());
    let names: Vec<String> = front.into_iter().chain(places).chain(fields.iter().flat_map(of_field)).collect();
    let mut text = names.join(",") + "\n";
    for row in rows(shells, fields, points) {
        let Row { shell, element: [along, across], parameters, undeformed_mm, deformed_mm, values } = row;
        if let Some(name) = shell {
            text += &format!("{},", quoted(name));
        }
        // Writing to a string does not fail.
        let _ = write!(text, "{along},{across}");
        let numbers = parameters.iter().chain(&undeformed_mm).chain(&deformed_mm).chain(values.iter().flatten());
        for number in numbers {
            let _ = write!(text, ",{number:?}");
        }
        text.push('\n');
    }
    text
}

/// A name as a cell of a table (RFC 4180).
fn quoted(name: &str) -> String {
    match name.contains(['"', ',', '\n', '\r']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name.to_owned(),
    }
}

/// A file of JSON.
#[derive(Serialize)]
struct Document<'a> {
    /// Step, parameter and other numbers of the state, named with their units.
    state: BTreeMap<&'static str, f64>,
    state_hash: String,
    fields: Vec<WrittenField<'a>>,
    points: Vec<Point<'a>>,
}

#[derive(Serialize)]
struct WrittenField<'a> {
    name: &'a str,
    unit: &'a str,
    components: &'a [&'a str],
    means: &'a str,
}

impl<'a> WrittenField<'a> {
    fn of(Field { name, unit, components, means, .. }: &'a Field) -> Self {
        Self { name, unit, components, means }
    }
}

#[derive(Serialize)]
struct Point<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    shell: Option<&'a str>,
    element: [usize; 2],
    uv: [f64; 2],
    undeformed_mm: [f64; 3],
    deformed_mm: [f64; 3],
    /// Components of the fields by name.
    #[serde(flatten)]
    values: BTreeMap<&'a str, Vec<f64>>,
}

/// Formats the same as JSON: what the state is, the fields with units and meanings, and a record for each point;
/// null where a field has no value.
pub fn json(shells: &[WholeShell], fields: &[Field], points: usize, instant: &Instant) -> String {
    let point = |Row { shell, element, parameters, undeformed_mm, deformed_mm, values }| Point {
        shell,
        element,
        uv: parameters,
        undeformed_mm,
        deformed_mm,
        values: fields.iter().map(|field| &field.name[..]).zip(values).collect(),
    };
    let document = Document {
        state: instant.numbers().into_iter().collect(),
        state_hash: instant.state_hash.to_string(),
        fields: fields.iter().map(WrittenField::of).collect(),
        points: rows(shells, fields, points).into_iter().map(point).collect(),
    };
    // Names and numbers always have a form in JSON.
    serde_json::to_string(&document).unwrap_or_default() + "\n"
}
