//! A log without the states between some load steps: every commit and every report stays, and with them the chain.
//!
//! A commit names its messages by their hashes, and continues naming those that are left out. So a thinned chunk lacks a state,
//! and a mesh or fields that no kept state uses, and nothing else; its commit, sealed as ever, names what the state
//! hashed to. A metadata record in front marks this as intended, so that a state which is lost otherwise is distinguished from one that
//! was dropped.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::Path;

use super::format::THINNED;
use super::log::{Kept, Log};
use super::new_log::{NewLog, NewLogError};
use super::portions::{Portion, Portions};
use super::reader::ReadError;
use crate::state::Hash;

/// The outcome of thinning a log.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Thinned {
    /// Stages in the new log: all.
    pub commits: usize,
    /// Those that have their state.
    pub states: usize,
    /// Load steps of the log.
    pub all_steps: BTreeSet<u64>,
    /// Load steps whose last state is kept.
    pub steps: BTreeSet<u64>,
    /// Length of the log and of the new one, bytes.
    pub bytes: [u64; 2],
}

/// Why a log cannot be thinned.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ThinError {
    /// The log cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// It is damaged or torn.
    #[error("it is not whole ({why}), and a thinned log would hide that: `foldline recover` first")]
    NotWhole {
        /// What is wrong with it.
        why: String,
    },
    /// The scene of some stages is lost.
    #[error("states of stages without a scene could not be made again once they are dropped: {lost}")]
    SceneLost {
        /// Which manifest, and the way out.
        lost: String,
    },
    /// Something has written over it meanwhile.
    #[error("it was changed while it was read, and nothing was written: thin it again when nothing else writes to it")]
    Changed,
    /// The new log cannot be made.
    #[error(transparent)]
    New(#[from] NewLogError),
}

/// Copies a log to a new one that holds only the states that end load steps for which `keeps` is true, and the last
/// state; `kept_as` describes them in words. The new log is written whole or not at all.
///
/// # Errors
/// Where the log cannot be read or is damaged, or the new one exists or cannot be written.
pub fn thin(path: &Path, new: &Path, kept_as: &str, keeps: impl Fn(u64) -> bool) -> Result<Thinned, ThinError> {
    let mut portions = Portions::of(path)?;
    let (mut needed, mut states, mut steps, mut all_steps) = (HashSet::new(), 0, BTreeSet::new(), BTreeSet::new());
    let log = loop {
        let portion = portions.read()?;
        for (place, entry) in portion.entries().iter().enumerate() {
            let step = entry.record.report.step;
            all_steps.insert(step);
            if keeps_state(portion.log(), place, &keeps) {
                needed.insert(entry.mesh_hash);
                needed.extend(&entry.fields);
                steps.insert(step);
                states += 1;
            }
        }
        if let Some(log) = portion.into_end() {
            break log;
        }
    };
    let unused = log.unused_manifest().map(|note| note.text.clone());
    if let Some(why) = log.problems().first().map(ToString::to_string).or(unused) {
        return Err(ThinError::NotWhole { why });
    }
    if let Some(lost) = log.missed_manifests().next() {
        return Err(ThinError::SceneLost { lost: log.lost_in_words(lost) });
    }
    let mut thinned = NewLog::begin(new, &log.library)?;
    let (commits, last) = (log.commits(), log.last_commit().copied());
    drop(log);

    let mut is_marked = false;
    loop {
        let portion = portions.read()?;
        let dropped = dropped_messages(&portion, &needed, &keeps);
        for part in portion.parts() {
            thinned.add(portion.log(), part, |data| !dropped.contains(&data))?;
            if part.kept == Kept::Manifest && !is_marked {
                thinned.metadata(&marker(kept_as))?;
                is_marked = true;
            }
        }
        let Some(log) = portion.into_end() else { continue };
        if log.last_commit().copied() != last || !log.problems().is_empty() {
            return Err(ThinError::Changed);
        }
        let bytes = [log.file_len(), thinned.finish(commits)?];
        return Ok(Thinned { commits, states, all_steps, steps, bytes });
    }
}

fn marker(kept_as: &str) -> mcap::records::Metadata {
    let metadata = BTreeMap::from([("kept".to_owned(), kept_as.to_owned())]);
    mcap::records::Metadata { name: THINNED.to_owned(), metadata }
}

/// Whether the state of an entry stays: of those that have one, that of the last stage of every step that is kept, and the last
/// of all.
fn keeps_state(log: &Log, place: usize, keeps: impl Fn(u64) -> bool) -> bool {
    let step = |place: usize| log.entries.get(place).map(|entry| entry.record.report.step);
    let ends_step = step(place) != step(place + 1);
    let is_last = place + 1 == log.entries.len();
    log.entries[place].state.is_some() && ends_step && (is_last || step(place).is_some_and(keeps))
}

/// First bytes of the messages of a portion that go: states, and meshes and fields that no kept state uses.
fn dropped_messages(portion: &Portion, needed: &HashSet<Hash>, keeps: impl Fn(u64) -> bool) -> HashSet<usize> {
    let log = portion.log();
    let go = (0..portion.entries().len()).filter(|place| !keeps_state(log, *place, &keeps));
    let states = go.filter_map(|place| log.entries[place].state.as_ref()).map(|state| state.start);
    let messages = log.meshes.iter().chain(&log.fields);
    let unneeded = messages.filter(|(hash, _)| !needed.contains(*hash)).map(|(_, message)| message.start);
    states.chain(unneeded).collect()
}
