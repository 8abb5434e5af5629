//! Everything that can be checked about a log, all of it, not only up to the first flaw.

use std::path::Path;

use super::damage::Completeness;
use super::encoder::{EncodeError, Encoder};
use super::log::{Entry, Log};
use super::recovery::again;

/// How much a finding matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Good to know.
    Info,
    /// Costs no state, and yet is not as it should be.
    Warning,
    /// A state or a commit is lost or cannot be trusted.
    Error,
}

/// Something that was found out about a log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// How much it matters.
    pub level: Level,
    /// What it is about: the log, a byte, or a commit.
    pub place: String,
    /// What it is.
    pub text: String,
}

/// Checks a log: framing, checksums, seals, the hash of every message, the chain, the content hash and soundness of
/// every state and mesh, manifests, completeness, and that the bytes between are those that the writer would write.
pub fn verify(path: &Path) -> Vec<Finding> {
    match Log::read(path) {
        Ok(log) => verify_log(&log),
        Err(error) => {
            vec![finding(Level::Error, "log", with_causes(&error))]
        }
    }
}

/// Checks a log that was read; see [`verify`].
pub fn verify_log(log: &Log) -> Vec<Finding> {
    let mut findings = vec![completeness(log)];
    for problem in log.problems() {
        // What the chain reaches across costs no commit, nor does anything behind the record of the end.
        // What a cut costs is the stage that was in flight.
        let costly = problem.at >= log.good_end() && matches!(log.completeness(), Completeness::Damaged { .. });
        let level = if costly { Level::Error } else { Level::Warning };
        findings.push(finding(level, format!("byte {}", problem.at), problem.damage.to_string()));
    }
    for note in log.notes() {
        findings.push(finding(Level::Warning, format!("byte {}", note.at), note.text.clone()));
    }
    for commit in log.later_commits() {
        let place = format!("commit {} (step {}, {})", commit.ordinal, commit.step, commit.stage);
        let text = format!("whole at byte {}, but what it follows on is lost: it is not used", commit.at);
        findings.push(finding(Level::Warning, place, text));
    }
    for lost in log.lost_manifests() {
        let way_out = "`foldline run SCENE -o LOG --resume` goes on with the scene's file";
        findings.push(finding(Level::Error, format!("commit {}", lost.ordinal), format!("{lost}. {way_out}")));
    }
    findings.extend(manifests(log));
    findings.extend(states_kept(log));
    for index in (0..log.entries().len()).filter(|index| log.keeps_state(*index)) {
        if let Err(error) = log.state(index) {
            findings.push(finding(Level::Error, place(&log.entries()[index]), with_causes(&error)));
        }
    }
    findings.extend(bytes_between(log));
    findings
}

fn finding(level: Level, place: impl Into<String>, text: impl Into<String>) -> Finding {
    Finding { level, place: place.into(), text: text.into() }
}

/// An error and what is below it, in one line.
fn with_causes(error: &dyn std::error::Error) -> String {
    match error.source() {
        Some(cause) => format!("{error}: {}", with_causes(cause)),
        None => error.to_string(),
    }
}

fn place(entry: &Entry) -> String {
    let commit = &entry.record.commit;
    format!("commit {} (step {}, {})", commit.ordinal, commit.step, commit.stage)
}

fn completeness(log: &Log) -> Finding {
    let commits = log.entries().len();
    let (level, text) = match log.completeness() {
        Completeness::Finished => (Level::Info, format!("{commits} commits, finished")),
        Completeness::Unfinished => (Level::Info, format!("{commits} commits, not finished")),
        Completeness::Truncated { at, dropped } => {
            let text = format!("{commits} commits; the {dropped} bytes from byte {at} on are of one that was cut off");
            (Level::Warning, text)
        }
        Completeness::Damaged { at, dropped, later_commits } => {
            let text = format!(
                "{commits} commits; {dropped} bytes from byte {at} on are lost, with {later_commits} whole commits"
            );
            (Level::Error, text)
        }
    };
    finding(level, "log", text)
}

/// That states are missing: as it was meant, or not.
fn states_kept(log: &Log) -> Option<Finding> {
    let all = log.entries().len();
    let states = (0..all).filter(|index| log.keeps_state(*index)).count();
    match log.thinned() {
        Some(kept) => {
            Some(finding(Level::Info, "log", format!("thinned ({kept}): {states} of {all} stages have their state")))
        }
        None if states < all => {
            let text = format!("{} of {all} stages have no state, and the log was not thinned", all - states);
            Some(finding(Level::Error, "log", text))
        }
        None => None,
    }
}

fn manifests(log: &Log) -> Vec<Finding> {
    let mut findings = Vec::new();
    let manifests = log.manifests();
    let is_lost = log.lost_manifests().first().is_some_and(|lost| lost.ordinal == 0);
    if manifests.first().is_none_or(|first| first.first_ordinal != 0) && !is_lost {
        let text = "no manifest of the beginning: the scene has to come from its file".to_owned();
        findings.push(finding(Level::Warning, "log", text));
    }
    for pair in manifests.windows(2) {
        let place = format!("commit {}", pair[1].first_ordinal);
        if let Some(otherwise) = pair[1].rounds_otherwise(&pair[0]) {
            findings.push(finding(Level::Info, place.clone(), format!("from here on {otherwise}: bits may differ")));
        }
        if !pair[0].same_machine(&pair[1]) {
            let text = format!("from here on computed on another machine: {} after {}", pair[1].host, pair[0].host);
            findings.push(finding(Level::Info, place.clone(), text));
        }
        if pair[0].scene_text != pair[1].scene_text {
            findings.push(finding(Level::Info, place, "from here on the scene reads differently"));
        }
    }
    findings
}

/// Writes the log again and compares: a byte that no hash covers (a time, an index, the summary) shows here.
fn bytes_between(log: &Log) -> Option<Finding> {
    if !log.problems().is_empty() || !log.notes().is_empty() {
        return None;
    }
    let mut written = 0;
    let mut differs = None;
    let mut compare = |ours: &[u8]| {
        let theirs = log.bytes.get(written..).unwrap_or_default();
        let same = ours.iter().zip(theirs).take_while(|(ours, theirs)| ours == theirs).count();
        if same < ours.len() && differs.is_none() {
            differs = Some(written + same);
        }
        written += ours.len();
    };
    let outcome = write_again(log, &mut compare);
    if let Err(error) = outcome {
        return Some(finding(Level::Warning, "log", format!("it cannot be written again: {error}")));
    }
    let at = differs.or((written < log.bytes.len()).then_some(written))?;
    let text = "not the byte that would be written here; no state depends on it, but viewers may. \
                `foldline recover` writes the log anew";
    Some(finding(Level::Warning, format!("byte {at}"), text))
}

/// Length of the record in front of the summary, with the nine bytes before it.
const DATA_END_LEN: usize = 9 + 4;

fn write_again(log: &Log, compare: &mut impl FnMut(&[u8])) -> Result<(), EncodeError> {
    let mut encoder = Encoder::new(&log.library)?;
    again(log, None, &mut encoder, |bytes| {
        compare(&bytes);
        Ok::<(), EncodeError>(())
    })?;
    if log.closed {
        let checksum = log.bytes.get(log.good_end.saturating_sub(4)..log.good_end).unwrap_or_default();
        let is_there = checksum.iter().any(|byte| *byte != 0);
        let before = log.good_end.saturating_sub(DATA_END_LEN);
        let checksum = if is_there { crc32fast::hash(&log.bytes[..before]) } else { 0 };
        encoder.close_with_checksum(log.commits() as u64, checksum, |piece| {
            compare(&piece);
            Ok::<(), EncodeError>(())
        })?;
    }
    Ok(())
}
