//! Rigid motions that the supports leave free: found before the first solve, and said in words.

use nalgebra::{DMatrix, Matrix3xX, SMatrix};

use crate::model::Unknowns;
use crate::model::supports::Supports;
use crate::shell::{add, cross, dot, norm, scaled, sub};

/// Squares of how much a motion is held, relative to the most held one, below which it is free. A lever of a millionth of
/// the shell holds nothing.
const HELD: f64 = 1e-12;

/// A free rigid motion in words, if there is one.
pub fn free_motion(unknowns: &Unknowns) -> Option<String> {
    let points = &unknowns.points;
    let free = FreeMotions::new(Body::around(points), unknowns.supports(), points);
    (free.basis.ncols() > 0).then(|| free.body.words(&free.basis))
}

/// A rigid body. It has six motions: translations, and turns about axes through its middle that move its farthest point
/// by 1.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Mean of its points, mm.
    pub middle: [f64; 3],
    /// Distance of the farthest point from the middle, mm.
    size: f64,
}

/// Rigid motions of a body that its supports leave free.
#[derive(Clone, Debug)]
pub struct FreeMotions {
    /// The body.
    pub body: Body,
    /// One in each column, orthonormal, as shares of the body's six.
    pub basis: DMatrix<f64>,
}

impl Body {
    /// The body of some points.
    pub fn around(points: &[[f64; 3]]) -> Self {
        let count = points.len() as f64;
        let middle = points.iter().fold([0.0; 3], |sum, x| [0, 1, 2].map(|c| sum[c] + x[c] / count));
        Self { middle, size: points.iter().map(|x| norm(sub(*x, middle))).fold(0.0, f64::max) }
    }

    /// What each motion does to a point.
    pub fn fields(&self, point: [f64; 3]) -> [[f64; 3]; 6] {
        let arm = scaled(1.0 / self.size, sub(point, self.middle));
        let unit = |k: usize| [0, 1, 2].map(|c| f64::from(u8::from(c == k)));
        [unit(0), unit(1), unit(2), cross(unit(0), arm), cross(unit(1), arm), cross(unit(2), arm)]
    }

    /// One of the motions that the columns of a basis span: a translation if there is one, or else a turn.
    pub fn words(&self, basis: &DMatrix<f64>) -> String {
        words(basis, self.middle, self.size)
    }
}

impl FreeMotions {
    /// What supports on some control points (undeformed, mm) leave free.
    pub fn new(body: Body, supports: &Supports, points: &[[f64; 3]]) -> Self {
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
        Self { body, basis }
    }
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

/// One free motion: a translation if there is one, or else a turn.
fn words(basis: &DMatrix<f64>, middle: [f64; 3], size: f64) -> String {
    let turns = Matrix3xX::from_fn(basis.ncols(), |row, column| basis[(row + 3, column)]);
    let gram = turns.transpose() * &turns;
    let eigen = gram.symmetric_eigen();
    let least = (0..basis.ncols()).fold(0, |a, b| if eigen.eigenvalues[b] < eigen.eigenvalues[a] { b } else { a });
    let most = (0..basis.ncols()).fold(0, |a, b| if eigen.eigenvalues[b] > eigen.eigenvalues[a] { b } else { a });
    let combined = |k: usize| basis * eigen.eigenvectors.column(k);
    let vector = |motion: &DMatrix<f64>, offset: usize| [0, 1, 2].map(|c| motion[(offset + c, 0)]);
    if eigen.eigenvalues[least] < 1e-10 {
        let motion = DMatrix::from_column_slice(6, 1, combined(least).as_slice());
        return format!("it can move along {}", direction(vector(&motion, 0)));
    }
    let motion = DMatrix::from_column_slice(6, 1, combined(most).as_slice());
    let turn = scaled(1.0 / size, vector(&motion, 3));
    let shift = vector(&motion, 0);
    // The axis passes through middle + ω × t / |ω|².
    let offset = scaled(1.0 / dot(turn, turn), cross(turn, shift));
    let at = crate::units::place(add(middle, offset));
    format!("it can turn about an axis along {} through {at}", direction(turn))
}

fn direction(vector: [f64; 3]) -> String {
    let length = norm(vector);
    let unit = scaled(1.0 / length, vector);
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        if unit[axis].abs() > 1.0 - 1e-9 {
            return name.into();
        }
    }
    format!("({:.3}, {:.3}, {:.3})", unit[0], unit[1], unit[2])
}
