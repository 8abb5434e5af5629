//! The balance of energy of a solve: what the model stored before, and what has been done on it since.

use crate::equilibrium::assembly::strain_energy;
use crate::equilibrium::configuration::{Configuration, Standing};
use crate::equilibrium::vector::product;
use crate::equilibrium::workspace::Workspace;
use crate::model::{Discretization, Placement};

/// The start of a solve.
pub(super) struct Before {
    /// Value of the scene's parameter.
    parameter: f64,
    /// Forces conjugate to the given coordinates, N; 0 where the start is out of balance.
    reactions: Vec<f64>,
    /// Strain energy of the model, N·mm.
    energy: f64,
    /// Displacement of the control points, mm, where the scene has a natural state that changes.
    displacement: Option<Vec<[f64; 3]>>,
}

impl Before {
    /// At an equilibrium.
    pub fn at(work: &mut Workspace, from: Standing) -> Self {
        let forces = work.forces(from);
        let Configuration { placement, .. } = Configuration::of(&work.discretization.unknowns, from);
        Self::with(&work.discretization, &placement, &forces, from, work.assembled.energy)
    }

    /// At an equilibrium whose forces (internal less loads, N, on all control points) and strain energy are known.
    pub fn with(
        discretization: &Discretization,
        placement: &Placement,
        forces: &[[f64; 3]],
        from: Standing,
        energy: f64,
    ) -> Self {
        let natural = discretization.free_strains.at(from.parameter);
        let displacement = natural.map(|_| from.displacement.to_vec());
        Self { parameter: from.parameter, reactions: placement.reactions(forces), energy, displacement }
    }

    /// Where forces do not balance and no given motion follows.
    pub fn unbalanced(work: &Workspace, from: Standing) -> Self {
        let reactions = vec![0.0; work.discretization.unknowns.given_count()];
        let energy = work.energy(from.displacement, from.parameter);
        Self { parameter: from.parameter, reactions, energy, displacement: None }
    }

    /// Work on the model up to a value of the parameter, N·mm: of the given motions by the means of reactions before and after,
    /// of the loads by the means of their factors and their strokes on the way.
    pub fn work(&self, discretization: &Discretization, parameter: f64, reactions: &[f64], strokes: &[f64]) -> f64 {
        let Discretization { unknowns, terms, .. } = discretization;
        let (given, target) = (unknowns.given_at(self.parameter), unknowns.given_at(parameter));
        let half: Vec<f64> = given.iter().zip(&target).map(|(m0, m1)| 0.5 * (m1 - m0)).collect();
        let of_motions = product(&self.reactions, &half) + product(reactions, &half);
        of_motions + terms.mean_work(strokes, [self.parameter, parameter])
    }

    /// Energy of the model that has left the balance on the way, if reactions stay what they were, N·mm.
    pub fn released(&self, discretization: &Discretization, parameter: f64, strokes: &[f64], energy: f64) -> f64 {
        let put_in = self.put_in_at(discretization, parameter, self.displacement.as_deref());
        self.energy + self.work(discretization, parameter, &self.reactions, strokes) + put_in - energy
    }

    /// Energy that the model stores more because its natural state changes, N·mm: had it stayed at the start, and at another
    /// displacement. 0 where the natural state stays.
    pub fn put_in(&self, discretization: &Discretization, parameter: f64, to: &[[f64; 3]]) -> [f64; 2] {
        let start = self.displacement.as_deref();
        [start, start.map(|_| to)].map(|displacement| self.put_in_at(discretization, parameter, displacement))
    }

    fn put_in_at(&self, discretization: &Discretization, parameter: f64, displacement: Option<&[[f64; 3]]>) -> f64 {
        let Some(displacement) = displacement else { return 0.0 };
        let Discretization { tables, free_strains, .. } = discretization;
        let [after, before] = [parameter, self.parameter]
            .map(|parameter| strain_energy(tables, displacement, free_strains.at(parameter)));
        after - before
    }
}
