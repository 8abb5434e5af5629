//! `LOG.index`: where the commits of a long log lie and the numbers of their reports, in blocks of a thousand or so.
//!
//! It is a cache. A block carries the hash of its head, and its head those of its columns; the head marks the block's last
//! commit, which is read from the log and compared with its own seal and chain hash before anything behind it is. Where a block
//! is missing, torn or does not fit, the log is read instead, and the index written again. No log is shorter for having none.
//!
//! A column holds eight bytes for each commit: where its chunk lies, or a field of its report ([`fields_of`]) as a number.

use std::fs::File;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::checkpoint::Checkpoint;
use super::format::{FIELDS_LIMIT, MANIFEST, THINNED, library};
use super::frame;
use super::ledger::{ChunkPlace, Ledger, PackedPlace, Pattern};
use super::manifest::Manifest;
use super::message::{HexHash, kept_as};
use super::reader::{open_regular, read_at};
use super::stretch::Stretches;
use crate::record::{Record, Report, as_number, fields_of};
use crate::state::Hash;

/// In front of every block.
pub(super) const INDEX_MAGIC: &[u8; 8] = b"FOLDINX2";

/// Commits of a block at most, and bytes of the log that it is about.
const BLOCK_COMMITS: usize = 1024;
const BLOCK_BYTES: u64 = 32 << 20;

/// The largest head that is read, bytes.
const HEAD_LIMIT: usize = 4 << 20;

/// Columns with the places of chunks.
const PLACES: [&str; 3] = ["#at", "#bytes", "#pattern"];

/// Columns with the places of packed chunks in front of them, where there are any.
const PACKED_PLACES: [&str; 3] = ["#packed_length", "#packed_content", "#packed_pattern"];

/// What a block begins with.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Head {
    /// Ordinal of its first commit.
    pub first: u64,
    /// Number of commits of the block.
    pub commits: u64,
    columns: Vec<Column>,
    mark: Mark,
    /// Where its columns lie in the index.
    #[serde(skip)]
    columns_at: u64,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Column {
    name: String,
    blake3: HexHash,
}

/// The last commit of a block, and what has to be known to read on from there.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Mark {
    pub chain_hash: HexHash,
    pub patterns: Vec<Pattern>,
    pub metadata: Vec<(u64, u64, String)>,
    pub described_at: Vec<u64>,
    /// The mesh and the fields of its state, as far as a log that was thinned has them.
    pub mesh: Option<Piece>,
    pub fields: Vec<Piece>,
    /// The last commit before it that has its state.
    pub kept_before: Option<u64>,
}

impl Mark {
    /// Whether it lists no more than a log can hold, and nothing twice.
    fn is_sound(&self) -> bool {
        let follow = self.metadata.windows(2).all(|pair| pair[0].0.saturating_add(pair[0].1) <= pair[1].0);
        self.fields.len() <= FIELDS_LIMIT && follow && self.described_at.is_sorted_by(|a, b| a < b)
    }
}

/// A message of the log.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Piece {
    pub hash: HexHash,
    /// Where its data lies, and its length, bytes.
    pub place: [u64; 2],
}

/// Collects commits until they fill a block.
#[derive(Debug, Default)]
pub(super) struct Builder {
    first: u64,
    places: Vec<ChunkPlace>,
    /// Of which columns are made once there is a block: a short log has none.
    reports: Vec<Report>,
}

/// A number that is not there.
const ABSENT: u64 = f64::NAN.to_bits();

impl Builder {
    /// Starts a block whose first commit has this ordinal.
    pub fn at(ordinal: u64) -> Self {
        Self { first: ordinal, ..Self::default() }
    }

    /// Ordinal of the commit that the block takes next.
    pub fn next(&self) -> u64 {
        self.first + self.places.len() as u64
    }

    /// Adds a commit, and returns the block when that fills it.
    pub fn push(
        &mut self,
        place: ChunkPlace,
        record: &Record,
        mark: impl FnOnce() -> Option<Mark>,
    ) -> Option<(Head, Vec<u8>)> {
        self.places.push(place);
        self.reports.push(record.report.clone());
        let bytes = place.at - self.places[0].start();
        let full = self.places.len() >= BLOCK_COMMITS || bytes >= BLOCK_BYTES;
        let mark = if full { mark()? } else { return None };
        Some(std::mem::replace(self, Self::at(self.next())).block(mark))
    }

    fn block(self, mark: Mark) -> (Head, Vec<u8>) {
        let places = [
            self.places.iter().map(|place| place.at).collect(),
            self.places.iter().map(|place| u64::from(place.bytes)).collect(),
            self.places.iter().map(|place| u64::from(place.pattern)).collect::<Vec<u64>>(),
        ];
        let mut places: Vec<(String, Vec<u64>)> = PLACES.map(str::to_owned).into_iter().zip(places).collect();
        if self.places.iter().any(|place| place.packed.is_some()) {
            let column = |number: fn(&PackedPlace) -> u32| {
                let number = |place: &ChunkPlace| place.packed.as_ref().map_or(ABSENT, |packed| number(packed).into());
                self.places.iter().map(number).collect()
            };
            let packed = [column(|place| place.length), column(|place| place.content), column(|place| place.pattern)];
            places.extend(PACKED_PLACES.map(str::to_owned).into_iter().zip(packed));
        }
        let (mut columns, mut data) = (Vec::new(), Vec::new());
        for (name, column) in places.into_iter().chain(numbers_of(&self.reports)) {
            let bytes: Vec<u8> = column.iter().flat_map(|number| number.to_le_bytes()).collect();
            columns.push(Column { name, blake3: HexHash(blake3::hash(&bytes)) });
            data.extend(bytes);
        }
        let head = Head { first: self.first, commits: self.places.len() as u64, columns, mark, columns_at: 0 };
        let json = serde_json::to_vec(&head).unwrap_or_default();
        let mut block = INDEX_MAGIC.to_vec();
        block.extend((json.len() as u64).to_le_bytes());
        block.extend(blake3::hash(&json).as_bytes());
        block.extend(json);
        block.extend(data);
        (head, block)
    }
}

/// The fields of reports by name, each with its numbers.
fn numbers_of(reports: &[Report]) -> Vec<(String, Vec<u64>)> {
    let mut columns: Vec<(String, Vec<u64>)> = Vec::new();
    for (row, report) in reports.iter().enumerate() {
        for (name, value) in fields_of(report) {
            let known = columns.iter().position(|(known, _)| *known == name);
            let column = known.unwrap_or_else(|| {
                columns.push((name, vec![ABSENT; row]));
                columns.len() - 1
            });
            columns[column].1.push(number(&value));
        }
        columns.iter_mut().for_each(|(_, column)| column.resize(row + 1, ABSENT));
    }
    columns
}

/// Bytes of a block in front of its head: magic, length and hash.
const BLOCK_START_LEN: usize = 8 + 8 + 32;

/// A field of a report as eight bytes: numbers as they are, words by their hash.
fn number(value: &serde_json::Value) -> u64 {
    match value {
        serde_json::Value::String(word) => word_number(word),
        value => as_number(value).map_or(ABSENT, f64::to_bits),
    }
}

/// The number that represents a word in a column.
pub fn word_number(word: &str) -> u64 {
    blake3::hash(word.as_bytes()).as_bytes().first_chunk().map_or(ABSENT, |bytes| u64::from_le_bytes(*bytes))
}

/// The blocks of an index that can be used.
#[derive(Debug)]
pub(super) struct Index {
    file: File,
    pub heads: Vec<Head>,
    /// Bytes of them.
    pub length: u64,
}

impl Index {
    /// Reads the heads of the blocks of an index; `None` where there is no index.
    pub fn read(path: &Path) -> Option<Self> {
        let file = open_regular(path).ok()?;
        let mut index = Self { file, heads: Vec::new(), length: 0 };
        while let Some(head) = index.head_at(index.length) {
            let expected = index.heads.last().map_or(0, |before| before.first + before.commits);
            if head.first != expected || head.commits == 0 {
                break;
            }
            index.length = head.columns_at + head.commits * 8 * head.columns.len() as u64;
            index.heads.push(head);
        }
        (!index.heads.is_empty()).then_some(index)
    }

    fn head_at(&self, at: u64) -> Option<Head> {
        let mut start = Vec::new();
        read_at(&self.file, at, BLOCK_START_LEN, &mut start).ok()?;
        let rest = start.strip_prefix(INDEX_MAGIC)?;
        let (length, hash) = rest.split_first_chunk::<8>()?;
        let length = usize::try_from(u64::from_le_bytes(*length)).ok().filter(|length| *length <= HEAD_LIMIT)?;
        let mut json = Vec::new();
        read_at(&self.file, at + BLOCK_START_LEN as u64, length, &mut json).ok()?;
        if blake3::hash(&json).as_bytes() != hash {
            return None;
        }
        let mut head: Head = serde_json::from_slice(&json).ok()?;
        head.columns_at = at + (BLOCK_START_LEN + length) as u64;
        let columns = head.commits.checked_mul(8 * head.columns.len() as u64)?;
        let is_whole = head.columns_at.checked_add(columns)? <= self.file.metadata().ok()?.len();
        let has_places = PLACES.iter().all(|name| head.columns.iter().any(|column| column.name == *name));
        (is_whole && has_places && head.mark.is_sound()).then_some(head)
    }

    /// Registers a block that was written behind the others.
    pub fn add(&mut self, mut head: Head, block_len: usize) {
        let columns = head.commits * 8 * head.columns.len() as u64;
        head.columns_at = self.length + block_len as u64 - columns;
        self.length += block_len as u64;
        self.heads.push(head);
    }

    /// Creates an index without blocks in a file.
    pub fn empty(file: File) -> Self {
        Self { file, heads: Vec::new(), length: 0 }
    }

    /// Number of commits that the index knows.
    pub fn commits(&self) -> u64 {
        self.heads.last().map_or(0, |head| head.first + head.commits)
    }

    /// Reads a column of a block and checks it; it is empty where the block has none of that name.
    pub fn column(&self, head: &Head, name: &str) -> io::Result<Vec<u64>> {
        let Some(place) = head.columns.iter().position(|column| column.name == name) else {
            return Ok(vec![ABSENT; head.commits as usize]);
        };
        let length = head.commits as usize * 8;
        let mut bytes = Vec::new();
        read_at(&self.file, head.columns_at + (place * length) as u64, length, &mut bytes)?;
        if blake3::hash(&bytes) != head.columns[place].blake3.0 {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "a column of the index has changed"));
        }
        Ok(bytes
            .chunks_exact(8)
            .filter_map(|number| number.first_chunk())
            .map(|number| u64::from_le_bytes(*number))
            .collect())
    }

    /// Reads from the log the checkpoint that the last block marks, and the places of all chunks before it.
    pub fn checkpoint(&self, log: &File) -> io::Result<Option<(Checkpoint, Ledger)>> {
        let Some(last) = self.heads.last() else { return Ok(None) };
        let mut ledger = Ledger { patterns: last.mark.patterns.clone(), ..Ledger::default() };
        for head in &self.heads {
            let Some(places) = self.places(head, ledger.patterns.len())? else { return Ok(None) };
            ledger.chunks.extend(places);
        }
        let Some(here) = ledger.chunks.pop() else { return Ok(None) };
        Ok(checkpoint_of(log, last, here.start(), &mut ledger)?.map(|checkpoint| (checkpoint, ledger)))
    }

    /// Reads the places of the chunks of a block; `None` where one has none of so many patterns.
    fn places(&self, head: &Head, patterns: usize) -> io::Result<Option<Vec<ChunkPlace>>> {
        let numbers = PLACES.into_iter().chain(PACKED_PLACES).map(|name| self.column(head, name));
        let numbers = numbers.collect::<io::Result<Vec<_>>>()?;
        let place = |row: usize| {
            let [at, bytes, pattern, length, content, packed_pattern] =
                [0, 1, 2, 3, 4, 5].map(|column| numbers[column][row]);
            let packed = PackedPlace { length: length as u32, content: content as u32, pattern: packed_pattern as u32 };
            let packed = (length != ABSENT).then_some(packed);
            let is_known = |pattern: u32| (pattern as usize) < patterns;
            let is_sound = is_known(pattern as u32)
                && packed.is_none_or(|packed| is_known(packed.pattern) && u64::from(packed.length) <= at);
            is_sound.then_some(ChunkPlace { at, bytes: bytes as u32, pattern: pattern as u32, packed })
        };
        Ok((0..head.commits as usize).map(place).collect())
    }

    /// Reads from the log the checkpoint that the last block marks.
    pub fn last_checkpoint(&self, log: &File) -> io::Result<Option<Checkpoint>> {
        self.checkpoint_before(log, usize::MAX)
    }

    /// Reads from the log the checkpoint of the last block whose commits all come before `ordinal`.
    pub fn checkpoint_before(&self, log: &File, ordinal: usize) -> io::Result<Option<Checkpoint>> {
        let behind = self.heads.partition_point(|head| head.first + head.commits <= ordinal as u64);
        let Some(last) = self.heads[..behind].last() else { return Ok(None) };
        let places = self.places(last, last.mark.patterns.len())?;
        let Some(here) = places.as_ref().and_then(|places| places.last()) else { return Ok(None) };
        checkpoint_of(log, last, here.start(), &mut Ledger::default())
    }
}

/// The commit that a block marks, whose chunk begins at `at`, and what has to be known to read on from there; the ledger gains the
/// metadata and the descriptions of channels before it.
fn checkpoint_of(log: &File, last: &Head, at: u64, ledger: &mut Ledger) -> io::Result<Option<Checkpoint>> {
    let Mark { chain_hash, metadata, described_at, mesh, fields, kept_before, .. } = &last.mark;
    let piece = |piece: &Piece| -> io::Result<(Hash, u64, Vec<u8>)> {
        let mut bytes = Vec::new();
        let length = (piece.place[1] as usize).min(super::format::CHUNK_BYTES_LIMIT);
        read_at(log, piece.place[0], length, &mut bytes)?;
        Ok((piece.hash.0, piece.place[0], bytes))
    };
    for at in described_at {
        if let Some((bytes, chunk)) = record_at(log, *at)? {
            ledger.describe(*at, &bytes, &chunk);
        }
    }
    let (mut stretches, mut thinned) = (Stretches::default(), None);
    for (at, bytes, name) in metadata {
        ledger.metadata.push((*at, *bytes, name.clone()));
        if name != MANIFEST && name != THINNED {
            continue;
        }
        let Some((bytes, record)) = record_at(log, *at)?.filter(|(found, _)| found.len() as u64 == *bytes) else {
            return Ok(None);
        };
        let Ok(mcap::records::Record::Metadata(parsed)) = frame::parse(record.opcode, &bytes[record.body.clone()])
        else {
            return Ok(None);
        };
        if name == THINNED {
            thinned = Some(kept_as(&parsed));
            continue;
        }
        let Ok((manifest, hash)) = Manifest::from_record(&parsed) else { return Ok(None) };
        stretches.begin(manifest, hash);
    }
    let checkpoint = Checkpoint {
        at,
        ordinal: last.first + last.commits - 1,
        chain_hash: chain_hash.0,
        library: library(),
        channels: ledger.channels_described(),
        stretches,
        mesh: mesh.as_ref().map(piece).transpose()?,
        fields: fields.iter().map(piece).collect::<io::Result<_>>()?,
        thinned,
        kept_before: kept_before.map(|ordinal| ordinal as usize),
    };
    Ok(Some(checkpoint))
}

/// The record at a place in a log, alone in a buffer.
pub(super) fn record_at(log: &File, at: u64) -> io::Result<Option<(Vec<u8>, frame::Frame)>> {
    let mut bytes = Vec::new();
    read_at(log, at, frame::PREFIX_LEN, &mut bytes)?;
    let Some(Err(frame::Cut { claim: Some((_, length)), .. })) = frame::next(&bytes, 0) else { return Ok(None) };
    let limit = super::format::CHUNK_BYTES_LIMIT as u64;
    if length > limit {
        return Ok(None);
    }
    read_at(log, at + frame::PREFIX_LEN as u64, length as usize, &mut bytes)?;
    Ok(frame::next(&bytes, 0).and_then(Result::ok).map(|found| (bytes, found)))
}
