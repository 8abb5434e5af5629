//! Text that is not TOML: the message of the TOML parser, and the mistake that it most likely is.

use std::ops::Range;

use super::fault::{Fault, TextSpan};
use super::key_table::SECTIONS;
use super::problem::{Problem, SyntaxSlip};

/// The error for a text that is not TOML; `base` is where the text begins.
pub(super) fn fault(error: &toml::de::Error, text: &str, base: &TextSpan) -> Box<Fault> {
    let span = error.span().unwrap_or(text.len()..text.len());
    let at = |span: Range<usize>| TextSpan {
        source: base.source,
        span: base.span.start + span.start..base.span.start + span.end,
    };
    let place = at(span.clone());
    let found = text.get(span.clone()).unwrap_or_default().trim();
    let line = line_around(text, span.start);
    let slip = match slip(found, line, error.message()) {
        Some(SyntaxSlip::Twice) if is_array(found) && line.trim_start().starts_with('[') => {
            Some(SyntaxSlip::TwiceInSingleBrackets)
        }
        slip => slip,
    };
    let fault = Fault::new(Problem::Syntax { message: error.message().to_owned(), slip }, &place);
    match slip {
        Some(SyntaxSlip::Twice | SyntaxSlip::TwiceInSingleBrackets) => {
            fault.also(first_of_two(text, &span).map(at).as_ref())
        }
        Some(SyntaxSlip::BareWord) if base.source == 0 => fault.edit(&place, format!("\"{found}\"")),
        Some(SyntaxSlip::Capitals) => fault.edit(&place, found.to_lowercase()),
        _ => fault,
    }
}

fn is_array(name: &str) -> bool {
    SECTIONS.iter().any(|section| section.many && section.name == name)
}

fn slip(found: &str, line: &str, message: &str) -> Option<SyntaxSlip> {
    let first = found.chars().next();
    let numeric = |c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.');
    if message.contains("duplicate key") {
        return Some(SyntaxSlip::Twice);
    }
    if ["true", "false"].contains(&&*found.to_lowercase()) {
        return Some(SyntaxSlip::Capitals);
    }
    if message.contains("comma between array elements") {
        return Some(SyntaxSlip::OpenList);
    }
    if message.contains("invalid basic string") || message.contains("invalid literal string") {
        return Some(SyntaxSlip::OpenText);
    }
    let value = line.split_once('=').map(|(_, value)| value.trim());
    let comma = |value: &str| {
        value.split_once(',').is_some_and(|(whole, rest)| {
            !whole.is_empty() && whole.chars().all(numeric) && rest.starts_with(|c: char| c.is_ascii_digit())
        })
    };
    match value {
        Some("") => Some(SyntaxSlip::NoValue),
        Some(value) if comma(value) => Some(SyntaxSlip::DecimalComma),
        _ if found.is_empty() && value.is_none() && line.is_empty() => Some(SyntaxSlip::NoValue),
        _ if !message.contains("must be quoted") => None,
        _ if first.is_some_and(numeric) => Some(SyntaxSlip::MoreThanANumber),
        _ if first.is_some_and(char::is_alphabetic) && found.chars().all(|c| c.is_alphanumeric() || c == '-') => {
            Some(SyntaxSlip::BareWord)
        }
        _ => None,
    }
}

fn line_around(text: &str, at: usize) -> &str {
    let Some((before, after)) = text.split_at_checked(at.min(text.len())) else { return "" };
    let start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let end = at + after.find('\n').unwrap_or(after.len());
    text.get(start..end).unwrap_or_default()
}

/// The place of the first of two keys or tables of one name, where the second is given at `second`: the last line before that begins with the same
/// name. (Between the two lies nothing but the table that they share.)
fn first_of_two(text: &str, second: &Range<usize>) -> Option<Range<usize>> {
    let name = text.get(second.clone()).filter(|name| !name.is_empty())?;
    let before = &text[..second.start];
    let is_table = before.trim_end().ends_with('[');
    let mut end = before.rfind('\n')?;
    loop {
        let start = before[..end].rfind('\n').map_or(0, |newline| newline + 1);
        let line = &before[start..end];
        let front = line.len() - line.trim_start_matches([' ', '\t', '[']).len();
        let rest = line[front..].strip_prefix(name).map(str::trim_start);
        let ends = if line[..front].contains('[') { ']' } else { '=' };
        if rest.is_some_and(|rest| rest.starts_with(ends)) && (is_table || ends == '=') {
            return Some(start + front..start + front + name.len());
        }
        end = start.checked_sub(1)?;
    }
}
