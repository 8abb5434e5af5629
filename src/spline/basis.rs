//! B-spline basis functions and their first two derivatives (NURBS Book, A2.1 and A2.3).

/// Polynomial degrees that the program handles: at least 2, for C¹ continuity, and at most 5, for which kernels are built.
pub const DEGREES: std::ops::RangeInclusive<usize> = 2..=MAX_DEGREE;
pub(super) const MAX_DEGREE: usize = 5;

/// Finds the index s of the knot span with `knots[s] ≤ parameter < knots[s + 1]`, or of the last non-empty span at the end.
/// `knots` is open, of degree `degree`, and `parameter` lies within it.
pub fn find_span(knots: &[f64], degree: usize, parameter: f64) -> usize {
    let last = knots.len() - degree - 2;
    if parameter >= knots[last + 1] {
        return (degree..=last).rev().find(|s| knots[*s] < knots[s + 1]).unwrap_or(last);
    }
    degree + knots[degree + 1..=last].partition_point(|knot| *knot <= parameter)
}

/// The non-empty knot spans (elements) of a knot vector, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct Spans {
    /// Span index s of each element; its basis functions are s − degree ..= s.
    pub index: Vec<usize>,
    /// Parameters at both ends of each element.
    pub bounds: Vec<[f64; 2]>,
}

impl Spans {
    /// Finds the elements of an open knot vector.
    pub fn of(knots: &[f64], degree: usize) -> Self {
        let index: Vec<usize> = (degree..knots.len() - degree - 1).filter(|s| knots[*s] < knots[s + 1]).collect();
        let bounds = index.iter().map(|s| [knots[*s], knots[s + 1]]).collect();
        Self { index, bounds }
    }

    /// The middle of each element in the parameter.
    pub fn middles(&self) -> Vec<f64> {
        self.bounds.iter().map(|[from, to]| 0.5 * (from + to)).collect()
    }

    /// Points that divide each element into so many parts, the ends of all elements among them.
    pub fn samples(&self, parts: usize) -> Vec<f64> {
        let within = |[from, to]: &[f64; 2]| {
            let [from, to] = [*from, *to];
            (0..parts).map(move |k| from + (to - from) * k as f64 / parts as f64)
        };
        self.bounds.iter().flat_map(within).chain(self.bounds.last().map(|[_, end]| *end)).collect()
    }

    /// Number of elements.
    pub fn count(&self) -> usize {
        self.index.len()
    }
}

/// Length of the buffer that [`basis_derivatives`] fills.
pub fn basis_derivatives_len(degree: usize) -> usize {
    3 * (degree + 1)
}

/// Computes values, first and second derivatives of the degree + 1 basis functions that do not vanish on knot span `span`.
/// `out[k * (degree + 1) + a]` is the k-th derivative of function span − degree + a.
pub fn basis_derivatives(knots: &[f64], degree: usize, span: usize, parameter: f64, out: &mut [f64]) {
    let count = degree + 1;
    debug_assert_eq!(out.len(), basis_derivatives_len(degree));
    // table[j][r]: upper triangle basis functions, lower triangle knot differences.
    let mut table = [[0.0; MAX_DEGREE + 1]; MAX_DEGREE + 1];
    let mut left = [0.0; MAX_DEGREE + 1];
    let mut right = [0.0; MAX_DEGREE + 1];
    table[0][0] = 1.0;
    for j in 1..=degree {
        left[j] = parameter - knots[span + 1 - j];
        right[j] = knots[span + j] - parameter;
        let mut saved = 0.0;
        for r in 0..j {
            table[j][r] = right[r + 1] + left[j - r];
            let quotient = table[r][j - 1] / table[j][r];
            table[r][j] = saved + right[r + 1] * quotient;
            saved = left[j - r] * quotient;
        }
        table[j][j] = saved;
    }
    for a in 0..count {
        out[a] = table[a][degree];
    }
    let mut coefficients = [[0.0; MAX_DEGREE + 1]; 2];
    for r in 0..count {
        let (mut old, mut new) = (0, 1);
        coefficients[0][0] = 1.0;
        let mut factor = 1.0;
        for k in 1..=2.min(degree) {
            let mut sum = 0.0;
            let lower = degree - k;
            if r >= k {
                coefficients[new][0] = coefficients[old][0] / table[lower + 1][r - k];
                sum = coefficients[new][0] * table[r - k][lower];
            }
            let first = if r + 1 >= k { 1 } else { k - r };
            let last = if r <= lower + 1 { k - 1 } else { degree - r };
            for j in first..=last {
                coefficients[new][j] = (coefficients[old][j] - coefficients[old][j - 1]) / table[lower + 1][r + j - k];
                sum += coefficients[new][j] * table[r + j - k][lower];
            }
            if r <= lower {
                coefficients[new][k] = -coefficients[old][k - 1] / table[lower + 1][r];
                sum += coefficients[new][k] * table[r][lower];
            }
            factor *= (degree + 1 - k) as f64;
            out[k * count + r] = sum * factor;
            std::mem::swap(&mut old, &mut new);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOTS: [f64; 10] = [0.0, 0.0, 0.0, 0.0, 0.3, 0.7, 1.0, 1.0, 1.0, 1.0];

    #[test]
    fn functions_sum_to_one_and_derivatives_match_finite_differences() {
        let step = 1e-5;
        let at = |x: f64| {
            let span = find_span(&KNOTS, 3, x);
            let mut out = [0.0; 12];
            basis_derivatives(&KNOTS, 3, span, x, &mut out);
            out
        };
        for x in [0.1, 0.29, 0.5, 0.8] {
            let (here, before, after) = (at(x), at(x - step), at(x + step));
            assert!((here[..4].iter().sum::<f64>() - 1.0).abs() < 1e-15);
            for a in 0..4 {
                let first = (after[a] - before[a]) / (2.0 * step);
                let second = (after[4 + a] - before[4 + a]) / (2.0 * step);
                assert!((first - here[4 + a]).abs() < 1e-8, "{first} {}", here[4 + a]);
                assert!((second - here[8 + a]).abs() < 1e-7, "{second} {}", here[8 + a]);
            }
        }
    }

    #[test]
    fn spans_are_found_at_knots_and_at_the_end() {
        assert_eq!(find_span(&KNOTS, 3, 0.0), 3);
        assert_eq!(find_span(&KNOTS, 3, 0.3), 4);
        assert_eq!(find_span(&KNOTS, 3, 1.0), 5);
        assert_eq!(Spans::of(&KNOTS, 3).index, [3, 4, 5]);
    }
}
