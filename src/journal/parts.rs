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
pub(super) const PART_BYTES: usize = 56 << 20;

const _: () = assert!(PART_BYTES > CHUNK_BYTES_LIMIT + (1 << 20));

/// Reads a long log in parts, from a checkpoint or from its start, and shows each to `see` with a ledger of all chunks before
/// its last commit; stops at its end, or at the first thing that is not as it was written. Gives back the last part.
pub(super) fn read_in_parts(
    file: &File,
    mut from: Option<Checkpoint>,
    ledger: &mut Ledger,
    mut see: impl FnMut(&Log, &mut Ledger) -> io::Result<()>,
) -> io::Result<Log> {
    let length = file.metadata()?.len();
    let mut at_most = &[FIRST_PART_BYTES, PART_BYTES][..];
    loop {
        let ends = |log: &Log| log.closed || log.reaches_end();
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
/// commit: so many bytes, or as many more as the next number gives where there is no commit in them to continue from. Gives
/// back the checkpoint to continue from too; none where the log ends there, or where something is not as it was written.
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
    let continues = !ends_here && last > log.base && log.is_clean();
    if !ends_here && !continues && !more.is_empty() {
        drop(log);
        return read_part(file, length, from, ledger, more, ends);
    }
    ledger.enter(log.base, &log.bytes[..(last - log.base) as usize]);
    let next = if continues { Checkpoint::at_the_end_of(&log, ledger) } else { None };
    Ok((log, next))
}
