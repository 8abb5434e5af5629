//! A key with its value, and their places in the text.

use std::ops::Range;

use toml::Spanned;
use toml::de::DeValue;

use super::fault::TextSpan;
use super::keys::Key;

/// A key with its value.
#[derive(Clone)]
pub(super) struct Entry<'t> {
    pub name: String,
    pub place: TextSpan,
    pub value: Spanned<DeValue<'t>>,
    /// Where the text begins that the spans in `value` count from.
    pub base: TextSpan,
}

impl Entry<'static> {
    /// Creates the entry that represents a key's default.
    ///
    /// # Errors
    /// Where the default is not TOML.
    pub fn of_default(key: &Key, text: &'static str) -> Result<Self, toml::de::Error> {
        let place = TextSpan { source: 0, span: 0..0 };
        let value = DeValue::parse(text)?;
        Ok(Self { name: key.name.into(), base: place.clone(), place, value })
    }
}

impl Entry<'_> {
    /// Writes a word as the value would be written: a setting needs no quotes, which a shell would remove.
    pub fn written(&self, word: &str) -> String {
        if self.base.source == 0 { format!("\"{word}\"") } else { word.into() }
    }

    /// The span of the value in its source.
    pub fn value_place(&self) -> TextSpan {
        self.place_of(self.value.span())
    }

    /// The span of a part of the value in its source.
    pub fn place_of(&self, span: Range<usize>) -> TextSpan {
        let start = self.base.span.start;
        TextSpan { source: self.base.source, span: start + span.start..start + span.end }
    }
}
