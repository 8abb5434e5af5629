//! Structures of several shells.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::{Geometry, Material, MeshSpec, Region, Scene, Support};

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

impl Support {
    /// What the support is on one shell: a section of several shells is one on the edge of each.
    fn of_shell(&self, shell: usize) -> Option<Self> {
        let edges = self.also.iter().filter(|also| also.shell == shell).map(|also| Region::Edge(also.edge));
        let on = (self.shell == shell).then_some(self.on).into_iter().chain(edges).next()?;
        Some(Self { on, shell: 0, also: Vec::new(), ..self.clone() })
    }
}

impl Scene {
    /// Direction away from the axis or the centre of the shell at a point; `None` where the geometry has neither.
    pub fn away_from_centre(&self, point: [f64; 3]) -> Option<[f64; 3]> {
        self.geometry.away_from_centre(self.pose.own(point)).map(|direction| self.pose.turned(direction))
    }

    /// Number of shells.
    pub fn shell_count(&self) -> usize {
        self.shells.len().max(1)
    }

    /// Name of a shell; `None` where the scene has one shell, which has no name.
    pub fn shell_name(&self, shell: usize) -> Option<&str> {
        self.shells.get(shell).map(|shell| &*shell.name)
    }

    /// The scene of one shell alone, with the supports, actions and probes that are its own, and the actions on all shells.
    /// A scene of one shell is returned as it is.
    pub fn of_shell(&self, shell: usize) -> Cow<'_, Scene> {
        let Some(own) = self.shells.get(shell) else { return Cow::Borrowed(self) };
        let supports = self.supports.iter().filter_map(|support| support.of_shell(shell));
        let actions = self.actions.iter().filter(|action| action.shell.is_none_or(|on| on == shell)).cloned();
        let probes = self.probes.iter().filter(|probe| probe.shell == shell).cloned();
        Cow::Owned(Scene {
            geometry: own.geometry.clone(),
            material: own.material.clone(),
            mesh: own.mesh.clone(),
            pose: own.pose,
            supports: supports.collect(),
            actions: actions.collect(),
            probes: probes.collect(),
            shells: Vec::new(),
            joints: Vec::new(),
            bonds: Vec::new(),
            ..self.clone()
        })
    }
}
