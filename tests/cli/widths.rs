//! What is printed fits the terminal: no line is wider than `COLUMNS` says, but for JSON, CSV, hashes and paths.

use foldline::cli::stage_table;

use crate::program::{Said, Sandbox};
use crate::synthetic;

const WIDTHS: [usize; 3] = [60, 80, 120];

/// Commands that print tables or prose; each is run after those before it, at each width with files of its own (`N`).
const COMMANDS: [&str; 26] = [
    "run small.toml -o N-run.mcap",
    "run small.toml -o N-until.mcap --until 7",
    "resume N-until.mcap",
    "run small.toml -o N-run.mcap",
    "inspect run.mcap",
    "inspect run.mcap --step 5",
    "inspect run.mcap --mesh",
    "inspect run.mcap --step 99",
    "inspect nothing.mcap",
    "verify run.mcap",
    "replay run.mcap --step 3",
    "stability run.mcap",
    "stability run.mcap --step 4",
    "compare run.mcap N-run.mcap",
    "bisect run.mcap N-run.mcap",
    "bisect run.mcap --snap",
    "thin run.mcap -o N-thin.mcap --keep every=3",
    "recover run.mcap -o N-recovered.mcap",
    "export run.mcap --list-fields",
    "check small.toml",
    "scenes",
    "--help",
    "help run",
    "help export",
    "rnu small.toml",
    "man -o N-pages",
];

#[test]
fn no_line_is_wider_than_the_terminal() {
    let place = Sandbox::new();
    place.foldline("run small.toml -o run.mcap").ends(0);
    let mut wide = String::new();
    for width in WIDTHS {
        for command in COMMANDS {
            let command = command.replace("N-", &format!("{width}-"));
            let output = place.command(&command).env("COLUMNS", width.to_string()).output().unwrap();
            let Said { out, err, .. } = Said::new(&command, output);
            for line in out.lines().chain(err.lines()) {
                // A hash cannot be broken.
                let is_excused = line.split_whitespace().any(|word| word.chars().count() >= 64);
                if line.chars().count() > width && !is_excused {
                    wide += &format!("{width}: {command}: {line}\n");
                }
            }
        }
    }
    assert!(wide.is_empty(), "{wide}");
}

#[test]
fn a_narrow_table_leaves_columns_out() {
    for width in WIDTHS {
        let table = stage_table(&synthetic::coarse_records(), Some(width));
        assert!(table.lines().all(|line| line.chars().count() <= width), "{table}");
        insta::assert_snapshot!(format!("stages_at_{width}"), table);
    }
}

#[test]
fn the_meshes_of_a_run() {
    let place = Sandbox::new();
    place.foldline("run small.toml -o run.mcap --until 7").ends(0);
    let output = place.command("inspect run.mcap --mesh").env("COLUMNS", "60").output().unwrap();
    insta::assert_snapshot!(String::from_utf8(output.stdout).unwrap());
}
