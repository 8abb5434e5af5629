//! A problem, and where it stands in the text.

use std::ops::Range;

use super::problem::Problem;

/// A problem, where it stands, and the edits that would mend it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fault {
    pub problem: Problem,
    pub place: Place,
    /// A second place that the problem hangs on.
    pub also: Option<Place>,
    /// Replacements that mend it.
    pub edits: Vec<(Place, String)>,
}

impl Fault {
    pub fn new(problem: Problem, place: &Place) -> Box<Self> {
        Box::new(Self { problem, place: place.clone(), also: None, edits: Vec::new() })
    }

    pub fn also(mut self: Box<Self>, place: Option<&Place>) -> Box<Self> {
        self.also = place.cloned();
        self
    }

    /// Without the edits.
    pub fn unmended(mut self: Box<Self>) -> Box<Self> {
        self.edits.clear();
        self
    }

    pub fn edit(mut self: Box<Self>, place: &Place, text: impl Into<String>) -> Box<Self> {
        self.edits.push((place.clone(), text.into()));
        self
    }

    /// The same, mended together with another fault.
    pub fn edits_of(mut self: Box<Self>, other: Fault) -> Box<Self> {
        self.edits.extend(other.edits);
        self
    }
}

pub(super) type Checked<T> = Result<T, Box<Fault>>;

/// A text that a scene is read from: the file, or a setting.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Source {
    pub name: String,
    pub text: String,
}

/// Bytes of one of the sources.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Place {
    /// Index of the source: 0 is the file, then one for each setting.
    pub source: usize,
    pub span: Range<usize>,
}
