//! Logs of every layout that there ever was are read, or refused, as they always were.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use foldline::journal::{
    Completeness, JournalWriter, Level, Log, Manifest, RecoverOutcome, format::FORMAT_VERSION, recover, verify_log,
};
use foldline::pipeline::{Ending, Run, Stages};
use foldline::record::NUMERICS_REVISION;
use foldline::scene::{Scene, Stage, SyncPolicy};
use foldline::state::{Rejection, State};

use crate::program::{Sandbox, scene};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("checkpoints/golden")
}

/// A row of the table in the folder's `README.md`.
struct Row {
    completeness: String,
    stages: usize,
    later: u64,
    recovered: String,
    last_chain_hash: String,
}

/// The table, by the names of the logs.
fn table() -> BTreeMap<String, Row> {
    let text = fs::read_to_string(folder().join("README.md")).unwrap();
    let cells = |line: &str| line.split('|').map(|cell| cell.trim().trim_matches('`').to_owned()).collect::<Vec<_>>();
    let rows = text.lines().filter(|line| line.starts_with("| `v")).map(cells);
    rows.map(|cells| {
        let [_, name, completeness, stages, later, recovered, last_chain_hash, _] =
            cells.try_into().unwrap_or_else(|cells| panic!("{cells:?}"));
        let number = |text: String| text.parse().unwrap_or_else(|_| panic!("{text}"));
        let (stages, later) = (number(stages) as usize, number(later));
        (name, Row { completeness, stages, later, recovered, last_chain_hash })
    })
    .collect()
}

#[test]
fn every_log_gives_what_the_table_says() {
    let table = table();
    let logs = fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let logs: Vec<String> = logs.filter(|name| name.ends_with(".mcap")).collect();
    assert_eq!(logs.len(), table.len(), "a row for every log: {logs:?}");
    let mut bytes = 0;
    for (name, row) in &table {
        let path = folder().join(name);
        let log = Log::read(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
        bytes += log.file_len();
        let (found, later) = match log.completeness() {
            Completeness::Finished => ("finished", 0),
            Completeness::Unfinished => ("unfinished", 0),
            Completeness::Truncated { .. } => ("truncated", 0),
            Completeness::Damaged { later_commits, .. } => ("damaged", later_commits),
        };
        assert_eq!((found, later), (row.completeness.as_str(), row.later), "{name}");
        assert_eq!(log.entries().len(), row.stages, "{name}");
        let last = log.last_commit().unwrap().chain_hash.to_string();
        assert!(last.starts_with(&row.last_chain_hash) && row.last_chain_hash.len() >= 16, "{name}: {last}");
        for index in (0..row.stages).filter(|index| log.keeps_state(*index)) {
            log.state(index).unwrap_or_else(|error| panic!("{name}: {error}"));
        }
        let errors = verify_log(&log).iter().filter(|finding| finding.level == Level::Error).count();
        assert_eq!(errors > 0, found == "damaged", "{name}");
        // Byte for byte what is written today, the summary too, which MCAP's own writer made in version 1.
        let faultless = verify_log(&log).iter().all(|finding| finding.level == Level::Info);
        assert_eq!(faultless, ["finished", "unfinished"].contains(&found), "{name}");

        let place = Sandbox::new();
        let new = place.file("new.mcap");
        let recovered = match recover(&path, &new).unwrap() {
            RecoverOutcome::Lossless { .. } => "lossless",
            RecoverOutcome::Lossy { .. } => "lossy",
            RecoverOutcome::Hopeless { .. } => "hopeless",
        };
        assert_eq!(recovered, row.recovered, "{name}");
        assert_eq!(Log::read(&new).unwrap().entries().len(), row.stages, "{name}");

        // It can be continued, and the scene in it still means the same problem.
        place.write("log.mcap", fs::read(&path).unwrap());
        place.foldline("resume log.mcap").ends(0);
        let resumed = place.log("log.mcap");
        assert_eq!(resumed.completeness(), Completeness::Finished, "{name}");
        for (before, after) in log.entries().iter().zip(resumed.entries()) {
            assert_eq!(before.record, after.record, "{name}");
        }
    }
    assert!(bytes < 1_300_000, "{bytes} bytes of golden logs");
}

/// A scene that leaves the rule of quadrature out means the rule that was the default when its log was begun.
#[test]
fn a_log_keeps_the_default_of_its_time() {
    let (_, manifest) = read_scene("predicted.toml");
    for rule in ["patch", "full"] {
        let text = manifest.scene_text.replace("quadrature = \"patch\"\n", "");
        let then = scene(&text.replace("[mesh]\n", &format!("[mesh]\nquadrature = \"{rule}\"\n")));
        assert_ne!(scene(&text).hash(), then.hash());
        let place = Sandbox::new();
        let manifest = Manifest { scene_text: text, ..manifest.clone() };
        let mut writer = JournalWriter::create(&place.file("log.mcap"), &manifest, SyncPolicy::AtEnd).unwrap();
        let mut stages = Stages::new(then.clone());
        let start = stages.start().unwrap();
        Run::new(stages, start, None).to_end(Some(1.0), &|| false, &mut writer).unwrap();
        writer.close().unwrap();
        place.foldline("resume log.mcap").ends(0);
        place.foldline("replay log.mcap --from-scratch").ends(0);
        let log = place.log("log.mcap");
        assert_eq!(log.completeness(), Completeness::Finished, "{rule}");
        assert!(log.entries().iter().all(|entry| entry.record.commit.scene_hash == then.hash()), "{rule}");
    }
}

/// The logs hold what they are kept for: states of every encoding, with the memory that only they carry.
#[test]
fn every_encoding_of_states_is_among_them() {
    let states = |what: &str| -> Vec<State> {
        let log = Log::read(&folder().join(format!("v1-0.1.0-{what}.mcap"))).unwrap();
        (0..log.entries().len()).map(|index| log.state(index).unwrap()).collect()
    };
    assert!(states("finished").iter().all(|state| state.turns.is_empty() && state.drive.path().is_none()));
    let turning = states("turning");
    assert!(turning.iter().all(|state| state.turns.len() == 1 && state.drive.path().is_none()));
    let [_, turn, _] = turning.last().unwrap().turns[0];
    assert!(turn < 0.0, "lifted, the section turns towards -y: {turn}");
    let growing: Vec<i32> = states("growing").iter().map(|state| state.drive.control.halvings).collect();
    assert_eq!(growing, [-1, -2, -2, -2], "doubled twice, up to the longest increment");
    let predicted = states("predicted");
    let previous = |state: &State| state.drive.previous().map(|previous| previous.displacement.len());
    let points = predicted.iter().map(|state| state.mesh.point_count());
    assert!(predicted.iter().zip(points).skip(1).all(|(state, points)| previous(state) == Some(points)));
    let meshes: std::collections::BTreeSet<usize> = predicted.iter().filter_map(previous).collect();
    assert!(meshes.len() > 1, "what states remember is carried to a finer mesh");
    let balanced = states("balanced");
    assert!(balanced.iter().all(|state| state.largest_force_n > 0.0), "every equilibrium has met forces");
    assert!(balanced.last().unwrap().refinement.is_some(), "and a mesh that was refined what that changed");
    let path = states("path");
    let memory = |state: &State| state.drive.path().cloned().expect("a path");
    let located = |state: &State| memory(state).critical_ahead.is_some();
    assert!(path.iter().filter(|state| located(state)).count() >= 2, "in the middle of a bisection");
    assert!(path.iter().any(|state| state.drive.control.rejection == Some(Rejection::CriticalPoint)));
    assert!(path.iter().any(|state| memory(state).at_bifurcation));
    let last = path.last().unwrap();
    assert_eq!((last.stage, last.negative_pivots), (Some(Stage::SwitchBranch), 0));
    let log = Log::read(&folder().join("v4-0.1.0-structure.mcap")).unwrap();
    let structure: Vec<State> = (0..log.entries().len()).map(|index| log.state(index).unwrap()).collect();
    assert!(structure.iter().all(|state| state.mesh.patches.len() == 2));
    let marked = |state: &State| state.marked[0] != state.marked[1];
    assert!(structure.iter().any(marked), "knots for one patch alone");
    assert!(structure.iter().any(|state| state.refined.as_ref().is_some_and(|mesh| mesh.patches.len() == 2)));
}

fn path_of(what: &str) -> PathBuf {
    folder().join(format!("v{FORMAT_VERSION}-{}-{what}.mcap", env!("CARGO_PKG_VERSION")))
}

/// Scene and manifest of a scene file of the folder.
fn read_scene(name: &str) -> (Scene, Manifest) {
    let scene_text = fs::read_to_string(folder().join(name)).unwrap();
    let scene = scene(&scene_text);
    let manifest = Manifest {
        format_version: FORMAT_VERSION,
        program_version: env!("CARGO_PKG_VERSION").to_owned(),
        scene_file: format!("checkpoints/golden/{name}"),
        scene_text,
        cpu: "x86_64".to_owned(),
        cpu_features: Vec::new(),
        kernel: String::new(),
        numerics: NUMERICS_REVISION,
        threads: 1,
        host: "golden".to_owned(),
        started_unix_s: 0,
        first_ordinal: 0,
        same_scene: false,
        own_terms: Vec::new(),
    };
    (scene, manifest)
}

/// Not a test: writes the logs of other scenes, where they are not there yet.
#[test]
#[ignore = "writes to checkpoints/golden"]
fn write_golden_logs_of_other_courses() {
    for (what, last) in [
        ("turning", None),
        ("path", Some(Stage::SwitchBranch)),
        ("tolerance", Some(Stage::CoarsenKnots)),
        ("structure", None),
    ] {
        if path_of(what).exists() {
            continue;
        }
        let (scene, manifest) = read_scene(&format!("{what}.toml"));
        let mut writer = JournalWriter::create(&path_of(what), &manifest, SyncPolicy::AtEnd).unwrap();
        let mut stages = Stages::new(scene);
        let start = stages.start().unwrap();
        let mut run = Run::new(stages, start, None);
        while let Some(record) = run.advance(&mut writer).unwrap() {
            if Some(record.report.stage) == last {
                break;
            }
        }
        match run.next_stage() {
            None => writer.finish().unwrap(),
            Some(_) => writer.close().unwrap(),
        }
    }
}

/// Not a test: writes a log that was continued to a farther target, where it is not there yet.
#[test]
#[ignore = "writes to checkpoints/golden"]
fn write_golden_log_of_two_stretches() {
    let path = path_of("stretches");
    if path.exists() {
        return;
    }
    let (_, manifest) = read_scene("scene.toml");
    let near = Manifest { scene_text: manifest.scene_text.replace("= 4.0", "= 2.0"), ..manifest.clone() };
    let mut writer = JournalWriter::create(&path, &near, SyncPolicy::AtEnd).unwrap();
    let mut stages = Stages::new(scene(&near.scene_text));
    let start = stages.start().unwrap();
    Run::new(stages, start, None).to_end(None, &|| false, &mut writer).unwrap();
    writer.finish().unwrap();
    let resumed = JournalWriter::resume(&path, &manifest, SyncPolicy::AtEnd).unwrap();
    let (mut writer, log) = (resumed.writer, resumed.log);
    let state = log.state(log.entries().len() - 1).unwrap();
    let mut run = Run::new(Stages::new(scene(&manifest.scene_text)), state, log.last_commit().copied());
    run.to_end(None, &|| false, &mut writer).unwrap();
    writer.finish().unwrap();
}

/// Not a test: writes the logs of this version, where they are not there yet. The `README.md` says when.
#[test]
#[ignore = "writes to checkpoints/golden"]
fn write_golden_logs() {
    let (scene, manifest) = read_scene("scene.toml");
    let path = path_of;
    for (what, until) in [("finished", None), ("unfinished", Some(2.0))] {
        let mut writer = JournalWriter::create(&path(what), &manifest, SyncPolicy::AtEnd).unwrap();
        let mut stages = Stages::new(scene.clone());
        let start = stages.start().unwrap();
        match Run::new(stages, start, None).to_end(until, &|| false, &mut writer).unwrap() {
            Ending::Finished => writer.finish().unwrap(),
            _ => writer.close().unwrap(),
        }
    }
    // Damage is done to what a killed process leaves after its sixth stage.
    let finished = Log::read(&path("finished")).unwrap();
    let chunk = |index: usize| {
        let range = finished.entries()[index].bytes.clone();
        range.start as usize..range.end as usize
    };
    let killed = fs::read(path("finished")).unwrap()[..chunk(5).end].to_vec();
    let find = |range: std::ops::Range<usize>, piece: &[u8]| {
        let at = killed[range.clone()].windows(piece.len()).position(|window| window == piece).unwrap();
        range.start + at
    };
    let with = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = killed.clone();
        change(&mut bytes);
        bytes
    };
    let state = finished.state(3).unwrap();
    let moment = find(chunk(3), &state.moment_n_mm.to_le_bytes());
    let report = find(chunk(4), b"\"moment_n_mm\":") + 14;
    let damaged = [
        ("cut", with(&|bytes| bytes.truncate(chunk(4).start + chunk(4).len() / 2))),
        ("flip-in-state", with(&|bytes| bytes[moment + 3] ^= 1)),
        ("flip-in-report", with(&|bytes| bytes[report] ^= 1)),
        ("missing-middle", with(&|bytes| drop(bytes.drain(chunk(2))))),
        ("trailing-garbage", with(&|bytes| bytes.extend(b"not of this log ".repeat(32)))),
    ];
    for (what, bytes) in damaged {
        let mut file = fs::OpenOptions::new().write(true).create_new(true).open(path(what)).unwrap();
        std::io::Write::write_all(&mut file, &bytes).unwrap();
    }
}
