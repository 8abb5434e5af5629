//! Rigid motions that the supports leave free, found before the first solve.

use std::sync::Arc;

use nalgebra::{DMatrix, SMatrix};

use crate::model::body::{Body, FreeMotions};
use crate::model::supports::Supports;
use crate::model::{At, BlockPattern, Blocks, ModelError, Tables, TermSource, Terms, Unknowns};
use crate::scene::Scene;
use crate::spline::Mesh;

/// Squares of how much a motion is held, relative to the most held one, below which it is free. A lever of a millionth of
/// the shell holds nothing.
const HELD: f64 = 1e-12;

/// Refuses a shell that neither supports nor terms of the caller's own hold.
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
    if free.basis.ncols() > 0 && !own.is_empty() {
        [free, _] = free.parted_by_terms(scene, mesh, own)?;
    }
    match free.basis.ncols() {
        0 => Ok(()),
        _ => Err(ModelError::FreeMotion { motion: free.body.words(&free.basis) }),
    }
}

impl FreeMotions {
    /// Those that the terms of a scene answer by no force, and those that they hold, at the undeformed shell.
    ///
    /// # Errors
    /// Where one of the terms does not fit the mesh.
    pub fn parted_by_terms(
        &self,
        scene: &Scene,
        mesh: &Mesh,
        own: &[Arc<dyn TermSource>],
    ) -> Result<[Self; 2], ModelError> {
        let tables = Tables::new(scene, mesh);
        let terms = Terms::new(scene, mesh, &tables, own)?;
        let pattern = BlockPattern::new(&[&tables.connectivity], &terms.pairs());
        let mut stiffness = Blocks::zeros(&pattern);
        let still = vec![[0.0; 3]; mesh.control_points.len()];
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

/// The rigid motions of a body that supports on some control points (undeformed, mm) leave free.
pub fn free_motions(body: Body, supports: &Supports, points: &[[f64; 3]]) -> FreeMotions {
    let mut gram = SMatrix::<f64, 6, 6>::zeros();
    for row in rows(body, supports, points) {
        let row = SMatrix::<f64, 6, 1>::from(row);
        let length = row.norm();
        if length > 0.0 {
            gram += (row / length) * (row / length).transpose();
        }
    }
    let eigen = gram.symmetric_eigen();
    let most = eigen.eigenvalues.max();
    let free: Vec<usize> = (0..6).filter(|k| eigen.eigenvalues[*k] <= HELD * most.max(1.0)).collect();
    let basis = DMatrix::from_fn(6, free.len(), |row, column| eigen.eigenvectors[(row, free[column])]);
    FreeMotions { body, basis }
}

/// What each constraint makes of the six rigid motions.
fn rows(body: Body, supports: &Supports, points: &[[f64; 3]]) -> Vec<[f64; 6]> {
    let in_space = |component: usize| component >= 3 * points.len() || supports.section_of[component / 3].is_none();
    let mut rows: Vec<[f64; 6]> = supports
        .constraints
        .iter()
        .filter(|expression| expression.iter().all(|(component, _)| in_space(*component)))
        .map(|expression| {
            let mut row = [0.0; 6];
            for (component, factor) in expression.iter().filter(|(c, _)| *c < 3 * points.len()) {
                let fields = body.fields(points[component / 3]);
                (0..6).for_each(|k| row[k] += factor * fields[k][component % 3]);
            }
            row
        })
        .collect();
    for section in &supports.sections {
        let fields = body.fields(section.centre);
        for motion in (0..6).filter(|motion| section.motions[*motion].is_some()) {
            rows.push([0, 1, 2, 3, 4, 5].map(|k| match motion {
                0..=2 => fields[k][motion],
                _ => f64::from(u8::from(k == motion)),
            }));
        }
    }
    rows.retain(|row| row.iter().any(|value| value.abs() > 1e-9));
    rows
}
