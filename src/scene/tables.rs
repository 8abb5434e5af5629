//! All tables of a scene file, each read by itself: what is wrong with one hides nothing of another.

use super::document::{Document, Written};
use super::fault::{CheckedWhole, Fault, TextSpan};
use super::keys::{Presence, Section};
use super::names;
use super::problem::Problem;
use super::table::Table;

/// Tables of one name in a scene: pairs of them are compared.
const MOST_OF_A_NAME: usize = 2000;

/// The tables of a scene: one of each that there is one of, and as many of the others as are written.
pub(super) struct Tables(Vec<Table>);

impl Tables {
    /// Reads all tables of a document. Faults of names come in the order of the text, others in the order of the table
    /// of keys.
    pub fn read(document: &Document<'_>) -> CheckedWhole<Self> {
        let wrong_names = names::check(document);
        let is_told = |name: &str| wrong_names.iter().any(|fault| fault.problem.meant().as_deref() == Some(name));
        // Of a table that is most likely of another kind nothing is reported.
        let of_other_kind = |fault: &&Fault| matches!(fault.problem, Problem::OfOtherKind { .. });
        let unread: Vec<&TextSpan> = wrong_names.iter().filter(of_other_kind).map(|fault| &fault.place).collect();
        let is_read = |table: &&Written<'_>| !table.entries.iter().any(|entry| unread.contains(&&entry.place));
        let (mut tables, mut faults) = (Vec::new(), Vec::new());
        let mut keep = |table: CheckedWhole<Table>| match table {
            Ok(table) => tables.push(table),
            Err(found) => faults.extend(found),
        };
        for section in document.sections {
            let written = || document.tables.iter().filter(|table| table.name == section.name);
            if let Some(first_of_too_many) = written().nth(MOST_OF_A_NAME) {
                keep(Err(vec![*too_many(section, written().count(), &first_of_too_many.place)]));
            } else if written().next().is_some() {
                let tables = written().filter(is_read).filter(|table| section.many == table.number.is_some());
                tables.for_each(|table| keep(Table::read(document, section, Some(table), &wrong_names)));
            } else if section.required {
                keep(if is_told(section.name) { Err(vec![]) } else { Err(vec![*missing_section(document, section)]) });
            } else if !section.many {
                keep(Table::read(document, section, None, &wrong_names));
            }
        }
        faults.splice(0..0, wrong_names);
        if faults.is_empty() { Ok(Self(tables)) } else { Err(faults) }
    }

    /// The only table of this name.
    pub fn one(&self, name: &str) -> &Table {
        let mut tables = self.all(name);
        tables.next().unwrap_or_else(|| unreachable!("there is no table [{name}]"))
    }

    /// All tables of this name.
    pub fn all(&self, name: &str) -> impl Iterator<Item = &Table> {
        self.0.iter().filter(move |table| table.section.name == name)
    }
}

fn too_many(section: &Section, count: usize, place: &TextSpan) -> Box<Fault> {
    let problem = Problem::Table {
        table: section.title(),
        problem: format!("there are {count} of them, and a scene takes no more than {MOST_OF_A_NAME}"),
        remedy: "write what is alike as one table: points along a line, layers of one angle".into(),
    };
    Fault::new(problem, place)
}

fn missing_section(document: &Document<'_>, section: &'static Section) -> Box<Fault> {
    let keys = section.keys_of(section.example_kind());
    let required = keys.filter(|key| key.presence == Presence::Required);
    let lines: String = required.map(|key| format!("\n{} = {}", key.name, key.example)).collect();
    let gap = if document.end.span.end == 0 { "" } else { "\n\n" };
    Fault::new(Problem::MissingSection { section }, &document.end)
        .edit(&document.end, format!("{gap}{}{lines}", section.title()))
}
