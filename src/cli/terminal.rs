//! What is printed to: whether it shows colours, whether a line can change in place, and how wide it is.

use std::env;
use std::ffi::OsString;
use std::io::{self, IsTerminal};

use anstream::stream::RawStream;
use anstream::{AutoStream, ColorChoice};
use clap::ValueEnum;
use terminal_size::terminal_size_of;

/// Columns of prose, and of help, where there is room.
const PROSE: usize = 80;
const HELP: usize = 100;

/// Columns below which nothing is made narrower.
const NARROWEST: usize = 40;

/// Makes `choice` the one of the whole process. `auto` leaves it to `NO_COLOR`, `CLICOLOR_FORCE`, `CLICOLOR` and `TERM`, and
/// shows none where there is no terminal.
pub(super) fn use_colours(choice: clap::ColorChoice) {
    let choice = match choice {
        clap::ColorChoice::Auto => ColorChoice::Auto,
        clap::ColorChoice::Always => ColorChoice::Always,
        clap::ColorChoice::Never => ColorChoice::Never,
    };
    choice.write_global();
}

/// The choice in arguments that cannot be parsed, or that ask for help: it holds for what is said about them.
pub(super) fn colours_asked_for(arguments: impl IntoIterator<Item = OsString>) -> clap::ColorChoice {
    let words: Vec<String> = arguments.into_iter().map(|word| word.to_string_lossy().into_owned()).collect();
    let after = words.iter().map(String::as_str).skip(1).chain([""]);
    let choices = words.iter().zip(after).filter_map(|(word, after)| match word.strip_prefix("--color") {
        Some("") => Some(after),
        Some(joined) => joined.strip_prefix('='),
        None => None,
    });
    choices.last().and_then(|choice| clap::ColorChoice::from_str(choice, false).ok()).unwrap_or_default()
}

/// Whether a stream shows colours.
pub(super) fn is_coloured(stream: &impl RawStream) -> bool {
    AutoStream::choice(stream) != ColorChoice::Never
}

/// Whether a line on standard error can be written over.
pub(super) fn can_overwrite() -> bool {
    io::stderr().is_terminal() && env::var_os("TERM").is_none_or(|terminal| terminal != "dumb")
}

/// Columns of a line on standard output: `COLUMNS`, or else those of the terminal. A pipe has no bounds.
pub(super) fn output_columns() -> Option<usize> {
    said_columns().or_else(|| terminal_size_of(io::stdout()).map(|(columns, _)| at_least(columns.0)))
}

/// The same of standard error.
pub(super) fn error_columns() -> Option<usize> {
    said_columns().or_else(|| terminal_size_of(io::stderr()).map(|(columns, _)| at_least(columns.0)))
}

/// Columns of prose, which no wide terminal makes wider.
pub(super) fn prose_columns() -> usize {
    output_columns().map_or(PROSE, |columns| columns.min(PROSE))
}

/// Columns of the help on arguments.
pub(super) fn help_columns() -> usize {
    output_columns().map_or(HELP, |columns| columns.min(HELP))
}

fn said_columns() -> Option<usize> {
    let said = env::var("COLUMNS").ok()?.parse().ok()?;
    (said > 0).then_some(at_least(said))
}

fn at_least(columns: u16) -> usize {
    usize::from(columns).max(NARROWEST)
}

#[cfg(test)]
mod tests {
    use clap::ColorChoice::{Always, Auto, Never};

    use super::*;

    #[test]
    fn colours_are_found_in_arguments_that_are_wrong() {
        let asked = |line: &str| colours_asked_for(line.split(' ').map(OsString::from));
        assert_eq!(asked("foldline rnu --color never"), Never);
        assert_eq!(asked("foldline --color=always --help"), Always);
        assert_eq!(asked("foldline --color never run --color always"), Always);
        assert_eq!(["foldline --color", "foldline --color blue", "foldline --colour never"].map(asked), [Auto; 3]);
    }
}
