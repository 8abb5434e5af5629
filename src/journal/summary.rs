//! MCAP's end of a file: the summary that viewers go by, in pieces, so that a log of a million commits needs no memory for
//! it. The MCAP project's own writer keeps some 350 bytes for each chunk until the end, this one what
//! [`Ledger`] takes. The data section's checksum is left out, as MCAP allows: it would have every
//! byte of a log read that is continued.

use super::format::log_time_ns;
use super::frame::{CHUNK_HEADER_LEN, PACKED_BY, PREFIX_LEN, op};
use super::ledger::{ChunkPlace, Ledger, Pattern, message_index_len};

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
    for (number, chunk) in ledger.chunks.iter().enumerate() {
        // The record of the end has the time of the last stage.
        let time = log_time_ns((number as u64).min(commits.saturating_sub(1)));
        for indexed in IndexedChunk::of(ledger, chunk) {
            out.record(op::CHUNK_INDEX, |body| indexed.write(time, body));
        }
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
    let packed = ledger.chunks.iter().filter(|chunk| chunk.packed.is_some()).count();
    body.extend(((ledger.chunks.len() + packed) as u32).to_le_bytes());
    body.extend(first.to_le_bytes());
    body.extend(last.to_le_bytes());
    map(messages.into_iter(), body);
}

/// What the index states of a chunk.
struct IndexedChunk<'l> {
    at: u64,
    /// Length with the nine bytes in front.
    bytes: u64,
    pattern: &'l Pattern,
    compression: &'static str,
    /// Lengths of the records as they lie there, and unpacked.
    lengths: [u64; 2],
}

impl<'l> IndexedChunk<'l> {
    /// The packed chunk in front of a chunk, if there is one, and the chunk.
    fn of(ledger: &'l Ledger, chunk: &ChunkPlace) -> impl Iterator<Item = Self> {
        let packed = chunk.packed.map(|packed| {
            let pattern = &ledger.patterns[packed.pattern as usize];
            let bytes = u64::from(packed.length) - indexes_len(pattern);
            let records = bytes - (PREFIX_LEN + CHUNK_HEADER_LEN + PACKED_BY.len()) as u64;
            let lengths = [records, u64::from(packed.content)];
            Self { at: chunk.start(), bytes, pattern, compression: PACKED_BY, lengths }
        });
        let bytes = u64::from(chunk.bytes);
        let records = bytes - (PREFIX_LEN + CHUNK_HEADER_LEN) as u64;
        let pattern = &ledger.patterns[chunk.pattern as usize];
        packed.into_iter().chain([Self { at: chunk.at, bytes, pattern, compression: "", lengths: [records; 2] }])
    }

    fn write(&self, time: u64, body: &mut Vec<u8>) {
        let places = self.pattern.iter().scan(self.at + self.bytes, |at, (channel, messages)| {
            let place = (*channel, *at);
            *at += message_index_len(*messages);
            Some(place)
        });
        for number in [time, time, self.at, self.bytes] {
            body.extend(number.to_le_bytes());
        }
        map(places, body);
        body.extend(indexes_len(self.pattern).to_le_bytes());
        text(self.compression, body);
        self.lengths.iter().for_each(|length| body.extend(length.to_le_bytes()));
    }
}

fn indexes_len(pattern: &Pattern) -> u64 {
    pattern.iter().map(|(_, messages)| message_index_len(*messages)).sum()
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
