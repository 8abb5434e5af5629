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
    /// Of a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        // ∫N_i dξ = (ξ_{i+p+1} − ξ_i)/(p + 1): de Boor, A Practical Guide to Splines, chapter X.
        let ways = [0, 1].map(|way| {
            let (knots, degree) = (&mesh.knots[way], mesh.degree[way]);
            let total = knots[knots.len() - 1] - knots[0];
            let integral = |i: usize| (knots[i + degree + 1] - knots[i]) / ((degree + 1) as f64 * total);
            (0..knots.len() - degree - 1).map(integral).collect::<Vec<f64>>()
        });
        Self { weights: ways[0].iter().flat_map(|along| ways[1].iter().map(move |across| along * across)).collect() }
    }

    /// Σ m a·b.
    pub fn product(&self, a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
        self.weights.iter().zip(a.iter().zip(b)).map(|(m, (a, b))| m * dot(*a, *b)).sum()
    }

    /// Length of a motion of the control points.
    pub fn length(&self, motion: &[[f64; 3]]) -> f64 {
        self.product(motion, motion).sqrt()
    }
}
