//! What stages keep of the current mesh, so that it is built once.

use std::sync::Arc;

use crate::adapt::Enriched;
use crate::energy::{Discretization, TermSource};
use crate::equilibrium::{Workspace, WorkspaceError};
use crate::model::{ModelError, Unknowns};
use crate::pipeline::imperfect_start::imperfect_mesh;
use crate::scene::Scene;
use crate::spline::Mesh;

/// The workspace of the current mesh, the unknowns of a mesh that has no workspace yet, and, where a tolerance asks for them, the
/// meshes with halved spans. Each is made once for a mesh; and so is the mesh that the scene starts from.
#[derive(Debug, Default)]
pub(super) struct CurrentMesh {
    work: Option<Workspace>,
    ahead: Option<(Arc<Mesh>, Unknowns)>,
    enriched: Option<(Arc<Mesh>, [Enriched; 2])>,
    start: Option<Mesh>,
}

impl CurrentMesh {
    /// Returns the mesh that the scene starts from, which is made if it is not kept.
    pub fn start(&mut self, scene: &Scene, own: &[Arc<dyn TermSource>]) -> Result<&Mesh, ModelError> {
        let start = match self.start.take() {
            Some(start) => start,
            None => imperfect_mesh(scene, own)?,
        };
        Ok(self.start.insert(start))
    }

    /// Returns the unknowns of a mesh, which are made if they are not kept.
    pub fn unknowns(&mut self, scene: &Scene, mesh: &Arc<Mesh>) -> Result<&Unknowns, ModelError> {
        match &self.work {
            Some(work) if is_same(&work.discretization().mesh, mesh) => Ok(&work.discretization().unknowns),
            _ => {
                let unknowns = taken(&mut self.ahead, scene, mesh)?;
                Ok(&self.ahead.insert((mesh.clone(), unknowns)).1)
            }
        }
    }

    /// Returns the workspace of a mesh, which is made if it is not kept.
    pub fn workspace(
        &mut self,
        scene: &Scene,
        own: &[Arc<dyn TermSource>],
        mesh: &Arc<Mesh>,
    ) -> Result<&mut Workspace, WorkspaceError> {
        let work = match self.work.take().filter(|work| is_same(&work.discretization().mesh, mesh)) {
            Some(work) => work,
            None => {
                let unknowns = taken(&mut self.ahead, scene, mesh)?;
                Workspace::of(Discretization::with_unknowns(scene, mesh, unknowns, own)?)?
            }
        };
        Ok(self.work.insert(work))
    }

    /// The shell on a mesh with the spans of one direction halved, for either direction.
    pub fn enriched(
        &mut self,
        scene: &Scene,
        own: &[Arc<dyn TermSource>],
        mesh: &Arc<Mesh>,
    ) -> Result<&mut [Enriched; 2], WorkspaceError> {
        let enriched = match self.enriched.take().filter(|(known, _)| is_same(known, mesh)) {
            Some((_, enriched)) => enriched,
            None => [Enriched::new(scene, own, mesh, 0)?, Enriched::new(scene, own, mesh, 1)?],
        };
        Ok(&mut self.enriched.insert((mesh.clone(), enriched)).1)
    }
}

/// Takes the kept unknowns where they belong to this mesh, or makes new ones.
fn taken(kept: &mut Option<(Arc<Mesh>, Unknowns)>, scene: &Scene, mesh: &Arc<Mesh>) -> Result<Unknowns, ModelError> {
    match kept.take() {
        Some((known, unknowns)) if is_same(&known, mesh) => Ok(unknowns),
        _ => Unknowns::new(scene, mesh),
    }
}

fn is_same(one: &Arc<Mesh>, other: &Arc<Mesh>) -> bool {
    Arc::ptr_eq(one, other) || one == other
}
