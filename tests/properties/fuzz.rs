//! Fuzzing of the reader and of the scene parser: for as long as one likes.
//!
//! ```text
//! FOLDLINE_FUZZ_SECONDS=600 cargo test --release --test properties fuzz -- --nocapture
//! ```
//!
//! Each target then runs for that long; without the variable a second. Seeds of cases that failed are kept in
//! `tests/properties/regressions-*.txt`, which belong into the repository and are tried first from then on.
//!
//! The reader gets golden logs with pieces cut out, moved, repeated, taken from another log of the same run, and with
//! the checksums of MCAP made right again, so that what refuses them is foldline's own hashes. What it accepts must be
//! a beginning of the run, state by state.

use std::cell::Cell;
use std::path::Path;
use std::time::{Duration, Instant};

use foldline::journal::{Log, StateError, verify_log};
use foldline::scene::parse_with_settings;
use foldline::state::State;
use proptest::prelude::*;
use proptest::sample::Index;
use proptest::test_runner::{Config, FileFailurePersistence, TestRunner};

/// Longest that one log or scene may take.
const CASE_LIMIT: Duration = Duration::from_secs(1);

/// Runs a target for the time asked for, in batches with seeds of their own.
fn fuzz<S: Strategy>(
    name: &str,
    regressions: &'static str,
    strategy: S,
    test: impl Fn(S::Value) -> Result<(), TestCaseError>,
) where
    S::Value: std::fmt::Debug + Clone,
{
    let seconds = std::env::var("FOLDLINE_FUZZ_SECONDS").map_or(1, |text| text.parse().unwrap());
    let (began, cases) = (Instant::now(), Cell::new(0_u64));
    while began.elapsed() < Duration::from_secs(seconds) {
        let config = Config {
            failure_persistence: Some(Box::new(FileFailurePersistence::Direct(regressions))),
            max_shrink_time: 60_000,
            ..Config::with_cases(500)
        };
        let outcome = TestRunner::new(config).run(&strategy, |value| {
            cases.set(cases.get() + 1);
            // What is slow in itself is slow every time; what the machine held up is not.
            let mut took = Duration::MAX;
            for _ in 0..3 {
                let case = Instant::now();
                test(value.clone())?;
                took = took.min(case.elapsed());
                if took < CASE_LIMIT {
                    return Ok(());
                }
            }
            Err(TestCaseError::fail(format!("took {took:?}")))
        });
        if let Err(failure) = outcome {
            panic!("{name}, case {}: {failure}", cases.get());
        }
    }
    println!("{name}: {} cases in {:?}, no finding", cases.get(), began.elapsed());
}

/// What is done to a log.
#[derive(Clone, Debug)]
enum Edit {
    Flip(Index, u8),
    Cut(Index),
    Remove(Index, usize),
    /// From one place to another.
    Repeat(Index, usize, Index),
    /// A number where a length may stand.
    Number(Index, u64),
    /// A piece of another golden log.
    Foreign(Index, Index, usize, Index),
    Insert(Index, Vec<u8>),
}

fn edit() -> impl Strategy<Value = Edit> {
    let number = prop_oneof![
        any::<u64>(),
        (0..64_u32).prop_map(|bit| 1 << bit),
        (0..64_u32).prop_map(|bit| (1_u64 << bit).wrapping_sub(1)),
        0..70_000_u64,
    ];
    let length = prop_oneof![1..16_usize, 1..4000_usize];
    prop_oneof![
        4 => (any::<Index>(), 0..8_u8).prop_map(|(at, bit)| Edit::Flip(at, bit)),
        1 => any::<Index>().prop_map(Edit::Cut),
        1 => (any::<Index>(), length.clone()).prop_map(|(at, length)| Edit::Remove(at, length)),
        1 => (any::<Index>(), length.clone(), any::<Index>()).prop_map(|(at, length, to)| Edit::Repeat(at, length, to)),
        2 => (any::<Index>(), number).prop_map(|(at, number)| Edit::Number(at, number)),
        1 => (any::<Index>(), any::<Index>(), length, any::<Index>())
            .prop_map(|(log, at, length, to)| Edit::Foreign(log, at, length, to)),
        1 => (any::<Index>(), prop::collection::vec(any::<u8>(), 1..200)).prop_map(|(at, bytes)| Edit::Insert(at, bytes)),
    ]
}

fn apply(bytes: &mut Vec<u8>, edit: &Edit, golden: &[Vec<u8>]) {
    if bytes.is_empty() {
        return;
    }
    let len = bytes.len();
    match edit {
        Edit::Flip(at, bit) => bytes[at.index(len)] ^= 1 << bit,
        Edit::Cut(at) => bytes.truncate(at.index(len)),
        Edit::Remove(at, length) => {
            let at = at.index(len);
            bytes.drain(at..len.min(at + length));
        }
        Edit::Repeat(at, length, to) => {
            let at = at.index(len);
            let piece = bytes[at..len.min(at + length)].to_vec();
            let to = to.index(len);
            bytes.splice(to..to, piece);
        }
        Edit::Number(at, number) => {
            let at = at.index(len);
            let end = len.min(at + 8);
            bytes[at..end].copy_from_slice(&number.to_le_bytes()[..end - at]);
        }
        Edit::Foreign(log, at, length, to) => {
            let other = &golden[log.index(golden.len())];
            let (at, to) = (at.index(other.len()), to.index(len));
            let piece = &other[at..other.len().min(at + length)];
            bytes.splice(to..len.min(to + piece.len()), piece.iter().copied());
        }
        Edit::Insert(at, piece) => {
            let at = at.index(len);
            bytes.splice(at..at, piece.iter().copied());
        }
    }
}

/// CRC-32 as MCAP has it, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 })
    })
}

/// Makes the checksum of every chunk right, as tools for recovery do with damaged ones.
fn restamp(bytes: &mut [u8]) {
    const CHUNK: u8 = 6;
    let number = |bytes: &[u8], at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
    let mut at = 8;
    while at + 9 <= bytes.len() {
        let (kind, length) = (bytes[at], number(bytes, at + 1));
        let Some(end) = usize::try_from(length).ok().and_then(|length| (at + 9).checked_add(length)) else { return };
        if end > bytes.len() {
            return;
        }
        // Two times, the size, the checksum, an empty name of a compression, the size again.
        let records = at + 9 + 8 + 8 + 8 + 4 + 4 + 8;
        if kind == CHUNK && records <= end {
            let crc = crc32(&bytes[records..end]).to_le_bytes();
            bytes[at + 9 + 24..at + 9 + 28].copy_from_slice(&crc);
        }
        at = end;
    }
}

#[test]
fn fuzz_reader() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("checkpoints/golden");
    let mut names: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    names.sort();
    names.retain(|path| path.extension().is_some_and(|extension| extension == "mcap"));
    let golden: Vec<Vec<u8>> = names.iter().map(|path| std::fs::read(path).unwrap()).collect();
    let logs: Vec<Log> = golden.iter().map(|bytes| Log::from_bytes(bytes.clone()).unwrap()).collect();
    // Golden logs that begin alike are of one run: the longest of them has every state.
    let first = |log: &Log| log.entries().first().map(|entry| entry.record.commit);
    let mut runs: Vec<&Log> = Vec::new();
    for log in &logs {
        match runs.iter_mut().find(|run| first(run) == first(log)) {
            Some(run) if run.entries().len() < log.entries().len() => *run = log,
            Some(_) => {}
            None => runs.push(log),
        }
    }
    let states =
        |run: &Log| -> Vec<State> { (0..run.entries().len()).map(|index| run.state(index).unwrap()).collect() };
    let runs: Vec<(&Log, Vec<State>)> = runs.into_iter().map(|run| (run, states(run))).collect();
    let input = (any::<Index>(), prop::collection::vec(edit(), 1..6), any::<bool>());
    fuzz("reader", "tests/properties/regressions-reader.txt", input, |(log, edits, stamped)| {
        let mut bytes = golden[log.index(golden.len())].clone();
        edits.iter().for_each(|edit| apply(&mut bytes, edit, &golden));
        if stamped {
            restamp(&mut bytes);
        }
        let Ok(log) = Log::from_bytes(bytes) else { return Ok(()) };
        for manifest in log.manifests() {
            prop_assert!(logs.iter().any(|golden| golden.manifests().contains(manifest)), "{:?}", manifest);
        }
        let Some((whole, states)) = runs.iter().find(|(run, _)| first(run) == first(&log)) else {
            prop_assert!(log.entries().is_empty(), "begins like no run: {:?}", first(&log));
            verify_log(&log);
            return Ok(());
        };
        for (index, entry) in log.entries().iter().enumerate() {
            // The wall time is the one thing in which equal runs differ.
            let (found, right) = (&entry.record, &whole.entries()[index].record);
            prop_assert_eq!((&found.report, &found.commit), (&right.report, &right.commit));
            match log.state(index) {
                Ok(state) => prop_assert_eq!(&state, &states[index]),
                // A thinned log has not every state.
                Err(error) => prop_assert!(matches!(error, StateError::NotKept { .. }), "{}", error),
            }
        }
        verify_log(&log);
        Ok(())
    });
}

#[test]
fn fuzz_scene_parser() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("pipelines");
    let files = |folder: &Path| -> Vec<_> {
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_file()).collect()
    };
    let mut names = [files(&folder), files(&folder.join("verification"))].concat();
    names.sort();
    let scenes: Vec<String> = names.iter().map(|path| std::fs::read_to_string(path).unwrap()).collect();
    let piece = prop_oneof![
        "\\PC{0,8}",
        "[\\x00-\\x7f]{0,8}",
        "[-+]?[0-9_.]{1,12}(e[-+]?[0-9]{1,4})?",
        prop::sample::select(vec![
            "[", "]", "[[", "]]", "=", "\"", "'''", "\"\"\"", "\\u{0}", "{", "}", ".", ",", "\r", "inf", "nan"
        ])
        .prop_map(str::to_owned),
    ];
    let setting = prop_oneof![any::<String>(), "[a-z_.]{0,20}=?[-0-9a-z\"\\[\\], ]{0,12}"];
    let edits = prop::collection::vec((any::<Index>(), 0..30_usize, piece), 0..5);
    let input = (any::<Index>(), edits, prop::collection::vec(setting, 0..3));
    fuzz("scene parser", "tests/properties/regressions-scene.txt", input, |(which, edits, settings)| {
        let mut text: Vec<char> = scenes[which.index(scenes.len())].chars().collect();
        for (at, length, piece) in edits {
            let at = at.index(text.len() + 1);
            let end = text.len().min(at + length);
            text.splice(at..end, piece.chars());
        }
        let text: String = text.into_iter().collect();
        match parse_with_settings(&text, "scene.toml", &settings) {
            Ok(scene) => {
                let again = parse_with_settings(&scene.to_toml(), "written.toml", &Vec::<String>::new());
                prop_assert_eq!(again.map_err(|error| TestCaseError::fail(error.plain()))?, scene);
            }
            Err(error) => {
                prop_assert!(error.plain().starts_with("error: ") && !error.summary().is_empty());
                prop_assert!(!error.coloured().is_empty());
            }
        }
        Ok(())
    });
}
