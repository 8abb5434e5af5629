//! Equilibrium: assembly, the sparse solver, Newton's method as a descent on the energy.

mod assembly;
mod condition;
mod descent;
mod external;
mod gmres;
mod kernel;
mod newton;
mod pattern;
mod sparse;
mod stability;
mod symmetry;
mod timing;

pub use assembly::{Assembled, Want, strain_energy};
pub use condition::Condition;
pub use newton::{Effort, Equilibrium, Iterate, Observer, SolveError, Solved, Standing, Workspace, WorkspaceError};
pub use sparse::DenseProduct;
pub use sparse::FactorError;
pub use stability::{SoftMode, soft_mode};
pub use symmetry::SymmetryError;
pub use timing::{KernelCost, KernelRun};
