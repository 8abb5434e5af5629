//! Studies: what is done is done once, whatever kills the program.

use std::collections::BTreeMap;
use std::time::Duration;

use serde_json::Value;

use crate::program::Sandbox;

const STUDY: &str = r#"
title = "small"

[reference]
degree = [4, 4]
part = "none"

[[structure]]
name = "spring"
scene = "small.toml"
published = 2.0
reference = [[12, 4], [10, 4]]
along = [6, 8]

[[uniform]]
degree = [3, 3]
across = 4
columns = ["cubic"]

[[adaptive]]
name = "threshold"
settings = ["adapt.threshold=0.03"]

[[adaptive]]
name = "tolerance"
without = ["adapt", "mesh", "pipeline"]
"#;

const COMMAND: &str = "study study.toml --logs logs --threads 1 --json --set load.rotation_deg=4";

fn place() -> Sandbox {
    let place = Sandbox::new();
    place.write("small.toml", include_str!("small.toml"));
    place.write("study.toml", STUDY);
    place
}

/// The page holds the rows that the study prints; it is written last, and over nothing.
#[test]
fn the_page_of_a_study_holds_its_rows() {
    let place = place();
    let printed = place.foldline(&format!("{COMMAND} --report page.html")).ends(0).out;
    let page = String::from_utf8(std::fs::read(place.file("page.html")).unwrap()).unwrap();
    let (_, rest) = page.split_once("id=\"data\">").unwrap();
    let held: Vec<Value> = serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap();
    let rows: Vec<Value> = printed.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(held, rows);
    place.foldline(&format!("{COMMAND} --report page.html")).ends(2).says(&["page.html exists"]);
    // Of logged runs, by the other command, in no time.
    place.foldline("report study.toml --study-logs logs -o again.html").ends(0);
    let again = String::from_utf8(place.read("again.html")).unwrap();
    assert!(
        again.contains("id=\"data\">")
            && again.matches("\"role\":\"adaptive\"").count() == page.matches("\"role\":\"adaptive\"").count()
    );
    place.write("a.mcap", "");
    place.foldline("report study.toml a.mcap").ends(2).says(&["study.toml is a study", "one of each"]);
}

/// The rows of a study without what differs between two runs of it.
fn rows(text: &str) -> Vec<Value> {
    let timeless = |line: &str| {
        let mut row: Value = serde_json::from_str(line).unwrap();
        row.as_object_mut().unwrap().remove("speed_up");
        if let Some(row) = row["row"].as_object_mut() {
            assert!(row.remove("wall_s").unwrap().as_f64().unwrap() > 0.0);
            row.remove("mesh_s");
        }
        row
    };
    text.lines().map(timeless).collect()
}

/// Every log of a study, by its name.
fn logs(place: &Sandbox) -> BTreeMap<String, Vec<u8>> {
    let Ok(files) = std::fs::read_dir(place.file("logs")) else { return BTreeMap::new() };
    let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
    names
        .filter(|name| name.ends_with(".mcap"))
        .map(|name| (name.clone(), place.read(&format!("logs/{name}"))))
        .collect()
}

#[test]
fn a_finished_study_runs_nothing_again() {
    let place = place();
    let first = place.foldline(COMMAND).ends(0).out;
    let made = logs(&place);
    assert_eq!((rows(&first).len(), made.len()), (9, 6), "{first}");
    let again = place.foldline(COMMAND).ends(0).out;
    assert_eq!(first, again, "with the times that were measured");
    assert_eq!(logs(&place), made);
}

/// A time measured with other threads does not count; a reference counts whatever it was made with.
#[test]
fn a_time_counts_for_its_threads_alone() {
    let place = place();
    let first = rows(&place.foldline(COMMAND).ends(0).out);
    let made = logs(&place);
    let other = rows(&place.foldline(&COMMAND.replace("--threads 1", "--threads 2")).ends(0).out);
    let threadless = |rows: Vec<Value>| {
        let drop = |mut row: Value| {
            _ = row["row"].as_object_mut().and_then(|row| row.remove("threads"));
            row
        };
        rows.into_iter().map(drop).collect::<Vec<_>>()
    };
    assert_eq!(threadless(first), threadless(other));
    let now = logs(&place);
    let same = now.iter().filter(|(name, bytes)| made[*name] == **bytes).count();
    assert_eq!((now.len(), same), (6, 2), "reference and coarser reference");
}

#[test]
fn a_killed_study_gives_the_same_table() {
    let straight = place();
    let expected = rows(&straight.foldline(COMMAND).ends(0).out);
    let place = place();
    let mut kept: BTreeMap<String, Vec<u8>> = BTreeMap::new();
    let mut killed = 0;
    for delay_ms in [30, 60, 90, 120, 150, 200, 250] {
        let mut child = place.command(COMMAND).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(delay_ms));
        child.kill().unwrap();
        killed += usize::from(!child.wait().unwrap().success());
        let now = logs(&place);
        for (name, bytes) in &kept {
            assert_eq!(now.get(name), Some(bytes), "{name} was finished, and is not touched again");
        }
        let is_finished = |name: &str| {
            let log = foldline::journal::Log::read(&place.file(&format!("logs/{name}")));
            let finished = log.is_ok_and(|log| log.completeness() == foldline::journal::Completeness::Finished);
            let timed = place.file(&format!("logs/{}", name.replace(".mcap", ".time.json"))).exists();
            finished && timed
        };
        kept = now.into_iter().filter(|(name, _)| is_finished(name)).collect();
    }
    assert!(killed > 0, "no run was killed");
    assert_eq!(rows(&place.foldline(COMMAND).ends(0).out), expected);
}

/// A log of another scene under the name of a run is not ours to remove.
#[test]
fn a_log_of_another_scene_is_left_alone() {
    let place = place();
    place.foldline(COMMAND).ends(0);
    let made = logs(&place);
    let (one, other) = (made.keys().next().unwrap(), made.keys().next_back().unwrap());
    place.write(&format!("logs/{one}"), &made[other]);
    let said = place.foldline(COMMAND).ends(1);
    said.says(&["is the log of another scene than its name says: move it elsewhere"]);
    assert_eq!(place.read(&format!("logs/{one}")), made[other]);
}

#[test]
fn wrong_studies_are_refused_with_their_place() {
    let place = place();
    let says = |right: &str, wrong: &str, pieces: &[&str]| {
        assert_eq!(STUDY.matches(right).count(), 1, "{right}");
        place.write("wrong.toml", STUDY.replace(right, wrong));
        place.foldline("study wrong.toml --logs logs").ends(2).says(pieces);
    };
    says("across = 4", "acros = 4", &["wrong.toml is no study", "acros = 4", "unknown field `acros`"]);
    says("along = [6, 8]", "along = [8, 6]", &["spring: along = [8, 6] does not go from coarse to fine"]);
    says("scene = \"small.toml\"", "scene = \"nope.toml\"", &["spring: cannot read its scene nope.toml"]);
    says(
        "adapt.threshold=0.03",
        "adapt.treshold=0.03",
        &["did you mean `threshold`?", "in the runs of spring: threshold"],
    );
    place.foldline("study small.toml").ends(2).says(&["small.toml is no study", "--against REFERENCE"]);
    place.foldline("study nope.toml").ends(2).says(&["cannot read nope.toml"]);
    assert!(logs(&place).is_empty(), "nothing was started");
}
