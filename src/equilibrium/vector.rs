//! Plain sums over vectors.

use crate::shell::{dot, norm};

/// Inner product Σ a b of two vectors.
pub(super) fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Euclidean length of forces on all control points.
pub(super) fn length(forces: &[[f64; 3]]) -> f64 {
    forces.iter().map(|force| dot(*force, *force)).sum::<f64>().sqrt()
}

/// Scales a field to a largest length of 1; returns where it is longest, and how long it was there.
pub(super) fn scale_to_one(field: &mut [[f64; 3]]) -> (usize, f64) {
    let lengths: Vec<f64> = field.iter().map(|vector| norm(*vector)).collect();
    let at = largest(&lengths);
    let length = lengths[at];
    field.iter_mut().for_each(|vector| *vector = vector.map(|value| value / length));
    (at, length)
}

/// Index of the largest magnitude; the first of equals.
pub(super) fn largest(vector: &[f64]) -> usize {
    (0..vector.len()).fold(0, |best, i| if vector[i].abs() > vector[best].abs() { i } else { best })
}
