//! A scene on a mesh.

use std::sync::Arc;

use crate::energy::{At, Connections, Shell, Term, TermSource, Terms, Want};
use crate::model::{
    BlockPattern, Blocks, Connectivity, FreeStrains, Member, ModelError, NaturalState, Tables, Unknowns, members,
};
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
    /// The shells, which are the first terms.
    pub shells: Vec<Shell>,
    /// The joints and bonds among the terms.
    pub connections: Connections,
    /// Terms other than the shells: loads and further energies.
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
        let tables = Tables::of_structure(scene, mesh);
        let connections = Connections::new(scene, mesh)?;
        let terms = Terms::with_connections(scene, mesh, &tables, own, &connections)?;
        let parts: Vec<&Connectivity> = tables.iter().map(|tables| &tables.connectivity).collect();
        let blocks = Arc::new(BlockPattern::new(&parts, &terms.pairs()));
        let shell = |(tables, member): (Tables, &Member)| Shell {
            tables,
            free_strains: FreeStrains::new(&member.scene, member.patch),
            blocks: blocks.clone(),
            part: member.index,
        };
        let shells = tables.into_iter().zip(&members(scene, mesh)).map(shell).collect();
        Ok(Self { mesh: mesh.clone(), blocks, unknowns, shells, connections, terms })
    }

    /// All terms, the shells first.
    pub fn all_terms(&self) -> impl Iterator<Item = &dyn Term> {
        self.shells.iter().map(|shell| shell as &dyn Term).chain(self.terms.iter())
    }

    /// States of the shells without forces at a value of the parameter; `None` where it is the undeformed one.
    pub fn natural_at(&self, parameter: f64) -> Vec<Option<NaturalState>> {
        self.shells.iter().map(|shell| shell.free_strains.at(parameter)).collect()
    }

    /// Gradient of the strain energy of all shells, N, where `natural` are their states without forces.
    pub(crate) fn residual(&self, displacement: &[[f64; 3]], natural: &[Option<NaturalState>]) -> Vec<[f64; 3]> {
        let mut residual = vec![[0.0; 3]; displacement.len()];
        for (shell, natural) in self.shells.iter().zip(natural) {
            let elements = shell.elements(*natural);
            elements.add(displacement, Want::Residual, &mut residual, &mut Blocks::default());
        }
        residual
    }

    /// Energy that the model stores at a displacement and a parameter, N·mm.
    pub fn energy(&self, displacement: &[[f64; 3]], parameter: f64) -> f64 {
        let at = At { mesh: &self.mesh, displacement, parameter };
        self.shells.iter().map(|shell| shell.energy(at)).sum::<f64>() + self.terms.energy(at)
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
