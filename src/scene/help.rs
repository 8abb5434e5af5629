//! The text of `foldline help scene`, from the table of keys.

use super::key_table::{KEYS, LONGEST_INCREMENT, SECTIONS};
use super::keys::{Key, Kind, Presence, Section};

/// Columns of the help text.
const WIDTH: usize = 96;

const OPENING: &str = "\
A scene is a TOML file that says what is folded and how. Units are the endings of the keys: mm, deg
(degrees), mpa (MPa = N/mm2). Every key is listed here with an example: first those of a tape spring
whose ends turn, then geometry, materials, supports and loads of any other shell.
";

/// Every key of a scene with its unit, its default and an example, and one complete scene that parses.
pub fn help_text() -> String {
    let mut text = OPENING.to_owned();
    for section in &SECTIONS {
        let required = if section.required { "Required." } else { "May be left out." };
        text.push_str(&format!("\n[{}]  {} {required}\n", section.name, section.meaning));
        for key in keys_of(section) {
            text.push_str(&format!("\n  {} = {}\n", key.name, key.example));
            text.push_str(&paragraph(&description(key), 6));
            if let Kind::Word(choices) = &key.kind {
                for choice in *choices {
                    text.push_str(&paragraph(&format!("\"{}\": {}", choice.word, choice.meaning), 8));
                }
            }
        }
    }
    text.push_str("\nA complete scene:\n\n");
    for line in example_scene().lines() {
        text.push_str(format!("  {line}").trim_end());
        text.push('\n');
    }
    text.push_str(GENERAL);
    for line in GENERAL_EXAMPLE.lines() {
        text.push_str(format!("  {line}").trim_end());
        text.push('\n');
    }
    text
}

/// Kinds of tables whose keys depend on the kind.
pub(super) const GENERAL: &str = include_str!("general_help.txt");

/// A scene of such tables.
const GENERAL_EXAMPLE: &str = include_str!("general_example.toml");

/// One scene with every key that can stand beside the others.
pub(super) fn example_scene() -> String {
    let mut text = String::new();
    for section in &SECTIONS {
        let gap = if text.is_empty() { "" } else { "\n" };
        text.push_str(&format!("{gap}[{}]\n", section.name));
        for key in keys_of(section) {
            let comment = match key.presence {
                Presence::InsteadOf(_) => "# or: ",
                // The example goes by arc length, where increments do not grow.
                _ if key == &LONGEST_INCREMENT => "# under load control: ",
                _ => "",
            };
            text.push_str(&format!("{comment}{} = {}\n", key.name, key.example));
        }
    }
    text
}

fn keys_of(section: &'static Section) -> impl Iterator<Item = &'static Key> {
    KEYS.iter().copied().filter(|key| key.section == section.name)
}

fn description(key: &Key) -> String {
    let allowed = match &key.kind {
        Kind::Word(_) => "One of the words below".into(),
        _ => capital(&key.allowed()),
    };
    let default = match key.presence {
        Presence::Required => "Required.".into(),
        Presence::Default(value) => format!("Default: {value}."),
        Presence::Follows(rule) => format!("Default: {rule}."),
        Presence::InsteadOf(other) => format!("In place of {other}."),
    };
    format!("{} {allowed}. {default}", key.meaning)
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Wraps a text, every line indented.
fn paragraph(text: &str, indent: usize) -> String {
    let mut wrapped = String::new();
    let mut line = String::new();
    for word in text.split_whitespace() {
        if !line.is_empty() && indent + line.chars().count() + 1 + word.chars().count() > WIDTH {
            wrapped.push_str(&format!("{:indent$}{line}\n", ""));
            line.clear();
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(word);
    }
    wrapped + &format!("{:indent$}{line}\n", "")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{LengthLimit, Stage, Symmetry, parse};

    #[test]
    fn the_second_example_is_a_scene() {
        let scene = parse(GENERAL_EXAMPLE, "example.toml").unwrap();
        assert_eq!((scene.supports.len(), scene.actions.len(), scene.probes.len()), (1, 1, 2));
    }

    #[test]
    fn the_example_is_a_scene() {
        let scene = parse(&example_scene(), "example.toml").unwrap();
        assert_eq!(scene.pipeline, Stage::REFINING);
        assert_eq!(scene.symmetry, Symmetry::Quarter);
    }

    #[test]
    fn the_alternatives_of_the_example_are_a_scene_too() {
        let text: Vec<_> =
            example_scene().lines().filter(|line| !line.starts_with("length_limit =")).map(String::from).collect();
        let scene = parse(&text.join("\n").replace("# or: ", ""), "example.toml").unwrap();
        assert_eq!(scene.adapt.unwrap().length_limit, LengthLimit::Millimetres([1.0; 2]));
    }

    #[test]
    fn every_key_stands_in_the_help_with_its_default() {
        let text = help_text();
        let unwrapped = text.split_whitespace().collect::<Vec<_>>().join(" ");
        for key in KEYS {
            assert!(text.contains(&format!("  {} = {}\n", key.name, key.example)), "{}", key.path());
            if let Presence::Default(default) = key.presence {
                assert!(unwrapped.contains(&format!("Default: {default}.")), "{}", key.path());
            }
        }
        let widest = text.lines().filter(|line| !line.contains(" = ")).map(|line| line.chars().count()).max();
        assert!(widest <= Some(125));
    }
}
