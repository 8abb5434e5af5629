//! A support that holds rigid motions and nothing else.
//!
//! Where the other supports leave n rigid motions free, n displacements of points are held on which those motions are
//! independent. A motion r that meets all other constraints does no work in the shell, so that Σ_k λ_k (row_k · r) = −f · r for the
//! reactions λ under loads f: the matrix of the rows on the free motions is square and regular, and where f does no work on
//! any of them all reactions are zero. The shell is held as it is free.
//!
//! Points and components are chosen greedily, each with the largest share of the motions that those before it leave free:
//! elimination with full pivoting, on points of the surface at fixed fractions, so that a refined mesh holds the same.

use nalgebra::{DMatrix, DVector};

use crate::model::elimination::Expression;
use crate::model::expressions::control_expressions;
use crate::model::place::parameters_of;
use crate::model::rigid_motion::{Body, FreeMotions};
use crate::model::supports::Supports;
use crate::model::{Loads, ModelError, Unknowns};
use crate::scene::{Place, Scene};
use crate::shell::norm;
use crate::spline::{Mesh, mid_surface_point};

/// Fractions of u and v at which points may be held: corners, middles of the edges, and between them.
const FRACTIONS: [f64; 5] = [0.0, 1.0, 0.5, 0.25, 0.75];
/// A candidate is better only by more than rounding, so that equal ones are told apart by their order on every mesh.
const BETTER: f64 = 1.0 + 1e-6;
/// A share of the free motions below which a component holds none of them.
const HOLDS: f64 = 1e-6;
/// Work of the loads on a free motion, relative to all their forces, that is rounding and quadrature. A force that a point
/// has to carry bends a thin free shell without stretching it: on a tube, (R/t)² times as far as pressure of the same sum
/// widens it.
const BALANCE: f64 = 1e-9;

/// What such a support holds.
#[derive(Clone, Debug)]
pub struct HeldMotions {
    /// Index of the support.
    pub support: usize,
    /// What the others leave free.
    free: FreeMotions,
    /// Fractions (u, v) of points, and which component of their displacement is held.
    pub displacements: Vec<([f64; 2], usize)>,
}

struct Candidate {
    fractions: [f64; 2],
    axis: usize,
    position: [f64; 3],
    expression: Expression,
}

impl Supports {
    /// Holds the motions that are free so far.
    pub(super) fn hold_rigid_motions(
        &mut self,
        index: usize,
        scene: &Scene,
        mesh: &Mesh,
        points: &[[f64; 3]],
    ) -> Result<(), ModelError> {
        let candidates = self.candidates(scene, mesh)?;
        let body = Body::around(&candidates.iter().map(|candidate| candidate.position).collect::<Vec<_>>());
        let free = FreeMotions::new(body, self, points);
        if free.basis.ncols() == 0 {
            return Err(ModelError::NoFreeMotion { support: self.traces[index].name.clone() });
        }
        let chosen = choose(&candidates, &free);
        for candidate in &chosen {
            self.push(Some(index), candidate.expression.clone());
        }
        let held = chosen.iter().flat_map(|candidate| &candidate.expression).map(|(component, _)| component / 3);
        self.traces[index].points = held.collect();
        let count = chosen.len() as f64;
        for candidate in &chosen {
            (0..3).for_each(|c| self.traces[index].pole[c] += candidate.position[c] / count);
        }
        let displacements = chosen.iter().map(|candidate| (candidate.fractions, candidate.axis)).collect();
        self.held_motions = Some(HeldMotions { support: index, free, displacements });
        Ok(())
    }

    /// Components of points that no moving section carries.
    fn candidates(&self, scene: &Scene, mesh: &Mesh) -> Result<Vec<Candidate>, ModelError> {
        let mut candidates = Vec::new();
        for u in FRACTIONS {
            for v in FRACTIONS {
                let fractions = [u, v];
                let position = mid_surface_point(mesh, &[], parameters_of(&scene.geometry, fractions)).position;
                let sum = control_expressions(scene, mesh, Place::Point(fractions))?.swap_remove(0);
                if sum.iter().any(|(point, _)| self.section_of[*point].is_some()) {
                    continue;
                }
                for axis in 0..3 {
                    let expression = sum.iter().map(|(point, factor)| (3 * point + axis, *factor)).collect();
                    candidates.push(Candidate { fractions, axis, position, expression });
                }
            }
        }
        Ok(candidates)
    }
}

/// As many of the candidates as there are free motions, independent on them.
fn choose<'a>(candidates: &'a [Candidate], free: &FreeMotions) -> Vec<&'a Candidate> {
    let row = |candidate: &Candidate| {
        let fields = free.body.fields(candidate.position);
        free.basis.tr_mul(&DVector::from_fn(6, |k, _| fields[k][candidate.axis]))
    };
    let mut rows: Vec<DVector<f64>> = candidates.iter().map(row).collect();
    let mut chosen = Vec::new();
    for _ in 0..free.basis.ncols() {
        let lengths: Vec<f64> = rows.iter().map(|row| row.norm()).collect();
        let best = (0..rows.len()).fold(0, |best, k| if lengths[k] > BETTER * lengths[best] { k } else { best });
        if rows.is_empty() || lengths[best] < HOLDS {
            break;
        }
        let pivot = &rows[best] / lengths[best];
        rows.iter_mut().for_each(|row| *row -= &pivot * pivot.dot(row));
        chosen.push(&candidates[best]);
    }
    chosen
}

/// Refuses loads that push along a motion that only a support of rigid motions holds.
///
/// # Errors
/// Where they do, at the end or at a kink of a history.
pub fn check_balance(scene: &Scene, mesh: &Mesh, unknowns: &Unknowns) -> Result<(), ModelError> {
    let Some(held) = &unknowns.supports().held_motions else { return Ok(()) };
    let loads = Loads::new(scene, mesh)?;
    let still = vec![[0.0; 3]; unknowns.points.len()];
    let kinks = scene.actions.iter().flat_map(|action| action.history.kinks());
    for load_factor in kinks.chain([scene.load.target()]) {
        let forces = loads.forces(mesh, &still, load_factor);
        let mut work = DVector::<f64>::zeros(6);
        for (force, point) in forces.iter().zip(&unknowns.points) {
            let fields = held.free.body.fields(*point);
            (0..6).for_each(|k| work[k] += (0..3).map(|c| force[c] * fields[k][c]).sum::<f64>());
        }
        let on_free = &held.free.basis * held.free.basis.tr_mul(&work);
        let all: f64 = forces.iter().map(|force| norm(*force)).sum();
        if on_free.norm() > BALANCE * all {
            let motion = DMatrix::from_column_slice(6, 1, (on_free.clone() / on_free.norm()).as_slice());
            return Err(ModelError::Unbalanced {
                support: unknowns.supports().traces[held.support].name.clone(),
                motion: held.free.body.words(&motion),
                share: on_free.norm() / all,
                load_factor,
            });
        }
    }
    Ok(())
}
