//! The envelope of a symmetric structure: how far its rows reach, what factoring it costs, and where to cut it.

use crate::equilibrium::sparse::structure::Couplings;

/// Share of the operations that a cut may leave to the longer side at most.
const CUT_PAYS: f64 = 0.8;

/// First and last unknown that each unknown meets.
pub(super) struct Envelope {
    pub first: Vec<usize>,
    pub last: Vec<usize>,
}

impl Envelope {
    /// Finds the envelope of a structure.
    pub fn new(couplings: &Couplings) -> Self {
        let mut envelope = Self { first: (0..couplings.unknowns).collect(), last: (0..couplings.unknowns).collect() };
        let ends = |group: &Vec<usize>| Some((*group.iter().min()?, *group.iter().max()?));
        let ends: Vec<Option<(usize, usize)>> = couplings.groups.iter().map(ends).collect();
        for [i, j] in couplings.meetings() {
            let (Some(one), Some(other)) = (ends[i], ends[j]) else { continue };
            envelope.widen(&couplings.groups[i], other);
            envelope.widen(&couplings.groups[j], one);
        }
        envelope
    }

    fn widen(&mut self, group: &[usize], (first, last): (usize, usize)) {
        for unknown in group {
            self.first[*unknown] = self.first[*unknown].min(first);
            self.last[*unknown] = self.last[*unknown].max(last);
        }
    }

    /// Finds the cut with the least work for the longer side; where no cut pays, an empty separator behind all
    /// unknowns.
    pub fn best_cut(&self) -> std::ops::Range<usize> {
        let count = self.first.len();
        let none = count..count;
        let mut best = (CUT_PAYS * self.flops(&none), none);
        // Work of rows from the front, and from the back: squares of the lengths of the rows.
        let mut behind = vec![0.0; count + 1];
        for unknown in (0..count).rev() {
            behind[unknown] = behind[unknown + 1] + ((self.last[unknown] + 1 - unknown) as f64).powi(2);
        }
        let (mut before, mut reach) = (0.0, 0);
        for begin in 0..count {
            // The separator reaches as far as the unknowns before it do.
            let cut = begin..reach.max(begin);
            let width = cut.len() as f64;
            let work = f64::max(before, behind[cut.end]) + width.powi(3);
            if begin > 0 && cut.end < count && work < best.0 {
                best = (work, cut);
            }
            before += ((begin + 1 - self.first[begin]) as f64).powi(2);
            reach = reach.max(self.last[begin] + 1);
        }
        best.1
    }

    /// Bound on the operations of a factorization with a cut: a row of n numbers takes n² where none before it begins
    /// later than it does, and less otherwise. Rows of the separator are counted with head and tail, and what is left
    /// of them as a full matrix.
    pub fn flops(&self, cut: &std::ops::Range<usize>) -> f64 {
        let head = (0..cut.start).map(|row| ((row + 1 - self.first[row]) as f64).powi(2)).sum::<f64>();
        let tail = (cut.end..self.last.len()).map(|row| ((self.last[row] + 1 - row) as f64).powi(2)).sum::<f64>();
        let in_head: Vec<f64> = cut.clone().map(|row| cut.start.saturating_sub(self.first[row]) as f64).collect();
        let in_tail: Vec<f64> = cut.clone().map(|row| (self.last[row] + 1).saturating_sub(cut.end) as f64).collect();
        let mut separator = (cut.len() as f64).powi(3) / 3.0;
        for lengths in [in_head, in_tail] {
            for (i, length) in lengths.iter().enumerate() {
                separator += length * length;
                separator += lengths[..=i].iter().map(|other| 2.0 * length.min(*other)).sum::<f64>();
            }
        }
        head + tail + separator
    }
}
