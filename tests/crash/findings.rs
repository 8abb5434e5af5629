//! What `verify` says, word for word.

use foldline::journal::{Log, verify_log};

use crate::support::finished_log;
use crate::synthetic;

/// The findings, one a line. Checksums of chunks are left out, because they cover the clock, and so are places and
/// lengths beyond 999, which depend on the words in the schema of reports.
fn said(bytes: Vec<u8>) -> String {
    let findings = match Log::from_bytes(bytes) {
        Ok(log) => verify_log(&log),
        Err(error) => return error.to_string(),
    };
    let lines = findings.iter().map(|finding| format!("{:?} {}: {}", finding.level, finding.place, finding.text));
    let text = lines.collect::<Vec<_>>().join("\n");
    let pieces = text.split(" (expected ");
    let text: String = pieces.map(|piece| piece.split_once(", got ").map_or(piece, |(_, rest)| &rest[9..])).collect();
    let hide = |word: &str| match word.trim_end_matches([':', ',']) {
        digits if digits.parse::<u64>().is_ok_and(|number| number > 999) => word.replace(digits, "#"),
        _ => word.to_owned(),
    };
    text.split(' ').map(hide).collect::<Vec<_>>().join(" ")
}

#[test]
fn findings_in_words() {
    let bytes = finished_log(&synthetic::run(2, 5));
    let entries: Vec<_> =
        Log::from_bytes(bytes.clone()).unwrap().entries().iter().map(|entry| entry.bytes.clone()).collect();
    let flipped = |place: usize| {
        let mut bytes = bytes.clone();
        bytes[place] ^= 4;
        said(bytes)
    };
    insta::assert_snapshot!(said(bytes.clone()), @"Info log: 5 commits, finished");
    insta::assert_snapshot!(said(bytes[..entries[3].start as usize + 700].to_vec()), @r"
    Warning log: 3 commits; the 700 bytes from byte # on are of one that was cut off
    Warning byte #: the chunk is # bytes long, and the file ends after 691 of them
    ");
    insta::assert_snapshot!(flipped(entries[2].start as usize + 100), @r"
    Error log: 2 commits; # bytes from byte # on are lost, with 2 whole commits
    Error byte #: the chunk cannot be read: Chunk CRC failed
    Warning commit 3 (step 2, evaluate-indicators): whole at byte #, but what it follows on is lost: it is not used
    Warning commit 4 (step 3, solve): whole at byte #, but what it follows on is lost: it is not used
    ");
    insta::assert_snapshot!(flipped(entries[2].start as usize + 2), @r"
    Error log: 2 commits; # bytes from byte # on are lost, with 2 whole commits
    Error byte #: the lengths in the chunk's header do not agree, or it is compressed in a way that foldline does not use
    Warning commit 3 (step 2, evaluate-indicators): whole at byte #, but what it follows on is lost: it is not used
    Warning commit 4 (step 3, solve): whole at byte #, but what it follows on is lost: it is not used
    ");
    insta::assert_snapshot!(flipped(entries[1].end as usize), @r"
    Info log: 5 commits, finished
    Warning byte #: a schema of 22 bytes is where none belongs
    ");
    insta::assert_snapshot!(flipped(150), @r"
    Info log: 5 commits, finished
    Warning byte 64: the manifest's entries do not have the hash that it carries; it is left out
    Error commit 0: the manifest at byte 64 is lost, and with it the scene of stages 0 to 4 (load steps 1 to 3): no other scene takes its place. `foldline run SCENE -o LOG --resume` with that scene's file brings it back
    ");
    insta::assert_snapshot!(flipped(entries[2].start as usize + 9), @r"
    Info log: 5 commits, finished
    Warning byte #: not the byte that would be written here; no state depends on it, but viewers may. `foldline recover` writes the log again
    ");
    insta::assert_snapshot!(flipped(bytes.len() - 30), @r"
    Info log: 5 commits, finished
    Warning byte #: not the byte that would be written here; no state depends on it, but viewers may. `foldline recover` writes the log again
    ");
    insta::assert_snapshot!(said(bytes[..20].to_vec()), @"the log has 20 bytes and no header to read: no stage is in it. Delete it and start the run again");
    insta::assert_snapshot!(said(b"# a scene, not a log".to_vec()), @"this is not a log: it does not begin like an MCAP file, and no commit of a run is in it");
}

/// Two places of damage are two findings, and a commit between them is named.
#[test]
fn all_findings_and_not_only_the_first() {
    let mut bytes = finished_log(&synthetic::run(2, 8));
    let entries: Vec<_> =
        Log::from_bytes(bytes.clone()).unwrap().entries().iter().map(|entry| entry.bytes.clone()).collect();
    for index in [2, 5] {
        bytes[entries[index].start as usize + 120] ^= 1;
    }
    insta::assert_snapshot!(said(bytes), @r"
    Error log: 2 commits; # bytes from byte # on are lost, with 4 whole commits
    Error byte #: the chunk cannot be read: Chunk CRC failed
    Error byte #: the chunk cannot be read: Chunk CRC failed
    Warning commit 3 (step 2, evaluate-indicators): whole at byte #, but what it follows on is lost: it is not used
    Warning commit 4 (step 3, solve): whole at byte #, but what it follows on is lost: it is not used
    Warning commit 6 (step 3, refine-knots): whole at byte #, but what it follows on is lost: it is not used
    Warning commit 7 (step 3, project-displacements): whole at byte #, but what it follows on is lost: it is not used
    ");
}
