//! The journal: a run as an MCAP log, stage by stage, that survives what happens to processes, disks and files.
//!
//! A log is an ordinary MCAP file, so that viewers can open it, and three things more:
//!
//! 1. **One chunk is one commit.** A chunk holds the state that a stage made (its mesh and its fields, displacements for one,
//!    only where the log does not have them yet), the stage's report, and at its end a commit message. It reaches the file in one
//!    write. A process that dies loses the stage in flight and nothing else.
//! 2. **Every commit vouches for its chunk.** The commit message is sealed with the hash of its own bytes and names the
//!    hash of every other message in the chunk and of the manifest of its stretch; its chain hash follows from the commit
//!    before it. A log that was cut or
//!    changed anywhere is read up to the last commit for which all of that holds, and [`Log::completeness`] reports what
//!    lies behind. States are decoded only when they are needed, and compared with their content hash.
//! 3. **The end is explicit.** MCAP's footer proves nothing (its writer adds one even while a panic unwinds), so a run
//!    that reached its end has a message for that.
//!
//! | file | holds |
//! |---|---|
//! | `format` | topics, encodings, versions, limits, times |
//! | `codec`, `soundness` | states and meshes as bytes, and what they must satisfy |
//! | `message`, `manifest` | reports, commits, the end, who wrote it |
//! | `topics`, `ledger`, `summary`, `outbox`, `encoder`, `packer`, `encode_error`, `backend`, `writer`, `write_error` | from a stage to bytes in a file |
//! | `frame`, `chunk`, `stretch`, `scan`, `reader`, `damage`, `log` | from bytes to stages, and what can be wrong with them |
//! | `checkpoint`, `parts`, `index`, `index_keeper`, `long`, `asked` | a long log, of which only what is needed is read |
//! | `portions` | a log of any length, read through without holding it |
//! | `resume`, `recovery` | continuing a log, copying what is good of one |
//! | `new_log`, `thin` | a log that is made of another, without some of its states |
//! | `mending`, `lost_manifest` | a log with stages put back that it had lost; what is not known without a manifest |
//! | `lock`, `lease`, `still_ours` | one writer at a time, of a file that is still the log |
//! | `rewriting`, `agreement`, `verify` | all that can be checked, all of it |
//! | `trace`, `timed_messages` | what a solve did, iterate by iterate, and what viewers are shown, each as a file of its own |
//!
//! # Writing, stopping, continuing
//!
//! [`JournalWriter::create`] begins a log and never overwrites one. It is a [`Sink`](crate::record::Sink): the loop
//! hands it every stage. At the end [`JournalWriter::finish`]; where a run is stopped on purpose
//! [`JournalWriter::close`], which leaves the end open but adds what viewers look for. [`Resume`] claims a log, reads
//! it, and continues behind its last good commit.
//!
//! A log that is as it was written is continued in place, under a lock that no other process can hold; any other is
//! copied (`resume` explains how both survive a kill and a power cut).
//!
//! # Long logs
//!
//! From some four thousand commits on, `LOG.index` lies next to a log: where its commits are and the numbers of their
//! reports, written as the run continues. [`LongLog`] and [`Resume`] read the end of such a log alone, and through the index
//! what they are asked for, and check the seals and hashes of what they read. The index is a cache: without it, or where it
//! does not fit, the log is read through, in parts that fit in memory, and the index is written again. [`verify()`] reads all
//! of a log and none of its index.
//!
//! What goes through a log from front to back reads [`Portions`], of which one is in memory: [`recover()`], [`thin()`], tables and
//! curves.
//!
//! [`thin()`] writes a log again without the states between some load steps; commits and reports, and with them the chain,
//! stay.
//!
//! # Checking that other programs can read a log
//!
//! With the MCAP project's own reader for Python (`pip install mcap`), which shares no code with this one:
//!
//! ```text
//! python3 -c '
//! import json, sys
//! from mcap.reader import make_reader
//! reader = make_reader(open(sys.argv[1], "rb"), validate_crcs=True)
//! for schema, channel, message in reader.iter_messages(topics=["/foldline/report"]):
//!     report = json.loads(message.data)
//!     print(report["step"], report["stage"], report["rotation_deg"], report["moment_n_mm"])
//! ' run.mcap
//! ```
//!
//! A log that was neither finished nor closed has no summary; readers that go by the summary then need
//! `foldline recover run.mcap -o copy.mcap` first. Those that read front to back (`NonSeekingReader` in Python, with
//! `log_time_order=False`) give every message, and an error at the end.
//!
//! # Old logs
//!
//! `checkpoints/golden/` holds small logs for each layout that was ever released, named
//! `v<format>-<program version>-<what happened to it>.mcap`: a finished one, an unfinished one, and damaged ones. The
//! `README.md` there states how each was made and what it must give, and a test holds every later version to that table,
//! to the last state. A change of what is written takes these steps: raise [`format::FORMAT_VERSION`] (or
//! [`CODEC_VERSION`], where only states or meshes change); keep the old structs and decode both; write the logs with
//! the last program before the change, by the command that the `README.md` names, and add them with their rows. A
//! golden log is never written again.
mod agreement;
mod asked;
mod backend;
mod checkpoint;
mod chunk;
mod codec;
mod damage;
mod encode_error;
mod encoder;
pub mod format;
mod frame;
mod index;
mod index_keeper;
mod lease;
mod ledger;
mod lock;
mod log;
mod long;
mod lost_manifest;
mod manifest;
mod mending;
pub mod message;
mod new_log;
mod outbox;
mod packer;
mod parts;
mod portions;
mod reader;
mod recovery;
mod resume;
mod rewriting;
mod scan;
mod soundness;
mod still_ours;
mod stretch;
mod summary;
mod thin;
mod timed_messages;
mod topics;
mod trace;
mod verify;
mod write_error;
mod writer;

pub use agreement::Disagreement;
pub use asked::AskedLog;
pub use backend::{Backend, FileBackend};
pub use codec::{
    CODEC_VERSION, CodecError, EncodedField, EncodedState, decode_mesh, decode_state, encode_mesh, encode_state,
};
pub use damage::{Completeness, Damage, LaterCommit, Problem};
pub use encode_error::EncodeError;
pub(crate) use index::word_number;
pub use lock::{LockError, LogLock};
pub use log::{Entry, Log, Note, StateError};
pub use long::{LongLog, LongLogError};
#[cfg(feature = "cli")]
pub(crate) use lost_manifest::stages_in_words;
pub(crate) use manifest::host;
pub use manifest::{Manifest, ManifestError, SceneInLogError};
pub use mending::MendError;
pub use new_log::NewLogError;
pub use portions::{Portion, Portions};
pub use reader::ReadError;
pub use recovery::{RecoverError, RecoverOutcome, recover, recover_mended};
pub use resume::{Resume, ResumeError, Resumed};
pub use soundness::Flaw;
#[doc(hidden)]
pub use soundness::check_state;
pub use still_ours::LogChanged;
pub use stretch::LostManifest;
pub use thin::{ThinError, Thinned, thin};
pub use timed_messages::{TimedMessages, TimedMessagesError};
pub use topics::{ViewerMessage, ViewerTopic};
pub use trace::{ITERATE_TOPIC, TraceRow, trace_file};
pub use verify::{Finding, Level, verify, verify_log};
pub use write_error::WriteError;
pub use writer::{JournalWriter, ViewerTopics};
