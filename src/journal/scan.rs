//! The walk over the bytes of a log: every record, every chunk opened, every commit compared with the one before it.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use mcap::records::Record as McapRecord;

use super::checkpoint::Checkpoint;
use super::chunk::{self, Channels, CommitContent, Content};
use super::damage::{Damage, LaterCommit, Problem};
use super::format::{
    CHUNK_BYTES_LIMIT, FORMAT_VERSION, MANIFEST, MANIFEST_BYTES_LIMIT, MANIFESTS_BYTES_LIMIT, PROFILE, THINNED,
};
use super::frame::{self, Cut, Frame, PREFIX_LEN, op};
use super::log::{Entry, Kept, Note, Part};
use super::manifest::{LIBRARY, Manifest};
use super::message::{FinishedMessage, PackedHash, in_brief, kept_as};
use super::stretch::Stretches;
use crate::record::Commit;
use crate::state::Hash;

/// Problems and notes that are listed one by one; a file of another kind under a log's name could have any number.
const PROBLEMS_LIMIT: usize = 1000;

/// Times its length that a log is parsed at most for manifests that turn out to be none: what looks like one may lie in
/// another, and that in a third.
const PARSED_IN_VAIN: usize = 4;

/// Largest header, bytes: it names a profile and a program.
const HEADER_BYTES_LIMIT: usize = 4 << 10;

/// The state of a scan. Places in `entries`, `parts`, `meshes` and `fields` count from the first byte that is scanned,
/// those in the report from the start of the file.
#[derive(Default)]
pub(super) struct Scan {
    /// Place of the first byte in the file.
    base: u64,
    /// Where reading continues from, other than the start of the file.
    from: Option<(u64, Hash)>,
    channels: Channels,
    pub header: Option<(String, String)>,
    pub thinned: Option<String>,
    pub stretches: Stretches,
    pub manifest_seen: bool,
    pub entries: Vec<Entry>,
    pub meshes: HashMap<Hash, Range<usize>>,
    pub fields: HashMap<Hash, Range<usize>>,
    pub parts: Vec<Part>,
    pub finished: Option<FinishedMessage>,
    pub closed: bool,
    pub good_end: usize,
    /// Where a new stretch would begin: behind the last commit or manifest and its indexes.
    pub stretch_end: usize,
    pub problems: Vec<Problem>,
    pub later: Vec<LaterCommit>,
    later_seen: HashSet<u64>,
    pub notes: Vec<Note>,
    pub newer_format: Option<u32>,
    /// Where the zeros begin that the bytes end with.
    content_end: usize,
    /// Bytes of records that were parsed without success.
    in_vain: usize,
    /// Bytes of the manifests that are kept.
    manifests_bytes: usize,
    /// A packed chunk with its message indexes, whose commit has not come yet.
    packed: Option<Range<usize>>,
}

impl Scan {
    /// Starts a scan at a commit in the middle of a log; `bytes` are those from there on, and `meshes` and `fields`
    /// locate the earlier ones.
    pub fn from(checkpoint: &Checkpoint) -> Self {
        Self {
            base: checkpoint.at,
            from: Some((checkpoint.ordinal, checkpoint.chain_hash)),
            channels: checkpoint.channels.clone(),
            header: Some((PROFILE.to_owned(), checkpoint.library.clone())),
            stretches: checkpoint.stretches.clone(),
            thinned: checkpoint.thinned.clone(),
            ..Self::default()
        }
    }

    /// Scans the bytes. Where more bytes follow in the file (`more_follows`), a record that they cut off is no damage.
    pub fn run(&mut self, bytes: &[u8], more_follows: bool) {
        let mut at = 0;
        self.content_end = bytes.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
        if self.from.is_none() {
            if !bytes.starts_with(mcap::MAGIC) {
                self.note(0, Damage::Magic.to_string());
            }
            at = mcap::MAGIC.len();
        }
        self.good_end = at.min(bytes.len());
        self.stretch_end = self.good_end;
        while let Some(next) = frame::next(bytes, at) {
            if more_follows && next.is_err() {
                break;
            }
            let outcome = match &next {
                Ok(frame) => self.frame(bytes, frame),
                Err(Cut { claim: None, left }) => Err(Damage::CutPrefix { left: *left as u64 }),
                Err(Cut { claim: Some((opcode, claims)), left }) => {
                    let left = left.saturating_sub(PREFIX_LEN) as u64;
                    Err(Damage::CutRecord { opcode: *opcode, claims: *claims, left })
                }
            };
            let following = match (outcome, next) {
                (Ok(()), Ok(frame)) => {
                    if !self.has_lost() && self.packed.is_none() {
                        self.good_end = frame.body.end;
                        if self.finished.is_none() && !self.closed {
                            self.stretch_end = frame.body.end;
                        }
                    }
                    match self.closed {
                        true if more_follows => None,
                        true => frame::find(bytes, frame.body.end),
                        false => Some(frame.body.end),
                    }
                }
                (Err(damage), next) => {
                    let only_zeros = at >= self.content_end;
                    let damage = if only_zeros { Damage::Zeros { left: (bytes.len() - at) as u64 } } else { damage };
                    let is_cut = damage.is_cut();
                    self.problem(at, damage);
                    // A chunk keeps its place even where its content is damaged; all else may have lost the step.
                    match next {
                        Ok(frame) if frame::is_chunk(bytes, &frame) => Some(frame.body.end),
                        _ => {
                            let following = frame::find(bytes, at + 1);
                            if !only_zeros && !self.closed {
                                let place = self.place(at);
                                self.stretches.gap(place, &bytes[at..following.unwrap_or(bytes.len())], is_cut);
                            }
                            following
                        }
                    }
                }
                (Ok(()), Err(_)) => None,
            };
            match following {
                Some(following) => at = following,
                None => break,
            }
        }
        let good = self.commits();
        if !more_follows || self.closed {
            if let Some(packed) = self.packed.take().filter(|_| !self.has_lost()) {
                self.problem(packed.start, Damage::LoosePacked);
            }
            self.stretches.end(good, self.problems.last().map(|problem| problem.at));
            if let Some(at) = self.stretches.unused {
                let text = "the log ends in a manifest that cannot be read: no stage was run under it, and what it demanded is not \
                            known; the scene before it holds";
                self.note(at, text.to_owned());
            }
        }
        self.later.retain(|commit| commit.ordinal >= good);
    }

    /// A place in the file.
    fn place(&self, at: usize) -> u64 {
        self.base + at as u64
    }

    /// Good commits so far, with those before the first that is read.
    fn commits(&self) -> u64 {
        self.from.map_or(0, |(ordinal, _)| ordinal) + self.entries.len() as u64
    }

    /// Whether something behind the last good record is not as it was written.
    fn has_lost(&self) -> bool {
        self.problems.last().is_some_and(|problem| problem.at >= self.place(self.good_end))
    }

    fn problem(&mut self, at: usize, damage: Damage) {
        // Beyond the limit the newest takes the place of the one before it, so that the last one is always there.
        self.problems.truncate(PROBLEMS_LIMIT - 1);
        let at = self.place(at);
        self.problems.push(Problem { at, damage });
    }

    fn note(&mut self, at: u64, text: String) {
        self.notes.truncate(PROBLEMS_LIMIT - 1);
        self.notes.push(Note { at, text });
    }

    fn frame(&mut self, bytes: &[u8], frame: &Frame) -> Result<(), Damage> {
        let body = &bytes[frame.body.clone()];
        let misplaced = || Err(Damage::Misplaced { opcode: frame.opcode, bytes: body.len() as u64 });
        let parse = || {
            let unreadable = |cause| Damage::Unreadable { opcode: frame.opcode, cause };
            frame::parse(frame.opcode, body).map_err(unreadable)
        };
        match frame.opcode {
            op::HEADER if self.base == 0 && frame.at == mcap::MAGIC.len() && body.len() <= HEADER_BYTES_LIMIT => {
                if let McapRecord::Header(header) = parse()? {
                    self.header = Some((header.profile, header.library));
                }
                Ok(())
            }
            op::METADATA if frame.body.end > self.content_end => {
                let left = self.content_end.saturating_sub(frame.body.start) as u64;
                Err(Damage::CutRecord { opcode: frame.opcode, claims: body.len() as u64, left })
            }
            op::METADATA => {
                if body.len() > MANIFEST_BYTES_LIMIT || self.manifests_bytes + body.len() > MANIFESTS_BYTES_LIMIT {
                    return Err(Damage::ManifestTooLarge { bytes: body.len() as u64 });
                }
                if self.in_vain > PARSED_IN_VAIN * bytes.len() {
                    return misplaced();
                }
                self.in_vain += body.len();
                match parse() {
                    Ok(McapRecord::Metadata(record)) => {
                        self.in_vain -= body.len();
                        self.metadata(frame, &record);
                    }
                    // Its length is right, so that nothing but its content is lost.
                    Err(damage) if is_before_another(bytes, frame) && frame::name(body) == Some(MANIFEST) => {
                        self.stretches.suspect_alone(self.place(frame.at));
                        self.note(self.place(frame.at), format!("{damage}; it is left out"));
                    }
                    parsed => drop(parsed?),
                }
                Ok(())
            }
            op::CHUNK if frame::packed_content(bytes, frame).is_some() => {
                if body.len() > CHUNK_BYTES_LIMIT {
                    return Err(Damage::ChunkTooLarge { bytes: body.len() as u64 });
                }
                if let Some(loose) = self.packed.replace(frame.at..frame.body.end) {
                    self.problem(loose.start, Damage::LoosePacked);
                }
                Ok(())
            }
            op::CHUNK => self.chunk(bytes, frame),
            op::MESSAGE_INDEX if is_message_index(body) => {
                if let Some(packed) = self.packed.as_mut().filter(|packed| packed.end == frame.at) {
                    packed.end = frame.body.end;
                }
                Ok(())
            }
            op::DATA_END if body.len() == 4 => {
                self.closed = true;
                Ok(())
            }
            _ => misplaced(),
        }
    }

    fn metadata(&mut self, frame: &Frame, record: &mcap::records::Metadata) {
        match Manifest::from_record(record) {
            Ok((manifest, hash)) => {
                self.manifests_bytes += frame.body.len();
                if manifest.format_version > FORMAT_VERSION {
                    self.newer_format = Some(manifest.format_version);
                }
                self.manifest_seen = true;
                let (header, named) = (self.header.as_ref().map(|(_, library)| library), record.metadata.get(LIBRARY));
                if manifest.first_ordinal == 0 && named.is_some() && header != named {
                    let text = "the header does not name the program that the manifest names";
                    self.note(mcap::MAGIC.len() as u64, text.to_owned());
                }
                // Behind a loss it speaks of commits that are not used.
                if manifest.first_ordinal == self.commits() {
                    self.parts.push(Part { at: frame.at, end: frame.body.end, kept: Kept::Manifest });
                    self.stretches.begin(manifest, hash);
                } else {
                    self.stretches.begin_later(self.place(frame.at), manifest, hash);
                }
            }
            Err(_) if record.name == THINNED => {
                self.parts.push(Part { at: frame.at, end: frame.body.end, kept: Kept::Marker });
                self.thinned = Some(kept_as(record));
            }
            Err(error) if record.name == MANIFEST => {
                self.stretches.suspect_alone(self.place(frame.at));
                self.note(self.place(frame.at), format!("{}; it is left out", in_brief(error.to_string())));
            }
            Err(_) => {
                let name = in_brief(format!("{:?}", record.name));
                self.note(self.place(frame.at), format!("metadata {name} is not foldline's; it is left out"));
            }
        }
    }

    /// Takes a chunk if it follows from what was taken before, whatever lies in between.
    fn chunk(&mut self, bytes: &[u8], frame: &Frame) -> Result<(), Damage> {
        let (content, beside) = chunk::open(bytes, frame, &mut self.channels)?;
        let packed = self.packed.take();
        let named = match &content {
            Content::Commit(content) => content.commit.packed,
            Content::Finished(_) => None,
        };
        let is_named = |packed: &Range<usize>| {
            packed.end == frame.at && named.is_some_and(|named| named == PackedHash::of(&bytes[packed.clone()]))
        };
        // Pictures may be lost without a loss of what they show.
        let (packed, loose) = (packed.clone().filter(is_named), packed.filter(|packed| !is_named(packed)));
        let at = packed.map_or(frame.at, |packed| packed.start);
        let kept = match content {
            Content::Commit(content) => {
                let (ordinal, stage, step) = (content.commit.ordinal, content.commit.stage, content.commit.step);
                let manifest = content.commit.manifest_hash.map(|hash| hash.0);
                if let Err(damage) = self.commit(at..frame.body.end, *content) {
                    self.stretches.of_later_commit(self.place(frame.at), manifest);
                    if self.later_seen.insert(ordinal) {
                        let at = self.place(frame.at);
                        self.later.push(LaterCommit { at, ordinal, stage, step });
                    }
                    // Behind a loss it goes without saying that the chain is broken.
                    if !self.has_lost() {
                        return Err(damage);
                    }
                    self.beside(frame.at, beside);
                    return Ok(());
                }
                Kept::Commit
            }
            Content::Finished(finished) => {
                let last = self.entries.last().map(|entry| entry.record.commit.chain_hash);
                let found = self.commits();
                if finished.commits != found || Some(finished.chain_hash.0) != last {
                    let damage = Damage::OtherEnd { claims: finished.commits, found };
                    return if self.has_lost() { Ok(()) } else { Err(damage) };
                }
                self.stretches.of_commit(self.place(frame.at), found, finished.manifest_hash.map(|hash| hash.0));
                self.finished = Some(finished);
                Kept::Finished
            }
        };
        self.good_end = frame.body.end;
        self.parts.push(Part { at, end: frame.body.end, kept });
        if let Some(loose) = loose {
            self.problem(loose.start, Damage::LoosePacked);
        }
        self.beside(frame.at, beside);
        Ok(())
    }

    /// Damage of a chunk outside its messages; that channels are not described is reported once.
    fn beside(&mut self, at: usize, beside: Option<Damage>) {
        let is_told = |problem: &Problem| matches!(problem.damage, Damage::UnknownChannel { .. });
        let again = matches!(beside, Some(Damage::UnknownChannel { .. })) && self.problems.iter().any(is_told);
        if let Some(beside) = beside.filter(|_| !again) {
            self.problem(at, beside);
        }
    }

    /// Compares a commit, whose chunks lie at `place`, with the one before it, and keeps it.
    fn commit(&mut self, place: Range<usize>, content: CommitContent) -> Result<(), Damage> {
        if self.finished.is_some() {
            return Err(Damage::AfterEnd);
        }
        let previous = self.entries.last().map(|entry| entry.record.commit);
        let commit = content.commit.commit();
        let ordinal = commit.ordinal;
        let expected = self.commits();
        if ordinal != expected {
            return Err(Damage::OutOfOrder { expected, found: ordinal });
        }
        let parent = previous.map_or(commit.parent_hash, |previous| previous.state_hash);
        if commit.parent_hash != parent {
            return Err(Damage::OtherParent { ordinal, expected: parent, found: commit.parent_hash });
        }
        let (stage, step, scene) = (commit.stage, commit.step, commit.scene_hash);
        let expected = match (previous, self.from) {
            (None, Some((_, chain_hash))) => chain_hash,
            _ => Commit::next(previous.as_ref(), stage, step, scene, parent, commit.state_hash).chain_hash,
        };
        if commit.chain_hash != expected {
            return Err(Damage::BrokenChain { ordinal, expected, found: commit.chain_hash });
        }
        let mesh_hash = content.commit.mesh_hash.0;
        let fields: Box<[Hash]> = content.commit.fields().collect();
        let has_state = content.state.is_some();
        if has_state && content.mesh.is_none() && !self.meshes.contains_key(&mesh_hash) {
            return Err(Damage::UnknownMesh { mesh: mesh_hash });
        }
        let is_there =
            |field: &Hash| self.fields.contains_key(field) || content.fields.iter().any(|(hash, _)| hash == field);
        if let Some(field) = fields.iter().find(|field| has_state && !is_there(field)) {
            return Err(Damage::UnknownField { field: *field });
        }
        self.meshes.extend(content.mesh.map(|place| (mesh_hash, place)));
        self.fields.extend(content.fields);
        let stretch =
            self.stretches.of_commit(self.place(place.start), ordinal, content.commit.manifest_hash.map(|hash| hash.0));
        let names_stretch = content.commit.manifest_hash.is_some();
        let record = content.report.into_record(commit);
        let bytes = self.place(place.start)..self.place(place.end);
        self.entries.push(Entry { record, mesh_hash, fields, bytes, state: content.state, stretch, names_stretch });
        Ok(())
    }
}

/// Whether the record behind another is one that may follow a manifest, or the end.
fn is_before_another(bytes: &[u8], frame: &Frame) -> bool {
    match frame::next(bytes, frame.body.end) {
        None => true,
        Some(Ok(next)) => [op::CHUNK, op::METADATA, op::DATA_END].contains(&next.opcode),
        Some(Err(_)) => false,
    }
}

/// Whether a message index has a channel, a length, and entries of that length.
fn is_message_index(body: &[u8]) -> bool {
    let Some((entries_len, entries)) = body.get(2..).and_then(|rest| rest.split_first_chunk()) else { return false };
    u32::from_le_bytes(*entries_len) as usize == entries.len() && entries.len().is_multiple_of(16)
}
