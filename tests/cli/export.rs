//! States in the formats of other programs: what is written and where, and that it is the shell. What ParaView makes of it is in
//! `paraview.py`.

use std::sync::OnceLock;

use crate::program::{Sandbox, Straight};

/// A quarter that refines and snaps.
fn sandbox() -> Sandbox {
    static RUN: OnceLock<Straight> = OnceLock::new();
    let run = RUN.get_or_init(|| Straight::run(crate::program::SMALL, 2));
    let place = Sandbox::new();
    place.write("run.mcap", &run.bytes);
    place
}

fn text(place: &Sandbox, file: &str) -> String {
    String::from_utf8(place.read(file)).unwrap()
}

/// Columns of a table by name.
fn column(csv: &str, name: &str) -> Vec<f64> {
    let mut lines = csv.lines();
    let index = lines.next().unwrap().split(',').position(|column| column == name).unwrap();
    lines.map(|line| line.split(',').nth(index).unwrap().parse().unwrap()).collect()
}

fn pin(name: &str, text: &str) {
    insta::with_settings!({ omit_expression => true }, { insta::assert_snapshot!(name, text) });
}

#[test]
fn fields_are_listed() {
    pin("export-fields", &sandbox().foldline("export run.mcap --list-fields").ends(0).out);
}

#[test]
fn a_series_for_paraview() {
    let place = sandbox();
    let said = place.foldline("export run.mcap --to vtu -o p --steps 1,3-4 --fields thickness").ends(0);
    pin("export-vtu", &said.out);
    pin("export-pvd", &text(&place, "p/run.pvd"));
    let xml = text(&place, "p/run-00001.vtu");
    // The whole of 4 × 4 elements, each with 4 × 4 points.
    assert!(xml.contains("<Piece NumberOfPoints=\"256\" NumberOfCells=\"16\">"), "{xml}");
    for array in ["RationalWeights", "HigherOrderDegrees", "displacement", "thickness", "rotation_deg", "state_hash"] {
        assert!(xml.contains(&format!("Name=\"{array}\"")), "{array}");
    }
    assert!(!xml.contains("bending"));
    assert!(text(&place, "p/run-knots-00001.vtu").contains("NumberOfCells=\"40\""));
}

#[test]
fn a_table_has_the_whole_shell() {
    let place = sandbox();
    place.foldline("export run.mcap --to csv -o t.csv --points 3 --steps 1").ends(0);
    let csv = text(&place, "t.csv");
    assert_eq!(csv.lines().count(), 1 + 16 * 9);
    let [x0, y0, z0] = ["x0_mm", "y0_mm", "z0_mm"].map(|name| column(&csv, name));
    // A cylinder of radius 10 over 300 mm, 110° wide.
    assert!(y0.iter().zip(&z0).all(|(y, z)| (y.hypot(*z) - 10.0).abs() < 1e-12));
    assert!(x0.iter().all(|x| (-1e-9..=300.0 + 1e-9).contains(x)));
    assert!((y0.iter().fold(0.0, |most: f64, y| most.max(y.abs())) - 10.0 * 55f64.to_radians().sin()).abs() < 1e-12);
    // Fields are those of the element, a touch inside it.
    let [x, u] = ["x_mm", "displacement_x"].map(|name| column(&csv, name));
    assert!((0..x.len()).all(|k| (x[k] - x0[k] - u[k]).abs() < 1e-9));
    // Images are beyond the planes where the model ends, and displacements with them.
    let v = column(&csv, "v");
    assert!(column(&csv, "u").iter().zip(&u).all(|(at, u)| *at != 0.5 || u.abs() < 1e-9));
    assert!(y0.iter().zip(&v).all(|(y, v)| *v != 0.5 || y.abs() < 1e-12));
    assert!(y0.iter().zip(&v).all(|(y, v)| (v - 0.5) * y >= 0.0));
}

#[test]
fn records_say_units_and_agree_with_the_table() {
    let place = sandbox();
    place.foldline("export run.mcap --to csv -o t.csv --points 2 --steps 5 --fields membrane_force").ends(0);
    place.foldline("export run.mcap --to json -o t.json --points 2 --steps 5 --fields membrane_force").ends(0);
    let json: serde_json::Value = serde_json::from_slice(&place.read("t.json")).unwrap();
    assert_eq!(json["state"]["step"], 5.0);
    assert_eq!(json["fields"][0]["unit"], "N/mm");
    let shear = column(&text(&place, "t.csv"), "membrane_force_12");
    let points = json["points"].as_array().unwrap();
    assert_eq!(points.len(), shear.len());
    assert!(points.iter().zip(&shear).all(|(point, shear)| point["membrane_force"][2] == *shear));
}

#[test]
fn arrays_are_written_a_file_a_mesh() {
    let place = sandbox();
    let said = place.foldline("export run.mcap --to npz -o arrays").ends(0);
    pin("export-npz", &said.out);
    let bytes = place.read(said.out.lines().next().unwrap());
    // Stored, not compressed: arrays can be found in the archive as they are.
    assert!(bytes.starts_with(b"PK\x03\x04"));
    let has = |text: &str| bytes.windows(text.len()).any(|window| window == text.as_bytes());
    assert!(has("control_points.npy") && has("'shape': (9, 9, 4,)"));
    let said = place.foldline("export run.mcap --to npz -o all.npz").ends(2);
    said.says(&["the load steps lie on", "--steps"]);
}

#[test]
fn triangles_and_nurbs_of_the_deformed_surface() {
    let place = sandbox();
    place.foldline("export run.mcap --to stl -o t.stl --points 3 --steps 1").ends(0);
    let stl = place.read("t.stl");
    let triangles = u32::from_le_bytes(stl[80..84].try_into().unwrap()) as usize;
    assert_eq!((triangles, stl.len()), (16 * 8, 84 + 50 * 16 * 8));
    place.foldline("export run.mcap --to step -o t.step --steps 1").ends(0);
    let step = text(&place, "t.step");
    assert!(step.starts_with("ISO-10303-21;") && step.ends_with("END-ISO-10303-21;\n"));
    // Four elements of degree 3 along, of two halves that share a line of multiplicity 3.
    assert!(step.contains("(4,1,3,1,4)"), "{step}");
    assert_eq!(step.matches("ORIENTED_EDGE").count(), 4);
}

/// What viewers are shown of a log that has no mesh history: a picture a load step, reports and lines of every stage.
#[test]
fn a_file_for_viewers() {
    let place = sandbox();
    let said = place.foldline("export run.mcap --to mcap").ends(0);
    assert_eq!(said.out, "run-view.mcap\n");
    let seen = |file: &str, topic: &str| -> Vec<(u64, serde_json::Value)> {
        let bytes = place.read(file);
        let messages = mcap::MessageStream::new(&bytes).unwrap().map(Result::unwrap);
        let of_topic = messages.filter(|message| message.channel.topic == topic);
        of_topic.map(|message| (message.log_time, serde_json::from_slice(&message.data).unwrap())).collect()
    };
    let log = place.log("run.mcap");
    let steps: std::collections::BTreeSet<u64> = log.entries().iter().map(|entry| entry.record.report.step).collect();
    let pictures = seen("run-view.mcap", "/foldline/scene");
    let times: Vec<u64> = pictures.iter().map(|(time, _)| *time / 100_000_000).collect();
    assert_eq!(times, steps.iter().copied().collect::<Vec<_>>(), "a tenth of a second each");
    let reports = seen("run-view.mcap", "/foldline/report");
    assert_eq!(reports.len(), log.commits());
    assert!(reports.is_sorted_by_key(|(time, _)| *time));
    let lines = seen("run-view.mcap", "/foldline/log");
    let words: Vec<&str> = lines.iter().map(|(_, line)| line["message"].as_str().unwrap()).collect();
    let text = words.join("\n");
    pin("export-mcap-lines", &text);

    place.foldline("export run.mcap --to mcap -o wall.mcap --times wall --every 2 --fields energy_density").ends(0);
    let wall = seen("wall.mcap", "/foldline/scene");
    assert!(wall.len() < pictures.len() && wall.is_sorted_by_key(|(time, _)| *time));
    let last = seen("wall.mcap", "/foldline/report").last().unwrap().0 as f64 * 1e-9;
    let all: f64 = log.entries().iter().map(|entry| entry.record.wall_s + entry.record.kept_s).sum();
    assert!((last - all).abs() < 1e-6 + 1e-6 * all, "{last} of {all} s");
    let legend = wall[0].1["entities"][0]["texts"][0]["text"].as_str().unwrap();
    assert!(legend.starts_with("energy density (N·mm/mm²): "), "{legend}");
    // Colours mean the same in every picture.
    assert!(wall.iter().all(|(_, scene)| scene["entities"][0]["texts"][0]["text"] == legend));
}

#[test]
fn what_cannot_be_written_is_refused_before_anything_is() {
    let place = sandbox();
    for (arguments, words) in [
        ("--to vtu --fields membrane_farce", "did you mean `membrane_force`?"),
        ("--to vtu --steps 400", "has no load step 400; it has 1 to"),
        ("--to step -o a.step --every 2", "a.step is one file, and"),
        ("--to stl --steps 3-1", "beyond its last one"),
        ("--to mcap --fields thickness,indicator", "2 fields are chosen, and one colours the mesh"),
        ("--to mcap --times noon", "invalid value 'noon'"),
        ("--to csv --points 1", "1 is not in 2..=100"),
        ("--to obj", "invalid value 'obj'"),
        ("", "--to <FORMAT>"),
    ] {
        let said = place.foldline(&format!("export run.mcap {arguments}")).ends(2);
        assert!(said.err.contains(words), "{arguments}: {}", said.err);
        assert_eq!(place.logs(), ["run.mcap"], "{arguments}");
    }
    place.write("here.stl", "mine");
    let said = place.foldline("export run.mcap --to stl -o here.stl").ends(2);
    assert!(said.err.contains("here.stl exists and is not overwritten"), "{}", said.err);
}

#[test]
fn a_thinned_log_writes_the_same() {
    let place = sandbox();
    place.foldline("export run.mcap --to step -o whole.step --steps 5").ends(0);
    place.foldline("thin run.mcap -o thin.mcap --keep every=100").ends(0);
    place.foldline("export thin.mcap --to step -o thin.step --steps 5").ends(0);
    let geometry = |file| text(&place, file).split_once("#14=").unwrap().1.replace("thin, load", "run, load");
    assert_eq!(geometry("whole.step"), geometry("thin.step"));
}
