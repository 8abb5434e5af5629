//! Planes of symmetry, each with the edge or the line inside that lies in it.

use crate::model::ModelError;
use crate::model::edge::{rows_of, side};
use crate::model::limits::{ANGLE, SAME_PARAMETER};
use crate::model::parametrize::parameters_of;
use crate::model::symmetric_line::Line;
use crate::model::symmetry_plane::{NoPlane, square_to, symmetry_plane};
use crate::scene::{Edge, Hold, Region, Scene, Support};
use crate::shell::{dot, norm, sub};
use crate::spline::{Patch, Spans, SurfacePoint, mid_surface_point};

/// An edge, or a line inside, in a plane of symmetry.
#[derive(Clone, Debug)]
pub struct Mirror {
    /// Name of the support.
    pub support: String,
    /// Edge in the plane; `None` for a line inside.
    pub edge: Option<Edge>,
    /// Direction (0 or 1) whose parameter is constant on the edge or line.
    pub direction: usize,
    /// Value of that parameter.
    pub parameter: f64,
    /// Unit normal of the plane.
    pub normal: [f64; 3],
}

impl Mirror {
    /// Finds the planes of symmetry among some supports. Those that meet at right angles within the tolerance do so to
    /// rounding, and so do those along an axis: constraints that differ by less than the coordinates' rounding must not
    /// both hold.
    ///
    /// # Errors
    /// Where an edge does not lie in a plane that the surface crosses at right angles.
    pub fn all(scene: &Scene, supports: &[Support], patch: &Patch) -> Result<Vec<Self>, ModelError> {
        let mut mirrors: Vec<Self> = Vec::new();
        for support in supports.iter().filter(|support| support.hold == Hold::Symmetric) {
            let (edge, direction, parameter) = match support.on {
                Region::Edge(edge) => {
                    let (direction, at_end) = side(edge);
                    (Some(edge), direction, if at_end { 1.0 } else { 0.0 })
                }
                Region::Line(direction, fraction) => {
                    let direction = direction.index();
                    (None, direction, parameters_of(&scene.geometry, [fraction; 2])[direction])
                }
                Region::Point(_) | Region::Whole => {
                    return Err(ModelError::NotAnEdge { support: support.name.clone() });
                }
            };
            let plane = plane_of(patch, edge, direction, parameter).map_err(|reason| {
                ModelError::NotASymmetryPlane { support: support.name.clone(), reason: reason.to_string() }
            })?;
            let normal = mirrors.iter().fold(plane, |normal, other| square_to(normal, other.normal));
            mirrors.push(Self { support: support.name.clone(), edge, direction, parameter, normal });
        }
        Ok(mirrors)
    }

    /// Evaluates the point of the surface at a parameter along the edge or line.
    pub(super) fn point(&self, patch: &Patch, parameter: f64) -> SurfacePoint {
        let at = if self.direction == 0 { [self.parameter, parameter] } else { [parameter, self.parameter] };
        mid_surface_point(patch, &[], at)
    }

    /// Samples the edge or line at the ends and in the middle of each span.
    pub(super) fn samples(&self, patch: &Patch) -> Vec<SurfacePoint> {
        let running = 1 - self.direction;
        let spans = Spans::of(&patch.knots[running], patch.degree[running]).bounds;
        let parameters = spans.into_iter().flat_map(|[from, to]| [from, 0.5 * (from + to), to]);
        parameters.map(|parameter| self.point(patch, parameter)).collect()
    }

    /// Component of a vector across the plane, where that is more than rounding.
    pub(crate) fn share_across(&self, vector: [f64; 3]) -> Option<f64> {
        let share = dot(vector, self.normal);
        (share.abs() > 2.0 * ANGLE * norm(vector)).then_some(share)
    }

    /// Whether a parameter in the constant direction is that of the edge or line.
    pub(super) fn is_at(&self, parameter: f64) -> bool {
        (parameter - self.parameter).abs() <= SAME_PARAMETER
    }
}

/// Finds the unit normal of the plane of symmetry that an edge, or a line inside, can lie in.
fn plane_of(patch: &Patch, edge: Option<Edge>, direction: usize, parameter: f64) -> Result<[f64; 3], NoPlane> {
    let Some(edge) = edge else {
        let line = Line::new(patch, direction, parameter)?;
        return symmetry_plane(&line.points(patch), &line.steps(patch));
    };
    let [points, beside] = rows_of(patch, edge).map(|row| {
        let point = |control: usize| patch.point(control);
        row.into_iter().map(point).collect::<Vec<_>>()
    });
    let steps: Vec<[f64; 3]> = beside.iter().zip(&points).map(|(beside, point)| sub(*beside, *point)).collect();
    symmetry_plane(&points, &steps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::starting_patch;
    use crate::scene::parse;

    #[test]
    fn edges_of_a_tape_spring_lie_in_planes_of_symmetry() {
        let scene = parse(include_str!("../../pipelines/baseline.toml"), "baseline.toml").unwrap();
        let patch = starting_patch(&scene).unwrap();
        assert_eq!(plane_of(&patch, Some(Edge::UEnd), 0, 1.0).map(|normal| normal.map(f64::abs)), Ok([1.0, 0.0, 0.0]));
        // The free edge of a cylinder lies in its own radial plane.
        assert!(plane_of(&patch, Some(Edge::VStart), 1, 0.0).is_ok());
    }
}
