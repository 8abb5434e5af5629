//! The undeformed mid-surface. Its parametric directions are u and v; places on it are fractions in [0, 1] of each.

use serde::{Deserialize, Serialize};

/// The undeformed mid-surface of the shell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Geometry {
    /// Open circular cylinder: axis along x, apex of the arc up (+z), edges down. u runs along the axis, v along the
    /// arc towards +y; the normal points outwards.
    TapeSpring {
        /// Length along the axis.
        length_mm: f64,
        /// Radius of the mid-surface of the cross-section.
        radius_mm: f64,
        /// Angle subtended by the whole cross-section, less than 360.
        arc_deg: f64,
    },
    /// Rectangle 0 ≤ x ≤ length, 0 ≤ y ≤ width in the plane z = 0. u runs along x, v along y; the normal is +z.
    Plate {
        /// Extent in x.
        length_mm: f64,
        /// Extent in y.
        width_mm: f64,
    },
    /// As [`Geometry::TapeSpring`], of any arc up to the full turn.
    CylinderPanel {
        /// Length along the axis.
        length_mm: f64,
        /// Radius of the mid-surface.
        radius_mm: f64,
        /// Angle subtended, up to 360.
        arc_deg: f64,
        /// Angle from the top (+z) towards +y at which the arc starts; `None`: −arc/2, so that its middle is on top.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        from_deg: Option<f64>,
        /// What a full turn does where it meets itself; given exactly where `arc_deg` is 360.
        #[serde(skip_serializing_if = "Option::is_none")]
        seam: Option<Seam>,
    },
    /// Ring, or a sector of it, in the plane z = 0 about the origin. u runs from the inner to the outer radius, v
    /// counterclockwise from the +x axis; the normal is +z.
    Annulus {
        /// Inner radius, > 0.
        inner_radius_mm: f64,
        /// Outer radius.
        outer_radius_mm: f64,
        /// Angle, up to 360°.
        arc_deg: f64,
        /// Angle from the +x axis at which it starts; `None`: 0.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        from_deg: Option<f64>,
        /// As for [`Geometry::CylinderPanel`].
        #[serde(skip_serializing_if = "Option::is_none")]
        seam: Option<Seam>,
    },
    /// Part of a sphere about the origin between two latitudes. u runs along the longitude, counterclockwise from the
    /// +x axis seen from +z; v along the latitude towards +z; the normal points outwards.
    SphereZone {
        /// Radius of the mid-surface.
        radius_mm: f64,
        /// From and to, in (−90, 90): the poles are not part of it.
        latitude_deg: [f64; 2],
        /// Longitudes, up to 360.
        arc_deg: f64,
        /// Longitude at which it starts; `None`: 0.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        from_deg: Option<f64>,
        /// As for [`Geometry::CylinderPanel`].
        #[serde(skip_serializing_if = "Option::is_none")]
        seam: Option<Seam>,
    },
    /// Cylinder over a profile of straight pieces and arcs in the y-z plane whose tangent is continuous. u runs along x
    /// from 0, v along the profile; the normal is on the left of the profile as seen with y to the right and z up, so that
    /// a profile towards +y has it on +z. An arc of a positive angle turns to that side.
    Profile {
        /// Length along x.
        length_mm: f64,
        /// Its pieces, in order; at least one.
        profile: Vec<ProfilePiece>,
        /// y and z of the start of the profile.
        start_mm: [f64; 2],
        /// Direction of the profile at its start, from +y towards +z.
        direction_deg: f64,
    },
    /// Any surface of one patch.
    Nurbs(NurbsPatch),
}

impl Geometry {
    /// The word for its kind.
    pub fn word(&self) -> &'static str {
        match self {
            Geometry::TapeSpring { .. } => "tape-spring",
            Geometry::CylinderPanel { .. } => "cylinder-panel",
            Geometry::Plate { .. } => "plate",
            Geometry::Annulus { .. } => "annulus",
            Geometry::SphereZone { .. } => "sphere-zone",
            Geometry::Profile { .. } => "profile",
            Geometry::Nurbs(_) => "nurbs",
        }
    }

    /// What the surface does where it meets itself; `None` where it does not.
    pub fn seam(&self) -> Option<Seam> {
        match self {
            Geometry::CylinderPanel { seam, .. }
            | Geometry::Annulus { seam, .. }
            | Geometry::SphereZone { seam, .. }
            | Geometry::Nurbs(NurbsPatch { seam, .. }) => *seam,
            Geometry::TapeSpring { .. } | Geometry::Plate { .. } | Geometry::Profile { .. } => None,
        }
    }

    /// Vector to a point from the axis of a cylinder or an annulus, or from the centre of a sphere, mm; `None` for
    /// shapes that have neither.
    pub fn away_from_centre(&self, [x, y, z]: [f64; 3]) -> Option<[f64; 3]> {
        match self {
            Geometry::TapeSpring { .. } | Geometry::CylinderPanel { .. } => Some([0.0, y, z]),
            Geometry::Annulus { .. } => Some([x, y, 0.0]),
            Geometry::SphereZone { .. } => Some([x, y, z]),
            Geometry::Plate { .. } | Geometry::Profile { .. } | Geometry::Nurbs(_) => None,
        }
    }
}

/// What happens where a full turn meets itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Seam {
    /// Closed: displacement and slope continue across it.
    Smooth,
    /// Slit: both lips are free edges.
    Free,
}

/// A NURBS surface given by knots, control points and weights.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NurbsPatch {
    /// Polynomial degree of the geometry in u and v, 1 to 5; the mesh may be of a higher one.
    pub degrees: [usize; 2],
    /// Open (clamped) knot vector in u; ascending.
    pub knots_u: Vec<f64>,
    /// Open (clamped) knot vector in v; ascending.
    pub knots_v: Vec<f64>,
    /// (x, y, z) of the control points, mm, not multiplied by their weights; v fastest.
    pub control_points_mm: Vec<[f64; 3]>,
    /// Weights of the control points, > 0, in the same order.
    pub weights: Vec<f64>,
    /// What the surface does where opposite edges coincide; given exactly where some do.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seam: Option<Seam>,
}

/// A piece of a profile.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ProfilePiece {
    /// A straight line in the direction that the profile has.
    Line {
        /// Its length.
        line_mm: f64,
    },
    /// An arc that begins in the direction that the profile has.
    Arc {
        /// Its angle: positive to the left, the side of the normal, and negative to the right.
        arc_deg: f64,
        /// Its radius.
        radius_mm: f64,
    },
}

impl ProfilePiece {
    /// Length along the piece, mm.
    pub fn length_mm(&self) -> f64 {
        match self {
            Self::Line { line_mm } => *line_mm,
            Self::Arc { arc_deg, radius_mm } => radius_mm * arc_deg.abs().to_radians(),
        }
    }

    /// Angle by which it turns, degrees.
    pub fn turn_deg(&self) -> f64 {
        match self {
            Self::Line { .. } => 0.0,
            Self::Arc { arc_deg, .. } => *arc_deg,
        }
    }
}
