//! Lengths, radii, arcs and thickness that look odd.

use std::f64::consts::TAU;

use super::key::key;
use crate::model::size::Size;
use crate::scene::{Geometry, Scene};
use crate::units::{rounded, significant};

/// Largest extents of a shell, mm.
const LARGEST_MM: [f64; 2] = [1.0, 1e5];
/// Radius over thickness.
const RADIUS_OVER_THICKNESS: [f64; 2] = [10.0, 1e4];
/// Shorter side over thickness of a plane shell: a film of 1 µm on 100 mm.
const SIDE_OVER_THICKNESS: f64 = 1e5;
/// The thinnest films that structures are made of are about this thick, mm; a plate of 1 mm in m.
const THINNEST_MM: f64 = 1e-3;
/// Least arc, degrees.
const LEAST_ARC_DEG: f64 = 5.0;

pub(super) fn odd(scene: &Scene, size: &Size) -> Vec<String> {
    let mut found = Vec::new();
    let [least, most] = LARGEST_MM;
    let largest = size.largest_mm();
    let shown = |value: f64| significant(value, 4);
    if largest < least {
        found.push(format!(
            "the shell is {} mm at its longest: lengths are in mm, and these may be in m",
            shown(largest)
        ));
    }
    if largest > most {
        found.push(format!(
            "the shell is {} mm at its longest: lengths are in mm, and these may be in µm",
            shown(largest)
        ));
    }
    if size.thickness_mm <= THINNEST_MM {
        found.push(format!("the shell is {} mm thick, which few films are: is that in m?", shown(size.thickness_mm)));
    }
    found.extend(thinness(size));
    found.extend(arcs(&scene.geometry));
    if let Geometry::TapeSpring { length_mm, radius_mm, arc_deg } = scene.geometry {
        let arc_mm = radius_mm * arc_deg.to_radians();
        if length_mm < arc_mm {
            found.push(format!(
                "{} is shorter than the arc, {} mm: are {} and the length exchanged?",
                key("geometry.length_mm", length_mm),
                shown(arc_mm),
                key("geometry.radius_mm", radius_mm)
            ));
        }
    }
    found
}

/// Thickness against the smallest radius, or against the shorter side of a plane.
fn thinness(size: &Size) -> Option<String> {
    let shown = |value: f64| significant(value, 3);
    let thickness = shown(size.thickness_mm);
    let Some(ratio) = size.radius_over_thickness() else {
        let side = size.sides_mm[0].min(size.sides_mm[1]);
        let ratio = side / size.thickness_mm;
        return (ratio > SIDE_OVER_THICKNESS).then(|| {
            format!(
                "the shorter side, {} mm, is {} times the thickness, {thickness} mm: are both in mm?",
                shown(side),
                shown(ratio)
            )
        });
    };
    let [least, most] = RADIUS_OVER_THICKNESS;
    let hint = match ratio {
        ratio if ratio < least => "a shell is thinner than a tenth of its radius",
        ratio if ratio > most => "a film so thin wrinkles rather than folds",
        _ => return None,
    };
    let radius = shown(size.radius_mm.unwrap_or(f64::INFINITY));
    Some(format!(
        "the smallest radius, {radius} mm, is {} times the thickness, {thickness} mm: {hint}; are both in mm?",
        shown(ratio)
    ))
}

/// Arcs that may be in radians: very small ones, and 2π.
fn arcs(geometry: &Geometry) -> Option<String> {
    let arcs = match geometry {
        Geometry::TapeSpring { arc_deg, .. }
        | Geometry::CylinderPanel { arc_deg, .. }
        | Geometry::Annulus { arc_deg, .. } => vec![("arc", *arc_deg)],
        Geometry::SphereZone { latitude_deg: [from, to], arc_deg, .. } => {
            vec![("arc", *arc_deg), ("range of latitudes", to - from)]
        }
        // A profile may have short arcs; where its widest is one, all are.
        Geometry::Profile { profile, .. } => {
            let widest = profile.iter().map(|piece| piece.turn_deg().abs()).fold(0.0, f64::max);
            if widest > 0.0 { vec![("widest arc", widest)] } else { vec![] }
        }
        Geometry::Plate { .. } | Geometry::Nurbs(_) => vec![],
    };
    let is_odd = |arc_deg: f64| arc_deg < LEAST_ARC_DEG || (arc_deg - TAU).abs() < 0.01;
    let (name, arc_deg) = arcs.into_iter().find(|(_, arc_deg)| is_odd(*arc_deg))?;
    let [given, meant] = [arc_deg, arc_deg.to_degrees()].map(rounded);
    Some(format!("the {name} is {given}°, and angles are in degrees: if radians were meant, that is {meant}°"))
}
