//! What a log looks like: topics, encodings, versions, limits and times.
//!
//! | topic | encoding | schema | one message |
//! |---|---|---|---|
//! | `/foldline/mesh` | `foldline-bincode-v1` | none | per mesh, the first time that a state uses it |
//! | `/foldline/displacement` | `foldline-bincode-v1` | none | per field on the control points, the first time that a state has it |
//! | `/foldline/state` | `foldline-bincode-v1` | none | per stage |
//! | `/foldline/report` | `json` | `foldline.Report` | per stage |
//! | `/foldline/commit` | `json` | `foldline.Commit` | per stage, the last of its chunk |
//! | `/foldline/finished` | `json` | `foldline.Finished` | at the end of a run that reached its end |
//!
//! A state names its mesh and its fields (displacements, those of the equilibrium before, the heading of a path) by hash, so a
//! stage that changes none (indicators that mark nothing, a solve that is rejected) writes some hundred bytes and its report.
//!
//! Before the first chunk, and again wherever a run was resumed, lies a metadata record `foldline.manifest`: it
//! begins a *stretch* of the run.
//!
//! # Versions
//!
//! | version | what is new |
//! |---|---|
//! | 1 | |
//! | 2 | commits and the end name the manifest of their stretch by its hash, so that none can be lost unseen; the manifest names the revision of the numerics that wrote the stretch; a chunk may lack a state, and a mesh or displacements that no state needs, in a log that was thinned and says so in a metadata record `foldline.thinned` |
//! | 3 | a state names each of its fields by its own hash, and a commit names them all; before, the displacements and those of the equilibrium before were one |
//! | 4 | what viewers are shown of a stage lies in a packed chunk right in front of the stage's own, which names it by the hash of its bytes; before, it lay among the stage's messages; reports state what keeping the stage before took |
//!
//! A log may hold commits of several versions: one that is continued keeps those that it has.
//!
//! # What is packed
//! Messages for viewers are text, of which zstd leaves an eighth. They go into a chunk of their own with the message indexes behind it, in
//! the same write as the stage's chunk and in front of it, so that a commit still comes last. Nothing in this program unpacks it: its
//! commit names it by the hash of its bytes, and its channels are described in the commit's chunk as well. Where it is damaged or
//! not there, nothing is lost but what viewers are shown.
//!
//! What states are made of is not packed. Measured on the chunks of three runs, one by one, as they would have to be written: zstd at
//! level 1 leaves 89 %, 60 % and 48 % of a chunk of 9, 26 and 3 kB, lz4 94 %, 74 % and 61 %, and higher levels gain no more than five in
//! a hundred. What is left over are displacements, of which the last bits are noise. Chunks that have to be unpacked before they can be
//! bounded are not worth that; `foldline thin` drops nine states of ten. What states repeat is named by its hash instead.
//!
//! # Times
//! `log_time` is the place in the run, not the clock: stage k is at (k + 1) · 100 ms after 1970. A viewer then
//! plays ten stages a second, whatever a stage cost and however many nights lie between an interruption and the
//! resume, and equal runs have equal times. The clock goes into `publish_time` (nanoseconds since 1970), which nothing
//! reads back. No hash covers either.

/// Version of the layout that this module describes. A reader refuses a newer one.
pub const FORMAT_VERSION: u32 = 4;

/// Name of the MCAP profile in the header of a log.
pub const PROFILE: &str = "foldline";

/// Name of the MCAP profile in the header of a file for viewers, which is no log.
pub const VIEWERS_PROFILE: &str = "foldline-viewers";

/// Name of the metadata records that hold a manifest.
pub const MANIFEST: &str = "foldline.manifest";

/// Name of the metadata record that marks a thinned log.
pub const THINNED: &str = "foldline.thinned";

/// Name of the encoding of states and meshes: a version byte, then bincode (little endian, fixed-width integers).
pub const BINARY_ENCODING: &str = "foldline-bincode-v1";

/// Topic of the messages with meshes.
pub const MESH_TOPIC: &str = "/foldline/mesh";
/// Topic of the messages with fields on the control points.
pub const DISPLACEMENT_TOPIC: &str = "/foldline/displacement";
/// Topic of the messages with states.
pub const STATE_TOPIC: &str = "/foldline/state";
/// Topic of the messages with reports.
pub const REPORT_TOPIC: &str = "/foldline/report";
/// Topic of the messages with commits.
pub const COMMIT_TOPIC: &str = "/foldline/commit";
/// Topic of the message that ends the log of a finished run.
pub const FINISHED_TOPIC: &str = "/foldline/finished";

/// The topics of the log itself, to which no viewer may write.
pub const OWN_TOPICS: [&str; 6] =
    [MESH_TOPIC, DISPLACEMENT_TOPIC, STATE_TOPIC, REPORT_TOPIC, COMMIT_TOPIC, FINISHED_TOPIC];

/// Largest chunk that is written or read, bytes. Bounds what a damaged length can make a reader allocate; a state
/// with its mesh and the direction of its path takes 80 bytes for each control point, so this is room for half a million
/// of them.
pub const CHUNK_BYTES_LIMIT: usize = 48 << 20;

/// Most fields of a state that are read; it has two at most.
pub(super) const FIELDS_LIMIT: usize = 8;

/// Largest report that is written or read, bytes: room for some ten thousand probes. A report is kept as long as its log is
/// read, and takes up to three times its length.
pub const REPORT_BYTES_LIMIT: usize = 1 << 20;

/// Largest manifest that is written or read, bytes: room for the net of a hundred thousand control points.
pub const MANIFEST_BYTES_LIMIT: usize = crate::scene::SCENE_BYTES_LIMIT as usize;

/// Most values of a scene in a log: the parser takes 160 bytes for each, where two bytes of the text may make one.
pub(super) const SCENE_VALUES_LIMIT: usize = 350_000;

/// Most bytes of manifests that are kept of one log.
pub(super) const MANIFESTS_BYTES_LIMIT: usize = 24 << 20;

/// Largest number of a schema, and largest schema, bytes. A log has three, and one for each viewers' topic; that of Foxglove's
/// scenes takes 24 kB.
pub(super) const SCHEMAS_LIMIT: u16 = 64;
pub(super) const SCHEMA_BYTES_LIMIT: usize = 128 << 10;

/// Largest number of a channel, and largest description of one, bytes. A log has six, and one for each viewers' topic.
pub(super) const CHANNELS_LIMIT: u16 = 256;
pub(super) const CHANNEL_BYTES_LIMIT: usize = 4 << 10;

/// Distance of two stages in `log_time`.
const NANOSECONDS_PER_STAGE: u64 = 100_000_000;

/// Logging time of the stage with this ordinal, nanoseconds.
pub fn log_time_ns(ordinal: u64) -> u64 {
    ordinal.saturating_add(1).saturating_mul(NANOSECONDS_PER_STAGE)
}

/// `sequence` of the messages of the stage with this ordinal; stays at its largest value once it got there.
pub(super) fn sequence(ordinal: u64) -> u32 {
    u32::try_from(ordinal).unwrap_or(u32::MAX)
}

/// What the header of a log names as the writer.
pub(super) fn library() -> String {
    format!("foldline {} {}", env!("CARGO_PKG_VERSION"), mcap::LIBRARY_IDENTIFIER)
}
