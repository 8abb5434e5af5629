//! Whether loads balance by themselves where a support holds rigid motions and nothing else.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use crate::energy::{At, TermSource, Terms};
use crate::model::{ModelError, Unknowns};
use crate::scene::Scene;
use crate::shell::norm;
use crate::spline::Mesh;

/// Work of the loads on a free motion, relative to all their forces, that is rounding and quadrature. A force that these
/// few points have to carry bends a thin free shell without stretching it: on a tube, (R/t)² times as far as pressure of
/// the same sum widens it.
const BALANCE: f64 = 1e-9;

/// Refuses loads that do work on a motion that only a support of rigid motions holds, and terms that hold such a motion
/// as well.
///
/// # Errors
/// Where loads do so at the end or at a kink of a history, where terms do, and where one of either does not fit the
/// mesh.
pub fn check_balance(
    scene: &Scene,
    mesh: &Mesh,
    unknowns: &Unknowns,
    own: &[Arc<dyn TermSource>],
) -> Result<(), ModelError> {
    let Some(held) = &unknowns.supports().held_motions else { return Ok(()) };
    let loads = Terms::on(scene, mesh, own)?;
    let still = vec![[0.0; 3]; unknowns.points.len()];
    let kinks = scene.actions.iter().flat_map(|action| action.history.kinks());
    for load_factor in kinks.chain([scene.load.target()]) {
        let forces = loads.forces(At { mesh, displacement: &still, parameter: load_factor });
        let mut work = DVector::<f64>::zeros(6);
        for (force, point) in forces.iter().zip(&unknowns.points) {
            let fields = held.free.body.fields(*point);
            (0..6).for_each(|k| work[k] += (0..3).map(|c| force[c] * fields[k][c]).sum::<f64>());
        }
        let on_free = &held.free.basis * held.free.basis.tr_mul(&work);
        let all: f64 = forces.iter().map(|force| norm(*force)).sum();
        if on_free.norm() > BALANCE * all {
            let motion = DMatrix::from_column_slice(6, 1, (&on_free / on_free.norm()).as_slice());
            return Err(ModelError::Unbalanced {
                support: unknowns.supports().footprints[held.support].name.clone(),
                motion: held.free.body.words(&motion),
                share: on_free.norm() / all,
                load_factor,
            });
        }
    }
    if Terms::may_store(scene, own) {
        let [_, by_terms] = held.free.parted_by_terms(scene, mesh, own)?;
        if by_terms.basis.ncols() > 0 {
            return Err(ModelError::HeldByTerms {
                support: unknowns.supports().footprints[held.support].name.clone(),
                motion: by_terms.body.words(&by_terms.basis),
            });
        }
    }
    Ok(())
}
