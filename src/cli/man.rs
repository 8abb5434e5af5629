//! `foldline man`: the help as manual pages.

use std::io;
use std::path::{Path, PathBuf};

use clap::{Args, Command};
use clap_mangen::Man;

use super::failure::Failure;
use super::output::{eprint, file_name, path_in_line, write_files};
use crate::units::count;

/// Write the manual pages, one for each subcommand: foldline.1, foldline-run.1, …
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// Folder to write them to; nothing there is written over
    #[arg(short, long, value_name = "FOLDER", value_parser = file_name())]
    output: PathBuf,
}

impl Arguments {
    /// Writes them; `command` has all subcommands.
    pub(super) fn run(self, mut command: Command) -> Result<(), Failure> {
        // Gives the subcommands their full names, and the options of all.
        command.build();
        let pages = std::iter::once(&command).chain(command.get_subcommands());
        let files = pages.map(|command| page(command, &self.output)).collect::<io::Result<Vec<_>>>();
        let files = files.map_err(|source| Failure::Write { path: self.output.clone(), source })?;
        write_files(&files)?;
        let shown = path_in_line(&self.output);
        eprint(&format!("{} written to {shown}; read one with: man {shown}/foldline.1", count(files.len(), "page")));
        Ok(())
    }
}

/// The page of a command, and where it goes.
fn page(command: &Command, folder: &Path) -> io::Result<(PathBuf, Vec<u8>)> {
    let page = Man::new(command.clone()).source(concat!("foldline ", env!("CARGO_PKG_VERSION")));
    let mut roff = Vec::new();
    page.render(&mut roff)?;
    Ok((folder.join(page.get_filename()), roff))
}
