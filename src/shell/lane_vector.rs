//! Vectors of three components, each of which is a number for every point of a batch.

use super::lanes::FourLanes;

/// a·b.
#[inline(always)]
pub(super) fn dot<V: FourLanes>(a: [V; 3], b: [V; 3]) -> V {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// a × b.
#[inline(always)]
pub(super) fn cross<V: FourLanes>(a: [V; 3], b: [V; 3]) -> [V; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// a + b.
#[inline(always)]
pub(super) fn add<V: FourLanes>(a: [V; 3], b: [V; 3]) -> [V; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// a − b.
#[inline(always)]
pub(super) fn sub<V: FourLanes>(a: [V; 3], b: [V; 3]) -> [V; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// A number times a vector.
#[inline(always)]
pub(super) fn scaled<V: FourLanes>(factor: V, a: [V; 3]) -> [V; 3] {
    [factor * a[0], factor * a[1], factor * a[2]]
}

/// Σ factors_i vectors_i.
#[inline(always)]
pub(super) fn combination<V: FourLanes>(factors: [V; 3], vectors: [[V; 3]; 3]) -> [V; 3] {
    let mut sum = scaled(factors[0], vectors[0]);
    for i in 1..3 {
        for c in 0..3 {
            sum[c] = factors[i].mul_add(vectors[i][c], sum[c]);
        }
    }
    sum
}

/// a bᵀ.
#[inline(always)]
pub(super) fn outer<V: FourLanes>(a: [V; 3], b: [V; 3]) -> [[V; 3]; 3] {
    [scaled(a[0], b), scaled(a[1], b), scaled(a[2], b)]
}

/// Adds a bᵀ.
#[inline(always)]
pub(super) fn accumulate<V: FourLanes>(block: &mut [[V; 3]; 3], a: [V; 3], b: [V; 3]) {
    for c in 0..3 {
        for d in 0..3 {
            block[c][d] = a[c].mul_add(b[d], block[c][d]);
        }
    }
}
