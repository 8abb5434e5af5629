//! How far imperfect surfaces are from the perfect ones, and integrals over these.

use crate::model::gauss::span_points;
use crate::scene::Scene;
use crate::shell::{cross, norm, sub};
use crate::spline::{Mesh, Patch, Spans, mid_surface_point, mid_surface_points};

/// Samples of each span for the largest offset.
const SAMPLES: usize = 4;
/// Gauss points of each span for integrals.
const POINTS: usize = 3;

/// The largest offset of surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offset {
    /// Its length, mm.
    pub mm: f64,
    /// Where it is on the perfect surface, mm.
    pub at: [f64; 3],
}

/// Finds the largest offset of surfaces whose control points move, at the ends of spans and between; and that nothing moves is an
/// offset of 0 at the first corner.
pub fn largest_offset(scene: &Scene, perfect: &Mesh, moves: &[[f64; 3]]) -> Offset {
    debug_assert_eq!(scene.shell_count(), perfect.patches.len());
    let nothing = Offset { mm: 0.0, at: perfect.point(0) };
    let all = perfect.patches.iter().zip(perfect.ranges()).map(|(patch, range)| largest_of_patch(patch, &moves[range]));
    all.fold(nothing, |largest, one| if one.mm > largest.mm { one } else { largest })
}

/// The same of one surface.
pub fn largest_of_patch(patch: &Patch, moves: &[[f64; 3]]) -> Offset {
    let mut largest = Offset { mm: 0.0, at: patch.point(0) };
    let [us, vs] = [0, 1].map(|k| Spans::of(&patch.knots[k], patch.degree[k]).samples(SAMPLES));
    for at in us.iter().flat_map(|u| vs.iter().map(move |v| [*u, *v])) {
        let [before, after] = mid_surface_points(patch, [&[], moves], at);
        let mm = norm(sub(after.position, before.position));
        if mm > largest.mm {
            largest = Offset { mm, at: before.position };
        }
    }
    largest
}

/// A point of an integral over the surfaces of a mesh.
#[derive(Clone, Debug)]
pub struct SurfaceSample {
    /// The patch.
    pub patch: usize,
    /// Its place on the patch.
    pub parameters: [f64; 2],
    /// Its place in space, mm.
    pub position: [f64; 3],
    /// Area that it stands for, mm².
    pub area: f64,
}

impl SurfaceSample {
    /// Lists the points of an integral over all surfaces.
    pub fn all(mesh: &Mesh) -> Vec<Self> {
        let of_patch = |(number, patch): (usize, &Patch)| {
            let [us, vs] = [0, 1].map(|direction| span_points(patch, direction, POINTS));
            let pairs = us.iter().flat_map(|u| vs.iter().map(move |v| (*u, *v))).collect::<Vec<_>>();
            let sample = |([u, along], [v, across]): ([f64; 2], [f64; 2])| {
                let point = mid_surface_point(patch, &[], [u, v]);
                let area = along * across * norm(cross(point.derivatives[0], point.derivatives[1]));
                Self { patch: number, parameters: [u, v], position: point.position, area }
            };
            pairs.into_iter().map(sample).collect::<Vec<_>>()
        };
        mesh.patches.iter().enumerate().flat_map(of_patch).collect()
    }

    /// The move of this point where control points move, mm.
    pub fn moved(&self, mesh: &Mesh, moves: &[[f64; 3]]) -> [f64; 3] {
        let patch = &mesh.patches[self.patch];
        sub(mid_surface_point(patch, &moves[mesh.range(self.patch)], self.parameters).position, self.position)
    }
}
