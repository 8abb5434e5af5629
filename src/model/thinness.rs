//! Whether a shell is thin, and drawn where its theory takes it to be: its thickness and its offset against the smallest radius of
//! curvature and the shorter side of the surface.

use crate::model::ModelError;
use crate::model::place::sample_parameters;
use crate::scene::{Material, Scene};
use crate::shell::{PointReference, gauss_legendre, norm};
use crate::spline::{Mesh, Spans, mid_surface_point};
use crate::units::place;

/// Share of a radius or a side from which on a thickness is said: plates so thick bend by shear too, by about (t/L)² more.
pub const THICK: f64 = 0.2;
/// Offset over radius beyond which results are no longer of use.
const MOST_OFFSET: f64 = 0.02;
/// Error of a tube under pressure by offset over radius, c/R: to first order, the theory has the stretch u/R (1 − c/R) in the middle
/// of the thickness for u/R (1 + c/R), squared in the energy, and an area of R for R − c.
pub const ERROR_OF_OFFSET: f64 = 3.0;
/// Gauss points a span for the length of a line.
const LENGTH_POINTS: usize = 4;

/// The lengths of a surface that its thickness is held against.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    /// Smallest radius of curvature at sample points, mm; infinite for a plane.
    pub radius_mm: f64,
    /// Where it is.
    pub at: [f64; 3],
    /// Length of the shorter of the two lines through the middle, mm.
    pub side_mm: f64,
}

impl Extent {
    /// Of the surface of a mesh, which has a normal everywhere.
    pub fn of(mesh: &Mesh, material: &Material) -> Self {
        let [us, vs] = [0, 1].map(|way| sample_parameters(mesh, way));
        let curvature = |at: [f64; 2]| {
            let point = mid_surface_point(mesh, &[], at);
            (PointReference::new(point.derivatives, material, 1.0).largest_curvature(), point.position)
        };
        let all = us.iter().flat_map(|u| vs.iter().map(|v| curvature([*u, *v])));
        let (largest, at) = all.fold((0.0, [0.0; 3]), |worst, one| if one.0 > worst.0 { one } else { worst });
        Self { radius_mm: 1.0 / largest, at, side_mm: side_mm(mesh, 0).min(side_mm(mesh, 1)) }
    }
}

/// Length of the line through the middle that runs in a direction, mm.
fn side_mm(mesh: &Mesh, way: usize) -> f64 {
    let rule = gauss_legendre(LENGTH_POINTS);
    let speed =
        |at: f64| norm(mid_surface_point(mesh, &[], if way == 0 { [at, 0.5] } else { [0.5, at] }).derivatives[way]);
    let span = |[from, to]: [f64; 2]| -> f64 {
        let half = 0.5 * (to - from);
        rule.iter().map(|[node, weight]| half * weight * speed(from + half * (1.0 + node))).sum()
    };
    Spans::of(&mesh.knots[way], mesh.degree[way]).bounds.into_iter().map(span).sum()
}

/// Refuses a body that is no shell, and a surface drawn too far from its middle.
///
/// # Errors
/// Where the thickness reaches the smallest radius of curvature or the shorter side, or the offset is more of a radius than the
/// theory bears.
pub fn check_thinness(scene: &Scene, mesh: &Mesh) -> Result<(), ModelError> {
    let Extent { radius_mm, at, side_mm } = Extent::of(mesh, &scene.material);
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
