//! Colours, completions and manual pages: what the program is to a terminal and to a shell.

use std::process::{Command, Output};

use crate::program::Sandbox;

/// Variables that say whether there are colours.
const COLOURS: [&str; 4] = ["NO_COLOR", "CLICOLOR_FORCE", "CLICOLOR", "TERM"];

/// What a command prints into pipes with some of [`COLOURS`] set and the others not.
fn said(place: &Sandbox, arguments: &str, set: &[(&str, &str)]) -> Output {
    let mut command = place.command(arguments);
    COLOURS.iter().for_each(|name| {
        command.env_remove(name);
    });
    command.envs(set.iter().copied()).output().unwrap()
}

#[test]
fn colours_are_shown_where_they_are_wanted_and_nowhere_else() {
    let place = Sandbox::new();
    place.write("wrong.toml", "[geometry]\nlength_mm = \"long\"\n");
    let (force, no) = (("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1"));
    // An error of a scene, one of the arguments, one of the program, and help on both ways.
    for line in ["run wrong.toml", "rnu wrong.toml", "inspect none.mcap", "run --help", "help run", "--help"] {
        let has_colours = |line: &str, set: &[(&str, &str)]| {
            let Output { stdout, stderr, .. } = said(&place, line, set);
            [stdout, stderr].concat().contains(&0x1b)
        };
        let with = |choice: &str| format!("{line} --color {choice}");
        let before = |choice: &str| format!("--color={choice} {line}");
        assert!(!has_colours(line, &[]), "{line}: a pipe shows none");
        assert!(has_colours(line, &[force]), "{line}");
        assert!(!has_colours(line, &[force, no]), "{line}");
        assert!(!has_colours(&with("never"), &[force]), "{line}");
        for line in [with("always"), before("always")] {
            assert!(has_colours(&line, &[]) && has_colours(&line, &[no]), "{line}");
        }
    }
}

#[test]
fn every_error_has_the_same_head() {
    let place = Sandbox::new();
    place.write("wrong.toml", "[geometry]\nlength_mm = \"long\"\n");
    for line in ["run wrong.toml", "rnu wrong.toml", "inspect none.mcap", "help rnu", "run none.toml", "run"] {
        let Output { stdout, stderr, status } = said(&place, line, &[]);
        let text = String::from_utf8(stderr).unwrap();
        assert!(text.starts_with("error: ") && stdout.is_empty() && !status.success(), "{line}: {text}");
    }
}

#[test]
fn shells_complete_every_subcommand() {
    let place = Sandbox::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = String::from_utf8(said(&place, &format!("completions {shell}"), &[]).stdout).unwrap();
        for word in ["resume", "inspect", "completions", "--color", "until"] {
            assert!(script.contains(word.trim_start_matches('-')), "{shell} has no {word}");
        }
    }
    place.write("foldline.bash", said(&place, "completions bash", &[]).stdout);
    let words = "COMP_WORDS=(foldline ins); COMP_CWORD=1; _foldline foldline ins foldline; echo ${COMPREPLY[@]}";
    let mut bash = Command::new("bash");
    bash.args(["--norc", "-c", &format!("source ./foldline.bash; {words}")]).current_dir(place.path());
    // Not every system has that shell.
    if let Ok(completed) = bash.output() {
        assert_eq!(String::from_utf8_lossy(&completed.stdout), "inspect\n");
    }
}

#[test]
fn every_subcommand_has_a_manual_page() {
    let place = Sandbox::new();
    assert!(said(&place, "man -o pages", &[]).status.success());
    let help = String::from_utf8(said(&place, "--help", &[]).stdout).unwrap();
    let commands = help.split("Commands:").nth(1).and_then(|text| text.split("Options:").next()).unwrap();
    let names = commands.lines().filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
    let names: Vec<&str> = names.filter(|name| !name.is_empty()).collect();
    assert!(names.contains(&"run") && names.contains(&"man"), "{names:?}");
    for name in &names {
        let page = String::from_utf8(place.read(&format!("pages/foldline-{name}.1"))).unwrap();
        assert!(page.contains(".SH NAME") && page.contains(&format!("foldline {name}")), "{name}: {page}");
    }
    assert_eq!(std::fs::read_dir(place.file("pages")).unwrap().count(), names.len() + 1);
    assert_eq!(said(&place, "man -o pages", &[]).status.code(), Some(2), "nothing is written over");
}
