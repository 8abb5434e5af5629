//! Wrong names in a scene file.

use toml::de::DeValue;

use super::document::{Document, Written};
use super::entry::Entry;
use super::fault::{Fault, TextSpan};
use super::foreign_unit::ForeignUnit;
use super::keys::{Key, Section, toml_float};
use super::meant::{also_called, meant_anywhere, near, other_unit};
use super::nearest::nearest;
use super::problem::Problem;
use super::value::{as_float, value_type};

/// All wrong names, in the order of the text.
pub(super) fn check(document: &Document<'_>) -> Vec<Fault> {
    let strays = document.strays.iter().map(|entry| *stray(document, entry));
    let tables = document.tables.iter().flat_map(|table| match document.section(&table.name) {
        Some(section) if section.many == table.number.is_some() => in_table(document, section, table),
        Some(section) => vec![*in_single_brackets(section, &table.place)],
        None => vec![*unknown_section(document, table)],
    });
    let mut faults: Vec<_> = strays.chain(tables).collect();
    faults.sort_by_key(|fault| (fault.place.source, fault.place.span.start));
    faults
}

fn in_single_brackets(section: &Section, place: &TextSpan) -> Box<Fault> {
    let problem = Problem::Table {
        table: format!("[{}]", section.name),
        problem: "there may be several, so each is an item of an array".into(),
        remedy: format!("write `{}` with two brackets", section.title()),
    };
    Fault::new(problem, place)
}

fn unknown_section(document: &Document<'_>, table: &Written<'_>) -> Box<Fault> {
    let sections = document.sections;
    let meant = nearest(&table.name, sections.iter().map(|section| section.name));
    let fault = Fault::new(Problem::UnknownSection { found: table.name.clone(), meant, sections }, &table.place);
    match meant {
        Some(meant) => fault.edit(&table.place, meant),
        None => fault,
    }
}

fn stray(document: &Document<'_>, entry: &Entry<'_>) -> Box<Fault> {
    if let Some(section) = document.section(&entry.name) {
        let found = value_type(entry.value.get_ref());
        return Fault::new(Problem::NotATable { section, found }, &entry.place);
    }
    let meant = meant_anywhere(document.sections, &entry.name);
    Fault::new(Problem::KeyOutsideTables { found: entry.name.clone(), meant }, &entry.place)
}

/// Wrong names in a table: all of them, but of keys that belong to another kind the first.
fn in_table(document: &Document<'_>, section: &'static Section, table: &Written<'_>) -> Vec<Fault> {
    let kind = section.kind_key().and_then(|key| {
        let word = table.entry(key.name)?.value.get_ref().as_str()?;
        key.words().find(|known| *known == word)
    });
    let names = Names { sections: document.sections, section, kind, table };
    let mut of_other_kind = false;
    let wrong = table.entries.iter().filter_map(|entry| {
        let fault = names.wrong(entry)?;
        let is_another = matches!(fault.problem, Problem::OfOtherKind { .. });
        let is_told = is_another && of_other_kind;
        of_other_kind |= is_another;
        (!is_told).then(|| *fault.in_item(section.many.then(|| table.title())))
    });
    wrong.collect()
}

/// The names in a table.
struct Names<'d, 't> {
    sections: &'static [Section],
    section: &'static Section,
    /// The kind of the table, where it has one that is known.
    kind: Option<&'static str>,
    table: &'d Written<'t>,
}

impl Names<'_, '_> {
    /// What is wrong with the name of an entry.
    fn wrong(&self, entry: &Entry<'_>) -> Option<Box<Fault>> {
        if self.here().any(|key| key.name == entry.name) {
            return None;
        }
        let same = self.section.keys.iter().filter(|key| key.name == entry.name);
        let kinds: Vec<&str> = same.flat_map(|key| key.kinds).copied().collect();
        Some(match self.kind {
            Some(here) if !kinds.is_empty() => self.of_other_kind(entry, kinds, here),
            _ => self.unknown(entry),
        })
    }

    /// The keys that are allowed here.
    fn here(&self) -> impl Iterator<Item = &'static Key> + Clone + use<'_> {
        self.section.keys_of(self.kind)
    }

    /// Whether a key is given together with an entry. A setting takes the place of what is given; a line of the file does not.
    fn is_given(&self, key: &Key, entry: &Entry<'_>) -> bool {
        entry.place.source == 0 && self.table.entry(key.name).is_some()
    }

    fn of_other_kind(&self, entry: &Entry<'_>, kinds: Vec<&'static str>, here: &'static str) -> Box<Fault> {
        let meant = near(&entry.name, self.here().filter(|key| !self.is_given(key, entry)));
        let problem = Problem::OfOtherKind { section: self.section, found: entry.name.clone(), kinds, here, meant };
        let fault = Fault::new(problem, &entry.place).also(self.table.entry("kind").map(Entry::value_place).as_ref());
        match meant {
            Some(key) => fault.edit(&entry.place, key.name),
            None => fault,
        }
    }

    fn unknown(&self, entry: &Entry<'_>) -> Box<Fault> {
        let found = &*entry.name;
        let others = self.sections.iter().filter(|other| !other.many && other.name != self.section.name);
        let elsewhere = others.flat_map(|other| other.keys).find(|key| key.name == found && key.name != "kind");
        let in_unit = || self.here().find_map(|key| Some((key, other_unit(key, found)?)));
        if let (None, Some((key, unit))) = (elsewhere, in_unit()) {
            let fault = in_other_unit(entry, key, unit);
            return if self.is_given(key, entry) { fault.unmended() } else { fault };
        }
        let meant = elsewhere
            .or_else(|| self.here().find(|key| also_called(key, found)))
            .or_else(|| near(found, self.here()))
            .or_else(|| meant_anywhere(self.sections, found));
        let problem = Problem::UnknownKey { section: self.section, kind: self.kind, found: found.into(), meant };
        let fault = Fault::new(problem, &entry.place);
        match meant {
            Some(key) if key.section == self.section.name && !self.is_given(key, entry) => {
                fault.edit(&entry.place, key.name)
            }
            _ => fault,
        }
    }
}

fn in_other_unit(entry: &Entry<'_>, key: &'static Key, unit: &'static ForeignUnit) -> Box<Fault> {
    let given = as_float(entry.value.get_ref()).filter(|value| value.is_finite());
    let values = given.map(|value| (value, unit.convert(value)));
    let fault =
        Fault::new(Problem::OtherUnit { found: entry.name.clone(), key, unit: unit.words, values }, &entry.place);
    let fault = fault.edit(&entry.place, key.name);
    let items = match entry.value.get_ref() {
        DeValue::Array(items) => items.iter().collect(),
        _ => vec![&entry.value],
    };
    items.into_iter().fold(fault, |fault, item| {
        match as_float(item.get_ref()).map(|value| (value, unit.convert(value))) {
            Some((before, after)) if before != after && before.is_finite() => {
                fault.edit(&entry.place_of(item.span()), toml_float(after))
            }
            _ => fault,
        }
    })
}
