//! Logs with bits flipped: read to a verified prefix or refused, quickly, without much memory, and never silently.

use std::time::{Duration, Instant};

use foldline::journal::format::CHUNK_BYTES_LIMIT;
use foldline::journal::{Completeness, Level, Log, recover, verify_log};
use foldline::record::Record;
use foldline::state::State;

use crate::memory::peak;
use crate::program::Sandbox;
use crate::support::{assert_prefix, assert_prefix_by_its_last_state, finished_log};
use crate::synthetic;

/// What reading may take beyond the file itself.
const MEMORY_LIMIT: isize = 2 * CHUNK_BYTES_LIMIT as isize;

/// A small generator of numbers that a seed decides (splitmix64).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        println!("seed {seed:#018x}");
        Self(seed)
    }

    pub fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((mixed ^ (mixed >> 31)) % bound as u64) as usize
    }
}

/// A seed from the clock, or the one in `FOLDLINE_SEED`.
pub fn seed() -> u64 {
    let clock = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap().as_nanos() as u64;
    std::env::var("FOLDLINE_SEED").map_or(clock, |text| u64::from_str_radix(text.trim_start_matches("0x"), 16).unwrap())
}

/// No damage keeps a reader longer than this.
const SLOW: Duration = Duration::from_secs(1);

#[derive(Default, Debug)]
struct Tally {
    refused: usize,
    whole: usize,
    shorter: usize,
    longest: Duration,
    most_memory: isize,
}

fn read_damaged(bytes: Vec<u8>, run: &[(State, Record)], tally: &mut Tally) {
    let again = bytes.clone();
    let began = Instant::now();
    let (log, memory) = peak(|| Log::from_bytes(bytes));
    let mut took = began.elapsed();
    if took > SLOW {
        // The machine may have stalled: what is slow is slow twice.
        let began = Instant::now();
        drop(Log::from_bytes(again));
        took = took.min(began.elapsed());
    }
    tally.longest = tally.longest.max(took);
    tally.most_memory = tally.most_memory.max(memory);
    let Ok(log) = log else {
        tally.refused += 1;
        return;
    };
    let small = run[0].0.displacement.len() < 1000;
    let ((), memory) = peak(|| match small {
        true => assert_prefix(&log, run),
        false => assert_prefix_by_its_last_state(&log, run),
    });
    tally.most_memory = tally.most_memory.max(memory);
    if log.entries().len() == run.len() {
        tally.whole += 1;
    } else {
        tally.shorter += 1;
        let told = matches!(log.completeness(), Completeness::Truncated { .. } | Completeness::Damaged { .. });
        assert!(told && log.loss().is_some(), "lost commits and did not say so: {:?}", log.completeness());
    }
}

fn check(tally: &Tally) {
    println!("{tally:?}");
    assert!(tally.longest < SLOW, "{tally:?}");
    assert!(tally.most_memory < MEMORY_LIMIT, "{tally:?}");
}

#[test]
fn ten_thousand_flipped_bits() {
    let run = synthetic::run(3, 12);
    let bytes = finished_log(&run);
    let mut random = Random::new(seed());
    let mut tally = Tally::default();
    for _ in 0..10_000 {
        let mut damaged = bytes.clone();
        damaged[random.below(bytes.len())] ^= 1 << random.below(8);
        read_damaged(damaged, &run, &mut tally);
    }
    check(&tally);
    assert_eq!(tally.refused, 0, "one bit costs no more than the commits behind it");
}

/// Every bit in front of the first commit and around the first index, where lengths and kinds of records stand.
#[test]
fn every_bit_of_the_framing() {
    let run = synthetic::run(2, 3);
    let bytes = finished_log(&run);
    let whole = Log::from_bytes(bytes.clone()).unwrap();
    let (first, second) = (whole.entries()[0].bytes.clone(), whole.entries()[1].bytes.clone());
    let mut tally = Tally::default();
    let places = (0..first.start as usize + 60).chain(first.end as usize..second.start as usize + 60);
    for place in places {
        for bit in 0..8 {
            let mut damaged = bytes.clone();
            damaged[place] ^= 1 << bit;
            read_damaged(damaged, &run, &mut tally);
        }
    }
    check(&tally);
}

/// Schemas and channels are described in the first chunk alone. That they are damaged there costs no stage, and a copy describes
/// them again; that its stage is lost as well hides none of those behind it.
#[test]
fn descriptions_of_channels_are_not_missed() {
    let run = synthetic::run(3, 6);
    let bytes = finished_log(&run);
    let first = Log::from_bytes(bytes.clone()).unwrap().entries()[0].bytes.clone();
    let place_of = |text: &[u8]| {
        let place = bytes.windows(text.len()).position(|window| window == text).unwrap();
        assert!((first.start..first.end).contains(&(place as u64)));
        place
    };
    let texts =
        ["/foldline/mesh", "/foldline/state", "/foldline/report", "/foldline/commit", "foldline.Report", "jsonschema"];
    for (text, bit) in texts.iter().flat_map(|text| [0, 7].map(|bit| (text, bit))) {
        let mut damaged = bytes.clone();
        damaged[place_of(text.as_bytes()) + 6] ^= 1 << bit;
        let place = Sandbox::new();
        place.write("log.mcap", &damaged);
        let log = place.log("log.mcap");
        assert_eq!((log.entries().len(), log.completeness()), (run.len(), Completeness::Finished), "{text}");
        assert_prefix(&log, &run);
        place.foldline("verify log.mcap").ends(1).says(&["cannot be read"]);
        recover(&place.file("log.mcap"), &place.file("new.mcap")).unwrap();
        let copy = place.log("new.mcap");
        assert_prefix(&copy, &run);
        assert_eq!(copy.completeness(), Completeness::Finished);
        let wrong: Vec<_> = verify_log(&copy).into_iter().filter(|finding| finding.level > Level::Info).collect();
        assert!(wrong.is_empty(), "{text}: {wrong:?}");
    }
    let mut damaged = bytes.clone();
    damaged[place_of(b"/foldline/mesh") + 200] ^= 1;
    let log = Log::from_bytes(damaged).unwrap();
    assert_eq!((log.entries().len(), log.later_commits().len()), (0, run.len() - 1));
}

/// A log of 12 MB: lengths that claim gigabytes, or most of the file, buy no memory.
#[test]
fn flipped_bits_in_a_large_log() {
    let run = synthetic::run(120, 60);
    let bytes = finished_log(&run);
    assert!(bytes.len() > 8 << 20);
    let whole = Log::from_bytes(bytes.clone()).unwrap();
    let mut random = Random::new(seed());
    let mut tally = Tally::default();
    for round in 0..60 {
        let mut damaged = bytes.clone();
        // Every other time in the nine bytes in front of a chunk or in its header.
        let place = match round % 2 {
            0 => random.below(bytes.len()),
            _ => whole.entries()[random.below(run.len())].bytes.start as usize + random.below(50),
        };
        damaged[place] ^= 1 << random.below(8);
        read_damaged(damaged, &run, &mut tally);
    }
    check(&tally);
}

/// The largest stage that a chunk holds: half a million control points.
#[test]
fn memory_for_the_largest_stage() {
    let run = synthetic::run(900, 1);
    let bytes = finished_log(&run);
    let mut tally = Tally::default();
    assert!(bytes.len() > 43 << 20);
    read_damaged(bytes, &run, &mut tally);
    check(&tally);
    let (mut writer, _) = crate::support::writer(foldline::scene::SyncPolicy::AtEnd);
    let (state, record) = synthetic::run(960, 1).remove(0);
    let error = writer.commit(&state, &record).unwrap_err();
    let cause = std::error::Error::source(&error).unwrap().to_string();
    assert!(cause.ends_with("bytes, and a chunk of a log holds 50331648: use a coarser mesh"), "{cause}");
}

/// Records swapped, repeated and left out, each whole in itself.
#[test]
fn chunks_out_of_place() {
    let run = synthetic::run(2, 5);
    let bytes = finished_log(&run);
    let log = Log::from_bytes(bytes.clone()).unwrap();
    let starts: Vec<usize> = log.entries().iter().map(|entry| entry.bytes.start as usize).collect();
    let piece = |index: usize| &bytes[starts[index]..starts[index + 1]];
    let build = |order: &[usize]| {
        let mut built = bytes[..starts[0]].to_vec();
        order.iter().for_each(|index| built.extend_from_slice(piece(*index)));
        Log::from_bytes(built).unwrap()
    };
    for (order, good, later) in [
        (&[0, 1, 2, 3][..], 4, 0),
        (&[0, 2, 1, 3], 2, 2),
        (&[0, 1, 1, 2, 3], 4, 0),
        (&[0, 1, 3], 2, 1),
        (&[1, 2, 3], 0, 3),
        (&[0, 3, 2], 1, 2),
    ] {
        let log = build(order);
        assert_eq!((log.entries().len(), log.later_commits().len()), (good, later), "{order:?}");
        assert_prefix(&log, &run);
    }
}
