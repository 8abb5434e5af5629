//! A scene on a mesh.

use std::sync::Arc;

use crate::energy::{At, TermSource, Terms};
use crate::model::{BlockPattern, FreeStrains, ModelError, Tables, Unknowns};
use crate::scene::Scene;
use crate::spline::Mesh;

/// A scene on a mesh: everything that assembly and constraints need and that a state does not carry.
#[derive(Debug)]
pub struct Discretization {
    /// The mesh that it was built for.
    pub mesh: Arc<Mesh>,
    /// Shape functions and undeformed shell at the quadrature points.
    pub tables: Tables,
    /// Which control points meet in a matrix.
    pub blocks: BlockPattern,
    /// Free unknowns and how control points follow from them.
    pub unknowns: Unknowns,
    /// Loads and energies beside the shell's own.
    pub terms: Terms,
    /// Strains without energy.
    pub free_strains: FreeStrains,
}

impl Discretization {
    /// Builds tables, unknowns and loads; a pure function of scene and mesh.
    ///
    /// # Errors
    /// Where supports or loads do not fit the mesh.
    pub fn new(scene: &Scene, mesh: &Arc<Mesh>) -> Result<Self, ModelError> {
        Self::with_terms(scene, mesh, &[])
    }

    /// The same with terms of the caller's own.
    ///
    /// # Errors
    /// Where supports, loads or those terms do not fit the mesh.
    pub fn with_terms(scene: &Scene, mesh: &Arc<Mesh>, own: &[Arc<dyn TermSource>]) -> Result<Self, ModelError> {
        Self::with_unknowns(scene, mesh, Unknowns::new(scene, mesh)?, own)
    }

    /// The same where the unknowns of scene and mesh are known.
    ///
    /// # Errors
    /// Where loads or terms do not fit the mesh.
    pub fn with_unknowns(
        scene: &Scene,
        mesh: &Arc<Mesh>,
        unknowns: Unknowns,
        own: &[Arc<dyn TermSource>],
    ) -> Result<Self, ModelError> {
        let tables = Tables::new(scene, mesh);
        let terms = Terms::new(scene, mesh, &tables, own)?;
        Ok(Self {
            mesh: mesh.clone(),
            blocks: BlockPattern::new(&[&tables.connectivity], &terms.pairs()),
            tables,
            unknowns,
            terms,
            free_strains: FreeStrains::new(scene, mesh),
        })
    }

    /// Forces that loads and other terms exert on the control points, N; empty where there are no terms.
    pub fn external_forces(&self, displacement: &[[f64; 3]], parameter: f64) -> Vec<[f64; 3]> {
        match self.terms.is_empty() {
            true => Vec::new(),
            false => self.terms.forces(At { mesh: &self.mesh, displacement, parameter }),
        }
    }
}
