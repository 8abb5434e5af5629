//! Linear constraints between components, eliminated: each eliminated component in terms of components that are not.

use std::collections::BTreeMap;

/// Coefficients below this, relative to 1, are rounding: the constraint that they belong to is redundant.
const REDUNDANT: f64 = 1e-11;

/// Σ factor · component.
pub type Expression = Vec<(usize, f64)>;

/// A constraint that asks of given components what they are not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contradiction {
    /// Its index.
    pub constraint: usize,
}

/// Gaussian elimination. Components from `first_given` on are given and are never eliminated. Linear in the number of
/// constraints, since each shares components with few others.
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
    // A component may have been eliminated after it was used: put its expression in, last first.
    for pivot in order.into_iter().rev() {
        let complete = expand(&eliminated[&pivot], &eliminated).into_iter().collect();
        eliminated.insert(pivot, complete);
    }
    Ok(eliminated)
}

/// Replaces eliminated components until none is left; drops what cancels.
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

/// The component below `first_given` with the largest factor; the first of equals.
fn largest(row: &BTreeMap<usize, f64>, first_given: usize) -> Option<(usize, f64)> {
    row.range(..first_given).fold(None, |best: Option<(usize, f64)>, (component, factor)| match best {
        Some((_, other)) if other.abs() >= factor.abs() => best,
        _ => Some((*component, *factor)),
    })
}
