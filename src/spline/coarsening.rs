//! Splines on fewer knots: the best approximation of what a finer space holds.

use crate::spline::{control_count, find_span};

/// Maps control values along one direction from a space to the coarser one that lacks some of its knots: those values of the
/// coarser space whose refinement differs least from the given ones, in the sum of squares.
///
/// What lies in the coarser space comes out exactly, since refinement and approximation undo each other there.
#[derive(Clone, Debug)]
pub struct Coarsening {
    /// For each fine control value its first coarse one and the p + 1 shares of refinement (discrete B-splines).
    refinement: Vec<(usize, Vec<f64>)>,
    /// Lower triangular Cholesky factor of the normal equations, row by row: entries i − p ..= i.
    factor: Vec<Vec<f64>>,
}

impl Coarsening {
    /// Builds the map between two open knot vectors of one degree; the knots of `coarse` are among those of `fine`.
    pub fn new(fine: &[f64], coarse: &[f64], degree: usize) -> Self {
        let rows = 0..control_count(fine, degree);
        let refinement: Vec<_> = rows.map(|row| discrete_splines(fine, coarse, degree, row)).collect();
        let factor = cholesky(normal_equations(&refinement, control_count(coarse, degree), degree));
        Self { refinement, factor }
    }

    /// Finds the coarse control values whose refinement is nearest to `fine`.
    pub fn coarsened(&self, fine: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut sums = vec![[0.0; 3]; self.factor.len()];
        for ((first, shares), value) in self.refinement.iter().zip(fine) {
            for (k, share) in shares.iter().enumerate() {
                (0..3).for_each(|c| sums[first + k][c] += share * value[c]);
            }
        }
        self.solve(&mut sums);
        sums
    }

    /// Refines coarse control values, exactly.
    pub fn refined(&self, coarse: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let value = |(first, shares): &(usize, Vec<f64>)| {
            let mut sum = [0.0; 3];
            for (share, point) in shares.iter().zip(&coarse[*first..]) {
                (0..3).for_each(|c| sum[c] += share * point[c]);
            }
            sum
        };
        self.refinement.iter().map(value).collect()
    }

    /// Forward and back substitution.
    fn solve(&self, values: &mut [[f64; 3]]) {
        let below = self.factor.first().map_or(0, Vec::len) - 1;
        for i in 0..values.len() {
            for j in i.saturating_sub(below)..i {
                let entry = self.factor[i][below + j - i];
                (0..3).for_each(|c| values[i][c] -= entry * values[j][c]);
            }
            values[i] = values[i].map(|value| value / self.factor[i][below]);
        }
        for i in (0..values.len()).rev() {
            values[i] = values[i].map(|value| value / self.factor[i][below]);
            for j in i.saturating_sub(below)..i {
                let entry = self.factor[i][below + j - i];
                (0..3).for_each(|c| values[j][c] -= entry * values[i][c]);
            }
        }
    }
}

/// The shares that coarse control values have in a fine one, and the first of them (the Oslo algorithm: Cohen, Lyche &
/// Riesenfeld, "Discrete B-splines and subdivision techniques", 1980).
fn discrete_splines(fine: &[f64], coarse: &[f64], degree: usize, row: usize) -> (usize, Vec<f64>) {
    let span = find_span(coarse, degree, fine[row]);
    let mut shares = vec![1.0];
    for k in 1..=degree {
        let mut next = vec![0.0; k + 1];
        for (r, share) in shares.iter().enumerate() {
            let j = span + 1 + r - k;
            let right = (fine[row + k] - coarse[j]) / (coarse[j + k] - coarse[j]);
            next[r] += (1.0 - right) * share;
            next[r + 1] += right * share;
        }
        shares = next;
    }
    (span - degree, shares)
}

/// The lower band of AᵀA, row by row.
fn normal_equations(rows: &[(usize, Vec<f64>)], count: usize, degree: usize) -> Vec<Vec<f64>> {
    let mut band = vec![vec![0.0; degree + 1]; count];
    for (first, shares) in rows {
        for (a, share) in shares.iter().enumerate() {
            for (b, other) in shares.iter().enumerate().take(a + 1) {
                band[first + a][degree + b - a] += share * other;
            }
        }
    }
    band
}

/// Replaces the lower band of a positive definite matrix by its Cholesky factor.
fn cholesky(mut band: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let below = band.first().map_or(0, Vec::len) - 1;
    for i in 0..band.len() {
        for j in i.saturating_sub(below)..=i {
            let from = i.saturating_sub(below).max(j.saturating_sub(below));
            let product: f64 = (from..j).map(|k| band[i][below + k - i] * band[j][below + k - j]).sum();
            let rest = band[i][below + j - i] - product;
            band[i][below + j - i] = if i == j { rest.sqrt() } else { rest / band[j][below] };
        }
    }
    band
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::insert_knots;

    fn spaces(degree: usize) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let mut coarse = vec![0.0; degree + 1];
        coarse.extend([0.2, 0.5, 0.5]);
        coarse.extend(vec![1.0; degree + 1]);
        let new = vec![0.1, 0.3, 0.35, 0.75];
        let (fine, _) = insert_knots(&coarse, degree, &vec![0.0; coarse.len() - degree - 1], 1, &new);
        (coarse, fine, new)
    }

    fn points(count: usize, seed: usize) -> Vec<[f64; 3]> {
        let value = |i: usize| ((seed * i * i + 5 * i + 3) % 17) as f64 - 8.0;
        (0..count).map(|i| [value(i), value(i + 7), value(2 * i)]).collect()
    }

    #[test]
    fn what_lies_in_the_coarser_space_comes_back() {
        for degree in 2..=5 {
            let (coarse, fine, new) = spaces(degree);
            let values = points(control_count(&coarse, degree), 2);
            let map = Coarsening::new(&fine, &coarse, degree);
            let (_, inserted) = insert_knots(&coarse, degree, values.as_flattened(), 3, &new);
            let refined = map.refined(&values);
            for (a, b) in refined.as_flattened().iter().zip(&inserted) {
                assert!((a - b).abs() < 1e-13, "{degree}");
            }
            for (a, b) in map.coarsened(&refined).as_flattened().iter().zip(values.as_flattened()) {
                assert!((a - b).abs() < 1e-11, "{degree}: {a} {b}");
            }
        }
    }

    #[test]
    fn what_is_left_is_orthogonal_to_the_coarser_space() {
        for degree in 2..=5 {
            let (coarse, fine, _) = spaces(degree);
            let values = points(control_count(&fine, degree), 3);
            let map = Coarsening::new(&fine, &coarse, degree);
            let near = map.refined(&map.coarsened(&values));
            let left: Vec<[f64; 3]> = values.iter().zip(near).map(|(a, b)| [0, 1, 2].map(|c| a[c] - b[c])).collect();
            assert!(left.as_flattened().iter().any(|value| value.abs() > 0.1));
            for (first, _) in &map.refinement {
                for k in 0..=degree {
                    let mut one = vec![[0.0; 3]; control_count(&coarse, degree)];
                    one[first + k] = [1.0; 3];
                    let product: f64 =
                        map.refined(&one).iter().zip(&left).map(|(a, b)| a[0] * b[0] + a[1] * b[1] + a[2] * b[2]).sum();
                    assert!(product.abs() < 1e-10, "{degree}: {product}");
                }
            }
        }
    }
}
