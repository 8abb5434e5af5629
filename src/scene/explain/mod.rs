//! What is wrong with a scene, in words.

mod names;
mod stages;
mod syntax;
mod values;

use super::error::{Problem, ValueType};
use super::keys::join_or;

/// The words around an annotated snippet.
#[derive(Debug, Default)]
pub(super) struct Explanation {
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
    fn new(title: impl Into<String>, label: impl Into<String>) -> Self {
        Self { title: title.into(), label: label.into(), ..Self::default() }
    }

    fn also(mut self, text: impl Into<String>) -> Self {
        self.also = text.into();
        self
    }

    fn alone(mut self, text: impl Into<String>) -> Self {
        self.alone = text.into();
        self
    }

    fn note(mut self, text: impl Into<String>) -> Self {
        self.notes.push(text.into());
        self
    }

    fn help(mut self, text: impl Into<String>) -> Self {
        self.help.push(text.into());
        self
    }

    fn example(mut self, text: impl Into<String>) -> Self {
        self.example = text.into();
        self
    }

    fn fix(mut self, text: impl Into<String>) -> Self {
        self.fix = text.into();
        self
    }
}

/// Says what the problem is, why it is one, and what to do.
pub(super) fn explain(problem: &Problem) -> Explanation {
    match problem {
        Problem::Syntax { message, slip } => syntax::not_toml(message, *slip),
        Problem::SettingWithoutValue { key } => syntax::setting_without_value(*key),
        Problem::SettingWithoutSection { found, meant } => names::setting_without_section(found, *meant),
        Problem::UnknownSection { found, meant } => names::unknown_section(found, *meant),
        Problem::NotATable { section, found } => names::not_a_table(section, *found),
        Problem::KeyOutsideTables { found, meant } => names::key_outside_tables(found, *meant),
        Problem::UnknownKey { section, found, meant } => names::unknown_key(section, found, *meant),
        Problem::OtherUnit { found, key, unit, values } => names::other_unit(found, key, unit, *values),
        Problem::MissingSection { section } => names::missing_section(section),
        Problem::MissingKey { key } => names::missing_key(key),
        Problem::BothGiven { key, other } => names::both_given(key, other),
        Problem::WrongType { key, found } => values::wrong_type(key, *found),
        Problem::NotWhole { key, value } => values::not_whole(key, *value),
        Problem::NotAPair { key, found } => values::not_a_pair(key, *found),
        Problem::UnknownWord { key, found, meant } => values::unknown_word(key, found, *meant),
        Problem::NotFinite { key, value } => values::not_finite(key, *value),
        Problem::OutOfRange { key, value } => values::out_of_range(key, *value),
        Problem::OddElements { direction, elements, part } => values::odd_elements(*direction, *elements, part),
        Problem::NotThin { thickness_mm, radius_mm } => values::not_thin(*thickness_mm, *radius_mm),
        Problem::IncrementPastTarget { increment_deg, rotation_deg } => {
            values::increment_past_target(*increment_deg, *rotation_deg)
        }
        Problem::LongestIncrementTooSmall { longest_increment_deg, increment_deg } => {
            values::longest_increment_too_small(*longest_increment_deg, *increment_deg)
        }
        Problem::LeastIncrementTooLarge { least_increment_deg, increment_deg } => {
            values::least_increment_too_large(*least_increment_deg, *increment_deg)
        }
        Problem::SnapToleranceTooSmall { snap_tolerance_deg, least_increment_deg } => {
            values::snap_tolerance_too_small(*snap_tolerance_deg, *least_increment_deg)
        }
        Problem::Table { table, problem, remedy } => {
            let explanation = Explanation::new(format!("{table}: {problem}"), "");
            let explanation = if remedy.is_empty() { explanation } else { explanation.help(remedy.clone()) };
            explanation.help("`foldline help scene` lists every key")
        }
        Problem::AdaptUnused => stages::adapt_unused(),
        Problem::Stages(problem) => stages::wrong_order(problem),
    }
}

/// Where to look when nothing is near.
const ALL_KEYS: &str = "`foldline help scene` lists every key";

/// The type in words.
pub(super) fn type_name(found: ValueType) -> &'static str {
    type_words(found)
}

fn type_words(found: ValueType) -> &'static str {
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

fn join_and(names: &[String]) -> String {
    match names {
        [rest @ .., last] if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => join_or(names),
    }
}

/// A meaning from the table of keys as a part of a sentence.
fn lower(meaning: &str) -> String {
    let meaning = meaning.trim_end_matches('.');
    let mut letters = meaning.chars();
    let is_name = meaning.starts_with("Young") || meaning.starts_with("Poisson") || meaning.starts_with("Newton");
    let first = letters.next().filter(|_| !is_name);
    first.map_or_else(|| meaning.to_owned(), |first| first.to_lowercase().chain(letters).collect())
}

/// What stands in the scene, cut to what fits into a line.
fn shorten(text: &str) -> String {
    const LONGEST: usize = 40;
    let line: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    if line.chars().count() <= LONGEST {
        return line;
    }
    line.chars().take(LONGEST).collect::<String>() + "..."
}
