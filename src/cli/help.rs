//! `foldline help`: on a subcommand, or on a topic.

use clap::{Args, Command};

use super::failure::Failure;
use super::output::{print, print_as_it_is, print_styled};
use crate::scene::{help_on_topic, help_text, help_topics, json_schema};

/// Help on a subcommand, or on the keys of a scene file: `help scene`
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// A subcommand, or `scene`
    topic: Option<String>,
    /// Of `scene`: the name of one of its tables, or `places`
    part: Option<String>,
    /// Of `scene`: a JSON Schema, with which editors complete and check scenes
    #[arg(long, requires = "topic", conflicts_with = "part")]
    json_schema: bool,
}

const SCENE: &str = "scene";

impl Arguments {
    /// Shows it; `command` has all subcommands.
    pub(super) fn run(self, mut command: Command) -> Result<(), Failure> {
        // Gives the subcommands their full names in usage lines.
        command.build();
        match (self.topic.as_deref(), self.part.as_deref()) {
            (None, _) => print_styled(&command.render_long_help()),
            (Some(SCENE), _) if self.json_schema => print_as_it_is(&json_schema()),
            (Some(SCENE), None) => print(&help_text()),
            (Some(SCENE), Some(part)) => match help_on_topic(part) {
                Some(text) => print(&text),
                None => Err(no_such_topic(part, help_topics().map(str::to_owned))),
            },
            (Some(topic), part) => match command.find_subcommand_mut(topic) {
                Some(subcommand) if part.is_none() && !self.json_schema => print_styled(&subcommand.render_long_help()),
                _ => {
                    let names = command.get_subcommands().map(|subcommand| subcommand.get_name().to_string());
                    let topic = part.map_or(topic.to_owned(), |part| format!("{topic} {part}"));
                    Err(no_such_topic(&topic, names.chain([SCENE.to_string()])))
                }
            },
        }
    }
}

fn no_such_topic(topic: &str, known: impl Iterator<Item = String>) -> Failure {
    Failure::NoSuchTopic { topic: topic.to_string(), known: known.collect() }
}
