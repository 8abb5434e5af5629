//! The energy that a state out of balance releases on its way to equilibrium, to first order.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::equilibrium::configuration::{Configuration, Coordinates};
use crate::equilibrium::solve_error::SolveError;
use crate::equilibrium::vector::product;
use crate::equilibrium::workspace::Workspace;
use crate::shell::norm;

/// Vectors among which soft modes are sought, beyond their number.
const MORE_VECTORS: usize = 2;

/// One step of Newton's method from a state out of balance: with the residual r on the free unknowns and the stiffness K, the
/// unknowns change by −K⁻¹r.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LinearRelease {
    /// Energy that the model releases, ½ rᵀK⁻¹r, N·mm; negative where K is not positive definite and r lies mostly in
    /// its negative part.
    pub energy: f64,
    /// Internal forces less loads on the control points where the step begins, N.
    pub forces: Vec<[f64; 3]>,
    /// Motion of the control points, to first order, mm.
    pub motion: Vec<[f64; 3]>,
    parameter: f64,
    free: Vec<f64>,
    step: Vec<f64>,
}

/// Displacement of the control points, mm, and rotation vectors of the rigid sections where one of them turns freely.
pub type Placed = (Vec<[f64; 3]>, Vec<[f64; 3]>);

impl LinearRelease {
    /// The largest motion of a control point, mm.
    pub fn motion_mm(&self) -> f64 {
        self.motion.iter().map(|motion| norm(*motion)).fold(0.0, f64::max)
    }

    /// Places the shell after a share of the step, on the mesh of the workspace that computed it.
    pub fn after(&self, share: f64, work: &Workspace) -> Placed {
        let moved = self.free.iter().zip(&self.step).map(|(value, change)| value + share * change).collect();
        let there = Coordinates::at(&work.discretization.unknowns, moved, self.parameter);
        (there.displacement, there.placement.turns())
    }
}

impl Workspace {
    /// Estimates the energy that a state out of balance releases.
    ///
    /// # Errors
    /// Where the stiffness has no factor.
    pub fn linear_release(&mut self, at: Configuration) -> Result<LinearRelease, SolveError> {
        self.factorize_at(at)?;
        let forces = self.forces(at);
        let Coordinates { free, placement, parameter, .. } = Coordinates::of(&self.discretization.unknowns, at);
        let residual = placement.restrict(&forces);
        let mut step: Vec<f64> = residual.iter().map(|force| -force).collect();
        self.tangent.solver.solve(&mut step);
        let energy = -0.5 * product(&residual, &step);
        let motion = placement.velocity(&step, &[]);
        Ok(LinearRelease { energy, forces, motion, parameter, free, step })
    }

    /// The part of the energy of a release that lies in the `count` softest modes of the stiffness, found among the step and what the
    /// inverse of the stiffness, which has to be that of the release still, makes of it. At a critical point these modes have hardly any
    /// stiffness, and ½ (r·φ)²/μ says how far off that point is and not what the mesh cannot show.
    pub fn released_by_softest(&mut self, release: &LinearRelease, count: usize) -> f64 {
        let (mut space, mut solved): (Vec<DVector<f64>>, Vec<DVector<f64>>) = (Vec::new(), Vec::new());
        let mut next = DVector::from_column_slice(&release.step);
        for _ in 0..count + MORE_VECTORS {
            // Twice, since what is nearly in the space leaves rounding in it.
            for _ in 0..2 {
                space.iter().for_each(|own| next.axpy(-own.dot(&next), own, 1.0));
            }
            let size = next.norm();
            if size.is_nan() || size <= f64::MIN_POSITIVE {
                break;
            }
            space.push(next / size);
            next = space[space.len() - 1].clone();
            self.tangent.solver.solve(next.as_mut_slice());
            solved.push(next.clone());
        }
        let inverse = DMatrix::from_fn(space.len(), space.len(), |i, j| {
            0.5 * (space[i].dot(&solved[j]) + space[j].dot(&solved[i]))
        });
        let modes = SymmetricEigen::new(inverse);
        let step = DVector::from_iterator(
            space.len(),
            space.iter().map(|own| own.iter().zip(&release.step).map(|(own, step)| own * step).sum::<f64>()),
        );
        let mut softest: Vec<(f64, f64)> = modes
            .eigenvalues
            .iter()
            .zip(modes.eigenvectors.column_iter())
            .map(|(compliance, mode)| (*compliance, 0.5 * mode.dot(&step).powi(2) / compliance))
            .collect();
        softest.sort_by(|one, other| other.0.abs().total_cmp(&one.0.abs()));
        softest.into_iter().take(count).map(|(_, energy)| energy).filter(|energy| energy.is_finite()).sum()
    }

    /// Computes a displacement again from its free unknowns, so that supports and joints hold on this mesh: on a finer one than that
    /// of the state, a section holds other points, and what it gives them differs by what the coarser mesh could not show.
    pub fn allowed(&self, at: Configuration) -> Placed {
        let there =
            Coordinates::at(&self.discretization.unknowns, at.free(&self.discretization.unknowns), at.parameter);
        (there.displacement, there.placement.turns())
    }

    /// Energy ½ dᵀKd of a small motion d of the control points from a configuration, on the whole model, N·mm. Points that supports
    /// or joints hold do not take part.
    ///
    /// # Errors
    /// Where the stiffness has no factor.
    pub fn energy_of_motion(&mut self, at: Configuration, motion: &[[f64; 3]]) -> Result<f64, SolveError> {
        self.factorize_at(at)?;
        let unknowns = &self.discretization.unknowns;
        let held = |point: usize| !unknowns.is_regular(point);
        let free: Vec<[f64; 3]> =
            motion.iter().enumerate().map(|(point, moved)| if held(point) { [0.0; 3] } else { *moved }).collect();
        let forces = self.assembled.multiply(&self.discretization, &free);
        Ok(0.5 * product(forces.as_flattened(), free.as_flattened()))
    }
}
