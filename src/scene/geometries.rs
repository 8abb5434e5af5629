//! `[geometry]`.

use std::path::Path;

use super::data::{Geometry, Seam};
use super::fault::Checked;
use super::nurbs::nurbs;
use super::profiles;
use super::table::Table;

/// The kind of geometry whose ends turn.
pub(super) const TAPE_SPRING: &str = "tape-spring";

/// A gap of a full turn that is smaller is rounding of coordinates: 1e-4 rad.
const NEAR_FULL_TURN_DEG: f64 = 0.006;

/// The geometry of a scene in this folder.
pub(super) fn geometry(table: &Table, folder: &Path) -> Checked<Geometry> {
    let geometry = match table.kind() {
        "nurbs" => Geometry::Nurbs(nurbs(table, folder)?),
        _ => table.data(),
    };
    match &geometry {
        Geometry::CylinderPanel { arc_deg, seam, .. } => check_seam(table, *arc_deg, *seam)?,
        Geometry::Annulus { inner_radius_mm, outer_radius_mm, arc_deg, seam, .. } => {
            if inner_radius_mm >= outer_radius_mm {
                let problem =
                    format!("the inner radius, {inner_radius_mm} mm, is not below the outer, {outer_radius_mm} mm");
                return Err(table.wrong_at("inner_radius_mm", problem, "exchange them"));
            }
            check_seam(table, *arc_deg, *seam)?;
        }
        Geometry::SphereZone { latitude_deg: [from, to], arc_deg, seam, .. } => {
            if from >= to {
                let problem = format!("latitudes from {from} to {to} degrees are no zone");
                return Err(table.wrong_at("latitude_deg", problem, "they must grow"));
            }
            check_seam(table, *arc_deg, *seam)?;
        }
        Geometry::Profile { profile, start_mm, direction_deg, .. } => {
            profiles::check(table, profile, *start_mm, *direction_deg)?;
        }
        Geometry::TapeSpring { .. } | Geometry::Plate { .. } | Geometry::Nurbs(_) => {}
    }
    Ok(geometry)
}

fn check_seam(table: &Table, arc_deg: f64, given: Option<Seam>) -> Checked<()> {
    let short_deg = 360.0 - arc_deg;
    if short_deg > 0.0 && short_deg < NEAR_FULL_TURN_DEG {
        return Err(table.wrong_at(
            "arc_deg",
            format!("an arc of {arc_deg} degrees is {short_deg:.1e} degrees short of a full turn"),
            "write `arc_deg = 360.0` and a `seam`, or leave a gap that can be seen (0.006 degrees)",
        ));
    }
    match (given, arc_deg == 360.0) {
        (None, true) => Err(table.wrong(
            None,
            "`seam` is missing, and a full turn meets itself",
            "write `seam = \"smooth\"` for a closed shell, or `seam = \"free\"` for one that is slit",
        )),
        (Some(_), false) => Err(table.wrong_at(
            "seam",
            format!("an arc of {arc_deg} degrees does not meet itself: it has no seam"),
            "leave `seam` out, or write `arc_deg = 360.0`",
        )),
        _ => Ok(()),
    }
}
