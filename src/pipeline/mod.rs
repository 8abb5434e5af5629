//! Stages, the loop that runs them, and step control.
//!
//! | file | what |
//! |---|---|
//! | `stages` | the stages |
//! | `evaluation`, `measured` | which spans are too coarse, and for what |
//! | `step` | a step of a drive: what every drive does alike |
//! | `load_drive`, `path_drive` | steps by load, and by arc length |
//! | `branch_switch` | from an unstable equilibrium to a stable one |
//! | `imperfect_start`, `buckled_shape` | the mesh that a run starts from; imperfections that are modes of buckling |
//! | `current_mesh` | what stages keep of the current mesh |
//! | `step_control`, `path_control` | how far the next step goes |
//! | `run` | the loop |
//! | `probes` | readings at an equilibrium |
//! | `doubts`, `ripple` | warnings about numbers; jumps of the mesh alone |
//! | `stage_error` | why a stage did not end |

mod branch_switch;
mod buckled_shape;
mod current_mesh;
mod doubts;
mod evaluation;
mod imperfect_start;
mod load_drive;
mod measured;
mod path_control;
mod path_drive;
mod probes;
mod ripple;
mod run;
mod stage_error;
mod stages;
mod step;
mod step_control;

pub use imperfect_start::imperfect_mesh;
pub use run::{Ending, Run, RunError};
pub use stage_error::StageError;
pub use stages::Stages;
pub use step_control::next_stage;
pub(crate) use step_control::{is_jump, known_release, next_attempt};
