//! Text without what a terminal obeys: names in logs and scenes, and of hosts, may hold anything.

use std::borrow::Cow;

/// The text with what a terminal obeys, but line feeds and tabs, shown by pictures. XML would not take control characters
/// either.
pub(crate) fn printable(text: &str) -> Cow<'_, str> {
    shown(text, is_obeyed)
}

/// The same for text within a line, such as a name: it breaks none.
pub(crate) fn one_line(text: &str) -> Cow<'_, str> {
    shown(text, breaks_a_line)
}

/// Whether a terminal obeys a character instead of showing it: control characters, and those that turn the direction of
/// writing or begin a line.
pub(crate) fn is_obeyed(c: char) -> bool {
    breaks_a_line(c) && !matches!(c, '\n' | '\t')
}

/// Whether a character has no place in a line of text.
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
