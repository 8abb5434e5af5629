//! What can be said about a key of a scene file. The keys themselves stand in `key_table`; reading, checking,
//! suggesting, explaining, comparing and the help text all draw on that one table.

/// A key of a scene file, and all that is known about it.
#[derive(Debug, PartialEq)]
pub struct Key {
    /// The table in which it stands.
    pub section: &'static str,
    /// Its name, with the unit as its ending.
    pub name: &'static str,
    /// Unit of its value.
    pub unit: Unit,
    /// Type and limits of its value.
    pub kind: Kind,
    /// What holds where it is missing.
    pub presence: Presence,
    /// How far a change of it reaches into a run.
    pub reach: Reach,
    /// What it means, in one line.
    pub meaning: &'static str,
    /// A value as it would stand in a scene file.
    pub example: &'static str,
    /// What else people call it: symbols, and names in other programs; in lower case.
    pub aliases: &'static [&'static str],
}

impl Key {
    /// Section and name, as in `solver.tolerance`.
    pub fn path(&self) -> String {
        format!("{}.{}", self.section, self.name)
    }

    /// The name without the unit.
    pub fn stem(&self) -> &'static str {
        match self.name.strip_suffix(self.unit.suffix()) {
            Some(stem) if !self.unit.suffix().is_empty() => stem.trim_end_matches('_'),
            _ => self.name,
        }
    }

    /// What is allowed, in words, with the unit.
    pub fn allowed(&self) -> String {
        let unit = self.unit.words();
        match &self.kind {
            Kind::Word(choices) => {
                let words: Vec<_> = choices.iter().map(|choice| format!("\"{}\"", choice.word)).collect();
                join_or(&words)
            }
            Kind::Number(limits) if unit.is_empty() => format!("a number {limits}"),
            Kind::Number(limits) => format!("a number {limits} {unit}"),
            Kind::Count(limits) => format!("a whole number {limits}"),
            Kind::Pair(limits) => format!("a whole number {limits}, or a pair of them"),
            Kind::Switch => "true or false".into(),
            Kind::Stages => "a list of stages".into(),
            Kind::Text => "text in quotes".into(),
        }
    }
}

/// How far a change of a key reaches into a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reach {
    /// No state changes: what is written beside the states, and where the run stops.
    Free,
    /// The steps taken change, not the problem solved: a state of one run can start the other.
    Steps,
    /// What supports and actions are called: no state changes, though the scene is another.
    Names,
    /// What acts from a load on: states of loads before it are the same.
    LaterLoads,
    /// The problem changes: no state of one run means anything in the other.
    Everything,
}

/// A table of a scene file.
#[derive(Debug, PartialEq)]
pub struct Section {
    /// Its name, without the brackets.
    pub name: &'static str,
    /// Whether a scene must have it.
    pub required: bool,
    /// What it is about, in one line.
    pub meaning: &'static str,
}

/// Unit of a key's value; the ending of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A word, a count or a plain number.
    None,
    /// Millimetres.
    Millimetre,
    /// Degrees.
    Degree,
    /// Megapascals, N/mm².
    Megapascal,
    /// Kilograms per cubic metre.
    KilogramPerCubicMetre,
}

impl Unit {
    /// How names of keys with this unit end.
    pub fn suffix(self) -> &'static str {
        match self {
            Unit::None => "",
            Unit::Millimetre => "mm",
            Unit::Degree => "deg",
            Unit::Megapascal => "mpa",
            Unit::KilogramPerCubicMetre => "kg_m3",
        }
    }

    /// The unit in a sentence.
    pub fn words(self) -> &'static str {
        match self {
            Unit::None => "",
            Unit::Millimetre => "mm",
            Unit::Degree => "degrees",
            Unit::Megapascal => "MPa",
            Unit::KilogramPerCubicMetre => "kg/m3",
        }
    }
}

/// Type and limits of a key's value.
#[derive(Debug, PartialEq)]
pub enum Kind {
    /// One of some words, in quotes.
    Word(&'static [Choice]),
    /// A finite number.
    Number(Limits),
    /// A whole number.
    Count(Limits),
    /// Two whole numbers (along the length, along the arc), or one for both.
    Pair(Limits),
    /// true or false.
    Switch,
    /// The list of stages.
    Stages,
    /// Any text, in quotes.
    Text,
}

/// One of the words that a key takes.
#[derive(Debug, PartialEq)]
pub struct Choice {
    /// As it stands in the scene, without the quotes.
    pub word: &'static str,
    /// What it chooses, in one line.
    pub meaning: &'static str,
}

/// What holds where a key is missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Presence {
    /// It must be there.
    Required,
    /// A default, as it would stand in a scene.
    Default(&'static str),
    /// A default that follows from other keys, in words.
    Follows(&'static str),
    /// It stands in for another key of the same table; at most one of the two is given.
    InsteadOf(&'static str),
}

/// Between which numbers a value must lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// The lower end.
    pub low: Limit,
    /// The upper end.
    pub high: Limit,
}

/// One end of the allowed numbers.
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
    /// The value itself is not allowed.
    pub const fn excluded(value: f64, reason: &'static str) -> Self {
        Self { value, included: false, reason }
    }

    /// The value itself is allowed.
    pub const fn included(value: f64, reason: &'static str) -> Self {
        Self { value, included: true, reason }
    }

    /// No upper limit.
    pub const NONE: Self = Self::excluded(f64::INFINITY, "");
}

impl Limits {
    /// The limit that `value` is past, if any. A value that is not a number is past both; the caller has asked before.
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
            _ if self.low.value.is_infinite() && self.high.value.is_infinite() => write!(f, "of any size"),
            (true, true) => write!(f, "from {low} to {high}"),
            (false, true) => write!(f, "greater than {low} and at most {high}"),
            (false, false) if self.high.value.is_infinite() => write!(f, "greater than {low}"),
            (false, false) => write!(f, "greater than {low} and less than {high}"),
            (true, false) => write!(f, "at least {low} and less than {high}"),
        }
    }
}

/// A word of a key.
pub(super) const fn choice(word: &'static str, meaning: &'static str) -> Choice {
    Choice { word, meaning }
}

/// A number as an engineer would write it: `300`, `0.019`, `1e-7`.
pub(super) fn number(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-4..1e6).contains(&size) { format!("{value:e}") } else { format!("{value}") }
}

/// A number as TOML writes floats: `300.0`, `0.019`, `1e-7`.
pub(super) fn toml_float(value: f64) -> String {
    format!("{value:?}")
}

/// Items in a sentence: `a, b or c`.
pub(super) fn join_or(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [rest @ .., last] => format!("{} or {last}", rest.join(", ")),
    }
}
