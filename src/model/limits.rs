//! Tolerances and limits of models.

/// Largest number of control points of a mesh: tables and matrix of more would not fit in the memory of a large
/// workstation.
pub const MOST_CONTROL_POINTS: usize = 500_000;
/// Relative distance up to which points coincide: coordinates given to five digits are off by that much.
pub const POSITION: f64 = 1e-4;
/// Angle (rad) and share up to which the geometry counts as smooth: coordinates given to five digits are off by that
/// much over the distance of two control points.
pub const SMOOTH: f64 = 1e-3;
/// Angle (rad) between a line's normal plane and the surface up to which it is rounding of coordinates given to five
/// digits; also the share of a stiffness that turning the axes by as much makes.
pub const ANGLE: f64 = SMOOTH;
/// Deviation below which a difference is rounding of a computation: elimination takes constraints for redundant that
/// differ by as little.
pub const ROUNDING: f64 = 1e-12;
/// Difference of two parameters (in a range from 0 to 1) below which they are the same.
pub const SAME_PARAMETER: f64 = 1e-9;
