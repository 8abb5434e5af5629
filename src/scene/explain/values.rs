//! Wrong values, in words.

use super::explanation::{Explanation, lower, shorten, subject, type_words};
use crate::scene::key_table::all_keys;
use crate::scene::keys::{Form, Key, Kind, Presence, Unit, number};
use crate::scene::problem::{Direction, ValueType};

fn must_be(key: &Key, item: Option<&str>, label: impl Into<String>) -> Explanation {
    Explanation::new(format!("{} must be {}", subject(key, item), key.allowed()), label)
}

fn cannot_be(key: &Key, item: Option<&str>, found: &str) -> Explanation {
    Explanation::new(format!("{} cannot be \"{}\"", subject(key, item), shorten(found)), "")
}

pub(super) fn wrong_type(key: &Key, item: Option<&str>, found: ValueType) -> Explanation {
    let explanation = must_be(key, item, format!("this is {}", type_words(found)));
    let instead = all_keys().find(|other| {
        other.section == key.section && other.presence == Presence::InsteadOf(key.name) && found != ValueType::Text
    });
    let explanation = match instead {
        Some(other) => explanation.example(format!("for a value of your own: `{} = {}`", other.name, other.example)),
        None => explanation.example(format!("for example `{} = {}`", key.name, key.example)),
    };
    match (&key.kind, found) {
        (Kind::Stages, ValueType::Text) => explanation.fix("one stage is a list, too"),
        (Kind::Words(_), ValueType::Text) => explanation.fix("one word is a list, too"),
        (Kind::Number(_) | Kind::NumberOrPair(_), ValueType::Text) if key.unit != Unit::None => {
            explanation.fix(format!("a plain number of {}: the unit is in the name of the key", key.unit.words()))
        }
        (Kind::Number(_) | Kind::NumberOrPair(_) | Kind::Count(_) | Kind::Pair(_), ValueType::Text) => {
            explanation.fix("without quotes")
        }
        _ => explanation.fix("did you mean this?"),
    }
}

pub(super) fn not_whole(key: &Key, item: Option<&str>, value: f64) -> Explanation {
    if value.fract() == 0.0 {
        let explanation = must_be(key, item, "written as a number with decimals");
        return explanation.fix("whole numbers are written without a point");
    }
    must_be(key, item, "this is not a whole number")
}

pub(super) fn wrong_length(key: &Key, item: Option<&str>, found: usize) -> Explanation {
    let label = match found {
        0 => "an empty list".into(),
        1 => "a list of one".into(),
        _ => format!("a list of {found}"),
    };
    let explanation = must_be(key, item, label);
    let example = format!("`{} = {}`", key.name, key.example);
    match key.kind {
        Kind::Pair(_) => {
            explanation.help(format!("the first is along the length, the second along the arc: {example}"))
        }
        _ => explanation.help(format!("for example {example}")),
    }
}

pub(super) fn unknown_word(key: &Key, item: Option<&str>, found: &str, meant: Option<&str>) -> Explanation {
    let (Kind::Word(choices) | Kind::Words(choices)) = key.kind else { return Explanation::default() };
    let explanation = cannot_be(key, item, found);
    let explanation = match choices {
        [only] => explanation.note(format!("the only one so far is \"{}\": {}", only.word, lower(only.meaning))),
        _ if choices.iter().all(|choice| choice.meaning.is_empty()) => {
            explanation.note(format!("it is {}", key.allowed()))
        }
        _ => choices.iter().fold(explanation, |explanation, choice| match choice.in_short() {
            "" => explanation.note(format!("\"{}\"", choice.word)),
            meaning => explanation.note(format!("\"{}\" is {meaning}", choice.word)),
        }),
    };
    match meant {
        Some(meant) => explanation.fix(format!("did you mean \"{meant}\"?")),
        None => explanation,
    }
}

pub(super) fn unprintable(key: &Key, item: Option<&str>, character: char) -> Explanation {
    let title =
        format!("{} holds the character U+{:04X}, which cannot be seen", subject(key, item), u32::from(character));
    Explanation::new(title, "").help("names are one line of ordinary characters")
}

pub(super) fn unknown_region(key: &Key, item: Option<&str>, found: &str, meant: Option<&str>) -> Explanation {
    let explanation = cannot_be(key, item, found).note(format!("it is {}", key.allowed()));
    match meant {
        Some(meant) => explanation.fix(format!("did you mean \"{meant}\"?")),
        None => explanation,
    }
}

pub(super) fn no_such_line(key: &Key, item: Option<&str>, found: &str) -> Explanation {
    let title = format!("{}: there is no line {}", subject(key, item), shorten(found));
    Explanation::new(title, "")
        .help("a line lies strictly between 0 and 1; at 0 and 1 are the edges, such as \"u-start\"")
}

pub(super) fn no_such_point(key: &Key, item: Option<&str>, [u, v]: [f64; 2]) -> Explanation {
    let title = format!("{}: there is no point ({}, {})", subject(key, item), number(u), number(v));
    Explanation::new(title, "").help("fractions of u and v run from 0 to 1")
}

pub(super) fn wrong_form(key: &Key, item: Option<&str>, found: Form) -> Explanation {
    let found = match found {
        Form::Edge => "this is an edge",
        Form::Point => "this is a point",
        Form::Line => "this is a line inside",
    };
    must_be(key, item, found).note(format!("`{}` says: {}", key.name, lower(key.meaning)))
}

pub(super) fn not_finite(key: &Key, item: Option<&str>, value: f64) -> Explanation {
    must_be(key, item, if value.is_nan() { "not a number" } else { "not finite" })
}

pub(super) fn out_of_range(key: &Key, item: Option<&str>, value: f64) -> Explanation {
    let (Kind::Number(limits)
    | Kind::NumberOrPair(limits)
    | Kind::Numbers(_, limits)
    | Kind::Count(limits)
    | Kind::Pair(limits)) = &key.kind
    else {
        return Explanation::default();
    };
    let reason = limits.broken_by(value).map_or("", |limit| limit.reason);
    let in_pascal = value * 1e-6;
    if key.unit == Unit::Megapascal && limits.broken_by(in_pascal).is_none() {
        return must_be(key, item, reason).help(format!("if this is in Pa, it is {} MPa", number(in_pascal)));
    }
    must_be(key, item, reason)
}

pub(super) fn odd_elements(direction: Direction, elements: usize, part: &str) -> Explanation {
    let way = match direction {
        Direction::Length => "length",
        Direction::Arc => "arc",
    };
    Explanation::new(format!("{elements} elements along the {way} cannot be cut in two"), "must be even")
        .also(format!("\"{part}\" cuts the {way} in the middle"))
        .note("`mesh.elements` counts over the whole shell, whatever the symmetry")
        .fix("the next finer mesh")
}

pub(super) fn not_thin(thickness_mm: f64, radius_mm: f64) -> Explanation {
    let (thickness, radius) = (number(thickness_mm), number(radius_mm));
    Explanation::new(
        format!("a thickness of {thickness} mm is not thin for a radius of {radius} mm"),
        "must be less than the radius",
    )
    .also("the radius")
    .note("shell theory holds for a thickness far below the radius; a tape spring's is about 1/100 of it")
}

pub(super) fn increment_past_target(increment_deg: f64, rotation_deg: f64) -> Explanation {
    let (increment, rotation) = (number(increment_deg), number(rotation_deg));
    Explanation::new(
        format!("the first increment of {increment} degrees would go past the rotation of {rotation} degrees"),
        "must be at most the rotation",
    )
    .also("the run stops here")
}

pub(super) fn longest_increment_too_small(longest_increment_deg: f64, increment_deg: f64) -> Explanation {
    let (longest, increment) = (number(longest_increment_deg), number(increment_deg));
    Explanation::new(
        format!("the longest increment ({longest} degrees) is smaller than the increment ({increment} degrees)"),
        "must be at least the increment",
    )
    .also("the increment that grows where solves are easy")
}

pub(super) fn least_increment_too_large(least_increment_deg: f64, increment_deg: f64) -> Explanation {
    let (least, increment) = (number(least_increment_deg), number(increment_deg));
    Explanation::new(
        format!("the least increment ({least} degrees) is larger than the increment ({increment} degrees)"),
        "must be at most the increment",
    )
    .also("the increment that is cut when a step fails")
}

pub(super) fn snap_tolerance_too_small(snap_tolerance_deg: f64, least_increment_deg: f64) -> Explanation {
    let (snap, least) = (number(snap_tolerance_deg), number(least_increment_deg));
    Explanation::new(
        format!("a jump cannot be located to {snap} degrees with increments of {least} degrees or more"),
        "",
    )
    .alone("the value that is not shown is the default")
    .note("increments are not cut below `least_increment_deg`, so `snap_tolerance_deg` must not be less")
}
