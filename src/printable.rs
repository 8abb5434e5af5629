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

/// A name as a word of a command that a shell takes as it is: in quotes where it holds a space or a character that means
/// something there. One that begins as an option does is led by its folder.
pub(crate) fn word(text: &str) -> Cow<'_, str> {
    let text = match text.starts_with('-') {
        true => Cow::from(format!("./{}", one_line(text))),
        false => one_line(text),
    };
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+:,@%".contains(c) || cfg!(windows) && c == '\\';
    match !text.is_empty() && text.chars().all(is_plain) {
        true => text,
        false if cfg!(windows) => format!("\"{text}\"").into(),
        // A quote ends the quoted part, stands for itself, and begins another.
        false => format!("'{}'", text.replace('\'', r"'\''")).into(),
    }
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

#[cfg(all(test, not(windows)))]
mod tests {
    use super::*;

    #[test]
    fn words_that_a_shell_takes_as_they_are() {
        for plain in ["checkpoints/a.mcap", "../Länge_1.5-x.toml"] {
            assert_eq!(word(plain), plain);
        }
        assert_eq!(word("two words.mcap"), "'two words.mcap'");
        assert_eq!(word("it's.mcap"), r"'it'\''s.mcap'");
        assert_eq!(word("$HOME;ls"), "'$HOME;ls'");
        assert_eq!(word("--force"), "./--force");
        assert_eq!(word(""), "''");
        assert_eq!(word("a\u{1b}[31m"), "'a\u{241b}[31m'", "a terminal obeys nothing of it");
    }
}
