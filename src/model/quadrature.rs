//! The number of Gauss points of each element in each direction: for bending, and for stretching where that needs more.
//!
//! Reduced integration that knows where splines are smooth (Adam, Hughes, Bouabdallah, Zarroug & Maitournam 2015,
//! *Selective and reduced numerical integrations for NURBS-based isogeometric analysis*) takes p − 1 points where a
//! spline is C^(p−1) across both ends of an element, and p next to the ends of the patch and to knots of higher
//! multiplicity ([`smooth`]). The counts are empirical, held by eigenvalues (`tests/verification/quadrature.rs`): with p
//! points in each direction a single element has a field without energy in addition to the rigid motions, in every
//! degree, and degree 2 with one point inside is four times too soft on graded meshes.
//!
//! Bending is content with them where the surface is developable, as tape springs are. Doubly curved surfaces take p +
//! 1 points: a dome (R/t = 300, 16 × 16 cubic elements) is 0.17 % off with p − 1 and with p points, and 0.14 % with
//! more. (On graded meshes of 16 fewer are better, 1.5 % for 2.3 %: there is less to lock. But that is luck.)
//!
//! Membrane forces are not: see [`crate::model::imbalance`]. So [`Quadrature::Balanced`] takes the cheapest rule for
//! stretching, in each direction on its own, that leaves constant membrane forces in balance on the current mesh. Where
//! stretching and bending act on each other (layers that are not symmetric) both have its points.

use crate::model::imbalance::imbalance;
use crate::scene::{Quadrature, Scene};
use crate::shell::{ShellStiffness, cross, dot, norm, shell_stiffness};
use crate::spline::{Patch, Spans, mid_surface_point};

/// Largest imbalance that stretching may be left with: the error of a displacement, relative to that of the membrane
/// alone.
///
/// What it bounds was measured on tubes under pressure, R/t from 30 to 3000, degrees 2 to 5, 4 to 64 elements a quarter turn,
/// uniform and graded by 1 : 2 (`tests/verification/quadrature_balance.rs`).
const MOST_IMBALANCE: f64 = 5e-3;
/// Gaussian curvature, relative to the square of the largest normal curvature found, above which a surface is doubly
/// curved.
const CURVED_BOTH_WAYS: f64 = 1e-3;
/// Number of points in each direction at which the curvature is examined.
const SAMPLES: usize = 7;
/// Largest number of points beyond the degree that [`Quadrature::Balanced`] tries.
const MOST_MORE: usize = 3;

/// Gauss points of each element, `[direction][element]`.
pub(crate) type Counts = [Vec<usize>; 2];

/// Numbers of Gauss points of the elements of a mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PointCounts {
    /// Points for bending, and for stretching where `stretching` is `None`.
    pub bending: Counts,
    /// Points for stretching alone.
    pub stretching: Option<Counts>,
}

impl PointCounts {
    /// Chooses the points on the elements of `mesh` by the scene's rule.
    pub fn of(scene: &Scene, patch: &Patch) -> Self {
        let both = |count: &dyn Fn(usize) -> Vec<usize>| [count(0), count(1)];
        let common = |bending: Counts| Self { bending, stretching: None };
        match scene.mesh.quadrature {
            Quadrature::Full => common(both(&|direction| everywhere(patch, direction, patch.degree[direction] + 1))),
            Quadrature::FullPlusOne => {
                common(both(&|direction| everywhere(patch, direction, patch.degree[direction] + 2)))
            }
            Quadrature::FullPlusTwo => {
                common(both(&|direction| everywhere(patch, direction, patch.degree[direction] + 3)))
            }
            Quadrature::Reduced => common(both(&|direction| reduced(patch, direction))),
            Quadrature::Patch => common(both(&|direction| smooth(patch, direction))),
            Quadrature::Balanced => {
                let stiffness = shell_stiffness(&scene.material, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
                let ratio = stretching_over_bending(&stiffness);
                let is_developable = !is_curved_both_ways(patch);
                let full = |direction: usize| everywhere(patch, direction, patch.degree[direction] + 1);
                let bending =
                    both(&|direction| if is_developable { smooth(patch, direction) } else { full(direction) });
                let stretching = both(&|direction| balanced(patch, direction, &bending[direction], ratio));
                match stretching == bending {
                    true => common(bending),
                    false if stiffness.coupling.is_some() => common(stretching),
                    false => Self { bending, stretching: Some(stretching) },
                }
            }
        }
    }

    /// Larger of both counts.
    pub fn most(&self) -> &Counts {
        self.stretching.as_ref().unwrap_or(&self.bending)
    }
}

fn everywhere(patch: &Patch, direction: usize, count: usize) -> Vec<usize> {
    vec![count; patch.element_counts()[direction]]
}

/// Counts degree points; degree + 1 on a single element.
fn reduced(patch: &Patch, direction: usize) -> Vec<usize> {
    let single = usize::from(patch.element_counts()[direction] == 1);
    everywhere(patch, direction, patch.degree[direction] + single)
}

/// Counts degree − 1 points (at least 2) where the spline is smooth, degree next to the ends and to repeated knots;
/// degree + 1 on a single element.
fn smooth(patch: &Patch, direction: usize) -> Vec<usize> {
    let (degree, knots) = (patch.degree[direction], &patch.knots[direction]);
    let bounds = Spans::of(knots, degree).bounds;
    let is_smooth = |knot: f64| {
        let first = knots.partition_point(|other| *other < knot);
        knots.get(first + 1).is_some_and(|next| *next > knot)
    };
    let count = |[from, to]: &[f64; 2]| match bounds.len() {
        1 => degree + 1,
        _ if is_smooth(*from) && is_smooth(*to) => (degree - 1).max(2),
        _ => degree,
    };
    bounds.iter().map(count).collect()
}

/// Finds the cheapest of `least` and degree, degree + 1, … points that leaves constant membrane forces in balance.
fn balanced(patch: &Patch, direction: usize, least: &[usize], stretching_over_bending: f64) -> Vec<usize> {
    let degree = patch.degree[direction];
    let at_least = |count: usize| -> Vec<usize> { least.iter().map(|least| count.max(*least)).collect() };
    let candidates = std::iter::once(least.to_vec()).chain((0..MOST_MORE).map(|more| at_least(degree + more)));
    let mut candidates =
        candidates.filter(|counts| imbalance(patch, direction, counts, stretching_over_bending) <= MOST_IMBALANCE);
    candidates.next().unwrap_or_else(|| at_least(degree + MOST_MORE))
}

/// Whether the undeformed surface is doubly curved, so that it cannot be unrolled.
fn is_curved_both_ways(patch: &Patch) -> bool {
    let parameter = |direction: usize, k: usize| {
        let (knots, degree) = (&patch.knots[direction], patch.degree[direction]);
        let (from, to) = (knots[degree], knots[knots.len() - 1 - degree]);
        from + (to - from) * (k as f64 + 0.5) / SAMPLES as f64
    };
    let (mut gauss, mut normal) = (0.0_f64, 0.0_f64);
    for k in 0..SAMPLES * SAMPLES {
        let point = mid_surface_point(patch, &[], [parameter(0, k / SAMPLES), parameter(1, k % SAMPLES)]);
        let [a1, a2, a11, a22, a12] = point.derivatives;
        let cross = cross(a1, a2);
        let [b11, b22, b12] = [a11, a22, a12].map(|second| dot(second, cross) / norm(cross));
        gauss = gauss.max((b11 * b22 - b12 * b12).abs() / dot(cross, cross));
        normal = normal.max((b11 / dot(a1, a1)).abs()).max((b22 / dot(a2, a2)).abs()).max(b12.abs() / norm(cross));
    }
    gauss > CURVED_BOTH_WAYS * normal * normal
}

/// Ratio of the larger stiffness against stretching, along the surface's axes, to the smaller one against bending,
/// 1/mm²; 12/t² where the shell is isotropic.
fn stretching_over_bending(stiffness: &ShellStiffness) -> f64 {
    let ShellStiffness { membrane, bending, .. } = stiffness;
    membrane[0][0].max(membrane[1][1]) / bending[0][0].min(bending[1][1])
}
