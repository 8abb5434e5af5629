//! What can be wrong with a scene, with the numbers.

use super::data::Stage;
use super::keys::{Form, Key, Section};

/// The type of a TOML value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValueType {
    /// `"text"`
    Text,
    /// `3`
    Integer,
    /// `3.0`
    Float,
    /// `true`
    Boolean,
    /// `1979-05-27`
    Date,
    /// `[…]`
    Array,
    /// `{…}`
    Table,
}

/// One of the two directions of the shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Along the axis.
    Length,
    /// Along the arc.
    Arc,
}

impl Direction {
    /// Both directions, in the order of pairs.
    pub const BOTH: [Direction; 2] = [Direction::Length, Direction::Arc];
}

/// A common mistake in writing TOML.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SyntaxSlip {
    /// A key or a table is given twice.
    Twice,
    /// A table of which there may be several is given twice, in single brackets.
    TwiceInSingleBrackets,
    /// A word without quotes.
    BareWord,
    /// A unit, or something else, behind a number.
    MoreThanANumber,
    /// `300,0` for `300.0`.
    DecimalComma,
    /// Nothing behind the equals sign.
    NoValue,
    /// `True` for `true`.
    Capitals,
    /// Text whose quotes are not closed.
    OpenText,
    /// A list that is not closed, or lacks a comma.
    OpenList,
}

/// What is wrong with a scene. Values are in the units of their keys.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Problem {
    /// The text is not TOML.
    Syntax {
        /// The message of the TOML parser.
        message: String,
        /// What it most likely is.
        slip: Option<SyntaxSlip>,
    },
    /// A setting is not of the form section.key=value.
    SettingWithoutValue {
        /// The key that it names.
        key: Option<&'static Key>,
    },
    /// A setting's key is not of the form section.key.
    SettingWithoutSection {
        /// What was found.
        found: String,
        /// What was most likely meant.
        meant: Option<&'static Key>,
    },
    /// No table of a scene has this name.
    UnknownSection {
        /// What was found.
        found: String,
        /// The nearest right spelling.
        meant: Option<&'static str>,
        /// The tables that there are.
        sections: &'static [Section],
    },
    /// A table of a scene is given as a value or as an array of tables.
    NotATable {
        /// The description of the table.
        section: &'static Section,
        /// What was found.
        found: ValueType,
    },
    /// A key is given in front of all tables.
    KeyOutsideTables {
        /// What was found.
        found: String,
        /// What was most likely meant.
        meant: Option<&'static Key>,
    },
    /// The table has no key of this name.
    UnknownKey {
        /// The table.
        section: &'static Section,
        /// Its kind, where its keys depend on that and it is known.
        kind: Option<&'static str>,
        /// What was found.
        found: String,
        /// What was most likely meant; may be a key of another table.
        meant: Option<&'static Key>,
    },
    /// The key belongs to tables of another kind.
    OfOtherKind {
        /// The table.
        section: &'static Section,
        /// What was found.
        found: String,
        /// The kinds that have it.
        kinds: Vec<&'static str>,
        /// The kind of the table.
        here: &'static str,
        /// A key of this kind that may be meant.
        meant: Option<&'static Key>,
    },
    /// A key's name ends in another unit.
    OtherUnit {
        /// What was found.
        found: String,
        /// The key that is meant.
        key: &'static Key,
        /// The unit that was found.
        unit: &'static str,
        /// The value, and the same in the unit of the key, where it is a number.
        values: Option<(f64, f64)>,
    },
    /// A table that every scene must have is missing.
    MissingSection {
        /// The table.
        section: &'static Section,
    },
    /// A key that has no default is missing.
    MissingKey {
        /// The key.
        key: &'static Key,
    },
    /// Two keys mean the same thing.
    BothGiven {
        /// The key that is given in place of the other.
        key: &'static Key,
        /// The other key.
        other: &'static Key,
    },
    /// The value has another type than the key takes.
    WrongType {
        /// The key.
        key: &'static Key,
        /// What was found.
        found: ValueType,
    },
    /// A number with a fraction where whole numbers count.
    NotWhole {
        /// The key.
        key: &'static Key,
        /// What was found.
        value: f64,
    },
    /// A list of too few or too many.
    WrongLength {
        /// The key.
        key: &'static Key,
        /// How many were found.
        found: usize,
    },
    /// Text that is not one line of ordinary characters.
    Unprintable {
        /// The key.
        key: &'static Key,
        /// The first character that cannot be seen.
        character: char,
    },
    /// No part of the surface is called so.
    UnknownRegion {
        /// The key.
        key: &'static Key,
        /// What was found.
        found: String,
        /// The nearest right spelling.
        meant: Option<&'static str>,
    },
    /// A line outside of the surface, or on its edge.
    NoSuchLine {
        /// The key.
        key: &'static Key,
        /// What was found.
        found: String,
    },
    /// A point outside of the surface.
    NoSuchPoint {
        /// The key.
        key: &'static Key,
        /// Its fractions of u and v.
        found: [f64; 2],
    },
    /// A part of the surface of a form that the key does not take.
    WrongForm {
        /// The key.
        key: &'static Key,
        /// The form of the value.
        found: Form,
    },
    /// The key does not take this word.
    UnknownWord {
        /// The key.
        key: &'static Key,
        /// What was found.
        found: String,
        /// The nearest right spelling.
        meant: Option<&'static str>,
    },
    /// NaN or infinity.
    NotFinite {
        /// The key.
        key: &'static Key,
        /// What was found.
        value: f64,
    },
    /// A number past the limits of its key.
    OutOfRange {
        /// The key.
        key: &'static Key,
        /// What was found.
        value: f64,
    },
    /// The symmetry cuts through an element.
    OddElements {
        /// The direction that is cut.
        direction: Direction,
        /// Elements that way over the whole shell.
        elements: usize,
        /// The part that is modelled, as written in the scene.
        part: String,
    },
    /// The shell is not thin: thickness ≥ radius.
    NotThin {
        /// Thickness, mm.
        thickness_mm: f64,
        /// Radius, mm.
        radius_mm: f64,
    },
    /// The first increment would go past the target.
    IncrementPastTarget {
        /// Increment, degrees.
        increment_deg: f64,
        /// Target, degrees.
        rotation_deg: f64,
    },
    /// The increment is larger than the one that it is to grow to.
    LongestIncrementTooSmall {
        /// Longest increment, degrees.
        longest_increment_deg: f64,
        /// Increment, degrees.
        increment_deg: f64,
    },
    /// The least increment is larger than the increment that is to be cut.
    LeastIncrementTooLarge {
        /// Least increment, degrees.
        least_increment_deg: f64,
        /// Increment, degrees.
        increment_deg: f64,
    },
    /// Jumps are to be located more finely than increments are cut.
    SnapToleranceTooSmall {
        /// Snap tolerance, degrees.
        snap_tolerance_deg: f64,
        /// Least increment, degrees.
        least_increment_deg: f64,
    },
    /// A table whose keys depend on its kind is wrong.
    Table {
        /// The table, as written in the file.
        table: String,
        /// What is wrong.
        problem: String,
        /// What to do.
        remedy: String,
    },
    /// `[adapt]` is given, and no stage reads it.
    AdaptUnused,
    /// The stages cannot run in this order.
    Stages(StageOrderProblem),
}

impl Problem {
    /// Name of the table, or path of the key, that a wrong name most likely means.
    pub(super) fn meant(&self) -> Option<String> {
        match self {
            Problem::UnknownSection { meant, .. } => meant.map(str::to_owned),
            Problem::NotATable { section, .. } => Some(section.name.to_owned()),
            Problem::KeyOutsideTables { meant, .. }
            | Problem::UnknownKey { meant, .. }
            | Problem::OfOtherKind { meant, .. } => meant.map(Key::path),
            Problem::OtherUnit { key, .. } => Some(key.path()),
            _ => None,
        }
    }
}

/// Why a list of stages cannot run.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum StageOrderProblem {
    /// The list is empty.
    Empty,
    /// No stage has this name.
    Unknown {
        /// What was found.
        found: String,
        /// The nearest right spelling.
        meant: Option<Stage>,
    },
    /// An item of the list is not a name.
    NotAName {
        /// What was found.
        found: ValueType,
    },
    /// A stage is listed twice.
    Twice {
        /// The stage.
        stage: Stage,
    },
    /// A stage is listed before one whose work it needs.
    TooEarly {
        /// The stage.
        stage: Stage,
        /// The stage that it needs, which comes later.
        needs: Stage,
    },
    /// A stage is not there whose work another needs.
    WithoutSource {
        /// The stage.
        stage: Stage,
        /// The stage that it needs.
        needs: Stage,
    },
    /// A stage leaves the state in a form that nobody carries on from.
    WithoutSequel {
        /// The stage.
        stage: Stage,
        /// The stage that would carry on.
        sequel: Stage,
    },
}
