//! Rigid motions that the supports leave free: found before the first solve, and said in words.

use nalgebra::{DMatrix, Matrix3xX, SMatrix};

use crate::model::Unknowns;
use crate::shell::{add, cross, dot, norm, scaled, sub};

/// Squares of how much a motion is held, relative to the most held one, below which it is free. A lever of a millionth of
/// the shell holds nothing.
const HELD: f64 = 1e-12;

/// A free rigid motion in words, if there is one.
pub fn free_motion(unknowns: &Unknowns) -> Option<String> {
    let points = &unknowns.points;
    let count = points.len() as f64;
    let middle = points.iter().fold([0.0; 3], |sum, x| [0, 1, 2].map(|c| sum[c] + x[c] / count));
    let size = points.iter().map(|x| norm(sub(*x, middle))).fold(0.0, f64::max);
    let mut gram = SMatrix::<f64, 6, 6>::zeros();
    for row in rows(unknowns, middle, size) {
        let row = SMatrix::<f64, 6, 1>::from(row);
        let length = row.norm();
        if length > 0.0 {
            gram += (row / length) * (row / length).transpose();
        }
    }
    let eigen = gram.symmetric_eigen();
    let most = eigen.eigenvalues.max();
    let free: Vec<usize> = (0..6).filter(|k| eigen.eigenvalues[*k] <= HELD * most.max(1.0)).collect();
    if free.is_empty() {
        return None;
    }
    let basis = DMatrix::from_fn(6, free.len(), |row, column| eigen.eigenvectors[(row, free[column])]);
    Some(words(&basis, middle, size))
}

/// What each constraint makes of the six rigid motions: translations, and turns about axes through `middle` that move the
/// farthest point by 1.
fn rows(unknowns: &Unknowns, middle: [f64; 3], size: f64) -> Vec<[f64; 6]> {
    let supports = unknowns.supports();
    let field = |point: [f64; 3]| {
        let arm = scaled(1.0 / size, sub(point, middle));
        let unit = |k: usize| [0, 1, 2].map(|c| f64::from(u8::from(c == k)));
        [unit(0), unit(1), unit(2), cross(unit(0), arm), cross(unit(1), arm), cross(unit(2), arm)]
    };
    let in_space =
        |component: usize| component >= 3 * unknowns.points.len() || supports.section_of[component / 3].is_none();
    let mut rows: Vec<[f64; 6]> = supports
        .constraints
        .iter()
        .filter(|expression| expression.iter().all(|(component, _)| in_space(*component)))
        .map(|expression| {
            let mut row = [0.0; 6];
            for (component, factor) in expression.iter().filter(|(c, _)| *c < 3 * unknowns.points.len()) {
                let fields = field(unknowns.points[component / 3]);
                (0..6).for_each(|k| row[k] += factor * fields[k][component % 3]);
            }
            row
        })
        .collect();
    for section in &supports.sections {
        let fields = field(section.centre);
        for (motion, law) in section.motions.iter().enumerate().filter(|(_, law)| law.is_some()) {
            let _ = law;
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
