//! Wrong names in a scene file.

use super::document::{Document, Header};
use super::entry::Entry;
use super::fault::{Checked, Fault};
use super::foreign_unit::ForeignUnit;
use super::key_table::{KEYS, SECTIONS};
use super::keys::{Key, Section, join_or, toml_float};
use super::kinds::{ARRAYS, kinds_with};
use super::meant::{also_called, key, meant_anywhere, near, other_unit};
use super::nearest::nearest;
use super::problem::Problem;
use super::read::known_word;
use super::value::{as_float, value_type};

/// Refuses the first wrong name in the text.
pub(super) fn check(document: &Document<'_>) -> Checked<()> {
    let headers = document.headers.iter().map(|header| (&header.place, Item::Header(header)));
    let strays = document.strays.iter().map(|entry| (&entry.place, Item::Stray(entry)));
    let entries = document.entries.iter().map(|entry| (&entry.place, Item::Entry(entry)));
    let mut items: Vec<_> = headers.chain(strays).chain(entries).collect();
    items.sort_by_key(|(place, _)| (place.source, place.span.start));
    items.into_iter().try_for_each(|(_, item)| match item {
        Item::Header(header) => check_header(header),
        Item::Stray(entry) => Err(stray(entry)),
        Item::Entry(entry) => check_entry(document, entry),
    })
}

enum Item<'d, 't> {
    Header(&'d Header),
    Stray(&'d Entry<'t>),
    Entry(&'d Entry<'t>),
}

fn section(name: &str) -> Option<&'static Section> {
    SECTIONS.iter().find(|section| section.name == name)
}

fn check_header(header: &Header) -> Checked<()> {
    if section(&header.name).is_some() {
        return Ok(());
    }
    if let Some(array) = ARRAYS.iter().find(|array| **array == header.name) {
        let problem = Problem::Table {
            table: format!("[{array}]"),
            problem: "there may be several, so each is an item of an array".into(),
            remedy: format!("write `[[{array}]]` with two brackets"),
        };
        return Err(Fault::new(problem, &header.place));
    }
    let meant = nearest(&header.name, SECTIONS.iter().map(|section| section.name).chain(ARRAYS));
    let fault = Fault::new(Problem::UnknownSection { found: header.name.clone(), meant }, &header.place);
    Err(match meant {
        Some(meant) => fault.edit(&header.place, meant),
        None => fault,
    })
}

fn stray(entry: &Entry<'_>) -> Box<Fault> {
    if let Some(section) = section(&entry.name) {
        let found = value_type(entry.value.get_ref());
        return Fault::new(Problem::NotATable { section: section.name, found }, &entry.place);
    }
    let meant = meant_anywhere(&entry.name);
    Fault::new(Problem::KeyOutsideTables { found: entry.name.clone(), meant }, &entry.place)
}

fn check_entry(document: &Document<'_>, entry: &Entry<'_>) -> Checked<()> {
    let Some(section) = section(&entry.section) else { return Ok(()) };
    if document.is_of_general_kind(section.name) {
        return Ok(());
    }
    let here = || KEYS.iter().copied().filter(|key| key.section == section.name);
    let found = &*entry.name;
    if here().any(|key| key.name == found) {
        return Ok(());
    }
    let kinds = kinds_with(section.name, found);
    if !kinds.is_empty() {
        return Err(of_other_kind(document, entry, &kinds));
    }
    // A setting takes the place of what is given; a line of the file does not.
    let given = |key: &Key| entry.place.source == 0 && document.entry(key.section, key.name).is_some();
    let elsewhere = || KEYS.iter().copied().filter(|key| key.section != section.name);
    let named = elsewhere().find(|key| key.name == found && key.name != "kind");
    if named.is_none()
        && let Some((key, unit)) = here().find_map(|key| Some((key, other_unit(key, found)?)))
    {
        let fault = in_other_unit(entry, key, unit);
        return Err(if given(key) { fault.unmended() } else { fault });
    }
    let meant = named
        .or_else(|| here().find(|key| also_called(key, found)))
        .or_else(|| near(found, here()))
        .or_else(|| meant_anywhere(found));
    let fault = Fault::new(Problem::UnknownKey { section: section.name, found: found.into(), meant }, &entry.place);
    Err(match meant {
        Some(key) if key.section == section.name && !given(key) => fault.edit(&entry.place, key.name),
        _ => fault,
    })
}

/// The error for a key that belongs to another kind than the table is of: most likely the kind is wrong.
fn of_other_kind(document: &Document<'_>, entry: &Entry<'_>, kinds: &[&str]) -> Box<Fault> {
    let section = &*entry.section;
    let quoted: Vec<String> = kinds.iter().map(|kind| format!("kind = \"{kind}\"")).collect();
    let kind = document.entry(section, "kind");
    if let (Some(kind), Some(key)) = (kind, key(&format!("{section}.kind")))
        && let Err(fault) = known_word(key, kind)
    {
        return fault;
    }
    let found = kind.and_then(|kind| kind.value.get_ref().as_str());
    let here = found.map_or("no kind is given".to_owned(), |kind| format!("the kind is \"{kind}\""));
    let problem = Problem::Table {
        table: format!("[{section}]"),
        problem: format!("`{}` is a key of {}, and here {here}", entry.name, join_or(&quoted)),
        remedy: format!("write {}, or take the key out", join_or(&quoted)),
    };
    Fault::new(problem, &entry.place).also(kind.map(Entry::value_place).as_ref())
}

fn in_other_unit(entry: &Entry<'_>, key: &'static Key, unit: &'static ForeignUnit) -> Box<Fault> {
    let given = as_float(entry.value.get_ref()).filter(|value| value.is_finite());
    let values = given.map(|value| (value, unit.convert(value)));
    let problem = Problem::OtherUnit { found: entry.name.clone(), key, unit: unit.words, values };
    let fault = Fault::new(problem, &entry.place).edit(&entry.place, key.name);
    match values {
        Some((before, after)) if before != after => fault.edit(&entry.value_place(), toml_float(after)),
        _ => fault,
    }
}
