//! `foldline help`: on a subcommand, or on a topic.

use clap::{Args, Command};

use super::failure::Failure;
use super::output::print;
use crate::scene::help_text;

/// Help on a subcommand, or on the keys of a scene file: `help scene`
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// A subcommand, or `scene`
    topic: Option<String>,
}

const SCENE: &str = "scene";

impl Arguments {
    /// Shows it; `command` has all subcommands.
    pub(super) fn run(self, mut command: Command) -> Result<(), Failure> {
        // Gives the subcommands their full names in usage lines.
        command.build();
        match self.topic.as_deref() {
            None => print(&command.render_long_help().to_string()),
            Some(SCENE) => print(&help_text()),
            Some(topic) => match command.find_subcommand_mut(topic) {
                Some(subcommand) => print(&subcommand.render_long_help().to_string()),
                None => {
                    let names = command.get_subcommands().map(|subcommand| subcommand.get_name().to_string());
                    let known = names.chain([SCENE.to_string()]).collect();
                    Err(Failure::NoSuchTopic { topic: topic.to_string(), known })
                }
            },
        }
    }
}
