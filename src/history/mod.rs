//! What can be done with a log: continue it, run its stages again, find where two runs part, where a run jumped.
//!
//! | file | what |
//! |---|---|
//! | `logged_scene` | the scene of a stage |
//! | `states` | states that a log holds, or that are made again |
//! | `resume` | where a run continues |
//! | `replay` | stages run again |
//! | `mending` | lost stages run again |
//! | `divergence`, `compare` | where two runs part; two states in bits |
//! | `bisection`, `condition` | what to look at next; conditions on reports |
//! | `snap`, `stability` | where a run jumped; how stable its states are |
//! | `probes` | probes read after the run |
//! | `long` | questions to a long log that its index answers |

mod bisection;
mod compare;
mod condition;
mod divergence;
mod logged_scene;
mod long;
mod mending;
mod probes;
mod replay;
mod resume;
mod snap;
mod stability;
mod states;

pub use compare::{Comparison, Difference, compare};
pub use condition::{Condition, ConditionError};
pub use divergence::{Divergence, find_divergence};
pub use logged_scene::{LoggedSceneError, logged_scene};
pub use long::{first_where, stages_of_step};
pub use mending::mended;
pub use probes::{ProbeError, RedefinedProbe, read_probes, redefined_probes, remove_redefined};
pub use replay::{ReplayError, Replayed, Verdict, replay_stage, verdict};
pub use resume::{Basis, BasisError, NothingKept, ResumePlan, basis, plan, restored_scene};
pub use snap::{SnapError, SnapReport, find_snap, first_loss_of_stability, no_jump};
pub use stability::{BucklingReport, StabilityError, StabilityReport, buckling_at, stability_at};
pub use states::{RemakeError, States};
