//! What was meant by a wrong name: a key of another table, one with another unit, a symbol, a slip of the finger.

use super::fault::{Fault, Place};
use super::foreign_unit::ForeignUnit;
use super::help::GENERAL;
use super::key_table::KEYS;
use super::keys::{Key, Presence, Unit};
use super::nearest::{LONGEST_NAME, nearest, plain, slip};
use super::problem::Problem;

/// The key of this path.
pub(super) fn key(path: &str) -> Option<&'static Key> {
    KEYS.iter().copied().find(|key| key.path() == path)
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
pub(super) fn meant_anywhere(found: &str) -> Option<&'static Key> {
    let keys = || KEYS.iter().copied().filter(|key| key.name != "kind");
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
