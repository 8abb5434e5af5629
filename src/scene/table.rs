//! One table of a scene file, read: each value of the type and within the limits of its key, and every default filled in.

use std::collections::BTreeMap;

use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use super::document::{Document, Written};
use super::entry::Entry;
use super::fault::{Checked, CheckedWhole, Fault, TextSpan};
use super::keys::{Key, Presence, Section};
use super::problem::Problem;
use super::{names, read};

/// The content of one table.
pub(super) struct Table {
    pub section: &'static Section,
    /// Name of the table in errors.
    pub title: String,
    /// Its number, from 1, where there may be several.
    pub number: usize,
    /// Whether the file has it, or a setting.
    pub is_given: bool,
    /// Span of the table's header.
    pub place: TextSpan,
    /// Values in the form that the data of a scene have in JSON, by key.
    pub values: Map<String, Value>,
    /// Places of given values: of the whole, and of the items of a list.
    places: BTreeMap<&'static str, (TextSpan, Vec<TextSpan>)>,
}

impl Table {
    /// Reads a table, or one that is missing, with the defaults of its keys. A key for which one of `wrong_names` is
    /// the likely misspelling is not reported as missing as well.
    pub fn read(
        document: &Document<'_>,
        section: &'static Section,
        written: Option<&Written<'_>>,
        wrong_names: &[Fault],
    ) -> CheckedWhole<Self> {
        let mut table = Self {
            section,
            title: written.map_or(section.title(), Written::title),
            number: written.and_then(|written| written.number).unwrap_or_default(),
            is_given: written.is_some(),
            place: written.map_or(&document.end, |written| &written.place).clone(),
            values: Map::new(),
            places: BTreeMap::new(),
        };
        let mut faults = Vec::new();
        let mut take = |table: &mut Self, key: &'static Key| match table.take(document, key, written) {
            Ok(()) => true,
            Err(fault) => {
                let fault = if section.many { fault.in_item(Some(table.title.clone())) } else { fault };
                let means_it = |wrong: &Fault| wrong.item == fault.item && wrong.problem.meant() == Some(key.path());
                let is_told = matches!(fault.problem, Problem::MissingKey { .. }) && wrong_names.iter().any(means_it);
                faults.extend((!is_told).then_some(*fault));
                false
            }
        };
        // Which keys it has hangs on its kind.
        let kind_key = section.kind_key();
        if kind_key.is_none_or(|key| take(&mut table, key)) {
            let kind = table.values.get("kind").and_then(Value::as_str).map(str::to_owned);
            let others = section.keys_of(kind_key.and(kind.as_deref())).filter(|key| Some(*key) != kind_key);
            others.for_each(|key| _ = take(&mut table, key));
        }
        if faults.is_empty() { Ok(table) } else { Err(faults) }
    }

    /// Takes the value of a key, or its default.
    fn take(
        &mut self,
        document: &Document<'_>,
        key: &'static Key,
        written: Option<&Written<'_>>,
    ) -> Result<(), Box<Fault>> {
        let entry = |name: &str| written.and_then(|written| written.entry(name));
        let value = match (entry(key.name), key.presence) {
            (Some(given), Presence::InsteadOf(other) | Presence::Unless(other)) if entry(other).is_some() => {
                let other = self.section.keys.iter().find(|it| it.name == other).unwrap_or(key);
                let also = entry(other.name).map(|entry| entry.place.clone());
                return Err(Fault::new(Problem::BothGiven { key, other }, &given.place).also(also.as_ref()));
            }
            (Some(given), _) => {
                let items = given.value.get_ref().as_array().into_iter().flatten();
                let items = items.map(|item| given.place_of(item.span())).collect();
                self.places.insert(key.name, (given.value_place(), items));
                value(key, given)?
            }
            (None, Presence::Default(text)) => match Entry::of_default(key, text) {
                Ok(entry) => read::value(key, &entry)?,
                Err(_) => unreachable!("the default of {} is no TOML", key.path()),
            },
            (None, Presence::Required) => return Err(missing(document, key, written)),
            (None, Presence::Unless(other)) if entry(other).is_none() => return Err(missing(document, key, written)),
            (None, _) => return Ok(()),
        };
        self.values.insert(key.name.to_owned(), value);
        Ok(())
    }

    /// The word for the table's kind.
    pub fn kind(&self) -> &str {
        self.word("kind")
    }

    /// The name of the table, or else one with its number: "support 2".
    pub fn name(&self) -> String {
        let numbered = || format!("{} {}", self.section.name, self.number);
        self.get::<Option<String>>("name").unwrap_or_else(numbered)
    }

    /// The value of a key that is a word; empty where it has none.
    pub fn word(&self, name: &str) -> &str {
        self.values.get(name).and_then(Value::as_str).unwrap_or_default()
    }

    /// Returns the value of a key, or its default; `None` for an optional key without one.
    pub fn get<T: DeserializeOwned>(&self, name: &str) -> T {
        let value = self.values.get(name).cloned().unwrap_or_default();
        serde_json::from_value(value).unwrap_or_else(|error| unreachable!("{} {name}: {error}", self.title))
    }

    /// Converts all values of the table to the data of a scene.
    pub fn data<T: DeserializeOwned>(&self) -> T {
        data(&self.title, self.values.clone())
    }

    /// The span of a key's value, if it is given.
    pub fn place_of(&self, name: &str) -> Option<TextSpan> {
        self.places.get(name).map(|(whole, _)| whole.clone())
    }

    /// The span of an item of a key's value, or of the whole value where it is no list.
    pub fn place_of_item(&self, name: &str, index: usize) -> Option<TextSpan> {
        let (whole, items) = self.places.get(name)?;
        Some(items.get(index).unwrap_or(whole).clone())
    }

    /// Creates a fault about this table.
    pub fn wrong(&self, place: Option<&TextSpan>, problem: impl Into<String>, remedy: impl Into<String>) -> Box<Fault> {
        let problem = Problem::Table { table: self.title.clone(), problem: problem.into(), remedy: remedy.into() };
        Fault::new(problem, place.unwrap_or(&self.place))
    }

    /// Creates a fault about the value of a key.
    pub fn wrong_at(&self, name: &str, problem: impl Into<String>, remedy: impl Into<String>) -> Box<Fault> {
        self.wrong(self.place_of(name).as_ref(), problem, remedy)
    }
}

/// The value of an entry; a list of inline tables is read as tables of a scene file are, and of what is wrong the first is told.
fn value(key: &'static Key, entry: &Entry<'_>) -> Checked<Value> {
    let value = read::value(key, entry)?;
    let Some(section) = key.items else { return Ok(value) };
    let items = entry.value.get_ref().as_array().into_iter().flatten().enumerate();
    let written = items.filter_map(|(index, item)| {
        let table = item.get_ref().as_table()?.clone();
        Some(Written::inline(section, index + 1, entry.place_of(item.span()), table, &entry.base))
    });
    let document = Document::of_inline(std::slice::from_ref(section), written.collect());
    if let Some(wrong_name) = names::check(&document).into_iter().next() {
        return Err(Box::new(wrong_name));
    }
    let mut values = Vec::new();
    for written in &document.tables {
        match Table::read(&document, section, Some(written), &[]) {
            Ok(table) => values.push(Value::Object(table.values)),
            Err(faults) => {
                return Err(faults.into_iter().next().map_or_else(|| missing(&document, key, None), Box::new));
            }
        }
    }
    Ok(values.into())
}

/// Values by key as the data of a scene, which have fields of the same names.
pub(super) fn data<T: DeserializeOwned>(title: &str, values: Map<String, Value>) -> T {
    serde_json::from_value(Value::Object(values)).unwrap_or_else(|error| unreachable!("{title}: {error}"))
}

/// The error for a key that is not there.
pub(super) fn missing(document: &Document<'_>, key: &'static Key, written: Option<&Written<'_>>) -> Box<Fault> {
    let place = written.map_or(&document.end, |written| &written.place);
    let fault = Fault::new(Problem::MissingKey { key }, place);
    match written.and_then(|written| document.line_end(written)) {
        Some(end) => fault.edit(&end, format!("\n{} = {}", key.name, key.example)),
        None => fault,
    }
}

/// The error for two values that do not go together; either may be a default, which is not in the text.
pub(super) fn between(
    problem: Problem,
    first: Option<TextSpan>,
    second: Option<TextSpan>,
    table: &Table,
) -> Box<Fault> {
    match (first, second) {
        (Some(first), second) => Fault::new(problem, &first).also(second.as_ref()),
        (None, Some(second)) => Fault::new(problem, &second),
        (None, None) => Fault::new(problem, &table.place),
    }
}
