//! Equilibrium: assembly, the sparse solver, Newton's method as a descent on the energy.

mod assembly;
mod condition;
mod configuration;
mod continuation;
mod descent;
mod equations;
mod force_scale;
mod gmres;
mod iterate;
mod kernel;
mod ledger;
mod linear_release;
mod metric;
mod newton;
mod pattern;
mod solve_error;
mod solved;
mod sparse;
mod stability;
mod symmetry;
mod tangent_stiffness;
mod timing;
mod vector;
mod workspace;

pub use assembly::{Assembled, Part, Want, strain_energy};
pub use condition::Condition;
pub use configuration::{Configuration, Standing};
pub use continuation::{Continuation, ContinuedPoint, Direction, Sense};
pub use force_scale::ForceScale;
pub use iterate::{Effort, Iterate, Observer};
pub use linear_release::LinearRelease;
pub use newton::Equilibrium;
pub use solve_error::{SolveError, WorkspaceError};
pub use solved::Solved;
pub use sparse::DenseProduct;
pub use sparse::FactorError;
pub use stability::{LinearBuckling, SoftMode, soft_mode};
pub use symmetry::SymmetryError;
pub use timing::{KernelCost, KernelRun};
pub use workspace::Workspace;

/// Build of the element kernel that this machine runs.
pub fn kernel_name() -> &'static str {
    kernel::Build::detect().name()
}
