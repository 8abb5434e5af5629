//! What has to be known of a log before some commit to read on from there, or to go on with a run behind it.

use std::fs::File;
use std::io;

use mcap::records::Record as McapRecord;

use super::chunk::Channels;
use super::frame;
use super::ledger::Ledger;
use super::log::Log;
use super::stretch::Stretches;
use crate::state::Hash;

/// A commit in the middle of a log, and what stands before it.
#[derive(Clone, Debug)]
pub(super) struct Checkpoint {
    /// First byte of its chunk.
    pub at: u64,
    /// Its ordinal.
    pub ordinal: u64,
    /// Its chain hash.
    pub chain_hash: Hash,
    /// What the header of the log names as its writer.
    pub library: String,
    /// Channels that are described before it.
    pub channels: Channels,
    /// Stretches up to its own.
    pub stretches: Stretches,
    /// The mesh that its state stands on: hash, place, and the bytes of the message.
    pub mesh: (Hash, u64, Vec<u8>),
    /// The displacements of its state: hash, place, and the bytes of the message.
    pub displacement: (Hash, u64, Vec<u8>),
}

impl Checkpoint {
    /// The last commit of a part of a log that was read, and that is as it was written; `ledger` has all before it.
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
            channels: channels(ledger),
            stretches: log.stretches.up_to(ordinal),
            mesh: piece(&log.meshes, entry.mesh_hash)?,
            displacement: piece(&log.displacements, entry.displacement_hash)?,
        })
    }
}

/// The channels that a ledger has the records of.
pub(super) fn channels(ledger: &Ledger) -> Channels {
    let parsed = ledger.channels.values().filter_map(|record| {
        let found = frame::next(record, 0)?.ok()?;
        match frame::parse(found.opcode, &record[found.body]).ok()? {
            McapRecord::Channel(channel) => Some((channel.id, channel)),
            _ => None,
        }
    });
    parsed.collect()
}

/// Reads a long log in parts, from a checkpoint or from its start, and shows each to `see` with a ledger of all chunks before
/// its last commit; stops at its end, or at the first thing that is not as it was written. Gives back the last part.
pub(super) fn read_in_parts(
    file: &File,
    mut from: Option<Checkpoint>,
    ledger: &mut Ledger,
    mut see: impl FnMut(&Log, &mut Ledger) -> io::Result<()>,
) -> io::Result<Log> {
    let mut at_most = FIRST_PART_BYTES;
    loop {
        let log = Log::read_on(file, from.as_ref(), at_most)?;
        let is_last = log.closed || log.base + log.walked as u64 >= log.file_len;
        if log.entries.len() < 2 && !is_last && at_most < PART_BYTES {
            at_most = PART_BYTES;
            continue;
        }
        at_most = PART_BYTES;
        let last = log.entries.last().map_or(0, |entry| (entry.bytes.start - log.base) as usize);
        ledger.enter(log.base, &log.bytes[..last]);
        see(&log, ledger)?;
        let next = Checkpoint::at_the_end_of(&log, ledger).filter(|next| next.at > log.base);
        match next {
            Some(next) if !is_last && log.is_clean() => from = Some(next),
            _ => return Ok(log),
        }
    }
}

/// Bytes that are read first: behind the mark of an index seldom more are left, and a summary may follow of many times that.
const FIRST_PART_BYTES: usize = 4 << 20;

/// Bytes that are read at once: room for the largest chunk.
const PART_BYTES: usize = 56 << 20;

const _: () = assert!(PART_BYTES > super::format::CHUNK_BYTES_LIMIT + (1 << 20));
