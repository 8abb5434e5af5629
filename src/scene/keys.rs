//! What can be said about a key of a scene file. The keys themselves stand in `key_table`; reading, checking,
//! suggesting, explaining, comparing, writing, the help text and the schema all draw on that one table.

/// A table of a scene file, or the items of an array of tables.
#[derive(Debug, PartialEq)]
pub struct Section {
    /// Its name, without the brackets.
    pub name: &'static str,
    /// Whether there may be several, each in two brackets.
    pub many: bool,
    /// Whether a scene must have it.
    pub required: bool,
    /// What it is about.
    pub meaning: &'static str,
    /// Its keys, of all its kinds, in the order in which one would write them.
    pub keys: &'static [Key],
}

impl Section {
    /// Its name in brackets.
    pub fn title(&self) -> String {
        if self.many { format!("[[{}]]", self.name) } else { format!("[{}]", self.name) }
    }

    /// The key that says of which kind the table is, where other keys depend on it.
    pub fn kind_key(&self) -> Option<&'static Key> {
        let has_kinds = self.keys.iter().any(|key| !key.kinds.is_empty());
        self.keys.iter().find(|key| key.name == "kind").filter(|_| has_kinds)
    }

    /// The keys of a table of this kind; those of every kind where it is `None`.
    pub fn keys_of<'k>(&self, kind: Option<&'k str>) -> impl Iterator<Item = &'static Key> + Clone + use<'k> {
        self.keys.iter().filter(move |key| kind.is_none_or(|kind| key.belongs_to(kind)))
    }

    /// The key of this name in a table of this kind.
    pub fn key(&self, kind: Option<&str>, name: &str) -> Option<&'static Key> {
        self.keys_of(kind).find(|key| key.name == name)
    }

    /// How far the widest-reaching of its keys reaches.
    pub fn reach(&self) -> Reach {
        self.keys.iter().map(|key| key.reach).max().unwrap_or(Reach::Everything)
    }
}

/// A key of a scene file, and all that is known about it.
#[derive(Debug, PartialEq)]
pub struct Key {
    /// The table in which it stands.
    pub section: &'static str,
    /// The kinds of that table that have it; all where it is empty.
    pub kinds: &'static [&'static str],
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
    /// What it means.
    pub meaning: &'static str,
    /// A value as it would stand in a scene file.
    pub example: &'static str,
    /// What else people call it: symbols, and names in other programs; in lower case.
    pub aliases: &'static [&'static str],
}

/// Keys as the key table writes them down: required, reaching everything and of every kind of table, unless it says
/// otherwise.
impl Key {
    /// A key whose unit is the ending of its name.
    pub(super) const fn new(section: &'static str, name: &'static str, kind: Kind, example: &'static str) -> Self {
        let (presence, reach) = (Presence::Required, Reach::Everything);
        let unit = Unit::of_name(name);
        Self { section, kinds: &[], name, unit, kind, presence, reach, meaning: "", example, aliases: &[] }
    }

    /// Its meaning.
    pub(super) const fn means(self, meaning: &'static str) -> Self {
        Self { meaning, ..self }
    }

    /// Of tables of these kinds alone.
    pub(super) const fn of(self, kinds: &'static [&'static str]) -> Self {
        Self { kinds, ..self }
    }

    /// What holds where it is missing.
    pub(super) const fn or(self, presence: Presence) -> Self {
        Self { presence, ..self }
    }

    /// How far a change of it reaches.
    pub(super) const fn reaches(self, reach: Reach) -> Self {
        Self { reach, ..self }
    }

    /// The same key in another table.
    pub(super) const fn in_table(
        self,
        section: &'static str,
        kinds: &'static [&'static str],
        presence: Presence,
    ) -> Self {
        Self { section, kinds, presence, ..self }
    }

    /// What else it is called.
    pub(super) const fn also_called(self, aliases: &'static [&'static str]) -> Self {
        Self { aliases, ..self }
    }
}

impl Key {
    /// Section and name, as in `solver.tolerance`.
    pub fn path(&self) -> String {
        format!("{}.{}", self.section, self.name)
    }

    /// The words that it takes.
    pub(super) fn words(&self) -> impl Iterator<Item = &'static str> + Clone + use<> {
        let choices = if let Kind::Word(choices) = self.kind { choices } else { &[] };
        choices.iter().map(|choice| choice.word)
    }

    /// Whether tables of this kind have it.
    pub fn belongs_to(&self, kind: &str) -> bool {
        self.kinds.is_empty() || self.kinds.contains(&kind)
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
        let within = |limits: &Limits| match (*limits == Limits::ANY, self.unit.words()) {
            (true, "") => String::new(),
            (true, unit) => format!(" in {unit}"),
            (false, "") => format!(" {limits}"),
            (false, unit) => format!(" {limits} {unit}"),
        };
        let each =
            |limits: &Limits| if *limits == Limits::ANY { within(limits) } else { format!(", each{}", within(limits)) };
        match &self.kind {
            Kind::Word(choices) => join_or(&quoted(choices)),
            Kind::Words(choices) => format!("a list of {}", join_or(&quoted(choices))),
            Kind::Number(limits) => format!("a number{}", within(limits)),
            Kind::NumberOrPair(limits) => format!("a number{}, or a pair of them", within(limits)),
            Kind::NumberOr(word) => format!("a number{}, or \"{word}\"", within(&Limits::ANY)),
            Kind::Numbers(Length::Exactly(2), limits) => format!("a pair of numbers{}", each(limits)),
            Kind::Numbers(Length::Exactly(length), limits) => format!("a list of {length} numbers{}", each(limits)),
            Kind::Numbers(Length::Any, limits) => format!("a list of numbers{}", each(limits)),
            Kind::Rows(length) => format!("a list of lists of {length} numbers{}", within(&Limits::ANY)),
            Kind::Vector => format!("a list of 3 numbers{0}, or one number{0} beside `along`", within(&Limits::ANY)),
            Kind::Count(limits) => format!("a whole number {limits}"),
            Kind::Pair(limits) => format!("a whole number {limits}, or a pair of them"),
            Kind::Place(forms) => join_or(&forms.iter().map(|form| form.words().to_owned()).collect::<Vec<_>>()),
            Kind::Switch => "true or false".into(),
            Kind::Stages => "a list of stages".into(),
            Kind::Text => "text in quotes".into(),
        }
    }
}

fn quoted(choices: &[Choice]) -> Vec<String> {
    choices.iter().map(|choice| format!("\"{}\"", choice.word)).collect()
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
    /// Newtons; of moments per length, N mm per mm.
    Newton,
    /// Newtons per millimetre.
    NewtonPerMillimetre,
    /// Newtons per square millimetre.
    NewtonPerSquareMillimetre,
    /// Metres per second squared.
    MetrePerSecondSquared,
    /// Kelvin.
    Kelvin,
    /// Per kelvin.
    PerKelvin,
    /// Per millimetre.
    PerMillimetre,
}

impl Unit {
    /// Those of the keys; a name that ends in two of them has the one that comes first.
    const ALL: [Unit; 11] = [
        Unit::NewtonPerSquareMillimetre,
        Unit::NewtonPerMillimetre,
        Unit::PerMillimetre,
        Unit::PerKelvin,
        Unit::KilogramPerCubicMetre,
        Unit::MetrePerSecondSquared,
        Unit::Millimetre,
        Unit::Degree,
        Unit::Megapascal,
        Unit::Newton,
        Unit::Kelvin,
    ];

    /// The unit in which a name ends.
    const fn of_name(name: &str) -> Self {
        let mut index = 0;
        while index < Self::ALL.len() {
            if ends_in(name.as_bytes(), Self::ALL[index].suffix().as_bytes()) {
                return Self::ALL[index];
            }
            index += 1;
        }
        Unit::None
    }

    /// How names of keys with this unit end.
    pub const fn suffix(self) -> &'static str {
        match self {
            Unit::None => "",
            Unit::Millimetre => "mm",
            Unit::Degree => "deg",
            Unit::Megapascal => "mpa",
            Unit::KilogramPerCubicMetre => "kg_m3",
            Unit::Newton => "n",
            Unit::NewtonPerMillimetre => "n_per_mm",
            Unit::NewtonPerSquareMillimetre => "n_per_mm2",
            Unit::MetrePerSecondSquared => "m_s2",
            Unit::Kelvin => "k",
            Unit::PerKelvin => "per_k",
            Unit::PerMillimetre => "per_mm",
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
            Unit::Newton => "N",
            Unit::NewtonPerMillimetre => "N/mm",
            Unit::NewtonPerSquareMillimetre => "N/mm2",
            Unit::MetrePerSecondSquared => "m/s2",
            Unit::Kelvin => "K",
            Unit::PerKelvin => "1/K",
            Unit::PerMillimetre => "1/mm",
        }
    }
}

/// Whether a name is some words, `_` and a suffix.
const fn ends_in(name: &[u8], suffix: &[u8]) -> bool {
    let Some(before) = name.len().checked_sub(suffix.len() + 1) else { return false };
    let mut index = 0;
    while index < suffix.len() {
        if name[before + 1 + index] != suffix[index] {
            return false;
        }
        index += 1;
    }
    name[before] == b'_'
}

/// Type and limits of a key's value.
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
    /// Components in x, y, z, or a size for the direction of the key `along`.
    Vector,
    /// A whole number.
    Count(Limits),
    /// Two whole numbers (along the length, along the arc), or one for both.
    Pair(Limits),
    /// A part of the surface of one of these forms.
    Place(&'static [Form]),
    /// true or false.
    Switch,
    /// The list of stages.
    Stages,
    /// Any text in one line, in quotes.
    Text,
}

/// How many items a list has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// No fewer and no more.
    Exactly(usize),
    /// As many as one likes.
    Any,
}

/// A form of a part of the surface.
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
    /// How it is written.
    pub fn words(self) -> &'static str {
        match self {
            Form::Edge => "an edge (\"u-start\", \"u-end\", \"v-start\" or \"v-end\")",
            Form::Point => "a point ([1.0, 0.5], fractions of u and v)",
            Form::Line => "a line inside (\"u=0.5\" or \"v=0.25\")",
        }
    }
}

/// One of the words that a key takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// As it stands in the scene, without the quotes.
    pub word: &'static str,
    /// What it chooses; empty where the word says it.
    pub meaning: &'static str,
}

impl Choice {
    /// The first clause of its meaning.
    pub fn in_short(&self) -> &'static str {
        self.meaning.split([':', ';']).next().unwrap_or_default()
    }
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
    /// It must be there unless another key of the same table is.
    Unless(&'static str),
}

impl Presence {
    /// A sentence about it.
    pub fn words(self) -> String {
        match self {
            Presence::Required => "Required.".into(),
            Presence::Default(value) => format!("Default: {value}."),
            Presence::Follows(rule) => format!("Default: {rule}."),
            Presence::InsteadOf(other) => format!("In place of {other}."),
            Presence::Unless(other) => format!("Required unless there is {other}."),
        }
    }
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
    /// Any finite number.
    pub const ANY: Self = Self { low: Limit::excluded(f64::NEG_INFINITY, ""), high: Limit::NONE };

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
            _ if *self == Limits::ANY => write!(f, "of any size"),
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
