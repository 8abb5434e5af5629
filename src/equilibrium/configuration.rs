//! A configuration of the shell: as a state holds it, and in the coordinates that solves work with.

use crate::model::{Placement, Unknowns};
use crate::state::State;

/// Displacements, section rotations and parameter, borrowed from a state.
#[derive(Clone, Copy, Debug)]
pub struct Configuration<'s> {
    /// Displacement of the control points, mm.
    pub displacement: &'s [[f64; 3]],
    /// Rotation vectors of the rigid sections where one of them turns freely; empty otherwise.
    pub turns: &'s [[f64; 3]],
    /// The scene's parameter.
    pub parameter: f64,
    /// The largest force met so far, N; see [`ForceScale::met`](crate::equilibrium::ForceScale::met).
    pub largest_force: f64,
}

impl<'s> Configuration<'s> {
    /// Borrows the configuration of a state.
    pub fn of(state: &'s State) -> Self {
        Self {
            displacement: &state.displacement,
            turns: &state.turns,
            parameter: state.parameter,
            largest_force: state.largest_force_n,
        }
    }

    /// Computes the free unknowns of the configuration.
    pub fn free(&self, unknowns: &Unknowns) -> Vec<f64> {
        unknowns.of_displacement(self.displacement, self.turns, self.parameter)
    }
}

/// A configuration in the coordinates of a mesh: its free unknowns.
#[derive(Debug)]
pub struct Coordinates<'u> {
    /// The scene's parameter.
    pub parameter: f64,
    /// Values of the free unknowns.
    pub free: Vec<f64>,
    /// Displacement as a function of the free unknowns, with its derivatives.
    pub placement: Placement<'u>,
    /// Displacement of the control points, mm.
    pub displacement: Vec<[f64; 3]>,
}

impl<'u> Coordinates<'u> {
    /// Creates the configuration at these free unknowns.
    pub fn at(unknowns: &'u Unknowns, free: Vec<f64>, parameter: f64) -> Self {
        let placement = unknowns.configure(&free, parameter);
        Self { parameter, displacement: placement.displacement(), free, placement }
    }

    /// Finds the coordinates of a configuration, whose displacement is kept to the last bit: the unknowns reproduce it
    /// up to rounding only.
    pub fn of(unknowns: &'u Unknowns, at: Configuration) -> Self {
        let free = at.free(unknowns);
        let placement = unknowns.configure(&free, at.parameter);
        Self { parameter: at.parameter, displacement: at.displacement.to_vec(), free, placement }
    }
}
