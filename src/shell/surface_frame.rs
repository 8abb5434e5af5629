//! Unit vectors of a deformed surface as functions of its tangents a₁, a₂, with two derivatives: the normal, and the normal
//! of an edge within the surface.
//!
//! With w = a₁ × a₂, J = |w| and n = w/J, ∂n_i/∂w_j = (δ_ij − n_i n_j)/J and
//! ∂²n_i/∂w_j∂w_k = −(n_k δ_ij + n_j δ_ik + n_i δ_jk − 3 n_i n_j n_k)/J². An edge along a_r has the unit tangent t = a_r/|a_r|,
//! whose derivatives are of the same form, and the normal a_n = t × n.

use crate::shell::vector::{add, basis_vector, cross, dot, norm, scaled};

/// Number of components of the tangents a₁ and a₂ together.
pub const TANGENTS: usize = 6;

/// A vector as a function of the six components of a₁ and a₂, with its derivatives.
#[derive(Clone, Copy, Debug)]
pub struct FrameVector {
    /// The vector.
    pub value: [f64; 3],
    /// Derivatives, `first[p]` with respect to component p mod 3 of a₁ (p < 3) or a₂.
    pub first: [[f64; 3]; TANGENTS],
    /// Second derivatives, `second[p][q]`.
    pub second: [[[f64; 3]; TANGENTS]; TANGENTS],
}

const ZERO: FrameVector =
    FrameVector { value: [0.0; 3], first: [[0.0; 3]; TANGENTS], second: [[[0.0; 3]; TANGENTS]; TANGENTS] };

impl FrameVector {
    /// The unit normal of the surface.
    pub fn normal([a1, a2]: [[f64; 3]; 2]) -> Self {
        let mut product = ZERO;
        product.value = cross(a1, a2);
        for e in 0..3 {
            product.first[e] = cross(basis_vector(e), a2);
            product.first[3 + e] = cross(a1, basis_vector(e));
            for f in 0..3 {
                let mixed = cross(basis_vector(e), basis_vector(f));
                product.second[e][3 + f] = mixed;
                product.second[3 + f][e] = mixed;
            }
        }
        product.normalized()
    }

    /// The unit normal, within the surface, of an edge along a₁ or a₂ (`running` 0 or 1).
    pub fn edge_normal(tangents: [[f64; 3]; 2], running: usize) -> Self {
        let mut along = ZERO;
        along.value = tangents[running];
        (0..3).for_each(|e| along.first[3 * running + e] = basis_vector(e));
        along.normalized().cross(&Self::normal(tangents))
    }

    /// The sum of some vectors with these factors.
    pub fn combined(vectors: &[Self; 3], factors: [f64; 3]) -> Self {
        let mut sum = ZERO;
        for (vector, factor) in vectors.iter().zip(factors) {
            sum.value = add(sum.value, scaled(factor, vector.value));
            for p in 0..TANGENTS {
                sum.first[p] = add(sum.first[p], scaled(factor, vector.first[p]));
                for q in 0..TANGENTS {
                    sum.second[p][q] = add(sum.second[p][q], scaled(factor, vector.second[p][q]));
                }
            }
        }
        sum
    }

    /// The vector divided by its length.
    fn normalized(&self) -> Self {
        let length = norm(self.value);
        let n = scaled(1.0 / length, self.value);
        // Derivatives by the vector itself, contracted with those of the vector.
        let along = self.first.map(|first| dot(n, first));
        let mut unit = ZERO;
        unit.value = n;
        for p in 0..TANGENTS {
            unit.first[p] = scaled(1.0 / length, add(self.first[p], scaled(-along[p], n)));
        }
        for p in 0..TANGENTS {
            for q in 0..TANGENTS {
                let (x, y) = (self.first[p], self.first[q]);
                let bent = add(add(scaled(along[q], x), scaled(along[p], y)), {
                    let share = dot(x, y) - 3.0 * along[p] * along[q];
                    scaled(share, n)
                });
                let second = self.second[p][q];
                let turned = scaled(1.0 / length, add(second, scaled(-dot(n, second), n)));
                unit.second[p][q] = add(turned, scaled(-1.0 / (length * length), bent));
            }
        }
        unit
    }

    /// The vector product with another such vector.
    pub fn cross(&self, other: &Self) -> Self {
        let mut product = ZERO;
        product.value = cross(self.value, other.value);
        for p in 0..TANGENTS {
            product.first[p] = add(cross(self.first[p], other.value), cross(self.value, other.first[p]));
            for q in 0..TANGENTS {
                let ends = add(cross(self.second[p][q], other.value), cross(self.value, other.second[p][q]));
                let mixed = add(cross(self.first[p], other.first[q]), cross(self.first[q], other.first[p]));
                product.second[p][q] = add(ends, mixed);
            }
        }
        product
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AT: [f64; 6] = [1.1, 0.3, -0.2, -0.4, 0.9, 0.35];

    fn tangents(at: [f64; 6]) -> [[f64; 3]; 2] {
        [[at[0], at[1], at[2]], [at[3], at[4], at[5]]]
    }

    /// Derivatives by finite differences, link by link.
    #[test]
    fn derivatives_are_those_of_the_vectors() {
        type Vector = fn([[f64; 3]; 2]) -> FrameVector;
        let vectors: [Vector; 3] =
            [FrameVector::normal, |a| FrameVector::edge_normal(a, 0), |a| FrameVector::edge_normal(a, 1)];
        let step = 1e-6;
        for vector in vectors {
            let here = vector(tangents(AT));
            assert!((norm(here.value) - 1.0).abs() < 1e-15);
            for p in 0..TANGENTS {
                let beside = |sign: f64| {
                    let mut at = AT;
                    at[p] += sign * step;
                    vector(tangents(at))
                };
                let (after, before) = (beside(1.0), beside(-1.0));
                for c in 0..3 {
                    let slope = (after.value[c] - before.value[c]) / (2.0 * step);
                    assert!((slope - here.first[p][c]).abs() < 1e-9, "{p} {c}: {slope} {}", here.first[p][c]);
                    for q in 0..TANGENTS {
                        let bend = (after.first[q][c] - before.first[q][c]) / (2.0 * step);
                        assert!((bend - here.second[p][q][c]).abs() < 1e-8, "{p} {q} {c}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_normal_of_an_edge_lies_in_the_surface_square_to_it() {
        let [a1, a2] = tangents(AT);
        for (running, along) in [a1, a2].into_iter().enumerate() {
            let edge = FrameVector::edge_normal([a1, a2], running).value;
            assert!(dot(edge, along).abs() < 1e-15 && dot(edge, FrameVector::normal([a1, a2]).value).abs() < 1e-15);
        }
    }
}
