//! Sweeps over designs: a scene, what of it varies, and a table of what each design's run shows.
//!
//! Every task is a run in a log of its own, named after what decides its results: what is done is never done again, and whatever was
//! interrupted continues where it stopped, on whatever machine.
//!
//! | file | what |
//! |---|---|
//! | `sweep_file`, `axis` | a sweep as it is written; what varies |
//! | `sampling` | points spread over what is scattered |
//! | `quantity` | what is collected of a run |
//! | `plan` | the tasks |
//! | `record`, `folder` | what is on record of a task; the folder of a sweep |
//! | `table`, `parquet` | rows, filtered and written; as Parquet where that is compiled in |
//! | `work`, `pool` | one task, done; all of them on this machine |
//! | `slurm`, `submission` | batch scripts and what Slurm prints; what was given to it |
//! | `error` | what can be wrong |

mod axis;
mod error;
mod folder;
#[cfg(feature = "parquet")]
mod parquet;
mod plan;
mod pool;
mod quantity;
mod record;
mod sampling;
mod slurm;
mod submission;
mod sweep_file;
mod table;
mod work;

pub use axis::{Axis, Scatter, Spacing};
pub use error::SweepError;
pub use folder::Folder;
pub use plan::{Head, Plan, Task, planned_from};
pub use pool::{Outcome, do_tasks, to_do};
pub use quantity::{FIELDS, FIGURES, Field, Figure, Finished, Quantity, Which};
pub use record::{Ending, Row, TaskRecord};
pub use slurm::{
    Array, END_FORMAT, JobOptions, QUEUE_FORMAT, Queued, Role, Script, USUAL_MAX_ARRAY_SIZE, job_number,
    max_array_size, shell_word, time_left,
};
pub use submission::{Submission, Submissions, Submitted, keep_list, keep_script};
pub use sweep_file::{Combine, Method, Reference, Sample, SweepFile};
pub use table::{Condition, Table};
pub use work::Work;
