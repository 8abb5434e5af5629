//! Terms that store energy or act as loads, one file each, and their balance.
//!
//! | file | what |
//! |---|---|
//! | `term` | what a term is |
//! | `terms` | the sum of all terms other than the shell |
//! | `shell`, `kernel` | the shell, and its elements |
//! | `loads` | the actions of a scene |
//! | `connections` | joints and bonds of a structure |
//! | `sections` | springs and weights on rigid sections |
//! | `balance` | what is stored, worked and dissipated |
//! | `discretization` | a scene on a mesh, with all its terms |
//! | `held` | whether supports and terms hold the shell |
//! | `load_balance` | whether loads balance where only rigid motions are held |
//! | `remarks` | what a scene leaves open, in words |

mod balance;
mod connections;
mod discretization;
mod held;
mod kernel;
mod load_balance;
mod loads;
mod remarks;
mod sections;
mod shell;
mod term;
mod terms;

pub use balance::Balance;
pub use connections::{ConnectionState, Connections, GluedLayers, GluedShell, GreatestTraction, Traction};
pub use discretization::Discretization;
pub(crate) use held::check_held;
pub(crate) use kernel::Build;
pub use kernel::Want;
pub(crate) use load_balance::check_balance;
pub(crate) use remarks::remarks;
pub(crate) use shell::with_locked;
pub use shell::{ElementSums, Shell, ShellElements, strain_energy};
pub use term::{At, Tangent, Term, TermSource};
pub use terms::Terms;

/// Name of the build of the element kernel that this machine runs.
pub fn kernel_name() -> &'static str {
    Build::detect().name()
}
