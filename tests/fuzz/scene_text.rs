//! What the fuzzer is given for a scene: its text, in which lines that begin with `#!`, comments of TOML, are settings.

use foldline::model::MOST_CONTROL_POINTS;
use foldline::pipeline::Stages;
use foldline::scene::{Scene, SceneError, parse, parse_with_settings};

/// In front of a setting.
pub const SETTING: &str = "#!";

/// Mistakes that are told at most.
const MOST_TOLD: usize = 10;

/// Elements of a start mesh that is made: more take their time.
const MOST_ELEMENTS: usize = 48;

/// Elements of which any part that a symmetry leaves is refused before anything is made of it.
const REFUSED_ELEMENTS: usize = 8 * MOST_CONTROL_POINTS;

/// Reads a scene as every command does before it solves anything: no panic, no mistake that is not told, and a scene that is
/// written is the same one.
pub fn read(text: &str) {
    let settings: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix(SETTING)).collect();
    match parse_with_settings(text, "nowhere/scene.toml", &settings) {
        Ok(scene) => {
            is_written_as_it_is(&scene);
            starts_or_is_refused(scene);
        }
        Err(error) => is_told(&error),
    }
}

fn is_written_as_it_is(scene: &Scene) {
    let written = scene.to_toml();
    let again = parse(&written, "written.toml").unwrap_or_else(|error| panic!("{written}\n{error}"));
    assert_eq!(&again, scene, "{written}");
    assert_eq!(again.hash(), scene.hash(), "{written}");
    assert_eq!(again.to_toml(), written);
    assert!(again.differences(scene).is_empty());
}

/// The state before the first step, and what is said of it.
fn starts_or_is_refused(scene: Scene) {
    let elements: usize = scene.mesh.elements.iter().product();
    if (MOST_ELEMENTS..REFUSED_ELEMENTS).contains(&elements) {
        return;
    }
    let mut stages = Stages::new(scene);
    let said = stages.start().and_then(|state| stages.remarks(&state));
    said.unwrap_or_else(|error| vec![error.to_string()]).iter().for_each(|line| shows_itself(line));
}

fn is_told(error: &SceneError) {
    let plain = error.plain();
    assert!(!error.summary().is_empty() && error.line() >= 1);
    let told = plain.lines().filter(|line| line.starts_with("error: ")).count();
    assert_eq!(told, error.problems().count().min(MOST_TOLD), "{plain}");
    shows_itself(&plain);
    for styled in error.coloured().split("\u{1b}[").skip(1) {
        let (style, text) = styled.split_once('m').expect("a style ends");
        assert!(style.bytes().all(|byte| byte.is_ascii_digit() || byte == b';'), "{style:?}");
        shows_itself(text);
    }
}

/// Nothing that a terminal obeys stands in a text, but line feeds and tabs.
fn shows_itself(text: &str) {
    let turns =
        |c| matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let obeyed = text.chars().find(|c| !matches!(c, '\n' | '\t') && (c.is_control() || turns(*c)));
    assert_eq!(obeyed, None, "{text}");
}
