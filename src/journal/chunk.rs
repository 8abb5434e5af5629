//! One chunk, opened: MCAP's checksum first, then the seal of the commit in it, then the hash of every message. Nothing is
//! copied, and nothing is listed by its number: what a chunk says costs no more memory than the chunk.

use std::collections::HashMap;
use std::ops::Range;

use mcap::records::{self, Record as McapRecord};

use super::damage::Damage;
use super::format::{
    CHANNEL_BYTES_LIMIT, CHANNELS_LIMIT, CHUNK_BYTES_LIMIT, COMMIT_TOPIC, DISPLACEMENT_TOPIC, FIELDS_LIMIT,
    FINISHED_TOPIC, FORMAT_VERSION, MESH_TOPIC, REPORT_BYTES_LIMIT, REPORT_TOPIC, SCHEMA_BYTES_LIMIT, SCHEMAS_LIMIT,
    STATE_TOPIC,
};
use super::frame::{self, CHUNK_HEADER_LEN, Frame, op};
use super::message::{CommitMessage, FinishedMessage, HexHash, MessageHash, ReportMessage, unseal};
use crate::state::Hash;

/// Bytes of a message record in front of its data: channel, sequence and two times.
pub(super) const MESSAGE_HEADER_LEN: usize = 2 + 4 + 8 + 8;

/// The channels that a log has described so far, by number.
pub(super) type Channels = HashMap<u16, records::Channel>;

/// A message where it lies.
struct Message<'c> {
    topic: &'c str,
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
    /// Fields in this chunk: hash, one of those that the commit names, and bytes in the log.
    pub fields: Vec<(Hash, Range<usize>)>,
}

/// The records of a chunk, one after the other, once they were found to fill it exactly. They are walked over, not listed: a
/// chunk can hold five million empty ones.
pub(super) fn records<'b>(bytes: &'b [u8], chunk: &Frame) -> Result<impl Iterator<Item = Frame> + Clone + 'b, Damage> {
    let within = frame::chunk_records(bytes, chunk).ok_or(Damage::ChunkHeader)?;
    let mut at = within.start;
    while let Some(record) = frame::next(&bytes[..within.end], at) {
        at = record.map_err(|_| Damage::ChunkHeader)?.body.end;
    }
    let mut at = within.start;
    Ok(std::iter::from_fn(move || {
        let record = frame::next(&bytes[..within.end], at)?.ok()?;
        at = record.body.end;
        Some(record)
    }))
}

/// Opens a chunk and checks all that can be checked without its neighbours. `channels` gains those it describes.
///
/// Where the chunk is damaged outside its messages, or the descriptions of its channels are lost, the commit names them;
/// that is given back as well.
pub(super) fn open(bytes: &[u8], chunk: &Frame, channels: &mut Channels) -> Result<(Content, Option<Damage>), Damage> {
    if chunk.body.len() > CHUNK_BYTES_LIMIT {
        return Err(Damage::ChunkTooLarge { bytes: chunk.body.len() as u64 });
    }
    let records = records(bytes, chunk)?;
    let described = check_crc(&bytes[chunk.body.clone()]).and_then(|()| describe(bytes, records.clone(), channels));
    let described = match described {
        Ok(described) => described,
        Err(beside) => {
            let (Damage::Unreadable { opcode: op::CHUNK, .. } | Damage::UnknownChannel { .. }) = beside else {
                return Err(beside);
            };
            let Some(Committed { messages: named, .. }) = as_committed(bytes, chunk) else { return Err(beside) };
            let messages = named.iter().map(|(topic, data)| Message { topic, data: data.clone() });
            return Ok((content(bytes, messages)?, Some(beside)));
        }
    };
    let topic = |id: u16| described.get(&id).or_else(|| channels.get(&id)).map_or("", |channel| &channel.topic[..]);
    let messages = records.filter(|record| record.opcode == op::MESSAGE).map(|record| {
        let [low, high] = [0, 1].map(|byte| bytes[record.body.start + byte]);
        Message { topic: topic(u16::from_le_bytes([low, high])), data: data_of(&record) }
    });
    let content = content(bytes, messages)?;
    channels.extend(described);
    Ok((content, None))
}

fn data_of(message: &Frame) -> Range<usize> {
    message.body.start + MESSAGE_HEADER_LEN..message.body.end
}

/// The channels that a chunk describes, once those of all its messages are known.
fn describe(bytes: &[u8], records: impl Iterator<Item = Frame>, channels: &Channels) -> Result<Channels, Damage> {
    let mut described = Channels::new();
    for record in records {
        let body = &bytes[record.body.clone()];
        let number = body.first_chunk().map(|number| u16::from_le_bytes(*number));
        match (record.opcode, number) {
            (op::SCHEMA, Some(id)) => {
                bounded("schema", id, SCHEMAS_LIMIT, body.len(), SCHEMA_BYTES_LIMIT)?;
                frame::parse(op::SCHEMA, body).map_err(unreadable(op::SCHEMA))?;
            }
            (op::CHANNEL, Some(id)) => {
                bounded("channel", id, CHANNELS_LIMIT, body.len(), CHANNEL_BYTES_LIMIT)?;
                if let McapRecord::Channel(channel) =
                    frame::parse(op::CHANNEL, body).map_err(unreadable(op::CHANNEL))?
                {
                    let known = described.get(&id).or_else(|| channels.get(&id));
                    if known.is_some_and(|known| *known != channel) {
                        return Err(Damage::ChannelChanged { channel: id });
                    }
                    described.insert(id, channel);
                }
            }
            (op::MESSAGE, Some(id)) if body.len() >= MESSAGE_HEADER_LEN => {
                if !described.contains_key(&id) && !channels.contains_key(&id) {
                    return Err(Damage::UnknownChannel { channel: id });
                }
            }
            (opcode, _) => return Err(Damage::Misplaced { opcode, bytes: body.len() as u64 }),
        }
    }
    Ok(described)
}

/// What a commit states of its chunk.
#[derive(Default)]
pub(super) struct Committed {
    /// Ordinal of the stage.
    pub ordinal: u64,
    /// Topic of every message of the chunk, and where its data lie.
    pub messages: Vec<(String, Range<usize>)>,
}

/// The messages of a chunk with the topics under which its commit, the last of them, names them by their hashes, whatever the
/// chunk states of its channels; and the ordinal of that commit. `None` where one is not as it was committed, or where a damaged
/// chunk lacks one: it may have had it.
pub(super) fn as_committed(bytes: &[u8], chunk: &Frame) -> Option<Committed> {
    let is_message = |record: &Frame| record.opcode == op::MESSAGE && record.body.len() >= MESSAGE_HEADER_LEN;
    let messages = records(bytes, chunk).ok()?.filter(is_message).map(|record| data_of(&record));
    let (place, last) = messages.clone().enumerate().last()?;
    if let Ok(end) = unseal::<FinishedMessage>(&bytes[last.clone()]) {
        let messages = vec![(FINISHED_TOPIC.to_owned(), last)];
        return (place == 0).then_some(Committed { ordinal: end.commits.saturating_sub(1), messages });
    }
    let commit: CommitMessage = unseal(&bytes[last.clone()]).ok()?;
    let mut named = commit.messages.iter();
    let mut messages_named = Vec::new();
    for data in messages.take(place) {
        let hash = HexHash(blake3::hash(&bytes[data.clone()]));
        let message = named.find(|message| message.blake3 == hash && message.bytes == data.len() as u64)?;
        messages_named.push((message.topic.clone(), data));
    }
    let is_whole = messages_named.len() == commit.messages.len() || has_its_checksum(bytes, chunk);
    messages_named.push((COMMIT_TOPIC.to_owned(), last));
    is_whole.then_some(Committed { ordinal: commit.ordinal, messages: messages_named })
}

/// Whether a chunk is as it was written as far as its checksum shows.
pub(super) fn has_its_checksum(bytes: &[u8], chunk: &Frame) -> bool {
    frame::chunk_records(bytes, chunk).is_some() && check_crc(&bytes[chunk.body.clone()]).is_ok()
}

fn unreadable(opcode: u8) -> impl Fn(mcap::McapError) -> Damage {
    move |cause| Damage::Unreadable { opcode, cause }
}

/// Holds the number and length of a description against the most that any log of this program has: what is described is kept
/// as long as the log is read.
fn bounded(what: &'static str, id: u16, ids: u16, bytes: usize, limit: usize) -> Result<(), Damage> {
    match id <= ids && bytes <= limit {
        true => Ok(()),
        false => Err(Damage::Description { what, id, ids, bytes, limit }),
    }
}

/// Checks the checksum in the header of a chunk, where there is one.
fn check_crc(body: &[u8]) -> Result<(), Damage> {
    let (header, records) = body.split_at(CHUNK_HEADER_LEN);
    let saved = u32::from_le_bytes([24, 25, 26, 27].map(|at| header[at]));
    let calculated = crc32fast::hash(records);
    match saved == 0 || saved == calculated {
        true => Ok(()),
        false => Err(unreadable(op::CHUNK)(mcap::McapError::BadChunkCrc { saved, calculated })),
    }
}

/// Checks the messages of a chunk against the commit in it.
fn content<'c>(bytes: &[u8], messages: impl Iterator<Item = Message<'c>> + Clone) -> Result<Content, Damage> {
    let sealed = |message: &Message| message.topic == COMMIT_TOPIC || message.topic == FINISHED_TOPIC;
    let Some((index, last)) = messages.clone().enumerate().find(|(_, message)| sealed(message)) else {
        return Err(Damage::NoCommit { messages: messages.count() });
    };
    if messages.clone().nth(index + 1).is_some() {
        return Err(Damage::AfterCommit);
    }
    let before = messages.take(index);
    let data = &bytes[last.data.clone()];
    if last.topic == FINISHED_TOPIC {
        let finished: FinishedMessage = unseal(data).map_err(Damage::Finished)?;
        known_format(finished.format)?;
        if index > 0 {
            return Err(Damage::MessageCount { expected: 0, found: index });
        }
        return Ok(Content::Finished(finished));
    }
    let commit: CommitMessage = unseal(data).map_err(Damage::Commit)?;
    known_format(commit.format)?;
    if commit.fields().count() > FIELDS_LIMIT {
        return Err(Damage::OtherFields);
    }
    let mut fields = Vec::new();
    named_messages(bytes, before.clone(), &commit.messages, |hash, message| {
        if message.topic != DISPLACEMENT_TOPIC {
            return Ok(());
        }
        if fields.len() == FIELDS_LIMIT || commit.fields().all(|named| named != hash) {
            return Err(Damage::OtherFields);
        }
        fields.push((hash, message.data));
        Ok(())
    })?;
    if !commit.messages.iter().any(|named| named.topic == STATE_TOPIC) {
        return Err(missing(STATE_TOPIC));
    }
    let state = one(before.clone(), STATE_TOPIC, "exactly one")?;
    let report = one(before.clone(), REPORT_TOPIC, "exactly one")?.ok_or(missing(REPORT_TOPIC))?;
    let mesh = one(before, MESH_TOPIC, "at most one")?;
    if report.len() > REPORT_BYTES_LIMIT {
        return Err(Damage::ReportTooLarge { bytes: report.len() as u64 });
    }
    let report = ReportMessage::from_json(&bytes[report]).map_err(Damage::Report)?;
    let same_stage = (report.report.stage, report.report.step) == (commit.stage, commit.step);
    if !same_stage || report.state_hash != commit.state_hash || report.chain_hash != commit.chain_hash {
        return Err(Damage::OtherReport);
    }
    Ok(Content::Commit(Box::new(CommitContent { commit, report, state, mesh, fields })))
}

/// Checks that the messages of a chunk are those that its commit names, in their order, and shows each with its hash. States,
/// meshes and fields may be left out.
fn named_messages<'c>(
    bytes: &[u8],
    messages: impl Iterator<Item = Message<'c>>,
    named: &[MessageHash],
    mut see: impl FnMut(Hash, Message<'c>) -> Result<(), Damage>,
) -> Result<(), Damage> {
    let may_be_left_out = |topic: &str| [STATE_TOPIC, MESH_TOPIC, DISPLACEMENT_TOPIC].contains(&topic);
    let mut expected = named.iter();
    let mut found = 0;
    for (index, message) in messages.enumerate() {
        let Message { topic, data } = &message;
        found += 1;
        let hash = HexHash(blake3::hash(&bytes[data.clone()]));
        let other = || Damage::OtherMessage { index, topic: (*topic).to_owned() };
        loop {
            let next = expected.next().ok_or_else(other)?;
            if next.topic == *topic && next.bytes == data.len() as u64 && next.blake3 == hash {
                break;
            }
            if next.topic == *topic && *topic != DISPLACEMENT_TOPIC || !may_be_left_out(&next.topic) {
                return Err(other());
            }
        }
        see(hash.0, message)?;
    }
    match expected.all(|left| may_be_left_out(&left.topic)) {
        true => Ok(()),
        false => Err(Damage::MessageCount { expected: named.len(), found }),
    }
}

fn known_format(found: u32) -> Result<(), Damage> {
    if found > FORMAT_VERSION { Err(Damage::NewerFormat { found }) } else { Ok(()) }
}

fn missing(topic: &'static str) -> Damage {
    Damage::TopicCount { topic, expected: "exactly one", found: 0 }
}

/// The data of the only message on a topic.
fn one<'c>(
    messages: impl Iterator<Item = Message<'c>>,
    topic: &'static str,
    expected: &'static str,
) -> Result<Option<Range<usize>>, Damage> {
    let mut found = messages.filter(|message| message.topic == topic);
    let first = found.next().map(|message| message.data);
    match found.count() {
        0 => Ok(first),
        more => Err(Damage::TopicCount { topic, expected, found: more + 1 }),
    }
}
