//! A profile of straight pieces and arcs as one exact curve.
//!
//! Every piece is one segment, and a wide arc several: a line raised to the degree, or a rational quadratic arc. They meet at
//! knots of full multiplicity that lie at their fractions of the whole length. The tangent goes on there, though the parameter
//! changes its speed where an arc begins or ends: an arc of one segment of sweep s starts with sin(s/2)/(s/2) of its mean speed.

use crate::scene::ProfilePiece;
use crate::spline::{HomogeneousCurve, circular_arc, segment_count, straight_line};

/// A stretch of a profile between two knots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfileSegment {
    /// Its length, mm.
    pub length_mm: f64,
    /// Angle by which it turns, radians, positive from +y towards +z; 0 for a line.
    pub turn: f64,
}

/// Lists the segments of a profile.
pub fn profile_segments(profile: &[ProfilePiece]) -> Vec<ProfileSegment> {
    let of_piece = |piece: &ProfilePiece| {
        let turn = piece.turn_deg().to_radians();
        let count = segment_count(turn.abs());
        let segment = ProfileSegment { length_mm: piece.length_mm() / count as f64, turn: turn / count as f64 };
        std::iter::repeat_n(segment, count)
    };
    profile.iter().flat_map(of_piece).collect()
}

/// Returns the parameter at which each segment ends; the last is 1. Equal segments end at equal steps.
pub fn profile_knots(segments: &[ProfileSegment]) -> Vec<f64> {
    let whole: f64 = segments.iter().map(|segment| segment.length_mm).sum();
    let is_even = segments.iter().all(|segment| segment.length_mm == segments[0].length_mm);
    let mut reached = 0.0;
    let end = |(index, segment): (usize, &ProfileSegment)| {
        reached += segment.length_mm;
        match (index + 1 == segments.len(), is_even) {
            (true, _) => 1.0,
            (false, true) => (index + 1) as f64 / segments.len() as f64,
            (false, false) => reached / whole,
        }
    };
    segments.iter().enumerate().map(end).collect()
}

/// Builds the profile from a start (y, z) in a direction: points (y w, z w, w) on [0, 1].
pub fn profile_curve(
    profile: &[ProfilePiece],
    start_mm: [f64; 2],
    direction_deg: f64,
    degree: usize,
) -> HomogeneousCurve {
    let mut at = start_mm;
    let mut heading_deg = direction_deg;
    let mut points: Vec<[f64; 3]> = Vec::new();
    for piece in profile {
        let curve = placed(piece, at, heading_deg, degree);
        // The point in which two pieces meet is that of the later one, which differs by rounding.
        points.pop();
        points.extend(curve);
        heading_deg += piece.turn_deg();
        at = points.last().map_or(at, |[y, z, w]| [y / w, z / w]);
    }
    let ends = profile_knots(&profile_segments(profile));
    let mut knots = vec![0.0; degree + 1];
    ends.iter().for_each(|end| knots.extend(std::iter::repeat_n(*end, degree)));
    knots.push(1.0);
    HomogeneousCurve { degree, knots, points }
}

/// Homogeneous control points of a piece that starts somewhere in a direction.
fn placed(piece: &ProfilePiece, [y, z]: [f64; 2], heading_deg: f64, degree: usize) -> Vec<[f64; 3]> {
    let (sin, cos) = heading_deg.to_radians().sin_cos();
    match piece {
        ProfilePiece::Line { line_mm } => {
            let along = |[s, _, w]: [f64; 3]| [y * w + s * cos, z * w + s * sin, w];
            straight_line(*line_mm, degree).points.into_iter().map(along).collect()
        }
        ProfilePiece::Arc { arc_deg, radius_mm } => {
            let side = arc_deg.signum();
            // The centre lies to the side that the arc turns to; angles are measured from the way to its start.
            let [to_centre_y, to_centre_z] = [-side * sin, side * cos];
            let arc = circular_arc(*radius_mm, 0.0, arc_deg.abs().to_radians(), degree);
            let turned = |[along, away, w]: [f64; 3]| {
                let inwards = radius_mm * w - away;
                [y * w + along * cos + inwards * to_centre_y, z * w + along * sin + inwards * to_centre_z, w]
            };
            arc.points.into_iter().map(turned).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{parameters_of, starting_patch};
    use crate::scene::{Geometry, parse};
    use crate::shell::{cross, dot, norm};
    use crate::spline::mid_surface_point;

    fn line(line_mm: f64) -> ProfilePiece {
        ProfilePiece::Line { line_mm }
    }

    fn arc(arc_deg: f64, radius_mm: f64) -> ProfilePiece {
        ProfilePiece::Arc { arc_deg, radius_mm }
    }

    /// y, z and the direction (radians) at a length from the start: of each piece its chord, 2 R sin of half its angle, in the
    /// mean of its directions.
    fn walked(
        profile: &[ProfilePiece],
        [mut y, mut z]: [f64; 2],
        direction_deg: f64,
        mut left: f64,
    ) -> ([f64; 2], f64) {
        let mut heading = direction_deg.to_radians();
        for piece in profile {
            let length = piece.length_mm().min(left);
            left -= length;
            let turn = length / piece.length_mm() * piece.turn_deg().to_radians();
            let chord = if turn == 0.0 { length } else { length * (turn / 2.0).sin() / (turn / 2.0) };
            y += chord * (heading + turn / 2.0).cos();
            z += chord * (heading + turn / 2.0).sin();
            heading += turn;
        }
        ([y, z], heading)
    }

    /// At any fractions of length and profile the surface is where the profile says, with its normal on the left.
    #[test]
    fn a_profile_is_exact_at_fractions_of_its_length() {
        let profiles = [
            vec![line(8.0), arc(105.0, 10.6)],
            vec![line(5.0), arc(60.0, 12.0), arc(-120.0, 12.0), arc(60.0, 12.0), line(5.0)],
            vec![arc(340.0, 9.0), arc(200.0, 4.0), line(2.0), arc(-100.0, 0.5)],
            vec![arc(-200.0, 3.0)],
            vec![line(3.0), line(0.02)],
        ];
        let mut scene = parse(include_str!("../../pipelines/verification/rolled-cantilever.toml"), "x.toml").unwrap();
        scene.mesh.elements = [3, 13];
        for (degree, profile) in (2..=5).flat_map(|degree| profiles.iter().map(move |profile| (degree, profile))) {
            let (start_mm, direction_deg) = ([-3.0, 5.0], -37.0);
            scene.geometry = Geometry::Profile { length_mm: 40.0, profile: profile.clone(), start_mm, direction_deg };
            scene.mesh.degree = [degree; 2];
            let mesh = starting_patch(&scene).unwrap();
            assert_eq!(mesh.element_counts(), [3, 13]);
            let whole: f64 = profile.iter().map(ProfilePiece::length_mm).sum();
            for k in 0..=200 {
                let [u, v] = [f64::from(k % 7) / 6.0, f64::from(k) / 200.0];
                let point = mid_surface_point(&mesh, &[], parameters_of(&scene.geometry, [u, v]));
                let ([y, z], heading) = walked(profile, start_mm, direction_deg, v * whole);
                let off = [point.position[0] - 40.0 * u, point.position[1] - y, point.position[2] - z];
                assert!(norm(off) < 1e-11, "{profile:?} degree {degree} at {v}: {off:?}");
                let normal = cross(point.derivatives[0], point.derivatives[1]);
                let left = [0.0, -heading.sin(), heading.cos()];
                assert!(dot(normal, left) > (1.0 - 1e-12) * norm(normal), "{profile:?} degree {degree} at {v}");
            }
        }
    }
}
