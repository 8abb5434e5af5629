//! What viewers are shown of a stage, packed: a chunk of its own, which nothing in this program ever unpacks. Its commit names
//! it by the hash of its bytes.

use std::collections::BTreeMap;

use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use mcap::{Compression, McapError, Writer};

use super::outbox::{Outbox, options};
use super::topics::{ChannelNumbers, ViewerTopic};

/// zstd's level; see [`super::format`] for what others give.
const LEVEL: u32 = 3;

/// Makes packed chunks. Each packer describes a channel in the first chunk that has a message of it.
pub(super) struct Packer {
    writer: Writer<NoSeek<Outbox>>,
    outbox: Outbox,
    described: Vec<u16>,
}

impl Packer {
    pub(super) fn new() -> Result<Self, McapError> {
        let outbox = Outbox::default();
        let options = options().compression(Some(Compression::Zstd)).compression_level(LEVEL);
        let writer = options.create(NoSeek::new(outbox.clone()))?;
        // The log has its header.
        outbox.bytes().clear();
        Ok(Self { writer, outbox, described: Vec::new() })
    }

    /// Puts a message into the chunk.
    pub(super) fn message(
        &mut self,
        topic: &ViewerTopic,
        ChannelNumbers { schema, channel }: ChannelNumbers,
        header: &MessageHeader,
        data: &[u8],
    ) -> Result<(), McapError> {
        if !self.described.contains(&channel) {
            if schema != 0 {
                self.writer.add_schema_with_id(schema, &topic.schema_name, &topic.schema_encoding, &topic.schema)?;
            }
            let metadata = BTreeMap::new();
            self.writer.add_channel_with_id(channel, schema, &topic.topic, &topic.message_encoding, &metadata)?;
            self.described.push(channel);
        }
        self.writer.write_to_known_channel(header, data)
    }

    /// The chunk of the messages so far, with its message indexes.
    pub(super) fn chunk(&mut self) -> Result<Vec<u8>, McapError> {
        self.writer.flush()?;
        Ok(std::mem::take(&mut *self.outbox.bytes()))
    }
}
