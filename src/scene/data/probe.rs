//! Quantities that reports give by name.

use serde::{Deserialize, Serialize};

use super::place::{Axis, Region, is_first};

/// A quantity of the scene that every equilibrium reports by name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Probe {
    /// Its name in reports; no two probes have the same.
    pub name: String,
    /// The shell that it looks at, by its place in the list.
    #[serde(default, skip_serializing_if = "is_first")]
    pub shell: usize,
    /// The quantity that is measured.
    #[serde(flatten)]
    pub kind: ProbeKind,
}

/// The quantity that a probe measures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum ProbeKind {
    /// Displacement of a point, mm.
    Displacement {
        /// The point, fractions (u, v).
        on: [f64; 2],
        /// The component of the displacement.
        component: Component,
    },
    /// What a support exerts on the shell: force (N), or moment (N·mm) about the displaced reference point of a rigid
    /// section, or for another support about the centroid of the undeformed place. It is the derivative of strain energy
    /// less work of the loads with respect to the support's motion. Where supports hold the same, a plane of symmetry takes
    /// force across itself and moment, and otherwise the first in the scene takes all.
    Reaction {
        /// Name of the support.
        support: String,
        /// The component of the reaction.
        component: Reaction,
    },
    /// Moment that the side of larger u or v exerts on the other across a line, about the line's displaced middle,
    /// N·mm.
    SectionMoment {
        /// The line of the section.
        on: Region,
        /// The component of the moment.
        component: Axis,
    },
    /// Energy that the whole shell stores, N·mm: strain energy, and what terms of the caller's own store.
    Energy,
    /// Largest magnitude of the physical bending strain along u or v, 1/mm, and where it is.
    BendingStrain,
}

/// A component of a vector, or its magnitude.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Component {
    /// Along x.
    X,
    /// Along y.
    Y,
    /// Along z.
    Z,
    /// The length of the vector.
    Magnitude,
    /// Along the normal of the undeformed surface at the point.
    Normal,
    /// Away from the axis or the centre of the undeformed shell ([`super::Geometry::away_from_centre`]).
    Radial,
}

/// A component of a reaction: of its force or its moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reaction {
    /// Force along x.
    ForceX,
    /// Force along y.
    ForceY,
    /// Force along z.
    ForceZ,
    /// Moment about x.
    MomentX,
    /// Moment about y.
    MomentY,
    /// Moment about z.
    MomentZ,
}
