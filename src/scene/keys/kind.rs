//! Types and limits of values.

use super::unit::Unit;
use super::wording::{join_or, number};

/// The type and limits of a key's value.
#[derive(Debug, PartialEq)]
pub enum Kind {
    /// One of some words, in quotes.
    Word(&'static [Choice]),
    /// A list of some of these words, in quotes.
    Words(&'static [Choice]),
    /// A finite number.
    Number(Limits),
    /// One finite number, or one for each direction.
    NumberOrPair(Limits),
    /// A finite number, or this word.
    NumberOr(&'static str),
    /// A list of finite numbers.
    Numbers(Length, Limits),
    /// A list of lists of this many finite numbers.
    Rows(usize),
    /// A list of inline tables; what they have is in the key.
    Tables,
    /// Components in x, y, z, or a size for the direction of the key `along`.
    Vector,
    /// A whole number.
    Count(Limits),
    /// Two whole numbers (along the length, along the arc), or one for both.
    Pair(Limits),
    /// A part of the surface of one of these forms.
    Region(&'static [Form]),
    /// true or false.
    Switch,
    /// The list of stages.
    Stages,
    /// Any text in one line, in quotes.
    Text,
    /// A list of such texts.
    Texts(Length),
    /// A list of edges of shells: the name of the shell, a point, and the word of the edge.
    Edges(Length),
}

impl Kind {
    /// What is allowed, in words.
    pub(super) fn words(&self, unit: Unit) -> String {
        let within = |limits: &Limits| match (*limits == Limits::ANY, unit.words()) {
            (true, "") => String::new(),
            (true, unit) => format!(" in {unit}"),
            (false, "") => format!(" {limits}"),
            (false, unit) => format!(" {limits} {unit}"),
        };
        let each =
            |limits: &Limits| if *limits == Limits::ANY { within(limits) } else { format!(", each{}", within(limits)) };
        match self {
            Kind::Word(choices) => join_or(&quoted(choices)),
            Kind::Words(choices) => format!("a list of {}", join_or(&quoted(choices))),
            Kind::Number(limits) => format!("a number{}", within(limits)),
            Kind::NumberOrPair(limits) => format!("a number{}, or a pair of them", within(limits)),
            Kind::NumberOr(word) => format!("a number{}, or \"{word}\"", within(&Limits::ANY)),
            Kind::Numbers(Length::Exactly(2), limits) => format!("a pair of numbers{}", each(limits)),
            Kind::Numbers(Length::Exactly(length), limits) => format!("a list of {length} numbers{}", each(limits)),
            Kind::Numbers(Length::Any, limits) => format!("a list of numbers{}", each(limits)),
            Kind::Rows(length) => format!("a list of lists of {length} numbers{}", within(&Limits::ANY)),
            Kind::Tables => "a list of one or more tables in braces".into(),
            Kind::Vector => {
                format!("a list of 3 numbers{0}, or one number{0} together with `along`", within(&Limits::ANY))
            }
            Kind::Count(limits) => format!("a whole number {limits}"),
            Kind::Pair(limits) => format!("a whole number {limits}, or a pair of them"),
            Kind::Region(forms) => join_or(&forms.iter().map(|form| form.words().to_owned()).collect::<Vec<_>>()),
            Kind::Switch => "true or false".into(),
            Kind::Stages => "a list of stages".into(),
            Kind::Text => "text in quotes".into(),
            Kind::Texts(length) => format!("a list of {}names in quotes", length.words()),
            Kind::Edges(length) => {
                format!("a list of {}edges, each \"SHELL.EDGE\" as in \"web.v-end\"", length.words())
            }
        }
    }
}

fn quoted(choices: &[Choice]) -> Vec<String> {
    choices.iter().map(|choice| format!("\"{}\"", choice.word)).collect()
}

/// The number of items of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// Exactly this number of items.
    Exactly(usize),
    /// Any number of items.
    Any,
}

impl Length {
    /// The number with a blank behind it, or nothing.
    fn words(self) -> String {
        match self {
            Length::Exactly(length) => format!("{length} "),
            Length::Any => String::new(),
        }
    }
}

/// The ways to describe a region of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A whole edge.
    Edge,
    /// A point, by its fractions of u and v.
    Point,
    /// The line inside on which u or v has a fraction.
    Line,
}

impl Form {
    /// How a region of this form is written.
    pub fn words(self) -> &'static str {
        match self {
            Form::Edge => "an edge (\"u-start\", \"u-end\", \"v-start\" or \"v-end\")",
            Form::Point => "a point ([1.0, 0.5], fractions of u and v)",
            Form::Line => "a line inside (\"u=0.5\" or \"v=0.25\")",
        }
    }
}

/// One of the words that a key accepts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The word as written in the scene, without the quotes.
    pub word: &'static str,
    /// The meaning of the choice; empty where the word is enough.
    pub meaning: &'static str,
}

impl Choice {
    /// The first clause of the choice's meaning.
    pub fn in_short(&self) -> &'static str {
        self.meaning.split([':', ';']).next().unwrap_or_default()
    }
}

/// The range of numbers to which a value is limited.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// The lower end.
    pub low: Limit,
    /// The upper end.
    pub high: Limit,
}

/// One end of a range of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// The limit; infinite where there is none.
    pub value: f64,
    /// Whether the limit itself is allowed.
    pub included: bool,
    /// Why values past it are not allowed.
    pub reason: &'static str,
}

impl Limit {
    /// A limit at which the value itself is not allowed.
    pub const fn excluded(value: f64, reason: &'static str) -> Self {
        Self { value, included: false, reason }
    }

    /// A limit at which the value itself is allowed.
    pub const fn included(value: f64, reason: &'static str) -> Self {
        Self { value, included: true, reason }
    }

    /// The absence of an upper limit.
    pub const NONE: Self = Self::excluded(f64::INFINITY, "");
}

impl Limits {
    /// The range of all finite numbers.
    pub const ANY: Self = Self { low: Limit::excluded(f64::NEG_INFINITY, ""), high: Limit::NONE };

    /// The limit that `value` exceeds, if any. NaN exceeds both limits; callers reject it before.
    pub fn broken_by(&self, value: f64) -> Option<&Limit> {
        let above = value > self.low.value || (self.low.included && value == self.low.value);
        let below = value < self.high.value || (self.high.included && value == self.high.value);
        match (above, below) {
            (false, _) => Some(&self.low),
            (_, false) => Some(&self.high),
            _ => None,
        }
    }
}

impl std::fmt::Display for Limits {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (low, high) = (number(self.low.value), number(self.high.value));
        match (self.low.included, self.high.included) {
            _ if *self == Limits::ANY => write!(f, "of any size"),
            (true, true) => write!(f, "from {low} to {high}"),
            (false, true) => write!(f, "greater than {low} and at most {high}"),
            (false, false) if self.high.value.is_infinite() => write!(f, "greater than {low}"),
            (false, false) => write!(f, "greater than {low} and less than {high}"),
            (true, false) if self.high.value.is_infinite() => write!(f, "at least {low}"),
            (true, false) => write!(f, "at least {low} and less than {high}"),
        }
    }
}

/// A word of a key.
pub(in crate::scene) const fn choice(word: &'static str, meaning: &'static str) -> Choice {
    Choice { word, meaning }
}
