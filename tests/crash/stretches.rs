//! A log of two stretches: no damage makes a run end at the target of the first in silence.

use foldline::journal::{Completeness, Level, Log, RecoverOutcome, Resume, recover, verify_log};
use foldline::state::Hash;

use crate::flips::{Random, seed};
use crate::program::{Place, Said};

const SCENE: &str = include_str!("../../checkpoints/golden/scene.toml");

fn scene_to(target: &str) -> String {
    let text = SCENE.replace("rotation_deg = 4.0", &format!("rotation_deg = {target}"));
    text.replace("increment_deg = 2.0", "increment_deg = 0.5")
}

/// Run to 1°, gone on with to 3°, of which it has come to 2°.
struct Stretches {
    bytes: Vec<u8>,
    /// Where the second manifest lies.
    manifest: std::ops::Range<usize>,
    near_end: Hash,
    far_end: Hash,
}

impl Stretches {
    fn new() -> Self {
        let place = Place::new();
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
        let place = Place::new();
        place.write("log.mcap", bytes);
        let said: Said = place.foldline("resume log.mcap --quiet");
        if said.code == Some(0) {
            let log = place.log("log.mcap");
            // Nothing of the second stretch is left, not even a piece.
            let cut_before = bytes.len() <= self.manifest.start;
            let right = if cut_before { self.near_end } else { self.far_end };
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
    let place = Place::new();
    let mut bytes = whole.bytes.clone();
    bytes[whole.manifest.start] ^= 1;
    place.write("log.mcap", &bytes);
    let said = ["the manifest at byte", "is lost"];
    place.foldline("inspect log.mcap").ends(0).says(&said);
    place.foldline("verify log.mcap").ends(1).says(&said);
    place.foldline("recover log.mcap -o new.mcap").ends(3).says(&said);
    place.foldline("resume log.mcap").ends(1).says(&["the scene", "is lost", "--resume"]);
    place.write("far.toml", scene_to("3.0"));
    let said = place.foldline("run far.toml -o log.mcap --resume").ends(0);
    said.says(&["has lost a manifest", "takes its place"]);
    assert_eq!(place.log("log.mcap").last_commit().unwrap().chain_hash, whole.far_end);
    assert!(Resume::open(&place.file("log.mcap")).unwrap().log().lost_manifests().len() == 1);
}
