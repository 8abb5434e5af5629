//! What can be wrong with the bytes of a log, and what that leaves of it.
//!
//! Each of these errors fits one line, its cause with it, because they come in lists.

use super::format::{CHUNK_BYTES_LIMIT, MANIFEST_BYTES_LIMIT, MANIFESTS_BYTES_LIMIT, REPORT_BYTES_LIMIT};
use super::frame::Kind;
use super::message::SealError;
use crate::scene::Stage;
use crate::state::Hash;

/// A place in a log that is not as it was written, and what is wrong there.
#[derive(Debug, thiserror::Error)]
#[error("at byte {at}: {damage}")]
pub struct Problem {
    /// First byte of the record that is affected.
    pub at: u64,
    /// What is wrong with it.
    pub damage: Damage,
}

/// What is wrong with a record of a log.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Damage {
    /// The file ends inside a record's first nine bytes.
    #[error("the file ends {left} bytes into a record")]
    CutPrefix {
        /// Number of bytes that are there.
        left: u64,
    },
    /// The file ends inside a record.
    #[error("the {} is {claims} bytes long, and the file ends after {left} of them", Kind(*opcode))]
    CutRecord {
        /// MCAP's code for the kind of record.
        opcode: u8,
        /// Length that the record states, bytes.
        claims: u64,
        /// Bytes of it that are there.
        left: u64,
    },
    /// Space that was reserved and never written.
    #[error("only zeros from here to the end, {left} bytes: space that was reserved and never written")]
    Zeros {
        /// Bytes to the end of the file.
        left: u64,
    },
    /// The first eight bytes are not those of an MCAP file.
    #[error("the file does not begin with the MCAP magic bytes")]
    Magic,
    /// A record where none of its kind can be.
    #[error("a {} of {bytes} bytes is where none belongs", Kind(*opcode))]
    Misplaced {
        /// MCAP's code for the kind of record.
        opcode: u8,
        /// Length of the record, bytes.
        bytes: u64,
    },
    /// A record that MCAP cannot read, or a chunk whose checksum is wrong.
    #[error("the {} cannot be read: {cause}", Kind(*opcode))]
    Unreadable {
        /// MCAP's code for the kind of record.
        opcode: u8,
        /// The error of the MCAP library.
        cause: mcap::McapError,
    },
    /// A chunk whose lengths disagree, or that is compressed otherwise than logs of this program are.
    #[error("the lengths in the chunk's header do not agree, or it is compressed in a way that foldline does not use")]
    ChunkHeader,
    /// A chunk larger than any that is written.
    #[error("the chunk has {bytes} bytes, and no chunk has more than {CHUNK_BYTES_LIMIT}")]
    ChunkTooLarge {
        /// Length of the chunk.
        bytes: u64,
    },
    /// A schema or channel unlike any that is written.
    #[error("{what} {id} takes {bytes} bytes; they are numbered up to {ids}, and none has more than {limit}")]
    Description {
        /// "schema" or "channel".
        what: &'static str,
        /// Number of the channel or schema.
        id: u16,
        /// Largest number that is allowed.
        ids: u16,
        /// Length of the description, bytes.
        bytes: usize,
        /// Largest length that is allowed, bytes.
        limit: usize,
    },
    /// A manifest larger than any that is written, or more of them than are kept.
    #[error(
        "the manifest has {bytes} bytes; none has more than {MANIFEST_BYTES_LIMIT}, and all together have no more than {MANIFESTS_BYTES_LIMIT}"
    )]
    ManifestTooLarge {
        /// Length of the manifest.
        bytes: u64,
    },
    /// A report larger than any that is written.
    #[error("the report has {bytes} bytes, and no report has more than {REPORT_BYTES_LIMIT}")]
    ReportTooLarge {
        /// Length of the report.
        bytes: u64,
    },
    /// A message of a channel that nothing before it describes.
    #[error("a message belongs to channel {channel}, which nothing before it describes")]
    UnknownChannel {
        /// Number of the channel.
        channel: u16,
    },
    /// A channel that is described twice, differently.
    #[error("channel {channel} is described twice, differently")]
    ChannelChanged {
        /// Number of the channel.
        channel: u16,
    },
    /// A chunk that is neither a commit nor the end of a run.
    #[error("the chunk holds {messages} messages and no commit")]
    NoCommit {
        /// Messages in the chunk.
        messages: usize,
    },
    /// Something behind the commit or the end of the run, in the same chunk.
    #[error("the chunk continues after its commit")]
    AfterCommit,
    /// The commit is not as it was sealed.
    #[error("the commit cannot be trusted: {0}")]
    Commit(SealError),
    /// The end of the run is not as it was sealed.
    #[error("the record of the end cannot be trusted: {0}")]
    Finished(SealError),
    /// Written in a later layout.
    #[error(
        "it is written in layout {found}, and this program reads up to {}: use a newer one",
        super::format::FORMAT_VERSION
    )]
    NewerFormat {
        /// Version of its layout.
        found: u32,
    },
    /// A chunk that does not hold the messages its commit names.
    #[error("the commit names {expected} messages, and the chunk holds {found}")]
    MessageCount {
        /// Messages that the commit names.
        expected: usize,
        /// Number of other messages in the chunk.
        found: usize,
    },
    /// A message that is not the one its commit names.
    #[error("message {index} of the chunk, on {topic}, is not the one that its commit names")]
    OtherMessage {
        /// Place in the chunk.
        index: usize,
        /// Topic of the message.
        topic: String,
    },
    /// A chunk with too few or too many messages on a topic.
    #[error("the chunk holds {found} messages on {topic}, and a commit takes {expected}")]
    TopicCount {
        /// The topic.
        topic: &'static str,
        /// How many there may be.
        expected: &'static str,
        /// Number of messages on the topic.
        found: usize,
    },
    /// A report that is no report.
    #[error("the report cannot be read: {0}")]
    Report(serde_json::Error),
    /// A report of another stage than its commit.
    #[error("the report is not about the state that the commit names")]
    OtherReport,
    /// A state on a mesh that the log does not hold up to here.
    #[error("the state is on mesh {mesh}, which the log does not hold up to here")]
    UnknownMesh {
        /// Content hash of the mesh.
        mesh: Hash,
    },
    /// Fields that are not those of the state, or more than a state can have.
    #[error("the fields in the chunk are not those that the commit names for its state")]
    OtherFields,
    /// A field that the log does not hold up to here.
    #[error("the state has a field {field} on its control points, which the log does not hold up to here")]
    UnknownField {
        /// Hash of its bytes.
        field: Hash,
    },
    /// A commit out of its order.
    #[error("commit {found} is where commit {expected} belongs")]
    OutOfOrder {
        /// Ordinal that the commit should have.
        expected: u64,
        /// Ordinal of the commit.
        found: u64,
    },
    /// A commit that does not start from the state that the one before it made.
    #[error("commit {ordinal} starts from state {found}, and the one before it made {expected}")]
    OtherParent {
        /// Ordinal of the commit.
        ordinal: u64,
        /// State that the commit before it made.
        expected: Hash,
        /// State that it starts from.
        found: Hash,
    },
    /// A commit whose chain hash does not follow from the one before it.
    #[error("commit {ordinal} has chain hash {found}, and {expected} follows from what precedes it")]
    BrokenChain {
        /// Ordinal of the commit.
        ordinal: u64,
        /// Chain hash that follows.
        expected: Hash,
        /// Chain hash that it has.
        found: Hash,
    },
    /// An end that does not belong to the commits before it.
    #[error("the record of the end is about {claims} commits, and {found} precede it")]
    OtherEnd {
        /// Commits that the record counts.
        claims: u64,
        /// Commits before it.
        found: u64,
    },
    /// A packed chunk without the commit that names it.
    #[error("the packed chunk is not the one that the commit behind it names: viewers are not shown what they were")]
    LoosePacked,
    /// Something after the end of the run.
    #[error("the log continues after the record of its end")]
    AfterEnd,
}

impl Damage {
    /// Whether this is what a writer that was cut off leaves behind.
    pub(super) fn is_cut(&self) -> bool {
        let cut = matches!(self, Damage::CutPrefix { .. } | Damage::CutRecord { .. } | Damage::Zeros { .. });
        cut || matches!(self, Damage::LoosePacked)
    }
}

/// How complete a log is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Completeness {
    /// Every commit is good, and the run reached its end.
    Finished,
    /// Every commit is good; the run was stopped between two of them.
    Unfinished,
    /// The file ends inside a record: its writer was cut off. Every commit before is good.
    Truncated {
        /// Where the good bytes end.
        at: u64,
        /// Bytes beyond, which are not used.
        dropped: u64,
    },
    /// Something before the end of the file is not as it was written. Every commit before is good.
    Damaged {
        /// Where the good bytes end.
        at: u64,
        /// Bytes beyond, which are not used.
        dropped: u64,
        /// Commits beyond that are whole but have lost their predecessor.
        later_commits: u64,
    },
}

/// A whole commit that follows a damaged part of the log, and cannot be used because the commits before it are lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaterCommit {
    /// First byte of its chunk.
    pub at: u64,
    /// Ordinal of the commit.
    pub ordinal: u64,
    /// The stage that was committed.
    pub stage: Stage,
    /// Load step of the stage.
    pub step: u64,
}
