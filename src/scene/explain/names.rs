//! Wrong, missing and misplaced names, in words.

use super::explanation::{ALL_KEYS, Explanation, join_and, lower, shorten, subject, table, type_words};
use crate::scene::keys::{Key, Section, join_or, number};
use crate::scene::problem::ValueType;

pub(super) fn setting_without_section(found: &str, meant: Option<&Key>) -> Explanation {
    let found = shorten(found);
    let title = format!("a setting is written section.key=value, and `{found}` is not of the form section.key");
    match meant {
        Some(key) => Explanation::new(title, "").fix(format!("did you mean `{}`?", key.path())),
        None => Explanation::new(title, "").help(ALL_KEYS),
    }
}

pub(super) fn unknown_section(found: &str, meant: Option<&str>, sections: &[Section]) -> Explanation {
    let explanation = Explanation::new(format!("a scene has no table [{}]", shorten(found)), "");
    match meant {
        Some(meant) => explanation.fix(format!("did you mean [{meant}]?")),
        None => {
            let names: Vec<_> = sections.iter().map(Section::title).collect();
            explanation.help(format!("the tables are {}", join_and(&names))).help(ALL_KEYS)
        }
    }
}

pub(super) fn not_a_table(section: &Section, found: ValueType) -> Explanation {
    Explanation::new(format!("`{}` is a table, not {}", section.name, type_words(found)), "").help(format!(
        "write {} on a line of its own, and below it {}",
        section.title(),
        keys_of(section, None)
    ))
}

pub(super) fn key_outside_tables(found: &str, meant: Option<&Key>) -> Explanation {
    let explanation = Explanation::new(format!("`{}` is outside of every table", shorten(found)), "");
    match meant {
        Some(key) if key.name == found => explanation.help(format!("it belongs below [{}]", key.section)),
        Some(key) => explanation.help(format!("did you mean `{}`, below [{}]?", key.name, key.section)),
        None => explanation.help(ALL_KEYS),
    }
}

pub(super) fn unknown_key(
    section: &Section,
    item: Option<&str>,
    kind: Option<&str>,
    found: &str,
    meant: Option<&Key>,
) -> Explanation {
    let explanation = Explanation::new(format!("{} has no key `{}`", table(section.name, item), shorten(found)), "");
    match meant {
        Some(key) if key.section != section.name && key.name == found => {
            explanation.help(format!("it belongs below [{}]", key.section))
        }
        Some(key) if key.section != section.name => {
            explanation.help(format!("did you mean `{}`, below [{}]?", key.name, key.section))
        }
        Some(key) => {
            explanation.fix(format!("did you mean `{}`?{}", key.name, unit_of(key, found))).example(given(key))
        }
        None => explanation.help(format!("the table has {}", keys_of(section, kind))).help(ALL_KEYS),
    }
}

pub(super) fn of_other_kind(
    section: &Section,
    item: Option<&str>,
    found: &str,
    kinds: &[&str],
    here: &str,
    meant: Option<&Key>,
) -> Explanation {
    let quoted: Vec<String> = kinds.iter().map(|kind| format!("kind = \"{kind}\"")).collect();
    let title = format!(
        "{}: `{}` is a key of {}, and here the kind is \"{here}\"",
        table(section.name, item),
        shorten(found),
        join_or(&quoted)
    );
    let explanation = Explanation::new(title, "").help(format!("write {}, or take the key out", join_or(&quoted)));
    match meant {
        Some(key) => explanation.fix(format!("or did you mean `{}`?{}", key.name, unit_of(key, found))),
        None => explanation.help(ALL_KEYS),
    }
}

/// The unit of a key, where the name in its place does not give it.
fn unit_of(key: &Key, found: &str) -> String {
    if found.ends_with(key.unit.suffix()) { String::new() } else { format!(" (the value is in {})", key.unit.words()) }
}

pub(super) fn other_unit(
    found: &str,
    key: &Key,
    item: Option<&str>,
    unit: &str,
    values: Option<(f64, f64)>,
) -> Explanation {
    let wanted = key.unit.words();
    let title =
        format!("{} has no key `{}`: this value is given in {wanted}", table(key.section, item), shorten(found));
    let conversion = match values {
        Some((before, after)) if before != after => {
            format!(" {} {unit} are {} {wanted}", number(before), number(after))
        }
        _ => String::new(),
    };
    Explanation::new(title, "").fix(format!("did you mean `{}`?{conversion}", key.name)).example(given(key))
}

/// Notes that a key that is meant is in the table already.
fn given(key: &Key) -> String {
    format!("`{}` is given already: take one of the two out", key.name)
}

pub(super) fn missing_section(section: &Section) -> Explanation {
    let title = section.title();
    Explanation::new(format!("the scene has no table {title}"), "the scene ends here")
        .note(format!("{title} says: {}", lower(section.meaning)))
        .help("`foldline help scene` shows a complete scene")
        .fix("add it, with your values")
}

pub(super) fn missing_key(key: &Key, item: Option<&str>) -> Explanation {
    Explanation::new(format!("{} lacks `{}`", table(key.section, item), key.name), "")
        .note(format!("`{}` says: {}", key.name, lower(key.meaning)))
        .note(format!("it must be {}", key.allowed()))
        .fix("add it, with your value")
        .example(format!("for example `{} = {}`", key.name, key.example))
}

pub(super) fn both_given(key: &Key, other: &Key, item: Option<&str>) -> Explanation {
    let title = format!("{} and `{}` cannot both be given", subject(other, item), key.path());
    Explanation::new(title, lower(key.meaning)).also(lower(other.meaning)).help("keep one of the two")
}

/// The keys of a table, each name once.
fn keys_of(section: &Section, kind: Option<&str>) -> String {
    let mut names: Vec<_> = section.keys_of(kind).map(|key| format!("`{}`", key.name)).collect();
    names.dedup();
    match &*names {
        [only] => format!("the one key {only}"),
        _ => format!("the keys {}", join_and(&names)),
    }
}
