//! GMRES with a preconditioner (Saad & Schultz 1986; Saad, *Iterative Methods for Sparse Linear Systems*, 2nd ed.,
//! algorithms 6.9 and 9.5), for stiffnesses with a skew part: the symmetric part, factored, leaves few iterations.

use crate::equilibrium::vector::product;

/// Solves A x = b to a residual of `tolerance` |b|, or as far as `most` iterations get. `precondition` is applied from
/// the right, in place.
pub(super) fn gmres(
    right_hand_side: &[f64],
    apply: impl Fn(&[f64]) -> Vec<f64>,
    mut precondition: impl FnMut(&mut [f64]),
    tolerance: f64,
    most: usize,
) -> Vec<f64> {
    let start = product(right_hand_side, right_hand_side).sqrt();
    if start == 0.0 {
        return right_hand_side.to_vec();
    }
    let mut basis: Vec<Vec<f64>> = vec![right_hand_side.iter().map(|value| value / start).collect()];
    let mut preconditioned: Vec<Vec<f64>> = Vec::new();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let mut turns: Vec<[f64; 2]> = Vec::new();
    let mut residual = vec![start];
    for k in 0..most {
        let mut vector = basis[k].clone();
        precondition(&mut vector);
        let mut next = apply(&vector);
        preconditioned.push(vector);
        let mut column = Vec::with_capacity(k + 2);
        for direction in &basis {
            let share = product(direction, &next);
            next.iter_mut().zip(direction).for_each(|(x, d)| *x -= share * d);
            column.push(share);
        }
        let rest = product(&next, &next).sqrt();
        column.push(rest);
        for (i, [cos, sin]) in turns.iter().enumerate() {
            let (a, b) = (column[i], column[i + 1]);
            (column[i], column[i + 1]) = (cos * a + sin * b, cos * b - sin * a);
        }
        let length = column[k].hypot(column[k + 1]);
        let [cos, sin] = [column[k] / length, column[k + 1] / length];
        (column[k], column[k + 1]) = (length, 0.0);
        turns.push([cos, sin]);
        columns.push(column);
        residual.push(-sin * residual[k]);
        residual[k] *= cos;
        if residual[k + 1].abs() <= tolerance * start || rest == 0.0 {
            break;
        }
        basis.push(next.into_iter().map(|value| value / rest).collect());
    }
    let count = columns.len();
    let mut shares = vec![0.0; count];
    for i in (0..count).rev() {
        let known: f64 = (i + 1..count).map(|j| columns[j][i] * shares[j]).sum();
        shares[i] = (residual[i] - known) / columns[i][i];
    }
    let mut solution = vec![0.0; right_hand_side.len()];
    for (share, vector) in shares.iter().zip(&preconditioned) {
        solution.iter_mut().zip(vector).for_each(|(x, v)| *x += share * v);
    }
    solution
}

#[cfg(test)]
mod tests {
    use super::gmres;

    #[test]
    fn a_small_unsymmetric_system_is_solved() {
        let matrix = [[4.0, 1.0, 0.5], [-1.0, 3.0, 0.2], [0.3, -0.4, 5.0]];
        let exact = [1.0, -2.0, 0.5];
        let apply =
            |x: &[f64]| matrix.iter().map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum()).collect::<Vec<f64>>();
        let right = apply(&exact);
        let jacobi = |x: &mut [f64]| x.iter_mut().zip([4.0, 3.0, 5.0]).for_each(|(value, d)| *value /= d);
        for (value, expected) in gmres(&right, apply, jacobi, 1e-13, 10).iter().zip(exact) {
            assert!((value - expected).abs() < 1e-12, "{value} {expected}");
        }
    }
}
