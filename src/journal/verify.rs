//! Everything that can be checked about a log, all of it, not only up to the first flaw.

use std::io;
use std::ops::Range;
use std::path::Path;

use super::agreement::disagreement;
use super::damage::Completeness;
use super::encode_error::EncodeError;
use super::index_keeper::LONG_BYTES;
use super::ledger::Ledger;
use super::log::{Entry, Log};
use super::parts::read_in_parts;
use super::reader::{open_regular, read_at};
use super::rewriting::Rewriting;
use crate::units::count;

/// The severity of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Information that needs no action.
    Info,
    /// Costs no state, and yet is not as it should be.
    Warning,
    /// A state or a commit is lost or cannot be trusted.
    Error,
}

/// One result of checking a log.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Finding {
    /// Severity of the finding.
    pub level: Level,
    /// What it is about: the log, a byte, or a commit.
    pub place: String,
    /// The finding in words.
    pub text: String,
}

/// Checks a log: framing, checksums, seals, the hash of every message, the chain, the content hash and soundness of
/// every state and mesh, reports against their states, manifests, completeness, and that the bytes between are those that the writer would write.
///
/// A long log is checked part by part; one that is damaged before its end is read whole.
pub fn verify(path: &Path) -> Vec<Finding> {
    if let Ok(Some(findings)) = verify_in_parts(path) {
        return findings;
    }
    match Log::read(path) {
        Ok(log) => verify_log(&log),
        Err(error) => {
            vec![finding(Level::Error, "log", with_causes(&error))]
        }
    }
}

/// Checks a long log without holding it in memory; `None` for one that has to be read whole.
fn verify_in_parts(path: &Path) -> io::Result<Option<Vec<Finding>>> {
    let file = open_regular(path)?;
    if file.metadata()?.len() < LONG_BYTES {
        return Ok(None);
    }
    let theirs = |at: u64, length: usize| {
        let mut bytes = Vec::new();
        // What cannot be read differs.
        let _ = read_at(&file, at, length, &mut bytes);
        bytes
    };
    let mut ledger = Ledger::default();
    let (mut found, mut kept) = (Vec::new(), 0);
    let mut rewriting: Option<Result<Rewriting<_>, _>> = None;
    let tail = read_in_parts(&file, None, &mut ledger, |part, _| {
        let last = part.entries.len().saturating_sub(1);
        // The last commit of a part is the first of the next.
        found.extend(states(part, 0..last));
        kept += kept_in(&part.entries[..last]);
        let written = rewriting.take().unwrap_or_else(|| Rewriting::new(&part.library, &theirs));
        rewriting = Some(written.and_then(|mut written| {
            let end = part.entries.last().map_or(0, |entry| (entry.bytes.start - part.base) as usize);
            written.write(part, end).map(|()| written)
        }));
        Ok(())
    })?;
    if tail.entries.is_empty() || !(tail.closed || tail.reaches_end()) || !tail.is_clean() {
        return Ok(None);
    }
    let mut findings = of_the_whole(&tail);
    findings.extend(states_kept(&tail, kept + kept_in(&tail.entries[tail.entries.len() - 1..])));
    findings.extend(found);
    findings.extend(states(&tail, tail.entries.len() - 1..tail.entries.len()));
    if let (true, Some(rewriting)) = (tail.problems().is_empty(), rewriting) {
        let last = tail.entries.last().map_or(0, |entry| (entry.bytes.start - tail.base) as usize);
        let rest = tail.parts.iter().filter(|place| place.at >= last).copied().collect();
        let rest = Log { parts: rest, ..tail };
        let outcome = rewriting.and_then(|mut rewriting| {
            rewriting.write(&rest, usize::MAX)?;
            Ok(rewriting.end(&rest).map(other_byte))
        });
        findings.extend(outcome.unwrap_or_else(|error| Some(not_written(&error))));
    }
    Ok(Some(findings))
}

/// Checks a log that was read before; see [`verify`].
pub fn verify_log(log: &Log) -> Vec<Finding> {
    let mut findings = of_the_whole(log);
    findings.extend(states_kept(log, kept_in(log.entries())));
    findings.extend(states(log, 0..log.entries().len()));
    findings.extend(bytes_between(log));
    findings
}

/// What is found of a log without looking into its states.
fn of_the_whole(log: &Log) -> Vec<Finding> {
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
    let missed: Vec<_> = log.missed_manifests().collect();
    for lost in log.lost_manifests() {
        let (level, text) = match missed.contains(&lost) {
            true => (Level::Error, log.lost_in_words(lost)),
            false => {
                let at = lost.at;
                let text = format!(
                    "the manifest at byte {at} is lost; a scene that was given again behind it makes the same states"
                );
                (Level::Info, text)
            }
        };
        findings.push(finding(level, format!("commit {}", lost.ordinal), text));
    }
    findings.extend(manifests(log));
    findings
}

/// Decodes the states of some entries, and holds their reports against them.
fn states(log: &Log, entries: Range<usize>) -> Vec<Finding> {
    let kept = entries.filter(|entry| log.keeps_state(log.first() + entry));
    let checked = kept.filter_map(|index| {
        let entry = &log.entries()[index];
        let text = match log.state(log.first() + index) {
            Ok(state) => disagreement(&entry.record.report, &state)?.to_string(),
            Err(error) => with_causes(&error),
        };
        Some(finding(Level::Error, place(entry), text))
    });
    checked.collect()
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
    let commits = count(log.commits(), "commit");
    let (level, text) = match log.completeness() {
        Completeness::Finished => (Level::Info, format!("{commits}, finished")),
        Completeness::Unfinished => (Level::Info, format!("{commits}, not finished")),
        Completeness::Truncated { at, dropped } => {
            let text = format!("{commits}; the {dropped} bytes from byte {at} on are of one that was cut off");
            (Level::Warning, text)
        }
        Completeness::Damaged { at, dropped, later_commits } => {
            let text = format!(
                "{commits}; {dropped} bytes from byte {at} on are lost, with {}",
                count(later_commits as usize, "whole commit")
            );
            (Level::Error, text)
        }
    };
    finding(level, "log", text)
}

/// How many entries have their state.
fn kept_in(entries: &[Entry]) -> usize {
    entries.iter().filter(|entry| entry.state.is_some()).count()
}

/// That a log has no more than so many states: as it was meant, or not.
fn states_kept(log: &Log, states: usize) -> Option<Finding> {
    let all = log.commits();
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
    }
    for (ordinal, differences) in log.scene_changes() {
        findings.extend(differences.iter().map(|difference| {
            let [was, is] = difference.values();
            let text = format!("from here on {} is {is}, and was {was}", difference.path);
            finding(Level::Info, format!("commit {ordinal}"), text)
        }));
    }
    findings
}

fn bytes_between(log: &Log) -> Option<Finding> {
    if !log.problems().is_empty() || !log.notes().is_empty() {
        return None;
    }
    let theirs = |at: u64, length: usize| {
        let from = usize::try_from(at).unwrap_or(usize::MAX);
        let rest = log.bytes.get(from..).unwrap_or_default();
        rest[..length.min(rest.len())].to_vec()
    };
    let written = Rewriting::new(&log.library, theirs).and_then(|mut rewriting| {
        rewriting.write(log, usize::MAX)?;
        Ok(rewriting.end(log))
    });
    written.map_or_else(|error| Some(not_written(&error)), |differs| differs.map(other_byte))
}

fn not_written(error: &EncodeError) -> Finding {
    finding(Level::Warning, "log", format!("it cannot be written again: {error}"))
}

fn other_byte(at: u64) -> Finding {
    let text = "not the byte that would be written here; no state depends on it, but viewers may. \
                `foldline recover` writes the log again";
    finding(Level::Warning, format!("byte {at}"), text)
}
