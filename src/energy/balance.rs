//! The balance of energy of a solve: what is stored, what was done, and what is missing.

/// Energies of the whole shell, N·mm. The workspace of a solve forms it where a solve ends; all else reads it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Balance {
    /// Stored at the end by all terms.
    pub stored: f64,
    /// What each of them stores, in their order, the shell first; 0 for loads.
    pub of_terms: Vec<f64>,
    /// Work of loads, given motions and changes of the natural state, or of what terms store, with the parameter since the start of
    /// the solve: reactions, and factors of the actions, by their means before and after; strokes of the actions along the way
    /// that the solve took.
    pub work: f64,
    /// What these changes with the parameter would have put in had the shell stayed, and at least a hundred times what rounding of
    /// the displacement is worth. Where a shell follows its natural state, or is carried off without strain, this is the measure
    /// of energies, not the little that it stores.
    pub put_in: f64,
}

impl Balance {
    /// What was done and is not stored, from a state that stored `before`: dissipated, on the way to equilibrium at rest, where the
    /// shell jumped, and otherwise the error of the means that the work is formed with.
    pub fn dissipated(&self, before: f64) -> f64 {
        before + self.work - self.stored
    }

    /// The measure of energies at the end of a solve from a state that stored `before`.
    pub fn scale(&self, before: f64) -> f64 {
        before.max(self.put_in)
    }
}
