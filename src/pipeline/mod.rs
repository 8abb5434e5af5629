//! Stages, the loop that runs them, step control, and the sinks that see every stage.
//!
//! | file | what |
//! |---|---|
//! | `stages` | the stages |
//! | `step` | a step of a drive: what every drive does alike |
//! | `load_drive`, `path_drive` | steps by load, and by arc length |
//! | `branch_switch` | from an unstable equilibrium to a stable one |
//! | `mesh_in_hand` | what is kept of the meshes that stages meet |
//! | `step_control`, `path_control` | how far the next step goes |
//! | `run` | the loop |
//! | `sink` | where stages go |
//! | `record`, `report`, `fields` | what is kept of a stage |
//! | `probes` | readings at an equilibrium |
//! | `warning`, `doubts`, `ripple` | when numbers are doubted, and how it is said |
//! | `stage_error` | why a stage did not end |
//! | `revision` | the revision of the numerics |

mod branch_switch;
mod doubts;
mod fields;
mod load_drive;
mod mesh_in_hand;
mod path_control;
mod path_drive;
mod probes;
mod record;
mod report;
mod revision;
mod ripple;
mod run;
mod sink;
mod stage_error;
mod stages;
mod step;
mod step_control;
mod warning;

pub use crate::scene::Parameter;
pub use fields::{as_number, fields_of};
pub use path_control::CriticalPoint;
pub use record::{Commit, Record};
pub use report::{Outcome, Reading, Report, WrittenReport, released_in_words};
pub use revision::NUMERICS_REVISION;
pub use run::{Ending, Run, RunError};
pub use sink::{MemorySink, Sink, SinkError};
pub use stage_error::StageError;
pub use stages::{Stages, run_hash};
pub use step_control::next_stage;
pub(crate) use step_control::{is_jump, known_release, next_attempt};
pub use warning::Warning;
