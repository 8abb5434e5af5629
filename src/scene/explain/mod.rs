//! What is wrong with a scene, in words.
//!
//! | file | what |
//! |---|---|
//! | `explanation` | its parts, and words that several use |
//! | `syntax` | text that is not TOML |
//! | `names` | wrong names |
//! | `values` | wrong values |
//! | `stages` | wrong stages |

mod explanation;
mod names;
mod stages;
mod syntax;
mod values;

use explanation::ALL_KEYS;
pub(super) use explanation::Explanation;

use super::fault::Fault;
use super::problem::Problem;

/// Says what the problem is, why it is one, and what to do.
pub(super) fn explain(fault: &Fault) -> Explanation {
    let item = fault.item.as_deref();
    match &fault.problem {
        Problem::Syntax { message, slip } => syntax::not_toml(message, *slip),
        Problem::SettingWithoutValue { key } => syntax::setting_without_value(*key),
        Problem::SettingWithoutSection { found, meant } => names::setting_without_section(found, *meant),
        Problem::UnknownSection { found, meant, sections } => names::unknown_section(found, *meant, sections),
        Problem::NotATable { section, found } => names::not_a_table(section, *found),
        Problem::KeyOutsideTables { found, meant } => names::key_outside_tables(found, *meant),
        Problem::UnknownKey { section, kind, found, meant } => names::unknown_key(section, item, *kind, found, *meant),
        Problem::OfOtherKind { section, found, kinds, here, meant } => {
            names::of_other_kind(section, item, found, kinds, here, *meant)
        }
        Problem::OtherUnit { found, key, unit, values } => names::other_unit(found, key, item, unit, *values),
        Problem::MissingSection { section } => names::missing_section(section),
        Problem::MissingKey { key } => names::missing_key(key, item),
        Problem::BothGiven { key, other } => names::both_given(key, other, item),
        Problem::WrongType { key, found } => values::wrong_type(key, item, *found),
        Problem::NotWhole { key, value } => values::not_whole(key, item, *value),
        Problem::WrongLength { key, found } => values::wrong_length(key, item, *found),
        Problem::UnknownWord { key, found, meant } => values::unknown_word(key, item, found, *meant),
        Problem::Unprintable { key, character } => values::unprintable(key, item, *character),
        Problem::UnknownRegion { key, found, meant } => values::unknown_region(key, item, found, *meant),
        Problem::NoSuchLine { key, found } => values::no_such_line(key, item, found),
        Problem::NoSuchPoint { key, found } => values::no_such_point(key, item, *found),
        Problem::WrongForm { key, found } => values::wrong_form(key, item, *found),
        Problem::NotFinite { key, value } => values::not_finite(key, item, *value),
        Problem::OutOfRange { key, value } => values::out_of_range(key, item, *value),
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
            explanation.help(ALL_KEYS)
        }
        Problem::AdaptUnused => stages::adapt_unused(),
        Problem::Stages(problem) => stages::wrong_order(problem),
    }
}
