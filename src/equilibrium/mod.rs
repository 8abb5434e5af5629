//! Equilibrium: assembly, the sparse solver, Newton's method as a descent on the energy.

mod assembly;
mod blocks;
mod condition;
mod continuation;
mod descent;
mod equations;
mod external;
mod force_scale;
mod gmres;
mod kernel;
mod ledger;
mod linear_release;
mod metric;
mod newton;
mod pattern;
mod solve_error;
mod sparse;
mod stability;
mod symmetry;
mod tangent_stiffness;
mod timing;

pub use assembly::{Assembled, Part, Want, strain_energy};
pub use blocks::Blocks;
pub use condition::Condition;
pub use continuation::{Continuation, ContinuedPoint, Direction, Sense};
pub use force_scale::ForceScale;
pub use linear_release::LinearRelease;
pub use newton::{Effort, Equilibrium, Iterate, Observer, Solved, Standing, Workspace};
pub use solve_error::{SolveError, WorkspaceError};
pub use sparse::DenseProduct;
pub use sparse::FactorError;
pub use stability::{LinearBuckling, SoftMode, soft_mode};
pub use symmetry::SymmetryError;
pub use timing::{KernelCost, KernelRun};

/// Build of the element kernel that this machine runs.
pub fn kernel_name() -> &'static str {
    kernel::Build::detect().name()
}
