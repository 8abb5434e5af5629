//! The balance of energy of a solve: what the model stored before, and what has been done on it since.

use crate::equilibrium::descent::product;
use crate::equilibrium::newton::{Standing, Workspace};
use crate::model::{Discretization, Placement};

/// The start of a solve.
pub(super) struct Before {
    /// Value of the scene's parameter.
    parameter: f64,
    /// Forces conjugate to the given coordinates, N; 0 where the start is out of balance.
    reactions: Vec<f64>,
    /// Strain energy of the model, N·mm.
    energy: f64,
}

impl Before {
    /// At an equilibrium.
    pub fn at(work: &mut Workspace, from: Standing) -> Self {
        let forces = work.forces(from);
        let Discretization { unknowns, .. } = &work.discretization;
        let free = unknowns.of_displacement(from.displacement, from.turns, from.parameter);
        let placement = unknowns.place(&free, from.parameter);
        Self::with(&placement, &forces, from, work.assembled.energy)
    }

    /// At an equilibrium whose forces (internal less loads, N, on all control points) and strain energy are known.
    pub fn with(placement: &Placement, forces: &[[f64; 3]], from: Standing, energy: f64) -> Self {
        Self { parameter: from.parameter, reactions: placement.reactions(forces), energy }
    }

    /// Where forces do not balance and no given motion follows.
    pub fn unbalanced(work: &Workspace, from: Standing) -> Self {
        let reactions = vec![0.0; work.discretization.unknowns.given_count()];
        Self { parameter: from.parameter, reactions, energy: work.energy(from.displacement) }
    }

    /// Work on the model up to a value of the parameter, N·mm: of the given motions by the means of reactions before and after,
    /// of the loads by the means of their factors and their strokes on the way.
    pub fn work(&self, discretization: &Discretization, parameter: f64, reactions: &[f64], strokes: &[f64]) -> f64 {
        let Discretization { unknowns, loads, .. } = discretization;
        let (given, target) = (unknowns.given_at(self.parameter), unknowns.given_at(parameter));
        let half: Vec<f64> = given.iter().zip(&target).map(|(m0, m1)| 0.5 * (m1 - m0)).collect();
        let of_motions = product(&self.reactions, &half) + product(reactions, &half);
        of_motions + loads.mean_work(strokes, [self.parameter, parameter])
    }

    /// Energy of the model that has left the balance on the way, if reactions stay what they were, N·mm.
    pub fn released(&self, discretization: &Discretization, parameter: f64, strokes: &[f64], energy: f64) -> f64 {
        self.energy + self.work(discretization, parameter, &self.reactions, strokes) - energy
    }
}
