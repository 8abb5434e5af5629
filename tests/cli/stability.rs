//! What the program says of stability: critical points told apart, soft modes, meshes compared.

use std::sync::OnceLock;

use foldline::journal::Log;

use crate::program::{Said, Sandbox, Straight};

const ROOF: &str = include_str!("../restart/path.toml");
const COLUMN: &str = include_str!("../restart/column.toml");

/// The roof's path by arc length.
fn roof() -> &'static Straight {
    static RUN: OnceLock<Straight> = OnceLock::new();
    RUN.get_or_init(|| Straight::run(ROOF, 2))
}

/// The column under load control, with no stage that leaves the straight branch.
fn column() -> &'static Straight {
    static RUN: OnceLock<Straight> = OnceLock::new();
    RUN.get_or_init(|| {
        let (head, _) = COLUMN.split_once("[continuation]").unwrap();
        Straight::run(head, 2)
    })
}

fn with(run: &Straight) -> Sandbox {
    let place = Sandbox::new();
    place.write("run.mcap", &run.bytes);
    place
}

/// The number behind a piece of text.
fn number_after(text: &str, piece: &str) -> f64 {
    let (_, rest) = text.split_once(piece).unwrap_or_else(|| panic!("no {piece:?} in {text}"));
    let rest = rest.trim_start();
    let end = rest.find(|c: char| !"+-.e0123456789".contains(c)).unwrap_or(rest.len());
    rest[..end].parse().unwrap_or_else(|_| panic!("no number behind {piece:?} in {text}"))
}

/// Words of what a command prints, with every number a `#`: digits are for tests of their own.
fn words(text: &str) -> String {
    let mut plain = String::new();
    for word in text.split_inclusive(char::is_whitespace) {
        let body = word.trim_end().trim_matches(|c| "(),;°".contains(c));
        plain.push_str(&if body.parse::<f64>().is_ok() { word.replace(body, "#") } else { word.to_owned() });
    }
    plain
}

fn pin(name: &str, text: &str) {
    insta::with_settings!({ omit_expression => true }, { insta::assert_snapshot!(name, text) });
}

#[test]
fn a_limit_point_is_called_one() {
    let place = with(roof());
    let said = place.foldline("bisect run.mcap --snap").ends(0);
    said.says(&[
        "kind                 limit point: 1 pivot of the stiffness changed sign",
        "negative pivots      0 before",
    ]);
}

#[test]
fn a_limit_point_lies_where_the_path_passed_it() {
    let place = with(roof());
    let said = place.foldline("bisect run.mcap --snap --tolerance 1e-5").ends(0);
    let [below, beyond] = [number_after(&said.out, "critical load"), number_after(&said.out, " to ")];
    assert!(below < beyond && beyond - below <= 1e-5 + 1e-9, "{}", said.out);
    let log = roof().log();
    let passed = log.entries().iter().find(|entry| entry.record.report.critical_point.is_some()).unwrap();
    let at = passed.record.report.parameter;
    // The scene locates it to 0.001.
    assert!((below - at).abs() <= 1e-3, "{below} and {at}");
    assert!(number_after(&said.out, "eigenvalue") > 0.0, "the last stable state is stable: {}", said.out);
}

#[test]
fn a_bifurcation_is_called_one() {
    let place = with(column());
    let said = place.foldline("bisect run.mcap --snap").ends(0);
    let below = number_after(&said.out, "critical load");
    // Euler's load is 1; what the column is shortened by and the mesh of eight elements change it by less than 0.2 %.
    assert!((below - 1.0).abs() < 2e-3, "{}", said.out);
    pin("bisect_of_a_bifurcation", &words(&said.out));
}

#[test]
fn a_run_on_an_unstable_branch_says_so() {
    let place = with(column());
    place.foldline("inspect run.mcap").ends(0).says(&["the last equilibrium is not stable", "1 negative pivot"]);
    let place = Sandbox::new();
    place.write("column.toml", COLUMN.split_once("[continuation]").unwrap().0);
    place.foldline("run column.toml -o run.mcap").ends(0).says(&["not stable (1 negative pivot)"]);
}

fn ends_of_steps(log: &Log) -> usize {
    let steps = log.entries().iter().map(|entry| entry.record.report.step);
    steps.max().unwrap() as usize
}

/// One row for each load step; the sign of the eigenvalue is that of the stiffness.
#[test]
fn eigenvalues_along_a_run() {
    for run in [roof(), column()] {
        let place = with(run);
        let said = place.foldline("stability run.mcap").ends(0);
        let mut lines = said.out.lines();
        assert_eq!(lines.next(), Some(" step   parameter   negative pivots   lowest eigenvalue N/mm"));
        let rows: Vec<&str> = lines.collect();
        assert_eq!(rows.len(), ends_of_steps(&run.log()), "{}", said.out);
        let mut unstable = 0;
        for (index, row) in rows.iter().enumerate() {
            let cells: Vec<&str> = row.split_whitespace().collect();
            assert_eq!(cells[0], (index + 1).to_string());
            let [pivots, eigenvalue] = [2, 3].map(|cell| cells[cell].parse::<f64>().unwrap());
            assert_eq!(eigenvalue < 0.0, pivots > 0.0, "{row}");
            assert_eq!(row.ends_with("not stable"), pivots > 0.0, "{row}");
            unstable += usize::from(pivots > 0.0);
        }
        assert!(unstable > 0 && unstable < rows.len(), "{}", said.out);
        assert_eq!(place.read("run.mcap"), run.bytes, "the log is only read");
    }
}

#[test]
fn one_step_with_its_mode() {
    let place = with(column());
    let last = ends_of_steps(&column().log());
    let said = place.foldline(&format!("stability run.mcap --step {last} -o pictures")).ends(0);
    pin("stability_of_a_step", &words(&said.out));
    // The free end moves most, out of the plane.
    said.says(&["moves most at (100, ", "lowest eigenvalue    -"]);
    let svg = String::from_utf8(place.read("pictures/mode.svg")).unwrap();
    assert!(svg.contains("<svg") && svg.contains("Mode of the lowest eigenvalue"), "{svg}");
    assert!(svg.contains("a mode has no size") && svg.contains(">equilibrium<"), "{svg}");
    assert!(String::from_utf8(place.read("pictures/mode.vtu")).unwrap().contains("UnstructuredGrid"));
    place.foldline("stability run.mcap --step 1").ends(0).says(&["load step 1,", "stable, 0 negative pivots"]);
}

#[test]
fn wrong_questions_about_stability() {
    let place = with(column());
    let last = ends_of_steps(&column().log());
    let said = place.foldline("stability run.mcap --step 99").ends(2);
    assert_eq!(said.err, format!("error: run.mcap has no load step 99; it has 1 to {last}\n"));
    assert_eq!(said.out, "");
    place.foldline("stability run.mcap --step 0").ends(2).says(&["it has 1 to"]);
    place.foldline("stability run.mcap --step one").ends(2).says(&["one"]);
    place.foldline("stability run.mcap -o pictures").ends(2).says(&["--step"]);
    place.foldline("stability none.mcap").ends(2).says(&["none.mcap", "No such file"]);
    place.foldline("stability").ends(2);
}

/// A tape spring on two meshes that are as coarse as can be.
#[test]
fn meshes_compared() {
    let place = Sandbox::new();
    let coarse = "converge small.toml --degree 3 --elements 8,4 --elements 12,4";
    let said = place.foldline(coarse).ends(0);
    let rows: Vec<Vec<&str>> = said.out.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(rows.len(), 3, "{}", said.out);
    for (row, elements) in rows[1..].iter().zip(["8×4", "12×4"]) {
        assert_eq!(row[..2], ["3", elements], "{}", said.out);
        let [peak, limit] = [3, 5].map(|cell| row[cell].parse::<f64>().unwrap());
        // Coarse meshes are too stiff; the fine ones give 292 N·mm and 9.9°.
        assert!((285.0..350.0).contains(&peak) && (9.0..13.0).contains(&limit), "{}", said.out);
    }
    let said = place.foldline("converge small.toml --degree 3 --elements 8,4 --unstable-at 10 --json").ends(0);
    let row: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    for key in
        ["degree", "elements", "unknowns", "peak", "limit", "fold_begins", "unstable_n_mm", "fold_n_mm", "wall_s"]
    {
        assert!(row.get(key).is_some_and(|value| !value.is_null()), "{key} in {}", said.out);
    }
}

#[test]
fn wrong_meshes_to_compare() {
    let place = Sandbox::new();
    place.write("roof.toml", ROOF);
    let refused = |arguments: &str, code: i32| -> Said { place.foldline(arguments).ends(code) };
    refused("converge small.toml --degree 1", 2).says(&["1 is not in 2..=5"]);
    refused("converge small.toml --degree 6", 2).says(&["6 is not in 2..=5"]);
    refused("converge small.toml --elements 8", 2).says(&["elements"]);
    refused("converge small.toml --elements 8,x", 2).says(&["elements"]);
    refused("converge small.toml --elements 8,5", 2).says(&["elements"]);
    refused("converge small.toml --elements 0,4", 2).says(&["elements"]);
    refused("converge small.toml --unstable-at high", 2).says(&["--unstable-at"]);
    refused("converge none.toml", 2).says(&["none.toml", "there is no such file"]);
    refused("converge", 2);
    let said = refused("converge roof.toml --degree 3 --elements 4,4", 2);
    said.says(&["only a tape spring whose ends turn", "load.kind = \"end-rotation\""]);
}

/// A probe is asked for by its name, and what is no number is no field.
#[test]
fn a_condition_on_a_probe() {
    let place = with(roof());
    let when = |condition: &str| {
        let output = place.command("bisect run.mcap --when").arg(condition).output().unwrap();
        Said::new(condition, output)
    };
    let log = place.log("run.mcap");
    let deep = |report: &foldline::record::Report| report.probes.iter().any(|probe| probe.value < -5.0);
    let first = log.entries().iter().position(|entry| deep(&entry.record.report)).unwrap();
    let step = log.entries()[first].record.report.step;
    let table = when("w_c < -5").ends(0).out;
    assert!(table.lines().last().unwrap().split_whitespace().any(|word| word == step.to_string()), "{step}: {table}");
    when("w_c > 1e9").ends(1);
    when("w_c > nan").ends(2).says(&["`nan` is not a number"]);
    when("probes < -5").ends(2).says(&["reports have no field `probes`", "w_c"]);
}
