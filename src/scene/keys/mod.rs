//! The description of a key of a scene file. The keys themselves are in `key_table`; reading, checking,
//! suggesting, explaining, comparing, writing, the help text and the schema all draw on that one table.
//!
//! | file | what |
//! |---|---|
//! | `kind` | types and limits of values |
//! | `unit` | units, the endings of names |
//! | `wording` | numbers and lists in sentences, and numbers in TOML |

mod kind;
mod unit;
mod wording;

pub(super) use kind::choice;
pub use kind::{Choice, Form, Kind, Length, Limit, Limits};
pub use unit::Unit;
pub(super) use wording::{join_or, number, toml_float};

/// A table of a scene file, or the items of an array of tables.
#[derive(Debug, PartialEq)]
pub struct Section {
    /// Its name, without the brackets.
    pub name: &'static str,
    /// Whether there may be several, each in two brackets.
    pub many: bool,
    /// Whether a scene must have it.
    pub required: bool,
    /// What the table describes, in a sentence.
    pub meaning: &'static str,
    /// Its keys, of all its kinds, in the order in which one would write them.
    pub keys: &'static [Key],
}

impl Section {
    /// The name of the table in brackets.
    pub fn title(&self) -> String {
        if self.many { format!("[[{}]]", self.name) } else { format!("[{}]", self.name) }
    }

    /// Whether the list of all its tables has this name in a scene.
    pub fn is_list(&self, path: &str) -> bool {
        let ending = if self.name.ends_with('s') { "es" } else { "s" };
        self.many && path.strip_suffix(ending) == Some(self.name)
    }

    /// The key that gives the kind of the table, where other keys depend on it.
    pub fn kind_key(&self) -> Option<&'static Key> {
        let has_kinds = self.keys.iter().any(|key| !key.kinds.is_empty());
        self.keys.iter().find(|key| key.name == "kind").filter(|_| has_kinds)
    }

    /// The kind of table that examples show.
    pub fn example_kind(&self) -> Option<&'static str> {
        self.kind_key().map(|key| key.example.trim_matches('"'))
    }

    /// The keys of a table of this kind, or those of every kind where it is `None`.
    pub fn keys_of<'k>(&self, kind: Option<&'k str>) -> impl Iterator<Item = &'static Key> + Clone + use<'k> {
        self.keys.iter().filter(move |key| kind.is_none_or(|kind| key.belongs_to(kind)))
    }

    /// Finds the key of this name in a table of this kind.
    pub fn key(&self, kind: Option<&str>, name: &str) -> Option<&'static Key> {
        self.keys_of(kind).find(|key| key.name == name)
    }

    /// The widest reach of any of the table's keys.
    pub fn reach(&self) -> Reach {
        self.keys.iter().map(|key| key.reach).max().unwrap_or(Reach::Everything)
    }
}

/// A key of a scene file, and all that is known about it.
#[derive(Debug, PartialEq)]
pub struct Key {
    /// The table of the key.
    pub section: &'static str,
    /// The kinds of that table that have it; all where it is empty.
    pub kinds: &'static [&'static str],
    /// Its name, with the unit as its ending.
    pub name: &'static str,
    /// Unit of its value.
    pub unit: Unit,
    /// Type and limits of its value.
    pub kind: Kind,
    /// Where its value is a list of inline tables, what those are.
    pub items: Option<&'static Section>,
    /// What holds where it is missing.
    pub presence: Presence,
    /// How far a change of it reaches into a run.
    pub reach: Reach,
    /// What the key means, in a sentence.
    pub meaning: &'static str,
    /// A value as written in a scene file.
    pub example: &'static str,
    /// What else people call it: symbols, and names in other programs; in lower case.
    pub aliases: &'static [&'static str],
}

/// Keys as the key table writes them down: required, reaching everything and of every kind of table, unless it states
/// otherwise.
impl Key {
    /// A key whose unit is the ending of its name.
    pub(super) const fn new(section: &'static str, name: &'static str, kind: Kind, example: &'static str) -> Self {
        let (presence, reach) = (Presence::Required, Reach::Everything);
        let unit = Unit::of_name(name);
        Self { section, kinds: &[], name, unit, kind, items: None, presence, reach, meaning: "", example, aliases: &[] }
    }

    /// Its meaning.
    pub(super) const fn means(self, meaning: &'static str) -> Self {
        Self { meaning, ..self }
    }

    /// A list of inline tables like this one.
    pub(super) const fn list_of(self, items: &'static Section) -> Self {
        Self { items: Some(items), ..self }
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
    /// The path of the key: section and name, as in `solver.tolerance`.
    pub fn path(&self) -> String {
        format!("{}.{}", self.section, self.name)
    }

    /// The words that it takes.
    pub(super) fn words(&self) -> impl Iterator<Item = &'static str> + Clone + use<> {
        let choices = if let Kind::Word(choices) = self.kind { choices } else { &[] };
        choices.iter().map(|choice| choice.word)
    }

    /// Whether tables of this kind have the key.
    pub fn belongs_to(&self, kind: &str) -> bool {
        self.kinds.is_empty() || self.kinds.contains(&kind)
    }

    /// The name of the key without its unit.
    pub fn stem(&self) -> &'static str {
        match self.name.strip_suffix(self.unit.suffix()) {
            Some(stem) if !self.unit.suffix().is_empty() => stem.trim_end_matches('_'),
            _ => self.name,
        }
    }

    /// Describes the values that are allowed, with their unit.
    pub fn allowed(&self) -> String {
        self.kind.words(self.unit)
    }
}

/// How much of a run a change of the key affects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reach {
    /// No state changes: what is written besides the states, and where the run stops.
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

/// What applies where the key is missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Presence {
    /// The key is required.
    Required,
    /// A default, as written in a scene.
    Default(&'static str),
    /// A default that follows from other keys, in words.
    Follows(&'static str),
    /// It replaces another key of the same table; at most one of the two is given.
    InsteadOf(&'static str),
    /// It must be there unless another key of the same table is.
    Unless(&'static str),
}

impl Presence {
    /// Describes what applies where the key is missing, in a sentence.
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
