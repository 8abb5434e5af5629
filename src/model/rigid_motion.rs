//! Search for the rigid motions that supports leave free.

use nalgebra::{DMatrix, SMatrix};

use crate::model::body::{Body, FreeMotions};
use crate::model::supports::Supports;

/// Square of how much a motion is held, relative to the most held one, below which it is free. A lever of a millionth
/// of the shell holds nothing.
pub(crate) const HELD: f64 = 1e-12;

/// Finds the rigid motions of a body that supports on some control points (undeformed, mm) leave free.
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

/// Evaluates each constraint on the six rigid motions.
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
