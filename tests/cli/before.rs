//! Before a run: scenes that come with the program, a scene to begin with, and what is said of one.

use serde_json::Value;

use crate::program::Sandbox;

/// Lines are no wider than a terminal.
#[track_caller]
fn fits(text: &str) -> &str {
    let wide = text.lines().find(|line| line.chars().count() > 80);
    assert_eq!(wide, None, "{text}");
    text
}

#[test]
fn scenes_are_listed_with_what_they_show() {
    let place = Sandbox::new();
    let all = place.foldline("scenes").ends(0).out;
    insta::assert_snapshot!(fits(&all));
    let chosen = place.foldline("scenes units-").ends(0).out;
    assert!(chosen.matches("extreme/units-m").count() == 2, "{chosen}");
    place.foldline("scenes banana").ends(2).says(&["has `banana` in its name"]);
    let json = place.foldline("scenes --json").ends(0).out;
    let first: Value = serde_json::from_str(json.lines().next().unwrap()).unwrap();
    assert_eq!(json.lines().count(), all.lines().filter(|line| !line.is_empty() && !line.starts_with(' ')).count());
    assert!(first["text"].as_str().unwrap().contains("[geometry]"));
}

#[test]
fn shipped_scenes_run_from_any_folder_and_files_win() {
    let place = Sandbox::new();
    place.foldline("run poisson-0.49 --until 0.4 --quiet").ends(0);
    assert!(place.file("checkpoints/poisson-0.49.mcap").exists());
    assert_eq!(place.log("checkpoints/poisson-0.49.mcap").manifests()[0].scene_file, "extreme/poisson-0.49.toml");
    place.foldline("run baseline-quarter --until 0.4 --quiet").ends(0);
    place.foldline("resume checkpoints/baseline-quarter.mcap --until 0.8 --quiet").ends(0);
    // A file of that name is taken, whatever is in it.
    place.write("baseline", "[geometry]\n");
    place.foldline("run baseline").ends(2).says(&["baseline:1:1"]);
    place.foldline("run basline-path").ends(2).says(&["no such file", "the nearest: baseline-path", "foldline scenes"]);
    place.foldline("check pipelines/length-150.toml").ends(2).says(&["the nearest: length-150"]);
    place.foldline("run my/own.toml").ends(2).says(&["cannot read my/own.toml: there is no such file"]);
    place.foldline("extremes one-element-degree-2").ends(0).says(&["refused", "yes"]);
    place.foldline("extremes arc-020 --scenes nowhere").ends(2).says(&["cannot read nowhere"]);
    // Names of scenes that a study of the program runs are found there too.
    place.foldline("study studies/length --set load.rotation_deg=-1").ends(2).says(&["rotation_deg", "L 150"]);
}

#[test]
fn check_says_what_a_scene_is_and_takes() {
    let place = Sandbox::new();
    let said = |scene: &str| {
        let text = place.foldline(&format!("check {scene} --threads 2")).ends(0).out;
        // What is measured differs from run to run: rows from their heads to the next.
        let mut measured = false;
        let is_kept = |line: &&str| {
            if !line.starts_with("             ") {
                measured = ["  memory", "  load step", "  refined"].iter().any(|head| line.starts_with(head));
            }
            !measured
        };
        fits(&text).lines().filter(is_kept).collect::<Vec<_>>().join("\n")
    };
    insta::assert_snapshot!("check_baseline", said("baseline"));
    insta::assert_snapshot!("check_units_metres", said("units-metres"));
    insta::assert_snapshot!("check_slit_annular_plate", said("slit-annular-plate"));
    place.foldline("check one-element-degree-2").ends(2).says(&["write at least 2 elements"]);
    place.foldline("check no-equilibrium").ends(0).says(&["load step"]);
}

/// Unknowns are those that the run has, and a step takes what its first solves take.
#[test]
fn check_predicts_what_a_run_takes() {
    let place = Sandbox::new();
    for scene in ["baseline-uniform", "hinged-roof-12.7", "cured-plate-saddle"] {
        let line = place.foldline(&format!("check {scene} --json")).ends(0).out;
        let found: Value = serde_json::from_str(&line).unwrap();
        let run = place.foldline(&format!("run {scene} --until 0.06 -o {scene}.mcap --json")).ends(0).out;
        let solves: Vec<Value> = run.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert_eq!(found["unknowns"], solves[0]["unknowns"], "{scene}");
        assert_eq!(found["elements"], solves[0]["elements"], "{scene}");
        assert!(found["step_s"].as_f64().unwrap() > 0.0 && found["odd"].as_array().unwrap().is_empty());
    }
}

#[test]
fn what_looks_odd_is_said_at_the_start_of_a_run() {
    let place = Sandbox::new();
    place.write("gpa.toml", crate::program::small_with(&[("131000.0", "131.0")]));
    let said = place.foldline("run gpa.toml -o a.mcap --until 0.8").ends(0);
    said.says(&["smallest radius 10 mm, R/t 100", "warning: material.youngs_modulus_mpa = 131 is in MPa"]);
    let quiet = place.foldline("run gpa.toml -o b.mcap --until 0.8 --quiet").ends(0);
    assert!(quiet.err.contains("warning: material.youngs_modulus_mpa") && !quiet.err.contains("smallest radius"));
    let well = place.foldline("run small.toml -o c.mcap --until 0.8").ends(0);
    assert!(!well.err.contains("warning"), "{}", well.err);
}

#[test]
fn a_support_that_does_not_hold_is_shown_with_its_lines() {
    let place = Sandbox::new();
    place.foldline("new plate").ends(0);
    let text = String::from_utf8(place.read("plate.toml")).unwrap();
    place.write("free.toml", text.replace("kind = \"clamped\"", "kind = \"hinged\" "));
    for command in ["run", "check"] {
        let refused = place.foldline(&format!("{command} free.toml")).ends(2);
        refused.says(&[
            "do not hold the shell: it can turn about an axis along y",
            "--> free.toml:23",
            "name = \"root\"",
        ]);
    }
    assert!(!place.file("checkpoints").exists());
}

#[test]
fn new_scenes_are_checked_and_run_as_they_are() {
    let place = Sandbox::new();
    for kind in ["tape-spring", "plate", "panel", "annulus", "sphere", "profile", "nurbs", "laminate"] {
        place.foldline(&format!("new {kind}")).ends(0).says(&[&format!("foldline run {kind}.toml")]);
        let text = String::from_utf8(place.read(&format!("{kind}.toml"))).unwrap();
        assert!(text.starts_with("# ") && text.matches("# ").count() >= 3, "{text}");
        assert!(text.lines().all(|line| line.chars().count() <= 140), "{text}");
        place.foldline(&format!("check {kind}.toml")).ends(0).says(&["odd        nothing"]);
        let until = if kind == "tape-spring" { "2" } else { "0.3" };
        place.foldline(&format!("run {kind}.toml --until {until} --quiet")).ends(0);
    }
    place.write("mine.toml", "# mine\n");
    place.foldline("new plate -o mine.toml").ends(2).says(&["exists and is not overwritten"]);
    assert_eq!(place.read("mine.toml"), b"# mine\n");
    place.foldline("new poisson-0.49 -o own.toml").ends(0);
    assert!(place.read("own.toml").starts_with(b"# Poisson's ratio 0.49"));
    place.foldline("new boom").ends(2).says(&["tape-spring, plate, panel", "foldline scenes"]);
}
