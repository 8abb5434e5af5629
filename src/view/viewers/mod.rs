//! What viewers of MCAP draw: the deformed mesh, and what each stage did in a line. The messages are JSON, which any reader can read
//! without generated code, with Foxglove's official schemas (npm package `@foxglove/schemas` 2.1.0, MIT licence).
//!
//! | file | what |
//! |---|---|
//! | `mesh_history` | what a run adds to its log for viewers |
//! | `viewer_file` | the same from a log that has none, as a file of its own |
//! | `scene_update` | a surface as `foxglove.SceneUpdate` |
//! | `log_lines` | a stage as `foxglove.Log` |

mod log_lines;
mod mesh_history;
mod scene_update;
mod viewer_file;

use std::sync::Arc;

use serde::Serialize;

use crate::journal::{ViewerMessage, ViewerTopic};

pub use mesh_history::MeshHistory;
pub use viewer_file::{PictureError, StepTimes, ViewerFile};

/// Topic of the messages with deformed meshes.
pub const MESH_HISTORY_TOPIC: &str = "/foldline/scene";
/// Topic of the messages with lines about stages.
pub const LOG_TOPIC: &str = "/foldline/log";

const SCENE_SCHEMA: &[u8] = include_bytes!("scene_update.schema.json");
const LOG_SCHEMA: &[u8] = include_bytes!("log.schema.json");

/// The topics, whose schemas are shared by all their messages.
#[derive(Clone, Debug)]
struct Topics {
    scene: Arc<ViewerTopic>,
    log: Arc<ViewerTopic>,
}

impl Topics {
    fn new() -> Self {
        let topic = |topic: &str, schema_name: &str, schema: &[u8]| {
            Arc::new(ViewerTopic {
                topic: topic.to_string(),
                message_encoding: "json".to_string(),
                schema_name: schema_name.to_string(),
                schema_encoding: "jsonschema".to_string(),
                schema: schema.to_vec(),
            })
        };
        Self {
            scene: topic(MESH_HISTORY_TOPIC, "foxglove.SceneUpdate", SCENE_SCHEMA),
            log: topic(LOG_TOPIC, "foxglove.Log", LOG_SCHEMA),
        }
    }
}

/// A message as JSON; `None` where it is none, which a picture is no reason to stop a run for.
fn message(topic: &Arc<ViewerTopic>, content: &impl Serialize) -> Option<ViewerMessage> {
    Some(ViewerMessage { topic: topic.clone(), data: serde_json::to_vec(content).ok()? })
}

/// A time after 1970, as the schemas have it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
struct Timestamp {
    sec: u64,
    nsec: u32,
}

impl Timestamp {
    fn of_ns(ns: u64) -> Self {
        Self { sec: ns / 1_000_000_000, nsec: (ns % 1_000_000_000) as u32 }
    }
}
