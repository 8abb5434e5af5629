//! Wrong names, and what was meant by them: a name of another table, one with another unit, a symbol, a slip of the
//! finger.

use super::document::{Document, Entry, Header};
use super::error::{Checked, Fault, Place, Problem};
use super::foreign_unit::ForeignUnit;
use super::general::{ARRAYS, kinds_with};
use super::help::GENERAL;
use super::key_table::{KEYS, SECTIONS};
use super::keys::{Key, Presence, Section, Unit, join_or, toml_float};
use super::read;

/// Bytes beyond which no name is compared with.
const LONGEST_NAME: usize = 64;

/// A name is a slip for another where at most one letter in this many differs (but always where one does).
const LETTERS_PER_SLIP: usize = 3;

/// Letters from which on a part of a name is taken for the whole.
const LEAST_PART: usize = 4;

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

/// The key of this path.
pub(super) fn key(path: &str) -> Option<&'static Key> {
    KEYS.iter().copied().find(|key| key.path() == path)
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
        let found = read::value_type(entry.value.get_ref());
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
        && let Err(fault) = read::known_word(key, kind)
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

/// Whether the help text of tables with kinds of their own names a key: with a value behind it, or in a list of them.
pub(super) fn is_known(name: &str) -> bool {
    let part_of_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    GENERAL.match_indices(name).any(|(at, _)| {
        let (before, after) = (&GENERAL[..at], &GENERAL[at + name.len()..]);
        let whole = !before.ends_with(part_of_name) && !after.starts_with(part_of_name);
        whole && (name.contains('_') || after.trim_start().starts_with('='))
    })
}

fn in_other_unit(entry: &Entry<'_>, key: &'static Key, unit: &'static ForeignUnit) -> Box<Fault> {
    let given = read::as_float(entry.value.get_ref()).filter(|value| value.is_finite());
    let values = given.map(|value| (value, unit.convert(value)));
    let problem = Problem::OtherUnit { found: entry.name.clone(), key, unit: unit.words, values };
    let fault = Fault::new(problem, &entry.place).edit(&entry.place, key.name);
    match values {
        Some((before, after)) if before != after => fault.edit(&entry.value_place(), toml_float(after)),
        _ => fault,
    }
}

/// The error for a setting such as `max_iterations=200`.
pub(super) fn setting_without_section(found: &str, place: &Place) -> Box<Fault> {
    let meant = meant_anywhere(found);
    let fault = Fault::new(Problem::SettingWithoutSection { found: found.into(), meant }, place);
    match meant {
        Some(key) => fault.edit(place, key.path()),
        None => fault,
    }
}

/// The keys of the same table that a key puts out of force.
pub(super) fn stands_in_for(section: &str, name: &str) -> Vec<&'static str> {
    let of_section = KEYS.iter().filter(|key| key.section == section);
    of_section
        .filter_map(|key| match key.presence {
            Presence::InsteadOf(other) if key.name == name => Some(other),
            Presence::InsteadOf(other) if other == name => Some(key.name),
            _ => None,
        })
        .collect()
}

/// The key of any table that a name most likely means.
fn meant_anywhere(found: &str) -> Option<&'static Key> {
    let keys = || KEYS.iter().copied().filter(|key| key.name != "kind");
    keys()
        .find(|key| key.name == found || key.path() == found)
        .or_else(|| keys().find(|key| also_called(key, found) || other_unit(key, found).is_some()))
        .or_else(|| near(found, keys()))
}

fn also_called(key: &Key, found: &str) -> bool {
    let found = plain(found);
    let with_unit = |alias: &&str| found == **alias || found == format!("{alias}_{}", key.unit.suffix());
    key.aliases.iter().any(with_unit) || found == key.stem()
}

/// The unit that `found` ends in where it is `key` with another unit (and perhaps a slip in front of it).
fn other_unit(key: &Key, found: &str) -> Option<&'static ForeignUnit> {
    if key.unit == Unit::None || found.len() > LONGEST_NAME {
        return None;
    }
    let found = plain(found);
    let splits = found.match_indices('_').map(|(at, _)| (&found[..at], &found[at + 1..]));
    splits
        .filter(|(stem, unit)| *unit != key.unit.suffix() && (slip(stem, key.stem()) || key.aliases.contains(stem)))
        .find_map(|(_, unit)| ForeignUnit::find(unit, key.unit))
}

fn near(found: &str, keys: impl Iterator<Item = &'static Key> + Clone) -> Option<&'static Key> {
    let name = nearest(found, keys.clone().map(|key| key.name))?;
    keys.into_iter().find(|key| key.name == name)
}

/// The nearest of some right spellings, if any is near.
pub(super) fn nearest<'n>(found: &str, names: impl Iterator<Item = &'n str> + Clone) -> Option<&'n str> {
    if found.len() > LONGEST_NAME {
        return None;
    }
    let wanted = plain(found);
    let distance = |name: &str| strsim::osa_distance(&wanted, &plain(name));
    let slips = names.clone().filter(|name| slip(&wanted, &plain(name)));
    slips.min_by_key(|name| distance(name)).or_else(|| {
        // No slip: perhaps a part of a longer name, if of one only.
        let part = |name: &&str| {
            let name = plain(name);
            wanted.len() >= LEAST_PART && name.contains(&wanted) || name.len() >= LEAST_PART && wanted.contains(&name)
        };
        let mut parts = names.filter(part);
        let first = parts.next()?;
        parts.next().is_none().then_some(first)
    })
}

fn slip(found: &str, name: &str) -> bool {
    let allowed = (found.chars().count().max(name.chars().count()) / LETTERS_PER_SLIP).max(1);
    found.len() > 1 && strsim::osa_distance(found, name) <= allowed
}

/// A name without what people write in different ways.
fn plain(name: &str) -> String {
    name.trim().to_lowercase().replace(['-', ' '], "_").replace('\'', "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_parts_and_writings_find_the_name() {
        let words = || ["half-length", "half-arc", "quarter", "none"].into_iter();
        assert_eq!(nearest("quater", words()), Some("quarter"));
        assert_eq!(nearest("Half_Length", words()), Some("half-length"));
        assert_eq!(nearest("length", words()), Some("half-length"));
        assert_eq!(nearest("half", words()), None, "two names begin so");
        assert_eq!(nearest("banana", words()), None);
    }

    #[test]
    fn each_alias_leads_to_its_key_and_is_no_key_itself() {
        for key in KEYS {
            for alias in key.aliases {
                assert_eq!(*alias, plain(alias), "{alias} can never be found");
                let clash = KEYS.iter().find(|other| other.section == key.section && other.name == *alias);
                assert!(clash.is_none(), "{alias} is both a key and an alias of {}", key.path());
                let rival = KEYS.iter().find(|other| {
                    other.section == key.section && other.name != key.name && other.aliases.contains(alias)
                });
                assert!(
                    rival.is_none(),
                    "{alias} is an alias of {} and of {}",
                    key.path(),
                    rival.unwrap_or(&key).path()
                );
            }
        }
    }
}
