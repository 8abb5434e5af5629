//! One chunk, opened: MCAP's checksum first, then the seal of the commit in it, then the hash of every message.

use std::collections::HashMap;
use std::ops::Range;

use mcap::records::{self, Record as McapRecord};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::damage::Damage;
use super::format::{
    CHUNK_BYTES_LIMIT, COMMIT_TOPIC, DISPLACEMENT_TOPIC, FINISHED_TOPIC, FORMAT_VERSION, MESH_TOPIC, REPORT_TOPIC,
    STATE_TOPIC,
};
use super::frame::{self, Frame, PREFIX_LEN, op};
use super::message::{CommitMessage, FinishedMessage, MessageHash, ReportMessage, unseal};

/// Bytes of a message record in front of its data: channel, sequence and two times.
pub(super) const MESSAGE_HEADER_LEN: usize = 2 + 4 + 8 + 8;

/// The channels that a log has described so far, by number.
pub(super) type Channels = HashMap<u16, records::Channel>;

/// A message where it lies.
struct Message {
    topic: String,
    data: Range<usize>,
}

/// What a chunk turned out to be; good in itself, its place in the run not yet looked at.
pub(super) enum Content {
    /// A stage.
    Commit(Box<CommitContent>),
    /// The end of the run.
    Finished(FinishedMessage),
}

/// A stage's messages.
pub(super) struct CommitContent {
    pub commit: CommitMessage,
    pub report: ReportMessage,
    /// Bytes of the state in the log, where that was not thinned out.
    pub state: Option<Range<usize>>,
    /// Bytes of the mesh in the log, where this chunk holds one.
    pub mesh: Option<Range<usize>>,
    /// Bytes of the displacements in the log, where this chunk holds them; they have the hash that the commit names.
    pub displacement: Option<Range<usize>>,
}

/// The records of a chunk, one after the other, once they were found to fill it exactly.
pub(super) fn records(bytes: &[u8], chunk: &Frame) -> Result<Vec<Frame>, Damage> {
    let within = frame::chunk_records(bytes, chunk).ok_or(Damage::ChunkHeader)?;
    let mut found = Vec::new();
    let mut at = within.start;
    while let Some(record) = frame::next(&bytes[..within.end], at) {
        let record = record.map_err(|_| Damage::ChunkHeader)?;
        at = record.body.end;
        found.push(record);
    }
    Ok(found)
}

/// Opens a chunk and checks all that can be checked without its neighbours. `channels` gains those it describes.
pub(super) fn open(bytes: &[u8], chunk: &Frame, channels: &mut Channels) -> Result<Content, Damage> {
    if chunk.body.len() > CHUNK_BYTES_LIMIT {
        return Err(Damage::ChunkTooLarge { bytes: chunk.body.len() as u64 });
    }
    // MCAP's reader subtracts the records' lengths from the chunk's without a look, so that they fill it comes first.
    let places = records(bytes, chunk)?;
    let mut described = Channels::new();
    let mut messages = Vec::new();
    let mut places = places.into_iter();
    for_each_record(&bytes[chunk.at..chunk.body.end], |opcode, data| {
        let unreadable = |cause| Damage::Unreadable { opcode, cause };
        let place = places.next().ok_or(Damage::ChunkHeader)?;
        match opcode {
            op::SCHEMA => drop(frame::parse(opcode, data).map_err(unreadable)?),
            op::CHANNEL => {
                if let McapRecord::Channel(channel) = frame::parse(opcode, data).map_err(unreadable)? {
                    let known = described.get(&channel.id).or_else(|| channels.get(&channel.id));
                    if known.is_some_and(|known| *known != channel) {
                        return Err(Damage::ChannelChanged { channel: channel.id });
                    }
                    described.insert(channel.id, channel);
                }
            }
            op::MESSAGE => {
                if let McapRecord::Message { header, .. } = frame::parse(opcode, data).map_err(unreadable)? {
                    let id = header.channel_id;
                    let channel = described.get(&id).or_else(|| channels.get(&id));
                    let topic = channel.ok_or(Damage::UnknownChannel { channel: id })?.topic.clone();
                    let start = place.at + PREFIX_LEN + MESSAGE_HEADER_LEN;
                    messages.push(Message { topic, data: start..place.body.end });
                }
            }
            opcode => return Err(Damage::Misplaced { opcode, bytes: data.len() as u64 }),
        }
        Ok(())
    })?;
    let content = content(bytes, &messages)?;
    channels.extend(described);
    Ok(content)
}

/// Runs MCAP's reader over one chunk, its checksum checked before the first record is seen.
fn for_each_record(mut left: &[u8], mut see: impl FnMut(u8, &[u8]) -> Result<(), Damage>) -> Result<(), Damage> {
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(CHUNK_BYTES_LIMIT);
    let mut reader = LinearReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event.map_err(|cause| Damage::Unreadable { opcode: op::CHUNK, cause })? {
            LinearReadEvent::ReadRequest(asked) => {
                let (given, rest) = left.split_at(asked.min(left.len()));
                reader.insert(given.len()).copy_from_slice(given);
                reader.notify_read(given.len());
                left = rest;
            }
            LinearReadEvent::Record { data, opcode } => see(opcode, data)?,
        }
    }
    Ok(())
}

/// Checks the messages of a chunk against the commit in it.
fn content(bytes: &[u8], messages: &[Message]) -> Result<Content, Damage> {
    let sealed = |message: &Message| message.topic == COMMIT_TOPIC || message.topic == FINISHED_TOPIC;
    let Some(index) = messages.iter().position(sealed) else {
        return Err(Damage::NoCommit { messages: messages.len() });
    };
    if index + 1 != messages.len() {
        return Err(Damage::AfterCommit);
    }
    let (before, last) = (&messages[..index], &messages[index]);
    let data = &bytes[last.data.clone()];
    if last.topic == FINISHED_TOPIC {
        let finished: FinishedMessage = unseal(data).map_err(Damage::Finished)?;
        known_format(finished.format)?;
        if !before.is_empty() {
            return Err(Damage::MessageCount { expected: 0, found: before.len() });
        }
        return Ok(Content::Finished(finished));
    }
    let commit: CommitMessage = unseal(data).map_err(Damage::Commit)?;
    known_format(commit.format)?;
    named_messages(bytes, before, &commit.messages)?;
    if !commit.messages.iter().any(|named| named.topic == STATE_TOPIC) {
        return Err(missing(STATE_TOPIC));
    }
    let state = one(before, STATE_TOPIC, "exactly one")?;
    let report = one(before, REPORT_TOPIC, "exactly one")?.ok_or(missing(REPORT_TOPIC))?;
    let mesh = one(before, MESH_TOPIC, "at most one")?;
    let displacement = one(before, DISPLACEMENT_TOPIC, "at most one")?;
    let named = commit.messages.iter().find(|message| message.topic == DISPLACEMENT_TOPIC);
    if named.is_some_and(|named| named.blake3 != commit.displacement_hash) {
        return Err(Damage::OtherDisplacement);
    }
    let report = ReportMessage::from_json(&bytes[report]).map_err(Damage::Report)?;
    let same_stage = (report.report.stage, report.report.step) == (commit.stage, commit.step);
    if !same_stage || report.state_hash != commit.state_hash || report.chain_hash != commit.chain_hash {
        return Err(Damage::OtherReport);
    }
    Ok(Content::Commit(Box::new(CommitContent { commit, report, state, mesh, displacement })))
}

/// Checks that the messages of a chunk are those that its commit names, in their order. States, meshes and displacements may
/// be left out.
fn named_messages(bytes: &[u8], messages: &[Message], named: &[MessageHash]) -> Result<(), Damage> {
    let may_be_left_out = |topic: &str| [STATE_TOPIC, MESH_TOPIC, DISPLACEMENT_TOPIC].contains(&topic);
    let mut expected = named.iter();
    for (index, message) in messages.iter().enumerate() {
        let found = MessageHash::of(&message.topic, &bytes[message.data.clone()]);
        let other = || Damage::OtherMessage { index, topic: message.topic.clone() };
        loop {
            let next = expected.next().ok_or_else(other)?;
            if *next == found {
                break;
            }
            if next.topic == found.topic || !may_be_left_out(&next.topic) {
                return Err(other());
            }
        }
    }
    match expected.all(|left| may_be_left_out(&left.topic)) {
        true => Ok(()),
        false => Err(Damage::MessageCount { expected: named.len(), found: messages.len() }),
    }
}

fn known_format(found: u32) -> Result<(), Damage> {
    if found > FORMAT_VERSION { Err(Damage::NewerFormat { found }) } else { Ok(()) }
}

fn missing(topic: &'static str) -> Damage {
    Damage::TopicCount { topic, expected: "exactly one", found: 0 }
}

/// The data of the only message on a topic.
fn one(messages: &[Message], topic: &'static str, expected: &'static str) -> Result<Option<Range<usize>>, Damage> {
    let mut found = messages.iter().filter(|message| message.topic == topic);
    let first = found.next().map(|message| message.data.clone());
    match found.count() {
        0 => Ok(first),
        more => Err(Damage::TopicCount { topic, expected, found: more + 1 }),
    }
}
