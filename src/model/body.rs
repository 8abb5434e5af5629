//! A rigid body and its motions, in numbers and words.

use nalgebra::{DMatrix, Matrix3xX};

use crate::shell::{add, basis_vector, cross, dot, norm, scaled, sub};

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
    /// Body that moves.
    pub body: Body,
    /// Free motions, one in each column, orthonormal, as shares of the body's six.
    pub basis: DMatrix<f64>,
}

/// Rigid motions that a support of rigid motions alone holds.
#[derive(Clone, Debug)]
pub struct HeldMotions {
    /// Index of the support.
    pub support: usize,
    /// Motions that the other supports leave free.
    pub free: FreeMotions,
}

impl Body {
    /// Creates the body of some points.
    pub fn around(points: &[[f64; 3]]) -> Self {
        let count = points.len() as f64;
        let middle = points.iter().fold([0.0; 3], |sum, x| [0, 1, 2].map(|c| sum[c] + x[c] / count));
        Self { middle, size: points.iter().map(|x| norm(sub(*x, middle))).fold(0.0, f64::max) }
    }

    /// Displacements of a point by each of the six motions.
    pub fn fields(&self, point: [f64; 3]) -> [[f64; 3]; 6] {
        let arm = scaled(1.0 / self.size, sub(point, self.middle));
        let [x, y, z] = [0, 1, 2].map(basis_vector);
        [x, y, z, cross(x, arm), cross(y, arm), cross(z, arm)]
    }

    /// Describes one of the motions that the columns of a basis span: a translation if there is one, or else a turn.
    pub fn words(&self, basis: &DMatrix<f64>) -> String {
        words(basis, self.middle, self.size)
    }
}

/// Describes one free motion: a translation if there is one, or else a turn.
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
