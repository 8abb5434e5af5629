//! What was meant by a wrong name: a key of another table, one with another unit, a symbol, a slip of the finger.

use super::fault::{Fault, TextSpan};
use super::foreign_unit::ForeignUnit;
use super::keys::{Key, Presence, Section, Unit};
use super::nearest::{LONGEST_NAME, nearest, plain, slip};
use super::problem::Problem;

/// The key of this path.
pub(super) fn key(sections: &'static [Section], path: &str) -> Option<&'static Key> {
    of_settings(sections).find(|key| key.path() == path)
}

/// Keys that a setting can name: those of tables of which there is one.
fn of_settings(sections: &'static [Section]) -> impl Iterator<Item = &'static Key> + Clone {
    sections.iter().filter(|section| !section.many).flat_map(|section| section.keys)
}

/// The error for a setting such as `max_iterations=200`.
pub(super) fn setting_without_section(sections: &'static [Section], found: &str, place: &TextSpan) -> Box<Fault> {
    let meant = meant_anywhere(sections, found);
    let fault = Fault::new(Problem::SettingWithoutSection { found: found.into(), meant }, place);
    match meant {
        Some(key) => fault.edit(place, key.path()),
        None => fault,
    }
}

/// The keys of the same table that a key puts out of force.
pub(super) fn stands_in_for(section: &'static Section, name: &str) -> Vec<&'static str> {
    let keys = section.keys.iter();
    keys.filter_map(|key| match key.presence {
        Presence::InsteadOf(other) if key.name == name => Some(other),
        Presence::InsteadOf(other) if other == name => Some(key.name),
        _ => None,
    })
    .collect()
}

/// The key of any table that a name most likely means.
pub(super) fn meant_anywhere(sections: &'static [Section], found: &str) -> Option<&'static Key> {
    let keys = || of_settings(sections).filter(|key| key.name != "kind");
    keys()
        .find(|key| key.name == found || key.path() == found)
        .or_else(|| keys().find(|key| also_called(key, found) || other_unit(key, found).is_some()))
        .or_else(|| near(found, keys()))
}

/// Whether people call a key so, with or without its unit.
pub(super) fn also_called(key: &Key, found: &str) -> bool {
    let found = plain(found);
    let with_unit = |alias: &&str| found == **alias || found == format!("{alias}_{}", key.unit.suffix());
    key.aliases.iter().any(with_unit) || found == key.stem()
}

/// The unit that `found` ends in where it is `key` with another unit (and perhaps a slip in front of it).
pub(super) fn other_unit(key: &Key, found: &str) -> Option<&'static ForeignUnit> {
    if key.unit == Unit::None || found.len() > LONGEST_NAME {
        return None;
    }
    let found = plain(found);
    let splits = found.match_indices('_').map(|(at, _)| (&found[..at], &found[at + 1..]));
    splits
        .filter(|(stem, unit)| *unit != key.unit.suffix() && (slip(stem, key.stem()) || key.aliases.contains(stem)))
        .find_map(|(_, unit)| ForeignUnit::find(unit, key.unit))
}

/// The key whose name is nearest.
pub(super) fn near(found: &str, keys: impl Iterator<Item = &'static Key> + Clone) -> Option<&'static Key> {
    let name = nearest(found, keys.clone().map(|key| key.name))?;
    keys.into_iter().find(|key| key.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::key_table::all_keys;

    #[test]
    fn each_alias_leads_to_its_key_and_is_no_key_itself() {
        for (key, other) in all_keys().flat_map(|key| all_keys().map(move |other| (key, other))) {
            let beside = key.section == other.section
                && (key.kinds.is_empty()
                    || other.kinds.is_empty()
                    || key.kinds.iter().any(|kind| other.belongs_to(kind)));
            for alias in key.aliases.iter().filter(|_| beside) {
                assert_eq!(*alias, plain(alias), "{alias} can never be found");
                assert!(other.name != *alias, "{alias} is both a key and an alias of {}", key.path());
                let rivals = other.name != key.name && other.aliases.contains(alias);
                assert!(!rivals, "{alias} is an alias of {} and of {}", key.path(), other.path());
            }
        }
    }
}
