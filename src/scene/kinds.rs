//! Kinds of geometry, material and load whose keys the table of keys does not hold, and arrays of tables.

use super::data::Seam;

/// Kinds of geometry that are read here.
pub(super) const GEOMETRIES: [&str; 5] = ["plate", "cylinder-panel", "annulus", "sphere-zone", "nurbs"];
/// Kinds of material that are read here.
pub(super) const MATERIALS: [&str; 2] = ["orthotropic", "laminate"];
/// Kinds of load that are read here.
pub(super) const LOADS: [&str; 1] = ["steps"];
/// Keys that tables of these kinds have and those of the first kind, which the table of keys knows, have not.
const KEYS_OF_KINDS: [(&str, &str, &[&str]); 8] = [
    ("geometry", "plate", &["width_mm"]),
    ("geometry", "cylinder-panel", &["seam", "from_deg"]),
    ("geometry", "annulus", &["inner_radius_mm", "outer_radius_mm", "seam", "from_deg"]),
    ("geometry", "sphere-zone", &["latitude_deg", "seam", "from_deg"]),
    ("geometry", "nurbs", &["degrees", "knots_u", "knots_v", "control_points_mm", "weights", "file", "seam"]),
    (
        "material",
        "orthotropic",
        &[
            "youngs_modulus_1_mpa",
            "youngs_modulus_2_mpa",
            "poissons_ratio_12",
            "shear_modulus_12_mpa",
            "thermal_expansion_1_per_k",
            "thermal_expansion_2_per_k",
            "angle_deg",
        ],
    ),
    (
        "material",
        "laminate",
        &[
            "youngs_modulus_1_mpa",
            "youngs_modulus_2_mpa",
            "poissons_ratio_12",
            "shear_modulus_12_mpa",
            "thermal_expansion_1_per_k",
            "thermal_expansion_2_per_k",
        ],
    ),
    ("load", "steps", &["increment", "longest_increment", "factor", "least_increment", "snap_tolerance"]),
];

/// The kinds of a table that have a key which those of its first kind have not.
pub(super) fn kinds_with(section: &str, key: &str) -> Vec<&'static str> {
    let with = KEYS_OF_KINDS.iter().filter(|(of, _, keys)| *of == section && keys.contains(&key));
    with.map(|(_, kind, _)| *kind).collect()
}

/// Words of `seam`.
pub(super) const SEAMS: [(&str, Seam); 2] = [("smooth", Seam::Smooth), ("free", Seam::Free)];
/// Arrays of tables.
pub(super) const ARRAYS: [&str; 4] = ["ply", "support", "action", "probe"];
