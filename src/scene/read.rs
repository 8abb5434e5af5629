//! One entry to one value, of the type and within the limits of its key.

use std::cell::RefCell;

use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::DeValue;

use super::document::Document;
use super::entry::Entry;
use super::fault::{Checked, Fault, Place};
use super::foreign_unit;
use super::keys::{Key, Kind, Limits, Presence, toml_float};
use super::nearest::nearest;
use super::problem::Problem;
use super::value::{as_float, integer_value, value_type};

/// A value, and where it stands.
pub(super) struct Found<T> {
    pub value: T,
    /// `None` where it is a default.
    pub place: Option<Place>,
}

/// Reads values of keys.
pub(super) struct Reader<'d, 't> {
    pub document: &'d Document<'t>,
    /// Paths of the keys asked for, so that a test can hold them against the table.
    asked: RefCell<Vec<String>>,
}

impl<'d, 't> Reader<'d, 't> {
    pub fn new(document: &'d Document<'t>) -> Self {
        Self { document, asked: RefCell::default() }
    }

    /// The keys asked for so far.
    #[cfg(test)]
    pub fn asked(&self) -> Vec<String> {
        self.asked.borrow().clone()
    }

    /// The entry of a key, if it is given.
    pub fn entry(&self, key: &Key) -> Option<&'d Entry<'t>> {
        self.asked.borrow_mut().push(key.path());
        self.document.entry(key.section, key.name)
    }

    /// A number.
    pub fn number(&self, key: &'static Key) -> Checked<Found<f64>> {
        self.read(key, |entry| number(key, entry))
    }

    /// A number that may be left out.
    pub fn maybe_number(&self, key: &'static Key) -> Checked<Option<f64>> {
        self.entry(key).map(|entry| number(key, entry)).transpose()
    }

    /// A whole number.
    pub fn count(&self, key: &'static Key) -> Checked<Found<usize>> {
        let Kind::Count(limits) = &key.kind else { unreachable!("{} is not a count", key.path()) };
        self.read(key, |entry| whole(key, limits, entry, &entry.value))
    }

    /// Two whole numbers, or one for both.
    pub fn pair(&self, key: &'static Key) -> Checked<Found<[usize; 2]>> {
        let Kind::Pair(limits) = &key.kind else { unreachable!("{} is not a pair", key.path()) };
        self.read(key, |entry| match entry.value.get_ref() {
            DeValue::Array(items) if items.len() == 2 => {
                match [0, 1].map(|way| whole(key, limits, entry, &items[way])) {
                    [Ok(first), Ok(second)] => Ok([first, second]),
                    [Err(first), Err(second)] if !first.edits.is_empty() => Err(first.edits_of(*second)),
                    [Err(fault), _] | [_, Err(fault)] => Err(fault),
                }
            }
            DeValue::Array(items) => {
                Err(Fault::new(Problem::NotAPair { key, found: items.len() }, &entry.value_place()))
            }
            _ => whole(key, limits, entry, &entry.value).map(|both| [both; 2]),
        })
    }

    /// One of the words of a key.
    pub fn word<T: DeserializeOwned>(&self, key: &'static Key) -> Checked<Found<T>> {
        let word = self.bare_word(key)?;
        let value = serde_json::Value::String(word.value.into());
        let value = serde_json::from_value(value).unwrap_or_else(|_| unreachable!("{} has other words", key.path()));
        Ok(Found { value, place: word.place })
    }

    /// One of the words of a key, as it stands in the key's table.
    pub fn bare_word(&self, key: &'static Key) -> Checked<Found<&'static str>> {
        self.read(key, |entry| known_word(key, entry))
    }

    /// true or false.
    pub fn switch(&self, key: &'static Key) -> Checked<Found<bool>> {
        self.read(key, |entry| entry.value.get_ref().as_bool().ok_or_else(|| wrong_type(key, entry)))
    }

    /// Text that may be left out.
    pub fn maybe_text(&self, key: &'static Key) -> Checked<Option<String>> {
        let read = |entry: &'d Entry<'t>| {
            entry.value.get_ref().as_str().map(str::to_owned).ok_or_else(|| wrong_type(key, entry))
        };
        self.entry(key).map(read).transpose()
    }

    /// The value of an entry, or else the default through the same checks.
    fn read<T>(&self, key: &'static Key, convert: impl Fn(&Entry<'_>) -> Checked<T>) -> Checked<Found<T>> {
        if let Some(entry) = self.entry(key) {
            return Ok(Found { value: convert(entry)?, place: Some(entry.value_place()) });
        }
        let Presence::Default(text) = key.presence else { return Err(self.missing(key)) };
        let Ok(entry) = Entry::of_default(key, text) else { unreachable!("the default of {} is no TOML", key.path()) };
        Ok(Found { value: convert(&entry)?, place: None })
    }

    fn missing(&self, key: &'static Key) -> Box<Fault> {
        let Some(header) = self.document.header(key.section) else {
            return Fault::new(Problem::MissingKey { key }, &self.document.end);
        };
        let fault = Fault::new(Problem::MissingKey { key }, &header.place);
        match self.document.line_end(header) {
            Some(end) => fault.edit(&end, format!("\n{} = {}", key.name, key.example)),
            None => fault,
        }
    }
}

/// The value of an entry as one of the words of its key.
pub(super) fn known_word(key: &'static Key, entry: &Entry<'_>) -> Checked<&'static str> {
    let Kind::Word(choices) = &key.kind else { unreachable!("{} is not a word", key.path()) };
    let place = entry.value_place();
    let found = entry.value.get_ref().as_str().ok_or_else(|| wrong_type(key, entry))?;
    let words = choices.iter().map(|choice| choice.word);
    words.clone().find(|word| *word == found).ok_or_else(|| {
        let meant = nearest(found, words);
        let fault = Fault::new(Problem::UnknownWord { key, found: found.into(), meant }, &place);
        match meant {
            Some(meant) => fault.edit(&place, entry.written(meant)),
            None => fault,
        }
    })
}

fn number(key: &'static Key, entry: &Entry<'_>) -> Checked<f64> {
    let Kind::Number(limits) = &key.kind else { unreachable!("{} is not a number", key.path()) };
    let value = as_float(entry.value.get_ref()).ok_or_else(|| wrong_type(key, entry))?;
    if !value.is_finite() {
        return Err(Fault::new(Problem::NotFinite { key, value }, &entry.value_place()));
    }
    within(key, limits, value, &entry.value_place())?;
    Ok(value + 0.0) // −0 becomes 0: equal scenes have equal hashes
}

fn whole(key: &'static Key, limits: &Limits, entry: &Entry<'_>, item: &Spanned<DeValue<'_>>) -> Checked<usize> {
    let place = entry.place_of(item.span());
    let value = match item.get_ref() {
        DeValue::Integer(integer) => integer_value(integer),
        DeValue::Float(float) => {
            let value = float.as_str().parse().unwrap_or(f64::NAN);
            let fault = Fault::new(Problem::NotWhole { key, value }, &place);
            let as_whole = value.fract() == 0.0 && limits.broken_by(value).is_none();
            return Err(if as_whole { fault.edit(&place, format!("{value}")) } else { fault });
        }
        other => return Err(wrong_type_at(key, other, &place)),
    };
    within(key, limits, value, &place)?;
    Ok(value as usize)
}

fn within(key: &'static Key, limits: &Limits, value: f64, place: &Place) -> Checked<()> {
    match limits.broken_by(value) {
        Some(_) => Err(Fault::new(Problem::OutOfRange { key, value }, place)),
        None => Ok(()),
    }
}

fn wrong_type(key: &'static Key, entry: &Entry<'_>) -> Box<Fault> {
    wrong_type_at(key, entry.value.get_ref(), &entry.value_place())
}

/// The error for a value of another type, with the value that was most likely meant.
fn wrong_type_at(key: &'static Key, value: &DeValue<'_>, place: &Place) -> Box<Fault> {
    let fault = Fault::new(Problem::WrongType { key, found: value_type(value) }, place);
    let meant = match (&key.kind, value) {
        (Kind::Number(limits), DeValue::String(text)) => foreign_unit::quantity(text, key.unit)
            .filter(|value| limits.broken_by(*value).is_none() && value.is_finite())
            .map(toml_float),
        (Kind::Count(limits) | Kind::Pair(limits), DeValue::String(text)) => {
            text.trim().parse::<u32>().ok().filter(|n| limits.broken_by(f64::from(*n)).is_none()).map(|n| n.to_string())
        }
        (Kind::Switch, DeValue::String(text)) => match text.trim().to_lowercase().as_str() {
            "true" | "yes" | "on" | "1" => Some("true".into()),
            "false" | "no" | "off" | "0" => Some("false".into()),
            _ => None,
        },
        (Kind::Switch, DeValue::Integer(number)) => match number.as_str() {
            "1" => Some("true".into()),
            "0" => Some("false".into()),
            _ => None,
        },
        _ => None,
    };
    match meant {
        Some(meant) => fault.edit(place, meant),
        None => fault,
    }
}
