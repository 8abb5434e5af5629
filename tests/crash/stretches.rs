//! A log of two stretches: no damage makes a run end at the target of the first in silence.

use foldline::journal::{Completeness, Level, Log, RecoverOutcome, Resume, recover, verify_log};
use foldline::state::Hash;

use crate::flips::{Random, seed};
use crate::program::{Said, Sandbox};

const SCENE: &str = include_str!("../../checkpoints/golden/scene.toml");

fn scene_to(target: &str) -> String {
    let text = SCENE.replace("rotation_deg = 4.0", &format!("rotation_deg = {target}"));
    text.replace("increment_deg = 2.0", "increment_deg = 0.5")
}

/// Run to 1°, continued to 3°, of which it has come to 2°.
struct Stretches {
    bytes: Vec<u8>,
    /// Where the second manifest lies.
    manifest: std::ops::Range<usize>,
    near_end: Hash,
    far_end: Hash,
}

impl Stretches {
    fn new() -> Self {
        let place = Sandbox::new();
        place.write("near.toml", scene_to("1.0"));
        place.write("far.toml", scene_to("3.0"));
        let end = |scene: &str| {
            place.foldline(&format!("run {scene}.toml -o {scene}.mcap --quiet")).ends(0);
            place.log(&format!("{scene}.mcap")).last_commit().unwrap().chain_hash
        };
        let (near_end, far_end) = (end("near"), end("far"));
        place.foldline("run far.toml -o near.mcap --resume --until 2 --quiet").ends(0);
        let log = place.log("near.mcap");
        let kept = log.manifests()[1].first_ordinal as usize;
        assert!(kept >= 2 && log.entries().len() > kept + 1);
        let bytes = place.read("near.mcap");
        let text = b"foldline.manifest";
        let first_commit = log.entries()[kept].bytes.start as usize;
        let name = bytes[..first_commit].windows(text.len()).rposition(|window| window == text).unwrap();
        Self { manifest: name - 4 - 9..first_commit, bytes, near_end, far_end }
    }

    /// Resumes a damaged copy. It comes to the end that it should come to, or says why it does not.
    fn resume(&self, bytes: &[u8], what: &str) -> bool {
        let place = Sandbox::new();
        place.write("log.mcap", bytes);
        let said: Said = place.foldline("resume log.mcap --quiet");
        if said.code == Some(0) {
            let log = place.log("log.mcap");
            // No stage of the second stretch is left, and what a piece of its manifest asked for nobody knows: that is said.
            let cut_before = bytes.len() < self.manifest.end;
            let right = if cut_before { self.near_end } else { self.far_end };
            if cut_before && bytes.len() > self.manifest.start {
                assert!(said.err.contains("the log ends in a manifest that cannot be read"), "{what}: {}", said.err);
            }
            assert_eq!(log.completeness(), Completeness::Finished, "{what}");
            assert_eq!(log.last_commit().unwrap().chain_hash, right, "{what}: {}", said.err);
            return true;
        }
        assert_eq!(said.code, Some(1), "{what}: {}", said.err);
        assert!(said.err.len() > 40, "{what}: {}", said.err);
        assert_eq!(place.read("log.mcap"), bytes, "{what}: what is refused is not touched");
        if let Ok(log) = Log::from_bytes(bytes.to_vec()) {
            let errors = verify_log(&log).into_iter().filter(|finding| finding.level == Level::Error);
            assert!(errors.count() > 0, "{what}: refused, and verify finds nothing");
            let recovered = recover(&place.file("log.mcap"), &place.file("new.mcap")).unwrap();
            assert!(!matches!(recovered, RecoverOutcome::Lossless { .. }), "{what}");
        }
        false
    }
}

#[test]
fn five_hundred_damages() {
    let whole = Stretches::new();
    let mut random = Random::new(seed());
    let (mut right, mut refused) = (0, 0);
    for round in 0..500 {
        let mut bytes = whole.bytes.clone();
        let across = |random: &mut Random| whole.manifest.start - 20 + random.below(whole.manifest.len() + 40);
        let what = match round {
            0..200 => {
                let (at, bit) = (across(&mut random), random.below(8));
                bytes[at] ^= 1 << bit;
                format!("bit {bit} of byte {at}")
            }
            200..280 => {
                let (at, bit) = (random.below(bytes.len()), random.below(8));
                bytes[at] ^= 1 << bit;
                format!("bit {bit} of byte {at}")
            }
            280..400 => {
                let at = if round < 340 { across(&mut random) } else { random.below(bytes.len()) } / 512 * 512;
                let end = bytes.len().min(at + 512);
                bytes[at..end].fill(0);
                format!("zeros from {at} to {end}")
            }
            _ => {
                bytes.truncate(if round < 450 { across(&mut random) } else { random.below(bytes.len()) });
                format!("cut at {}", bytes.len())
            }
        };
        match whole.resume(&bytes, &format!("{what}; the second manifest is {:?}", whole.manifest)) {
            true => right += 1,
            false => refused += 1,
        }
    }
    println!("{right} came to the right end, {refused} were refused with a reason");
    assert!(right > 100 && refused > 100);
}

/// The scene's file brings back what a lost manifest said; a lost manifest is said by every command that reads.
#[test]
fn a_lost_manifest_is_said_and_has_a_way_out() {
    let whole = Stretches::new();
    let place = Sandbox::new();
    let mut bytes = whole.bytes.clone();
    bytes[whole.manifest.start] ^= 1;
    place.write("log.mcap", &bytes);
    let said = ["the manifest at byte", "is lost"];
    place.foldline("inspect log.mcap").ends(0).says(&said);
    place.foldline("verify log.mcap").ends(1).says(&said);
    place.foldline("recover log.mcap -o new.mcap").ends(3).says(&said);
    place.foldline("resume log.mcap").ends(1).says(&["the scene", "is lost", "--resume"]);
    place.write("far.toml", scene_to("3.0"));
    place.foldline("thin log.mcap -o thin.mcap --keep 1").ends(1).says(&["foldline recover"]);
    place.foldline("thin new.mcap -o thin.mcap --keep 1").ends(1).says(&["could not be made again", "--resume"]);
    let said = place.foldline("run far.toml -o log.mcap --resume").ends(0);
    said.says(&["has lost a manifest", "takes its place"]);
    assert_eq!(place.log("log.mcap").last_commit().unwrap().chain_hash, whole.far_end);
    assert!(Resume::open(&place.file("log.mcap")).unwrap().log().lost_manifests().len() == 1);
    has_its_scene_again(&place);
}

/// Nothing is missed of a log to which a lost scene was given again.
#[track_caller]
fn has_its_scene_again(place: &Sandbox) {
    place.foldline("verify log.mcap").ends(0).says(&["makes the same states", "log.mcap: good"]);
    place.foldline("resume log.mcap").ends(0).says(&["nothing to do"]);
    place.foldline("replay log.mcap --from-scratch").ends(0);
    place.foldline("recover log.mcap -o copy.mcap").ends(0);
    place.foldline("thin copy.mcap -o thinner.mcap --keep 1").ends(0);
    place.foldline("verify thinner.mcap").ends(0);
}

/// The way out of a lost manifest is open for a finished log as well, and what recovery leaves takes it too.
#[test]
fn a_finished_log_gets_its_scene_again() {
    for recovered in [false, true] {
        let place = Sandbox::new();
        place.write("far.toml", scene_to("3.0"));
        place.foldline("run far.toml -o log.mcap --quiet").ends(0);
        let mut bytes = place.read("log.mcap");
        let at = bytes.windows(18).position(|window| window == b"rotation_deg = 3.0").unwrap();
        bytes[at + 15] = b'2';
        place.write("log.mcap", &bytes);
        place.foldline("verify log.mcap").ends(1).says(&["run SCENE -o LOG --resume"]);
        if recovered {
            place.foldline("recover log.mcap -o new.mcap").ends(3);
            std::fs::rename(place.file("new.mcap"), place.file("log.mcap")).unwrap();
        }
        place.foldline("run far.toml -o log.mcap --resume").ends(0).says(&["takes its place"]);
        has_its_scene_again(&place);
    }
}

/// The scene of an earlier stretch is lost, and that of the last is there: every message says which stages are meant, and the
/// way out that it names puts the scene back, whatever became of the log meanwhile.
#[test]
fn an_earlier_scene_is_put_back() {
    let place = Sandbox::new();
    let tighter = scene_to("3.0") + "\n[solver]\ntolerance = 1e-9\n";
    for (name, scene) in [("first", scene_to("3.0")), ("last", tighter)] {
        place.write(&format!("{name}.toml"), scene);
    }
    place.foldline("run first.toml -o log.mcap --until 1 --quiet").ends(0);
    place.foldline("run last.toml -o log.mcap --resume --until 2 --quiet").ends(0);
    let unfinished = place.read("log.mcap");
    place.foldline("resume log.mcap --quiet").ends(0);
    let chain = place.log("log.mcap").last_commit().unwrap().chain_hash;
    for (what, mut bytes) in [("finished", place.read("log.mcap")), ("unfinished", unfinished)] {
        let at = bytes.windows(18).position(|window| window == b"rotation_deg = 3.0").unwrap();
        bytes[at + 15] = b'2';
        let log = Log::from_bytes(bytes.clone()).unwrap();
        let lost = log.entries().iter().take_while(|entry| entry.record.report.parameter <= 1.0).count();
        let stages = format!("the scene of stages 0 to {} (load steps 1 to 2)", lost - 1);
        for recovered in [false, true] {
            place.write("log.mcap", &bytes);
            if recovered {
                place.foldline("recover log.mcap -o new.mcap").ends(3).says(&[&stages]);
                std::fs::rename(place.file("new.mcap"), place.file("log.mcap")).unwrap();
            }
            for (command, code) in
                [("verify log.mcap", 1), ("inspect log.mcap", 0), ("thin log.mcap -o thin.mcap --keep 1", 1)]
            {
                place.foldline(command).ends(code).says(&[&stages, "--resume` with that scene's file"]);
            }
            place.foldline("replay log.mcap --step 1").ends(1).says(&["stage 0 of log.mcap", "--resume"]);
            place.foldline("run first.toml -o log.mcap --resume").ends(0).says(&["put back", &stages]);
            assert_eq!(place.log("log.mcap").commits(), log.commits(), "{what}: no stage is added or taken");
            place.foldline("resume log.mcap --quiet").ends(0);
            let again = place.log("log.mcap");
            assert_eq!(
                (again.completeness(), again.last_commit().unwrap().chain_hash),
                (Completeness::Finished, chain)
            );
            has_its_scene_again(&place);
            for copy in ["copy.mcap", "thinner.mcap"] {
                std::fs::remove_file(place.file(copy)).unwrap();
            }
        }
    }
}

/// Where the scene of the last stretch is lost, nothing of the one before is shown as if it held.
#[test]
fn an_older_scene_is_said_to_be_one() {
    let whole = Stretches::new();
    let place = Sandbox::new();
    let mut bytes = whole.bytes.clone();
    bytes[whole.manifest.start + 40] ^= 1;
    place.write("log.mcap", &bytes);
    place.write("whole.mcap", &whole.bytes);
    for command in ["inspect log.mcap", "bisect log.mcap whole.mcap", "bisect whole.mcap log.mcap"] {
        let said = place.foldline(command);
        assert!(said.out.contains("what the run was to compute from stage"), "{command}: {}", said.out);
    }
}

/// A damaged manifest at the end under which no stage was run keeps nobody from continuing; it is said, and kept aside.
#[test]
fn a_manifest_that_nothing_depends_on() {
    let whole = Stretches::new();
    let kept = &whole.bytes[..whole.manifest.end];
    let torn = &kept[..whole.manifest.start + 700];
    let flipped = |at: usize| {
        let mut bytes = kept.to_vec();
        bytes[whole.manifest.start + at] ^= 1;
        bytes
    };
    // In its head, in the length of its first text, in the scene.
    for (what, bytes) in
        [("torn", torn.to_vec()), ("head", flipped(0)), ("length", flipped(32)), ("scene", flipped(900))]
    {
        let place = Sandbox::new();
        place.write("log.mcap", &bytes);
        let said = ["the log ends in a manifest that cannot be read: no stage was run under it"];
        place.foldline("verify log.mcap").ends(1).says(&said);
        place.foldline("recover log.mcap -o new.mcap").ends(3);
        assert_eq!(place.log("new.mcap").lost_manifests(), [], "{what}");
        let resumed = place.foldline("resume log.mcap --quiet").ends(0).says(&said);
        resumed.says(&["what was dropped is kept in", "log.mcap.dropped-1"]);
        assert!(bytes.ends_with(&place.read("log.mcap.dropped-1")), "{what}");
        let log = place.log("log.mcap");
        assert_eq!(log.last_commit().unwrap().chain_hash, whole.near_end, "{what}");
        place.foldline("verify log.mcap").ends(0);
    }
}
