//! What is kept of a run: every stage with its place in the chain of hashes, and what keeps it.
//!
//! | file | what |
//! |---|---|
//! | `commit` | a stage's place in the chain, and all that is kept of it |
//! | `report`, `fields` | what a stage reports of what it did; its entries by name |
//! | `reading` | probes, joints and bonds by name |
//! | `critical_point` | limit points and bifurcations |
//! | `warning` | when numbers are doubted, and the words for it |
//! | `run_hash`, `revision` | the identity of a run; the revision of the numerics |
//! | `sink` | where stages go |

mod commit;
mod critical_point;
mod fields;
mod reading;
mod report;
mod revision;
mod run_hash;
mod sink;
mod warning;

pub use crate::scene::Parameter;
pub use commit::{Commit, Record};
pub use critical_point::CriticalPoint;
pub(crate) use fields::as_number;
pub use fields::fields_of;
pub use reading::{ConnectionReading, LargestTraction, Reading};
pub(crate) use report::released_in_words;
pub use report::{Outcome, Report, WrittenReport};
pub use revision::NUMERICS_REVISION;
pub use run_hash::run_hash;
pub use sink::{MemorySink, Sink, SinkError};
pub(crate) use warning::LARGE;
pub use warning::Warning;
