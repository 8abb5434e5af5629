//! Points of the area over which two shells are glued: where their faces lie together.

use std::borrow::Cow;

use super::coupled::CoupledPoint;
use super::glue::Glue;
use super::layer::{Layer, Side};
use crate::model::{Member, ModelError, gauss_points};
use crate::scene::Bond;
use crate::shell::{cross, dot, norm};
use crate::spline::{Patch, Spans, mid_surface_point};
use crate::units::place;

/// Finds the points at which two shells are glued, where their perfect surfaces lie together; the layer keeps the gap that the shells
/// have.
///
/// # Errors
/// Where their faces do not lie together anywhere, or the shells cross each other.
pub(super) fn glued_points(
    bond: &Bond,
    members: &[Member],
    perfect: &[Member],
) -> Result<Vec<CoupledPoint<Glue>>, ModelError> {
    let sides = bond.shells.map(|shell| {
        let Member { scene, patch, points, .. } = &members[shell];
        Side { patch, perfect: Cow::Borrowed(perfect[shell].patch), first: points.start, material: &scene.material }
    });
    let searched = bond.shells.map(|shell| perfect[shell].patch);
    let layer = Layer::new(bond, sides);
    let (mut points, mut nearest) = (Vec::new(), (f64::INFINITY, [0.0; 3]));
    let mut guess = None;
    for (at, weight) in points_of(searched[0], searched[1]) {
        let here = mid_surface_point(searched[0], &[], at);
        let found = layer.other.nearest(here.position, guess);
        guess = Some(found);
        let Some(faces) = layer.faces([at, found]) else { continue };
        if faces.gap < nearest.0 {
            nearest = (faces.gap, here.position);
        }
        if faces.gap < -layer.tolerance {
            return Err(ModelError::ShellsCross { bond: bond.name.clone(), by: -faces.gap, at: place(here.position) });
        }
        if faces.gap > layer.tolerance {
            continue;
        }
        let area = weight * norm(cross(here.derivatives[0], here.derivatives[1]));
        points.push(layer.glued(&faces, area));
    }
    match points.is_empty() {
        true => Err(ModelError::NothingGlued {
            bond: bond.name.clone(),
            gap: nearest.0.is_finite().then_some(nearest.0),
            at: place(nearest.1),
            most: layer.tolerance,
        }),
        false => Ok(points),
    }
}

/// Quadrature points of a patch with their weights in the parameters: as many as the degree in each direction of each element, and more
/// where elements of the other patch are shorter.
fn points_of(patch: &Patch, other: &Patch) -> Vec<([f64; 2], f64)> {
    let finest = |patch: &Patch, direction: usize| {
        let spans = Spans::of(&patch.knots[direction], patch.degree[direction]).bounds;
        let length = |[from, to]: &[f64; 2]| (to - from) * norm(tangent_at(patch, direction, 0.5 * (from + to)));
        spans.iter().map(length).fold(f64::INFINITY, f64::min)
    };
    let [along, across] = [0, 1].map(|direction| {
        // Elements of the other patch in the direction that runs alike.
        let own = tangent_at(patch, direction, 0.5);
        let alike = |other_direction: usize| {
            let tangent = tangent_at(other, other_direction, 0.5);
            dot(own, tangent).abs() / norm(tangent)
        };
        let shortest = finest(other, if alike(0) >= alike(1) { 0 } else { 1 });
        let parts = (finest(patch, direction) / shortest - 1e-9).ceil().clamp(1.0, 4.0) as usize;
        let spans = Spans::of(&patch.knots[direction], patch.degree[direction]).bounds;
        let pieces = move |[from, to]: [f64; 2]| {
            (0..parts).map(move |k| [k, k + 1].map(|k| from + (to - from) * k as f64 / parts as f64))
        };
        let count = patch.degree[direction];
        spans
            .into_iter()
            .map(|span| pieces(span).flat_map(|piece| gauss_points(piece, count)).collect::<Vec<_>>())
            .collect::<Vec<_>>()
    });
    // Element by element, so that points of one element follow each other.
    let mut points = Vec::new();
    for one in &along {
        for two in &across {
            for [u, du] in one {
                points.extend(two.iter().map(|[v, dv]| ([*u, *v], du * dv)));
            }
        }
    }
    points
}

/// The tangent of a patch in a direction, in the middle of the other one.
fn tangent_at(patch: &Patch, direction: usize, at: f64) -> [f64; 3] {
    mid_surface_point(patch, &[], if direction == 0 { [at, 0.5] } else { [0.5, at] }).derivatives[direction]
}
