//! What the program shows on a terminal: a pseudo-terminal of so many columns.
#![cfg(target_os = "linux")]

use std::fs::File;
use std::io::Read;
use std::process::Stdio;

use rustix::fs::{Mode, OFlags, open};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{Winsize, tcsetwinsize};

use crate::program::Sandbox;

/// Variables that say what a terminal is; a test sets its own.
const OF_TERMINALS: [&str; 6] = ["NO_COLOR", "CLICOLOR_FORCE", "CLICOLOR", "TERM", "COLUMNS", "CI"];

/// All that a command sends to a terminal of so many columns.
fn on_a_terminal(place: &Sandbox, arguments: &str, columns: u16, set: &[(&str, &str)]) -> String {
    let ours = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&ours).unwrap();
    unlockpt(&ours).unwrap();
    let name = ptsname(&ours, Vec::new()).unwrap();
    let theirs = File::from(open(name, OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).unwrap());
    tcsetwinsize(&theirs, Winsize { ws_row: 40, ws_col: columns, ws_xpixel: 0, ws_ypixel: 0 }).unwrap();
    let mut command = place.command(arguments);
    OF_TERMINALS.iter().for_each(|name| {
        command.env_remove(name);
    });
    command.env("TERM", "xterm-256color").envs(set.iter().copied());
    command.stdout(Stdio::from(theirs.try_clone().unwrap())).stderr(Stdio::from(theirs));
    let mut child = command.spawn().unwrap();
    // Its ends of the terminal: what is read ends when the program does.
    drop(command);
    let (mut ours, mut shown, mut part) = (File::from(ours), Vec::new(), [0; 4096]);
    // An error is the end, too: there is nobody any more on the other side.
    while let Ok(1..) = ours.read(&mut part).inspect(|&bytes| shown.extend_from_slice(&part[..bytes])) {}
    child.wait().unwrap();
    String::from_utf8(shown).unwrap()
}

/// The lines of a text as they stand on a terminal, without escapes.
fn bare(text: &str) -> Vec<String> {
    let mut plain = String::new();
    let mut rest = text.chars();
    while let Some(c) = rest.next() {
        match c {
            '\u{1b}' => rest.by_ref().skip(1).find(|c| c.is_ascii_alphabetic()).map_or((), drop),
            c => plain.push(c),
        }
    }
    plain.split(['\n', '\r']).map(str::to_owned).collect()
}

/// Whether a terminal tears a word of a line where it goes on in the next: lines above one that changes in place are filled with
/// blanks up to the last column, and no line feed follows.
fn is_torn(line: &str, columns: usize) -> bool {
    let line: Vec<char> = line.chars().collect();
    let ends = (columns..line.len()).step_by(columns);
    ends.into_iter().any(|end| line[end - 1] != ' ' && line[end] != ' ')
}

/// Escapes of a text that set colours or other looks.
fn looks(text: &str) -> Vec<&str> {
    let escapes = text.match_indices("\u{1b}[").map(|(at, _)| &text[at + 2..]);
    let escapes = escapes.filter_map(|rest| Some(&rest[..=rest.find(|c: char| c.is_ascii_alphabetic())?]));
    escapes.filter(|escape| escape.ends_with('m')).collect()
}

/// A run on a terminal, and a scene that is wrong.
fn place() -> Sandbox {
    let place = Sandbox::new();
    place.write("wrong.toml", crate::program::small_with(&[("rotation_deg = 16.0", "rotation_dge = 16.0")]));
    place
}

#[test]
fn no_line_is_wider_than_the_terminal() {
    let place = place();
    for columns in [60, 80, 120] {
        let log = format!("{columns}.mcap");
        for command in [
            &*format!("run small.toml -o {log}"),
            &format!("inspect {log}"),
            &format!("inspect {log} --step 5"),
            "check small.toml",
            "run wrong.toml",
            "rnu small.toml",
            "scenes",
            "help scene",
            "help run",
            "--help",
        ] {
            let shown = on_a_terminal(&place, command, columns, &[]);
            let lines = bare(&shown);
            assert!(lines.len() > 2, "{command} shows {shown}");
            let wide = lines.iter().find(|line| match command.starts_with("run small") {
                true => is_torn(line, columns.into()),
                false => line.chars().count() > columns.into(),
            });
            let is_excused = |line: &&String| line.split_whitespace().any(|word| word.chars().count() >= 64);
            assert_eq!(wide.filter(|line| !is_excused(line)), None, "{columns}: {command}");
        }
        assert!(!looks(&on_a_terminal(&place, "run wrong.toml", columns, &[])).is_empty());
    }
}

/// A line that changes in place needs escapes that move; colours are another matter, and a terminal without escapes gets none.
#[test]
fn escapes_are_sent_where_they_are_obeyed() {
    let place = place();
    for (index, command) in ["run small.toml -o N.mcap", "run wrong.toml", "--help"].into_iter().enumerate() {
        let shown = |name: &str, set: &[(&str, &str)]| on_a_terminal(&place, &command.replace('N', name), 80, set);
        let plain = shown("plain", &[("NO_COLOR", "1")]);
        assert_eq!(looks(&plain), [""; 0], "{command}: {plain}");
        assert_eq!(plain.contains('\u{1b}'), index == 0, "only a run has a line that changes: {plain:?}");
        let dumb = shown("dumb", &[("TERM", "dumb")]);
        assert!(!dumb.contains('\u{1b}'), "{command}: {dumb:?}");
        if index == 0 {
            assert!(dumb.contains("step    1") || dumb.contains("step"), "a line for each load step: {dumb}");
        }
    }
}
