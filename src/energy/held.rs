//! Whether supports and terms hold the shell, found before the first solve.

use std::sync::Arc;

use nalgebra::DMatrix;

use crate::energy::{At, Connections, TermSource, Terms};
use crate::model::{
    BlockPattern, Blocks, Body, Connectivity, FreeMotions, HELD, Member, ModelError, Tables, Unknowns, free_motions,
    members,
};
use crate::scene::{Hold, Scene};
use crate::spline::Mesh;

/// Supports at most of which it is tried whether u and v are exchanged.
const MOST_EXCHANGED: usize = 10;

/// Refuses a shell that neither supports nor springs nor terms of the caller's own hold.
///
/// # Errors
/// Where a rigid motion is free, or one of the terms does not fit the mesh.
pub fn check_held(
    scene: &Scene,
    mesh: &Mesh,
    unknowns: &Unknowns,
    own: &[Arc<dyn TermSource>],
) -> Result<(), ModelError> {
    let points = &unknowns.points;
    let mut free = free_motions(Body::around(points), unknowns.supports(), points);
    if free.basis.ncols() > 0 && Terms::may_store(scene, own) {
        [free, _] = free.parted_by_terms(scene, mesh, own)?;
    }
    match free.basis.ncols() {
        0 if own.is_empty() => check_apart(scene, mesh),
        0 => Ok(()),
        _ => Err(ModelError::FreeMotion { motion: free.body.words(&free.basis), instead: held_instead(scene, mesh) }),
    }
}

/// Refuses a shell that nothing connects to the others, and supports of its own do not hold.
fn check_apart(scene: &Scene, mesh: &Mesh) -> Result<(), ModelError> {
    for Member { index, scene: alone, patch, .. } in members(scene, mesh) {
        if scene.shell_count() == 1 || !is_apart(scene, index) {
            continue;
        }
        let unknowns = Unknowns::new(&alone, &Mesh { patches: vec![patch.clone()] })?;
        let free = free_motions(Body::around(&unknowns.points), unknowns.supports(), &unknowns.points);
        if free.basis.ncols() > 0 {
            let (motion, name) = (free.body.words(&free.basis), scene.shell_name(index).unwrap_or_default());
            let motion =
                format!("{motion}, of shell \"{name}\", which no joint, bond or section connects to another one");
            return Err(ModelError::FreeMotion { motion, instead: Vec::new() });
        }
    }
    Ok(())
}

/// Whether a shell stands for itself: nothing connects it to another one, and neither a spring nor a support of rigid motions holds it.
fn is_apart(scene: &Scene, shell: usize) -> bool {
    let joined = scene.joints.iter().any(|joint| joint.edges.iter().any(|edge| edge.shell == shell));
    let glued = scene.bonds.iter().any(|bond| bond.shells.contains(&shell));
    let held = scene.supports.iter().any(|support| {
        let has = support.edges().any(|edge| edge.shell == shell);
        let shared = support.edges().any(|edge| edge.shell != shell);
        let springs = scene.springs.iter().any(|spring| spring.section == support.name);
        matches!(support.hold, Hold::RigidMotions) || (has && (shared || springs))
    });
    !(joined || glued || held)
}

/// Supports each of which would hold the shell, with the others, at the place with u and v exchanged, and that place.
fn held_instead(scene: &Scene, mesh: &Mesh) -> Vec<(String, String)> {
    let holds = |index: usize| {
        let mut other = scene.clone();
        let support = other.supports.get_mut(index)?;
        let place = support.on.exchanged();
        if place == support.on {
            return None;
        }
        support.on = place;
        let unknowns = Unknowns::new(&other, mesh).ok()?;
        let free = free_motions(Body::around(&unknowns.points), unknowns.supports(), &unknowns.points);
        (free.basis.ncols() == 0).then(|| (other.supports.swap_remove(index).name, place.to_string()))
    };
    (0..scene.supports.len().min(MOST_EXCHANGED)).filter_map(holds).collect()
}

impl FreeMotions {
    /// Splits the motions into those that the terms of a scene exert no force against, and those that they hold, at the
    /// undeformed shell.
    ///
    /// # Errors
    /// Where one of the terms does not fit the mesh.
    pub fn parted_by_terms(
        &self,
        scene: &Scene,
        mesh: &Mesh,
        own: &[Arc<dyn TermSource>],
    ) -> Result<[Self; 2], ModelError> {
        let tables = Tables::of_structure(scene, mesh);
        // Joints and bonds hold nothing of the whole structure, and are too stiff to compare with.
        let terms = Terms::with_connections(scene, mesh, &tables, own, &Connections::default())?;
        let parts: Vec<&Connectivity> = tables.iter().map(|tables| &tables.connectivity).collect();
        let pattern = BlockPattern::new(&parts, &terms.pairs());
        let mut stiffness = Blocks::zeros(&pattern);
        let still = vec![[0.0; 3]; mesh.point_count()];
        terms.add_tangent(At { mesh, displacement: &still, parameter: 0.0 }, &pattern, &mut stiffness);
        let answers = self.basis.column_iter().map(|motion| {
            let moved = |point| {
                let fields = self.body.fields(point);
                [0, 1, 2].map(|c| (0..6).map(|k| motion[k] * fields[k][c]).sum::<f64>())
            };
            let field: Vec<[f64; 3]> = mesh.points().map(moved).collect();
            stiffness.multiply(&pattern, 1.0, &field).into_flattened()
        });
        let answers: Vec<f64> = answers.flatten().collect();
        let answers = DMatrix::from_vec(3 * still.len(), self.basis.ncols(), answers);
        let eigen = answers.tr_mul(&answers).symmetric_eigen();
        let size: f64 = stiffness.diagonal(&pattern).flatten().map(|value| value * value).sum();
        let are_held = |held: bool| -> Self {
            let chosen = (0..self.basis.ncols()).filter(|k| (eigen.eigenvalues[*k] > HELD * size) == held);
            let chosen: Vec<usize> = chosen.collect();
            Self { body: self.body, basis: &self.basis * eigen.eigenvectors.select_columns(&chosen) }
        };
        Ok([false, true].map(are_held))
    }
}
