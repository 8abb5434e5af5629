//! The balance of energy of a solve: what the model stored before, and what has been done on it since.

use crate::energy::Discretization;
use crate::equilibrium::configuration::{Configuration, Coordinates};
use crate::equilibrium::vector::product;
use crate::equilibrium::workspace::Workspace;
use crate::model::Placement;

/// The start of a solve: parameter, reactions, energy and displacement.
pub(super) struct SolveStart {
    /// Value of the scene's parameter.
    parameter: f64,
    /// Forces conjugate to the given coordinates, N; 0 where the start is out of balance.
    reactions: Vec<f64>,
    /// Energy that the model stores, N·mm.
    energy: f64,
    /// Displacement of the control points, mm.
    displacement: Vec<[f64; 3]>,
}

impl SolveStart {
    /// Records the start of a solve at an equilibrium.
    pub fn at(work: &mut Workspace, from: Configuration) -> Self {
        let forces = work.forces(from);
        let Coordinates { placement, .. } = Coordinates::of(&work.discretization.unknowns, from);
        Self::with(&placement, &forces, from, work.assembled.energy)
    }

    /// Records the start of a solve at an equilibrium whose forces (internal less loads, N, on all control points) and
    /// energy are known.
    pub fn with(placement: &Placement, forces: &[[f64; 3]], from: Configuration, energy: f64) -> Self {
        let Configuration { displacement, parameter, .. } = from;
        Self { parameter, reactions: placement.reactions(forces), energy, displacement: displacement.to_vec() }
    }

    /// Records a start where forces do not balance and no given motion follows.
    pub fn unbalanced(work: &Workspace, from: Configuration) -> Self {
        let reactions = vec![0.0; work.discretization.unknowns.given_count()];
        let energy = work.energy(from.displacement, from.parameter);
        Self { parameter: from.parameter, reactions, energy, displacement: from.displacement.to_vec() }
    }

    /// Computes the work on the model up to a value of the parameter, N·mm: that of given motions from the means of
    /// reactions before and after, that of loads from the means of their factors and their strokes.
    pub fn work(&self, discretization: &Discretization, parameter: f64, reactions: &[f64], strokes: &[f64]) -> f64 {
        let Discretization { unknowns, terms, .. } = discretization;
        let (given, target) = (unknowns.given_at(self.parameter), unknowns.given_at(parameter));
        let half: Vec<f64> = given.iter().zip(&target).map(|(m0, m1)| 0.5 * (m1 - m0)).collect();
        let of_motions = product(&self.reactions, &half) + product(reactions, &half);
        of_motions + terms.mean_work(strokes, [self.parameter, parameter])
    }

    /// Computes the energy that has left the balance of the model since the start, if reactions stay what they were,
    /// N·mm.
    pub fn released(&self, discretization: &Discretization, parameter: f64, strokes: &[f64], energy: f64) -> f64 {
        let put_in = self.put_in_at(discretization, parameter, &self.displacement);
        self.energy + self.work(discretization, parameter, &self.reactions, strokes) + put_in - energy
    }

    /// Computes the energy that the parameter puts into the model by changing its natural state or what its terms
    /// store, N·mm: at the displacement of the start, and at another one. Both are 0 where the parameter changes
    /// neither.
    pub fn put_in(&self, discretization: &Discretization, parameter: f64, to: &[[f64; 3]]) -> [f64; 2] {
        [&self.displacement[..], to].map(|displacement| self.put_in_at(discretization, parameter, displacement))
    }

    fn put_in_at(&self, discretization: &Discretization, parameter: f64, displacement: &[[f64; 3]]) -> f64 {
        if parameter == self.parameter {
            return 0.0;
        }
        discretization.put_in(displacement, [self.parameter, parameter])
    }
}
