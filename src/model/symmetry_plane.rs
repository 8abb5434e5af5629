//! The plane of symmetry that an edge, or a line inside, can lie in: found from the control points of the line as a curve and
//! the steps from them across it.

use crate::model::limits::{ANGLE, POSITION, ROUNDING};
use crate::shell::{add, cross, dot, norm, scaled, sub};
use crate::units::{place, significant};

/// Reasons why an edge or a line lies in no plane of symmetry.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoPlane {
    /// The edge or line is not plane.
    #[error(
        "it leaves a plane by {} mm at {at} (up to {} mm, {POSITION} of its size, is taken for rounding)",
        significant(*off_mm, 3),
        significant(*tolerance_mm, 3)
    )]
    NotPlane {
        /// Largest distance from the plane, mm.
        off_mm: f64,
        /// Position at which it occurs, as text with its unit.
        at: String,
        /// Distance up to which it is taken for rounding, mm.
        tolerance_mm: f64,
    },
    /// The surface leaves the plane at another angle.
    #[error(
        "the surface crosses its plane at {at} {}° off a right angle, so that it leaves it by {} mm (up to {} mm, {POSITION} of its \
         size, is taken for rounding)",
        significant(*off_deg, 3),
        significant(*off_mm, 3),
        significant(*tolerance_mm, 3)
    )]
    NotAtRightAngles {
        /// Deviation from a right angle, degrees.
        off_deg: f64,
        /// Position at which it occurs, as text with its unit.
        at: String,
        /// Largest distance from the plane at right angles to the surface, mm.
        off_mm: f64,
        /// Distance up to which it is taken for rounding, mm.
        tolerance_mm: f64,
    },
    /// The lines of control points leave the plane at another angle.
    #[error(
        "the parametric lines of the surface cross its plane at {at} {}° off a right angle (up to {}° is taken for \
         rounding): put the second row of control points straight behind the first",
        significant(*off_deg, 3),
        significant(ANGLE.to_degrees(), 2)
    )]
    Skewed {
        /// Deviation from a right angle, degrees.
        off_deg: f64,
        /// Position at which it occurs, as text with its unit.
        at: String,
    },
    /// The weights across a line inside are shared out differently along it.
    #[error(
        "the weights of the surface change across the line in shares that differ along it, so that no spline keeps its slope: model the half, whose edge lies there"
    )]
    UnevenWeights,
}

/// Removes the component of a vector along another unit vector, where that is rounding of coordinates.
pub(super) fn square_to(vector: [f64; 3], other: [f64; 3]) -> [f64; 3] {
    let share = dot(vector, other);
    if !(ROUNDING..2.0 * ANGLE).contains(&share.abs()) {
        return vector;
    }
    unit(sub(vector, scaled(share, other)))
}

/// Replaces a vector by the axis that it differs from by rounding of coordinates, if any.
fn along_axis(vector: [f64; 3]) -> [f64; 3] {
    let largest = (0..3).fold(0, |best, c| if vector[c].abs() > vector[best].abs() { c } else { best });
    let mut axis = [0.0; 3];
    axis[largest] = 1.0_f64.copysign(vector[largest]);
    if (ROUNDING..ANGLE).contains(&norm(sub(vector, axis))) { axis } else { vector }
}

/// Normalises a vector.
pub(super) fn unit(vector: [f64; 3]) -> [f64; 3] {
    scaled(1.0 / norm(vector), vector)
}

/// Finds the unit normal of the plane of symmetry that a line of the surface can lie in: the direction of the steps
/// from its control points across it.
///
/// # Errors
/// Where the line cannot lie in one.
pub(super) fn symmetry_plane(points: &[[f64; 3]], steps: &[[f64; 3]]) -> Result<[f64; 3], NoPlane> {
    let off_axis = |normal: [f64; 3], step: [f64; 3]| norm(cross(step, normal)).atan2(dot(step, normal));
    let first = unit(steps[0]);
    let parallel = steps.iter().all(|step| off_axis(first, *step) <= ROUNDING);
    let normal = if parallel { first } else { unit(steps.iter().fold([0.0; 3], |sum, step| add(sum, *step))) };
    let normal = along_axis(normal);

    let origin = scaled(1.0 / points.len() as f64, points.iter().fold([0.0; 3], |sum, point| add(sum, *point)));
    let size = points.iter().map(|point| norm(sub(*point, points[0]))).fold(norm(steps[0]), f64::max);
    let distance = |point: &[f64; 3]| dot(sub(*point, origin), normal).abs();
    let farthest = points.iter().max_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(&points[0]);
    if distance(farthest) > POSITION * size {
        // A plane line whose surface leaves it at an angle, or no plane at all: the line alone says which.
        let (off_mm, at) = off_own_plane(points);
        let tolerance_mm = POSITION * size;
        return Err(match off_mm > tolerance_mm {
            true => NoPlane::NotPlane { off_mm, at: place(at), tolerance_mm },
            false => {
                let slant = |arm: [f64; 3]| dot(arm, normal).abs().atan2(norm(cross(arm, normal)));
                let off = points.iter().map(|point| slant(sub(*point, points[0]))).fold(0.0, f64::max);
                let off_mm = distance(farthest);
                NoPlane::NotAtRightAngles { off_deg: off.to_degrees(), at: place(points[0]), off_mm, tolerance_mm }
            }
        });
    }
    let skewest = steps.iter().map(|step| off_axis(normal, *step)).zip(points);
    let (off, at) = skewest.fold((0.0, &points[0]), |worst, one| if one.0 > worst.0 { one } else { worst });
    match off > ANGLE {
        true => Err(NoPlane::Skewed { off_deg: off.to_degrees(), at: place(*at) }),
        false => Ok(normal),
    }
}

/// Finds the point farthest from the plane through the first point and the two that span most with it, and its
/// distance, mm.
fn off_own_plane(points: &[[f64; 3]]) -> (f64, [f64; 3]) {
    let arms: Vec<[f64; 3]> = points.iter().map(|x| sub(*x, points[0])).collect();
    let longest =
        |vectors: &[[f64; 3]]| vectors.iter().fold([0.0; 3], |best, x| if norm(*x) > norm(best) { *x } else { best });
    let arm = longest(&arms);
    let normal = longest(&arms.iter().map(|x| cross(*x, arm)).collect::<Vec<_>>());
    let length = norm(normal).max(f64::MIN_POSITIVE);
    let off = arms.iter().zip(points).map(|(arm, point)| (dot(*arm, normal).abs() / length, *point));
    off.fold((0.0, points[0]), |worst, one| if one.0 > worst.0 { one } else { worst })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_of_coordinates_is_taken_out_and_no_more() {
        let slanted = unit([1.0, 2e-4, 0.0]);
        assert_eq!(along_axis(slanted), [1.0, 0.0, 0.0]);
        assert_eq!(along_axis(unit([-1.0, 0.0, 3e-3])), unit([-1.0, 0.0, 3e-3]));
        let square = square_to(slanted, unit([3e-4, 1.0, 0.0]));
        assert!(dot(square, unit([3e-4, 1.0, 0.0])).abs() < 1e-15);
        let exact = [1.0, 3e-16, 0.0];
        assert_eq!(along_axis(exact), exact, "bits of exact planes stay");
    }
}
