//! Structures of several shells.

use serde::{Deserialize, Serialize};

use super::geometry::Geometry;
use super::material::Material;
use super::mesh::MeshSpec;

/// A shell of a structure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shell {
    /// What joints, supports, actions and probes call it; no two shells have the same name.
    pub name: String,
    /// Undeformed mid-surface, in the shell's own axes.
    pub geometry: Geometry,
    /// Constitutive law and thickness.
    pub material: Material,
    /// Spline space and quadrature that the run starts with.
    pub mesh: MeshSpec,
    /// Where the shell's own axes lie.
    #[serde(default, skip_serializing_if = "Pose::is_none")]
    pub pose: Pose,
}

/// Position and axes of a shell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Origin of the shell's own axes, mm.
    pub position_mm: [f64; 3],
    /// Unit vectors of the shell's own x, y and z, a right-handed system.
    pub axes: [[f64; 3]; 3],
}

impl Default for Pose {
    fn default() -> Self {
        Self { position_mm: [0.0; 3], axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] }
    }
}

/// Cosine of the angle between two axes that are at right angles, but for rounding.
const SQUARE: f64 = 1e-6;

impl Pose {
    /// Creates the pose whose x axis points along `x`, and its y axis along `y`; both of any length.
    ///
    /// # Errors
    /// The angle between the two, degrees, where they are not at right angles.
    pub fn new(position_mm: [f64; 3], x: [f64; 3], y: [f64; 3]) -> Result<Self, f64> {
        let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|c| a[c] * b[c]).sum::<f64>();
        let unit = |a: [f64; 3]| a.map(|value| value / dot(a, a).sqrt());
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let (x, y) = (unit(x), unit(y));
        let cosine = dot(x, y);
        if cosine.abs() > SQUARE {
            return Err(cosine.clamp(-1.0, 1.0).acos().to_degrees());
        }
        let z = unit(cross(x, y));
        // −0 becomes 0: equal scenes have equal hashes.
        Ok(Self { position_mm, axes: [x, cross(z, x), z].map(|axis| axis.map(|value| value + 0.0)) })
    }

    /// Whether the shell's own axes are those of space.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Turns a vector from the shell's own axes into space.
    pub fn turned(&self, vector: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|c| (0..3).map(|k| vector[k] * self.axes[k][c]).sum())
    }

    /// Moves a point from the shell's own axes into space, mm.
    pub fn placed(&self, point: [f64; 3]) -> [f64; 3] {
        let turned = self.turned(point);
        [0, 1, 2].map(|c| self.position_mm[c] + turned[c])
    }

    /// Finds the coordinates of a point of space in the shell's own axes, mm.
    pub fn own(&self, point: [f64; 3]) -> [f64; 3] {
        let arm = [0, 1, 2].map(|c| point[c] - self.position_mm[c]);
        self.axes.map(|axis| (0..3).map(|c| axis[c] * arm[c]).sum())
    }
}
