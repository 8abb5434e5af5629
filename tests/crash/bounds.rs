//! Logs of anyone's making, every seal in them right: no command takes more memory than the log and 64 MiB, or more time than
//! its length, or writes anywhere but in its folder.

use std::io::Read;
use std::process::Stdio;
use std::time::{Duration, Instant};

use foldline::journal::message::ReportMessage;
use foldline::journal::{Log, encode_mesh, encode_state};
use foldline::record::Report;
use foldline::scene::Stage;
use foldline::state::{Course, PathMemory, Refinement, State};
use serde_json::{Value, json};

use crate::crafted::{self, CHANNEL, METADATA, SCHEMA, Said, channel, record, text};
use crate::program::Sandbox;

/// Memory that a command may take beside the log.
const BESIDE_THE_LOG: u64 = 64 << 20;

/// What a log of fifty megabytes may take on a machine that has other things to do.
const LONGEST: Duration = Duration::from_secs(20);

const COMMANDS: [&str; 8] = [
    "verify LOG",
    "inspect LOG",
    "resume LOG --until 1",
    "recover LOG -o recovered.mcap",
    "plot LOG -o pictures",
    "bisect LOG --when step>900",
    "thin LOG -o thin.mcap --keep every=10",
    "replay LOG --step 1",
];

/// The first commits of a golden log: its scene, states and reports.
struct Ordinary {
    scene: String,
    states: Vec<State>,
    reports: Vec<Value>,
    stages: Vec<Stage>,
}

impl Ordinary {
    fn new() -> Self {
        let bytes = include_bytes!("../../checkpoints/golden/v3-0.1.0-finished.mcap");
        let log = Log::from_bytes(bytes.to_vec()).unwrap();
        let records: Vec<_> = log.entries().iter().map(|entry| entry.record.clone()).collect();
        Self {
            scene: log.manifests()[0].scene_text.clone(),
            states: (0..3).map(|index| log.state(index).unwrap()).collect(),
            reports: records.iter().map(|it| serde_json::to_value(ReportMessage::new(it)).unwrap()).collect(),
            stages: records.iter().map(|record| record.report.stage).collect(),
        }
    }

    /// What commit `index` says, of this state.
    fn said_of(&self, index: usize, state: &State) -> Said {
        let encoded = encode_state(state).unwrap();
        Said {
            mesh: encode_mesh(&state.mesh).unwrap(),
            fields: encoded.fields.into_iter().map(|field| field.bytes).collect(),
            state: encoded.state,
            report: self.reports[index].to_string().into_bytes(),
            ..Said::default()
        }
    }

    /// A log of the first commit, whose state is another.
    fn with_state(&self, change: impl FnOnce(&mut State)) -> Vec<u8> {
        let mut state = self.states[0].clone();
        change(&mut state);
        self.with(self.said_of(0, &state))
    }

    /// A log of the first commit, whose report is another.
    fn with_report(&self, report: Value) -> Vec<u8> {
        self.with(Said { report: report.to_string().into_bytes(), ..self.said_of(0, &self.states[0]) })
    }

    /// A log of one commit.
    fn with(&self, said: Said) -> Vec<u8> {
        let mut crafted = crafted::Crafted::new(&self.scene);
        crafted.commit(self.stages[0], 1, said);
        crafted.bytes
    }
}

/// Runs a command to its end: exit code, peak of its memory and what it says.
pub fn measured(place: &Sandbox, arguments: &str) -> (Option<i32>, u64, String) {
    let mut command = place.command(arguments);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut stderr = child.stderr.take().unwrap();
    let said = std::thread::spawn(move || {
        let mut said = Vec::new();
        stderr.read_to_end(&mut said).map(|_| String::from_utf8_lossy(&said).into_owned())
    });
    let (began, mut peak) = (Instant::now(), 0);
    let code = loop {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        // For a moment the child still has the memory, and the name, of the thread that spawned it.
        if status.starts_with("Name:\tfoldline\n") {
            let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
            let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<u64>().ok());
            peak = peak.max(kilobytes.unwrap_or(0) << 10);
        }
        if let Some(status) = child.try_wait().unwrap() {
            break status.code();
        }
        if began.elapsed() > LONGEST {
            child.kill().unwrap();
            panic!("{arguments} takes longer than {LONGEST:?}");
        }
        std::thread::sleep(Duration::from_millis(1));
    };
    (code, peak, said.join().unwrap().unwrap())
}

/// Every command on this log, each on a copy of its own.
#[track_caller]
fn all_bounded(what: &str, log: &[u8]) {
    for command in COMMANDS {
        let place = Sandbox::new();
        std::fs::create_dir(place.file("in")).unwrap();
        place.write("in/log.mcap", log);
        let arguments = command.replace("LOG", "in/log.mcap").replace("-o ", "-o in/");
        let before = place.logs();
        let (code, peak, said) = measured(&place, &arguments);
        println!("{what}: {command}: {code:?}, {} MiB beside the log", peak.saturating_sub(log.len() as u64) >> 20);
        assert!(code.is_some_and(|code| code != 101), "{what}: {command} ends with {code:?}: {said}");
        assert!(peak <= log.len() as u64 + BESIDE_THE_LOG, "{what}: {command} takes {peak} bytes for {}", log.len());
        assert_eq!(place.logs(), before, "{what}: {command} writes beside the folder");
        assert!(said.len() < 1 << 20, "{what}: {command} says {} bytes", said.len());
    }
}

/// What `verify` says, which is an error.
#[track_caller]
fn refused(bytes: Vec<u8>, why: &str) {
    let place = Sandbox::new();
    place.write("log.mcap", &bytes);
    place.foldline("verify log.mcap").ends(1).says(&[why]);
    for command in ["resume log.mcap", "replay log.mcap --step 1", "plot log.mcap"] {
        let said = place.foldline(command);
        assert!(!matches!(said.code, Some(101) | None), "{command}: {}", said.err);
    }
    assert_eq!(place.read("log.mcap"), bytes, "what is refused is not touched");
}

#[test]
fn an_ordinary_log_is_one() {
    let ordinary = Ordinary::new();
    let place = Sandbox::new();
    place.write("log.mcap", ordinary.with_state(|_| ()));
    // Its header names no program that writes logs: that is all there is to say.
    let said =
        place.foldline("verify log.mcap").says(&["1 commit, not finished", "not the byte that would be written"]);
    assert!(!said.out.contains("error"), "{}", said.out);
}

#[test]
fn a_long_topic_with_many_messages() {
    let ordinary = Ordinary::new();
    let topic = "t".repeat(1 << 20);
    let others = (0..8000).map(|_| (topic.clone(), Vec::new())).take(20).collect();
    let said = Said { others, ..ordinary.said_of(0, &ordinary.states[0]) };
    all_bounded("a topic of 1 MiB that the commit names", &ordinary.with(said));
    let mut crafted = crafted::Crafted::new(&ordinary.scene);
    let mut records = record(CHANNEL, &channel(9, &topic));
    (0..1_000_000).for_each(|_| records.extend(record(crafted::MESSAGE, &crafted::message(9, b""))));
    crafted.bytes.extend(record(crafted::CHUNK, &crafted::chunk(&records)));
    all_bounded("a topic of 1 MiB with a million messages", &crafted.bytes);
}

#[test]
fn records_without_number() {
    let ordinary = Ordinary::new();
    let empty = record(0x80, b"").repeat(5_000_000);
    let mut crafted = crafted::Crafted::new(&ordinary.scene);
    crafted.bytes.extend(record(crafted::CHUNK, &crafted::chunk(&empty)));
    all_bounded("five million records", &crafted.bytes);
    let last = crafted.bytes.len() - 1;
    crafted.bytes[last] ^= 1;
    all_bounded("five million records, before their checksum", &crafted.bytes);
}

#[test]
fn a_report_with_an_unknown_key() {
    let ordinary = Ordinary::new();
    for length in [400_000, 20_000_000] {
        let mut report = ordinary.reports[0].to_string();
        report.pop();
        report += ",\"unknown\":[";
        report += &"0,".repeat(length);
        report += "0]}";
        let said = Said { report: report.into_bytes(), ..ordinary.said_of(0, &ordinary.states[0]) };
        all_bounded("a report with an unknown key", &ordinary.with(said));
    }
}

#[test]
fn deep_nesting() {
    let ordinary = Ordinary::new();
    let mut report = ordinary.reports[0].to_string();
    report.pop();
    report += ",\"unknown\":";
    report += &"[".repeat(400_000);
    let said = Said { report: report.into_bytes(), ..ordinary.said_of(0, &ordinary.states[0]) };
    all_bounded("a report of brackets", &ordinary.with(said));
    let mut crafted = crafted::Crafted::new(&format!("a = {}", "[".repeat(400_000)));
    crafted.commit(Stage::Solve, 1, ordinary.said_of(0, &ordinary.states[0]));
    all_bounded("a scene of brackets", &crafted.bytes);
}

#[test]
fn notes_channels_and_schemas_without_number() {
    let ordinary = Ordinary::new();
    let mut crafted = crafted::Crafted::new(&ordinary.scene);
    let other = record(METADATA, &[text("other"), text("")].concat());
    (0..400_000).for_each(|_| crafted.bytes.extend(&other));
    all_bounded("400,000 notes", &crafted.bytes);
    let mut crafted = crafted::Crafted::new(&ordinary.scene);
    let named = record(METADATA, &[text(&"n".repeat(20_000)), text("")].concat());
    (0..2000).for_each(|_| crafted.bytes.extend(&named));
    all_bounded("2,000 long notes", &crafted.bytes);
    let mut records = Vec::new();
    for id in 1..=60_000_u16 {
        records.extend(record(CHANNEL, &channel(id, &format!("{id}{}", "c".repeat(500)))));
        let schema = [&id.to_le_bytes()[..], &text("s"), &text("json"), &text("")].concat();
        records.extend(record(SCHEMA, &schema));
    }
    let said = Said { records, ..ordinary.said_of(0, &ordinary.states[0]) };
    all_bounded("60,000 channels and schemas", &ordinary.with(said));
}

#[test]
fn scenes_that_fill_a_log() {
    let ordinary = Ordinary::new();
    let comment = format!("{}\n# {}", ordinary.scene, "c".repeat(7 << 20));
    let mut crafted = crafted::Crafted::new(&comment);
    crafted.commit(ordinary.stages[0], 1, ordinary.said_of(0, &ordinary.states[0]));
    all_bounded("a scene of 7 MiB", &crafted.bytes);
    let mut crafted = crafted::Crafted::new(&"s".repeat(40 << 20));
    crafted.commit(ordinary.stages[0], 1, ordinary.said_of(0, &ordinary.states[0]));
    all_bounded("a scene of 40 MiB", &crafted.bytes);
    let mut crafted = crafted::Crafted::new(&comment);
    (0..12).for_each(|_| crafted.manifest(&[("scene", &comment)]));
    all_bounded("thirteen scenes of 7 MiB", &crafted.bytes);
    for count in [300_000, 3_500_000] {
        let mut crafted =
            crafted::Crafted::new(&format!("{}\n[other]\nvalues = [{}]", ordinary.scene, "0,".repeat(count)));
        crafted.commit(ordinary.stages[0], 1, ordinary.said_of(0, &ordinary.states[0]));
        all_bounded("a scene of many values", &crafted.bytes);
    }
}

/// Each of many beginnings of a manifest claims all bytes to the end, which are zeros: none is looked through again.
#[test]
fn manifests_in_manifests() {
    let mut crafted = crafted::Crafted::new("");
    crafted.bytes.push(0x80);
    let (count, zeros) = (40_000, 2 << 20);
    let one = [text("foldline.manifest"), text("")].concat();
    let step = 9 + one.len();
    for index in 0..count {
        let claimed = (count - index) * step - 9 + zeros;
        crafted.bytes.extend([&[METADATA][..], &(claimed as u64).to_le_bytes(), &one].concat());
    }
    crafted.bytes.resize(crafted.bytes.len() + zeros, 0);
    all_bounded("manifests in manifests, then zeros", &crafted.bytes);
    let last = crafted.bytes.len() - 1;
    crafted.bytes[last] = 255;
    all_bounded("manifests in manifests", &crafted.bytes);
}

#[test]
fn numbers_that_no_axis_has() {
    let ordinary = Ordinary::new();
    for value in [json!(1.7e308), json!(-1.7e308), json!(5e-324), json!("inf"), json!("-inf"), json!("NaN")] {
        for entry in ["rotation_deg", "moment_n_mm", "strain_energy_n_mm"] {
            let mut report = ordinary.reports[0].clone();
            match &value {
                Value::String(_) => {
                    report[entry] = Value::Null;
                    report["not_finite"] = json!([{ "entry": entry, "value": value }]);
                }
                value => report[entry] = value.clone(),
            }
            let log = ordinary.with_report(report);
            all_bounded(&format!("{entry} = {value}"), &log);
            refused(log, &format!("the report has {}", entry.replace("rotation_deg", "parameter")));
        }
    }
}

/// Every number of a report that the state has too is compared with it, in its last bit.
#[test]
fn a_report_that_says_otherwise_than_its_state() {
    let ordinary = Ordinary::new();
    let next = |value: &Value| match value {
        Value::Number(number) if number.is_f64() => json!(f64::from_bits(number.as_f64().unwrap().to_bits() + 1)),
        Value::Number(number) => json!(number.as_u64().unwrap() + 1),
        pair => json!([pair[0].as_u64().unwrap() + 1, pair[1]]),
    };
    for entry in ["rotation_deg", "moment_n_mm", "strain_energy_n_mm", "negative_pivots", "elements", "marked"] {
        let mut report = ordinary.reports[0].clone();
        report[entry] = next(&report[entry]);
        let named = entry.replace("rotation_deg", "parameter");
        refused(ordinary.with_report(report), &format!("the report has {named}"));
    }
    let mut report = ordinary.reports[0].clone();
    report["path_length_mm"] = json!(1.0);
    let log = ordinary.with_report(report);
    refused(log, "the report has path_length_mm 1");
}

/// What the scene of a log does not have, no state of it has.
#[test]
fn states_that_no_scene_makes() {
    let ordinary = Ordinary::new();
    let uniform = include_str!("../../checkpoints/golden/scene.toml");
    assert!(ordinary.scene.contains("[adapt]") && uniform.contains("[adapt]"));
    let path = |first_mm: f64| PathMemory {
        heading: vec![[0.0; 3]; ordinary.states[0].displacement.len()],
        parameter_rate: 1.0,
        first_mm,
        next_mm: first_mm,
        travelled_mm: 0.0,
        critical_ahead: None,
        at_bifurcation: false,
    };
    refused(ordinary.with_state(|state| state.drive.course = Course::Path(path(1.0))), "a path");
    refused(ordinary.with_state(|state| state.drive.course = Course::Path(path(-1.0))), "a path");
    refused(ordinary.with_state(|state| state.turns = vec![[0.0; 3]; 1000]), "more rigid sections that turn");
    refused(ordinary.with_state(|state| state.stage = Some(Stage::SwitchBranch)), "a stage of another pipeline");
    refused(ordinary.with_state(|state| state.negative_pivots = u64::MAX), "negative pivots");
    refused(ordinary.with_state(|state| state.drive.control.halvings = i32::MIN), "the number of halvings");
    refused(ordinary.with_state(|state| state.largest_force_n = -1.0), "the largest force");
    let refinement = |growth| Refinement { changed_n_mm: 0.0, growth, expected_n_mm: None, ripple_n_mm: 0.0 };
    refused(ordinary.with_state(|state| state.refinement = Some(refinement(-1.0))), "the growth of the mesh");
}

/// Where a path is followed, its memory is what a path has.
#[test]
fn paths_that_lead_nowhere() {
    let bytes = include_bytes!("../../checkpoints/golden/v1-0.1.0-path.mcap");
    let log = Log::from_bytes(bytes.to_vec()).unwrap();
    let whole = Ordinary {
        scene: log.manifests()[0].scene_text.clone(),
        states: vec![log.state(0).unwrap()],
        reports: vec![serde_json::to_value(ReportMessage::new(&log.entries()[0].record)).unwrap()],
        stages: vec![log.entries()[0].record.report.stage],
    };
    let path = |change: fn(&mut PathMemory)| {
        whole.with_state(|state| match &mut state.drive.course {
            Course::Path(path) => change(path),
            other => panic!("no path: {other:?}"),
        })
    };
    let report: Report = log.entries()[0].record.report.clone();
    assert!(report.path_length_mm.is_some());
    refused(path(|path| path.first_mm *= -1.0), "the first step along the path");
    refused(path(|path| path.next_mm = 0.0), "the next step along the path");
    refused(path(|path| path.travelled_mm *= -1.0), "the length of the path");
}

/// A scene in a log names no file that anyone opens; what is no regular file is no scene and no log.
#[test]
fn no_file_is_opened_for_a_log() {
    let ordinary = Ordinary::new();
    let place = Sandbox::new();
    std::process::Command::new("mkfifo").arg(place.file("pipe")).status().unwrap();
    for file in ["/dev/zero", "pipe", "../log.mcap"] {
        let (_, rest) = ordinary.scene.split_once("[material]").unwrap();
        let scene = format!("[geometry]\nkind = \"nurbs\"\nfile = \"{file}\"\n[material]{rest}");
        let mut crafted = crafted::Crafted::new(&scene);
        crafted.commit(ordinary.stages[0], 1, ordinary.said_of(0, &ordinary.states[0]));
        place.write("log.mcap", &crafted.bytes);
        for command in COMMANDS {
            let (code, _, said) = measured(&place, &command.replace("LOG", "log.mcap"));
            assert!(code.is_some_and(|code| code != 101), "{command}: {said}");
            assert!(!said.contains("cannot be read"), "{command}: {said}");
        }
        place.write("scene.toml", &scene);
        let (code, _, said) = measured(&place, "run scene.toml -o new.mcap");
        assert!(code == Some(2) && said.contains("cannot be read"), "{said}");
    }
    for file in ["/dev/zero", "pipe", "."] {
        for command in COMMANDS.iter().chain(&["run LOG -o new.mcap"]) {
            let (code, _, said) = measured(&place, &command.replace("LOG", file));
            assert!(matches!(code, Some(1 | 2)), "{command} {file}: {code:?} {said}");
        }
    }
}

/// No text of a log or scene tells a terminal anything, wherever it stands: in tables, errors, JSON and pictures.
#[test]
fn no_terminal_is_told_anything() {
    let ordinary = Ordinary::new();
    let escape = "\u{1b}[31m\u{9b}2J\u{7f}\u{202e}\u{2066}\nforged";
    let mut report = ordinary.reports[0].clone();
    report["probes"] = json!([{ "name": escape, "value": 1.0, "unit": escape }]);
    let mut crafted = crafted::Crafted::of_entries(&[
        ("scene", &ordinary.scene),
        ("host", escape),
        ("cpu", escape),
        ("kernel", escape),
        ("program_version", escape),
        ("scene_file", escape),
    ]);
    let said = Said { report: report.to_string().into_bytes(), ..ordinary.said_of(0, &ordinary.states[0]) };
    crafted.bytes.extend(record(METADATA, &[text(escape), text("")].concat()));
    crafted.commit(ordinary.stages[0], 1, said);
    let place = Sandbox::new();
    let turns = |c: char| matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let obeyed = |c: char| turns(c) || (c.is_control() && !matches!(c, '\n' | '\t'));
    let commands = ["inspect LOG --json", "inspect LOG --step 1", "run scene.toml -o new.mcap"];
    for command in COMMANDS.iter().chain(&commands) {
        place.write("log.mcap", &crafted.bytes);
        place.write("scene.toml", "[geometry]\n\"\\u001b[31m\" = 1\nkind = \"\\u001b]0;\\u0007\\u009b\"\n# \u{9b}");
        let said = place.foldline(&command.replace("LOG", "log.mcap"));
        let told = said.out.chars().chain(said.err.chars()).find(|c| obeyed(*c));
        assert_eq!(told, None, "{command}: {:?} {:?}", said.out, said.err);
        let forged = said.out.lines().chain(said.err.lines()).find(|line| line.starts_with("forged"));
        assert_eq!(forged, None, "{command}: a name breaks no line");
    }
    for picture in ["pictures/mesh.svg", "pictures/moment-rotation.svg", "pictures/mesh.vtu"] {
        let picture = String::from_utf8(place.read(picture)).unwrap();
        assert!(!picture.chars().any(obeyed));
    }
}
