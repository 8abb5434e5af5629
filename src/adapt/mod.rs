//! Refinement: where bending concentrates, knots are inserted, and the displacement is carried over exactly.

mod indicators;
mod refinement;

pub use indicators::{Indicators, element_strains, evaluate_indicators};
pub use refinement::project_displacements;
