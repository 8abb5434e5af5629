//! A log cut at every byte.

use foldline::journal::{Completeness, Log, ReadError};

use crate::support::{assert_prefix, finished_log};
use crate::synthetic;

/// Every prefix of a log is read to the last commit that it wholly holds, or refused where not even a header is left.
#[test]
fn every_cut_keeps_the_commits_before_it() {
    let run = synthetic::run(2, 9);
    let bytes = finished_log(&run);
    let whole = Log::from_bytes(bytes.clone()).unwrap();
    assert_eq!(whole.completeness(), Completeness::Finished);
    assert_eq!(whole.entries().len(), run.len());
    let ends: Vec<u64> = whole.entries().iter().map(|entry| entry.bytes.end).collect();
    let mut finished = 0;
    for length in 0..=bytes.len() {
        let whole_commits = ends.iter().filter(|end| **end <= length as u64).count();
        match Log::from_bytes(bytes[..length].to_vec()) {
            Err(ReadError::TooShort { bytes }) => assert!(bytes == length as u64 && length < 100),
            Err(error) => panic!("cut at {length}: {error}"),
            Ok(log) => {
                assert_eq!(log.entries().len(), whole_commits, "cut at {length}");
                assert!(log.good_end() <= length as u64);
                match log.completeness() {
                    Completeness::Finished => finished += 1,
                    Completeness::Unfinished => {}
                    Completeness::Truncated { at, dropped } => assert_eq!(at + dropped, length as u64),
                    damaged => panic!("cut at {length}: {damaged:?}"),
                }
                if length % 97 == 0 {
                    assert_prefix(&log, &run);
                }
            }
        }
    }
    assert!(finished > 0);
}

/// What follows a cut can be anything that was in the blocks before.
#[test]
fn garbage_behind_a_cut_is_not_taken_for_commits() {
    let run = synthetic::run(3, 6);
    let bytes = finished_log(&run);
    let ends: Vec<u64> =
        Log::from_bytes(bytes.clone()).unwrap().entries().iter().map(|entry| entry.bytes.end).collect();
    for (tail, kind) in [(vec![0_u8; 4096], "zeros"), (vec![0xFF; 4096], "ones"), (bytes[500..4500].to_vec(), "old")] {
        for length in (ends[2] as usize..ends[3] as usize).step_by(13) {
            let mut cut = bytes[..length].to_vec();
            cut.extend_from_slice(&tail);
            let log = Log::from_bytes(cut).unwrap();
            assert_eq!(log.entries().len(), 3, "{kind} behind a cut at {length}");
            assert_prefix(&log, &run);
        }
    }
}
