//! Messages for viewers as an MCAP file of their own, which is no log: no run continues from it.

use std::collections::BTreeMap;
use std::io::Cursor;

use mcap::records::MessageHeader;

use super::encode_error::EncodeError;
use super::format::VIEWERS_PROFILE;
use super::message::ReportMessage;
use super::topics::{OWN, ViewerMessage, ViewerTopic};
use crate::record::Record;

/// A file that is being made.
pub struct TimedMessages {
    writer: mcap::Writer<Cursor<Vec<u8>>>,
    /// Topics with the numbers of their channels and of the messages that they have had.
    channels: Vec<(ViewerTopic, u16, u32)>,
}

/// Why there is no such file.
#[derive(Debug, thiserror::Error)]
#[error("MCAP refuses what viewers would be shown")]
pub struct TimedMessagesError(#[from] EncodeError);

impl From<mcap::McapError> for TimedMessagesError {
    fn from(error: mcap::McapError) -> Self {
        Self(EncodeError::Mcap(error))
    }
}

impl TimedMessages {
    /// Creates a file without messages.
    ///
    /// # Errors
    /// None that a log can cause.
    pub fn new() -> Result<Self, TimedMessagesError> {
        let options = mcap::WriteOptions::new().profile(VIEWERS_PROFILE).compression(Some(mcap::Compression::Zstd));
        let writer = options.compression_threads(0).create(Cursor::new(Vec::new()))?;
        Ok(Self { writer, channels: Vec::new() })
    }

    /// Adds a message that is shown at a time, nanoseconds.
    ///
    /// # Errors
    /// Where MCAP refuses it.
    pub fn add(&mut self, time_ns: u64, message: &ViewerMessage) -> Result<(), TimedMessagesError> {
        self.write(time_ns, &message.topic, &message.data)
    }

    /// Adds the report of a stage, as logs have it.
    ///
    /// # Errors
    /// Where MCAP refuses it.
    pub fn add_report(&mut self, time_ns: u64, record: &Record) -> Result<(), TimedMessagesError> {
        let report = ReportMessage::new(record).to_json().map_err(EncodeError::from)?;
        self.write(time_ns, &OWN.report, &report)
    }

    fn write(&mut self, time_ns: u64, topic: &ViewerTopic, data: &[u8]) -> Result<(), TimedMessagesError> {
        let known = self.channels.iter().position(|(known, ..)| known == topic);
        let place = match known {
            Some(place) => place,
            None => {
                let schema = self.writer.add_schema(&topic.schema_name, &topic.schema_encoding, &topic.schema)?;
                let none = BTreeMap::new();
                let number = self.writer.add_channel(schema, &topic.topic, &topic.message_encoding, &none)?;
                self.channels.push((topic.clone(), number, 0));
                self.channels.len() - 1
            }
        };
        let (_, channel_id, sequence) = self.channels[place];
        self.channels[place].2 = sequence.wrapping_add(1);
        let header = MessageHeader { channel_id, sequence, log_time: time_ns, publish_time: time_ns };
        Ok(self.writer.write_to_known_channel(&header, data)?)
    }

    /// The bytes of the file.
    ///
    /// # Errors
    /// Where MCAP refuses to end it.
    pub fn finish(mut self) -> Result<Vec<u8>, TimedMessagesError> {
        self.writer.finish()?;
        Ok(self.writer.into_inner().into_inner())
    }
}
