//! Text without what a terminal obeys: names in logs and scenes, and of hosts, may hold anything.

use std::borrow::Cow;

/// The text with control characters, but line feeds and tabs, shown by their pictures. XML would not take them either.
pub(crate) fn printable(text: &str) -> Cow<'_, str> {
    if !text.chars().any(is_obeyed) {
        return text.into();
    }
    let picture = |c| match c {
        _ if !is_obeyed(c) => c,
        '\u{7f}' => '␡',
        '\0'..' ' => char::from_u32('␀' as u32 + c as u32).unwrap_or(char::REPLACEMENT_CHARACTER),
        _ => char::REPLACEMENT_CHARACTER,
    };
    text.chars().map(picture).collect::<String>().into()
}

/// Whether a terminal obeys a character instead of showing it.
pub(crate) fn is_obeyed(c: char) -> bool {
    c.is_control() && !matches!(c, '\n' | '\t')
}
