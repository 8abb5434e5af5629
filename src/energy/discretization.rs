//! A scene on a mesh.

use std::sync::Arc;

use crate::energy::{At, Shell, Term, TermSource, Terms};
use crate::model::{BlockPattern, FreeStrains, ModelError, Tables, Unknowns};
use crate::scene::Scene;
use crate::spline::Mesh;

/// A scene made discrete on a mesh: everything that assembly and constraints need beyond the state.
#[derive(Debug)]
pub struct Discretization {
    /// The mesh that it was built for.
    pub mesh: Arc<Mesh>,
    /// Pattern of the blocks that couple control points in a matrix.
    pub blocks: Arc<BlockPattern>,
    /// Free unknowns, and how the control points follow from them.
    pub unknowns: Unknowns,
    /// The shell, which is the first term.
    pub shell: Shell,
    /// Terms other than the shell: loads and further energies.
    pub terms: Terms,
}

impl Discretization {
    /// Builds tables, unknowns and loads; a pure function of scene and mesh.
    ///
    /// # Errors
    /// Where supports or loads do not fit the mesh.
    pub fn new(scene: &Scene, mesh: &Arc<Mesh>) -> Result<Self, ModelError> {
        Self::with_terms(scene, mesh, &[])
    }

    /// Builds tables, unknowns and loads, with terms of the caller's own.
    ///
    /// # Errors
    /// Where supports, loads or those terms do not fit the mesh.
    pub fn with_terms(scene: &Scene, mesh: &Arc<Mesh>, own: &[Arc<dyn TermSource>]) -> Result<Self, ModelError> {
        Self::with_unknowns(scene, mesh, Unknowns::new(scene, mesh)?, own)
    }

    /// Builds tables and loads where the unknowns of scene and mesh are already known.
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
        let blocks = Arc::new(BlockPattern::new(&[&tables.connectivity], &terms.pairs()));
        let shell = Shell { tables, free_strains: FreeStrains::new(scene, mesh), blocks: blocks.clone() };
        Ok(Self { mesh: mesh.clone(), blocks, unknowns, shell, terms })
    }

    /// All terms, the shell first.
    pub fn all_terms(&self) -> impl Iterator<Item = &dyn Term> {
        std::iter::once(&self.shell as &dyn Term).chain(self.terms.iter())
    }

    /// Energy that the model stores at a displacement and a parameter, N·mm.
    pub fn energy(&self, displacement: &[[f64; 3]], parameter: f64) -> f64 {
        let at = At { mesh: &self.mesh, displacement, parameter };
        self.shell.energy(at) + self.terms.energy(at)
    }

    /// Change of the energy that the model stores, N·mm, as the parameter changes while the displacement stays.
    pub fn put_in(&self, displacement: &[[f64; 3]], [from, to]: [f64; 2]) -> f64 {
        let at = At { mesh: &self.mesh, displacement, parameter: from };
        self.all_terms().map(|term| term.put_in(at, to)).sum()
    }

    /// Forces that loads and other terms exert on the control points, N; empty where there are no terms.
    pub fn external_forces(&self, displacement: &[[f64; 3]], parameter: f64) -> Vec<[f64; 3]> {
        match self.terms.is_empty() {
            true => Vec::new(),
            false => self.terms.forces(At { mesh: &self.mesh, displacement, parameter }),
        }
    }
}
