//! `foldline new`: a scene to begin with.

use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::Failure;
use super::output::{eprint, file_name, path_in_command, path_in_line, write_files};
use super::shipped::Shipped;

/// Write a scene with comments, which runs as it is and is there to be changed
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// What it is of: tape-spring, plate, panel, annulus, sphere, profile, nurbs, laminate; or the name of one of `foldline scenes`
    #[arg(value_parser = named)]
    kind: &'static Shipped,
    /// File to write; nothing is written over [default: KIND.toml]
    #[arg(short, long, value_name = "FILE", value_parser = file_name())]
    output: Option<PathBuf>,
}

macro_rules! templates {
    ($($name:literal)+) => {
        &[$(Shipped { name: $name, text: include_str!(concat!("templates/", $name, ".toml")) }),+]
    };
}

/// One for each geometry, and a laminate.
const TEMPLATES: &[Shipped] =
    templates! { "tape-spring" "plate" "panel" "annulus" "sphere" "profile" "nurbs" "laminate" };

/// Finds the template of a name, or else the scene that comes with the program.
fn named(name: &str) -> Result<&'static Shipped, String> {
    let template = TEMPLATES.iter().find(|template| template.name == name);
    template.or_else(|| Shipped::named(Path::new(name))).ok_or_else(|| {
        let kinds: Vec<&str> = TEMPLATES.iter().map(|template| template.name).collect();
        format!("there are {}, and the scenes that `foldline scenes` lists", kinds.join(", "))
    })
}

/// A sweep with its scene by the name that it comes with the program under: the path beside it leads nowhere from another folder.
fn away_from_home(text: &str) -> String {
    let named = |line: &str| match line.strip_prefix("scene = \"../").and_then(|rest| rest.strip_suffix(".toml\"")) {
        Some(name) => format!("scene = \"{name}\""),
        None => line.to_owned(),
    };
    text.lines().map(|line| named(line) + "\n").collect()
}

impl Arguments {
    /// Writes the scene where nothing is yet.
    pub(super) fn run(self) -> Result<(), Failure> {
        let file = self.output.unwrap_or_else(|| format!("{}.toml", self.kind.last_name()).into());
        let is_sweep = self.kind.name.starts_with("sweeps/");
        write_files(&[(
            file.clone(),
            if is_sweep { away_from_home(self.kind.text) } else { self.kind.text.to_owned() }.into_bytes(),
        )])?;
        let shown = path_in_line(&file);
        let word = path_in_command(&file);
        let next = match is_sweep {
            true => format!("foldline sweep run {word}"),
            false => format!("foldline check {word}, foldline run {word}"),
        };
        eprint(&format!("{shown} written; next: {next}"));
        Ok(())
    }
}
