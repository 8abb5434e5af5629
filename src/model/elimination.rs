//! Linear constraints between components, eliminated: each eliminated component in terms of components that are not.

use std::collections::BTreeMap;

/// Coefficients below this, relative to 1, are rounding: the constraint that they belong to is redundant.
const REDUNDANT: f64 = 1e-11;

/// Linear expression in components, Σ factor · component.
pub type Expression = Vec<(usize, f64)>;

/// A constraint that given components do not meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contradiction {
    /// Index of the constraint.
    pub constraint: usize,
}

/// Eliminates constraints by Gaussian elimination. Components from `first_given` on are given and are never eliminated.
/// Linear in the number of constraints, since each shares components with few others.
///
/// # Errors
/// Where constraints leave a condition on given components alone.
pub fn eliminate(constraints: &[Expression], first_given: usize) -> Result<BTreeMap<usize, Expression>, Contradiction> {
    let mut order: Vec<usize> = Vec::new();
    let mut eliminated: BTreeMap<usize, Expression> = BTreeMap::new();
    for (index, constraint) in constraints.iter().enumerate() {
        let row = expand(constraint, &eliminated);
        let Some((pivot, factor)) = largest(&row, first_given) else {
            if row.is_empty() {
                continue;
            }
            return Err(Contradiction { constraint: index });
        };
        let rest = row.iter().filter(|(component, _)| **component != pivot).map(|(c, f)| (*c, -f / factor)).collect();
        eliminated.insert(pivot, rest);
        order.push(pivot);
    }
    // A component may have been eliminated after it was used: its expression is substituted, last first.
    for pivot in order.into_iter().rev() {
        let complete = expand(&eliminated[&pivot], &eliminated).into_iter().collect();
        eliminated.insert(pivot, complete);
    }
    Ok(eliminated)
}

/// Replaces eliminated components until none is left, and drops terms that cancel.
fn expand(expression: &Expression, eliminated: &BTreeMap<usize, Expression>) -> BTreeMap<usize, f64> {
    let mut sum: BTreeMap<usize, f64> = BTreeMap::new();
    let mut pending = expression.clone();
    while let Some((component, factor)) = pending.pop() {
        match eliminated.get(&component) {
            Some(replacement) => pending.extend(replacement.iter().map(|(c, f)| (*c, factor * f))),
            None => *sum.entry(component).or_default() += factor,
        }
    }
    sum.retain(|_, factor| factor.abs() > REDUNDANT);
    sum
}

/// Finds the multipliers λ of constraints that together carry forces on the components: Σ λ_k b_k = forces, up to what
/// is left on components that nothing holds. Components beyond the forces are given. A constraint that follows from
/// those before it carries nothing: λ = 0.
///
/// Elimination writes b_k = p_k e_k + Σ_j f_kj e_j, where e_k has a 1 at its pivot and nothing at those of the rows before
/// it, so that the shares μ of the rows in the forces are read off at the pivots, first to last; then
/// μ_j = p_j λ_j + Σ_k f_kj λ_k over the constraints k behind j gives the multipliers, last to first.
pub fn multipliers(constraints: &[&Expression], forces: &[f64]) -> Vec<f64> {
    let mut rows: Vec<Reduced> = Vec::new();
    let mut row_of: BTreeMap<usize, usize> = BTreeMap::new();
    for (constraint, expression) in constraints.iter().enumerate() {
        let mut sum: BTreeMap<usize, f64> = BTreeMap::new();
        let mut used: Expression = Vec::new();
        // A row may bring in pivots of later rows, but of none before it: each is substituted once.
        let mut pending: BTreeMap<usize, f64> = BTreeMap::new();
        let mut terms: Expression = (*expression).clone();
        loop {
            for (component, factor) in terms {
                match row_of.get(&component) {
                    Some(row) => *pending.entry(*row).or_default() += factor,
                    None => *sum.entry(component).or_default() += factor,
                }
            }
            let Some((row, factor)) = pending.pop_first() else { break };
            used.push((row, factor));
            terms = rows[row].rest.iter().map(|(component, share)| (*component, -factor * share)).collect();
        }
        sum.retain(|_, factor| factor.abs() > REDUNDANT);
        let Some((pivot, factor)) = largest(&sum, forces.len()) else { continue };
        let rest = sum.iter().filter(|(component, _)| **component != pivot).map(|(c, f)| (*c, f / factor)).collect();
        row_of.insert(pivot, rows.len());
        rows.push(Reduced { constraint, pivot, factor, rest, used });
    }
    let mut left = forces.to_vec();
    let mut shares: Vec<f64> = Vec::with_capacity(rows.len());
    for row in &rows {
        let share = left[row.pivot];
        for (component, factor) in row.rest.iter().filter(|(component, _)| *component < forces.len()) {
            left[*component] -= share * factor;
        }
        shares.push(share);
    }
    let mut found = vec![0.0; constraints.len()];
    for (index, row) in rows.iter().enumerate().rev() {
        let multiplier = shares[index] / row.factor;
        row.used.iter().for_each(|(before, factor)| shares[*before] -= multiplier * factor);
        found[row.constraint] = multiplier;
    }
    found
}

/// A constraint without the pivots of those before it, as b_k = factor · e_k + Σ used · e_j.
struct Reduced {
    constraint: usize,
    pivot: usize,
    factor: f64,
    /// Entries of e_k other than the 1 at its pivot.
    rest: Expression,
    /// Factors of the rows before.
    used: Expression,
}

/// Finds the component below `first_given` with the largest factor; the first of equal ones.
fn largest(row: &BTreeMap<usize, f64>, first_given: usize) -> Option<(usize, f64)> {
    row.range(..first_given).fold(None, |best: Option<(usize, f64)>, (component, factor)| match best {
        Some((_, other)) if other.abs() >= factor.abs() => best,
        _ => Some((*component, *factor)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ties, a chain of them, a redundant constraint, given motions.
    #[test]
    fn multipliers_add_up_to_the_forces() {
        let constraints: Vec<Expression> = vec![
            vec![(0, 1.0), (1, -1.0)],
            vec![(1, 1.0), (2, -0.25), (3, -0.75)],
            vec![(3, 0.6), (4, 0.8)],
            vec![(3, 1.0), (8, -1.0)],
            vec![(0, 1.0)],
            vec![(1, 1.0)],
            vec![(5, 0.5), (6, 0.5), (9, -1.0)],
        ];
        let carried = [3.0, -2.0, 5.0, 0.5, 7.0, 0.0, -4.0];
        let mut forces = vec![0.0; 8];
        for (expression, multiplier) in constraints.iter().zip(carried) {
            for (component, factor) in expression.iter().filter(|(component, _)| *component < 8) {
                forces[*component] += multiplier * factor;
            }
        }
        let all: Vec<&Expression> = constraints.iter().collect();
        let found = multipliers(&all, &forces);
        for (one, other) in found.iter().zip(carried) {
            assert!((one - other).abs() < 1e-13, "{found:?}");
        }
        // The other of two that ask the same takes it where it comes first; the tie carries the difference.
        let turned: Vec<&Expression> = [0, 1, 2, 3, 5, 4, 6].iter().map(|index| &constraints[*index]).collect();
        let found = multipliers(&turned, &forces);
        for (one, other) in found.iter().zip([10.0, -2.0, 5.0, 0.5, 7.0, 0.0, -4.0]) {
            assert!((one - other).abs() < 1e-13, "{found:?}");
        }
    }
}
