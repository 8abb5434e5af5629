//! Lengths of motions of a shell.
//!
//! About the root mean square over the parameter domain: a sum over control points with the integrals of the B-splines as
//! weights (lumped, and without the weights of a NURBS),
//!
//! |u|² = Σ_a m_a |u_a|²,  m_a = ∫N_a dξdη  (Σ m_a = 1),
//!
//! so that a length means nearly the same before and after knots are inserted (it falls towards the integral), on a whole
//! shell and on its quarter.

use crate::shell::dot;
use crate::spline::Mesh;

/// Weights m_a of the control points of a mesh.
#[derive(Clone, Debug)]
pub(super) struct Metric {
    pub weights: Vec<f64>,
}

impl Metric {
    /// Computes the weights of a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        Self { weights: mesh.basis_integrals() }
    }

    /// Inner product Σ m a·b of two motions.
    pub fn product(&self, a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
        self.weights.iter().zip(a.iter().zip(b)).map(|(m, (a, b))| m * dot(*a, *b)).sum()
    }

    /// Length of a motion of the control points.
    pub fn length(&self, motion: &[[f64; 3]]) -> f64 {
        self.product(motion, motion).sqrt()
    }
}
