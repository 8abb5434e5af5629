//! Bisection as pure state machines: they name what to examine next and take what was seen; they examine nothing
//! themselves.

/// A bisection for the first index in `0..len` from which on a property holds. It must hold at every index after one at
/// which it holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndexBisection {
    /// Everything before does not hold.
    low: usize,
    /// This one, and all after, hold (`len`: perhaps none does).
    high: usize,
}

impl IndexBisection {
    /// Starts a search among `len` items.
    pub fn new(len: usize) -> Self {
        Self { low: 0, high: len }
    }

    /// The index to examine next; `None` where the answer is known.
    pub fn next(&self) -> Option<usize> {
        (self.low < self.high).then_some(self.low + (self.high - self.low) / 2)
    }

    /// Narrows the search by whether the property holds at `index`.
    #[must_use]
    pub fn narrowed(self, index: usize, holds: bool) -> Self {
        if holds {
            Self { high: index.min(self.high), ..self }
        } else {
            Self { low: (index + 1).max(self.low), ..self }
        }
    }

    /// The first index at which the property holds, or `len`; valid once [`Self::next`] returns `None`.
    pub fn answer(&self) -> usize {
        self.high
    }
}

/// A bisection of a bracket of loads: at the lower one the shell has not jumped, at the upper one it has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadBisection {
    below: f64,
    beyond: f64,
    tolerance: f64,
}

impl LoadBisection {
    /// Starts with a bracket that is to be narrowed to `tolerance`.
    pub fn new(below: f64, beyond: f64, tolerance: f64) -> Self {
        Self { below, beyond, tolerance }
    }

    /// The load to try next; `None` where the bracket is narrow enough, or no number lies within it.
    pub fn next(&self) -> Option<f64> {
        let middle = 0.5 * (self.below + self.beyond);
        let within = middle > self.below && middle < self.beyond;
        (within && self.beyond - self.below > self.tolerance).then_some(middle)
    }

    /// Narrows the bracket by whether the shell jumped when it was loaded to `parameter`.
    #[must_use]
    pub fn narrowed(self, parameter: f64, jumped: bool) -> Self {
        if jumped { Self { beyond: parameter, ..self } } else { Self { below: parameter, ..self } }
    }

    /// The bracket: last load before the jump and first load beyond it, in the units of the scene's parameter.
    pub fn bracket(&self) -> [f64; 2] {
        [self.below, self.beyond]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_every_first_index_in_logarithmic_looks() {
        for len in 0..70 {
            for first in 0..=len {
                let mut search = IndexBisection::new(len);
                let mut looks = 0;
                while let Some(index) = search.next() {
                    search = search.narrowed(index, index >= first);
                    looks += 1;
                }
                assert_eq!(search.answer(), first);
                assert!(looks <= usize::BITS - len.leading_zeros(), "{looks} looks at {len}");
            }
        }
    }

    #[test]
    fn narrows_a_bracket_and_stops() {
        let mut search = LoadBisection::new(9.0, 10.0, 1e-4);
        let mut tries = 0;
        while let Some(load) = search.next() {
            search = search.narrowed(load, load > 9.876_543);
            tries += 1;
        }
        let [below, beyond] = search.bracket();
        assert!(below <= 9.876_543 && 9.876_543 < beyond && beyond - below <= 1e-4);
        assert_eq!(tries, 14);
        assert_eq!(LoadBisection::new(1.0, 1.0, 0.0).next(), None);
    }
}
