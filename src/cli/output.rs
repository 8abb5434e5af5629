//! Standard output that may be closed, text that no terminal obeys, and files that are whole or not there.

use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use anstream::AutoStream;
use clap::builder::styling::AnsiColor;
use clap::builder::{PathBufValueParser, StyledStr, TypedValueParser};

use super::failure::Failure;
use super::terminal::{error_columns, output_columns};
use super::wrapped::fitted;
pub(super) use crate::printable::printable;
use crate::printable::{is_obeyed, one_line, word};
use crate::whole_file::write_new;

/// Writes what a person reads to standard output, in lines that fit.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    print_as_it_is(&fitted(text, output_columns()))
}

/// Writes what a program reads to standard output: JSON, tables for others, paths.
pub(super) fn print_as_it_is(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    written(out.write_all(printable(text).as_bytes()).and_then(|()| out.flush()))
}

/// A reader that has closed its end (`| head`) has what it wanted: that is no failure.
fn written(result: io::Result<()>) -> Result<(), Failure> {
    match result {
        Err(source) if source.kind() != ErrorKind::BrokenPipe => Err(Failure::Print { source }),
        _ => Ok(()),
    }
}

/// The name of a file or a folder to write, in whatever characters. `-`, which elsewhere means standard output, is none.
pub(super) fn file_name() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| match path.as_os_str() == "-" {
        true => Err("a file is wanted: this is written in place, not to standard output; ./- is a file of that name"),
        false => Ok(path),
    })
}

/// A path as it is printed in a line of text.
pub(super) fn path_in_line(path: &Path) -> String {
    one_line(&path.to_string_lossy()).into_owned()
}

/// A path as it is printed in a command to type, in quotes where a shell needs them.
pub(super) fn path_in_command(path: &Path) -> String {
    word(&path.to_string_lossy()).into_owned()
}

/// Writes a line of JSON to standard output.
pub(super) fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    print_as_it_is(&(escaped(serde_json::to_string(value).unwrap_or_default()) + "\n"))
}

/// Writes a line to standard error, or as many as it takes; a closed stream is ignored.
pub(super) fn eprint(text: &str) {
    eprint_rendered(&printable(&fitted(text, error_columns())));
}

/// Says on standard error what stopped a command, with the head that errors of scenes and of arguments have.
pub(super) fn say(failure: &Failure) {
    match failure {
        // Its lines have their head, and what they quote was made printable as they were rendered.
        Failure::WrongScene { rendered } | Failure::WrongStudy { rendered } => eprint_rendered(rendered.trim_end()),
        // Nothing went wrong.
        Failure::Interrupted { .. } | Failure::StudyInterrupted | Failure::TaskInterrupted { .. } => {
            eprint(&failure.in_full());
        }
        _ => {
            let text = fitted(&format!("error: {}", failure.in_full()), error_columns());
            let (head, style) = ("error:", AnsiColor::Red.on_default().bold());
            let text = printable(text.strip_prefix(head).unwrap_or(&text)).into_owned();
            eprint_rendered(&format!("{style}{head}{style:#}{text}"));
        }
    }
}

/// Writes a text with its colours to standard output, where they are shown there.
pub(super) fn print_styled(text: &StyledStr) -> Result<(), Failure> {
    written(write!(AutoStream::auto(io::stdout().lock()), "{}", text.ansi()))
}

/// Writes a line that was made for a terminal to standard error, with its colours where they are shown there.
pub(super) fn eprint_rendered(text: &str) {
    let _ = writeln!(AutoStream::auto(io::stderr().lock()), "{text}");
}

/// JSON with the control characters escaped that JSON allows.
pub(super) fn escaped(json: String) -> String {
    if !json.chars().any(is_obeyed) {
        return json;
    }
    let escape = |c| if is_obeyed(c) { format!("\\u{:04x}", u32::from(c)) } else { String::from(c) };
    json.chars().map(escape).collect()
}

/// Writes files, each whole or not at all, and none over another: whether anything is in the way is asked before the first
/// is written.
pub(super) fn write_files(files: &[(PathBuf, Vec<u8>)]) -> Result<(), Failure> {
    refuse_what_is_there(files.iter().map(|(path, _)| path))?;
    files.iter().try_for_each(|(path, content)| {
        let made = make_folder_of(path)?;
        let written = write_new(path, content);
        if written.is_err() {
            // One that holds something by now stays.
            made.iter().take_while(|folder| std::fs::remove_dir(folder).is_ok()).for_each(drop);
        }
        written.map_err(|source| match source.kind() {
            ErrorKind::AlreadyExists => Failure::InTheWay { path: path.clone() },
            _ => Failure::Write { path: path.clone(), source },
        })
    })
}

/// Makes the folder that a file is to lie in; gives back the folders that were not there, the innermost first.
fn make_folder_of(path: &Path) -> Result<Vec<&Path>, Failure> {
    let folders = path.ancestors().skip(1).filter(|folder| !folder.as_os_str().is_empty());
    let missing: Vec<&Path> = folders.take_while(|folder| !folder.exists()).collect();
    for folder in missing.iter().rev() {
        let failed = |source| Failure::Write { path: folder.to_path_buf(), source };
        std::fs::create_dir(folder).map_err(failed)?;
    }
    Ok(missing)
}

/// Refuses to write where anything is: nothing is written over, whatever it is.
pub(super) fn refuse_what_is_there<'p>(paths: impl IntoIterator<Item = &'p PathBuf>) -> Result<(), Failure> {
    match paths.into_iter().find(|path| path.symlink_metadata().is_ok()) {
        Some(path) => Err(Failure::InTheWay { path: path.clone() }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_terminal_obeys_nothing() {
        assert_eq!(printable("a line\n\tof µm"), "a line\n\tof µm");
        assert_eq!(printable("\u{1b}[31mred\u{9b}0m\u{7f}\r"), "␛[31mred\u{fffd}0m␡␍");
        let json = serde_json::to_string("\u{1b}[31m\u{9b}\u{7f}").unwrap();
        assert_eq!(escaped(json), r#""\u001b[31m\u009b\u007f""#);
        assert_eq!(escaped("\"a\u{202e}b\"".to_owned()), r#""a\u202eb""#);
        assert_eq!(printable("a\u{202e}b\u{2066}"), "a\u{fffd}b\u{fffd}");
        assert_eq!(crate::printable::one_line("tip\n\tone"), "tip␊␉one");
    }
}
