//! Knot insertion (Boehm's algorithm, NURBS Book A5.1): the same curve in a larger space, exactly.

use crate::spline::find_span;

/// Inserts `new` knots (sorted, inside the open interval) into rows of control data along one direction.
///
/// `data` holds control rows of `width` numbers: row i is `data[i * width ..][.. width]`. Returns knots and data of the
/// larger space. Any linear control data may be passed (homogeneous coordinates, weighted displacements).
pub fn insert_knots(knots: &[f64], degree: usize, data: &[f64], width: usize, new: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut knots = knots.to_vec();
    let mut rows = data.to_vec();
    let mut fresh = vec![0.0; degree * width];
    for knot in new {
        let span = find_span(&knots, degree, *knot);
        // Rows span − degree + 1 ..= span become convex combinations; one row more than before.
        for (slot, row) in (span - degree + 1..=span).enumerate() {
            let share = (knot - knots[row]) / (knots[row + degree] - knots[row]);
            for c in 0..width {
                fresh[slot * width + c] = share * rows[row * width + c] + (1.0 - share) * rows[(row - 1) * width + c];
            }
        }
        let kept = (span - degree + 1) * width..span * width;
        rows.splice(kept, fresh.iter().copied());
        knots.insert(span + 1, *knot);
    }
    (knots, rows)
}

/// Inserts knots, as [`insert_knots`] does, for control points of `N` numbers each on a tensor-product net of `counts`
/// points (second direction fastest), along `direction` 0 or 1.
pub fn insert_knots_into_net<const N: usize>(
    knots: &[f64],
    degree: usize,
    net: &[[f64; N]],
    counts: [usize; 2],
    direction: usize,
    new: &[f64],
) -> (Vec<f64>, Vec<[f64; N]>) {
    let [n1, n2] = counts;
    if direction == 0 {
        let (knots, rows) = insert_knots(knots, degree, net.as_flattened(), n2 * N, new);
        return (knots, rows.as_chunks::<N>().0.to_vec());
    }
    // Along the second direction: transpose, so that a row is all points with the same second index.
    let transposed: Vec<f64> = (0..n2).flat_map(|j| (0..n1).flat_map(move |i| net[i * n2 + j])).collect();
    let (knots, rows) = insert_knots(knots, degree, &transposed, n1 * N, new);
    let points = rows.as_chunks::<N>().0;
    let wider = n2 + new.len();
    let net = (0..n1 * wider).map(|k| points[(k % wider) * n1 + k / wider]).collect();
    (knots, net)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::basis_derivatives;

    fn value(knots: &[f64], degree: usize, points: &[f64], x: f64) -> f64 {
        let span = find_span(knots, degree, x);
        let mut basis = vec![0.0; 3 * (degree + 1)];
        basis_derivatives(knots, degree, span, x, &mut basis);
        (0..=degree).map(|a| basis[a] * points[span - degree + a]).sum()
    }

    #[test]
    fn the_curve_is_unchanged() {
        for degree in 2..=5 {
            let mut knots = vec![0.0; degree + 1];
            knots.extend([0.25, 0.5, 0.5]);
            knots.extend(vec![1.0; degree + 1]);
            let points: Vec<f64> = (0..knots.len() - degree - 1).map(|i| ((7 * i + 3) % 11) as f64).collect();
            let (finer, raised) = insert_knots(&knots, degree, &points, 1, &[0.1, 0.25, 0.6, 0.9]);
            assert_eq!(raised.len(), points.len() + 4);
            for sample in 0..=50 {
                let x = sample as f64 / 50.0;
                assert!((value(&knots, degree, &points, x) - value(&finer, degree, &raised, x)).abs() < 1e-13);
            }
        }
    }
}
