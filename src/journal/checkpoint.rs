//! What has to be known of a log before some commit to read on from there, or to continue a run behind it.

use super::chunk::Channels;
use super::ledger::Ledger;
use super::log::Log;
use super::stretch::Stretches;
use crate::state::Hash;

/// A commit in the middle of a log, and what precedes it.
#[derive(Clone, Debug)]
pub(super) struct Checkpoint {
    /// First byte of its chunk.
    pub at: u64,
    /// Ordinal of the commit.
    pub ordinal: u64,
    /// Chain hash of the commit.
    pub chain_hash: Hash,
    /// What the header of the log names as its writer.
    pub library: String,
    /// Channels that are described before it.
    pub channels: Channels,
    /// Stretches up to its own.
    pub stretches: Stretches,
    /// The mesh of its state; not there where that was thinned out.
    pub mesh: Option<StoredPiece>,
    /// The fields of its state; not there where they were thinned out.
    pub fields: Vec<StoredPiece>,
    /// The words that the log was thinned with.
    pub thinned: Option<String>,
    /// The last commit before it that has its state.
    pub kept_before: Option<usize>,
}

/// A mesh or a field in a log: hash, place, and the bytes of the message.
pub(super) type StoredPiece = (Hash, u64, Vec<u8>);

impl Checkpoint {
    /// The checkpoint at the last commit of a part of a log, if nothing in the part is damaged; `ledger` describes all
    /// before it.
    pub fn at_the_end_of(log: &Log, ledger: &Ledger) -> Option<Self> {
        let entry = log.entries.last()?;
        let piece = |places: &std::collections::HashMap<Hash, std::ops::Range<usize>>, hash| {
            let place = places.get(&hash)?;
            Some((hash, log.place_of(place)?, log.bytes.get(place.clone())?.to_vec()))
        };
        let ordinal = entry.record.commit.ordinal;
        Some(Self {
            at: entry.bytes.start,
            ordinal,
            chain_hash: entry.record.commit.chain_hash,
            library: log.library.clone(),
            channels: ledger.channels_described(),
            stretches: log.stretches.up_to(ordinal),
            mesh: piece(&log.meshes, entry.mesh_hash),
            fields: entry.fields.iter().filter_map(|hash| piece(&log.fields, *hash)).collect(),
            thinned: log.thinned.clone(),
            kept_before: log.kept_before(ordinal as usize),
        })
    }
}
