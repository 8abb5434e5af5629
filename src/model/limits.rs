//! How near is near enough, and how much is too much.

/// Control points of a mesh at most: tables and matrix of more would not fit in the memory of a large workstation.
pub const MOST_CONTROL_POINTS: usize = 500_000;
/// Distances, relative to the size of what they are distances of, that are rounding of coordinates given to five digits.
pub const POSITION: f64 = 1e-4;
/// Angles (rad) and shares up to which the geometry counts as smooth: coordinates given to five digits are off by that much
/// over the distance of two control points.
pub const SMOOTH: f64 = 1e-3;
/// Angles (rad) between a line's normal plane and the surface that are rounding of coordinates given to five digits; also
/// the share of a stiffness that turning the axes by as much makes.
pub const ANGLE: f64 = SMOOTH;
/// Deviations below this are rounding of a computation: elimination finds constraints redundant that differ by as little.
pub const ROUNDING: f64 = 1e-12;
/// Parameters (of a range from 0 to 1) that differ by less are the same.
pub const SAME_PARAMETER: f64 = 1e-9;
