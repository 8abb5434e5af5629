//! The outermost layer of MCAP, walked on bytes in memory: one byte for the kind of a record, eight for how
//! long, then the record. Allocates nothing, whatever the lengths claim.

use std::fmt;
use std::ops::Range;

pub(super) use mcap::records::op;

use super::format::MANIFEST;

/// Bytes in front of a record.
pub(super) const PREFIX_LEN: usize = 1 + 8;

/// One record where it lies.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    /// First byte, that of the prefix.
    pub at: usize,
    /// Opcode of the record: its kind.
    pub opcode: u8,
    /// The record without its prefix.
    pub body: Range<usize>,
}

/// A record that continues beyond the bytes there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cut {
    /// What the record is and the length that it states, where that much is left.
    pub claim: Option<(u8, u64)>,
    /// Bytes that are left, with the prefix.
    pub left: usize,
}

/// The record at `at`; `None` at the end.
pub(super) fn next(bytes: &[u8], at: usize) -> Option<Result<Frame, Cut>> {
    let rest = bytes.get(at..).filter(|rest| !rest.is_empty())?;
    let left = rest.len();
    let Some(([opcode], rest)) = rest.split_first_chunk::<1>() else { return Some(Err(Cut { claim: None, left })) };
    let Some((length, rest)) = rest.split_first_chunk::<8>() else { return Some(Err(Cut { claim: None, left })) };
    let length = u64::from_le_bytes(*length);
    let start = at + PREFIX_LEN;
    Some(match usize::try_from(length) {
        Ok(len) if len <= rest.len() => Ok(Frame { at, opcode: *opcode, body: start..start + len }),
        _ => Err(Cut { claim: Some((*opcode, length)), left }),
    })
}

/// Chunk header of an uncompressed chunk: two times, size, checksum, an empty name, size.
pub(super) const CHUNK_HEADER_LEN: usize = 8 + 8 + 8 + 4 + 4 + 8;

/// Where the records of an uncompressed chunk lie, if the lengths in its header agree with its own.
pub(super) fn chunk_records(bytes: &[u8], frame: &Frame) -> Option<Range<usize>> {
    let header = bytes.get(frame.body.clone())?.get(..CHUNK_HEADER_LEN)?;
    let number = |at: usize| header[at..at + 8].iter().rev().fold(0_u64, |sum, byte| (sum << 8) | u64::from(*byte));
    let len = frame.body.len() - CHUNK_HEADER_LEN;
    let agree = number(16) == len as u64 && header[28..32] == [0; 4] && number(32) == len as u64;
    agree.then(|| frame.body.start + CHUNK_HEADER_LEN..frame.body.end)
}

/// What chunks are packed by, as MCAP names it.
pub(super) const PACKED_BY: &str = "zstd";

/// Length of the records of a chunk that is packed, once they are unpacked, if the lengths in its header agree with its
/// own.
pub(super) fn packed_content(bytes: &[u8], frame: &Frame) -> Option<u64> {
    let body = bytes.get(frame.body.clone()).filter(|_| frame.opcode == op::CHUNK)?;
    let (_times, rest) = body.split_first_chunk::<16>()?;
    let (content, rest) = rest.split_first_chunk::<8>()?;
    let (_checksum, rest) = rest.split_first_chunk::<4>()?;
    let (name_len, rest) = rest.split_first_chunk::<4>()?;
    let is_named = u32::from_le_bytes(*name_len) as usize == PACKED_BY.len();
    let (length, records) = rest.strip_prefix(PACKED_BY.as_bytes()).filter(|_| is_named)?.split_first_chunk::<8>()?;
    (u64::from_le_bytes(*length) == records.len() as u64).then_some(u64::from_le_bytes(*content))
}

/// Whether a record is a chunk whose lengths agree.
pub(super) fn is_chunk(bytes: &[u8], frame: &Frame) -> bool {
    frame.opcode == op::CHUNK && (chunk_records(bytes, frame).is_some() || packed_content(bytes, frame).is_some())
}

/// Where a chunk ends with the message indexes that follow on it.
pub(super) fn end_with_indexes(bytes: &[u8], chunk: &Frame) -> usize {
    let mut end = chunk.body.end;
    while let Some(Ok(index)) =
        next(bytes, end).filter(|next| matches!(next, Ok(next) if next.opcode == op::MESSAGE_INDEX))
    {
        end = index.body.end;
    }
    end
}

/// The next place at or after `from` that looks like a chunk, whose lengths agree, or like a manifest.
pub(super) fn find(bytes: &[u8], from: usize) -> Option<usize> {
    let kinds = [op::CHUNK, op::METADATA];
    let candidates = bytes.get(from..)?.iter().enumerate().filter(|(_, byte)| kinds.contains(*byte));
    candidates.map(|(offset, _)| from + offset).find(|&at| match next(bytes, at) {
        Some(Ok(frame)) if frame.opcode == op::CHUNK => is_chunk(bytes, &frame),
        Some(Ok(frame)) => is_named(&bytes[frame.body], MANIFEST),
        _ => false,
    })
}

/// Whether a record begins with this text; looks at no more of it.
fn is_named(mut body: &[u8], name: &str) -> bool {
    length(&mut body) == Some(name.len()) && body.starts_with(name.as_bytes())
}

/// The text that a record begins with.
pub(super) fn name(mut body: &[u8]) -> Option<&str> {
    let len = length(&mut body)?;
    std::str::from_utf8(take(&mut body, len)?).ok()
}

/// A record parsed by MCAP, once no text in it claims to be longer than the record: the parser reserves what a length
/// claims before it looks whether that much is there.
pub(super) fn parse(opcode: u8, body: &[u8]) -> Result<mcap::records::Record<'_>, mcap::McapError> {
    let mut rest = body;
    let mut texts_fit = || match opcode {
        op::HEADER => text(&mut rest).and_then(|()| text(&mut rest)),
        op::METADATA => text(&mut rest).and_then(|()| texts(&mut rest)),
        op::SCHEMA => take(&mut rest, 2).and_then(|_| text(&mut rest)).and_then(|()| text(&mut rest)),
        op::CHANNEL => {
            take(&mut rest, 4)?;
            text(&mut rest)?;
            text(&mut rest)?;
            texts(&mut rest)
        }
        _ => Some(()),
    };
    match texts_fit() {
        Some(()) => mcap::parse_record(opcode, body),
        None => Err(mcap::McapError::UnexpectedEof),
    }
}

fn take<'a>(rest: &mut &'a [u8], len: usize) -> Option<&'a [u8]> {
    let (taken, left) = rest.split_at_checked(len)?;
    *rest = left;
    Some(taken)
}

fn length(rest: &mut &[u8]) -> Option<usize> {
    let bytes = take(rest, 4)?.try_into().ok()?;
    usize::try_from(u32::from_le_bytes(bytes)).ok()
}

/// Passes over one text: its length, then its bytes.
fn text(rest: &mut &[u8]) -> Option<()> {
    let len = length(rest)?;
    take(rest, len).map(drop)
}

/// Passes over a map of texts: its length in bytes, then names and values. The parser takes ten times the length of a map of
/// many short ones.
fn texts(rest: &mut &[u8]) -> Option<()> {
    const MOST: usize = 1000;
    let len = length(rest)?;
    let mut map = take(rest, len)?;
    let mut count = 0;
    while !map.is_empty() && count <= MOST {
        text(&mut map)?;
        count += 1;
    }
    (count <= MOST).then_some(())
}

/// A kind of record, in words.
pub(super) struct Kind(pub u8);

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.0 {
            op::HEADER => "header",
            op::FOOTER => "footer",
            op::SCHEMA => "schema",
            op::CHANNEL => "channel",
            op::MESSAGE => "message",
            op::CHUNK => "chunk",
            op::MESSAGE_INDEX => "message index",
            op::CHUNK_INDEX => "chunk index",
            op::ATTACHMENT => "attachment",
            op::ATTACHMENT_INDEX => "attachment index",
            op::STATISTICS => "statistics",
            op::METADATA => "metadata",
            op::METADATA_INDEX => "metadata index",
            op::SUMMARY_OFFSET => "summary offset",
            op::DATA_END => "data end",
            other => return write!(f, "record of unknown kind {other:#04x}"),
        })
    }
}
