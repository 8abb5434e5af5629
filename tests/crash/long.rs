//! Long logs: what they are asked takes the time and memory of the answer.
//!
//! A million commits, to be looked at with `/usr/bin/time -v foldline resume LOG --until 0.1` and the like:
//!
//! ```text
//! FOLDLINE_LONG_LOG=/tmp/long.mcap FOLDLINE_COMMITS=1000000 \
//!     cargo test --release --test crash long::write_a_long_log -- --ignored --nocapture
//! ```

use std::fs;
use std::path::Path;
use std::time::Instant;

use foldline::journal::{AskedLog, JournalWriter, Level, Log, LongLog, Manifest, Resume, verify};
use foldline::pipeline::{Run, Stages};
use foldline::record::{Commit, MemorySink, Record};
use foldline::scene::SyncPolicy;
use foldline::state::State;

use crate::flips::{Random, seed};
use crate::memory::peak;
use crate::program::{Said, Sandbox, scene};

pub const SCENE: &str = r#"
[geometry]
kind = "tape-spring"
length_mm = 300.0
radius_mm = 10.0
arc_deg = 110.0

[material]
kind = "isotropic"
youngs_modulus_mpa = 131000.0
poissons_ratio = 0.3
thickness_mm = 0.1

[mesh]
degree = [2, 2]
elements = [4, 2]

[symmetry]
part = "quarter"

[load]
kind = "end-rotation"
sense = "opposite"
rotation_deg = 4.0
increment_deg = 0.01

[pipeline]
stages = ["solve"]
"#;

/// The moment of the stage that conditions look for.
const LARGE_N_MM: f64 = 1.0e6;

/// A log of so many commits: states near the third of a real run, and at the end that one itself, so that the program continues
/// from there. Three quarters on stands a large moment.
pub fn write_long(path: &Path, commits: u64) {
    write_long_of(SCENE, path, commits);
}

/// The same of another scene.
pub fn write_long_of(text: &str, path: &Path, commits: u64) {
    let scene = scene(text);
    let mut stages = Stages::new(scene.clone());
    let start = stages.start().unwrap();
    let mut sink = MemorySink::default();
    Run::new(stages, start.clone(), None).to_end(Some(0.03), &|| false, &mut sink).unwrap();
    let (real, record) = sink.stages.pop().unwrap();
    let manifest = Manifest::here(Path::new("long.toml"), text, 1);
    let mut writer = JournalWriter::create(path, &manifest, SyncPolicy::AtEnd).unwrap();
    let scene_hash = scene.hash();
    let (mut previous, mut parent): (Option<Commit>, _) = (None, start.hash());
    for ordinal in 0..commits {
        let mut state = State { step: ordinal + 1, ..real.clone() };
        let mut report = record.report.clone();
        report.step = ordinal + 1;
        if ordinal + 1 < commits {
            let share = ordinal as f64 / commits as f64;
            state.displacement.iter_mut().for_each(|point| point[2] += share * 1e-3);
            state.moment_n_mm *= 1.0 + share;
        }
        if ordinal == commits / 4 * 3 {
            state.moment_n_mm = LARGE_N_MM;
        }
        report.moment_n_mm = state.moment_n_mm;
        let hash = state.hash();
        let commit = Commit::next(previous.as_ref(), report.stage, report.step, scene_hash, parent, hash);
        writer.commit(&state, &Record { report, commit, wall_s: 0.01, kept_s: 0.0 }).unwrap();
        (previous, parent) = (Some(commit), hash);
    }
}

/// Not a test: the log to measure.
#[test]
#[ignore = "writes the log that FOLDLINE_LONG_LOG names"]
fn write_a_long_log() {
    let path = std::env::var("FOLDLINE_LONG_LOG").unwrap();
    let commits = std::env::var("FOLDLINE_COMMITS").map_or(1_000_000, |text| text.parse().unwrap());
    let began = Instant::now();
    write_long(Path::new(&path), commits);
    let bytes = fs::metadata(&path).unwrap().len();
    println!("{commits} commits, {bytes} bytes in {:?}", began.elapsed());
}

/// What the program answers about a long log is what it would answer having read all of it, whether there is an index, none, or
/// a damaged one.
#[test]
fn an_index_changes_no_answer() {
    const COMMITS: u64 = 20_000;
    let place = Sandbox::new();
    let path = place.file("long.mcap");
    write_long(&path, COMMITS);
    assert_eq!(place.logs(), ["long.mcap", "long.mcap.index"]);
    let index = place.read("long.mcap.index");
    let whole = Log::read(&path).unwrap();
    let faults: Vec<_> = verify(&path).into_iter().filter(|finding| finding.level > Level::Info).collect();
    assert!(faults.is_empty(), "{faults:?}");

    let (long, memory) = peak(|| LongLog::open(&path).unwrap().unwrap());
    assert!(long.tail().entries().len() < 3000, "{} stages were read", long.tail().entries().len());
    assert!(memory < 24 << 20, "{memory} bytes for a log of {}", whole.file_len());
    for ordinal in [0, 1, 5000, 15_000, COMMITS as usize - 1] {
        assert_eq!(long.record(ordinal).unwrap(), whole.entries()[ordinal].record);
    }
    let ask = || {
        let step = place.foldline("inspect long.mcap --step 12345 --json").ends(0).out;
        let condition = "moment_n_mm > 999999 and step > 3";
        let first = place.command("bisect long.mcap --when").arg(condition).output().unwrap();
        (step, Said::new("bisect", first).ends(0).out)
    };
    let (step, first) = ask();
    assert!(step.contains("\"step\":12345"), "{step}");
    assert!(first.contains("15000"), "{first}");
    place.foldline("inspect long.mcap --step 20001").ends(2).says(&["it has 1 to 20000"]);
    let mut random = Random::new(seed());
    for round in 0..30 {
        let mut damaged = index.clone();
        match round {
            0 => damaged.clear(),
            1..5 => damaged.truncate(random.below(index.len())),
            5..10 => damaged[..].fill(0),
            _ => damaged[random.below(index.len())] ^= 1 << random.below(8),
        }
        place.write("long.mcap.index", damaged);
        assert_eq!(ask(), (step.clone(), first.clone()), "round {round}");
    }
    for changed in crafted(&index) {
        place.write("long.mcap.index", changed);
        assert_eq!(ask(), (step.clone(), first.clone()));
    }
    fs::remove_file(place.file("long.mcap.index")).unwrap();
    assert_eq!(ask(), (step, first));
}

/// Indexes whose first head says what none would, with its hash right.
fn crafted(index: &[u8]) -> Vec<Vec<u8>> {
    let length = u64::from_le_bytes(index[8..16].try_into().unwrap()) as usize;
    let head: serde_json::Value = serde_json::from_slice(&index[48..48 + length]).unwrap();
    let with = |change: &dyn Fn(&mut serde_json::Value)| {
        let mut head = head.clone();
        change(&mut head);
        let json = serde_json::to_vec(&head).unwrap();
        let start = [&index[..8], &(json.len() as u64).to_le_bytes(), blake3::hash(&json).as_bytes()].concat();
        [&start[..], &json, &index[48 + length..]].concat()
    };
    let field = head["mark"]["fields"][0].clone();
    vec![
        with(&|head| {
            head["columns"] = serde_json::json!([]);
            head["commits"] = (1_u64 << 62).into();
        }),
        with(&|head| head["commits"] = u64::MAX.into()),
        with(&|head| head["mark"]["fields"] = vec![field.clone(); 1000].into()),
        with(&|head| {
            let record = head["mark"]["metadata"][0].clone();
            head["mark"]["metadata"] = vec![record; 100_000].into();
        }),
        with(&|head| head["mark"]["described_at"] = vec![0; 100_000].into()),
    ]
}

/// Behind the last block of an index there may be more than is read at first: it is asked like all else.
#[test]
fn what_lies_behind_the_last_block_is_found() {
    const COMMITS: u64 = 5 * 1024 + 1000;
    let place = Sandbox::new();
    let path = place.file("long.mcap");
    write_long_of(&SCENE.replace("elements = [4, 2]", "elements = [24, 12]"), &path, COMMITS);
    let long = LongLog::open(&path).unwrap().unwrap();
    let rest = fs::metadata(&path).unwrap().len() - long.tail().entries()[0].bytes.start;
    assert!(rest > 4 << 20, "{rest} bytes behind the last block");
    for with_index in [true, false] {
        for step in [4000, 5120, 5121, 5300, 5600, COMMITS] {
            place.foldline(&format!("inspect long.mcap --step {step}")).ends(0).says(&[&format!("{step}")]);
        }
        if with_index {
            LongLog::read_through(&path).unwrap().unwrap();
        }
    }
}

/// Stages of a long log are had, and run again, without the rest of it; and what is said of them is what is said having read it.
#[test]
fn a_part_of_a_long_log_is_as_good_as_all_of_it() {
    const COMMITS: u64 = 8000;
    let place = Sandbox::new();
    let path = place.file("long.mcap");
    write_long(&path, COMMITS);
    let whole = Log::read(&path).unwrap();
    let (asked, memory) = peak(|| {
        let asked = AskedLog::open(&path).unwrap();
        // At the start, on both sides of a block of the index, and at the end.
        for ordinal in [0, 1, 1023, 1024, 1025, 5000, COMMITS as usize - 1] {
            let part = asked.part(ordinal..ordinal + 1).unwrap();
            assert!(part.entries().len() <= 2200, "{} stages for one", part.entries().len());
            for index in ordinal.saturating_sub(1)..=ordinal {
                assert_eq!(part.state(index).unwrap().hash(), whole.state(index).unwrap().hash());
                assert_eq!(part.entry(index).unwrap().record, whole.entry(index).unwrap().record);
            }
        }
        asked
    });
    assert!(matches!(asked, AskedLog::Long(_)));
    assert!(memory < 24 << 20, "{memory} bytes for a log of {}", whole.file_len());
    let beyond = asked.part(COMMITS as usize..COMMITS as usize + 1).unwrap_err();
    assert!(beyond.to_string().contains("there is no stage 8000 in this log: it holds 8000"), "{beyond}");
    let every: Vec<usize> = (0..COMMITS as usize).collect();
    let in_parts = asked.parts(&every).flat_map(|part| {
        let (log, indices) = part.unwrap();
        indices.iter().map(|index| log.entry(*index).unwrap().record.clone()).collect::<Vec<_>>()
    });
    assert!(in_parts.eq(whole.entries().iter().map(|entry| entry.record.clone())));

    fs::copy(&path, place.file("copy.mcap")).unwrap();
    for (command, code) in [
        ("replay LOG --step 5000", 4),
        ("stability LOG --step 5000", 0),
        ("stability LOG --step 8001", 2),
        ("replay LOG --step 5000 --stage refine-knots", 2),
    ] {
        let of_part = place.foldline(&command.replace("LOG", "long.mcap")).ends(code);
        let of_whole = place.foldline(&command.replace("LOG", "copy.mcap")).ends(code);
        assert_eq!(of_part.out, of_whole.out.replace("copy.mcap", "long.mcap"), "{command}");
        assert_eq!(of_part.err, of_whole.err.replace("copy.mcap", "long.mcap"), "{command}");
    }
    place
        .foldline("bisect long.mcap copy.mcap")
        .ends(0)
        .says(&["the same: all 8000 stages, by their chains of hashes"]);
    // A flipped byte in the middle: what stands before it is still had, and what stands there is refused.
    let mut damaged = place.read("long.mcap");
    let chunk = &whole.entries()[5000].bytes;
    damaged[(chunk.start + chunk.end) as usize / 2] ^= 1;
    place.write("long.mcap", damaged);
    place.foldline("stability long.mcap --step 4000").ends(0);
    place.foldline("stability long.mcap --step 5001").ends(1).says(&["commit 5000", "foldline verify"]);
}

/// The same of a log that was thinned, whose states lie far apart.
#[test]
fn a_thinned_long_log_has_an_index_too() {
    const COMMITS: u64 = 8000;
    let place = Sandbox::new();
    write_long(&place.file("long.mcap"), COMMITS);
    place.foldline("thin long.mcap --keep 100,every=3000 -o thin.mcap").ends(0);
    let path = place.file("thin.mcap");
    let whole = Log::read(&path).unwrap();
    let asked = AskedLog::Long(Box::new(LongLog::read_through(&path).unwrap().unwrap()));
    assert!(place.logs().contains(&"thin.mcap.index".to_owned()));
    assert!(matches!(AskedLog::open(&path).unwrap(), AskedLog::Long(_)), "by its index");
    assert_eq!(asked.end().thinned(), whole.thinned());
    // What is asked for stands behind a state, or at the start of the run.
    for (ordinal, kept) in [(50, None), (99, Some(99)), (1024, Some(99)), (2999, Some(2999)), (4500, Some(2999))] {
        let part = asked.part(ordinal + 1..ordinal + 2).unwrap();
        let last = (part.first()..=ordinal).rev().find(|index| part.keeps_state(*index));
        assert_eq!(last, kept, "{ordinal}");
        assert!(kept.is_some() || part.first() == 0);
        if let Some(kept) = kept {
            assert_eq!(part.state(kept).unwrap().hash(), whole.state(kept).unwrap().hash());
        }
        assert_eq!(part.entry(ordinal).unwrap().record, whole.entry(ordinal).unwrap().record);
    }
    let of_index = place.foldline("inspect thin.mcap --step 5000 --json").ends(0).out;
    place.foldline("resume thin.mcap --until 0.06 --quiet").ends(0);
    assert!(place.log("thin.mcap").entries().len() as u64 >= COMMITS + 2);
    assert_eq!(place.foldline("inspect thin.mcap --step 5000 --json").ends(0).out, of_index);
    fs::remove_file(place.file("thin.mcap.index")).unwrap();
    assert_eq!(place.foldline("inspect thin.mcap --step 5000 --json").ends(0).out, of_index);
}

/// A long log is continued from its end, in place, with the index or without; its index grows with it.
#[test]
fn a_long_log_goes_on() {
    const COMMITS: u64 = 6000;
    let place = Sandbox::new();
    let path = place.file("long.mcap");
    write_long(&path, COMMITS);
    let mut chains = Vec::new();
    let before = place.read("long.mcap");
    let index = place.read("long.mcap.index");
    for with_index in [true, false] {
        place.write("long.mcap", &before);
        match with_index {
            true => place.write("long.mcap.index", &index),
            false => fs::remove_file(place.file("long.mcap.index")).unwrap(),
        }
        let resumed = place.foldline("resume long.mcap --until 0.06 --quiet").ends(0);
        if with_index {
            // Numbers of its end would be taken for those of the run.
            resumed.says(&["no summary"]);
        }
        let after = place.read("long.mcap");
        assert_eq!(after[..before.len()], before);
        let log = Log::read(&path).unwrap();
        assert!(log.entries().len() as u64 >= COMMITS + 2);
        let faults: Vec<_> = verify(&path).into_iter().filter(|finding| finding.level > Level::Info).collect();
        assert!(faults.is_empty(), "{faults:?}");
        chains.push(log.last_commit().unwrap().chain_hash);
        // And again, behind its summary.
        place.foldline("resume long.mcap --until 0.08 --quiet").ends(0);
        assert!(Log::read(&path).unwrap().entries().len() > log.entries().len());
        assert_eq!(Log::read(&path).unwrap().manifests().len(), 3);
    }
    assert_eq!(chains[0], chains[1]);
    // Every reader of MCAP finds every chunk.
    let bytes = place.read("long.mcap");
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let log = Log::read(&path).unwrap();
    let entries = log.entries().iter().zip(&summary.chunk_indexes);
    assert!(entries.clone().count() == log.entries().len());
    for (entry, chunk) in entries {
        let place = chunk.chunk_start_offset..chunk.chunk_start_offset + chunk.chunk_length;
        assert_eq!(place, entry.bytes);
    }
    let messages = mcap::MessageStream::new(&bytes).unwrap().count() as u64;
    assert_eq!(summary.stats.unwrap().message_count, messages);
    assert!(Resume::open(&path).unwrap().log().first() > 0, "only the end is read");
}
