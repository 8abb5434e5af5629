//! Why something cannot be put into a log.

use mcap::McapError;

use super::codec::CodecError;
use super::format::{CHUNK_BYTES_LIMIT, MANIFEST_BYTES_LIMIT, REPORT_BYTES_LIMIT, SCENE_VALUES_LIMIT};

/// Why a stage cannot be encoded for a log.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EncodeError {
    /// The state has no place in a log.
    #[error("the state cannot be kept")]
    State(#[from] CodecError),
    /// More than a chunk can hold.
    #[error("the stage takes {bytes} bytes, and a chunk of a log holds {CHUNK_BYTES_LIMIT}: use a coarser mesh{hint}")]
    TooLarge {
        /// Bytes that the stage takes.
        bytes: usize,
        /// What else would help.
        hint: &'static str,
    },
    /// A message for viewers on a topic of the log's own.
    #[error("viewers' messages cannot go to {topic}, which is the log's own")]
    OwnTopic {
        /// The topic.
        topic: String,
    },
    /// A message cannot be written as JSON.
    #[error("a report cannot be written as JSON")]
    Json(#[from] serde_json::Error),
    /// A report that no reader would take.
    #[error("the report takes {bytes} bytes, and one in a log has no more than {REPORT_BYTES_LIMIT}: use fewer probes")]
    ReportTooLarge {
        /// Length of the report, bytes.
        bytes: usize,
    },
    /// A scene that no reader would take.
    #[error(
        "the scene takes {bytes} bytes with {values} values, and one in a log has no more than {MANIFEST_BYTES_LIMIT} bytes and \
         {SCENE_VALUES_LIMIT} values, so that no log takes much memory to read: use a net of fewer control points, which the mesh \
         then refines"
    )]
    SceneTooLarge {
        /// Length of the scene, bytes.
        bytes: usize,
        /// Number of values in the scene.
        values: usize,
    },
    /// The MCAP library refuses a record.
    #[error("MCAP refused a record")]
    Mcap(#[from] McapError),
}
