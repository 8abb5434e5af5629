//! A refusal of a scene that its text alone does not show, with the tables that it is about.

use super::document::{Document, Written};
use super::error::SceneError;
use super::fault::{Fault, Source, TextSpan};
use super::key_table::SECTIONS;
use super::problem::Problem;

/// The error of a scene that was refused after it was read (`text`, called `file_name`, with settings laid over it): `refusal`,
/// with the table of this kind (`support`, `action`, `probe`) and name underlined, or all of the kind where no name is given;
/// `None` where the text has no such table.
pub fn tables_refused<S: AsRef<str>>(
    text: &str,
    file_name: &str,
    settings: &[S],
    kind: &str,
    name: Option<&str>,
    refusal: &str,
) -> Option<SceneError> {
    let document = Document::read(text, settings, SECTIONS).ok()?;
    let is_meant = |(index, table): &(usize, &Written<'_>)| match name {
        None => true,
        Some(name) => table.entry("name").map_or_else(
            || format!("{kind} {}", index + 1) == name,
            |entry| entry.value.get_ref().as_str() == Some(name),
        ),
    };
    let of_kind = document.tables.iter().filter(|table| table.name == kind).enumerate();
    let meant: Vec<&Written<'_>> = of_kind.filter(is_meant).map(|(_, table)| table).collect();
    let first = meant.first()?;
    let table = if name.is_some() { first.title() } else { format!("[[{kind}]]") };
    // The sentence ends with the way out.
    let (problem, remedy) = refusal.rsplit_once("; ").unwrap_or((refusal, ""));
    let problem = Problem::Table { table, problem: problem.to_owned(), remedy: remedy.to_owned() };
    let rest = meant.iter().skip(1).map(|table| span_of(table));
    let fault = rest.fold(Fault::new(problem, &span_of(first)), |mut fault, place| {
        fault.others.push(place);
        fault
    });
    let sources = std::iter::once(Source { name: file_name.into(), text: text.into() })
        .chain(settings.iter().map(|text| Source { name: "--set".into(), text: text.as_ref().into() }));
    Some(SceneError::new(vec![*fault], sources.collect()))
}

/// A table from its header to its last value.
fn span_of(table: &Written<'_>) -> TextSpan {
    let TextSpan { source, span } = &table.place;
    let in_file = table.entries.iter().filter(|entry| entry.place.source == *source);
    let end = in_file.map(|entry| entry.value_place().span.end).max().unwrap_or(span.end);
    TextSpan { source: *source, span: span.start..end.max(span.end) }
}
