//! The result of a solve.

use crate::energy::{At, Balance, Discretization};
use crate::equilibrium::configuration::{Configuration, Coordinates};
use crate::equilibrium::iterate::{Effort, Iterate};
use crate::equilibrium::ledger::SolveStart;
use crate::equilibrium::vector::{length, product};
use crate::equilibrium::workspace::{Factored, Workspace};
use crate::scene::Scene;

/// An equilibrium that a solve found.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Solved {
    /// Displacement of the control points, mm.
    pub displacement: Vec<[f64; 3]>,
    /// Rotation vectors of the rigid sections where one of them turns freely, radians.
    pub turns: Vec<[f64; 3]>,
    /// Balance of energies since the start of the solve.
    pub balance: Balance,
    /// Moment at each end of the whole shell where ends turn, dΠ/dθ / 2, N·mm; otherwise 0.
    pub moment: f64,
    /// Number of negative pivots of the stiffness there; 0 where the equilibrium is stable.
    pub negative_pivots: usize,
    /// Norm of the residual divided by the forces that it is compared with.
    pub residual: f64,
    /// Largest force met so far, N; see [`super::ForceScale::met`].
    pub largest_force: f64,
    /// Iterations and factorizations spent.
    pub effort: Effort,
}

/// The configuration that a solve ended at.
pub(super) struct Ended {
    /// Displacement of the control points, mm.
    pub displacement: Vec<[f64; 3]>,
    /// Rotation vectors of the sections, radians; see [`crate::model::Placement::turns`].
    pub turns: Vec<[f64; 3]>,
    /// Strokes of the actions over the solve, N·mm.
    pub strokes: Vec<f64>,
    /// Forces conjugate to the given coordinates, N.
    pub reactions: Vec<f64>,
    /// Iterations and factorizations spent.
    pub effort: Effort,
}

impl Workspace {
    /// Turning ends: moment dΠ/dθ / 2 at each end of the whole shell at a configuration, N·mm. Otherwise 0.
    pub fn end_moment(&mut self, scene: &Scene, at: Configuration) -> f64 {
        let forces = self.forces(at);
        let reactions = Coordinates::of(&self.discretization.unknowns, at).placement.reactions(&forces);
        self.moment_of(scene, &reactions)
    }

    fn moment_of(&self, scene: &Scene, reactions: &[f64]) -> f64 {
        let parts = scene.symmetry.copies() as f64;
        match scene.end_rotation() {
            // All given motions are proportional to θ in degrees.
            Some(_) => {
                0.5 * parts * product(reactions, &self.discretization.unknowns.given_at(1.0)) * 1.0_f64.to_degrees()
            }
            None => 0.0,
        }
    }

    /// Forms the result of a solve, and remembers that stiffness and factor are those of its end.
    pub(super) fn solved(
        &mut self,
        scene: &Scene,
        parameter: f64,
        before: &SolveStart,
        ended: Ended,
        last: &Iterate,
    ) -> Solved {
        let largest_force = last.forces.met_here();
        let at = Configuration { displacement: &ended.displacement, turns: &ended.turns, parameter, largest_force };
        let put_in = before.put_in(&self.discretization, parameter, &ended.displacement);
        let rounding = last.forces.rounding * length(&ended.displacement);
        self.factored_at = Some(Factored::new(at, last.negative_pivots));
        let parts = scene.symmetry.copies() as f64;
        let moment = self.moment_of(scene, &ended.reactions);
        let Discretization { mesh, terms, .. } = &self.discretization;
        let beside = terms.energies(At { mesh, displacement: &ended.displacement, parameter });
        // The energy of the shell follows without integrating again.
        let of_shell = last.energy - beside.iter().sum::<f64>();
        let balance = Balance {
            stored: parts * last.energy,
            of_terms: std::iter::once(of_shell).chain(beside).map(|energy| parts * energy).collect(),
            work: parts
                * (before.work(&self.discretization, parameter, &ended.reactions, &ended.strokes)
                    + 0.5 * (put_in[0] + put_in[1])),
            put_in: parts * put_in[0].abs().max(put_in[1].abs()).max(100.0 * rounding),
        };
        Solved {
            balance,
            moment,
            negative_pivots: last.negative_pivots,
            residual: last.relative_residual(),
            largest_force,
            effort: ended.effort,
            displacement: ended.displacement,
            turns: ended.turns,
        }
    }
}
