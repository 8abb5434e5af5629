//! Check of forces by the projected area: where two layers lie one above the other, the area alone does not say which
//! carries them.

use crate::model::ModelError;
use crate::model::limits::ANGLE;
use crate::model::parametrize::sample_parameters;
use crate::model::symmetry_plane::unit;
use crate::scene::{ActionKind, ForceVector, LoadedArea, Scene};
use crate::shell::{dot, norm, unit_normal};
use crate::spline::{Patch, mid_surface_point};
use crate::units::place;

/// Refuses forces by the projected area that meet both sides of the surface.
///
/// # Errors
/// Where a force does, by more than rounding.
pub(super) fn check_overhangs(scene: &Scene, patch: &Patch) -> Result<(), ModelError> {
    for action in &scene.actions {
        let ActionKind::AreaForce { force_n_per_mm2: ForceVector::Components(force), per: LoadedArea::Projected } =
            action.kind
        else {
            continue;
        };
        if norm(force) == 0.0 {
            continue;
        }
        let [us, vs] = [0, 1].map(|direction| sample_parameters(patch, direction));
        let points = us.iter().flat_map(|u| vs.iter().map(|v| mid_surface_point(patch, &[], [*u, *v])));
        let facing = points.map(|point| {
            let normal = unit_normal([point.derivatives[0], point.derivatives[1]]);
            (dot(normal, unit(force)), point.position)
        });
        let [mut least, mut most] = [(0.0, [0.0; 3]); 2];
        for one in facing {
            least = if one.0 < least.0 { one } else { least };
            most = if one.0 > most.0 { one } else { most };
        }
        if least.0 < -ANGLE && most.0 > ANGLE {
            let [one, other] = [least.1, most.1].map(place);
            return Err(ModelError::Overhang { action: action.name.clone(), one, other });
        }
    }
    Ok(())
}
