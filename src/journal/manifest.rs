//! Who wrote this part of a log, with what and where: a metadata record at the start and at every resume.
//!
//! A metadata record lies outside the chunks and has no checksum in MCAP, so it carries one of its own over all its
//! entries. That hash is the name by which the commits of the stretch call their manifest. A manifest that does not check
//! is lost, and never guessed at: states do not depend on it, but what the run was to compute does.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};

use super::encode_error::EncodeError;
use super::format::{FORMAT_VERSION, MANIFEST, MANIFEST_BYTES_LIMIT, SCENE_VALUES_LIMIT, library};
use crate::energy::TermSource;
use crate::printable::one_line;
use crate::record::{NUMERICS_REVISION, run_hash};
use crate::scene::{Scene, SceneError, parse_with_settings};
use crate::state::Hash;

/// The scene, program and machine of one stretch of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Manifest {
    /// Version of the log's layout.
    pub format_version: u32,
    /// Version of the program.
    pub program_version: String,
    /// Name of the scene file as the user gave it; empty where there was none.
    pub scene_file: String,
    /// The scene as the user wrote it.
    pub scene_text: String,
    /// Processor family, such as `x86_64`.
    pub cpu: String,
    /// Vector instructions that the processor has.
    pub cpu_features: Vec<String>,
    /// Build of the element kernel that ran; empty in logs that do not state it. Those for AVX2 and AVX-512 give the same
    /// bits.
    pub kernel: String,
    /// Revision of the numerics; 0 in logs that do not state it. Stretches of one revision and one kind of kernel have the same
    /// bits.
    pub numerics: u32,
    /// Threads that the run used.
    pub threads: usize,
    /// Name of the machine; empty where it is not known.
    pub host: String,
    /// When this stretch began, seconds since 1970.
    pub started_unix_s: u64,
    /// Ordinal of the first stage of this stretch.
    pub first_ordinal: u64,
    /// Whether the scene reads as in the stretch before.
    pub same_scene: bool,
    /// Terms of the caller's own that the run was made with: name and hash, in their order.
    pub own_terms: Vec<(String, String)>,
}

/// Why a metadata record cannot be read as a manifest.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ManifestError {
    /// An entry is not there.
    #[error("the manifest has no entry `{key}`")]
    Missing {
        /// Name of the entry.
        key: &'static str,
    },
    /// An entry is not what it should be.
    #[error("the manifest's entry `{key}` is `{value}`, which is not a number")]
    NotANumber {
        /// Name of the entry.
        key: &'static str,
        /// Value of the entry.
        value: String,
    },
    /// Some entry has changed since it was written.
    #[error("the manifest's entries do not have the hash that it carries")]
    Check,
}

/// Why the text in a manifest cannot be read as a scene.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneInLogError {
    /// It names another file.
    #[error(
        "the scene in the log names a file for its geometry: logs hold theirs whole, and no file is opened for one"
    )]
    NamesAFile,
    /// More than a scene's text that a log holds may have.
    #[error("the scene in the log has more values than any that is written, {SCENE_VALUES_LIMIT}")]
    TooManyValues,
    /// The text is rejected as a scene.
    #[error("the scene in the log does not read")]
    Wrong(#[from] Box<SceneError>),
}

fn own_terms(entries: &BTreeMap<String, String>) -> Vec<(String, String)> {
    let terms = entries.iter().filter(|(key, _)| key.starts_with(OWN_TERM));
    let parts = terms.map(|(_, value)| value.split_once(' ').unwrap_or((value, "")));
    parts.map(|(hash, name)| (one_line(name).into_owned(), one_line(hash).into_owned())).collect()
}

impl Manifest {
    /// Creates a manifest of this program on this machine, with the present time.
    pub fn here(scene_file: &Path, scene_text: &str, threads: usize) -> Self {
        Self {
            format_version: FORMAT_VERSION,
            program_version: env!("CARGO_PKG_VERSION").to_owned(),
            scene_file: scene_file.display().to_string(),
            scene_text: scene_text.to_owned(),
            cpu: std::env::consts::ARCH.to_owned(),
            cpu_features: cpu_features().iter().map(|&name| name.to_owned()).collect(),
            kernel: crate::energy::kernel_name().to_owned(),
            numerics: NUMERICS_REVISION,
            threads,
            host: host(),
            started_unix_s: SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs()),
            first_ordinal: 0,
            same_scene: false,
            own_terms: Vec::new(),
        }
    }

    /// Adds the terms of the caller's own that the run is made with.
    pub fn with_terms(self, own: &[Arc<dyn TermSource>]) -> Self {
        let own_terms = own.iter().map(|source| (source.name().to_owned(), source.hash().to_string())).collect();
        Self { own_terms, ..self }
    }

    /// Hash of all that decides the results of this stretch, as its commits name it; `None` where the scene cannot be
    /// read.
    pub fn run_hash(&self) -> Option<Hash> {
        let hash = |hash: &str| Hash::from_hex(hash).ok();
        let terms: Option<Vec<_>> = self.own_terms.iter().map(|(name, of)| Some((&name[..], hash(of)?))).collect();
        Some(run_hash(&self.scene(&[]).ok()?, &terms?))
    }

    /// Whether both stretches were written by machines that compute alike, as far as manifests show.
    pub fn same_machine(&self, other: &Self) -> bool {
        (&self.host, &self.cpu, &self.cpu_features) == (&other.host, &other.cpu, &other.cpu_features)
    }

    /// Why this stretch may round differently from `before`, in words; `None` where both round alike, on whatever
    /// machines.
    pub fn rounds_otherwise(&self, before: &Self) -> Option<String> {
        let kernels = [before, self].map(|manifest| KernelClass::of(&manifest.kernel));
        let [was, is] = [before, self].map(|manifest| {
            let Self { kernel, cpu, .. } = manifest;
            if kernel.is_empty() {
                format!("a kernel for {cpu} that the log does not name")
            } else {
                format!("kernel {kernel}")
            }
        });
        if kernels[0] != kernels[1] || (kernels[0] == KernelClass::Unknown && !self.same_machine(before)) {
            return Some(format!("another kernel: {was} before, {is} now"));
        }
        match (before.numerics, self.numerics) {
            (was, is) if was == is => None,
            (0, is) => Some(format!(
                "another revision of the numerics may have written it: the log does not state which, this is {is}"
            )),
            (was, is) => Some(format!("another revision of the numerics: {was} before, {is} now")),
        }
    }

    /// Parses the scene, with settings applied to it. A scene that names a file was not written by this program, and no
    /// file is opened.
    ///
    /// # Errors
    /// Where it is no scene, in the words of the parser.
    pub fn scene(&self, settings: &[String]) -> Result<Scene, SceneInLogError> {
        if values(&self.scene_text) > SCENE_VALUES_LIMIT {
            return Err(SceneInLogError::TooManyValues);
        }
        let names_a_file = |text: &str| {
            let scene = text.parse::<toml::Table>();
            scene.is_ok_and(|scene| scene.get("geometry").is_some_and(|geometry| geometry.get("file").is_some()))
        };
        // Most have no such word; they are not parsed twice.
        if self.scene_text.contains("file") && names_a_file(&self.scene_text) {
            return Err(SceneInLogError::NamesAFile);
        }
        Ok(parse_with_settings(&self.scene_text, "the scene in the log", settings).map_err(Box::new)?)
    }

    /// Checks that the manifest is not too large for a log.
    ///
    /// # Errors
    /// Where the scene is larger than any that a reader takes.
    pub fn check_size(&self) -> Result<(), EncodeError> {
        let record = self.to_record();
        let bytes: usize = record.metadata.iter().map(|(key, value)| key.len() + value.len() + 8).sum();
        let values = values(&self.scene_text);
        match bytes <= MANIFEST_BYTES_LIMIT - 64 && values <= SCENE_VALUES_LIMIT {
            true => Ok(()),
            false => Err(EncodeError::SceneTooLarge { bytes, values }),
        }
    }

    /// The name of this manifest in the commits of its stretch.
    pub(super) fn hash(&self) -> Hash {
        check(&self.entries())
    }

    pub(super) fn to_record(&self) -> mcap::records::Metadata {
        let mut entries = self.entries();
        let check = check(&entries);
        entries.insert(CHECK.to_owned(), check.to_string());
        mcap::records::Metadata { name: MANIFEST.to_owned(), metadata: entries }
    }

    /// All entries but the hash over them.
    fn entries(&self) -> BTreeMap<String, String> {
        let mut entries = BTreeMap::from(
            [
                ("format_version", self.format_version.to_string()),
                ("program", "foldline".to_owned()),
                ("program_version", self.program_version.clone()),
                ("scene_file", self.scene_file.clone()),
                (LIBRARY, library()),
                ("scene", self.scene_text.clone()),
                ("cpu", self.cpu.clone()),
                ("cpu_features", self.cpu_features.join(" ")),
                ("kernel", self.kernel.clone()),
                ("numerics", self.numerics.to_string()),
                ("threads", self.threads.to_string()),
                ("host", self.host.clone()),
                ("started_unix_s", self.started_unix_s.to_string()),
                ("first_ordinal", self.first_ordinal.to_string()),
            ]
            .map(|(key, value)| (key.to_owned(), value)),
        );
        if self.first_ordinal > 0 || self.same_scene {
            let what = if self.same_scene { SAME_SCENE } else { "another scene" };
            entries.insert(AGAIN.to_owned(), what.to_owned());
        }
        for (place, (name, hash)) in self.own_terms.iter().enumerate() {
            entries.insert(format!("{OWN_TERM}{place:04}"), format!("{hash} {name}"));
        }
        entries
    }

    /// The manifest that a record holds, and its name in the commits of its stretch.
    pub(super) fn from_record(record: &mcap::records::Metadata) -> Result<(Self, Hash), ManifestError> {
        let text = |key: &'static str| record.metadata.get(key).cloned().ok_or(ManifestError::Missing { key });
        fn number<N: std::str::FromStr>(key: &'static str, value: String) -> Result<N, ManifestError> {
            value.parse().map_err(|_| ManifestError::NotANumber { key, value })
        }
        let name = check(&record.metadata);
        if text(CHECK)? != name.to_string() {
            return Err(ManifestError::Check);
        }
        // All but the scene is shown in lines.
        let line = |key: &'static str| text(key).map(|text| one_line(&text).into_owned());
        let manifest = Self {
            format_version: number("format_version", text("format_version")?)?,
            program_version: line("program_version")?,
            scene_file: line("scene_file")?,
            scene_text: text("scene")?,
            cpu: line("cpu")?,
            cpu_features: text("cpu_features")?.split_whitespace().map(|name| one_line(name).into_owned()).collect(),
            kernel: line("kernel").unwrap_or_default(),
            numerics: number("numerics", record.metadata.get("numerics").cloned().unwrap_or("0".to_owned()))?,
            threads: number("threads", text("threads")?)?,
            host: line("host")?,
            started_unix_s: number("started_unix_s", text("started_unix_s")?)?,
            first_ordinal: number("first_ordinal", text("first_ordinal")?)?,
            same_scene: record.metadata.get(AGAIN).is_some_and(|what| what == SAME_SCENE),
            own_terms: own_terms(&record.metadata),
        };
        Ok((manifest, name))
    }
}

/// Values of a scene, or somewhat more: what may begin one is counted.
fn values(scene_text: &str) -> usize {
    scene_text.bytes().filter(|byte| b",=[{".contains(byte)).count()
}

/// Fewer bytes than any manifest takes: its name and those of its entries, and the hash. A gap that is shorter held none.
pub(super) const MANIFEST_LEN_AT_LEAST: usize = 256;

/// Entry with what the program puts into the header of a log, which has no checksum of its own.
pub(super) const LIBRARY: &str = "library";

/// What the entries of terms of the caller's own begin with; their number in the order of the terms follows.
const OWN_TERM: &str = "own_term_";

/// Entry of a stretch that is not the first. It comes first in the record, so that even a torn one shows whether its scene was
/// that of the stretch before.
const AGAIN: &str = "again";
const SAME_SCENE: &str = "same scene";

/// Whether a torn manifest is one of a stretch with the scene of the stretch before: that it is lost costs nothing.
pub(super) fn begins_with_same_scene(bytes: &[u8]) -> bool {
    let text = |text: &str| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
    let entry = [text(AGAIN), text(SAME_SCENE)].concat();
    bytes
        .get(..MANIFEST_LEN_AT_LEAST.min(bytes.len()))
        .is_some_and(|head| head.windows(entry.len()).any(|it| it == entry))
}

/// Whether bytes that cannot be read hold a piece of a manifest: the name of an entry that nothing else in a log has.
pub(super) fn has_piece_of_manifest(bytes: &[u8]) -> bool {
    const NAMES: [&[u8]; 4] = [b"started_unix_s", b"cpu_features", b"first_ordinal", b"format_version"];
    NAMES.iter().any(|name| bytes.windows(name.len()).any(|window| window == *name))
}

/// Kernels that give the same bits.
#[derive(Clone, Copy, PartialEq, Eq)]
enum KernelClass {
    Portable,
    /// Those with fused multiply-add, for AVX2 and AVX-512.
    Fused,
    Unknown,
}

impl KernelClass {
    fn of(name: &str) -> Self {
        match name {
            "portable" => Self::Portable,
            "avx2+fma" | "avx512" => Self::Fused,
            _ => Self::Unknown,
        }
    }
}

const CHECK: &str = "check";

/// Hash over all entries but the hash itself, in the order of their names, each text with its length in front.
fn check(entries: &BTreeMap<String, String>) -> Hash {
    let mut hasher = blake3::Hasher::new();
    hasher.update(MANIFEST.as_bytes());
    for (key, value) in entries.iter().filter(|(key, _)| *key != CHECK) {
        for text in [key, value] {
            hasher.update(&(text.len() as u64).to_le_bytes());
            hasher.update(text.as_bytes());
        }
    }
    hasher.finalize()
}

fn cpu_features() -> Vec<&'static str> {
    #[cfg(target_arch = "x86_64")]
    let known = [
        ("sse4.2", std::arch::is_x86_feature_detected!("sse4.2")),
        ("avx", std::arch::is_x86_feature_detected!("avx")),
        ("avx2", std::arch::is_x86_feature_detected!("avx2")),
        ("fma", std::arch::is_x86_feature_detected!("fma")),
        ("avx512f", std::arch::is_x86_feature_detected!("avx512f")),
    ];
    #[cfg(not(target_arch = "x86_64"))]
    let known: [(&str, bool); 0] = [];
    known.into_iter().filter(|(_, present)| *present).map(|(name, _)| name).collect()
}

/// Name of this machine; empty where it has none.
pub(crate) fn host() -> String {
    let from_system = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let name = from_system.or_else(|| std::env::var("HOSTNAME").ok()).or_else(|| std::env::var("COMPUTERNAME").ok());
    name.unwrap_or_default().trim().to_owned()
}
