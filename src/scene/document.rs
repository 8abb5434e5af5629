//! TOML text and settings as one list of entries that know their place in the text. Nothing is judged here but syntax.

use std::borrow::Cow;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::entry::Entry;
use super::fault::{Checked, Fault, Place};
use super::kinds::{ARRAYS, GEOMETRIES, LOADS, MATERIALS};
use super::problem::Problem;
use super::table::Table;
use super::{meant, syntax};

/// What stands in a scene file, with settings applied.
pub(super) struct Document<'t> {
    /// The tables, in the order of the text.
    pub headers: Vec<Header>,
    /// Keys and values in tables.
    pub entries: Vec<Entry<'t>>,
    /// Keys and values in front of all tables, and tables of the wrong form.
    pub strays: Vec<Entry<'t>>,
    /// Items of arrays of tables.
    pub items: Vec<Item<'t>>,
    /// Behind the last text of the file.
    pub end: Place,
    /// The file.
    text: &'t str,
}

/// One table of an array of tables.
pub(super) struct Item<'t> {
    /// Name of the array.
    pub array: String,
    pub place: Place,
    pub entries: Vec<Entry<'t>>,
}

/// A table.
pub(super) struct Header {
    pub name: String,
    pub place: Place,
    /// Whether it is written `[name]` on a line of its own, so that lines may be added below.
    own_line: bool,
}

impl<'t> Document<'t> {
    /// Reads the file (source 0) and then each setting (sources 1, 2, …) over it.
    pub fn read<S: AsRef<str>>(text: &'t str, settings: &'t [S]) -> Checked<Self> {
        let root =
            DeTable::parse(text).map_err(|error| syntax::fault(&error, text, &Place { source: 0, span: 0..0 }))?;
        let last = text.trim_end().len();
        let end = Place { source: 0, span: last..last };
        let mut document = Self { headers: vec![], entries: vec![], strays: vec![], items: vec![], end, text };
        for (name, value) in in_order_of_text(root.into_inner()) {
            document.take_root(name, value);
        }
        for (index, setting) in settings.iter().enumerate() {
            document.set(index + 1, setting.as_ref())?;
        }
        Ok(document)
    }

    /// The table of this name.
    pub fn header(&self, name: &str) -> Option<&Header> {
        self.headers.iter().find(|header| header.name == name)
    }

    /// The value of a key.
    pub fn entry(&self, section: &str, name: &str) -> Option<&Entry<'t>> {
        self.entries.iter().find(|entry| entry.section == section && entry.name == name)
    }

    /// Whether a table has a kind whose keys the table of keys does not know.
    pub fn is_of_general_kind(&self, section: &str) -> bool {
        let kinds: &[&str] = match section {
            "geometry" => &GEOMETRIES,
            "material" => &MATERIALS,
            "load" => &LOADS,
            _ => &[],
        };
        let kind = self.entry(section, "kind").and_then(|entry| entry.value.get_ref().as_str());
        kind.is_some_and(|kind| kinds.contains(&kind))
    }

    /// A table of such a kind.
    pub fn table(&self, section: &str) -> Table<'_, 't> {
        let place = self.header(section).map_or(&self.end, |header| &header.place).clone();
        let entries = self.entries.iter().filter(|entry| entry.section == section).collect();
        Table::new(format!("[{section}]"), place, entries)
    }

    /// The tables of an array.
    pub fn tables(&self, array: &str) -> Vec<Table<'_, 't>> {
        let items = self.items.iter().filter(|item| item.array == array).enumerate();
        items
            .map(|(index, item)| {
                let name = item.entries.iter().find(|entry| entry.name == "name");
                let title = match name.and_then(|entry| entry.value.get_ref().as_str()) {
                    Some(name) => format!("[[{array}]] \"{name}\""),
                    None => format!("[[{array}]] {}", index + 1),
                };
                Table::new(title, item.place.clone(), item.entries.iter().collect())
            })
            .collect()
    }

    /// Where a line can be added to a table: the end of the line of its last entry, or of its header.
    pub fn line_end(&self, header: &Header) -> Option<Place> {
        if !header.own_line {
            return None;
        }
        let in_file = self.entries.iter().filter(|entry| entry.section == header.name && entry.place.source == 0);
        let last = in_file.map(|entry| entry.value_place().span.end).max().unwrap_or(header.place.span.end);
        let rest = self.text.get(last..)?;
        let line = rest.find('\n').map_or(rest, |length| &rest[..length]);
        let at = last + line.trim_end_matches('\r').len();
        Some(Place { source: 0, span: at..at })
    }

    fn take_root(&mut self, name: Spanned<Cow<'t, str>>, value: Spanned<DeValue<'t>>) {
        let place = Place { source: 0, span: name.span() };
        let base = Place { source: 0, span: 0..0 };
        let section = name.into_inner().into_owned();
        let span = value.span();
        match value.into_inner() {
            DeValue::Table(table) => {
                for (key, value) in in_order_of_text(table) {
                    let place = Place { source: 0, span: key.span() };
                    let name = key.into_inner().into_owned();
                    let section = section.clone();
                    self.entries.push(Entry { section, name, place, value, base: base.clone() });
                }
                let before = self.text[..place.span.start].trim_end_matches([' ', '\t']);
                self.headers.push(Header { name: section, place, own_line: before.ends_with('[') });
            }
            DeValue::Array(tables) if ARRAYS.contains(&&*section) => {
                for (index, table) in tables.into_iter().enumerate() {
                    let place = Place { source: 0, span: if index == 0 { place.span.clone() } else { table.span() } };
                    let mut entries = Vec::new();
                    if let DeValue::Table(table) = table.into_inner() {
                        for (key, value) in in_order_of_text(table) {
                            let place = Place { source: 0, span: key.span() };
                            let (name, base) = (key.into_inner().into_owned(), base.clone());
                            entries.push(Entry { section: section.clone(), name, place, value, base });
                        }
                    }
                    self.items.push(Item { array: section.clone(), place, entries });
                }
            }
            other => {
                let value = Spanned::new(span, other);
                self.strays.push(Entry { section: String::new(), name: section, place, value, base });
            }
        }
    }

    /// Applies one setting, `section.key=value`.
    fn set(&mut self, source: usize, setting: &'t str) -> Checked<()> {
        let whole = Place { source, span: 0..setting.len() };
        let Some((path, value_text)) = setting.split_once('=') else {
            let key = meant::key(setting.trim());
            return Err(Fault::new(Problem::SettingWithoutValue { key }, &whole));
        };
        let start = path.len() - path.trim_start().len();
        let place = Place { source, span: start..start + path.trim().len() };
        let Some((section, name)) = path.trim().split_once('.') else {
            return Err(meant::setting_without_section(path.trim(), &place));
        };
        let section_place = Place { source, span: start..start + section.len() };
        if ARRAYS.contains(&section) {
            let problem = Problem::Table {
                table: format!("[[{section}]]"),
                problem: "a setting cannot say which of several tables it means".into(),
                remedy: "change it in the scene file".into(),
            };
            return Err(Fault::new(problem, &section_place));
        }
        let name_place = Place { source, span: start + section.len() + 1..place.span.end };

        let value_start = setting.len() - value_text.trim_start().len();
        let base = Place { source, span: value_start..setting.len() };
        let value =
            setting_value(value_text.trim()).map_err(|error| syntax::fault(&error, value_text.trim(), &base))?;

        let displaced = meant::stands_in_for(section, name);
        self.entries
            .retain(|entry| entry.section != section || !(entry.name == name || displaced.contains(&&*entry.name)));
        if self.header(section).is_none() {
            self.headers.push(Header { name: section.into(), place: section_place, own_line: false });
        }
        self.entries.push(Entry { section: section.into(), name: name.into(), place: name_place, value, base });
        Ok(())
    }
}

/// The value of a setting: TOML, or a bare word, which needs no quotes (a shell would take them away).
fn setting_value(text: &str) -> Result<Spanned<DeValue<'_>>, toml::de::Error> {
    DeValue::parse(text).or_else(|error| {
        let bare = text.starts_with(|c: char| c.is_ascii_alphabetic())
            && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
        if bare { Ok(Spanned::new(0..text.len(), DeValue::String(Cow::Borrowed(text)))) } else { Err(error) }
    })
}

fn in_order_of_text<'t>(table: DeTable<'t>) -> Vec<(Spanned<Cow<'t, str>>, Spanned<DeValue<'t>>)> {
    let mut items: Vec<_> = table.into_iter().collect();
    items.sort_by_key(|(key, _)| key.span().start);
    items
}
