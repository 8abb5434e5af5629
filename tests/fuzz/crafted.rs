//! Logs that say whatever they are told to, with every checksum, hash and seal right: what anyone can write who knows the
//! format. Tests of bounds and the fuzzing of the reader build theirs here.

use std::collections::BTreeMap;
use std::sync::Arc;

use foldline::journal::format::{
    COMMIT_TOPIC, DISPLACEMENT_TOPIC, FINISHED_TOPIC, MESH_TOPIC, REPORT_TOPIC, STATE_TOPIC,
};
use foldline::journal::message::{CommitMessage, FinishedMessage, MessageHash, seal};
use foldline::journal::{CodecError, decode_mesh, decode_state};
use foldline::record::Commit;
use foldline::scene::Stage;
use foldline::state::{Hash, Mesh};
use serde_json::Value;

/// Opcodes of MCAP's records.
pub const SCHEMA: u8 = 3;
pub const CHANNEL: u8 = 4;
pub const MESSAGE: u8 = 5;
pub const CHUNK: u8 = 6;
pub const METADATA: u8 = 12;

/// Stands for a hash that is asked for: that of what was decoded comes back in the error.
const NONE: Hash = Hash::from_bytes([0; 32]);

/// What a chunk says before its commit.
#[derive(Clone, Debug, Default)]
pub struct Said {
    /// Bytes of a mesh; that of the chunk before where there are none.
    pub mesh: Vec<u8>,
    /// Fields: the first that the state names; the others are those of the chunk before.
    pub fields: Vec<Vec<u8>>,
    /// Bytes of a state; the hashes of mesh and fields in it are put right.
    pub state: Vec<u8>,
    /// A report; the hashes in it are put right where it is an object.
    pub report: Vec<u8>,
    /// Other messages: topic and data.
    pub others: Vec<(String, Vec<u8>)>,
    /// Records of any kind before the messages.
    pub records: Vec<u8>,
}

/// A log in the making.
pub struct Crafted {
    /// The log so far.
    pub bytes: Vec<u8>,
    manifest: Hash,
    scene_hash: Hash,
    previous: Option<Commit>,
    mesh: (Hash, Option<Arc<Mesh>>),
    fields: Vec<(Hash, Vec<u8>)>,
    channels: Vec<String>,
}

/// One record: what it is, how long, and its body.
pub fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    [&[opcode][..], &(body.len() as u64).to_le_bytes(), body].concat()
}

/// A text with its length in front.
pub fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat()
}

/// The body of a channel without a schema.
pub fn channel(id: u16, topic: &str) -> Vec<u8> {
    [&id.to_le_bytes()[..], &[0, 0], &text(topic), &text("json"), &text("")].concat()
}

/// The body of a message at time 0.
pub fn message(channel: u16, data: &[u8]) -> Vec<u8> {
    [&channel.to_le_bytes()[..], &[0; 4 + 8 + 8], data].concat()
}

/// The body of an uncompressed chunk with the right checksum.
pub fn chunk(records: &[u8]) -> Vec<u8> {
    let len = (records.len() as u64).to_le_bytes();
    [&[0; 16][..], &len, &crc32(records).to_le_bytes(), &text(""), &len, records].concat()
}

/// CRC-32 as MCAP has it, byte by byte.
pub fn crc32(bytes: &[u8]) -> u32 {
    let table: [u32; 256] = std::array::from_fn(|byte| {
        (0..8).fold(byte as u32, |crc, _| if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 })
    });
    !bytes.iter().fold(!0, |crc, byte| (crc >> 8) ^ table[usize::from((crc as u8) ^ byte)])
}

impl Crafted {
    /// A log whose manifest holds this scene; nothing else in it is out of the ordinary.
    pub fn new(scene_text: &str) -> Self {
        Self::of_entries(&[("scene", scene_text)])
    }

    /// A log with these entries of the manifest, beside ordinary ones.
    pub fn of_entries(entries: &[(&str, &str)]) -> Self {
        let header = [text("foldline"), text("crafted")].concat();
        let bytes = [b"\x89MCAP0\r\n", &record(1, &header)[..]].concat();
        let mut crafted = Self {
            bytes,
            manifest: NONE,
            scene_hash: blake3::hash(b"a scene"),
            previous: None,
            mesh: (NONE, None),
            fields: Vec::new(),
            channels: Vec::new(),
        };
        crafted.manifest(entries);
        crafted
    }

    /// Another manifest.
    pub fn manifest(&mut self, entries: &[(&str, &str)]) {
        let first_ordinal = self.previous.map_or(0, |commit| commit.ordinal + 1).to_string();
        let ordinary = [
            ("format_version", "3"),
            ("program", "foldline"),
            ("program_version", "0.1.0"),
            ("scene_file", "scene.toml"),
            ("library", "crafted"),
            ("scene", ""),
            ("cpu", "x86_64"),
            ("cpu_features", "avx2 fma"),
            ("kernel", "avx2+fma"),
            ("numerics", "1"),
            ("threads", "1"),
            ("host", "somewhere"),
            ("started_unix_s", "1700000000"),
            ("first_ordinal", &first_ordinal),
        ];
        let all: BTreeMap<&str, &str> = ordinary.iter().chain(entries).copied().collect();
        let mut hasher = blake3::Hasher::new();
        hasher.update(b"foldline.manifest");
        for piece in all.iter().flat_map(|(key, value)| [key, value]) {
            hasher.update(&(piece.len() as u64).to_le_bytes()).update(piece.as_bytes());
        }
        self.manifest = hasher.finalize();
        let check = self.manifest.to_string();
        let entries = all.into_iter().chain([("check", &check[..])]);
        let map: Vec<u8> = entries.flat_map(|(key, value)| [text(key), text(value)].concat()).collect();
        let body = [&text("foldline.manifest")[..], &(map.len() as u32).to_le_bytes(), &map].concat();
        self.bytes.extend(record(METADATA, &body));
    }

    /// A commit that vouches for what a chunk says.
    pub fn commit(&mut self, stage: Stage, step: u64, said: Said) {
        let Said { mesh, fields, mut state, report, others, records } = said;
        if !mesh.is_empty() {
            self.mesh = match decode_mesh(&mesh, NONE) {
                Err(CodecError::ContentHash { found, .. }) => (found, decode_mesh(&mesh, found).ok().map(Arc::new)),
                _ => (blake3::hash(&mesh), None),
            };
        }
        let said = fields.iter().map(|field| (blake3::hash(field), field.clone()));
        self.fields = said.chain(std::mem::take(&mut self.fields)).collect();
        self.name_pieces(&mut state);
        let state_hash = match &self.mesh {
            (hash, Some(mesh)) => {
                let field = |asked| self.fields.iter().find(|(hash, _)| *hash == asked).map(|(_, field)| &field[..]);
                match decode_state(&state, field, mesh.clone(), *hash, NONE) {
                    Err(CodecError::ContentHash { found, .. }) => found,
                    _ => blake3::hash(&state),
                }
            }
            _ => blake3::hash(&state),
        };
        let parent = self.previous.map_or(NONE, |commit| commit.state_hash);
        let commit = Commit::next(self.previous.as_ref(), stage, step, self.scene_hash, parent, state_hash);
        self.previous = Some(commit);
        let report = match serde_json::from_slice(&report) {
            Ok(Value::Object(mut entries)) => {
                entries.insert("state_hash".into(), commit.state_hash.to_string().into());
                entries.insert("chain_hash".into(), commit.chain_hash.to_string().into());
                serde_json::to_vec(&entries).unwrap()
            }
            _ => report,
        };
        let fields = fields.into_iter().map(|field| (DISPLACEMENT_TOPIC, field));
        let own = [(MESH_TOPIC, mesh)].into_iter().chain(fields).chain([(STATE_TOPIC, state), (REPORT_TOPIC, report)]);
        let own = own.filter(|(_, data)| !data.is_empty()).map(|(topic, data)| (topic.to_owned(), data));
        let mut messages: Vec<(String, Vec<u8>)> = own.chain(others).collect();
        let named = messages.iter().map(|(topic, data)| MessageHash::of(topic, data)).collect();
        let fields: Vec<Hash> = self.fields.iter().map(|(hash, _)| *hash).collect();
        let message = CommitMessage::new(&commit, self.manifest, self.mesh.0, &fields, named);
        messages.push((COMMIT_TOPIC.to_owned(), seal(&message).unwrap()));
        self.chunk(records, &messages);
    }

    /// Puts the hashes right that a state names, and forgets fields that it does not.
    fn name_pieces(&mut self, state: &mut [u8]) {
        const FIRST_FIELD: usize = 1 + 32 + 8;
        if state.len() < 65 {
            return;
        }
        state[1..33].copy_from_slice(self.mesh.0.as_bytes());
        // Up to version 6 a state names one field.
        if state[0] < 7 {
            self.fields.truncate(1);
            state[33..65].copy_from_slice(self.fields.first().map_or(NONE, |(hash, _)| *hash).as_bytes());
            return;
        }
        self.fields.truncate(usize::from(state[33]));
        for ((hash, _), place) in self.fields.iter().zip(state[FIRST_FIELD..].chunks_exact_mut(32)) {
            place.copy_from_slice(hash.as_bytes());
        }
    }

    /// The end of the run.
    pub fn finish(&mut self) {
        if let Some(last) = &self.previous {
            let message = FinishedMessage::after(last, self.manifest);
            self.chunk(Vec::new(), &[(FINISHED_TOPIC.to_owned(), seal(&message).unwrap())]);
        }
    }

    /// A chunk with these records and messages, and the channels that they need.
    pub fn chunk(&mut self, mut records: Vec<u8>, messages: &[(String, Vec<u8>)]) {
        for (topic, data) in messages {
            let id = self.channels.iter().position(|known| known == topic).unwrap_or_else(|| {
                self.channels.push(topic.clone());
                records.extend(record(CHANNEL, &channel(self.channels.len() as u16, topic)));
                self.channels.len() - 1
            });
            records.extend(record(MESSAGE, &message(1 + id as u16, data)));
        }
        self.bytes.extend(record(CHUNK, &chunk(&records)));
    }
}
