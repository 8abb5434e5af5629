//! Ripples: jumps of the mesh, not of the shell.
//!
//! A fold that wanders over elements as long as itself is held by each of them for a while, and then snaps to the next: the
//! energy ripples, and with it the shell becomes unstable and stable again. On a finer mesh there are other ripples. Where
//! the scene refines, a run knows how large they are: what the last refinement changed, taken for the whole mesh. They come
//! in trains, so that what releases no more than twice the last one is another: by then refining is done elsewhere. A step
//! that passes an unstable shape and releases less is taken at once; locating it would cost several solves to say where an
//! element ends. The baseline in bending of equal sense, refined to 164 × 16 elements, ripples by 1e-3 N·mm about once a
//! degree, where refining one or two of its spans changes 1e-4 to 6e-4, and jumps by 0.24 and 4.2.
//!
//! What moves much farther than the path did before is no ripple, however little it releases: next to a bifurcation the
//! energies of both branches are alike.

use crate::equilibrium::Iterate;
use crate::state::State;

/// Largest ratio of a ripple to the one before it.
const IN_TRAIN: f64 = 2.0;

/// Watch over the iterates of a solve for unstable shapes.
#[derive(Debug)]
pub(super) struct Watch {
    /// Number of negative pivots of the state: a run on an unstable branch follows it (and says so), and only a further
    /// loss of stability ends an attempt.
    known: u64,
    /// Energy that a ripple of the model may release, N·mm; `None` where ripples are not known.
    ripple: Option<f64>,
    /// Whether an unstable shape was passed.
    pub unstable: bool,
}

impl Watch {
    /// Creates the watch over a solve from a state of the whole shell, of which the model is one of `parts`.
    pub fn new(state: &State, parts: f64) -> Self {
        let ripple = ripple_n_mm(state).map(|size| size / parts);
        Self { known: state.negative_pivots, ripple, unstable: false }
    }

    /// Takes an iterate into account; returns whether the solve has passed an unstable shape and released more than a
    /// ripple.
    pub fn sees_jump(&mut self, iterate: &Iterate) -> bool {
        self.unstable |= iterate.negative_pivots as u64 > self.known;
        self.unstable && self.ripple.is_none_or(|size| iterate.released > size)
    }
}

/// Whether a jump that released this energy, N·mm, is a ripple.
pub(super) fn is_ripple(state: &State, released: f64) -> bool {
    ripple_n_mm(state).is_some_and(|size| released.abs() <= size)
}

/// Energy that a ripple may release, N·mm; `None` where refining has not shown it, or the shell is on an unstable
/// branch.
fn ripple_n_mm(state: &State) -> Option<f64> {
    let refinement = state.refinement.filter(|_| state.negative_pivots == 0);
    refinement.map(|last| last.of_all_n_mm().max(IN_TRAIN * last.ripple_n_mm))
}
