//! MCAP's end of a file: the summary that viewers go by, in pieces, so that a log of a million commits needs no memory for
//! it. The MCAP project's own writer keeps some 350 bytes for each chunk until the end, this one what
//! [`Ledger`] takes. The data section's checksum is left out, as MCAP allows: it would have every
//! byte of a log read that is continued.

use super::format::log_time_ns;
use super::frame::{CHUNK_HEADER_LEN, PREFIX_LEN, op};
use super::ledger::{Ledger, message_index_len};

/// Bytes that are collected before they are handed on.
const PIECE_BYTES: usize = 1 << 20;

/// The end of a log that is `length` bytes long before it and holds `commits` stages; `checksum` is that of these bytes, or 0
/// where it is left out.
pub(super) fn write<E>(
    ledger: &Ledger,
    length: u64,
    commits: u64,
    checksum: u32,
    emit: impl FnMut(Vec<u8>) -> Result<(), E>,
) -> Result<(), E> {
    let mut out = Pieces { emit, piece: Vec::new(), at: length, checksum: crc32fast::Hasher::new() };
    out.record(op::DATA_END, |body| body.extend(checksum.to_le_bytes()));
    out.pass()?;
    out.checksum = crc32fast::Hasher::new();
    let start = out.at;
    let mut groups = Vec::new();

    for (opcode, records) in [(op::SCHEMA, &ledger.schemas), (op::CHANNEL, &ledger.channels)] {
        let from = out.position();
        records.values().for_each(|record| out.piece.extend(record));
        groups.push((opcode, from));
        out.pass_if_large()?;
    }
    groups.push((op::STATISTICS, out.position()));
    out.record(op::STATISTICS, |body| statistics(ledger, commits, body));
    groups.push((op::CHUNK_INDEX, out.position()));
    for number in 0..ledger.chunks.len() {
        out.record(op::CHUNK_INDEX, |body| chunk_index(ledger, number, commits, body));
        out.pass_if_large()?;
    }
    groups.push((op::METADATA_INDEX, out.position()));
    for (at, bytes, name) in &ledger.metadata {
        out.record(op::METADATA_INDEX, |body| {
            body.extend(at.to_le_bytes());
            body.extend(bytes.to_le_bytes());
            text(name, body);
        });
    }
    let offsets = out.position();
    let ends = groups.iter().skip(1).map(|(_, from)| *from).chain([offsets]);
    for ((opcode, from), end) in groups.iter().zip(ends).filter(|((_, from), end)| from < end) {
        out.record(op::SUMMARY_OFFSET, |body| {
            body.push(*opcode);
            body.extend(from.to_le_bytes());
            body.extend((end - from).to_le_bytes());
        });
    }
    out.pass()?;
    out.piece.push(op::FOOTER);
    out.piece.extend(FOOTER_LEN.to_le_bytes());
    out.piece.extend(start.to_le_bytes());
    out.piece.extend(offsets.to_le_bytes());
    out.checksum.update(&out.piece);
    let checksum = out.checksum.clone().finalize();
    out.piece.extend(checksum.to_le_bytes());
    out.piece.extend(mcap::MAGIC);
    out.pass()
}

/// Two places and a checksum.
const FOOTER_LEN: u64 = 8 + 8 + 4;

fn statistics(ledger: &Ledger, commits: u64, body: &mut Vec<u8>) {
    let messages = ledger.messages();
    let [first, last] = match commits.checked_sub(1) {
        Some(last) => [0, last].map(log_time_ns),
        None => [0, 0],
    };
    body.extend(messages.values().sum::<u64>().to_le_bytes());
    body.extend((ledger.schemas.len() as u16).to_le_bytes());
    body.extend((ledger.channels.len() as u32).to_le_bytes());
    body.extend(0_u32.to_le_bytes());
    body.extend((ledger.metadata.len() as u32).to_le_bytes());
    body.extend((ledger.chunks.len() as u32).to_le_bytes());
    body.extend(first.to_le_bytes());
    body.extend(last.to_le_bytes());
    map(messages.into_iter(), body);
}

fn chunk_index(ledger: &Ledger, number: usize, commits: u64, body: &mut Vec<u8>) {
    let chunk = ledger.chunks[number];
    let pattern = &ledger.patterns[chunk.pattern as usize];
    // The record of the end has the time of the last stage.
    let time = log_time_ns((number as u64).min(commits.saturating_sub(1)));
    let content = u64::from(chunk.bytes) - (PREFIX_LEN + CHUNK_HEADER_LEN) as u64;
    let behind = chunk.at + u64::from(chunk.bytes);
    let places = pattern.iter().scan(behind, |at, (channel, messages)| {
        let place = (*channel, *at);
        *at += message_index_len(*messages);
        Some(place)
    });
    let indexes: u64 = pattern.iter().map(|(_, messages)| message_index_len(*messages)).sum();
    for number in [time, time, chunk.at, u64::from(chunk.bytes)] {
        body.extend(number.to_le_bytes());
    }
    map(places, body);
    body.extend(indexes.to_le_bytes());
    text("", body);
    body.extend(content.to_le_bytes());
    body.extend(content.to_le_bytes());
}

fn text(text: &str, body: &mut Vec<u8>) {
    body.extend((text.len() as u32).to_le_bytes());
    body.extend(text.as_bytes());
}

fn map(entries: impl Iterator<Item = (u16, u64)>, body: &mut Vec<u8>) {
    let at = body.len();
    body.extend([0; 4]);
    for (key, value) in entries {
        body.extend(key.to_le_bytes());
        body.extend(value.to_le_bytes());
    }
    let length = (body.len() - at - 4) as u32;
    body[at..at + 4].copy_from_slice(&length.to_le_bytes());
}

/// Bytes on their way out.
struct Pieces<F> {
    emit: F,
    piece: Vec<u8>,
    /// Where the piece lies in the file.
    at: u64,
    checksum: crc32fast::Hasher,
}

impl<E, F: FnMut(Vec<u8>) -> Result<(), E>> Pieces<F> {
    fn position(&self) -> u64 {
        self.at + self.piece.len() as u64
    }

    fn record(&mut self, opcode: u8, fill: impl FnOnce(&mut Vec<u8>)) {
        let at = self.piece.len();
        self.piece.push(opcode);
        self.piece.extend([0; 8]);
        fill(&mut self.piece);
        let length = (self.piece.len() - at - PREFIX_LEN) as u64;
        self.piece[at + 1..at + PREFIX_LEN].copy_from_slice(&length.to_le_bytes());
    }

    fn pass_if_large(&mut self) -> Result<(), E> {
        if self.piece.len() < PIECE_BYTES { Ok(()) } else { self.pass() }
    }

    fn pass(&mut self) -> Result<(), E> {
        self.checksum.update(&self.piece);
        self.at += self.piece.len() as u64;
        (self.emit)(std::mem::take(&mut self.piece))
    }
}
