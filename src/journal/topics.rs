//! Topics: the log's own and those of viewers, with the schemas that other programs read their messages by.

use std::sync::{Arc, LazyLock};

use super::format::{
    BINARY_ENCODING, COMMIT_TOPIC, DISPLACEMENT_TOPIC, FINISHED_TOPIC, MESH_TOPIC, REPORT_TOPIC, STATE_TOPIC,
};
use super::message::{CommitMessage, FinishedMessage, ReportMessage, schema_of};

/// A topic that a log carries for viewers, apart from its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ViewerTopic {
    /// Name of the topic; none of the log's own.
    pub topic: String,
    /// Encoding of its messages, such as `protobuf`.
    pub message_encoding: String,
    /// Name of their schema, such as `foxglove.SceneUpdate`.
    pub schema_name: String,
    /// Encoding of the schema, such as `protobuf`.
    pub schema_encoding: String,
    /// The schema of the messages.
    pub schema: Vec<u8>,
}

/// A message for viewers on one of their topics.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ViewerMessage {
    /// The topic of the message.
    pub topic: Arc<ViewerTopic>,
    /// Its bytes, in the topic's encoding.
    pub data: Vec<u8>,
}

/// The numbers under which a topic is described.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ChannelNumbers {
    pub schema: u16,
    pub channel: u16,
}

/// The log's own topics; their schemas are made once.
pub(super) struct OwnTopics {
    pub mesh: ViewerTopic,
    pub displacement: ViewerTopic,
    pub state: ViewerTopic,
    pub report: ViewerTopic,
    pub commit: ViewerTopic,
    pub finished: ViewerTopic,
}

impl OwnTopics {
    /// The topic of this name, if it is one of them.
    pub fn named(&self, name: &str) -> Option<&ViewerTopic> {
        let Self { mesh, displacement, state, report, commit, finished } = self;
        [mesh, displacement, state, report, commit, finished].into_iter().find(|topic| topic.topic == name)
    }
}

pub(super) static OWN: LazyLock<OwnTopics> = LazyLock::new(|| OwnTopics {
    mesh: binary_topic(MESH_TOPIC),
    displacement: binary_topic(DISPLACEMENT_TOPIC),
    state: binary_topic(STATE_TOPIC),
    report: json_topic::<ReportMessage>(REPORT_TOPIC, "foldline.Report"),
    commit: json_topic::<CommitMessage>(COMMIT_TOPIC, "foldline.Commit"),
    finished: json_topic::<FinishedMessage>(FINISHED_TOPIC, "foldline.Finished"),
});

/// A topic with messages that only this program reads.
pub(super) fn binary_topic(topic: &str) -> ViewerTopic {
    ViewerTopic {
        topic: topic.to_owned(),
        message_encoding: BINARY_ENCODING.to_owned(),
        schema_name: String::new(),
        schema_encoding: String::new(),
        schema: Vec::new(),
    }
}

fn json_topic<M: schemars::JsonSchema>(topic: &str, schema_name: &str) -> ViewerTopic {
    ViewerTopic {
        topic: topic.to_owned(),
        message_encoding: "json".to_owned(),
        schema_name: schema_name.to_owned(),
        schema_encoding: "jsonschema".to_owned(),
        schema: schema_of::<M>(schema_name),
    }
}
