//! Where a shell stands: as a state says it, and in the coordinates that solves work with.

use crate::model::{Placement, Unknowns};
use crate::state::State;

/// Where a solve starts from.
#[derive(Clone, Copy, Debug)]
pub struct Standing<'s> {
    /// Displacement of the control points, mm.
    pub displacement: &'s [[f64; 3]],
    /// Rotation vectors of the rigid sections where one of them turns freely; empty otherwise.
    pub turns: &'s [[f64; 3]],
    /// The scene's parameter.
    pub parameter: f64,
    /// The largest force met so far, N; see [`ForceScale::met`](crate::equilibrium::ForceScale::met).
    pub largest_force: f64,
}

impl<'s> Standing<'s> {
    /// A state.
    pub fn of(state: &'s State) -> Self {
        Self {
            displacement: &state.displacement,
            turns: &state.turns,
            parameter: state.parameter,
            largest_force: state.largest_force_n,
        }
    }

    /// Its free unknowns.
    pub fn free(&self, unknowns: &Unknowns) -> Vec<f64> {
        unknowns.of_displacement(self.displacement, self.turns, self.parameter)
    }
}

/// A point in the coordinates of a mesh.
#[derive(Debug)]
pub struct Configuration<'u> {
    /// The scene's parameter.
    pub parameter: f64,
    /// Free unknowns.
    pub free: Vec<f64>,
    /// The displacement as a function of them, with its derivatives.
    pub placement: Placement<'u>,
    /// Displacement of the control points, mm.
    pub displacement: Vec<[f64; 3]>,
}

impl<'u> Configuration<'u> {
    /// At free unknowns.
    pub fn at(unknowns: &'u Unknowns, free: Vec<f64>, parameter: f64) -> Self {
        let placement = unknowns.place(&free, parameter);
        Self { parameter, displacement: placement.displacement(), free, placement }
    }

    /// Of a standing, with its displacement to the bit: the unknowns give that to rounding.
    pub fn of(unknowns: &'u Unknowns, at: Standing) -> Self {
        let free = at.free(unknowns);
        let placement = unknowns.place(&free, at.parameter);
        Self { parameter: at.parameter, displacement: at.displacement.to_vec(), free, placement }
    }
}
