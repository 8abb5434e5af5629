//! Where and how the shell is held, and what acts on it.

use serde::{Deserialize, Serialize};

use super::place::{Axis, Edge, Region, ShellEdge, is_first};

/// A support: a region of the shell that is held or moved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Support {
    /// What reports and errors call it; no two supports have the same name.
    pub name: String,
    /// The region that is supported.
    pub on: Region,
    /// The shell that the region belongs to, by its place in the list.
    #[serde(default, skip_serializing_if = "is_first")]
    pub shell: usize,
    /// Further edges that belong to the same rigid section.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub also: Vec<ShellEdge>,
    /// How the region is held.
    #[serde(flatten)]
    pub hold: Hold,
    /// Factor of the given motions over the load factor.
    #[serde(default, skip_serializing_if = "History::is_proportional")]
    pub history: History,
}

impl Support {
    /// The edges that it holds: of a rigid section of several shells all of them; none where it is elsewhere.
    pub fn edges(&self) -> impl Iterator<Item = ShellEdge> {
        let first = match self.on {
            Region::Edge(edge) => Some(ShellEdge { shell: self.shell, edge }),
            _ => None,
        };
        first.into_iter().chain(self.also.iter().copied())
    }

    /// What the support is on one shell: a section of several shells is one on the edge of each.
    pub(super) fn of_shell(&self, shell: usize) -> Option<Self> {
        let edges = self.also.iter().filter(|also| also.shell == shell).map(|also| Region::Edge(also.edge));
        let on = (self.shell == shell).then_some(self.on).into_iter().chain(edges).next()?;
        Some(Self { on, shell: 0, also: Vec::new(), ..self.clone() })
    }
}

/// How a support holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Hold {
    /// Components of the displacement are given (0: held), others are free; slopes are free. Anywhere. The words
    /// `hinged` (all three 0), `fixed` (those that `hold` lists are 0) and `displacement` of a scene all come to this.
    Displacement {
        /// Displacement in x, y, z at factor 1, mm; `None` is free.
        displacement_mm: [Option<f64>; 3],
    },
    /// The edge, or a line inside, lies in a plane of symmetry: displacements across the plane and turns about the edge
    /// or line are zero. It must be plane, and the surface must cross the plane at right angles. Edges and lines only.
    Symmetric,
    /// The rigid motions that the other supports leave free are held, and nothing else: the shell takes no part in them
    /// on the mean of points spread over it. Loads in balance leave no reaction. [`Region::Whole`] only.
    RigidMotions,
    /// The edge is a rigid section with a pose of its own. `clamped` in a scene is one with all six motions held. The
    /// membrane strain at the edge stays free. Edges only.
    Rigid {
        /// Translations along x, y, z (mm) of the reference point and the rotation vector about x, y, z (degrees), at
        /// factor 1.
        motions: [Motion; 6],
        /// The point of the section whose translation is meant and about which it turns; `None`: the centroid of the
        /// undeformed edge.
        #[serde(skip_serializing_if = "Option::is_none")]
        reference_mm: Option<[f64; 3]>,
        /// Whether the shell's normal turns with the section; otherwise the shell is hinged to it.
        normals_turn: bool,
    },
}

/// The motion of a rigid section along or about one axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Motion {
    /// Its value at factor 1, mm or degrees; 0 is held.
    Given(f64),
    /// Free: found by equilibrium.
    Free(FreeWord),
}

/// The word `free`, as the value of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FreeWord {
    /// The only one.
    Free,
}

impl Motion {
    /// A motion that is left free.
    pub const FREE: Self = Motion::Free(FreeWord::Free);
}

/// A load: forces, moments, pressures or a change of temperature, and their history.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Action {
    /// Name of the action in errors.
    pub name: String,
    /// What acts, at factor 1.
    #[serde(flatten)]
    pub kind: ActionKind,
    /// The shell that it acts on, by its place in the list; `None`: all shells.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shell: Option<usize>,
    /// Factor over the load factor.
    #[serde(default, skip_serializing_if = "History::is_proportional")]
    pub history: History,
}

/// What acts, at a factor of 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum ActionKind {
    /// A dead force on a point.
    Force {
        /// The loaded point, fractions (u, v).
        on: [f64; 2],
        /// The force, N.
        force_n: ForceVector,
    },
    /// A dead force per undeformed length of an edge or a line.
    LineForce {
        /// The loaded edge or line.
        on: Region,
        /// The force per length, N/mm.
        force_n_per_mm: ForceVector,
    },
    /// A dead force per area of the whole surface.
    AreaForce {
        /// The force per area, N/mm².
        force_n_per_mm2: ForceVector,
        /// The area that is meant.
        #[serde(default, skip_serializing_if = "LoadedArea::is_undeformed")]
        per: LoadedArea,
    },
    /// Own weight: mass per undeformed area times an acceleration.
    Gravity {
        /// Components in x, y, z, m/s².
        acceleration_m_s2: [f64; 3],
    },
    /// A moment per undeformed length of an edge, about the tangent of the deformed edge in the direction of
    /// growing u or v (right-hand rule); it turns with the shell.
    EdgeMoment {
        /// The loaded edge.
        on: Edge,
        /// The moment per length, N·mm per mm.
        moment_n: f64,
    },
    /// A pressure on the whole surface; positive along the normal.
    Pressure {
        /// The pressure, N/mm².
        pressure_mpa: f64,
        /// Whether it acts along the deformed normal on the deformed area, or keeps the direction and the area of the
        /// undeformed shell (dead).
        follower: bool,
    },
    /// A dead force on a rigid section, at its reference point.
    SectionForce {
        /// Name of the support that is the section.
        section: String,
        /// Components in x, y, z, N.
        force_n: [f64; 3],
    },
    /// A moment on a rigid section: a couple of forces along one axis, in arms along another.
    SectionMoment {
        /// Name of the support that is the section.
        section: String,
        /// The moment, N·mm.
        moment_n_mm: f64,
        /// The axis that it acts about.
        about: Axis,
        /// The axis of its forces.
        forces_along: Axis,
        /// Whether the forces turn with the section, and have no potential then; otherwise they are dead.
        turns: SectionTurns,
    },
    /// A change of temperature, the same in the whole shell. The material states how much it expands.
    Temperature {
        /// The change of temperature, K.
        change_k: f64,
    },
    /// A change of the curvature that the shell has where it is free of stress, the same in the whole shell.
    NaturalCurvature {
        /// κ₁₁, κ₂₂, κ₁₂ in axes e₁ along the u direction and e₂ = n × e₁, 1/mm: positive where the side that the normal
        /// points to gets longer, so that the surface bends away from the normal. κ₁₂ is the twist, half of the shear.
        change_per_mm: [f64; 3],
    },
}

/// A dead force, or a dead force per length or area.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ForceVector {
    /// Components in x, y, z.
    Components([f64; 3]),
    /// A size in a direction that each point of the undeformed surface has of its own.
    Along(f64, SurfaceDirection),
}

impl From<[f64; 3]> for ForceVector {
    fn from(components: [f64; 3]) -> Self {
        ForceVector::Components(components)
    }
}

/// A direction that is defined at every point of the undeformed surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SurfaceDirection {
    /// Along the normal.
    Normal,
    /// Away from the axis or the centre ([`super::Geometry::away_from_centre`]).
    Radial,
    /// In the surface, square to an edge, out of the shell. Edges only.
    Outward,
}

/// How the forces of a couple behave as the section turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SectionTurns {
    /// They keep their direction.
    Dead,
    /// They turn with the section.
    Follows,
}

/// The area to which a force per area refers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LoadedArea {
    /// Of the undeformed surface.
    #[default]
    Undeformed,
    /// Of its projection on a plane square to the force: snow.
    Projected,
}

impl LoadedArea {
    /// Whether the area is the undeformed one, which is the default.
    pub fn is_undeformed(&self) -> bool {
        *self == LoadedArea::Undeformed
    }
}

impl ActionKind {
    /// Whether the load turns with the shell, so that it need not have a potential.
    pub fn follows(&self) -> bool {
        matches!(
            self,
            Self::EdgeMoment { .. }
                | Self::Pressure { follower: true, .. }
                | Self::SectionMoment { turns: SectionTurns::Follows, .. }
        )
    }
}

/// The factor of a load or motion as a function of the load factor: piecewise linear through (load factor, factor)
/// pairs, constant beyond the last. Without pairs it is the load factor itself.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct History(pub Vec<[f64; 2]>);

impl History {
    /// Whether the factor is the load factor itself.
    pub fn is_proportional(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the factor at a load factor.
    pub fn at(&self, load_factor: f64) -> f64 {
        let points = &self.0;
        let Some(first) = points.first() else { return load_factor };
        let after = points.partition_point(|point| point[0] <= load_factor);
        match (after.checked_sub(1).map(|before| points[before]), points.get(after)) {
            (None, _) => first[1],
            (Some(last), None) => last[1],
            (Some([from, low]), Some([to, high])) => low + (high - low) * (load_factor - from) / (to - from),
        }
    }

    /// A straight line from 0 to the factor at load factor 1.
    pub(crate) fn straight(&self) -> Self {
        match self.is_proportional() {
            true => self.clone(),
            false => Self(vec![[0.0, 0.0], [1.0, self.at(1.0)]]),
        }
    }

    /// Returns the derivative of the factor at a load factor; at a kink, the derivative beyond it.
    pub fn rate(&self, load_factor: f64) -> f64 {
        let points = &self.0;
        if points.is_empty() {
            return 1.0;
        }
        let after = points.partition_point(|point| point[0] <= load_factor);
        match (after.checked_sub(1).map(|before| points[before]), points.get(after)) {
            (Some([from, low]), Some([to, high])) => (high - low) / (to - from),
            _ => 0.0,
        }
    }

    /// The load factor up to which two histories are the same because they begin with the same points. They may differ
    /// beyond it, or at it where the rate counts.
    pub fn same_up_to(&self, other: &Self) -> f64 {
        let in_common = self.0.iter().zip(&other.0).take_while(|(one, other)| one == other).count();
        match in_common.checked_sub(1) {
            _ if self == other => f64::INFINITY,
            Some(last) => self.0[last][0],
            None => f64::NEG_INFINITY,
        }
    }

    /// The load factors at which the factor has a kink.
    pub fn kinks(&self) -> impl Iterator<Item = f64> + '_ {
        self.0.iter().map(|point| point[0])
    }
}
