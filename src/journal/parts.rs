//! A long log, read in parts.

use std::fs::File;
use std::io;

use super::checkpoint::Checkpoint;
use super::format::CHUNK_BYTES_LIMIT;
use super::ledger::Ledger;
use super::log::Log;

/// Bytes that are read first: behind the mark of an index seldom more are left, and a summary may follow of many times that.
const FIRST_PART_BYTES: usize = 4 << 20;

/// Bytes that are read at once: room for the largest chunk.
const PART_BYTES: usize = 56 << 20;

const _: () = assert!(PART_BYTES > CHUNK_BYTES_LIMIT + (1 << 20));

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
