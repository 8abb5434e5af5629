//! Wrong, missing and misplaced names, in words.

use super::explanation::{ALL_KEYS, Explanation, join_and, lower, shorten, type_words};
use crate::scene::key_table::{KEYS, SECTIONS};
use crate::scene::keys::{Key, number};
use crate::scene::problem::ValueType;

pub(super) fn setting_without_section(found: &str, meant: Option<&Key>) -> Explanation {
    let found = shorten(found);
    let title = format!("a setting is written section.key=value, and `{found}` is not of the form section.key");
    match meant {
        Some(key) => Explanation::new(title, "").fix(format!("did you mean `{}`?", key.path())),
        None => Explanation::new(title, "").help(ALL_KEYS),
    }
}

pub(super) fn unknown_section(found: &str, meant: Option<&str>) -> Explanation {
    let explanation = Explanation::new(format!("a scene has no table [{}]", shorten(found)), "");
    match meant {
        Some(meant) => explanation.fix(format!("did you mean [{meant}]?")),
        None => {
            let names: Vec<_> = SECTIONS.iter().map(|section| format!("[{}]", section.name)).collect();
            explanation.help(format!("the tables are {}", join_and(&names))).help(ALL_KEYS)
        }
    }
}

pub(super) fn not_a_table(section: &str, found: ValueType) -> Explanation {
    Explanation::new(format!("`{section}` is a table, not {}", type_words(found)), "")
        .help(format!("write [{section}] on a line of its own, and below it {}", keys_of(section)))
}

pub(super) fn key_outside_tables(found: &str, meant: Option<&Key>) -> Explanation {
    let explanation = Explanation::new(format!("`{}` stands outside of every table", shorten(found)), "");
    match meant {
        Some(key) if key.name == found => explanation.help(format!("it belongs below [{}]", key.section)),
        Some(key) => explanation.help(format!("did you mean `{}`, below [{}]?", key.name, key.section)),
        None => explanation.help(ALL_KEYS),
    }
}

pub(super) fn unknown_key(section: &str, found: &str, meant: Option<&Key>) -> Explanation {
    let explanation = Explanation::new(format!("[{section}] has no key `{}`", shorten(found)), "");
    match meant {
        Some(key) if key.section != section && key.name == found => {
            explanation.help(format!("it belongs below [{}]", key.section))
        }
        Some(key) if key.section != section => {
            explanation.help(format!("did you mean `{}`, below [{}]?", key.name, key.section))
        }
        Some(key) => {
            let says_unit = found.ends_with(key.unit.suffix());
            let unit = if says_unit { String::new() } else { format!(" (the value is in {})", key.unit.words()) };
            explanation.fix(format!("did you mean `{}`?{unit}", key.name)).example(given(key))
        }
        None => explanation.help(format!("the table has {}", keys_of(section))).help(ALL_KEYS),
    }
}

pub(super) fn other_unit(found: &str, key: &Key, unit: &str, values: Option<(f64, f64)>) -> Explanation {
    let wanted = key.unit.words();
    let title = format!("[{}] has no key `{}`: this value is given in {wanted}", key.section, shorten(found));
    let conversion = match values {
        Some((before, after)) if before != after => {
            format!(" {} {unit} are {} {wanted}", number(before), number(after))
        }
        _ => String::new(),
    };
    Explanation::new(title, "").fix(format!("did you mean `{}`?{conversion}", key.name)).example(given(key))
}

/// Said of a key that is meant, but stands in the table already.
fn given(key: &Key) -> String {
    format!("`{}` is given already: take one of the two out", key.name)
}

pub(super) fn missing_section(section: &str) -> Explanation {
    let meaning = SECTIONS.iter().find(|known| known.name == section).map_or("", |known| known.meaning);
    Explanation::new(format!("the scene has no table [{section}]"), "the scene ends here")
        .note(format!("[{section}] says: {}", lower(meaning)))
        .help("`foldline help scene` shows a complete scene")
        .fix("add it, with your values")
}

pub(super) fn missing_key(key: &Key) -> Explanation {
    Explanation::new(format!("[{}] lacks `{}`", key.section, key.name), "")
        .note(format!("`{}` says: {}", key.name, lower(key.meaning)))
        .note(format!("it must be {}", key.allowed()))
        .fix("add it, with your value")
        .example(format!("for example `{} = {}`", key.name, key.example))
}

pub(super) fn both_given(key: &Key, other: &Key) -> Explanation {
    Explanation::new(format!("`{}` and `{}` cannot both be given", other.path(), key.path()), lower(key.meaning))
        .also(lower(other.meaning))
        .help("keep one of the two")
}

fn keys_of(section: &str) -> String {
    let names: Vec<_> = KEYS.iter().filter(|key| key.section == section).map(|key| format!("`{}`", key.name)).collect();
    match &*names {
        [only] => format!("the one key {only}"),
        _ => format!("the keys {}", join_and(&names)),
    }
}
