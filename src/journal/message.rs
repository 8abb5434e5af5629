//! The messages in JSON: the report that viewers plot, the commit that binds a chunk together, and the end of a run.
//!
//! Commit and end carry a *seal*: their last entry is the hash of every byte before it. The commit in turn holds the
//! hash of every other message of its chunk, so one good seal vouches for the whole chunk, byte for byte.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value, json};

use super::format::FORMAT_VERSION;
use crate::printable::one_line;
use crate::record::{Commit, Parameter, Reading, Record, Report, WrittenReport};
use crate::scene::Stage;
use crate::state::Hash;

/// A hash that is written as 64 lower-case hexadecimal digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HexHash(pub Hash);

impl fmt::Display for HexHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.to_hex())
    }
}

impl Serialize for HexHash {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.0.to_hex())
    }
}

impl<'de> Deserialize<'de> for HexHash {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        Hash::from_hex(&text).map(Self).map_err(D::Error::custom)
    }
}

impl JsonSchema for HexHash {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Hash".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "string", "pattern": "^[0-9a-f]{64}$" })
    }
}

/// The hash of one message of a chunk, as the commit of the chunk lists it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct MessageHash {
    /// Topic of the message.
    pub topic: String,
    /// Length of its data, bytes.
    pub bytes: u64,
    /// BLAKE3 of its data.
    pub blake3: HexHash,
}

impl MessageHash {
    /// Hashes this data on this topic.
    pub fn of(topic: &str, data: &[u8]) -> Self {
        Self::hashed(topic, data, blake3::hash(data))
    }

    /// The same where the hash of the data is known.
    pub(super) fn hashed(topic: &str, data: &[u8], hash: Hash) -> Self {
        Self { topic: topic.to_owned(), bytes: data.len() as u64, blake3: HexHash(hash) }
    }
}

/// A packed chunk, as its commit names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PackedHash {
    /// Its length with its message indexes, bytes.
    pub bytes: u64,
    /// BLAKE3 of all of them.
    pub blake3: HexHash,
}

impl PackedHash {
    /// Hashes the records of a packed chunk and its message indexes, each with the nine bytes in front of it.
    pub fn of(bytes: &[u8]) -> Self {
        Self { bytes: bytes.len() as u64, blake3: HexHash(blake3::hash(bytes)) }
    }
}

/// The message on `/foldline/commit`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct CommitMessage {
    /// Version of the log's layout.
    pub format: u32,
    /// 0 for the first stage of the run.
    pub ordinal: u64,
    /// The stage that ran.
    pub stage: Stage,
    /// Load step.
    pub step: u64,
    /// Hash of the state that the stage started from.
    pub parent_hash: HexHash,
    /// Hash of the state that the stage made.
    pub state_hash: HexHash,
    /// Hash of the parts of the scene that decide states.
    pub scene_hash: HexHash,
    /// Hash of (chain so far, scene hash, stage, state hash).
    pub chain_hash: HexHash,
    /// Hash of the mesh of the state, which this chunk or an earlier one holds.
    pub mesh_hash: HexHash,
    /// Hashes of the bytes of the state's fields, its displacements first, which this chunk or earlier ones hold; not there
    /// before version 3.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub field_hashes: Vec<HexHash>,
    /// The same of the one field that states had before version 3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement_hash: Option<HexHash>,
    /// The other messages of this chunk, in their order.
    pub messages: Vec<MessageHash>,
    /// The packed chunk right in front of this one, with the message indexes between them; not there where viewers are shown
    /// nothing, and not before version 4.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub packed: Option<PackedHash>,
    /// Hash of the manifest of the stretch that this commit belongs to; not there in version 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub manifest_hash: Option<HexHash>,
    /// Hash of all bytes before this entry.
    check: HexHash,
}

impl CommitMessage {
    /// Creates the message for a commit whose chunk holds `messages`, in the stretch whose manifest has the hash
    /// `manifest`.
    pub fn new(commit: &Commit, manifest: Hash, mesh_hash: Hash, fields: &[Hash], messages: Vec<MessageHash>) -> Self {
        Self {
            format: FORMAT_VERSION,
            ordinal: commit.ordinal,
            stage: commit.stage,
            step: commit.step,
            parent_hash: HexHash(commit.parent_hash),
            state_hash: HexHash(commit.state_hash),
            scene_hash: HexHash(commit.scene_hash),
            chain_hash: HexHash(commit.chain_hash),
            mesh_hash: HexHash(mesh_hash),
            field_hashes: fields.iter().copied().map(HexHash).collect(),
            displacement_hash: None,
            messages,
            packed: None,
            manifest_hash: Some(HexHash(manifest)),
            check: UNSEALED,
        }
    }

    /// The hashes of the encoded fields of the state.
    pub fn fields(&self) -> impl Iterator<Item = Hash> {
        self.displacement_hash.iter().chain(&self.field_hashes).map(|hash| hash.0)
    }

    /// Converts the message to a commit; its chain hash is as written, not yet computed again.
    pub fn commit(&self) -> Commit {
        Commit {
            ordinal: self.ordinal,
            stage: self.stage,
            step: self.step,
            parent_hash: self.parent_hash.0,
            state_hash: self.state_hash.0,
            scene_hash: self.scene_hash.0,
            chain_hash: self.chain_hash.0,
        }
    }
}

/// The message on `/foldline/finished`: the run reached its end.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct FinishedMessage {
    /// Version of the log's layout.
    pub format: u32,
    /// Number of commits in the log.
    pub commits: u64,
    /// Chain hash of the last commit.
    pub chain_hash: HexHash,
    /// Hash of the manifest of the last stretch; not there in version 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub manifest_hash: Option<HexHash>,
    /// Hash of all bytes before this entry.
    check: HexHash,
}

impl FinishedMessage {
    /// Creates the message for a run whose last commit is `last`, in the stretch whose manifest has the hash
    /// `manifest`.
    pub fn after(last: &Commit, manifest: Hash) -> Self {
        Self {
            format: FORMAT_VERSION,
            commits: last.ordinal + 1,
            chain_hash: HexHash(last.chain_hash),
            manifest_hash: Some(HexHash(manifest)),
            check: UNSEALED,
        }
    }
}

/// The message on `/foldline/report`: the report as it is, and what binds it to its state.
///
/// JSON has no NaN and no infinities; such a number is `null` in its place and spelt out in `not_finite`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct ReportMessage {
    /// What the stage reported.
    #[serde(flatten)]
    #[schemars(with = "WrittenReport")]
    pub report: Report,
    /// Hash of the state that the stage made.
    pub state_hash: HexHash,
    /// Chain hash of its commit.
    pub chain_hash: HexHash,
    /// Wall time of the stage, seconds.
    pub wall_s: f64,
    /// Wall time that it took to keep the stage before, seconds; not there before version 4.
    #[serde(default)]
    pub kept_s: f64,
    /// Numbers above that JSON cannot hold, as (entry, value); seldom there.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    not_finite: Vec<NotFinite>,
}

/// A number that JSON cannot hold.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
struct NotFinite {
    /// The entry that should hold it.
    entry: String,
    /// `NaN`, `inf` or `-inf`.
    value: String,
}

impl ReportMessage {
    /// Creates the message of a finished stage.
    pub fn new(record: &Record) -> Self {
        let mut message = Self {
            report: record.report.clone(),
            state_hash: HexHash(record.commit.state_hash),
            chain_hash: HexHash(record.commit.chain_hash),
            wall_s: record.wall_s,
            kept_s: record.kept_s,
            not_finite: Vec::new(),
        };
        let found = message.numbers().into_iter().filter(|(_, value)| !value.is_finite());
        message.not_finite =
            found.map(|(entry, value)| NotFinite { entry: entry.to_owned(), value: value.to_string() }).collect();
        message
    }

    /// Every number of the message that is not an integer, by name.
    fn numbers(&mut self) -> Vec<(&'static str, &mut f64)> {
        let [parameter, attempted] = match self.report.driven_by {
            Parameter::Rotation => ["rotation_deg", "attempted_rotation_deg"],
            Parameter::LoadFactor => ["load_factor", "attempted_load_factor"],
        };
        let [along_length, along_arc] = &mut self.report.largest_indicator;
        let released = self.report.energy_released_n_mm.as_mut().map(|energy| ("energy_released_n_mm", energy));
        let numbers = [
            (parameter, &mut self.report.parameter),
            (attempted, &mut self.report.attempted_parameter),
            ("moment_n_mm", &mut self.report.moment_n_mm),
            ("strain_energy_n_mm", &mut self.report.strain_energy_n_mm),
            ("work_n_mm", &mut self.report.work_n_mm),
            ("residual", &mut self.report.residual),
            ("largest_indicator[0]", along_length),
            ("largest_indicator[1]", along_arc),
            ("wall_s", &mut self.wall_s),
            ("kept_s", &mut self.kept_s),
        ];
        numbers.into_iter().chain(released).collect()
    }

    /// Writes the message as JSON.
    ///
    /// # Errors
    /// None that a report can cause; serde has no infallible way.
    pub fn to_json(&self) -> Result<Vec<u8>, serde_json::Error> {
        serde_json::to_vec(self)
    }

    /// The record of the stage, at this place in the run.
    pub fn into_record(self, commit: Commit) -> Record {
        Record { report: self.report, commit, wall_s: self.wall_s, kept_s: self.kept_s }
    }

    /// Reads the message from JSON, bit for bit as it was written. Entries that a report does not have are ignored,
    /// however long they are.
    ///
    /// # Errors
    /// Where the JSON is not a report.
    pub fn from_json(json: &[u8]) -> Result<Self, serde_json::Error> {
        #[derive(Deserialize)]
        struct Spelt {
            #[serde(default)]
            not_finite: Vec<NotFinite>,
        }
        #[derive(Deserialize)]
        struct Bound {
            state_hash: HexHash,
            chain_hash: HexHash,
            wall_s: f64,
            #[serde(default)]
            kept_s: f64,
        }
        let Spelt { not_finite } = parsed(json)?;
        let json = if not_finite.is_empty() { Cow::from(json) } else { Cow::from(without_nulls(json)) };
        // One after the other and not as one: serde would hold all entries in memory to hand them on.
        let Bound { state_hash, chain_hash, wall_s, kept_s } = parsed(&json)?;
        let report = parsed::<WrittenReport>(&json)?.into();
        let mut message = Self { report, state_hash, chain_hash, wall_s, kept_s, not_finite };
        for Reading { name, unit, .. } in &mut message.report.probes {
            *name = one_line(name).into_owned();
            *unit = one_line(unit).into_owned();
        }
        for NotFinite { entry, value } in message.not_finite.clone() {
            let number: f64 = value.parse().map_err(|_| brief(format!("{entry}: {value}")))?;
            if let Some((_, place)) = message.numbers().into_iter().find(|(name, _)| *name == entry) {
                *place = number;
            }
        }
        Ok(message)
    }
}

/// JSON with 0 where `null` stands for a number that JSON cannot hold; the caller then sets the right one.
fn without_nulls(json: &[u8]) -> Vec<u8> {
    let mut filled = json.to_vec();
    let (mut at, mut in_text) = (0, false);
    while at < filled.len() {
        match filled[at] {
            b'\\' if in_text => at += 1,
            b'"' => in_text = !in_text,
            b'n' if !in_text && filled[at..].starts_with(b"null") => filled[at..at + 4].copy_from_slice(b"0.00"),
            _ => {}
        }
        at += 1;
    }
    filled
}

/// What JSON holds, or what is wrong with it in a line.
fn parsed<'j, T: Deserialize<'j>>(json: &'j [u8]) -> Result<T, serde_json::Error> {
    serde_json::from_slice(json).map_err(|error| brief(error.to_string()))
}

/// An error that quotes no more of a log than fits a line.
fn brief(text: String) -> serde_json::Error {
    serde_json::Error::custom(in_brief(text))
}

/// The beginning of a text: as much as fits a line.
pub(super) fn in_brief(text: String) -> String {
    const LONGEST: usize = 300;
    let text = one_line(&text).into_owned();
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{} …", &text[..end]),
        None => text,
    }
}

/// The words of the record in front of a log that was thinned.
pub(super) fn kept_as(marker: &mcap::records::Metadata) -> String {
    in_brief(marker.metadata.get("kept").cloned().unwrap_or_default())
}

/// Stands where the seal will be.
const UNSEALED: HexHash = HexHash(Hash::from_bytes([0; 32]));

/// The seal's 64 digits and the two characters that end the JSON.
const SEAL_LEN: usize = 64 + 2;

/// Why a sealed message is rejected.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SealError {
    /// Too short to hold a seal.
    #[error("{bytes} bytes are too few for a sealed message")]
    Short {
        /// Length of the message.
        bytes: usize,
    },
    /// The bytes before the seal do not have the hash that it holds.
    #[error("the bytes before the seal hash to {found}, and the seal differs")]
    Broken {
        /// Hash of the bytes.
        found: Hash,
    },
    /// Sealed, but not the message that was looked for.
    #[error("the message is sealed and yet not what it should be: {0}")]
    Json(#[from] serde_json::Error),
}

fn seal_of(body: &[u8]) -> Hash {
    blake3::Hasher::new().update(b"foldline seal").update(body).finalize()
}

/// Writes a message as JSON with its seal.
///
/// # Errors
/// None that a message can cause; serde has no infallible way.
pub fn seal(message: &impl Sealed) -> Result<Vec<u8>, serde_json::Error> {
    let mut json = serde_json::to_vec(message)?;
    let body_len = json.len() - SEAL_LEN;
    let seal = seal_of(&json[..body_len]).to_hex();
    json[body_len..body_len + 64].copy_from_slice(seal.as_bytes());
    Ok(json)
}

/// Reads a sealed message and checks its seal.
///
/// # Errors
/// Where any byte is not as it was sealed.
pub fn unseal<M: Sealed>(json: &[u8]) -> Result<M, SealError> {
    let Some(body_len) = json.len().checked_sub(SEAL_LEN) else {
        return Err(SealError::Short { bytes: json.len() });
    };
    let (body, seal) = json.split_at(body_len);
    let found = seal_of(body);
    if &seal[..64] != found.to_hex().as_bytes() || &seal[64..] != b"\"}" {
        return Err(SealError::Broken { found });
    }
    Ok(parsed(json)?)
}

/// A message that is written with a seal (a hash of its other bytes) as its last entry.
pub trait Sealed: Serialize + for<'de> Deserialize<'de> {}
impl Sealed for CommitMessage {}
impl Sealed for FinishedMessage {}

/// Generates the JSON schema of a message, in the subset that viewers read: no references, and a choice of words as
/// `enum`.
pub fn schema_of<M: JsonSchema>(title: &str) -> Vec<u8> {
    let settings = schemars::generate::SchemaSettings::draft07().with(|settings| settings.inline_subschemas = true);
    let mut schema = settings.into_generator().into_root_schema_for::<M>().to_value();
    plain_choices(&mut schema);
    schema["title"] = Value::from(title);
    schema.to_string().into_bytes()
}

/// The object with the entries of all objects of a `oneOf`; an entry that is a constant in each becomes a choice.
fn one_object(schema: &Value) -> Option<Value> {
    let choices = schema.get("oneOf")?.as_array()?;
    let mut entries = Map::new();
    for choice in choices {
        for (name, entry) in choice.get("properties")?.as_object()? {
            match (entries.get_mut(name), entry.get("const")) {
                (Some(known), Some(word)) => known["enum"].as_array_mut()?.push(word.clone()),
                (None, Some(word)) => _ = entries.insert(name.clone(), json!({ "type": "string", "enum": [word] })),
                (Some(_), None) => {}
                (None, None) => _ = entries.insert(name.clone(), entry.clone()),
            }
        }
    }
    Some(json!({ "description": schema["description"], "type": "object", "properties": entries }))
}

/// Turns `oneOf` constants into one `enum` of words, and `oneOf` objects that a constant distinguishes into one object with the
/// entries of all.
fn plain_choices(schema: &mut Value) {
    if let Some(whole) = one_object(schema) {
        *schema = whole;
    }
    let words: Option<Vec<Value>> = schema.get("oneOf").and_then(Value::as_array).and_then(|choices| {
        let constant = |choice: &Value| choice.get("const").filter(|word| word.is_string()).cloned();
        choices.iter().map(constant).collect()
    });
    match schema {
        Value::Object(entries) => {
            if let Some(words) = words {
                entries.remove("oneOf");
                entries.insert("type".to_owned(), Value::from("string"));
                entries.insert("enum".to_owned(), Value::from(words));
            }
            entries.values_mut().for_each(plain_choices);
        }
        Value::Array(items) => items.iter_mut().for_each(plain_choices),
        _ => {}
    }
}
