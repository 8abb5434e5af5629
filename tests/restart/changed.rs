//! A scene that changed between a run and its resume: what stands is said and kept, and nothing is mixed in silence.

use foldline::journal::{JournalWriter, Log, Manifest};
use foldline::record::Outcome;
use foldline::scene::{Stage, SyncPolicy};

use crate::program::{SMALL, Sandbox, Straight, assert_ends_with, scene, small_with};

const TARGET: &str = "rotation_deg = 16.0";

/// Index of the last stage of a load step.
fn end_of_step(log: &Log, step: u64) -> usize {
    log.entries().iter().rposition(|entry| entry.record.report.step == step).unwrap()
}

/// What is written beside the states may change: every stage is kept.
#[test]
fn output_alone() {
    let whole = Straight::small();
    let place = Sandbox::new();
    place.write("run.mcap", whole.cut_after(17));
    place.write("small.toml", format!("{SMALL}\n[output]\nsync = \"each-stage\"\n"));
    let said = place.foldline("run small.toml -o run.mcap --resume").ends(0);
    said.says(&["the log holds 17 stages, all good", "output.sync changed", "every stage is kept"]);
    assert_ends_with(&place.log("run.mcap"), whole.chain, "output changed");
}

/// Probes that a finished run has not are read on its states; what its log will not get is said, however quiet.
#[test]
fn new_probes_and_a_mesh_history() {
    let whole = Straight::small();
    let place = Sandbox::new();
    place.write("run.mcap", &whole.bytes);
    let probed =
        format!("{SMALL}\n[output]\nmesh_history = true\n\n[[probe]]\nname = \"strain energy\"\nkind = \"energy\"\n");
    place.write("small.toml", &probed);
    let said = place.foldline("run small.toml -o run.mcap --resume").ends(0);
    let stand = format!("every stage is kept, and the {} in the log keep what they were written with", whole.stages);
    let lines: Vec<&str> = said.err.lines().filter(|line| line.contains(&stand)).collect();
    assert!(
        lines.len() == 2 && lines[0].contains("mesh_history") && lines[1].contains("probe.strain energy changed"),
        "{}",
        said.err
    );
    // Each equilibrium, with the energy that its report tells.
    let log = whole.log();
    let done = log.entries().iter().map(|entry| &entry.record.report);
    let done = done.filter(|report| report.outcome == Outcome::Done && report.stage.finds_equilibrium());
    let mut table = said.out.lines().skip_while(|line| !line.contains("strain energy N·mm")).skip(1);
    let rows: Vec<&str> = table.by_ref().take(done.clone().count()).collect();
    assert!(table.next().is_some_and(|next| next.starts_with("tape spring")), "{}", said.out);
    for (row, report) in rows.iter().zip(done) {
        let value: f64 = row.split_whitespace().last().unwrap().parse().unwrap();
        // Of the whole shell, to the digits that are printed.
        assert!((value - report.strain_energy_n_mm).abs() < 1e-4 * value.abs(), "{row}: {}", report.strain_energy_n_mm);
    }
    assert_eq!(place.read("run.mcap"), whole.bytes, "the log keeps what it has");
    for manner in ["--quiet", "--json"] {
        let said = place.foldline(&format!("run small.toml -o run.mcap --resume {manner}")).ends(0);
        assert_eq!(said.err.lines().filter(|line| line.contains(&stand)).count(), 2, "{manner}: {}", said.err);
        if manner == "--json" {
            let lines = said.out.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap());
            let values = lines.map(|line| (line["probes"][0]["value"].clone(), line["strain_energy_n_mm"].clone()));
            let values: Vec<_> = values.collect();
            assert_eq!(values.len(), rows.len());
            let near = |a: &serde_json::Value, b: &serde_json::Value| {
                (a.as_f64().unwrap() / b.as_f64().unwrap() - 1.0).abs() < 1e-12
            };
            assert!(values.iter().all(|(probe, energy)| near(probe, energy)), "{values:?}");
        }
    }
}

/// A probe that measures something else under the same name is not put together with the one before: neither in a table nor in
/// a curve.
#[test]
fn a_probe_that_is_another_under_the_same_name() {
    const ROOF: &str = include_str!("path.toml");
    let other = ROOF.replace("on = [0.5, 0.5]\ncomponent", "on = [0.5, 0.25]\ncomponent");
    assert_ne!(ROOF, other);
    let (place, straight) = (Sandbox::new(), Sandbox::new());
    straight.write("other.toml", &other);
    straight.foldline("run other.toml -o run.mcap --quiet").ends(0);
    place.write("roof.toml", ROOF);
    place.write("other.toml", &other);
    place.foldline("run roof.toml -o run.mcap --until 0.5 --quiet").ends(0);
    let first = place.log("run.mcap").entries().len();
    let said = place.foldline("run other.toml -o run.mcap --resume --quiet").ends(0);
    // What differs is shown, however long the rest is.
    said.says(&["probe.w_c.on changed ([0.5,0.5] → [0.5,0.25])"]);
    let names = format!("probe `w_c` of stages 0 to {} is not the one of the last scene", first - 1);
    let table = place.foldline("inspect run.mcap").ends(0).says(&[&names, "foldline inspect run.mcap --probes"]).out;
    let probes = |place: &Sandbox, command: &str| -> Vec<serde_json::Value> {
        let out = place.foldline(command).ends(0).out;
        out.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap()["probes"].clone()).collect()
    };
    let right = probes(&straight, "inspect run.mcap --json");
    assert_eq!(probes(&place, "inspect run.mcap --json --probes"), right);
    assert_ne!(probes(&place, "inspect run.mcap --json"), right, "the log keeps what it has");
    let cells = |table: &str, stage: usize| table.lines().nth(stage + 1).unwrap().split_whitespace().count();
    let again = place.foldline("inspect run.mcap --probes").ends(0).out;
    assert_eq!(
        (cells(&table, 0) + 1, cells(&table, first)),
        (cells(&again, 0), cells(&again, first)),
        "{table}{again}"
    );
    for place in [&place, &straight] {
        place.foldline("plot run.mcap -o pictures").ends(0);
    }
    assert_eq!(place.read("pictures/load-probe.svg"), straight.read("pictures/load-probe.svg"));
}

/// Each probe that changed is a line, whatever else changed; all of them are read again, and shown while the run continues.
#[test]
fn many_probes_are_a_line_and_a_column_each() {
    let probe = |name: &str, on: &str| {
        format!("\n[[probe]]\nname = \"{name}\"\nkind = \"displacement\"\non = {on}\ncomponent = \"z\"\n")
    };
    let was = include_str!("path.toml").to_owned() + &probe("left", "[0.5, 0.25]") + &probe("right", "[0.5, 0.75]");
    let is = was.replace("\"w_c\"", "\"crown\"").replace("[0.5, 0.75]", "[0.25, 0.75]").replace("\"z\"", "\"x\"");
    let place = Sandbox::new();
    place.write("was.toml", &was);
    place.write("is.toml", is + &probe("end", "[0.0, 0.5]"));
    place.foldline("run was.toml -o run.mcap --until 0.5 --quiet").ends(0);
    let said = place.foldline("run is.toml -o run.mcap --resume").ends(0).says(&[
        "probe.left.component changed (\"z\" → \"x\")",
        "probe.right.on changed ([0.5,0.75] → [0.25,0.75])",
        "probe.w_c changed (",
        "probe.crown changed (not set → ",
        "probe.end changed (not set → ",
        "crown mm",
    ]);
    let steps: Vec<&str> = said.err.lines().filter(|line| line.starts_with("step ")).collect();
    assert!(steps.len() > 3 && steps.iter().all(|line| line.contains("  crown ")), "{}", said.err);
    let again = place.foldline("inspect run.mcap --probes").ends(0);
    assert!(!again.err.contains("--probes") && !again.out.contains("--probes"), "{}{}", again.out, again.err);
    let heads = again.out.lines().find(|line| line.contains("crown mm")).unwrap();
    assert!(["left mm", "right mm", "end mm"].iter().all(|head| heads.contains(head)), "{heads}");
}

/// What supports and actions are called decides no state, nor does a history beyond the loads that were reached: the run continues,
/// and ends with the states of one that had the new scene from the start.
#[test]
fn names_and_later_loads() {
    let roof = include_str!("path.toml").split("[continuation]").next().unwrap().replace("1.6", "1.0");
    let ramp = |points: &str| roof.replace("-3000.0]", &format!("-3000.0]\nhistory = [{points}]"));
    let [was, later] = [ramp("[0, 0], [0.7, 0.7], [1, 1]"), ramp("[0, 0], [0.7, 0.7], [1, 0.2]")];
    let renamed = was.replace("left hinge", "links").replace("[[action]]", "[[action]]\nname = \"pull\"");
    let states = |log: &Log| log.entries().iter().map(|entry| entry.record.commit.state_hash).collect::<Vec<_>>();
    for (what, is, until, kept) in [
        ("renamed", &renamed, 0.6, "every stage is kept"),
        ("changed beyond", &later, 0.6, "every stage is kept"),
        ("changed before the last stages", &later, 0.9, "is new"),
    ] {
        let (place, straight) = (Sandbox::new(), Sandbox::new());
        place.write("was.toml", &was);
        place.foldline(&format!("run was.toml -o run.mcap --until {until} --quiet")).ends(0);
        for place in [&place, &straight] {
            place.write("is.toml", is);
        }
        let said = place.foldline("run is.toml -o run.mcap --resume").ends(0).says(&["changed (", kept]);
        assert!(!said.err.contains("mixed"), "{what}: {}", said.err);
        straight.foldline("run is.toml -o run.mcap --quiet").ends(0);
        assert_eq!(states(&place.log("run.mcap")), states(&straight.log("run.mcap")), "{what}");
        place.foldline("replay run.mcap --from-scratch").ends(0);
    }
    // Where nothing can be kept, the message says why.
    let place = Sandbox::new();
    place.write("was.toml", &was);
    place.write("other.toml", ramp("[0.1, 0], [0.7, 0.7], [1, 1]"));
    place.write("at-start.toml", ramp("[0, 0], [0.3, 0.7], [1, 1]"));
    place.foldline("run was.toml -o run.mcap --until 0.6 --quiet").ends(0);
    for (scene, why) in [
        ("other", "the histories do not begin with the same points: nothing can be kept"),
        ("at-start", "the histories part at load factor 0: nothing can be kept"),
    ] {
        place
            .foldline(&format!("run {scene}.toml -o run.mcap --resume"))
            .ends(1)
            .says(&["action 1.history changed", why]);
    }
    let along_path = |scene: &str| scene.to_owned() + "\n[continuation]\ncontrol = \"arc-length\"\n";
    place.write("path.toml", along_path(&was));
    place.write("path-later.toml", along_path(&later));
    place.foldline("run path.toml -o path.mcap --until 0.3 --quiet").ends(0);
    place.foldline("run path-later.toml -o path.mcap --resume").ends(1).says(&["a step by arc length looks beyond"]);
}

/// A finished run continues to a farther target as if that had been the target from the start.
#[test]
fn a_farther_target() {
    let whole = Straight::small();
    for (near, clipped) in [("12.0", false), ("11.3", true), ("10.46", true), ("9.0", true), ("2.0", false)] {
        let place = Sandbox::new();
        place.write("near.toml", small_with(&[(TARGET, &format!("rotation_deg = {near}"))]));
        place.foldline("run near.toml -o run.mcap").ends(0);
        let near_stages = place.log("run.mcap").entries().len();
        let said = place.foldline("run small.toml -o run.mcap --resume").ends(0);
        assert_ends_with(&place.log("run.mcap"), whole.chain, &format!("target {near} and then 16"));
        assert_eq!(place.logs().len(), 1 + usize::from(clipped), "{near}: {:?}", place.logs());
        if clipped {
            assert!(!said.err.contains("every stage is kept"), "{near}: stages go, and yet: {}", said.err);
            said.says(&[
                "load.rotation_deg changed",
                "are kept,",
                &format!("the log holds {near_stages} stages, all good; the first"),
            ]);
            assert_eq!(place.logs(), ["run.mcap", "run.mcap.replaced-1"]);
        } else {
            said.says(&["load.rotation_deg changed", "every stage is kept"]);
        }
    }
}

/// A nearer target: what lies beyond it goes, and the log ends where a run to that target ends.
#[test]
fn a_nearer_target() {
    let whole = Straight::small();
    for near in ["12.0", "11.3", "10.46", "9.0"] {
        let near_scene = small_with(&[(TARGET, &format!("rotation_deg = {near}"))]);
        let straight = Straight::run(&near_scene, 2);
        for stages in [whole.stages, 30, 5] {
            let place = Sandbox::new();
            place.write("run.mcap", whole.cut_after(stages));
            place.write("small.toml", &near_scene);
            place.foldline("run small.toml -o run.mcap --resume").ends(0);
            assert_ends_with(&place.log("run.mcap"), straight.chain, &format!("{stages} stages, then to {near}"));
        }
    }
}

/// What steps are made with: complete steps stand, a step in hand is begun again, and the log says which scene made
/// what.
#[test]
fn solver_tolerance() {
    let whole = Straight::small();
    let log = whole.log();
    let tighter = small_with(&[("[solver]", "[solver]\ntolerance = 1e-9")]);
    let third = end_of_step(&log, 3) + 1;
    for (stages, keep, last_step) in [(third, third, 3), (third + 1, third + 2, 3), (third - 2, 0, 2), (1, 0, 0)] {
        let keep = if keep <= stages && keep > 0 { keep } else { end_of_step_at_most(&log, stages) };
        let place = Sandbox::new();
        place.write("run.mcap", whole.cut_after(stages));
        place.write("small.toml", &tighter);
        let said = place.foldline("run small.toml -o run.mcap --resume").ends(0);
        if last_step == 0 {
            said.says(&["solver.tolerance changed", "no complete step is kept"]);
        } else {
            let stand =
                format!("steps 1 to {last_step} are kept, {} on is new: the log is mixed from there on", last_step + 1);
            said.says(&["solver.tolerance changed (1e-7 → 1e-9)", &stand]);
        }
        let mixed = place.log("run.mcap");
        let hashes = [scene(SMALL).hash(), scene(&tighter).hash()];
        for (index, entry) in mixed.entries().iter().enumerate() {
            assert_eq!(entry.record.commit.scene_hash, hashes[usize::from(index >= keep)], "{stages}: stage {index}");
            if index < keep {
                assert_eq!(entry.record, log.entries()[index].record, "{stages}: stage {index}");
            }
        }
        assert_ne!(mixed.last_commit().unwrap().chain_hash, whole.chain);
        let told = format!("mixed: solver.tolerance is 1e-9 from stage {keep} on, and was 1e-7");
        assert_eq!(place.foldline("inspect run.mcap").ends(0).out.contains(&told), keep > 0);
        // Every stretch is run again with the scene that it was run with.
        let said = place.foldline("replay run.mcap --from-scratch").ends(0);
        assert_eq!(said.out.matches("bit-identical").count(), mixed.entries().len());
    }
}

/// Stages of the complete steps among the first `stages`.
fn end_of_step_at_most(log: &Log, stages: usize) -> usize {
    let step_of = |index: usize| log.entries()[index].record.report.step;
    let ends = |index: &usize| log.entries().get(index + 1).is_some_and(|_| step_of(index + 1) > step_of(*index));
    (0..stages).rev().find(ends).map_or(0, |index| index + 1)
}

/// A new target and new steps at once: the earlier of the two boundaries holds, and it is the end of a step.
#[test]
fn target_and_tolerance_at_once() {
    let place = Sandbox::new();
    place.write("near.toml", small_with(&[(TARGET, "rotation_deg = 10.46")]));
    place.foldline("run near.toml -o run.mcap").ends(0);
    let near = place.log("run.mcap");
    place.write("small.toml", small_with(&[("[solver]", "[solver]\ntolerance = 1e-9")]));
    place.foldline("run small.toml -o run.mcap --resume").ends(0);
    let log = place.log("run.mcap");
    let keep = log.manifests()[1].first_ordinal as usize;
    let last = near.state(keep - 1).unwrap();
    assert!(last.drive.control.rejection.is_none() && log.entries()[keep].record.report.stage == Stage::Solve);
    assert!(log.entries()[keep - 1].record.report.step < log.entries()[keep].record.report.step);
    place.foldline("replay run.mcap --from-scratch").ends(0);
}

/// Another problem keeps nothing: refused, and the log is not touched.
#[test]
fn geometry_and_the_like() {
    let whole = Straight::small();
    let place = Sandbox::new();
    place.write("run.mcap", whole.cut_after(17));
    let changes = [
        ("length_mm = 300.0", "length_mm = 310.0", "geometry.length_mm changed (300.0 in the log, 310.0 now)"),
        ("thickness_mm = 0.1", "thickness_mm = 0.11", "material.thickness_mm changed"),
        ("elements = [4, 4]", "elements = [6, 4]", "mesh.elements changed"),
        ("sense = \"opposite\"", "sense = \"equal\"", "load.sense changed"),
        ("part = \"quarter\"", "part = \"half-arc\"", "symmetry.part changed"),
    ];
    for (from, to, said) in changes {
        place.write("small.toml", small_with(&[(from, to)]));
        let refusal = place.foldline("run small.toml -o run.mcap --resume").ends(1);
        refusal.says(&[said, "nothing can be kept; write to another log with -o"]);
        assert_eq!(place.read("run.mcap"), whole.cut_after(17), "{said}");
        assert_eq!(place.logs(), ["run.mcap"]);
    }
    place.foldline("resume run.mcap").ends(0);
    assert_ends_with(&place.log("run.mcap"), whole.chain, "after refusals");
}

/// Another machine may round differently: allowed, said, and recorded.
#[test]
fn another_machine() {
    let whole = Straight::small();
    let (place, log) = (Sandbox::new(), whole.log());
    let elsewhere = Manifest { host: "elsewhere".into(), cpu: "abacus".into(), ..log.manifests()[0].clone() };
    let mut writer = JournalWriter::create(&place.file("run.mcap"), &elsewhere, SyncPolicy::AtEnd).unwrap();
    for (index, entry) in log.entries()[..25].iter().enumerate() {
        writer.commit(&log.state(index).unwrap(), &entry.record).unwrap();
    }
    drop(writer);
    let said = place.foldline("resume run.mcap").ends(0);
    said.says(&["another machine: written on elsewhere (abacus", "continues on", "the log records it"]);
    let resumed = place.log("run.mcap");
    let machines: Vec<_> =
        resumed.manifests().iter().map(|manifest| (&*manifest.cpu, manifest.first_ordinal)).collect();
    assert_eq!(machines, [("abacus", 0), (std::env::consts::ARCH, 25)]);
    assert_ends_with(&resumed, whole.chain, "two machines that round alike");
    place.foldline("verify run.mcap").ends(0).says(&["commit 25: from here on computed on another machine"]);
    place.write("straight.mcap", &whole.bytes);
    let said = place.foldline("bisect run.mcap straight.mcap").ends(0);
    said.says(&["machine: elsewhere and", "processor: abacus"]);
}

/// Names that a log holds reach a terminal as text.
#[test]
fn a_host_that_commands_a_terminal() {
    let whole = Straight::small();
    let (place, log) = (Sandbox::new(), whole.log());
    let elsewhere = Manifest { host: "\u{1b}[2Jelsewhere\u{9b}".into(), ..log.manifests()[0].clone() };
    let mut writer = JournalWriter::create(&place.file("run.mcap"), &elsewhere, SyncPolicy::AtEnd).unwrap();
    for (index, entry) in log.entries()[..25].iter().enumerate() {
        writer.commit(&log.state(index).unwrap(), &entry.record).unwrap();
    }
    drop(writer);
    place.write("straight.mcap", &whole.bytes);
    for command in ["resume run.mcap", "verify run.mcap", "bisect run.mcap straight.mcap"] {
        let said = place.foldline(command);
        assert!(!said.out.contains(['\u{1b}', '\u{9b}']) && !said.err.contains(['\u{1b}', '\u{9b}']), "{command}");
        said.ends(0).says(&["␛[2Jelsewhere"]);
    }
}

/// Where the scene of the last stretch is lost, an earlier one does not silently take its place.
#[test]
fn a_lost_scene_is_not_replaced_by_an_older_one() {
    let whole = Straight::small();
    let place = Sandbox::new();
    place.write("run.mcap", whole.cut_after(17));
    let tighter = small_with(&[("[solver]", "[solver]\ntolerance = 1e-9")]);
    place.write("small.toml", &tighter);
    place.foldline("run small.toml -o run.mcap --resume --until 9").ends(0);
    let mut bytes = place.read("run.mcap");
    let at = bytes.windows(16).rposition(|window| window == b"tolerance = 1e-9").unwrap();
    bytes[at + 15] = b'8';
    place.write("run.mcap", &bytes);
    place.foldline("verify run.mcap").says(&["the manifest's entries do not have the hash that it carries"]);
    let before = place.read("run.mcap");
    for command in ["resume run.mcap", "replay run.mcap --step 4"] {
        place.foldline(command).ends(1).says(&["the scene", "is lost", "--resume"]);
    }
    assert_eq!(place.read("run.mcap"), before);
    // Stages whose scene is there can be run again, and everything else can be looked at.
    place.foldline("replay run.mcap --step 2").ends(0);
    place.foldline("inspect run.mcap").ends(0);
    // The scene's file brings it back.
    place.foldline("run small.toml -o run.mcap --resume").ends(0);
    let log = place.log("run.mcap");
    let kept = log.manifests().last().unwrap().first_ordinal;
    assert_eq!(kept, Log::from_bytes(before).unwrap().entries().len() as u64);
    place.foldline("replay run.mcap --step 6").ends(0);
}
