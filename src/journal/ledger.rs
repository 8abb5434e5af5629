//! Where the chunks of a log lie, in a few bytes each: all that MCAP's summary at the end of a log is made of.

use std::collections::BTreeMap;

use mcap::records::Record as McapRecord;

use super::chunk::{self, Channels};
use super::frame::{self, Frame, op};

/// One chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ChunkPlace {
    /// Offset of the first byte in the log.
    pub at: u64,
    /// Length with the nine bytes in front.
    pub bytes: u32,
    /// Which of the ledger's patterns its message indexes have.
    pub pattern: u32,
    /// The packed chunk right in front of it.
    pub packed: Option<PackedPlace>,
}

impl ChunkPlace {
    /// Offset at which it begins, with the packed chunk in front of it.
    pub fn start(&self) -> u64 {
        self.at - self.packed.map_or(0, |packed| u64::from(packed.length))
    }
}

/// A packed chunk, right in front of the commit that names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PackedPlace {
    /// Length with the nine bytes in front and with its message indexes.
    pub length: u32,
    /// Length of its records once they are unpacked.
    pub content: u32,
    /// Which of the ledger's patterns its message indexes have.
    pub pattern: u32,
}

/// The message indexes behind a chunk: channel and messages of each, in their order.
pub(super) type Pattern = Vec<(u16, u32)>;

/// What a log holds, in the order of the file.
#[derive(Clone, Debug, Default)]
pub(super) struct Ledger {
    pub chunks: Vec<ChunkPlace>,
    /// Few: chunks of one kind share theirs.
    pub patterns: Vec<Pattern>,
    /// First byte, length and name of every metadata record.
    pub metadata: Vec<(u64, u64, String)>,
    /// Records of schemas, whole, by number.
    pub schemas: BTreeMap<u16, Vec<u8>>,
    /// Records of channels, whole, by number.
    pub channels: BTreeMap<u16, Vec<u8>>,
    /// First bytes of the chunks that describe schemas or channels which no chunk before them does.
    pub described_at: Vec<u64>,
}

impl Ledger {
    /// Registers the whole chunks in `bytes`, with their indexes; the bytes begin at `at` in the log.
    pub fn enter(&mut self, at: u64, bytes: &[u8]) {
        let mut from = if at == 0 { mcap::MAGIC.len() } else { 0 };
        let mut open: Option<(ChunkPlace, Pattern)> = None;
        // What was packed comes before its commit.
        let mut packed: Option<(PackedPlace, Pattern)> = None;
        while let Some(Ok(record)) = frame::next(bytes, from) {
            from = record.body.end;
            if record.opcode == op::MESSAGE_INDEX {
                let body = &bytes[record.body.clone()];
                let messages = (body.len().saturating_sub(INDEX_HEAD_LEN) / INDEX_ENTRY_LEN) as u32;
                let Some(channel) = body.first_chunk().map(|channel| u16::from_le_bytes(*channel)) else { continue };
                match (&mut open, &mut packed) {
                    (Some((_, pattern)), _) => pattern.push((channel, messages)),
                    (None, Some((place, pattern))) => {
                        pattern.push((channel, messages));
                        place.length += (record.body.end - record.at) as u32;
                    }
                    (None, None) => {}
                }
                continue;
            }
            self.close(open.take());
            let place = at + record.at as u64;
            match record.opcode {
                op::CHUNK => {
                    let length = (record.body.end - record.at) as u32;
                    if let Some(content) = frame::packed_content(bytes, &record) {
                        packed = Some((PackedPlace { length, content: content as u32, pattern: 0 }, Pattern::new()));
                        continue;
                    }
                    self.describe(place, bytes, &record);
                    let packed = packed.take().map(|(packed, pattern)| {
                        let pattern = self.number_of(pattern);
                        PackedPlace { pattern, ..packed }
                    });
                    open = Some((ChunkPlace { at: place, bytes: length, pattern: 0, packed }, Pattern::new()));
                }
                op::METADATA => {
                    let name = frame::name(&bytes[record.body.clone()]).unwrap_or_default();
                    self.metadata.push((place, (record.body.end - record.at) as u64, name.to_owned()));
                }
                _ => {}
            }
        }
        self.close(open);
    }

    /// Number of messages of each channel.
    pub fn messages(&self) -> BTreeMap<u16, u64> {
        let mut chunks = vec![0_u64; self.patterns.len()];
        for chunk in &self.chunks {
            chunks[chunk.pattern as usize] += 1;
            chunk.packed.iter().for_each(|packed| chunks[packed.pattern as usize] += 1);
        }
        let mut messages = BTreeMap::new();
        for (pattern, chunks) in self.patterns.iter().zip(chunks) {
            for (channel, each) in pattern {
                *messages.entry(*channel).or_insert(0) += u64::from(*each) * chunks;
            }
        }
        messages
    }

    /// The channels whose schema and channel records the ledger has.
    pub fn channels_described(&self) -> Channels {
        let parsed = self.channels.values().filter_map(|record| {
            let found = frame::next(record, 0)?.ok()?;
            match frame::parse(found.opcode, &record[found.body]).ok()? {
                McapRecord::Channel(channel) => Some((channel.id, channel)),
                _ => None,
            }
        });
        parsed.collect()
    }

    /// Returns the number of a pattern, adding it if it is new.
    pub fn number_of(&mut self, pattern: Pattern) -> u32 {
        let known = self.patterns.iter().position(|known| *known == pattern);
        known.unwrap_or_else(|| {
            self.patterns.push(pattern);
            self.patterns.len() - 1
        }) as u32
    }

    fn close(&mut self, chunk: Option<(ChunkPlace, Pattern)>) {
        if let Some((place, pattern)) = chunk {
            let pattern = self.number_of(pattern);
            self.chunks.push(ChunkPlace { pattern, ..place });
        }
    }

    /// Registers the schemas and channels that a chunk describes.
    pub fn describe(&mut self, at: u64, bytes: &[u8], chunk: &Frame) {
        let known = self.schemas.len() + self.channels.len();
        for record in chunk::records(bytes, chunk).into_iter().flatten() {
            let Some(number) = bytes[record.body.clone()].first_chunk() else { continue };
            let kind = match record.opcode {
                op::SCHEMA => &mut self.schemas,
                op::CHANNEL => &mut self.channels,
                _ => continue,
            };
            let whole = &bytes[record.at..record.body.end];
            kind.entry(u16::from_le_bytes(*number)).or_insert_with(|| whole.to_vec());
        }
        if self.schemas.len() + self.channels.len() > known {
            self.described_at.push(at);
        }
    }
}

/// Bytes of a message index in front of its entries: channel, and the length of what follows.
const INDEX_HEAD_LEN: usize = 2 + 4;
/// Bytes of one entry: time and place.
const INDEX_ENTRY_LEN: usize = 8 + 8;

/// Length of a message index with so many messages, with the nine bytes in front.
pub(super) fn message_index_len(messages: u32) -> u64 {
    (frame::PREFIX_LEN + INDEX_HEAD_LEN + INDEX_ENTRY_LEN * messages as usize) as u64
}
