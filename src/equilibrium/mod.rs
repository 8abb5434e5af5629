//! Equilibrium: assembly, the sparse solver, Newton's method as a descent on the energy.
//!
//! | file | what |
//! |---|---|
//! | `assembly` | sums of all terms |
//! | `symmetry` | how symmetric a stiffness is |
//! | `pattern` | from blocks on control points to the matrix on free unknowns |
//! | `sparse` | factor and solution |
//! | `tangent_stiffness` | the matrix with its factor |
//! | `vector`, `metric`, `gmres` | sums over vectors; lengths of motions; iterative solution |
//! | `configuration` | where a solve starts from, and a point with its unknowns and placement |
//! | `workspace` | tables, matrix and factor for one mesh |
//! | `iterate` | iterates and effort of a solve |
//! | `force_scale` | what a residual is compared with |
//! | `ledger` | the energies of a solve, from its start |
//! | `descent` | Newton's method as a descent on the energy |
//! | `newton` | equilibrium at a value of the parameter |
//! | `equations`, `continuation` | equilibrium along a path |
//! | `stability`, `condition` | the lowest eigenvalue and its mode; the spread of all |
//! | `buckling` | load factors and modes of linear buckling |
//! | `linear_release` | energy that a state out of balance releases |
//! | `solved`, `solve_error` | the result of a solve, and why there is none |
//! | `timing` | the parts of an iteration one by one |

mod assembly;
mod buckling;
mod condition;
mod configuration;
mod continuation;
mod descent;
mod equations;
mod force_scale;
mod gmres;
mod iterate;
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

pub use assembly::Assembled;
pub use buckling::{BucklingError, BucklingMode, BucklingModes, linear_buckling};
pub use condition::Condition;
pub use configuration::{Configuration, Coordinates};
pub use continuation::{Continuation, ContinuedPoint, Direction, Sense};
pub use force_scale::ForceScale;
pub use iterate::{Effort, Iterate, Observer};
pub use linear_release::{LinearRelease, Placed};
pub use newton::Equilibrium;
pub use solve_error::{SolveError, WorkspaceError};
pub use solved::Solved;
pub use sparse::Couplings;
pub use sparse::DenseProduct;
pub use sparse::FactorError;
pub use sparse::SparseSolver;
pub use stability::{LinearBuckling, SoftMode, soft_mode};
pub use symmetry::SymmetryError;
pub use timing::{KernelCost, KernelRun};
pub use workspace::Workspace;
