//! Refinement: where bending concentrates, knots are inserted, and the displacement is carried over exactly.
//!
//! | file | what |
//! |---|---|
//! | `error_estimate`, `estimate`, `judged_mesh` | the error that the mesh causes, by direction and span, and the knots that lower it |
//! | `coarsening` | knots taken out, and the best approximation on what is left |
//! | `finest` | the mesh that refining ends with at the latest |
//! | `halving` | what halving every element would change |
//! | `indicators` | refinement indicators, and the marks that they set |
//! | `refinement` | knots inserted, displacements carried over |

mod coarsening;
mod error_estimate;
mod estimate;
mod finest;
mod halving;
mod indicators;
mod judged_mesh;
mod refinement;

pub use coarsening::{Coarsened, superfluous};
pub use error_estimate::{DirectionalError, Enriched, Measure};
pub use estimate::still_holds;
pub use finest::Finest;
pub use halving::{Halved, Halving, compared_with};
pub use indicators::{
    Blocked, Indicators, element_strains, evaluate_indicators, largest_bending_strain, largest_strain, length_limit,
    span_lengths,
};
pub use judged_mesh::JudgedMesh;
pub use refinement::project_displacements;
