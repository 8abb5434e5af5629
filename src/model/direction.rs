//! Directions that the undeformed surface defines at a point.

use crate::scene::{Edge, ParametricDirection, Scene, SurfaceDirection};
use crate::shell::{cross, dot, norm, scaled, sub};

/// A point of the undeformed surface.
#[derive(Clone, Copy, Debug)]
pub struct Site {
    /// Position, mm.
    pub position: [f64; 3],
    /// Tangents A₁, A₂.
    pub tangents: [[f64; 3]; 2],
    /// Edge that the point is taken to lie on, if any.
    pub edge: Option<Edge>,
}

/// Unit vector of a direction at a point; zero where there is none: on the axis, away from an edge, and where the
/// surface collapses.
pub fn direction_at(scene: &Scene, site: &Site, direction: SurfaceDirection) -> [f64; 3] {
    let [a1, a2] = site.tangents;
    let vector = match direction {
        SurfaceDirection::Normal => cross(a1, a2),
        SurfaceDirection::Radial => scene.away_from_centre(site.position).unwrap_or_default(),
        SurfaceDirection::Outward => site.edge.map_or([0.0; 3], |edge| outward(site.tangents, edge)),
    };
    let length = norm(vector);
    if length > 0.0 { scaled(1.0 / length, vector) } else { [0.0; 3] }
}

/// Tangent across an edge, out of the shell, less its component along the edge.
fn outward(tangents: [[f64; 3]; 2], edge: Edge) -> [f64; 3] {
    let (direction, at_end) = edge.side();
    let [across, along] = match direction {
        ParametricDirection::U => tangents,
        ParametricDirection::V => [tangents[1], tangents[0]],
    };
    let square = sub(across, scaled(dot(across, along) / dot(along, along), along));
    scaled(if at_end { 1.0 } else { -1.0 }, square)
}
