//! `foldline completions`: what a shell completes after `foldline`.

use clap::{Args, Command};
use clap_complete::Shell;

use super::failure::Failure;
use super::output::print_as_it_is;

/// Print the completions of a shell: subcommands, options and their values
#[derive(Args, Debug)]
#[command(after_help = WHERE)]
pub(super) struct Arguments {
    /// The shell
    shell: Shell,
}

const WHERE: &str = "\
Where they are read from:
  bash        ~/.local/share/bash-completion/completions/foldline
  zsh         _foldline, in a folder of $fpath
  fish        ~/.config/fish/completions/foldline.fish
  elvish      ~/.config/elvish/rc.elv, at its end
  powershell  $PROFILE, at its end";

impl Arguments {
    /// Prints them; `command` has all subcommands.
    pub(super) fn run(self, mut command: Command) -> Result<(), Failure> {
        let name = command.get_name().to_owned();
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut command, name, &mut script);
        print_as_it_is(&String::from_utf8_lossy(&script))
    }
}
