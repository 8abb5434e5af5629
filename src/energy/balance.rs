//! The balance of energy of a solve: what is stored, what was done, and what is missing.

/// Balance of energies of the whole shell over a solve, N·mm, formed where the solve ends.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Balance {
    /// Energy that all terms store at the end.
    pub stored: f64,
    /// Energy that each term stores at the end, in the order of the terms, the shell first; 0 for loads.
    pub of_terms: Vec<f64>,
    /// Work of loads, given motions, and changes with the parameter of the natural state or of what terms store, since
    /// the start of the solve. Reactions and factors of the actions enter by their means before and after; strokes of
    /// the actions are summed along the steps of the solve.
    pub work: f64,
    /// Energy that the changes with the parameter would have put in had the shell not moved, at least a hundred times
    /// the energy of a rounding error of the displacement. It is the scale of energies where a shell follows its
    /// natural state, or moves without strain, and stores little itself.
    pub put_in: f64,
}

impl Balance {
    /// Work that is not stored, from a state that stored `before`, N·mm: where the shell jumped, the energy dissipated
    /// until it is at rest; otherwise the error of the means that the work is formed with.
    pub fn dissipated(&self, before: f64) -> f64 {
        before + self.work - self.stored
    }

    /// Scale of energies at the end of a solve from a state that stored `before`, N·mm.
    pub fn scale(&self, before: f64) -> f64 {
        before.max(self.put_in)
    }
}
