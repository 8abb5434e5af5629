//! A scene made discrete: the patch that it starts from, and for a mesh its tables, supports and free unknowns.

mod ends;
mod patch;
mod tables;
mod unknowns;

pub use ends::RigidEnd;
pub use patch::{MOST_CONTROL_POINTS, ModelError, starting_mesh};
pub(crate) use tables::LANES;
pub use tables::Tables;
pub use unknowns::{Entry, Placement, Unknowns};

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
    /// Free unknowns and how control points follow from them.
    pub unknowns: Unknowns,
}

impl Discretization {
    /// Builds tables and unknowns; a pure function of scene and mesh.
    pub fn new(scene: &Scene, mesh: &Arc<Mesh>) -> Self {
        Self { mesh: mesh.clone(), tables: Tables::new(scene, mesh), unknowns: Unknowns::new(scene, mesh) }
    }
}
