//! Refinement: where bending concentrates, knots are inserted, and the displacement is carried over exactly.
//!
//! | file | what |
//! |---|---|
//! | `halving` | what halving every element would change |
//! | `indicators` | refinement indicators, and the marks that they set |
//! | `refinement` | knots inserted, displacements carried over |

mod halving;
mod indicators;
mod refinement;

pub use halving::{Halved, Halving};
pub use indicators::{
    Blocked, Indicators, element_strains, evaluate_indicators, largest_bending_strain, largest_strain,
};
pub use refinement::project_displacements;
