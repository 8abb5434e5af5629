//! A scene made discrete: the patch that it starts from, and for a mesh its tables, supports and free unknowns.

mod block_pattern;
mod blocks;
mod connectivity;
mod direction;
mod edge;
mod elimination;
mod error;
mod expressions;
mod free_strains;
mod imbalance;
mod joint;
mod loads;
mod mirror;
mod mirror_image;
mod overhang;
mod patch;
mod place;
mod placement;
mod quadrature;
mod reactions;
mod remarks;
mod rigid_motion;
mod rigid_support;
mod rotation;
mod shape;
mod soundness;
mod subdivision;
mod supports;
mod symmetric_line;
mod symmetry_plane;
mod tables;
mod term;
mod thinness;
mod unknowns;

pub use block_pattern::BlockPattern;
pub(crate) use blocks::BLOCK;
pub use blocks::Blocks;
pub use connectivity::{Connectivity, Strand};
pub(crate) use direction::{Site, direction_at};
pub use error::ModelError;
pub(crate) use expressions::control_expressions;
pub use free_strains::{FreeStrains, NaturalState};
pub use patch::{MOST_CONTROL_POINTS, starting_mesh};
pub(crate) use place::{line_place, parameters_of};
pub use placement::Placement;
pub use reactions::{Exerted, PointForces};
pub(crate) use remarks::remarks;
pub(crate) use rigid_motion::free_motion;
pub(crate) use rigid_support::check_balance;
pub use supports::Supports;
pub(crate) use tables::{BATCH, LANES};
pub use tables::{PointTable, Tables};
pub use term::{At, Tangent, Term, TermSource, Terms};
pub use unknowns::{Entry, Unknowns};

use std::sync::Arc;

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
