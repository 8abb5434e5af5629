//! The parts of an explanation, and words that several of them use.

use crate::printable::printable;
use crate::scene::keys::{Key, join_or};
use crate::scene::problem::ValueType;

/// The texts around an annotated snippet: title, label, notes and help.
#[derive(Debug, Default)]
pub struct Explanation {
    /// The problem in one line.
    pub title: String,
    /// Beside the offending text.
    pub label: String,
    /// Beside the second place, where there is one.
    pub also: String,
    /// A note where there is no second place.
    pub alone: String,
    /// Below the snippet: why it is a problem, what is allowed.
    pub notes: Vec<String>,
    /// What to do.
    pub help: Vec<String>,
    /// What to do, where no mended text can be shown.
    pub example: String,
    /// Above the mended text, where it can be shown.
    pub fix: String,
}

impl Explanation {
    /// Creates an explanation with a title, and a label for the marked text.
    pub fn new(title: impl Into<String>, label: impl Into<String>) -> Self {
        Self { title: title.into(), label: label.into(), ..Self::default() }
    }

    /// Makes all texts printable, since words of the scene are quoted in them.
    pub fn printable(self) -> Self {
        let Self { title, label, also, alone, notes, help, example, fix } = self;
        let plain = |text: String| printable(&text).into_owned();
        let all = |texts: Vec<String>| texts.into_iter().map(plain).collect();
        Self {
            title: plain(title),
            label: plain(label),
            also: plain(also),
            alone: plain(alone),
            notes: all(notes),
            help: all(help),
            example: plain(example),
            fix: plain(fix),
        }
    }

    /// Adds a label for the second marked text.
    pub fn also(mut self, text: impl Into<String>) -> Self {
        self.also = text.into();
        self
    }

    /// Sets a note that is shown where there is no second marked text.
    pub fn alone(mut self, text: impl Into<String>) -> Self {
        self.alone = text.into();
        self
    }

    /// Adds a note: why it is a problem.
    pub fn note(mut self, text: impl Into<String>) -> Self {
        self.notes.push(text.into());
        self
    }

    /// Adds a line of help: what to do.
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help.push(text.into());
        self
    }

    /// Sets an example of what to write.
    pub fn example(mut self, text: impl Into<String>) -> Self {
        self.example = text.into();
        self
    }

    /// Sets the heading of the suggested edits.
    pub fn fix(mut self, text: impl Into<String>) -> Self {
        self.fix = text.into();
        self
    }
}

/// Names a table in a sentence: by its name in brackets, or as `item` where there may be several.
pub fn table(section: &str, item: Option<&str>) -> String {
    item.map_or_else(|| format!("[{section}]"), str::to_owned)
}

/// Names a key at the beginning of a sentence: `mesh.degree`, or with the table `item` that holds it.
pub fn subject(key: &Key, item: Option<&str>) -> String {
    item.map_or_else(|| format!("`{}`", key.path()), |item| format!("{item}: `{}`", key.name))
}

/// The hint for names to which no known one is near.
pub const ALL_KEYS: &str = "`foldline help scene` lists every key";

/// Names the type of a value.
pub fn type_words(found: ValueType) -> &'static str {
    match found {
        ValueType::Text => "text",
        ValueType::Integer => "a whole number",
        ValueType::Float => "a number",
        ValueType::Boolean => "true or false",
        ValueType::Date => "a date or time",
        ValueType::Array => "a list",
        ValueType::Table => "a table",
    }
}

/// Joins items in a sentence: `a, b and c`.
pub fn join_and(names: &[String]) -> String {
    match names {
        [rest @ .., last] if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => join_or(names),
    }
}

/// Turns a meaning from the table of keys into a part of a sentence.
pub fn lower(meaning: &str) -> String {
    let meaning = meaning.trim_end_matches('.');
    let mut letters = meaning.chars();
    let is_name = meaning.starts_with("Young") || meaning.starts_with("Poisson") || meaning.starts_with("Newton");
    let first = letters.next().filter(|_| !is_name);
    first.map_or_else(|| meaning.to_owned(), |first| first.to_lowercase().chain(letters).collect())
}

/// Shortens a text of the scene to what fits into a line.
pub fn shorten(text: &str) -> String {
    const LONGEST: usize = 40;
    let line: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    if line.chars().count() <= LONGEST {
        return line;
    }
    line.chars().take(LONGEST).collect::<String>() + "..."
}
