//! A support that holds rigid motions and nothing else.
//!
//! Where the other supports leave the rigid motions r_1 … r_n free, the displacement u is held orthogonal to each of them
//! over some points x_k of the surface: Σ_k r_m(x_k) · u(x_k) = 0; with all six free, the shell neither moves nor turns on
//! the mean. The free motions meet all other constraints and do no work in the shell, so that the reactions λ under loads f
//! follow from Σ_m λ_m Σ_k r_m(x_k) · r_l(x_k) = −f · r_l. The matrix is their Gram matrix, regular where the points do not lie on one
//! line: loads that do no work on rigid motions leave no reaction, and the shell deforms as if it were free.
//!
//! The points lie at fixed fractions of the surface, so that a refined mesh holds the same motions.

use crate::model::ModelError;
use crate::model::body::{Body, HeldMotions};
use crate::model::elimination::Expression;
use crate::model::expressions::{control_expressions, shifted};
use crate::model::member::Member;
use crate::model::parametrize::parameters_of;
use crate::model::rigid_motion::free_motions;
use crate::model::supports::Supports;
use crate::scene::Region;
use crate::shell::{cross, dot, norm, sub};
use crate::spline::mid_surface_point;

/// Fractions in u and v at which the points lie. Three remain on a closed turn, evenly spaced and never on one line; so
/// few that they couple few control points.
const FRACTIONS: [f64; 4] = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0];
/// Share of the largest distance below which two points are one, as where a full turn meets itself.
const SAME: f64 = 1e-6;
/// A point whose displacement is held on average.
struct Point {
    position: [f64; 3],
    /// Displacement of the point as a weighted sum over control points.
    sum: Vec<(usize, f64)>,
}

impl Supports {
    /// Holds the rigid motions that the other supports leave free.
    pub(super) fn hold_rigid_motions(
        &mut self,
        index: usize,
        members: &[Member],
        points: &[[f64; 3]],
    ) -> Result<(), ModelError> {
        let spread = self.spread_points(members)?;
        let positions: Vec<[f64; 3]> = spread.iter().map(|point| point.position).collect();
        if on_one_line(&positions) {
            let support = self.footprints[index].name.clone();
            return Err(ModelError::TooFewPoints { support, count: spread.len() });
        }
        let body = Body::around(&positions);
        let free = free_motions(body, self, points);
        if free.basis.ncols() == 0 {
            return Err(ModelError::NoFreeMotion { support: self.footprints[index].name.clone() });
        }
        for motion in free.basis.column_iter() {
            let mut expression = Expression::new();
            for point in &spread {
                let fields = body.fields(point.position);
                let moved = [0, 1, 2].map(|c| (0..6).map(|k| motion[k] * fields[k][c]).sum::<f64>());
                for (control, factor) in &point.sum {
                    let of_axis = |c: usize| (3 * control + c, factor * moved[c]);
                    expression.extend((0..3).map(of_axis).filter(|(_, factor)| *factor != 0.0));
                }
            }
            self.push(Some(index), expression);
        }
        let footprint = &mut self.footprints[index];
        footprint.points = spread.iter().flat_map(|point| &point.sum).map(|(control, _)| *control).collect();
        footprint.pole = body.middle;
        self.held_motions = Some(HeldMotions { support: index, free });
        Ok(())
    }

    /// Finds the points that no moving section carries, each once.
    fn spread_points(&self, members: &[Member]) -> Result<Vec<Point>, ModelError> {
        let mut spread: Vec<Point> = Vec::new();
        for Member { scene, patch, points, .. } in members {
            for fractions in FRACTIONS.iter().flat_map(|u| FRACTIONS.map(|v| [*u, v])) {
                let position = mid_surface_point(patch, &[], parameters_of(&scene.geometry, fractions)).position;
                let sums = control_expressions(scene, patch, Region::Point(fractions))?;
                let sum = shifted(sums, points.start).swap_remove(0);
                if sum.iter().all(|(control, _)| self.section_of[*control].is_none()) {
                    spread.push(Point { position, sum });
                }
            }
        }
        let distance = |one: &Point, other: &Point| norm(sub(one.position, other.position));
        let largest = spread.iter().map(|point| distance(point, &spread[0])).fold(0.0, f64::max);
        let mut once: Vec<Point> = Vec::new();
        for point in spread {
            if once.iter().all(|other| distance(&point, other) > SAME * largest) {
                once.push(point);
            }
        }
        Ok(once)
    }
}

/// Whether some points span no triangle.
fn on_one_line(points: &[[f64; 3]]) -> bool {
    let Some(first) = points.first() else { return true };
    let arms = points.iter().map(|point| sub(*point, *first));
    let longest = arms.clone().fold([0.0; 3], |best, arm| if norm(arm) > norm(best) { arm } else { best });
    arms.map(|arm| norm(cross(arm, longest))).fold(0.0, f64::max) <= SAME * dot(longest, longest)
}
