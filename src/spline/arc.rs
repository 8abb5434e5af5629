//! Exact curves in homogeneous coordinates: straight line and circular arc of any degree from 2 up.
//!
//! An arc is built from rational quadratic Bézier segments (NURBS Book, section 7.3), raised in degree in homogeneous
//! coordinates, which keeps the curve. Up to [`WIDEST_SEGMENT`] it is one segment: a wider one would be parametrised
//! ever more unevenly (its weight cos(angle/2) falls to zero at 180°). Beyond, equal segments meet at knots of full
//! multiplicity: there the geometry is C¹ but the basis only C⁰, and the model ties the control points on both
//! sides so that displacements are C¹ as well.

/// Widest arc of one segment, radians (150°).
pub const WIDEST_SEGMENT: f64 = 150.0 * std::f64::consts::PI / 180.0;

/// A rational curve in a plane: open knots and homogeneous control points (u w, v w, w).
#[derive(Clone, Debug, PartialEq)]
pub struct HomogeneousCurve {
    /// Polynomial degree.
    pub degree: usize,
    /// Open knot vector on [0, 1].
    pub knots: Vec<f64>,
    /// Homogeneous control points (u w, v w, w).
    pub points: Vec<[f64; 3]>,
}

/// Builds the line from (0, 0) to (length, 0), parametrised by arc length.
pub fn straight_line(length: f64, degree: usize) -> HomogeneousCurve {
    let points = raise(&[[0.0, 0.0, 1.0], [length, 0.0, 1.0]], degree);
    HomogeneousCurve { degree, knots: joint_knots(1, degree), points }
}

/// Builds the arc of the circle about the origin from angle `from` to `to` (radians, measured from the v axis towards u):
/// the point at angle φ is (R sin φ, R cos φ).
pub fn circular_arc(radius: f64, from: f64, to: f64, degree: usize) -> HomogeneousCurve {
    let segments = segment_count(to - from);
    let sweep = (to - from) / segments as f64;
    let middle_weight = (sweep / 2.0).cos();
    let on_circle = |angle: f64| [radius * angle.sin(), radius * angle.cos(), 1.0];
    let mut points: Vec<[f64; 3]> = Vec::new();
    for segment in 0..segments {
        let start = from + segment as f64 * sweep;
        // The middle point of a quadratic segment lies at R / cos(sweep/2): its homogeneous form needs no division.
        let middle = start + sweep / 2.0;
        let quadratic =
            [on_circle(start), [radius * middle.sin(), radius * middle.cos(), middle_weight], on_circle(start + sweep)];
        points.pop();
        points.extend(raise(&quadratic, degree));
    }
    HomogeneousCurve { degree, knots: joint_knots(segments, degree), points }
}

/// Number of segments that an arc of this sweep (radians) is built from.
pub fn segment_count(sweep: f64) -> usize {
    if sweep <= WIDEST_SEGMENT { 1 } else { (sweep / (WIDEST_SEGMENT * 0.8)).ceil() as usize }
}

fn joint_knots(segments: usize, degree: usize) -> Vec<f64> {
    let mut knots = vec![0.0; degree + 1];
    for joint in 1..segments {
        knots.extend(std::iter::repeat_n(joint as f64 / segments as f64, degree));
    }
    knots.extend(std::iter::repeat_n(1.0, degree + 1));
    knots
}

/// Bézier degree elevation (NURBS Book, eq. 5.36, one degree at a time).
fn raise(bezier: &[[f64; 3]], degree: usize) -> Vec<[f64; 3]> {
    let mut points = bezier.to_vec();
    while points.len() < degree + 1 {
        let next = points.len() as f64;
        let mut raised = vec![points[0]];
        for i in 1..points.len() {
            let share = i as f64 / next;
            raised.push([0, 1, 2].map(|c| share * points[i - 1][c] + (1.0 - share) * points[i][c]));
        }
        raised.push(points[points.len() - 1]);
        points = raised;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::{basis_derivatives, find_span};

    #[test]
    fn every_point_of_an_arc_lies_on_the_circle() {
        for degree in 2..=5 {
            for sweep_deg in [20.0, 110.0, 149.0, 180.0, 270.0, 350.0_f64] {
                let sweep = sweep_deg.to_radians();
                let curve = circular_arc(10.0, -sweep / 2.0, sweep / 2.0, degree);
                for sample in 0..=40 {
                    let parameter = sample as f64 / 40.0;
                    let span = find_span(&curve.knots, degree, parameter);
                    let mut basis = vec![0.0; 3 * (degree + 1)];
                    basis_derivatives(&curve.knots, degree, span, parameter, &mut basis);
                    let mut sum = [0.0; 3];
                    for a in 0..=degree {
                        for c in 0..3 {
                            sum[c] += basis[a] * curve.points[span - degree + a][c];
                        }
                    }
                    let radius = (sum[0] / sum[2]).hypot(sum[1] / sum[2]);
                    assert!((radius - 10.0).abs() < 1e-13, "degree {degree}, {sweep_deg}°: {radius}");
                }
            }
        }
    }
}
