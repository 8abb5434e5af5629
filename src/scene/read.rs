//! One entry to one value, of the type and within the limits of its key, in the form that the data of a scene have in JSON.

use serde_json::{Value, json};
use toml::Spanned;
use toml::de::DeValue;

use super::entry::Entry;
use super::fault::{Checked, Fault, TextSpan};
use super::foreign_unit;
use super::keys::{Choice, Key, Kind, Length, Limits, toml_float};
use super::nearest::nearest;
use super::problem::Problem;
use super::value::{as_float, integer_value, value_type};
use super::{regions, stage_order};
use crate::printable::breaks_a_line;

/// Most inline tables of a value: pairs of them are compared.
const MOST_TABLES: usize = 1000;

/// An item of a value, and the key and entry that it belongs to.
struct Item<'d, 't> {
    key: &'static Key,
    entry: &'d Entry<'t>,
    value: &'d Spanned<DeValue<'t>>,
}

/// The value of an entry.
pub(super) fn value(key: &'static Key, entry: &Entry<'_>) -> Checked<Value> {
    let item = Item { key, entry, value: &entry.value };
    match &key.kind {
        Kind::Word(choices) => item.word(choices).map(Value::from),
        Kind::Words(choices) => {
            let words = item.items(Length::Any)?.iter().map(|word| word.word(choices)).collect::<Checked<Vec<_>>>()?;
            if words.is_empty() { Err(item.wrong_length(0)) } else { Ok(json!(words)) }
        }
        Kind::Number(limits) => item.number(limits),
        Kind::NumberOrPair(limits) if item.is_list() => item.numbers(Length::Exactly(2), limits),
        Kind::NumberOrPair(limits) => item.number(limits),
        Kind::NumberOr(word) if entry.value.get_ref().as_str() == Some(word) => Ok(json!(word)),
        Kind::NumberOr(_) => item.number(&Limits::ANY),
        Kind::Numbers(length, limits) => item.numbers(*length, limits),
        Kind::Rows(length) => {
            let rows = item.items(Length::Any)?;
            rows.iter().map(|row| row.numbers(Length::Exactly(*length), &Limits::ANY)).collect()
        }
        Kind::Tables => item.tables(),
        Kind::Vector if item.is_list() => item.numbers(Length::Exactly(3), &Limits::ANY),
        Kind::Vector => item.number(&Limits::ANY),
        Kind::Count(limits) => item.whole(limits).map(Value::from),
        Kind::Pair(limits) if item.is_list() => {
            let items = item.items(Length::Exactly(2))?;
            match [0, 1].map(|direction| items[direction].whole(limits)) {
                [Ok(first), Ok(second)] => Ok(json!([first, second])),
                [Err(first), Err(second)] if !first.edits.is_empty() => Err(first.edits_of(*second)),
                [Err(fault), _] | [_, Err(fault)] => Err(fault),
            }
        }
        Kind::Pair(limits) => item.whole(limits).map(|both| json!([both, both])),
        Kind::Region(forms) => regions::read(key, forms, entry),
        Kind::Switch => entry.value.get_ref().as_bool().map(Value::from).ok_or_else(|| item.wrong_type()),
        Kind::Stages => stage_order::read(key, entry).map(|stages| json!(stages)),
        Kind::Text => item.text().map(Value::from),
        Kind::Texts(length) | Kind::Edges(length) => {
            let texts = item.items(*length)?.iter().map(Item::text).collect::<Checked<Vec<_>>>()?;
            if texts.is_empty() { Err(item.wrong_length(0)) } else { Ok(json!(texts)) }
        }
    }
}

impl<'d, 't> Item<'d, 't> {
    fn place(&self) -> TextSpan {
        self.entry.place_of(self.value.span())
    }

    fn fault(&self, problem: Problem) -> Box<Fault> {
        Fault::new(problem, &self.place())
    }

    fn is_list(&self) -> bool {
        self.value.get_ref().as_array().is_some()
    }

    /// Its items, if it is a list of so many.
    fn items(&self, length: Length) -> Checked<Vec<Item<'d, 't>>> {
        let DeValue::Array(items) = self.value.get_ref() else { return Err(self.wrong_type()) };
        match length {
            Length::Exactly(length) if items.len() != length => Err(self.wrong_length(items.len())),
            _ => Ok(items.iter().map(|value| Item { value, ..*self }).collect()),
        }
    }

    /// Nothing yet, if it is a list of inline tables: what they hold is read as tables are.
    fn tables(&self) -> Checked<Value> {
        let items = self.items(Length::Any)?;
        match items.iter().find(|item| item.value.get_ref().as_table().is_none()) {
            _ if items.is_empty() || items.len() > MOST_TABLES => Err(self.wrong_length(items.len())),
            Some(other) => Err(other.wrong_type()),
            None => Ok(Value::Null),
        }
    }

    fn wrong_length(&self, found: usize) -> Box<Fault> {
        self.fault(Problem::WrongLength { key: self.key, found })
    }

    fn number(&self, limits: &Limits) -> Checked<Value> {
        let key = self.key;
        let value = as_float(self.value.get_ref()).ok_or_else(|| self.wrong_type())?;
        if !value.is_finite() {
            return Err(self.fault(Problem::NotFinite { key, value }));
        }
        self.within(limits, value)?;
        Ok(json!(value + 0.0)) // −0 becomes 0: equal scenes have equal hashes
    }

    fn numbers(&self, length: Length, limits: &Limits) -> Checked<Value> {
        self.items(length)?.iter().map(|item| item.number(limits)).collect()
    }

    fn whole(&self, limits: &Limits) -> Checked<usize> {
        let key = self.key;
        let value = match self.value.get_ref() {
            DeValue::Integer(integer) => integer_value(integer),
            DeValue::Float(float) => {
                let value = float.as_str().parse().unwrap_or(f64::NAN);
                let fault = self.fault(Problem::NotWhole { key, value });
                let as_whole = value.fract() == 0.0 && limits.broken_by(value).is_none();
                return Err(if as_whole { fault.edit(&self.place(), format!("{value}")) } else { fault });
            }
            _ => return Err(self.wrong_type()),
        };
        self.within(limits, value)?;
        Ok(value as usize)
    }

    fn within(&self, limits: &Limits, value: f64) -> Checked<()> {
        match limits.broken_by(value) {
            Some(_) => Err(self.fault(Problem::OutOfRange { key: self.key, value })),
            None => Ok(()),
        }
    }

    fn word(&self, choices: &'static [Choice]) -> Checked<&'static str> {
        let found = self.value.get_ref().as_str().ok_or_else(|| self.wrong_type())?;
        let words = choices.iter().map(|choice| choice.word);
        words.clone().find(|word| *word == found).ok_or_else(|| {
            let meant = nearest(found, words);
            let fault = self.fault(Problem::UnknownWord { key: self.key, found: found.into(), meant });
            match meant {
                Some(meant) => fault.edit(&self.place(), self.entry.written(meant)),
                None => fault,
            }
        })
    }

    fn text(&self) -> Checked<&'d str> {
        let text = self.value.get_ref().as_str().ok_or_else(|| self.wrong_type())?;
        match text.chars().find(|c| breaks_a_line(*c)) {
            None => Ok(text),
            Some(character) => Err(self.fault(Problem::Unprintable { key: self.key, character })),
        }
    }

    /// The error for a value of another type, with the value that was most likely meant.
    fn wrong_type(&self) -> Box<Fault> {
        let (key, value) = (self.key, self.value.get_ref());
        let fault = self.fault(Problem::WrongType { key, found: value_type(value) });
        let meant = match (&key.kind, value) {
            (Kind::Number(limits) | Kind::NumberOrPair(limits) | Kind::Numbers(_, limits), DeValue::String(text)) => {
                self.quantity(text, limits)
            }
            (Kind::NumberOr(word), DeValue::String(text)) => self
                .quantity(text, &Limits::ANY)
                .or_else(|| nearest(text, [*word].into_iter()).map(|word| self.entry.written(word))),
            (Kind::Count(limits) | Kind::Pair(limits), DeValue::String(text)) => {
                let whole = text.trim().parse::<u32>().ok();
                whole.filter(|n| limits.broken_by(f64::from(*n)).is_none()).map(|n| n.to_string())
            }
            (Kind::Words(choices), DeValue::String(text)) => {
                choices.iter().find(|choice| choice.word == text).map(|choice| format!("[\"{}\"]", choice.word))
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
            Some(meant) => fault.edit(&self.place(), meant),
            None => fault,
        }
    }

    /// A number in quotes, perhaps with a unit, in the unit of the key.
    fn quantity(&self, text: &str, limits: &Limits) -> Option<String> {
        let value = foreign_unit::quantity(text, self.key.unit)?;
        (limits.broken_by(value).is_none() && value.is_finite()).then(|| toml_float(value))
    }
}
