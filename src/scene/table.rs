//! One table of a scene file whose keys depend on its `kind`, read key by key. What is left over at the end is a mistake.

use std::cell::RefCell;

use toml::Spanned;
use toml::de::DeValue;

use super::entry::Entry;
use super::fault::{Checked, Fault, Place};
use super::keys::number;
use super::meant;
use super::nearest::nearest;
use super::problem::Problem;
use super::value::{as_float, value_type};
use crate::printable::breaks_a_line;

/// The entries of one table.
pub(super) struct Table<'d, 't> {
    /// What errors call it: `[geometry]`, `[[support]] 2`.
    pub title: String,
    /// Where it begins.
    pub place: Place,
    entries: Vec<&'d Entry<'t>>,
    asked: RefCell<Vec<&'static str>>,
}

/// An interval of allowed numbers with a reason for it.
#[derive(Clone, Copy)]
pub(super) struct Range {
    /// Greater than this.
    pub above: f64,
    /// At most this.
    pub most: f64,
    /// Why.
    pub reason: &'static str,
}

/// Any finite number.
pub(super) const ANY: Range = Range { above: f64::NEG_INFINITY, most: f64::INFINITY, reason: "" };

/// Lengths of a shell, mm.
pub(super) const LENGTH: Range =
    Range { above: 0.0, most: 1e6, reason: "lengths are positive, in mm, and at most a kilometre" };

impl<'d, 't> Table<'d, 't> {
    pub fn new(title: String, place: Place, entries: Vec<&'d Entry<'t>>) -> Self {
        Self { title, place, entries, asked: RefCell::default() }
    }

    /// An error about this table.
    pub fn wrong(&self, place: Option<&Place>, problem: impl Into<String>, remedy: impl Into<String>) -> Box<Fault> {
        let problem = Problem::Table { table: self.title.clone(), problem: problem.into(), remedy: remedy.into() };
        Fault::new(problem, place.unwrap_or(&self.place))
    }

    /// The entry of a key, if it is given.
    pub fn entry(&self, name: &'static str) -> Option<&'d Entry<'t>> {
        self.asked.borrow_mut().push(name);
        self.entries.iter().find(|entry| entry.name == name).copied()
    }

    /// Where a key's value stands.
    pub fn place_of(&self, name: &str) -> Option<Place> {
        self.entries.iter().find(|entry| entry.name == name).map(|entry| entry.value_place())
    }

    fn required(&self, name: &'static str, example: &str) -> Checked<&'d Entry<'t>> {
        self.entry(name).ok_or_else(|| self.missing(name, format!("write for example `{name} = {example}`")))
    }

    /// The error for a key that is not there. One that is no key at all most likely stands in its place, and is told first.
    pub fn missing(&self, name: &str, remedy: impl Into<String>) -> Box<Fault> {
        let remedy = remedy.into();
        let asked = self.asked.borrow();
        let known = |entry: &Entry<'_>| asked.contains(&entry.name.as_str()) || meant::is_known(&entry.name);
        match self.entries.iter().find(|entry| !known(entry)) {
            None => self.wrong(None, format!("`{name}` is missing"), remedy),
            Some(stray) => {
                let meant = nearest(&stray.name, std::iter::once(name));
                let remedy = match meant {
                    Some(_) => format!("perhaps `{name}` is meant, which is missing: {remedy}"),
                    None => format!("take it out; `{name}` is missing: {remedy}"),
                };
                self.wrong(Some(&stray.place), format!("`{}` is no key of it", stray.name), remedy)
            }
        }
    }

    fn not_a(&self, entry: &Entry<'_>, wanted: &str) -> Box<Fault> {
        let found = value_type(entry.value.get_ref());
        let found = super::explain::type_words(found);
        self.wrong(Some(&entry.value_place()), format!("`{}` must be {wanted}, not {found}", entry.name), "")
    }

    fn checked(&self, entry: &Entry<'_>, item: &Spanned<DeValue<'_>>, range: Range, wanted: &str) -> Checked<f64> {
        let place = entry.place_of(item.span());
        let value = as_float(item.get_ref()).ok_or_else(|| self.not_a(entry, wanted))?;
        if !value.is_finite() {
            return Err(self.wrong(Some(&place), format!("`{}` must be a finite number", entry.name), ""));
        }
        if value <= range.above || value > range.most {
            let problem = format!("`{}` cannot be {}", entry.name, number(value));
            return Err(self.wrong(Some(&place), problem, range.reason));
        }
        Ok(value + 0.0)
    }

    /// A number.
    pub fn number(&self, name: &'static str, range: Range, example: &str) -> Checked<f64> {
        let entry = self.required(name, example)?;
        self.checked(entry, &entry.value, range, "a number")
    }

    /// A number that may be left out.
    pub fn number_or(&self, name: &'static str, range: Range, default: f64) -> Checked<f64> {
        Ok(self.maybe_number(name, range)?.unwrap_or(default))
    }

    /// A number, if it is given.
    pub fn maybe_number(&self, name: &'static str, range: Range) -> Checked<Option<f64>> {
        self.entry(name).map(|entry| self.checked(entry, &entry.value, range, "a number")).transpose()
    }

    /// Items of a list.
    fn items(&self, entry: &'d Entry<'t>, wanted: &str) -> Checked<Vec<&'d Spanned<DeValue<'t>>>> {
        match entry.value.get_ref() {
            DeValue::Array(items) => Ok(items.iter().collect()),
            _ => Err(self.not_a(entry, wanted)),
        }
    }

    /// A list of numbers, if it is given.
    pub fn maybe_numbers(&self, name: &'static str) -> Checked<Option<Vec<f64>>> {
        let Some(entry) = self.entry(name) else { return Ok(None) };
        let items = self.items(entry, "a list of numbers")?;
        items
            .into_iter()
            .map(|item| self.checked(entry, item, ANY, "a list of numbers"))
            .collect::<Checked<_>>()
            .map(Some)
    }

    /// A fixed count of numbers, if they are given.
    pub fn maybe_tuple<const N: usize>(&self, name: &'static str, example: &str) -> Checked<Option<[f64; N]>> {
        let Some(values) = self.maybe_numbers(name)? else { return Ok(None) };
        <[f64; N]>::try_from(values.as_slice()).map(Some).map_err(|_| {
            let problem = format!("`{name}` must be a list of {N} numbers, and holds {}", values.len());
            self.wrong(self.place_of(name).as_ref(), problem, format!("write for example `{name} = {example}`"))
        })
    }

    /// A fixed count of numbers.
    pub fn tuple<const N: usize>(&self, name: &'static str, example: &str) -> Checked<[f64; N]> {
        self.required(name, example)?;
        self.maybe_tuple(name, example)?.ok_or_else(|| self.wrong(None, format!("`{name}` is missing"), ""))
    }

    /// Rows of a fixed count of numbers, if they are given.
    pub fn maybe_rows<const N: usize>(&self, name: &'static str, example: &str) -> Checked<Option<Vec<[f64; N]>>> {
        let Some(entry) = self.entry(name) else { return Ok(None) };
        let wanted = format!("a list of lists of {N} numbers");
        let mut rows = Vec::new();
        for item in self.items(entry, &wanted)? {
            let DeValue::Array(numbers) = item.get_ref() else { return Err(self.not_a(entry, &wanted)) };
            let place = entry.place_of(item.span());
            let values: Vec<f64> =
                numbers.iter().map(|item| self.checked(entry, item, ANY, &wanted)).collect::<Checked<_>>()?;
            rows.push(<[f64; N]>::try_from(values.as_slice()).map_err(|_| {
                let problem = format!("`{name}` must be {wanted}, and one has {}", values.len());
                self.wrong(Some(&place), problem, format!("write for example `{name} = {example}`"))
            })?);
        }
        Ok(Some(rows))
    }

    /// Text, if it is given.
    pub fn maybe_text(&self, name: &'static str) -> Checked<Option<String>> {
        let Some(entry) = self.entry(name) else { return Ok(None) };
        let text = entry.value.get_ref().as_str().ok_or_else(|| self.not_a(entry, "text in quotes"))?;
        match text.chars().find(|c| breaks_a_line(*c)) {
            None => Ok(Some(text.to_owned())),
            Some(c) => {
                let problem = format!("`{name}` holds the character U+{:04X}, which cannot be seen", u32::from(c));
                Err(self.wrong(self.place_of(name).as_ref(), problem, "names are one line of ordinary characters"))
            }
        }
    }

    /// One of some words, if it is given.
    pub fn maybe_word<T: Copy>(&self, name: &'static str, words: &[(&'static str, T)]) -> Checked<Option<T>> {
        let Some(text) = self.maybe_text(name)? else { return Ok(None) };
        words.iter().find(|(word, _)| *word == text).map(|(_, value)| Some(*value)).ok_or_else(|| {
            let all: Vec<String> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
            let meant = nearest(&text, words.iter().map(|(word, _)| *word));
            let remedy = match meant {
                Some(meant) => format!("perhaps \"{meant}\" is meant; allowed are {}", all.join(", ")),
                None => format!("allowed are {}", all.join(", ")),
            };
            self.wrong(self.place_of(name).as_ref(), format!("`{name}` cannot be \"{text}\""), remedy)
        })
    }

    /// One of some words.
    pub fn word<T: Copy>(&self, name: &'static str, words: &[(&'static str, T)]) -> Checked<T> {
        let example = words.first().map_or("", |(word, _)| word);
        self.required(name, &format!("\"{example}\""))?;
        self.maybe_word(name, words)?.ok_or_else(|| self.wrong(None, format!("`{name}` is missing"), ""))
    }

    /// true or false.
    pub fn switch_or(&self, name: &'static str, default: bool) -> Checked<bool> {
        let Some(entry) = self.entry(name) else { return Ok(default) };
        entry.value.get_ref().as_bool().ok_or_else(|| self.not_a(entry, "true or false"))
    }

    /// A list of words, if it is given.
    pub fn maybe_words(&self, name: &'static str) -> Checked<Option<Vec<String>>> {
        let Some(entry) = self.entry(name) else { return Ok(None) };
        let wanted = "a list of words in quotes";
        let text = |item: &Spanned<DeValue<'_>>| item.get_ref().as_str().map(str::to_owned);
        let words =
            self.items(entry, wanted)?.into_iter().map(|item| text(item).ok_or_else(|| self.not_a(entry, wanted)));
        words.collect::<Checked<_>>().map(Some)
    }

    /// Refuses keys that nobody asked for.
    pub fn finish(self) -> Checked<()> {
        let asked = self.asked.borrow().clone();
        let Some(extra) = self.entries.iter().find(|entry| !asked.contains(&entry.name.as_str())) else {
            return Ok(());
        };
        let given = |name: &&&'static str| self.entries.iter().any(|entry| entry.name == **name);
        let open = || asked.iter().filter(|name| !given(name)).copied();
        let mut all: Vec<String> = asked.iter().map(|name| format!("`{name}`")).collect();
        all.sort();
        all.dedup();
        let remedy = match nearest(&extra.name, open()) {
            Some(meant) => format!("perhaps `{meant}` is meant; the keys here are {}", all.join(", ")),
            None => format!("the keys here are {}", all.join(", ")),
        };
        Err(self.wrong(Some(&extra.place), format!("`{}` is no key of it", extra.name), remedy))
    }
}
