//! A message as bytes and back: a version byte, then bincode; and what can be wrong with them.

use serde::{Deserialize, Serialize};

use crate::journal::format::CHUNK_BYTES_LIMIT;
use crate::journal::soundness::Flaw;
use crate::state::Hash;

/// The latest version in which states are written, in front of each of them: on several patches.
pub const CODEC_VERSION: u8 = 9;
/// The version in which states on one patch are written.
pub(super) const ONE_PATCH_VERSION: u8 = 8;

/// Why bytes do not decode to a usable state or mesh.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CodecError {
    /// No bytes at all.
    #[error("the message is empty")]
    Empty,
    /// Written by a later version of the program.
    #[error("the message has encoding version {found}, and this program reads up to {CODEC_VERSION}: use a newer one")]
    Version {
        /// Version in the message.
        found: u8,
    },
    /// A version that such messages never had.
    #[error("the message has encoding version {found}, and messages of its kind have {expected}")]
    OtherVersion {
        /// Version in the message.
        found: u8,
        /// Version of the encoding of this kind of message.
        expected: u8,
    },
    /// Bytes that the encoding does not allow.
    #[error("the message does not decode")]
    Decode(#[from] bincode::error::DecodeError),
    /// Too large, or a failure of the encoder.
    #[error("the state cannot be encoded")]
    Encode(#[from] bincode::error::EncodeError),
    /// Bytes left over after decoding.
    #[error("the message holds {total} bytes of which only {used} were used")]
    LeftOver {
        /// Bytes that decoding used.
        used: usize,
        /// Bytes of the message.
        total: usize,
    },
    /// The state names another mesh than the commit.
    #[error("the state is on mesh {found}, and its commit has {expected}")]
    OtherMesh {
        /// Mesh that the commit names.
        expected: Hash,
        /// Mesh that the state names.
        found: Hash,
    },
    /// The state names a field that the log does not hold.
    #[error("the state has a field {hash} on its control points, which the log does not hold")]
    NoField {
        /// Hash of its bytes.
        hash: Hash,
    },
    /// The state names more or fewer fields than it has.
    #[error("the state names {found} fields, and it has its displacements and at most one of its course")]
    FieldCount {
        /// Number of fields that the state names.
        found: usize,
    },
    /// Decoded, but not the content that was committed.
    #[error("the {what} hashes to {found}, and its commit has {expected}")]
    ContentHash {
        /// "state" or "mesh".
        what: &'static str,
        /// Hash in the commit.
        expected: Hash,
        /// Hash of what was decoded.
        found: Hash,
    },
    /// The content that was committed, but nothing that a run could continue from.
    #[error("the content is unusable")]
    Unsound(#[from] Flaw),
}

fn config() -> impl bincode::config::Config {
    bincode::config::standard().with_little_endian().with_fixed_int_encoding().with_limit::<CHUNK_BYTES_LIMIT>()
}

pub(super) fn encode(version: u8, value: &impl Serialize) -> Result<Vec<u8>, CodecError> {
    let mut bytes = vec![version];
    bincode::serde::encode_into_std_write(value, &mut bytes, config())?;
    Ok(bytes)
}

/// What the bytes of a message of this version hold.
pub(super) fn decode<T: for<'de> Deserialize<'de>>(version: u8, bytes: &[u8]) -> Result<T, CodecError> {
    match bytes {
        [] => Err(CodecError::Empty),
        [found, body @ ..] if *found == version => {
            let (value, used) = bincode::serde::decode_from_slice(body, config())?;
            if used == body.len() {
                Ok(value)
            } else {
                Err(CodecError::LeftOver { used: used + 1, total: bytes.len() })
            }
        }
        [found @ 1..=CODEC_VERSION, ..] => Err(CodecError::OtherVersion { found: *found, expected: version }),
        [found, ..] => Err(CodecError::Version { found: *found }),
    }
}
