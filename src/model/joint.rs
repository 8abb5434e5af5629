//! C⁰ knot lines across which the shell must stay smooth: joints of arc segments, and the seam of a full turn.
//!
//! With A = Σ N w u and W = Σ N w, u = A/W has the one-sided derivatives (p/Δ₋)(w₋/w)(u − u₋) and (p/Δ₊)(w₊/w)(u₊ − u) at
//! such a line: equal derivatives put u on the line between its neighbours, in shares of the weights over the spans. The
//! geometry itself says whether it is smooth there. Where it is, but its parameter runs at another speed on either side,
//! derivatives with respect to length are equal instead, and the shares are those of the geometry. Both need the weights
//! of the three lines in one ratio all along.

use crate::model::ModelError;
use crate::model::limits::SMOOTH;
use crate::shell::{add, cross, dot, norm, scaled, sub};
use crate::spline::{Patch, cartesian};

/// Three neighbouring lines of control points of which the middle one follows from the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// Index of the middle line, which follows from the others.
    pub index: usize,
    /// Index of the line before it.
    pub before: usize,
    /// Index of the line after it.
    pub after: usize,
    /// Weight of the line before; only its ratio to the other weight counts.
    pub before_weight: f64,
    /// Weight of the line after; only its ratio to the other weight counts.
    pub after_weight: f64,
}

/// Finds the joints in a direction, which lie at interior knots of full multiplicity.
///
/// # Errors
/// Where the geometry is not smooth there.
pub fn joints(patch: &Patch, direction: usize) -> Result<Vec<Joint>, ModelError> {
    let degree = patch.degree[direction];
    let knots = &patch.knots[direction];
    let count = patch.control_counts()[direction];
    (degree + 1..count)
        .filter(|k| knots[*k] < knots[k + 1] && knots[k + 1 - degree] == knots[*k])
        .map(|last| {
            // Knots last − p + 1 ..= last coincide: function last − p is 1 there.
            let index = last - degree;
            let (before, after) = (index - 1, index + 1);
            let spans = [knots[last] - knots[last - degree], knots[last + 1] - knots[last]];
            smooth(patch, direction, Joint { index, before, after, before_weight: 0.0, after_weight: 0.0 }, spans)
        })
        .collect()
}

/// Finds the seam where the last line of control points meets the first.
///
/// # Errors
/// Where the geometry is not smooth there. The edges must coincide.
pub fn seam(patch: &Patch, direction: usize) -> Result<Joint, ModelError> {
    let degree = patch.degree[direction];
    let knots = &patch.knots[direction];
    let last = patch.control_counts()[direction] - 1;
    let spans = [knots[last + 1] - knots[last], knots[degree + 1] - knots[degree]];
    let joint = Joint { index: 0, before: last - 1, after: 1, before_weight: 0.0, after_weight: 0.0 };
    smooth(patch, direction, joint, spans)
}

/// Moves the middle line of every joint, and of the seam where the surface is `closed`, on to the straight line between
/// its neighbours, and the last line of a closed direction on to the first. What is smooth within the tolerance becomes
/// smooth up to rounding, so that a shell that turns as a whole is not strained.
///
/// # Errors
/// Where the surface is not smooth.
pub fn smoothed(mut patch: Patch, closed: [bool; 2]) -> Result<Patch, ModelError> {
    for direction in 0..2 {
        let last = patch.control_counts()[direction] - 1;
        if closed[direction] {
            copy_line(&mut patch, direction, 0, last);
        }
        for joint in joints(&patch, direction)? {
            straighten(&mut patch, direction, joint);
        }
        if closed[direction] {
            let joint = seam(&patch, direction)?;
            straighten(&mut patch, direction, joint);
            copy_line(&mut patch, direction, 0, last);
        }
    }
    Ok(patch)
}

fn straighten(patch: &mut Patch, direction: usize, joint: Joint) {
    let Joint { index, before, after, before_weight, after_weight } = joint;
    let shares = [before_weight, after_weight].map(|weight| weight / (before_weight + after_weight));
    for across in 0..patch.control_counts()[1 - direction] {
        let [one, other] = [before, after].map(|along| place_of(patch, direction, along, across));
        move_to(patch, direction, [index, across], add(scaled(shares[0], one), scaled(shares[1], other)));
    }
}

fn copy_line(patch: &mut Patch, direction: usize, from: usize, to: usize) {
    for across in 0..patch.control_counts()[1 - direction] {
        let place = place_of(patch, direction, from, across);
        move_to(patch, direction, [to, across], place);
    }
}

fn move_to(patch: &mut Patch, direction: usize, [along, across]: [usize; 2], [x, y, z]: [f64; 3]) {
    let index = patch.grid().index_along(direction, along, across);
    let weight = patch.control_points[index][3];
    patch.control_points[index] = [x * weight, y * weight, z * weight, weight];
}

fn weight_of(patch: &Patch, direction: usize, along: usize, across: usize) -> f64 {
    patch.control_points[patch.grid().index_along(direction, along, across)][3]
}

fn place_of(patch: &Patch, direction: usize, along: usize, across: usize) -> [f64; 3] {
    patch.point(patch.grid().index_along(direction, along, across))
}

/// Finds the weights of a joint, and checks them on every line across it.
fn smooth(patch: &Patch, direction: usize, joint: Joint, spans: [f64; 2]) -> Result<Joint, ModelError> {
    let across = 0..patch.control_counts()[1 - direction];
    let legs: Vec<[[f64; 3]; 2]> = across
        .clone()
        .map(|across| {
            let [before, middle, after] =
                [joint.before, joint.index, joint.after].map(|along| place_of(patch, direction, along, across));
            [sub(middle, before), sub(after, middle)]
        })
        .collect();
    let at = |across: usize| crate::units::place(place_of(patch, direction, joint.index, across));
    for (across, [before, after]) in legs.iter().enumerate() {
        let angle = kink(*before, *after);
        if angle > SMOOTH {
            return Err(ModelError::Kink { at: at(across), angle_deg: angle.to_degrees() });
        }
    }
    let uneven = |along: usize| {
        let ratio = |across: usize| {
            weight_of(patch, direction, along, across) / weight_of(patch, direction, joint.index, across)
        };
        across.clone().find(|across| (ratio(*across) / ratio(0) - 1.0).abs() > SMOOTH)
    };
    let knot = || crate::units::significant(knot_of(patch, direction, joint.index), 6);
    let name = ["u", "v"][direction];
    if let Some(across) = uneven(joint.before).or_else(|| uneven(joint.after)) {
        return Err(ModelError::UnevenJoint { direction: name, knot: knot(), at: at(across), what: "weights" });
    }
    let weights = [joint.before, joint.after].map(|along| weight_of(patch, direction, along, 0));
    let [before_weight, after_weight] = shares(&legs, weights, spans).map_err(|across| ModelError::UnevenJoint {
        direction: name,
        knot: knot(),
        at: at(across),
        what: "speeds",
    })?;
    Ok(Joint { before_weight, after_weight, ..joint })
}

/// Angle between the legs of a line on both sides of its middle point, radians.
fn kink(before: [f64; 3], after: [f64; 3]) -> f64 {
    norm(cross(before, after)).atan2(dot(before, after))
}

/// Finds the shares of the neighbours in the middle points of lines with these legs: by the speeds of the parameter, where `weights` are
/// those of the neighbours and `spans` the parameter's steps to them over the degree, or else by the lengths of the legs.
///
/// # Errors
/// The line on which derivatives differ most, where neither makes them equal.
fn shares(legs: &[[[f64; 3]; 2]], weights: [f64; 2], spans: [f64; 2]) -> Result<[f64; 2], usize> {
    // How far off equal derivatives are, as a share of the step from the line before to the line after.
    let misfit = |[before_weight, after_weight]: [f64; 2]| {
        let off = legs.iter().enumerate().map(|(across, [before, after])| {
            let step = norm(sub(scaled(after_weight, *after), scaled(before_weight, *before)));
            (across, step / ((before_weight + after_weight) * norm(add(*before, *after))))
        });
        off.fold((0, 0.0), |worst, one| if one.1 > worst.1 { one } else { worst })
    };
    let by_parameter = [weights[0] / spans[0], weights[1] / spans[1]];
    let by_length = [0, 1].map(|side| 1.0 / legs.iter().map(|leg| norm(leg[side])).sum::<f64>());
    let found = [by_parameter, by_length].into_iter().find(|shares| misfit(*shares).1 <= SMOOTH);
    found.ok_or_else(|| misfit(by_length).0)
}

/// Shares of the neighbours in the middle points of lines of three control points (homogeneous) that cross a joint of two patches
/// ([`shares`]); `None` where the surface is not smooth there, or where the lines do not go on in one ratio.
pub(super) fn shares_across(lines: &[[[f64; 4]; 3]], spans: [f64; 2]) -> Option<[f64; 2]> {
    let legs_of = |line: &[[f64; 4]; 3]| {
        let [before, middle, after] = line.map(cartesian);
        [sub(middle, before), sub(after, middle)]
    };
    let legs: Vec<[[f64; 3]; 2]> = lines.iter().map(legs_of).collect();
    let ratio = |line: &[[f64; 4]; 3], at: usize| line[at][3] / line[1][3];
    let is_even =
        |line: &[[f64; 4]; 3]| [0, 2].iter().all(|at| (ratio(line, *at) / ratio(&lines[0], *at) - 1.0).abs() <= SMOOTH);
    if !legs.iter().all(|[before, after]| kink(*before, *after) <= SMOOTH) || !lines.iter().all(is_even) {
        return None;
    }
    shares(&legs, [lines[0][0][3], lines[0][2][3]], spans).ok()
}

/// Knot at which the function of a line is 1; for a seam, the first knot.
fn knot_of(patch: &Patch, direction: usize, line: usize) -> f64 {
    patch.knots[direction][line + 1]
}
