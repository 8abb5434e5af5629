//! A problem, and its place in the text.

use std::ops::Range;

use super::problem::Problem;

/// A problem, its place, and the edits that would mend it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fault {
    pub problem: Problem,
    /// The table that holds it, where there may be several of its name.
    pub item: Option<String>,
    pub place: TextSpan,
    /// A second place that is part of the problem.
    pub also: Option<TextSpan>,
    /// Further places, in the same source, that are as much at fault.
    pub others: Vec<TextSpan>,
    /// Replacements that mend it.
    pub edits: Vec<(TextSpan, String)>,
}

impl Fault {
    /// Creates a fault at a span of text.
    pub fn new(problem: Problem, place: &TextSpan) -> Box<Self> {
        Box::new(Self { problem, item: None, place: place.clone(), also: None, others: Vec::new(), edits: Vec::new() })
    }

    /// Adds a second span that is part of the problem.
    pub fn also(mut self: Box<Self>, place: Option<&TextSpan>) -> Box<Self> {
        self.also = place.cloned();
        self
    }

    /// Names the table of the fault, where there may be several of its name.
    pub fn in_item(mut self: Box<Self>, item: Option<String>) -> Box<Self> {
        self.item = item;
        self
    }

    /// Removes the edits.
    pub fn unmended(mut self: Box<Self>) -> Box<Self> {
        self.edits.clear();
        self
    }

    /// Adds an edit that replaces a span of text.
    pub fn edit(mut self: Box<Self>, place: &TextSpan, text: impl Into<String>) -> Box<Self> {
        self.edits.push((place.clone(), text.into()));
        self
    }

    /// Adds the edits of another fault, which mend both.
    pub fn edits_of(mut self: Box<Self>, other: Fault) -> Box<Self> {
        self.edits.extend(other.edits);
        self
    }
}

pub(super) type Checked<T> = Result<T, Box<Fault>>;

/// A value, or all that is wrong with it.
pub(super) type CheckedWhole<T> = Result<T, Vec<Fault>>;

/// All that is wrong, as it is found.
#[derive(Default)]
pub(super) struct Faults(pub Vec<Fault>);

impl Faults {
    /// Returns the value, or keeps the fault and returns `None`.
    pub fn keep<T>(&mut self, checked: Checked<T>) -> Option<T> {
        checked.map_err(|fault| self.0.push(*fault)).ok()
    }

    /// Returns the value if there is no fault.
    pub fn or<T>(self, value: T) -> CheckedWhole<T> {
        if self.0.is_empty() { Ok(value) } else { Err(self.0) }
    }
}

/// A text that a scene is read from: the file, or a setting.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Source {
    pub name: String,
    pub text: String,
}

/// Bytes of one of the sources.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TextSpan {
    /// Index of the source: 0 is the file, then one for each setting.
    pub source: usize,
    pub span: Range<usize>,
}
