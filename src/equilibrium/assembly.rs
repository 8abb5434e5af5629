//! Sums over all terms on control points: energy, forces and stiffness.

use crate::energy::{At, Discretization, Want, with_locked};
use crate::equilibrium::vector::length;
use crate::model::{Blocks, NaturalState};
use crate::shell::add;

/// Sums over all elements and terms, in buffers that are kept between calls.
#[doc(hidden)]
#[derive(Debug, Default)]
pub struct Assembled {
    /// Energy that the model stores: strain energy, and what other terms store, N·mm.
    pub energy: f64,
    /// Euclidean norm of the elements' forces on their control points, before they are summed, N.
    pub element_forces: f64,
    /// Gradient of the strain energy with respect to the control points' displacements, N.
    pub residual: Vec<[f64; 3]>,
    /// Forces that loads and other terms exert on the control points, N; empty where there are none.
    pub external: Vec<[f64; 3]>,
    /// Part of the external forces that terms exert which store energy: internal forces of the model, N; empty where
    /// there are none.
    pub internal: Vec<[f64; 3]>,
    /// Norm of the part of the residual that the free strain causes, which acts like a load, N; 0 where there is none.
    pub free_strain_forces: f64,
    /// Symmetric part of the tangent of the residual less the external forces, N/mm; empty where it is not asked for.
    pub stiffness: Blocks,
    /// Skew part of that tangent, N/mm; empty where there is none.
    pub skew: Blocks,
}

impl Assembled {
    /// Allocates the sums for a mesh.
    pub fn new(discretization: &Discretization) -> Self {
        let stiffness = Blocks::zeros(&discretization.blocks);
        let residual = vec![[0.0; 3]; discretization.blocks.points()];
        Self { residual, stiffness, ..Self::default() }
    }

    /// Assembles residual and energy, and the stiffness where `want` says so, at a displacement of the control points and a
    /// value of the scene's parameter.
    pub fn assemble(&mut self, discretization: &Discretization, displacement: &[[f64; 3]], parameter: f64, want: Want) {
        let natural = discretization.natural_at(parameter);
        self.assemble_shells(discretization, displacement, &natural, want);
        self.add_terms(discretization, displacement, parameter, want);
        self.free_strain_forces = match natural.iter().any(Option::is_some) {
            true => length(&self.change_of_forces(discretization, displacement, &vec![None; natural.len()])),
            false => 0.0,
        };
    }

    /// Computes the change of the internal forces, N, as the natural states become others while the shells stay at
    /// the displacement that it was assembled at. They are linear in the free strain.
    pub(super) fn change_of_forces(
        &self,
        discretization: &Discretization,
        displacement: &[[f64; 3]],
        natural: &[Option<NaturalState>],
    ) -> Vec<[f64; 3]> {
        subtract(&discretization.residual(displacement, natural), &self.residual)
    }

    fn add_terms(&mut self, discretization: &Discretization, displacement: &[[f64; 3]], parameter: f64, want: Want) {
        let Discretization { mesh, terms, blocks, .. } = discretization;
        (self.external, self.internal) = (Vec::new(), Vec::new());
        if !terms.is_empty() {
            let at = At { mesh, displacement, parameter };
            [self.external, self.internal] = terms.forces_apart(at);
            self.external.iter_mut().zip(&self.internal).for_each(|(sum, force)| *sum = add(*sum, *force));
            self.energy += terms.energy(at);
            if want == Want::Stiffness {
                self.skew = terms.add_tangent(at, blocks, &mut self.stiffness);
            }
        }
    }

    /// Assembles energy, residual and stiffness of the shells, where `natural` are their states without forces.
    pub(super) fn assemble_shells(
        &mut self,
        discretization: &Discretization,
        displacement: &[[f64; 3]],
        natural: &[Option<NaturalState>],
        want: Want,
    ) {
        self.residual.fill([0.0; 3]);
        if want == Want::Stiffness {
            self.stiffness.clear();
        }
        let (mut energy, mut squared_forces) = (0.0, 0.0);
        for (shell, natural) in discretization.shells.iter().zip(natural) {
            let sums = shell.elements(*natural).add(displacement, want, &mut self.residual, &mut self.stiffness);
            energy += with_locked(sums.energy, *natural);
            squared_forces += sums.squared_forces;
        }
        self.energy = energy;
        self.element_forces = squared_forces.sqrt();
    }

    /// Forces that are out of balance: the residual less the external forces, N.
    pub fn forces(&self) -> Vec<[f64; 3]> {
        subtract(&self.residual, &self.external)
    }

    /// Whether the tangent has a skew part.
    pub(super) fn has_skew(&self) -> bool {
        !self.skew.is_empty()
    }

    /// Product of the skew part with a field on the control points.
    pub(super) fn multiply_skew(&self, discretization: &Discretization, field: &[[f64; 3]]) -> Vec<[f64; 3]> {
        match self.has_skew() {
            true => self.skew.multiply(&discretization.blocks, -1.0, field),
            false => vec![[0.0; 3]; field.len()],
        }
    }

    /// Product of the stiffness with a field on the control points.
    pub fn multiply(&self, discretization: &Discretization, field: &[[f64; 3]]) -> Vec<[f64; 3]> {
        self.stiffness.multiply(&discretization.blocks, 1.0, field)
    }
}

/// Computes g − f; `external` may be empty.
pub(super) fn subtract(internal: &[[f64; 3]], external: &[[f64; 3]]) -> Vec<[f64; 3]> {
    if external.is_empty() {
        return internal.to_vec();
    }
    internal.iter().zip(external).map(|(g, f)| [0, 1, 2].map(|c| g[c] - f[c])).collect()
}
