//! The mesh that a run starts from: the perfect surfaces, or these with the imperfections of the scene.

use std::sync::Arc;

use crate::energy::TermSource;
use crate::model::{
    ImperfectionField, ModelError, kept_together, largest_offset, moved, perfect_on, starting_mesh, thinnest_mm,
};
use crate::pipeline::buckled_shape::buckled_shape;
use crate::scene::{ImperfectionKind, Scene};
use crate::shell::{add, sub};
use crate::spline::Mesh;
use crate::units::{count, place, significant};

/// Builds the mesh that a run of a scene starts from.
///
/// # Errors
/// As for [`starting_mesh`], and where the surfaces cannot be imperfect as the scene asks for.
pub fn imperfect_mesh(scene: &Scene, own: &[Arc<dyn TermSource>]) -> Result<Mesh, ModelError> {
    let perfect = Arc::new(starting_mesh(scene)?);
    if scene.imperfections.is_empty() {
        return Ok(Arc::unwrap_or_clone(perfect));
    }
    let mut moves = vec![[0.0; 3]; perfect.point_count()];
    for imperfection in &scene.imperfections {
        let name = &imperfection.name;
        let field = ImperfectionField::of(scene, imperfection);
        let shape = match (&imperfection.kind, &field) {
            (ImperfectionKind::Modes { modes, amplitude, seed }, _) => {
                buckled_shape(scene, &perfect, own, name, modes, *amplitude * thinnest_mm(scene), *seed)?
            }
            (_, Some(field)) => field.moves(&perfect),
            (_, None) => continue,
        };
        let is_free = field.is_none_or(|field| field.is_smooth_in_space());
        let kept = kept_together(scene, &perfect, name, shape, is_free)?;
        moves.iter_mut().zip(kept).for_each(|(sum, shift)| *sum = add(*sum, shift));
    }
    moved(scene, &perfect, &moves)
}

/// Says how imperfect a mesh is, and what of that it does not show, a sentence each.
///
/// # Errors
/// As for [`starting_mesh`].
pub(super) fn imperfection_remarks(scene: &Scene, mesh: &Mesh) -> Result<Vec<String>, ModelError> {
    if scene.imperfections.is_empty() {
        return Ok(Vec::new());
    }
    let perfect = perfect_on(scene, mesh)?;
    let moves: Vec<[f64; 3]> = mesh.points().zip(perfect.points()).map(|(is, was)| sub(is, was)).collect();
    let largest = largest_offset(scene, &perfect, &moves);
    let mut remarks = vec![format!(
        "the geometry is imperfect ({}): up to {} thicknesses, {} mm, off the perfect one, at {}",
        count(scene.imperfections.len(), "imperfection"),
        significant(largest.mm / thinnest_mm(scene), 4),
        significant(largest.mm, 4),
        place(largest.at)
    )];
    for imperfection in &scene.imperfections {
        let lost = ImperfectionField::of(scene, imperfection).and_then(|field| field.not_shown(&perfect));
        remarks.extend(lost.map(|share| {
            format!(
                "the mesh does not show {} % of imperfection \"{}\" (root mean square): its elements are too long for it",
                significant(100.0 * share, 2),
                imperfection.name
            )
        }));
    }
    Ok(remarks)
}
