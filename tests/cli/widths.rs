//! What is printed fits the terminal: no line is wider than `COLUMNS` says, but for JSON, CSV, hashes and paths.

use foldline::cli::stage_table;

use crate::program::{Said, Sandbox, small_with};
use crate::synthetic;

const WIDTHS: [usize; 3] = [60, 80, 120];

/// Commands that print tables or prose; each is run after those before it, at each width with files of its own (`N`).
const COMMANDS: [&str; 57] = [
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
    "help scene",
    "help scene load",
    "help scene places",
    "help study",
    "help extremes",
    "help bench",
    "inspect run.mcap --probes",
    "plot run.mcap -o N-plot.svg",
    "report run.mcap -o N-report.html",
    "bench small.toml --elements 8,8 --repeats 1",
    "converge short.toml --degree 3 --elements 8,4 --logs converged",
    "calibrate short.toml --fine 8,8",
    "study short.toml --against short.toml --vary mesh.quadrature=[\"full\",\"patch\"] --logs studied",
    "study study.toml --logs studied",
    "extremes one-element-degree-2 --logs extremes",
    "sweep run sweep.toml --folder N-sweep",
    "sweep status N-sweep",
    "sweep status N-sweep --where radius_mm>99",
    "sweep run wrong-sweep.toml --folder N-wrong",
    "sweep report N-sweep",
    "help sweep",
    "run typo.toml",
    "run unit.toml",
    "run support.toml",
    "run range.toml",
    "run missing.toml",
    "run syntax.toml",
    "run stages.toml",
    "run twice.toml",
    "run small.toml --set load.rotation_dge=7",
    "run nothing.toml",
];

/// Scenes that are wrong in one place each, by their names.
const WRONG: [(&str, &str, &str); 8] = [
    (
        "typo",
        "rotation_deg = 16.0",
        "rotation_dge = 16.0 # how far each of the two ends turns about its own axis, in degrees",
    ),
    ("unit", "length_mm = 300.0", "length_m = 0.3"),
    ("support", "[adapt]", "[[support]]\non = \"u-strat\"\nkind = \"clampd\"\n[adapt]"),
    ("range", "poissons_ratio = 0.3", "poissons_ratio = 0.7"),
    ("missing", "thickness_mm = 0.1", ""),
    ("syntax", "arc_deg = 110.0", "arc_deg = 110,0"),
    ("stages", "\"refine-knots\", \"project-displacements\"", "\"project-displacements\", \"refine-knots\""),
    ("twice", "part = \"quarter\"", "part = \"quarter\"\npart = \"full\""),
];

/// Two meshes against a third.
const STUDY: &str = include_str!("small_study.toml");

/// Designs of which one cannot be.
const SWEEP: &str = r#"
title = "Moments of small springs over their radius, arc and thickness"
scene = "short.toml"
outputs = ["stiffness_n_mm", "last.moment_n_mm", "last.strain_energy_n_mm", "theory_stiffness_n_mm", "theory_peak_n_mm"]
[[axis]]
keys = ["geometry.radius_mm", "geometry.arc_deg", "material.thickness_mm"]
values = [[9, 110, 0.1], [10.123456789, 400, 0.12]]
"#;

#[test]
fn no_line_is_wider_than_the_terminal() {
    let place = Sandbox::new();
    let probes = "\n[[probe]]\nname = \"strain energy of the whole spring\"\nkind = \"energy\"\n";
    place.write("probed.toml", format!("{}{probes}{}", crate::program::SMALL, probes.replace("whole", "very same")));
    place.write("short.toml", small_with(&[("rotation_deg = 16.0", "rotation_deg = 4.0")]));
    place.write("study.toml", STUDY);
    place.write("sweep.toml", SWEEP);
    place.write("wrong-sweep.toml", SWEEP.replace("geometry.radius_mm", "geometry.radius"));
    for (name, right, wrong) in WRONG {
        place.write(&format!("{name}.toml"), small_with(&[(right, wrong)]));
    }
    place.foldline("run probed.toml -o run.mcap").ends(0);
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

/// What a command says at a width, with times and hashes masked.
fn said_at(place: &Sandbox, command: &str, width: usize) -> String {
    let output = place.command(command).env("COLUMNS", width.to_string()).output().unwrap();
    let Said { out, err, .. } = Said::new(command, output);
    let is_time = |word: &str| word.ends_with('s') && word.starts_with(|c: char| c.is_ascii_digit());
    let masked = |line: &str| {
        let words: Vec<&str> = line.split(' ').collect();
        let units = words.iter().skip(1).chain([&""]);
        let words = words.iter().zip(units).map(|(word, unit)| match () {
            _ if is_time(word) || ["s", "s,", "ms", "ms,", "min"].contains(unit) && word.parse::<f64>().is_ok() => "…",
            _ => word,
        });
        words.collect::<Vec<_>>().join(" ")
    };
    (out + &err).lines().map(masked).collect::<Vec<_>>().join("\n")
}

/// What is read most, at each width.
#[test]
fn what_is_read_most() {
    let place = Sandbox::new();
    place.write("unit.toml", small_with(&[(WRONG[1].1, WRONG[1].2)]));
    place.foldline("run small.toml -o run.mcap").ends(0);
    for width in WIDTHS {
        let commands = [
            "scenes cured",
            "run unit.toml",
            "bisect run.mcap --snap",
            "replay run.mcap --step 3",
            "run small.toml -o run.mcap",
            "inspect run.mcap --mesh",
        ];
        let shown = commands.map(|command| format!("$ foldline {command}\n{}\n", said_at(&place, command, width)));
        insta::with_settings!({ omit_expression => true }, {
            insta::assert_snapshot!(format!("read_at_{width}"), shown.join("\n"));
        });
    }
}
