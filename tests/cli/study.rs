//! `foldline study`: rows, lists of values, what it refuses.

use crate::program::Sandbox;

const SMALL: &str = include_str!("../restart/small.toml");

/// `small.toml` to 4°, and the strip of `path.toml` beside it.
fn place() -> Sandbox {
    let place = Sandbox::new();
    place.write("short.toml", SMALL.replace("rotation_deg = 16.0", "rotation_deg = 4.0").as_bytes());
    place.write("along.toml", include_str!("../restart/path.toml").as_bytes());
    place
}

fn rows(text: &str) -> Vec<serde_json::Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn every_combination_has_a_row_behind_the_reference() {
    let place = place();
    let said = place.foldline(
        "study short.toml --against short.toml --vary mesh.quadrature=[\"full\",\"patch\"] --vary adapt.threshold=[0.019,0.03] --json",
    );
    let rows = rows(&said.ends(0).out);
    let settings: Vec<Vec<&str>> = rows
        .iter()
        .map(|row| row["settings"].as_array().unwrap().iter().map(|setting| setting.as_str().unwrap()).collect())
        .collect();
    assert_eq!(
        settings,
        [
            vec![],
            vec!["mesh.quadrature=\"full\"", "adapt.threshold=0.019"],
            vec!["mesh.quadrature=\"full\"", "adapt.threshold=0.03"],
            vec!["mesh.quadrature=\"patch\"", "adapt.threshold=0.019"],
            vec!["mesh.quadrature=\"patch\"", "adapt.threshold=0.03"],
        ]
    );
    let error = |row: &serde_json::Value| row["error_before"].as_f64().unwrap();
    assert_eq!((error(&rows[0]), error(&rows[1])), (0.0, 0.0), "the same run");
    assert!(error(&rows[3]) > 0.0 && error(&rows[3]) < 0.01, "another rule of quadrature: {}", error(&rows[3]));
    for row in &rows {
        assert_eq!((row["compared"].as_u64(), row["jump_at"].is_null()), (Some(2), true));
        assert!(row["wall_s"].as_f64().unwrap() > 0.0);
    }
}

#[test]
fn the_table_has_the_settings() {
    let place = place();
    let said = place.foldline("study short.toml --against short.toml --vary load.increment_deg=[2.0,1.0]");
    said.ends(0).says(&["run  ", "before", "wall s", "short.toml load.increment_deg=1.0", "0.00 %"]);
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let place = place();
    let says = |arguments: &str, code: i32, pieces: &[&str]| {
        place.foldline(&format!("study short.toml --against {arguments}")).ends(code).says(pieces);
    };
    says("short.toml --vary mesh.quadrature=[full]", 2, &["is not a TOML list", "names need quotes"]);
    says("short.toml --vary mesh.quadrature=\"full\"", 2, &["write the values of mesh.quadrature as a list"]);
    says("short.toml --vary mesh.quadrature=[]", 2, &["mesh.quadrature has no value to take"]);
    says(
        "short.toml --vary mesh.elements=[[4,4]] --vary mesh.elements=[[8,4]]",
        2,
        &["mesh.elements is set more than once"],
    );
    says("short.toml --vary geometry.radius_mm=[11.0]", 2, &["another structure", "geometry.radius_mm: 10.0 -> 11.0"]);
    says("along.toml", 2, &["another structure"]);
    says("short.toml --vary mesh.quadratur=[\"full\"]", 2, &["quadratur"]);
    let alone = place.foldline("study along.toml --against along.toml").ends(2);
    alone.says(&["by arc length a path passes one load factor more than once"]);
    says("nope.toml", 2, &["cannot read nope.toml"]);
    says(
        "short.toml --vary load.increment_deg=[3.0] --vary load.rotation_deg=[3.0]",
        1,
        &["give both the same increment", "1 of 1 runs gave nothing to compare"],
    );
}
