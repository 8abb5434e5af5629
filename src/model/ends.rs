//! A rigid end section that turns about the transverse axis (y) through its centroid.

use crate::scene::{Geometry, Scene, Sense};

/// An end section: all of its motion follows from the end rotation θ of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidEnd {
    /// Centroid of the undeformed section, mm.
    pub centre: [f64; 3],
    /// Sense of its turn about +y: the section turns by `sign` · θ.
    pub sign: f64,
    /// Whether it slides freely along x.
    pub slides: bool,
}

impl RigidEnd {
    /// The ends of the whole shell at x = 0 and x = length. The first slides, so that there is no axial force; the
    /// other, or the plane of symmetry in its place, holds the shell along x.
    pub fn both(scene: &Scene) -> [Self; 2] {
        let Geometry::TapeSpring { length_mm, radius_mm, arc_deg } = scene.geometry else { todo!() };
        let half = arc_deg.to_radians() / 2.0;
        let height = radius_mm * half.sin() / half;
        // Opposite sense: the free edges (below the centroid) are stretched, so the end at x = length turns by −θ.
        let sign = match scene.end_rotation().unwrap().sense {
            Sense::Opposite => 1.0,
            Sense::Equal => -1.0,
        };
        [
            Self { centre: [0.0, 0.0, height], sign, slides: true },
            Self { centre: [length_mm, 0.0, height], sign: -sign, slides: false },
        ]
    }

    /// Rotation matrix about y at end rotation `theta` (radians).
    pub fn rotation(&self, theta: f64) -> [[f64; 3]; 3] {
        let (sin, cos) = (self.sign * theta).sin_cos();
        [[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]]
    }

    /// Derivative of [`Self::rotation`] with respect to θ.
    pub fn rotation_rate(&self, theta: f64) -> [[f64; 3]; 3] {
        let (sin, cos) = (self.sign * theta).sin_cos();
        [[-sin, 0.0, cos], [0.0; 3], [-cos, 0.0, -sin]].map(|row: [f64; 3]| row.map(|value| self.sign * value))
    }

    /// Displacement of a material point that turns with the section; exact to rounding for small θ too.
    pub fn displacement(&self, theta: f64, point: [f64; 3]) -> [f64; 3] {
        let sin = (self.sign * theta).sin();
        let versine = 2.0 * (theta / 2.0).sin().powi(2);
        let (x, z) = (point[0] - self.centre[0], point[2] - self.centre[2]);
        [sin * z - versine * x, 0.0, -sin * x - versine * z]
    }

    /// Derivative of [`Self::displacement`] with respect to θ.
    pub fn displacement_rate(&self, theta: f64, point: [f64; 3]) -> [f64; 3] {
        let [first, _, last] = self.rotation_rate(theta);
        let (x, z) = (point[0] - self.centre[0], point[2] - self.centre[2]);
        [first[0] * x + first[2] * z, 0.0, last[0] * x + last[2] * z]
    }
}
