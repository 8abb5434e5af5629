//! Commits and manifests as MCAP bytes, in memory; nothing here touches a file, so nothing here can fail halfway.

use std::collections::{BTreeMap, HashSet};
use std::time::{SystemTime, UNIX_EPOCH};

use mcap::records::{MessageHeader, Metadata, Record as McapRecord};
use mcap::write::NoSeek;
use mcap::{McapError, Writer};

use super::chunk;
use super::codec::EncodedField;
use super::encode_error::EncodeError;
use super::format::{CHUNK_BYTES_LIMIT, DISPLACEMENT_TOPIC, OWN_TOPICS, REPORT_BYTES_LIMIT, log_time_ns, sequence};
use super::frame::{self, Frame, op};
use super::index::{Mark, Piece};
use super::ledger::{ChunkPlace, Ledger};
use super::manifest::Manifest;
use super::message::{CommitMessage, FinishedMessage, HexHash, MessageHash, PackedHash, ReportMessage, seal};
use super::outbox::{Outbox, options};
use super::packer::Packer;
use super::summary;
use super::topics::{ChannelNumbers, OWN, ViewerMessage, ViewerTopic, binary_topic};
use crate::record::{Commit, Record};
use crate::state::Hash;

/// Makes the bytes of a log. They are collected until [`Encoder::take`]; those of a record that failed, and the summary
/// that MCAP's writer makes when it is dropped, go nowhere.
pub(super) struct Encoder {
    writer: Writer<NoSeek<Outbox>>,
    outbox: Outbox,
    /// Chunks that the ledger had when the writer was made.
    writer_made_at: usize,
    /// Hash of the manifest that began the stretch.
    stretch: Hash,
    ledger: Ledger,
    /// Numbers of the channels that are described so far.
    described: HashSet<u16>,
    /// Topics that messages went to, and the numbers of their schemas and channels.
    channels: Vec<(ViewerTopic, ChannelNumbers)>,
    /// Packs what viewers are shown; not there before they are shown something.
    packer: Option<Packer>,
    /// Mesh and fields of the last state, where they lie, and their lengths.
    pieces: Vec<(Hash, [u64; 2])>,
    /// Those that were not taken yet: the first messages of their chunk.
    new_pieces: Vec<Hash>,
    /// Length of the log so far.
    length: u64,
    /// Bytes that the log lacks and the ledger has.
    in_front: Vec<u8>,
}

/// Chunks after which MCAP's writer is replaced by a new one: it keeps some 350 bytes for each until the end.
const CHUNKS_OF_ONE_WRITER: usize = 4096;

/// The messages of one stage, encoded.
pub(super) struct Parts<'a> {
    pub record: &'a Record,
    pub mesh_hash: Hash,
    /// The mesh, where the log does not have it yet.
    pub mesh: Option<Vec<u8>>,
    pub state: &'a [u8],
    pub fields: &'a [EncodedField],
    /// Fields that the log has already.
    pub known: &'a [EncodedField],
    pub viewer: &'a [ViewerMessage],
}

impl Encoder {
    pub(super) fn new(library: &str) -> Result<Self, McapError> {
        let (writer, outbox) = writer(library)?;
        Ok(Self::with(writer, outbox, Ledger::default(), 0))
    }

    /// Continues after the first `length` bytes of a log, which `ledger` describes.
    pub(super) fn behind(ledger: Ledger, length: u64) -> Result<Self, McapError> {
        let (writer, outbox) = writer_that_knows(&ledger)?;
        Ok(Self::with(writer, outbox, ledger, length))
    }

    fn with(writer: Writer<NoSeek<Outbox>>, outbox: Outbox, ledger: Ledger, length: u64) -> Self {
        Self {
            writer,
            outbox,
            writer_made_at: ledger.chunks.len(),
            stretch: Hash::from_bytes([0; 32]),
            described: ledger.channels.keys().copied().collect(),
            ledger,
            channels: Vec::new(),
            packer: None,
            pieces: Vec::new(),
            new_pieces: Vec::new(),
            length,
            in_front: Vec::new(),
        }
    }

    /// The bytes made so far, whole records, which are then gone from here.
    pub(super) fn take(&mut self) -> Vec<u8> {
        let mut bytes = {
            let mut outbox = self.outbox.bytes();
            // What comes next is likely to be as long.
            let room = Vec::with_capacity(outbox.len());
            std::mem::replace(&mut *outbox, room)
        };
        self.ledger.enter(self.length, &bytes);
        self.find_new_pieces(&bytes);
        self.length += bytes.len() as u64;
        if !self.in_front.is_empty() {
            bytes.splice(..0, std::mem::take(&mut self.in_front));
        }
        if self.ledger.chunks.len() - self.writer_made_at >= CHUNKS_OF_ONE_WRITER {
            self.writer_made_at = self.ledger.chunks.len();
            self.packer = None;
            // The one there is does as well.
            if let Ok((writer, outbox)) = writer_that_knows(&self.ledger) {
                (self.writer, self.outbox) = (writer, outbox);
            }
        }
        bytes
    }

    /// Finds the pieces of a state in the chunk that was made of it.
    fn find_new_pieces(&mut self, bytes: &[u8]) {
        let Some(place) = self.ledger.chunks.last().filter(|_| !self.new_pieces.is_empty()) else { return };
        let Some(Ok(chunk)) = place.at.checked_sub(self.length).and_then(|at| frame::next(bytes, at as usize)) else {
            return;
        };
        let messages =
            chunk::records(bytes, &chunk).into_iter().flatten().filter(|record| record.opcode == op::MESSAGE);
        let places = messages.map(|record| {
            let data = record.body.start + chunk::MESSAGE_HEADER_LEN;
            [self.length + data as u64, (record.body.end - data) as u64]
        });
        self.pieces.extend(self.new_pieces.drain(..).zip(places));
    }

    /// Says where a mesh or a field of the last state lies, and its length.
    pub(super) fn know(&mut self, piece: Hash, place: [u64; 2]) {
        self.pieces.push((piece, place));
    }

    /// Gives back bytes that were taken: they go out in front of what is made next.
    pub(super) fn give_back(&mut self, bytes: &[u8]) {
        self.in_front = bytes.to_vec();
    }

    /// The ledger of the log so far.
    pub(super) fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    /// Starts a stretch with its manifest.
    pub(super) fn manifest(&mut self, manifest: &Manifest) -> Result<(), EncodeError> {
        manifest.check_size()?;
        self.stretch = manifest.hash();
        Ok(self.writer.write_metadata(&manifest.to_record())?)
    }

    /// Starts a stretch, whose manifest has this hash.
    pub(super) fn go_on_with(&mut self, stretch: Hash) {
        self.stretch = stretch;
    }

    /// One stage as one chunk.
    pub(super) fn commit(&mut self, parts: &Parts) -> Result<(), EncodeError> {
        let report = ReportMessage::new(parts.record).to_json()?;
        if report.len() > REPORT_BYTES_LIMIT {
            return Err(EncodeError::ReportTooLarge { bytes: report.len() });
        }
        let mut messages: Vec<(&ViewerTopic, &[u8])> = Vec::new();
        messages.extend(parts.mesh.as_deref().map(|mesh| (&OWN.mesh, mesh)));
        let is_new = |field: &&EncodedField| parts.known.iter().all(|known| known.hash != field.hash);
        let mut new_fields: Vec<&EncodedField> = Vec::new();
        for field in parts.fields.iter().filter(is_new) {
            if new_fields.iter().all(|other| other.hash != field.hash) {
                new_fields.push(field);
            }
        }
        messages.extend(new_fields.iter().map(|field| (&OWN.displacement, &field.bytes[..])));
        messages.push((&OWN.state, parts.state));
        messages.push((&OWN.report, &report));
        let mut hashes = new_fields.iter().map(|field| field.hash);
        let named = messages.iter().map(|(topic, data)| match topic.topic.as_str() {
            DISPLACEMENT_TOPIC => hashes.next().map_or_else(
                || MessageHash::of(DISPLACEMENT_TOPIC, data),
                |hash| MessageHash::hashed(DISPLACEMENT_TOPIC, data, hash),
            ),
            topic => MessageHash::of(topic, data),
        });
        let named = named.collect();
        let fields: Vec<Hash> = parts.fields.iter().map(|field| field.hash).collect();
        let ordinal = parts.record.commit.ordinal;
        let own_bytes = bytes_of(messages.iter().copied());
        check_size(own_bytes, "")?;
        let packed = self.packed(ordinal, parts.viewer)?;
        let mut commit = CommitMessage::new(&parts.record.commit, self.stretch, parts.mesh_hash, &fields, named);
        commit.packed = packed.as_deref().map(PackedHash::of);
        let commit = seal(&commit)?;
        messages.push((&OWN.commit, &commit));
        for (topic, data) in messages {
            self.message(topic, ordinal, data)?;
        }
        // The chunk itself comes when the writer is flushed.
        self.outbox.bytes().extend(packed.unwrap_or_default());
        self.pieces.retain(|(hash, _)| *hash == parts.mesh_hash || fields.contains(hash));
        let mesh = parts.mesh.as_ref().map(|_| parts.mesh_hash);
        self.new_pieces = mesh.into_iter().chain(new_fields.iter().map(|field| field.hash)).collect();
        Ok(self.writer.flush()?)
    }

    /// The messages for viewers as a packed chunk with its message indexes; `None` without a message.
    fn packed(&mut self, ordinal: u64, viewer: &[ViewerMessage]) -> Result<Option<Vec<u8>>, EncodeError> {
        if viewer.is_empty() {
            return Ok(None);
        }
        check_size(
            bytes_of(viewer.iter().map(|message| (&*message.topic, &message.data[..]))),
            ", or `mesh_history = false` under [output]",
        )?;
        for message in viewer {
            if OWN_TOPICS.contains(&message.topic.topic.as_str()) {
                return Err(EncodeError::OwnTopic { topic: message.topic.topic.clone() });
            }
            // Described in the commit's chunk as well: nothing that is packed has to be unpacked to continue a log.
            let numbers = self.channel(&message.topic)?;
            let packer = match &mut self.packer {
                Some(packer) => packer,
                none => none.insert(Packer::new()?),
            };
            packer.message(&message.topic, numbers, &header_of(numbers, ordinal), &message.data)?;
        }
        Ok(self.packer.as_mut().map(Packer::chunk).transpose()?)
    }

    /// Where the last chunk that was taken lies.
    pub(super) fn last_chunk(&self) -> Option<ChunkPlace> {
        self.ledger.chunks.last().copied()
    }

    /// The mark of the last commit that was taken, for a block of the index.
    pub(super) fn mark(&self, last: &Commit, mesh: Hash, fields: &[EncodedField]) -> Option<Mark> {
        let piece = |hash| {
            let (_, place) = self.pieces.iter().find(|(known, _)| *known == hash)?;
            Some(Piece { hash: HexHash(hash), place: *place })
        };
        Some(Mark {
            chain_hash: HexHash(last.chain_hash),
            patterns: self.ledger.patterns.clone(),
            metadata: self.ledger.metadata.clone(),
            described_at: self.ledger.described_at.clone(),
            mesh: Some(piece(mesh)?),
            fields: fields.iter().map(|field| piece(field.hash)).collect::<Option<_>>()?,
            kept_before: last.ordinal.checked_sub(1),
        })
    }

    /// The end of the run, as a chunk of its own.
    pub(super) fn finished(&mut self, last: &Commit) -> Result<(), EncodeError> {
        let data = seal(&FinishedMessage::after(last, self.stretch))?;
        self.message(&OWN.finished, last.ordinal, &data)?;
        Ok(self.writer.flush()?)
    }

    /// The numbers of a topic's channel. MCAP's writer knows them too, and looks for them by the hash of the whole schema.
    fn channel(&mut self, topic: &ViewerTopic) -> Result<ChannelNumbers, McapError> {
        if let Some((_, numbers)) = self.channels.iter().find(|(known, _)| known == topic) {
            return Ok(*numbers);
        }
        let schema = match topic.schema_encoding.as_str() {
            "" => 0,
            encoding => self.writer.add_schema(&topic.schema_name, encoding, &topic.schema)?,
        };
        let channel = self.writer.add_channel(schema, &topic.topic, &topic.message_encoding, &BTreeMap::new())?;
        let numbers = ChannelNumbers { schema, channel };
        self.described.insert(channel);
        self.channels.push((topic.clone(), numbers));
        Ok(numbers)
    }

    fn message(&mut self, topic: &ViewerTopic, ordinal: u64, data: &[u8]) -> Result<(), McapError> {
        let numbers = self.channel(topic)?;
        self.writer.write_to_known_channel(&header_of(numbers, ordinal), data)
    }

    /// A manifest or a chunk of another log again: the same records with the same numbers and times, so that the bytes are
    /// the same.
    pub(super) fn again(&mut self, bytes: &[u8], part: &Frame) -> Result<(), McapError> {
        self.again_if(bytes, part, |_| true)
    }

    /// A metadata record about the log.
    pub(super) fn metadata(&mut self, record: &Metadata) -> Result<(), McapError> {
        self.writer.write_metadata(record)
    }

    /// The same without the messages whose data begins at a place that `keeps` does not take.
    pub(super) fn again_if(
        &mut self,
        bytes: &[u8],
        part: &Frame,
        keeps: impl Fn(usize) -> bool,
    ) -> Result<(), McapError> {
        if part.opcode == frame::op::METADATA
            && let McapRecord::Metadata(record) = frame::parse(part.opcode, &bytes[part.body.clone()])?
        {
            return self.writer.write_metadata(&record);
        }
        if frame::packed_content(bytes, part).is_some() {
            let end = frame::end_with_indexes(bytes, part);
            let Some(Ok(commit)) = frame::next(bytes, end) else { return Ok(()) };
            self.outbox.bytes().extend(&bytes[part.at..end]);
            return self.again_if(bytes, &commit, keeps);
        }
        if !self.describes(bytes, part) {
            return self.again_as_committed(bytes, part, keeps);
        }
        for record in chunk::records(bytes, part).into_iter().flatten() {
            let data = record.body.start + chunk::MESSAGE_HEADER_LEN;
            match frame::parse(record.opcode, &bytes[record.body])? {
                McapRecord::Message { .. } if !keeps(data) => {}
                McapRecord::Message { header, data } => self.writer.write_to_known_channel(&header, &data)?,
                record => {
                    if let McapRecord::Channel(channel) = &record {
                        self.described.insert(channel.id);
                    }
                    describe(&mut self.writer, &record)?;
                }
            }
        }
        self.writer.flush()
    }

    /// Whether the descriptions of channels in a chunk, or in those before it, can be trusted.
    fn describes(&self, bytes: &[u8], part: &Frame) -> bool {
        let mut described: Vec<u16> = Vec::new();
        let is_described = |record: Frame| {
            let Some(id) = bytes[record.body.clone()].first_chunk().map(|id| u16::from_le_bytes(*id)) else {
                return false;
            };
            if record.opcode == frame::op::CHANNEL {
                described.push(id);
            }
            record.opcode != frame::op::MESSAGE || described.contains(&id) || self.described.contains(&id)
        };
        chunk::has_its_checksum(bytes, part) && chunk::records(bytes, part).into_iter().flatten().all(is_described)
    }

    /// A chunk of which nothing can be trusted but the hashes in its commit: its messages under topics described again.
    fn again_as_committed(
        &mut self,
        bytes: &[u8],
        part: &Frame,
        keeps: impl Fn(usize) -> bool,
    ) -> Result<(), McapError> {
        let chunk::Committed { ordinal, messages } = chunk::as_committed(bytes, part).unwrap_or_default();
        for (topic, data) in messages.into_iter().filter(|(_, data)| keeps(data.start)) {
            match OWN.named(&topic) {
                Some(own) => self.message(own, ordinal, &bytes[data])?,
                // What viewers' topics were is lost.
                None => self.message(&binary_topic(&topic), ordinal, &bytes[data])?,
            }
        }
        self.writer.flush()
    }

    /// MCAP's summary and end, behind all that was taken.
    pub(super) fn close<E>(&self, commits: u64, emit: impl FnMut(Vec<u8>) -> Result<(), E>) -> Result<(), E> {
        summary::write(&self.ledger, self.length, commits, 0, emit)
    }

    /// The same as in version 1: with the checksum of all bytes before it.
    pub(super) fn close_with_checksum<E>(
        &self,
        commits: u64,
        checksum: u32,
        emit: impl FnMut(Vec<u8>) -> Result<(), E>,
    ) -> Result<(), E> {
        summary::write(&self.ledger, self.length, commits, checksum, emit)
    }
}

/// What the messages of a chunk take, or somewhat more, bytes.
fn bytes_of<'m>(messages: impl Iterator<Item = (&'m ViewerTopic, &'m [u8])>) -> usize {
    const RECORD_OVERHEAD: usize = 256;
    messages.map(|(topic, data)| data.len() + topic.schema.len() + RECORD_OVERHEAD).sum()
}

fn check_size(bytes: usize, hint: &'static str) -> Result<(), EncodeError> {
    // Room for the commit, which comes last.
    const COMMIT_BYTES: usize = 64 << 10;
    if bytes + COMMIT_BYTES > CHUNK_BYTES_LIMIT { Err(EncodeError::TooLarge { bytes, hint }) } else { Ok(()) }
}

/// MCAP's writer at the start of a log, and where its bytes go.
fn writer(library: &str) -> Result<(Writer<NoSeek<Outbox>>, Outbox), McapError> {
    let outbox = Outbox::default();
    let options = options().library(library).compression(None);
    Ok((options.create(NoSeek::new(outbox.clone()))?, outbox))
}

/// The header of a message of a stage.
fn header_of(numbers: ChannelNumbers, ordinal: u64) -> MessageHeader {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    MessageHeader {
        channel_id: numbers.channel,
        sequence: sequence(ordinal),
        log_time: log_time_ns(ordinal),
        publish_time: u64::try_from(now.as_nanos()).unwrap_or(u64::MAX),
    }
}

/// MCAP's writer in the middle of a log: it knows the schemas and channels, and makes the bytes that the one before it would
/// have made.
fn writer_that_knows(ledger: &Ledger) -> Result<(Writer<NoSeek<Outbox>>, Outbox), McapError> {
    let (mut writer, outbox) = writer("")?;
    for record in ledger.schemas.values().chain(ledger.channels.values()) {
        let Some(Ok(found)) = frame::next(record, 0) else { continue };
        describe(&mut writer, &frame::parse(found.opcode, &record[found.body])?)?;
    }
    writer.flush()?;
    outbox.bytes().clear();
    Ok((writer, outbox))
}

/// Puts a schema or a channel into a chunk under the number that it has.
fn describe(writer: &mut Writer<NoSeek<Outbox>>, record: &McapRecord) -> Result<(), McapError> {
    match record {
        McapRecord::Schema { header, data } => {
            writer.add_schema_with_id(header.id, &header.name, &header.encoding, data)?;
        }
        McapRecord::Channel(channel) => {
            let (topic, encoding) = (&channel.topic, &channel.message_encoding);
            writer.add_channel_with_id(channel.id, channel.schema_id, topic, encoding, &channel.metadata)?;
        }
        _ => {}
    }
    Ok(())
}
