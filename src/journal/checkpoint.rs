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
    /// The mesh that its state stands on; not there where that was thinned out.
    pub mesh: Option<StoredPiece>,
    /// The displacements of its state; not there where those were thinned out.
    pub displacement: Option<StoredPiece>,
    /// The words that the log was thinned with.
    pub thinned: Option<String>,
    /// The last commit before it that has its state.
    pub kept_before: Option<usize>,
}

/// A mesh or displacements in a log: hash, place, and the bytes of the message.
pub(super) type StoredPiece = (Hash, u64, Vec<u8>);

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
            mesh: piece(&log.meshes, entry.mesh_hash),
            displacement: piece(&log.displacements, entry.displacement_hash),
            thinned: log.thinned.clone(),
            kept_before: log.kept_before(ordinal as usize),
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
/// its last commit; stops at its end, where `ends` says so, or at the first thing that is not as it was written. Gives back the
/// last part.
pub(super) fn read_in_parts(
    file: &File,
    mut from: Option<Checkpoint>,
    ledger: &mut Ledger,
    ends: impl Fn(&Log) -> bool,
    mut see: impl FnMut(&Log, &mut Ledger) -> io::Result<()>,
) -> io::Result<Log> {
    let length = file.metadata()?.len();
    let mut at_most = &[FIRST_PART_BYTES, PART_BYTES][..];
    loop {
        let ends = |log: &Log| log.closed || log.reaches_end() || ends(log);
        let (log, next) = read_part(file, length, from.as_ref(), ledger, at_most, ends)?;
        see(&log, ledger)?;
        match next {
            Some(next) => from = Some(next),
            None => return Ok(log),
        }
        at_most = &[PART_BYTES];
    }
}

/// Reads a part of the first `length` bytes of a log, from a checkpoint or from its start, and enters all chunks before its last
/// commit: so many bytes, or as many more as the next number says where there is no commit in them to go on from. Gives
/// back the checkpoint to go on from too; none where the log ends there, or where something is not as it was written.
pub(super) fn read_part(
    file: &File,
    length: u64,
    from: Option<&Checkpoint>,
    ledger: &mut Ledger,
    at_most: &[usize],
    ends: impl Fn(&Log) -> bool,
) -> io::Result<(Log, Option<Checkpoint>)> {
    let [at_most, more @ ..] = at_most else { return Err(io::ErrorKind::InvalidInput.into()) };
    let log = Log::read_on(file, length, from, *at_most)?;
    let ends_here = ends(&log);
    let last = log.entries.last().map_or(log.base, |entry| entry.bytes.start);
    let goes_on = !ends_here && last > log.base && log.is_clean();
    if !ends_here && !goes_on && !more.is_empty() {
        drop(log);
        return read_part(file, length, from, ledger, more, ends);
    }
    ledger.enter(log.base, &log.bytes[..(last - log.base) as usize]);
    let next = if goes_on { Checkpoint::at_the_end_of(&log, ledger) } else { None };
    Ok((log, next))
}

/// Bytes that are read first: behind the mark of an index seldom more are left, and a summary may follow of many times that.
const FIRST_PART_BYTES: usize = 4 << 20;

/// Bytes that are read at once: room for the largest chunk.
pub(super) const PART_BYTES: usize = 56 << 20;

const _: () = assert!(PART_BYTES > super::format::CHUNK_BYTES_LIMIT + (1 << 20));
