//! Rotations by rotation vectors, with their first and second derivatives.
//!
//! exp(ω) = I + a Ω + b Ω², with Ω x = ω × x, a = sin θ/θ, b = (1 − cos θ)/θ², θ = |ω| (Rodrigues). Both are functions of t = θ²,
//! so that nothing is singular at ω = 0; derivatives follow from ∂t/∂ω_k = 2 ω_k.

use crate::shell::dot;

type Matrix = [[f64; 3]; 3];

/// The rotation exp(ω) and its derivatives with respect to ω.
#[derive(Clone, Debug)]
pub struct Rotation {
    /// Change exp(ω) − I, without cancellation at small angles.
    pub change: Matrix,
    /// First derivatives ∂exp/∂ω_k.
    pub first: [Matrix; 3],
    /// Second derivatives ∂²exp/∂ω_k∂ω_l.
    pub second: [[Matrix; 3]; 3],
}

impl Rotation {
    /// Computes exp(ω) and its derivatives at a rotation vector ω, radians.
    pub fn new(vector: [f64; 3]) -> Self {
        let square: f64 = vector.iter().map(|x| x * x).sum();
        let [a, b] = [series(square, 1), series(square, 2)];
        let spin = skew(vector);
        let spin_square = product(spin, spin);
        let units = [0, 1, 2].map(|k| skew([0, 1, 2].map(|c| f64::from(u8::from(c == k)))));
        let mixed = units.map(|unit| sum(&[(1.0, product(unit, spin)), (1.0, product(spin, unit))]));
        let first = [0, 1, 2].map(|k| {
            let rate = 2.0 * vector[k];
            sum(&[(rate * a[1], spin), (a[0], units[k]), (rate * b[1], spin_square), (b[0], mixed[k])])
        });
        let second = [0, 1, 2].map(|k| {
            [0, 1, 2].map(|l| {
                let same = if k == l { 2.0 } else { 0.0 };
                let curvature = |f: [f64; 3]| same * f[1] + 4.0 * vector[k] * vector[l] * f[2];
                let both = sum(&[(1.0, product(units[k], units[l])), (1.0, product(units[l], units[k]))]);
                let (to_k, to_l) = (2.0 * vector[k], 2.0 * vector[l]);
                sum(&[
                    (curvature(a), spin),
                    (to_k * a[1], units[l]),
                    (to_l * a[1], units[k]),
                    (curvature(b), spin_square),
                    (to_k * b[1], mixed[l]),
                    (to_l * b[1], mixed[k]),
                    (b[0], both),
                ])
            })
        });
        Self { change: sum(&[(a[0], spin), (b[0], spin_square)]), first, second }
    }

    /// Rotates a vector: exp(ω) x.
    pub fn turn(&self, x: [f64; 3]) -> [f64; 3] {
        let change = apply(&self.change, x);
        [0, 1, 2].map(|c| x[c] + change[c])
    }

    /// Rotates a vector back: exp(ω)ᵀ x = exp(−ω) x.
    pub fn turn_back(&self, x: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|c| x[c] + (0..3).map(|row| self.change[row][c] * x[row]).sum::<f64>())
    }
}

/// Number of terms of the series: enough for three full turns.
const TERMS: usize = 40;

/// Sums Σ cₙ tⁿ with cₙ = (−1)ⁿ / (2n + order)!, and its first two derivatives in t: order 1 is sin θ/θ, order 2 is (1
/// − cos θ)/θ². The terms grow to e^θ before they fall: up to a full turn three digits are lost at most.
fn series(t: f64, order: u32) -> [f64; 3] {
    let mut coefficients = [0.0; TERMS];
    let mut coefficient = if order == 1 { 1.0 } else { 0.5 };
    for (n, slot) in coefficients.iter_mut().enumerate() {
        *slot = coefficient;
        let last = (2 * n) as f64 + f64::from(order);
        coefficient /= -(last + 1.0) * (last + 2.0);
    }
    let mut sums = [0.0; 3];
    for (n, c) in coefficients.iter().enumerate().rev() {
        let n = n as f64;
        sums[0] = sums[0] * t + c;
        if n >= 1.0 {
            sums[1] = sums[1] * t + n * c;
        }
        if n >= 2.0 {
            sums[2] = sums[2] * t + n * (n - 1.0) * c;
        }
    }
    sums
}

/// Matrix of y ↦ x × y.
fn skew(x: [f64; 3]) -> Matrix {
    [[0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]]
}

fn product(a: Matrix, b: Matrix) -> Matrix {
    a.map(|row| [0, 1, 2].map(|j| (0..3).map(|k| row[k] * b[k][j]).sum()))
}

fn sum(parts: &[(f64, Matrix)]) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| parts.iter().map(|(factor, matrix)| factor * matrix[i][j]).sum()))
}

/// Multiplies a matrix by a vector.
pub fn apply(matrix: &Matrix, x: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| dot(row, x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_rotation_and_the_rotation_is_one() {
        for vector in [[0.0; 3], [1e-5, -2e-5, 1e-5], [0.3, -0.2, 0.5], [1.0, 2.0, -1.5], [0.0, 6.0, 0.0]] {
            let here = Rotation::new(vector);
            let x = [0.3, -1.0, 0.7];
            let turned = here.turn(x);
            assert!((dot(turned, turned) - dot(x, x)).abs() < 1e-12);
            let step = 1e-5;
            for k in 0..3 {
                let moved = |sign: f64| {
                    let mut other = vector;
                    other[k] += sign * step;
                    Rotation::new(other)
                };
                let (plus, minus) = (moved(1.0), moved(-1.0));
                for i in 0..3 {
                    for j in 0..3 {
                        let slope = (plus.change[i][j] - minus.change[i][j]) / (2.0 * step);
                        assert!((slope - here.first[k][i][j]).abs() < 1e-9, "{vector:?} {k}");
                        for l in 0..3 {
                            let slope = (plus.first[l][i][j] - minus.first[l][i][j]) / (2.0 * step);
                            assert!((slope - here.second[k][l][i][j]).abs() < 1e-9, "{vector:?} {k} {l}");
                        }
                    }
                }
            }
        }
        let quarter = Rotation::new([0.0, std::f64::consts::FRAC_PI_2, 0.0]).turn([1.0, 0.0, 0.0]);
        assert!((quarter[2] + 1.0).abs() < 1e-15 && quarter[0].abs() < 1e-15);
    }
}
