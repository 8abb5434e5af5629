//! Text without characters that control a terminal: names in logs and scenes, and of hosts, may hold anything.

use std::borrow::Cow;

/// Replaces characters that control a terminal, except line feeds and tabs, by pictures of them. XML does not allow
/// control characters either.
pub(crate) fn printable(text: &str) -> Cow<'_, str> {
    shown(text, is_obeyed)
}

/// An error with what is below it, in one line; what an error repeats of its cause is said once.
pub(crate) fn in_full(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let below = error.to_string();
        if !text.ends_with(&below) {
            text = format!("{text}: {below}");
        }
        cause = error.source();
    }
    text
}

/// Replaces characters that control a terminal, and line breaks, in text that is part of a line, such as a name.
pub(crate) fn one_line(text: &str) -> Cow<'_, str> {
    shown(text, breaks_a_line)
}

/// Whether a character controls a terminal instead of being shown: control characters, and those that change the
/// direction of writing or begin a line.
pub(crate) fn is_obeyed(c: char) -> bool {
    breaks_a_line(c) && !matches!(c, '\n' | '\t')
}

/// Whether a character breaks a line of text or controls a terminal.
pub(crate) fn breaks_a_line(c: char) -> bool {
    const TURNS_OR_BREAKS: [std::ops::RangeInclusive<char>; 4] =
        ['\u{61c}'..='\u{61c}', '\u{200e}'..='\u{200f}', '\u{2028}'..='\u{202e}', '\u{2066}'..='\u{2069}'];
    c.is_control() || TURNS_OR_BREAKS.iter().any(|range| range.contains(&c))
}

fn shown(text: &str, hidden: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.chars().any(&hidden) {
        return text.into();
    }
    let picture = |c| match c {
        _ if !hidden(c) => c,
        '\u{7f}' => '␡',
        '\0'..' ' => char::from_u32('␀' as u32 + c as u32).unwrap_or(char::REPLACEMENT_CHARACTER),
        _ => char::REPLACEMENT_CHARACTER,
    };
    text.chars().map(picture).collect::<String>().into()
}
