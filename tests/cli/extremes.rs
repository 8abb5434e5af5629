//! `foldline extremes`: its table, its exit codes, its filter.

use std::fs;
use std::process::{Command, Output};

use foldline::cli::ExtremesTable;
use foldline::scene::ExpectedOutcome;
use foldline::study::{ExtremeEnd, ExtremeFault, ExtremeRow};

fn row(scene: &str, outcome: ExtremeEnd) -> ExtremeRow {
    ExtremeRow {
        scene: format!("{scene}.toml"),
        message: outcome.message().map(str::to_owned),
        outcome,
        as_stated: true,
        faults: vec![],
        error: Some(0.0021),
        inexact: None,
        load_steps: 23,
        iterations: 261,
        worst_residual: Some(9.6e-8),
        energy_balance: Some(-0.0021),
        condition: Some(2.9e8),
        symmetry_error: Some(3.1e-17),
        significant_bits: Some(40.3),
        wall_s: 2.46,
    }
}

#[test]
fn table() {
    let stopped = |outcome| ExtremeEnd::Stopped { outcome, message: "step 21, solve: the shell jumps".into() };
    let refused = ExtremeRow {
        error: None,
        load_steps: 0,
        iterations: 0,
        worst_residual: None,
        energy_balance: None,
        condition: None,
        symmetry_error: None,
        significant_bits: None,
        wall_s: 0.001,
        ..row("one-element", ExtremeEnd::Stopped { outcome: ExpectedOutcome::Refused, message: "write 2".into() })
    };
    let broken = ExtremeRow {
        as_stated: false,
        faults: vec![
            ExtremeFault::EndedOtherwise { expected: ExpectedOutcome::Finished, limit_s: 120.0 },
            ExtremeFault::Noise { bits: 5.2, least: 10.0 },
        ],
        error: Some(0.38),
        inexact: Some("elements of 1 mm, and the fold has layers of 0.14 mm".into()),
        significant_bits: Some(5.2),
        wall_s: 133.08,
        ..row("radius-over-thickness-5000", ExtremeEnd::OutOfTime)
    };
    let rows = [
        row("degree-3", ExtremeEnd::Finished),
        row("no-equilibrium", stopped(ExpectedOutcome::JumpNotFollowed)),
        refused,
        broken,
    ];
    let shown = |columns: Option<usize>| {
        let table = ExtremesTable::new(rows.iter().map(|row| row.scene.trim_end_matches(".toml")), columns);
        table.head() + &rows.iter().map(|row| table.row(row)).collect::<String>()
    };
    insta::assert_snapshot!(shown(None));
    for columns in [60, 80, 120] {
        let narrow = shown(Some(columns));
        assert!(narrow.lines().all(|line| line.chars().count() <= columns), "{narrow}");
        assert!(rows.iter().all(|row| narrow.contains(row.outcome.name())), "{narrow}");
    }
    insta::assert_snapshot!("table_at_80", shown(Some(80)));
}

#[test]
fn json() {
    let text = serde_json::to_string_pretty(&row("degree-3", ExtremeEnd::Finished)).unwrap();
    insta::assert_snapshot!(text);
}

/// A folder with a scene that ends as it states and one that does not.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let scene =
        include_str!("../../pipelines/baseline-quarter.toml").replace("rotation_deg = 60.0", "rotation_deg = 0.4");
    fs::write(folder.path().join("right.toml"), &scene).unwrap();
    fs::write(folder.path().join("wrong.toml"), scene + "\n[expect]\noutcome = \"no-equilibrium\"\n").unwrap();
    folder
}

fn extremes(folder: &tempfile::TempDir, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_foldline"));
    command
        .arg("extremes")
        .arg("--scenes")
        .arg(folder.path())
        .args(arguments)
        .current_dir(folder.path())
        .output()
        .unwrap()
}

#[test]
fn the_exit_code_says_whether_all_ended_as_stated() {
    let folder = folder();
    for (filter, code) in [("right", 0), ("wrong", 1), ("r", 1)] {
        let output = extremes(&folder, &[filter, "--json"]);
        assert_eq!(output.status.code(), Some(code), "{filter}");
        let text = String::from_utf8(output.stdout).unwrap();
        for line in text.lines() {
            let row: serde_json::Value = serde_json::from_str(line).unwrap();
            assert_eq!(row["outcome"], "finished");
            assert_eq!(row["as_stated"], row["scene"] == "right.toml", "{line}");
        }
        assert_eq!(text.lines().count(), if filter == "r" { 2 } else { 1 });
    }
}

#[test]
fn a_filter_that_nothing_matches_lists_what_there_is() {
    let folder = folder();
    let output = extremes(&folder, &["steel"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
    let place = folder.path().display().to_string();
    let text = String::from_utf8(output.stderr).unwrap().replace(&place, "FOLDER");
    insta::assert_snapshot!(text, @"error: no scene in FOLDER has `steel` in its name; there is right, wrong");
    assert_eq!(extremes(&tempfile::tempdir().unwrap(), &[]).status.code(), Some(2), "a folder without scenes");
}
