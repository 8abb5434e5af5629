//! Checks that a shell is thin and near the surface that it is drawn on: its thickness and its offset, compared with
//! the smallest radius of curvature and the shorter side of the surface.

use crate::model::ModelError;
use crate::model::gauss::span_points;
use crate::scene::{Material, Scene};
use crate::shell::{PointReference, cross, norm};
use crate::spline::{Patch, SurfacePoint, mid_surface_point};
use crate::units::place;

/// Share of a radius or a side from which on the thickness causes a remark: plates so thick bend by shear too, by about
/// (t/L)² more.
pub const THICK: f64 = 0.2;
/// Offset over radius beyond which results are no longer of use.
const MOST_OFFSET: f64 = 0.02;
/// Error of a tube under pressure over offset by radius, c/R: to first order, the theory has the stretch u/R (1 − c/R)
/// in the middle of the thickness for u/R (1 + c/R), squared in the energy, and an area of R for R − c.
pub const ERROR_OF_OFFSET: f64 = 3.0;
/// Number of Gauss points of a span for curvature, area and length.
const POINTS: usize = 2;
/// Share of the area whose radii are disregarded: the tip of a cone, a small hole at a pole.
const TIPS: f64 = 0.01;

/// The lengths of a surface that its thickness is compared with.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    /// Smallest radius of curvature except at tips, mm; infinite for a plane.
    pub radius_mm: f64,
    /// Point with that radius, mm.
    pub at: [f64; 3],
    /// Length of the shorter of the two lines through the middle, mm.
    pub side_mm: f64,
}

/// A point of the surface.
struct Sample {
    curvature: f64,
    position: [f64; 3],
    area: f64,
}

impl Extent {
    /// Measures the surface of a mesh, which has a normal everywhere.
    pub fn of(patch: &Patch, material: &Material) -> Self {
        let [us, vs] = [0, 1].map(|direction| span_points(patch, direction, POINTS));
        let sample = |[u, along]: [f64; 2], [v, across]: [f64; 2]| {
            let SurfacePoint { position, derivatives } = mid_surface_point(patch, &[], [u, v]);
            let curvature = PointReference::new(derivatives, material, 1.0).largest_curvature();
            Sample { curvature, position, area: along * across * norm(cross(derivatives[0], derivatives[1])) }
        };
        let mut samples: Vec<Sample> = us.iter().flat_map(|u| vs.iter().map(move |v| sample(*u, *v))).collect();
        samples.sort_by(|one, other| other.curvature.total_cmp(&one.curvature));
        let mut left = TIPS * samples.iter().map(|sample| sample.area).sum::<f64>();
        let sharpest = samples.iter().find(|sample| {
            left -= sample.area;
            left < 0.0
        });
        let (curvature, at) = sharpest.map_or((0.0, [0.0; 3]), |sample| (sample.curvature, sample.position));
        Self { radius_mm: 1.0 / curvature, at, side_mm: side_mm(patch, 0).min(side_mm(patch, 1)) }
    }
}

/// Computes the length of the line through the middle that runs in a direction, mm.
pub(super) fn side_mm(patch: &Patch, direction: usize) -> f64 {
    let point = |at: f64| mid_surface_point(patch, &[], if direction == 0 { [at, 0.5] } else { [0.5, at] });
    span_points(patch, direction, POINTS)
        .into_iter()
        .map(|[at, weight]| weight * norm(point(at).derivatives[direction]))
        .sum()
}

/// Refuses a body too thick for a shell, and a surface drawn too far from its middle.
///
/// # Errors
/// Where the thickness reaches the smallest radius of curvature or the shorter side, or the offset is a larger share of
/// a radius than the theory allows.
pub fn check_thinness(scene: &Scene, patch: &Patch) -> Result<(), ModelError> {
    let Extent { radius_mm, at, side_mm } = Extent::of(patch, &scene.material);
    let (thickness_mm, offset_mm) = (scene.material.thickness_mm(), scene.material.offset_mm());
    if thickness_mm >= radius_mm {
        return Err(ModelError::ThickerThanRadius { thickness_mm, radius_mm, at: place(at) });
    }
    if thickness_mm >= side_mm {
        return Err(ModelError::ThickerThanSide { thickness_mm, side_mm });
    }
    if offset_mm.abs() > MOST_OFFSET * radius_mm {
        let error = ERROR_OF_OFFSET * offset_mm.abs() / radius_mm;
        return Err(ModelError::OffsetTooLarge {
            offset_mm,
            radius_mm,
            at: place(at),
            error,
            most_mm: MOST_OFFSET * radius_mm,
        });
    }
    Ok(())
}
