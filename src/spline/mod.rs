//! NURBS: basis functions, knot insertion, exact arcs, tensor-product surfaces.
//!
//! Piegl & Tiller, *The NURBS Book*, 2nd ed. (1997); algorithm numbers below refer to it.
//!
//! | file | what |
//! |---|---|
//! | `basis` | basis functions and spans |
//! | `knots` | whether knots make a spline space |
//! | `arc` | exact curves |
//! | `insertion` | knot insertion |
//! | `interpolation` | splines through given values |
//! | `coarsening` | best approximation on fewer knots |
//! | `grid` | numbering of rows and columns |
//! | `patch`, `mesh` | a spline space with its geometry; the surfaces of a structure |
//! | `surface` | points and derivatives |

mod arc;
mod basis;
mod coarsening;
mod grid;
mod insertion;
mod interpolation;
mod knots;
mod mesh;
mod patch;
mod surface;

pub use arc::{HomogeneousCurve, circular_arc, segment_count, straight_line};
pub use basis::{DEGREES, Spans, basis_derivatives, basis_derivatives_len, find_span};
pub use coarsening::Coarsening;
pub use grid::Grid;
pub use insertion::{insert_knots, insert_knots_into_net};
pub use interpolation::{Interpolation, ScalarSurface, collocation, greville_points};
pub use knots::{KnotFlaw, check_knots, control_count, without_knots};
pub use mesh::{Elements, KnotLists, Mesh, knot_counts};
pub use patch::{Patch, cartesian};
pub use surface::{
    LineBasis, SurfaceBasis, SurfacePoint, evaluate_surface, mid_surface_point, mid_surface_points, position_on_lines,
    quotient_derivatives, tensor_derivatives,
};
