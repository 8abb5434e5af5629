//! What a log can be asked: go on with it, run its stages again, find where two runs part, where a run jumped.

mod bisection;
mod compare;
mod condition;
mod long;
mod part;
mod probes;
mod replay;
mod resume;
mod snap;
mod stability;

pub use bisection::{IndexBisection, LoadBisection};
pub use compare::{Comparison, Difference, compare};
pub use condition::{Condition, ConditionError};
pub use long::{first_where, stages_of_step};
pub use part::{Parting, find_parting};
pub use probes::{ProbeError, read_probes};
pub use replay::{ReplayError, Replayed, Verdict, replay_stage, verdict};
pub use resume::{Basis, BasisError, NothingStands, ResumePlan, basis, plan, restored_scene, shown_value};
pub use snap::{SnapError, SnapReport, find_snap, first_loss_of_stability};
pub use stability::{StabilityError, StabilityReport, stability_at};
