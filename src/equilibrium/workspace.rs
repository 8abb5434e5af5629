//! Tables, matrix and factor for one mesh.

use std::sync::Arc;

use crate::energy::{Discretization, TermSource, Want};
use crate::equilibrium::assembly::{Assembled, subtract};
use crate::equilibrium::configuration::{Configuration, Coordinates};
use crate::equilibrium::solve_error::{SolveError, WorkspaceError};
use crate::equilibrium::sparse::FactorError;
use crate::equilibrium::tangent_stiffness::TangentStiffness;
use crate::scene::Scene;
use crate::spline::Mesh;

/// Tables, matrix and factor for one mesh, kept between solves. It holds nothing that decides a result: a new one gives
/// the same bits.
#[derive(Debug)]
pub struct Workspace {
    pub(super) discretization: Discretization,
    pub(super) tangent: TangentStiffness,
    pub(super) assembled: Assembled,
    /// Configuration at which the stiffness in `assembled` and its factor were formed, with the negative pivots.
    pub(super) factored_at: Option<Factored>,
}

/// The matrix of a configuration in a workspace, not factored.
pub(super) struct Formed<'w> {
    pub discretization: &'w Discretization,
    pub tangent: &'w mut TangentStiffness,
    pub configuration: Coordinates<'w>,
}

#[derive(Debug)]
pub(super) struct Factored {
    parameter: f64,
    displacement: Vec<[f64; 3]>,
    turns: Vec<[f64; 3]>,
    negative: usize,
}

impl Workspace {
    /// Builds tables, structure and symbolic factor for a mesh.
    ///
    /// # Errors
    /// Where supports or loads do not fit the mesh, or the factor does not fit in memory.
    pub fn new(scene: &Scene, mesh: &Arc<Mesh>) -> Result<Self, WorkspaceError> {
        Self::with_terms(scene, mesh, &[])
    }

    /// Builds tables, structure and symbolic factor, with terms of the caller's own.
    ///
    /// # Errors
    /// Where supports, loads or those terms do not fit the mesh, or the factor does not fit in memory.
    pub fn with_terms(scene: &Scene, mesh: &Arc<Mesh>, own: &[Arc<dyn TermSource>]) -> Result<Self, WorkspaceError> {
        Self::of(Discretization::with_terms(scene, mesh, own)?).map_err(WorkspaceError::from)
    }

    /// Builds structure and symbolic factor for a scene that is already discrete on a mesh.
    ///
    /// # Errors
    /// Where the factor does not fit in memory.
    pub fn of(discretization: Discretization) -> Result<Self, FactorError> {
        let tangent = TangentStiffness::new(&discretization)?;
        let assembled = Assembled::new(&discretization);
        Ok(Self { discretization, tangent, assembled, factored_at: None })
    }

    /// The scene made discrete on the mesh: its tables, unknowns and terms.
    pub fn discretization(&self) -> &Discretization {
        &self.discretization
    }

    /// Energy that the model stores at a displacement and a value of the parameter, N·mm.
    pub fn energy(&self, displacement: &[[f64; 3]], parameter: f64) -> f64 {
        self.discretization.energy(displacement, parameter)
    }

    /// Internal forces less loads on the control points, N: at equilibrium, the reactions of the supports.
    pub fn forces(&self, at: Configuration) -> Vec<[f64; 3]> {
        if self.factored_at.as_ref().is_some_and(|known| known.is_at(&at)) {
            return self.assembled.forces();
        }
        let natural = self.discretization.natural_at(at.parameter);
        let internal = self.discretization.residual(at.displacement, &natural);
        subtract(&internal, &self.discretization.external_forces(at.displacement, at.parameter))
    }

    /// Forms and factors the stiffness at a configuration, unless the last solve left it there; returns the number of
    /// negative pivots. This is not counted in the effort of a solve, which would then depend on what ran before in the
    /// same process.
    pub(super) fn factorize_at(&mut self, at: Configuration) -> Result<usize, SolveError> {
        // Where sections turn freely the state decides the unknowns up to rounding only: those that a solve ended with
        // would give other bits than those of the same state read from a log.
        let exact = !self.discretization.unknowns.turns_are_unknown();
        if let Some(known) = self.factored_at.as_ref().filter(|known| exact && known.is_at(&at)) {
            return Ok(known.negative);
        }
        let negative = self.form_at(at).tangent.factorize_formed()?.count;
        self.factored_at = Some(Factored::new(at, negative));
        Ok(negative)
    }

    /// Forms the matrix on the free unknowns at a state, without factoring it.
    pub(super) fn form_at(&mut self, at: Configuration) -> Formed<'_> {
        self.factored_at = None;
        let Self { discretization, tangent, assembled, .. } = self;
        assembled.assemble(discretization, at.displacement, at.parameter, Want::Stiffness);
        let configuration = Coordinates::of(&discretization.unknowns, at);
        tangent.form(discretization, &configuration.placement, assembled);
        Formed { discretization, tangent, configuration }
    }
}

impl Factored {
    pub(super) fn new(at: Configuration, negative: usize) -> Self {
        let (displacement, turns) = (at.displacement.to_vec(), at.turns.to_vec());
        Self { parameter: at.parameter, displacement, turns, negative }
    }

    fn is_at(&self, at: &Configuration) -> bool {
        self.parameter == at.parameter && self.displacement == at.displacement && self.turns == at.turns
    }
}
