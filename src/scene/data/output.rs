//! What is written besides the states, and the units of the scene: what changes no state.

use serde::{Deserialize, Serialize};

/// What is written besides the states; it never changes a state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// When the log is forced to disk.
    pub sync: SyncPolicy,
    /// Whether the deformed mesh is written for viewers after every stage that changes it.
    pub mesh_history: bool,
    /// The units that the numbers of the scene are in.
    #[serde(default, skip_serializing_if = "NumbersIn::is_of_keys")]
    pub units: NumbersIn,
}

/// The units that the numbers of a scene are in. Nothing is converted; what looks like a slip of unit is said for those of
/// keys alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NumbersIn {
    /// Those that the names of keys end in.
    #[default]
    Keys,
    /// Units of the scene's own that go together, as those of benchmarks without units.
    Own,
}

impl NumbersIn {
    /// Whether the units are those of the keys, which is the default.
    pub fn is_of_keys(&self) -> bool {
        *self == NumbersIn::Keys
    }
}

/// When the log is forced to disk (a process kill loses nothing that was flushed; this is for power loss).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SyncPolicy {
    /// After every stage.
    EachStage,
    /// At most once a second, and at the end.
    EachSecond,
    /// At the end only.
    AtEnd,
}
