//! Lengths of motions of a shell.
//!
//! About the root mean square over the parameter domain: a sum over control points with the integrals of the B-splines as
//! weights (lumped, and without the weights of a NURBS),
//!
//! |u|² = Σ_a m_a |u_a|²,  m_a = ∫N_a dξdη  (Σ m_a = 1),
//!
//! so that a length means nearly the same before and after knots are inserted (it falls towards the integral), on a whole
//! shell and on its quarter. The shells of a structure count alike.

use crate::shell::dot;
use crate::spline::{Mesh, Patch};

/// Weights m_a of the control points of a mesh.
#[derive(Clone, Debug)]
pub(super) struct Metric {
    pub weights: Vec<f64>,
}

impl Metric {
    /// Computes the weights of a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        let share = 1.0 / mesh.patches.len() as f64;
        let of_patch = |patch: &Patch| patch.basis_integrals().into_iter().map(move |integral| share * integral);
        Self { weights: mesh.patches.iter().flat_map(of_patch).collect() }
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
