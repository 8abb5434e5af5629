//! What connects the shells of a structure.

use serde::{Deserialize, Serialize};

use super::place::ShellEdge;

/// A connection of two shells along an edge of each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// What reports and errors call it.
    pub name: String,
    /// How the edges are joined.
    pub kind: JointKind,
    /// The two edges.
    pub edges: [ShellEdge; 2],
    /// Factor of the penalties.
    pub stiffness: f64,
}

/// How two edges are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum JointKind {
    /// Displacement and slope are continuous.
    Smooth,
    /// Displacement is continuous, and the angle stays.
    KeptAngle,
    /// Displacement is continuous.
    Hinge,
}

/// Two shells that are glued together where their faces meet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bond {
    /// What reports and errors call it.
    pub name: String,
    /// The two shells, by their places in the list.
    pub shells: [usize; 2],
    /// Largest distance of faces that are glued, mm; `None`: a thousandth of the mean thickness.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gap_mm: Option<f64>,
    /// Stiffness of the layer, in E/t of the stiffer shell.
    pub stiffness: f64,
}
