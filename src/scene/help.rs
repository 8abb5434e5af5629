//! The text of `foldline help scene`, from the table of keys.

use super::key_table::SECTIONS;
use super::keys::{Key, Kind, Presence, Section, join_or};

/// Columns of the help text.
const WIDTH: usize = 96;

const OPENING: &str = "\
A scene is a TOML file that says what is folded and how. Units are the endings of the keys: mm, deg
(degrees), mpa (MPa = N/mm2). Every key is listed here with an example. Which keys some tables have
hangs on their `kind`. A tape spring whose ends turn needs no [[support]] and no [[action]]. For any
other problem, choose another kind of geometry, [load] kind = \"steps\", and say with arrays of tables
where the shell is held and what acts on it; model a symmetric part by itself, and give its cut edges
[[support]] tables of kind \"symmetric\". `foldline help scene TOPIC` shows one table, or `places`.
";

/// Name of the topic of [`PLACES`].
const PLACES_TOPIC: &str = "places";

const PLACES: &str = "
PLACES

The surface has two directions, u and v; places are fractions from 0 to 1 of its length or its
angle (for nurbs: of its parameter). Pairs such as mesh.elements and mesh.degree are [along u, along
v]; of a tape spring u runs along the length and v along the arc.
  on = \"u-start\"        the edge u = 0; also \"u-end\" (u = 1), \"v-start\" (v = 0), \"v-end\" (v = 1)
  on = [1.0, 0.5]       the point u = 1, v = 0.5; corners are [0.0, 0.0], [1.0, 0.0], [0.0, 1.0],
                        [1.0, 1.0]
  on = \"u=0.5\"          the line u = 0.5 inside the surface; also \"v=0.25\"
The normal n points along (direction of u) x (direction of v). All axes are right-handed; a positive
moment or rotation about an axis turns as a right-handed screw along it.
";

/// A scene of supports, actions and probes.
const STRUCTURE_EXAMPLE: &str = include_str!("structure_example.toml");

/// Describes every key of a scene with its unit, its default and an example, and gives two complete scenes that parse.
pub fn help_text() -> String {
    let sections: String = SECTIONS.iter().map(of_section).collect();
    let example = |title: &str, scene: &str| {
        let lines = scene.lines().map(|line| format!("  {line}").trim_end().to_owned() + "\n");
        format!("\n{title}:\n\n{}", lines.collect::<String>())
    };
    OPENING.to_owned()
        + &sections
        + PLACES
        + &example("A complete scene", &example_scene())
        + &example("A complete scene with supports and actions of its own", STRUCTURE_EXAMPLE)
}

/// Returns the part of [`help_text`] on one table, by its name, or on `places`; `None` where there is no such topic.
pub fn help_on_topic(topic: &str) -> Option<String> {
    let name = topic.trim_matches(['[', ']']);
    let section = SECTIONS.iter().find(|section| section.name == name);
    let text = section.map(of_section).or((name == PLACES_TOPIC).then(|| PLACES.to_owned()));
    text.map(|text| text.trim_start().to_owned())
}

/// The names of the topics on which there is help.
pub fn help_topics() -> impl Iterator<Item = &'static str> {
    SECTIONS.iter().map(|section| section.name).chain([PLACES_TOPIC])
}

/// A table and its keys.
pub(super) fn of_section(section: &Section) -> String {
    let presence = match (section.many, section.required) {
        (true, _) => "There may be several.",
        (false, true) => "Required.",
        (false, false) => "May be left out.",
    };
    let header = paragraph(&format!("{}  {} {presence}", section.title(), section.meaning), 0);
    section.keys.iter().fold(format!("\n{header}"), |text, key| text + &of_key(key))
}

fn of_key(key: &Key) -> String {
    let mut text = format!("\n  {} = {}\n", key.name, key.example);
    text.push_str(&paragraph(&description(key), 6));
    if let Kind::Word(choices) = key.kind
        && choices.iter().any(|choice| !choice.meaning.is_empty())
    {
        let meaning = |meaning: &str| if meaning.is_empty() { String::new() } else { format!(": {meaning}") };
        for choice in choices {
            text.push_str(&paragraph(&format!("\"{}\"{}", choice.word, meaning(choice.meaning)), 8));
        }
    }
    text
}

/// One scene with every key of a tape spring that can be combined with the others.
pub(super) fn example_scene() -> String {
    let mut text = String::new();
    for section in SECTIONS.iter().filter(|section| !section.many) {
        let gap = if text.is_empty() { "" } else { "\n" };
        text.push_str(&format!("{gap}[{}]\n", section.name));
        for key in section.keys_of(section.example_kind()) {
            let comment = match key.presence {
                // The example goes by arc length, where meshes are refined by a threshold.
                Presence::InsteadOf(_) if key.name == "tolerance" => "# under load control, in its place: ",
                Presence::InsteadOf(_) => "# or: ",
                // The example goes by arc length, where increments do not grow.
                _ if key.name == "longest_increment_deg" => "# under load control: ",
                _ => "",
            };
            text.push_str(&format!("{comment}{} = {}\n", key.name, key.example));
        }
    }
    text
}

fn description(key: &Key) -> String {
    let kinds: Vec<_> = key.kinds.iter().map(|kind| format!("\"{kind}\"")).collect();
    let of = if kinds.is_empty() { String::new() } else { format!("Of kind {}. ", join_or(&kinds)) };
    let allowed = match &key.kind {
        Kind::Word(choices) if choices.iter().any(|choice| !choice.meaning.is_empty()) => {
            "One of the words below".into()
        }
        _ => capital(&key.allowed()),
    };
    format!("{of}{} {allowed}. {}", key.meaning, key.presence.words())
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Wraps a text, every line indented.
fn paragraph(text: &str, indent: usize) -> String {
    let mut wrapped = String::new();
    let mut line = String::new();
    for word in text.split(' ') {
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
    use crate::scene::key_table::all_keys;
    use crate::scene::{LengthLimit, Stage, Symmetry, parse};

    #[test]
    fn the_second_example_is_a_scene() {
        let scene = parse(STRUCTURE_EXAMPLE, "example.toml").unwrap();
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
        for key in all_keys() {
            assert!(text.contains(&format!("  {} = {}\n", key.name, key.example)), "{}", key.path());
            if let Presence::Default(default) = key.presence {
                assert!(unwrapped.contains(&format!("Default: {default}.")), "{}", key.path());
            }
        }
        let widest = text.lines().filter(|line| !line.contains(" = ")).map(|line| line.chars().count()).max();
        assert!(widest <= Some(125));
    }
}
