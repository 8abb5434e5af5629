//! `[geometry]` of another kind than a tape spring.

use super::data::{Geometry, Seam};
use super::fault::Checked;
use super::kinds::{GEOMETRIES, SEAMS};
use super::nurbs::nurbs;
use super::table::{LENGTH, Range, Table};

const ARC: Range = Range { above: 0.0, most: 360.0, reason: "an arc is more than 0 and at most 360 degrees" };
const FROM: Range = Range { above: -360.0, most: 360.0, reason: "an arc starts between -360 and 360 degrees" };
/// A gap of a full turn that is smaller is rounding of coordinates: 1e-4 rad.
const NEAR_FULL_TURN_DEG: f64 = 0.006;

/// A geometry of one of [`GEOMETRIES`].
pub(super) fn geometry(table: Table<'_, '_>, folder: &std::path::Path) -> Checked<Geometry> {
    let kinds = GEOMETRIES.map(|kind| (kind, kind));
    let kind = table.word("kind", &kinds)?;
    let geometry = match kind {
        "plate" => Geometry::Plate {
            length_mm: table.number("length_mm", LENGTH, "100.0")?,
            width_mm: table.number("width_mm", LENGTH, "50.0")?,
        },
        "cylinder-panel" => {
            let arc_deg = table.number("arc_deg", ARC, "90.0")?;
            Geometry::CylinderPanel {
                length_mm: table.number("length_mm", LENGTH, "100.0")?,
                radius_mm: table.number("radius_mm", LENGTH, "50.0")?,
                arc_deg,
                from_deg: table.maybe_number("from_deg", FROM)?,
                seam: seam(&table, arc_deg)?,
            }
        }
        "annulus" => {
            let arc_deg = table.number("arc_deg", ARC, "360.0")?;
            let inner_radius_mm = table.number("inner_radius_mm", LENGTH, "6.0")?;
            let outer_radius_mm = table.number("outer_radius_mm", LENGTH, "10.0")?;
            if inner_radius_mm >= outer_radius_mm {
                let problem =
                    format!("the inner radius, {inner_radius_mm} mm, is not below the outer, {outer_radius_mm} mm");
                return Err(table.wrong(table.place_of("inner_radius_mm").as_ref(), problem, "exchange them"));
            }
            let from_deg = table.maybe_number("from_deg", FROM)?;
            Geometry::Annulus { inner_radius_mm, outer_radius_mm, arc_deg, from_deg, seam: seam(&table, arc_deg)? }
        }
        "sphere-zone" => {
            let arc_deg = table.number("arc_deg", ARC, "90.0")?;
            let latitude_deg: [f64; 2] = table.tuple("latitude_deg", "[0.0, 72.0]")?;
            let [from, to] = latitude_deg;
            if !(-90.0 < from && from < to && to < 90.0) {
                let problem = format!("latitudes from {from} to {to} degrees are no zone");
                let remedy = "they must grow, and lie between the poles: at a pole (90 degrees) an edge would collapse to a point; leave a small hole";
                return Err(table.wrong(table.place_of("latitude_deg").as_ref(), problem, remedy));
            }
            let radius_mm = table.number("radius_mm", LENGTH, "10.0")?;
            let from_deg = table.maybe_number("from_deg", FROM)?;
            Geometry::SphereZone { radius_mm, latitude_deg, arc_deg, from_deg, seam: seam(&table, arc_deg)? }
        }
        _ => Geometry::Nurbs(nurbs(&table, folder)?),
    };
    table.finish()?;
    Ok(geometry)
}

fn seam(table: &Table<'_, '_>, arc_deg: f64) -> Checked<Option<Seam>> {
    let given = table.maybe_word("seam", &SEAMS)?;
    let short_deg = 360.0 - arc_deg;
    if short_deg > 0.0 && short_deg < NEAR_FULL_TURN_DEG {
        return Err(table.wrong(
            table.place_of("arc_deg").as_ref(),
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
        (Some(_), false) => Err(table.wrong(
            table.place_of("seam").as_ref(),
            format!("an arc of {arc_deg} degrees does not meet itself: it has no seam"),
            "leave `seam` out, or write `arc_deg = 360.0`",
        )),
        (given, _) => Ok(given),
    }
}
