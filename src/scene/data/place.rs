//! Places on the surface of a shell, and axes.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A parametric direction of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ParametricDirection {
    /// The first direction, u.
    U,
    /// The second direction, v.
    V,
}

impl ParametricDirection {
    /// Index of the direction: 0 for u, 1 for v.
    pub fn index(self) -> usize {
        match self {
            ParametricDirection::U => 0,
            ParametricDirection::V => 1,
        }
    }
}

/// An edge of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Edge {
    /// u = 0.
    UStart,
    /// u = 1.
    UEnd,
    /// v = 0.
    VStart,
    /// v = 1.
    VEnd,
}

impl Edge {
    /// All edges.
    pub const ALL: [Self; 4] = [Self::UStart, Self::UEnd, Self::VStart, Self::VEnd];

    /// What a scene calls it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::UStart => "u-start",
            Self::UEnd => "u-end",
            Self::VStart => "v-start",
            Self::VEnd => "v-end",
        }
    }

    /// The direction that is constant along the edge, and whether the edge is at its end.
    pub fn side(self) -> (ParametricDirection, bool) {
        match self {
            Edge::UStart => (ParametricDirection::U, false),
            Edge::UEnd => (ParametricDirection::U, true),
            Edge::VStart => (ParametricDirection::V, false),
            Edge::VEnd => (ParametricDirection::V, true),
        }
    }
}

/// A part of the surface. Fractions are of the length or of the angle that the direction spans (of the parameter for
/// [`super::Geometry::Nurbs`]).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Region {
    /// A whole edge.
    Edge(Edge),
    /// A point (u, v), a corner for instance; fractions in [0, 1].
    Point([f64; 2]),
    /// The line on which one direction has a fraction, strictly inside (0, 1).
    Line(ParametricDirection, f64),
    /// The whole surface.
    Whole,
}

impl Region {
    /// Fractions of u and v that a place has; `None` for one that it runs along.
    pub fn fractions(self) -> [Option<f64>; 2] {
        match self {
            Region::Edge(edge) => {
                let (direction, at_end) = edge.side();
                Region::Line(direction, if at_end { 1.0 } else { 0.0 }).fractions()
            }
            Region::Line(ParametricDirection::U, fraction) => [Some(fraction), None],
            Region::Line(ParametricDirection::V, fraction) => [None, Some(fraction)],
            Region::Point(at) => at.map(Some),
            Region::Whole => [None; 2],
        }
    }

    /// The place with u and v exchanged.
    pub fn exchanged(self) -> Self {
        match self {
            Region::Edge(Edge::UStart) => Region::Edge(Edge::VStart),
            Region::Edge(Edge::UEnd) => Region::Edge(Edge::VEnd),
            Region::Edge(Edge::VStart) => Region::Edge(Edge::UStart),
            Region::Edge(Edge::VEnd) => Region::Edge(Edge::UEnd),
            Region::Line(ParametricDirection::U, fraction) => Region::Line(ParametricDirection::V, fraction),
            Region::Line(ParametricDirection::V, fraction) => Region::Line(ParametricDirection::U, fraction),
            Region::Point([u, v]) => Region::Point([v, u]),
            Region::Whole => Region::Whole,
        }
    }
}

/// As a scene has it as the value of `on`.
impl fmt::Display for Region {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Region::Edge(Edge::UStart) => write!(f, "\"u-start\""),
            Region::Edge(Edge::UEnd) => write!(f, "\"u-end\""),
            Region::Edge(Edge::VStart) => write!(f, "\"v-start\""),
            Region::Edge(Edge::VEnd) => write!(f, "\"v-end\""),
            Region::Line(ParametricDirection::U, fraction) => write!(f, "\"u={fraction}\""),
            Region::Line(ParametricDirection::V, fraction) => write!(f, "\"v={fraction}\""),
            Region::Point([u, v]) => write!(f, "[{u:?}, {v:?}]"),
            Region::Whole => write!(f, "the whole surface"),
        }
    }
}

/// An edge of a shell of a structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShellEdge {
    /// The shell, by its place in the list.
    pub shell: usize,
    /// Its edge.
    pub edge: Edge,
}

/// An axis of the global frame, as a component of a vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// Along x.
    X,
    /// Along y.
    Y,
    /// Along z.
    Z,
}

/// Whether a place in the list of shells is the first one, which is not written.
pub(super) fn is_first(shell: &usize) -> bool {
    *shell == 0
}
