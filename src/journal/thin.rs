//! A log without the states between some load steps: every commit and every report stays, and with them the chain.
//!
//! A commit names its messages by their hashes, and goes on naming those that are left out. So a thinned chunk lacks a state,
//! and a mesh or displacements that no kept state stands on, and nothing else; its commit, sealed as ever, says what the state
//! hashed to. A metadata record in front says that this was meant, so that a state which is lost otherwise is told from one that
//! was dropped.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::io;
use std::path::Path;

use super::encode_error::EncodeError;
use super::encoder::Encoder;
use super::format::THINNED;
use super::frame;
use super::log::{Kept, Log};
use super::reader::ReadError;
use super::stretch::LostManifest;
use crate::state::Hash;
use crate::whole_file::WholeFile;

/// What became of a log that was thinned.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Thinned {
    /// Stages in the new log: all.
    pub commits: usize,
    /// Those that have their state.
    pub states: usize,
    /// Load steps whose last state is kept.
    pub steps: BTreeSet<u64>,
    /// The last load step of the log.
    pub last_step: u64,
    /// Length of the log and of the new one, bytes.
    pub bytes: [u64; 2],
}

/// Why a log cannot be thinned.
#[derive(Debug, thiserror::Error)]
pub enum ThinError {
    /// It cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// It is damaged or torn.
    #[error("it is not whole ({why}), and a thinned log would hide that: `foldline recover` first")]
    NotWhole {
        /// What is wrong with it.
        why: String,
    },
    /// The scene of some stages is lost.
    #[error(
        "{lost}, and states of these stages that are dropped could not be made again: `foldline run SCENE -o {log} --resume` with the \
         scene's file brings it back"
    )]
    SceneLost {
        /// The log.
        log: String,
        /// Its manifest.
        lost: LostManifest,
    },
    /// There is a file where the new log should go.
    #[error("{new} exists and is not overwritten: choose another name")]
    Exists {
        /// The new log.
        new: String,
    },
    /// The new log cannot be written.
    #[error("cannot write {new}; the log itself is as it was")]
    Write {
        /// The new log.
        new: String,
        /// What the system says.
        #[source]
        source: io::Error,
    },
    /// MCAP refused a record of the log.
    #[error("the log cannot be written anew")]
    Encode(#[from] EncodeError),
}

/// Writes a log anew with the states that end the load steps which `keeps` takes, and the last one; `kept_as` says in words
/// which. The new log is whole or not there.
///
/// # Errors
/// Where the log cannot be read or is damaged, or the new one exists or cannot be written.
pub fn thin(path: &Path, new: &Path, kept_as: &str, keeps: impl Fn(u64) -> bool) -> Result<Thinned, ThinError> {
    let log = Log::read(path)?;
    let unused = log.unused_manifest().map(|note| note.text.clone());
    if let Some(why) = log.problems().first().map(ToString::to_string).or(unused) {
        return Err(ThinError::NotWhole { why });
    }
    if let Some(lost) = log.missed_manifests().next() {
        return Err(ThinError::SceneLost { log: path.display().to_string(), lost: *lost });
    }
    let name = new.display().to_string();
    let failed = |source: io::Error| match source.kind() {
        io::ErrorKind::AlreadyExists => ThinError::Exists { new: name.clone() },
        _ => ThinError::Write { new: name.clone(), source },
    };
    if new.symlink_metadata().is_ok() {
        return Err(failed(io::ErrorKind::AlreadyExists.into()));
    }
    let kept = kept_states(&log, keeps);
    let dropped = dropped_messages(&log, &kept);
    let whole = WholeFile::beside(new).map_err(failed)?;
    let emit = |bytes: Vec<u8>| io::Write::write_all(&mut whole.file(), &bytes);

    let mut encoder = Encoder::new(&log.library).map_err(EncodeError::Mcap)?;
    let mut is_marked = false;
    for part in &log.parts {
        let Some(Ok(record)) = frame::next(&log.bytes, part.at) else { continue };
        encoder.again_if(&log.bytes, &record, |data| !dropped.contains(&data)).map_err(EncodeError::Mcap)?;
        if part.kept == Kept::Manifest && !is_marked {
            encoder.metadata(&marker(kept_as)).map_err(EncodeError::Mcap)?;
            is_marked = true;
        }
        emit(encoder.take()).map_err(failed)?;
    }
    encoder.close(log.commits() as u64, emit).map_err(failed)?;
    let length = whole.file().metadata().map_err(failed)?.len();
    whole.keep_as(new).map_err(failed)?;
    let step = |index: &usize| log.entries()[*index].record.report.step;
    let (steps, last_step) =
        (kept.iter().map(step).collect(), log.entries().len().checked_sub(1).as_ref().map_or(0, step));
    Ok(Thinned { commits: log.commits(), states: kept.len(), steps, last_step, bytes: [log.file_len(), length] })
}

fn marker(kept_as: &str) -> mcap::records::Metadata {
    let metadata = BTreeMap::from([("kept".to_owned(), kept_as.to_owned())]);
    mcap::records::Metadata { name: THINNED.to_owned(), metadata }
}

/// Stages whose states stay: of those that have one, the last stage of every step that is kept, and the last of all.
fn kept_states(log: &Log, keeps: impl Fn(u64) -> bool) -> HashSet<usize> {
    let entries = log.entries();
    let step = |index: usize| entries[index].record.report.step;
    let last = entries.len().saturating_sub(1);
    let ends_step = |index: usize| index == last || step(index + 1) != step(index);
    (0..entries.len())
        .filter(|index| log.keeps_state(*index) && ends_step(*index) && (*index == last || keeps(step(*index))))
        .collect()
}

/// First bytes of the messages that go.
fn dropped_messages(log: &Log, kept: &HashSet<usize>) -> HashSet<usize> {
    let mut needed: HashSet<Hash> = HashSet::new();
    let mut dropped = HashSet::new();
    for (index, entry) in log.entries().iter().enumerate() {
        match kept.contains(&index) {
            true => needed.extend([entry.mesh_hash, entry.displacement_hash]),
            false => dropped.extend(entry.state.as_ref().map(|place| place.start)),
        }
    }
    let messages = log.meshes.iter().chain(&log.displacements);
    dropped.extend(messages.filter(|(hash, _)| !needed.contains(*hash)).map(|(_, place)| place.start));
    dropped
}
