//! Whether a sequence of numbers is a knot vector that a surface can have.

/// Reasons why a sequence of numbers is not a knot vector.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum KnotFlaw {
    /// There are fewer than 2 (degree + 1) knots.
    Few {
        /// Smallest number of knots for the degree.
        least: usize,
    },
    /// A knot is NaN or infinite.
    NotFinite {
        /// Index of the knot in the sequence.
        index: usize,
    },
    /// A knot is smaller than the one before it.
    Descending {
        /// Index of the smaller knot in the sequence.
        index: usize,
    },
    /// Two successive knots differ by less than they may.
    TooNear {
        /// The two knots.
        pair: [f64; 2],
        /// Difference of the two, relative to the range of all knots.
        share: f64,
    },
    /// The first or the last knot is not repeated degree + 1 times: the vector is not open (clamped).
    NotClamped {
        /// Value of the knot.
        knot: f64,
        /// Multiplicity of the knot.
        times: usize,
    },
    /// An interior knot has a multiplicity above the degree, so that the surface is torn.
    Tears {
        /// Value of the knot.
        knot: f64,
        /// Multiplicity of the knot.
        times: usize,
    },
}

/// Checks that knots are finite and ascend, have multiplicity degree + 1 at both ends and at most the degree inside, and
/// that successive ones are equal or differ by at least `least_gap` of the range.
///
/// # Errors
/// The first flaw, in that order, except that gaps are checked before multiplicities: knots that are nearly equal are most
/// likely meant to be equal.
pub fn check_knots(knots: &[f64], degree: usize, least_gap: f64) -> Result<(), KnotFlaw> {
    let least = 2 * (degree + 1);
    if knots.len() < least {
        return Err(KnotFlaw::Few { least });
    }
    if let Some(index) = knots.iter().position(|knot| !knot.is_finite()) {
        return Err(KnotFlaw::NotFinite { index });
    }
    if let Some(before) = knots.windows(2).position(|pair| pair[1] < pair[0]) {
        return Err(KnotFlaw::Descending { index: before + 1 });
    }
    let ends = [knots[0], knots[knots.len() - 1]];
    let range = ends[1] - ends[0];
    let gaps = || knots.windows(2).map(|pair| [pair[0], pair[1]]);
    if let Some(pair) = gaps().find(|[one, other]| other > one && other - one < least_gap * range) {
        return Err(KnotFlaw::TooNear { pair, share: (pair[1] - pair[0]) / range });
    }
    for group in knots.chunk_by(|a, b| a == b) {
        let (knot, times) = (group[0], group.len());
        let at_end = ends.contains(&knot);
        if at_end && times != degree + 1 {
            return Err(KnotFlaw::NotClamped { knot, times });
        }
        if !at_end && times > degree {
            return Err(KnotFlaw::Tears { knot, times });
        }
    }
    Ok(())
}

/// Removes some knots from others, each as often as it is in `taken`; both ascend.
pub fn without_knots(knots: &[f64], taken: &[f64]) -> Vec<f64> {
    let mut taken = taken.iter().peekable();
    knots.iter().copied().filter(|knot| taken.next_if(|other| *other == knot).is_none()).collect()
}

/// Number of control points in a direction with these knots; there must be more knots than the degree.
pub fn control_count(knots: &[f64], degree: usize) -> usize {
    knots.len() - degree - 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_flaw_is_found() {
        let check = |knots: &[f64]| check_knots(knots, 2, 1e-5);
        assert_eq!(check(&[0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0]), Ok(()));
        assert_eq!(check(&[0.0, 0.0, 1.0, 1.0]), Err(KnotFlaw::Few { least: 6 }));
        assert_eq!(check(&[0.0, 0.0, 0.0, f64::NAN, 1.0, 1.0]), Err(KnotFlaw::NotFinite { index: 3 }));
        assert_eq!(check(&[0.0, 0.0, 0.0, 1.0, 0.5, 1.0]), Err(KnotFlaw::Descending { index: 4 }));
        assert_eq!(check(&[0.0, 0.0, 1e-6, 1.0, 1.0, 1.0]), Err(KnotFlaw::TooNear { pair: [0.0, 1e-6], share: 1e-6 }));
        assert_eq!(check(&[0.0, 0.0, 0.5, 1.0, 1.0, 1.0]), Err(KnotFlaw::NotClamped { knot: 0.0, times: 2 }));
        let torn = [0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 1.0, 1.0, 1.0];
        assert_eq!(check(&torn), Err(KnotFlaw::Tears { knot: 0.5, times: 3 }));
        assert_eq!(check(&[0.0; 6]), Err(KnotFlaw::NotClamped { knot: 0.0, times: 6 }));
    }
}
