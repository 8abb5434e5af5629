//! Keys of `[material]` and `[[ply]]`.

use super::geometry::SHELL_LENGTH;
use crate::scene::keys::Presence::{Default, Follows};
use crate::scene::keys::{Key, Kind, Limit, Limits, Presence, Reach, choice};

const fn material(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("material", name, kind, example)
}

const fn ply(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("ply", name, kind, example)
}

pub(super) static MATERIAL: &[Key] = &[
    material("kind", Kind::Word(&[
        choice("isotropic", "St. Venant-Kirchhoff, isotropic"),
        choice("orthotropic", "one orthotropic layer"),
        choice(
            "laminate",
            "layers through the thickness, each a [[ply]]; moduli, density and expansions in [material] hold for plies that \
             have none of their own",
        ),
    ]), "\"isotropic\"")
        .means("Constitutive law.")
        .also_called(&["type", "law", "model"]),
    material("youngs_modulus_mpa", Kind::Number(MODULUS), "131000.0")
        .of(&["isotropic"])
        .means("Young's modulus E.")
        .also_called(&["e", "young", "youngs", "elastic_modulus", "modulus", "young_modulus", "elasticity"]),
    material("poissons_ratio", Kind::Number(Limits {
        low: Limit::excluded(-1.0, "at -1 and below the shear modulus E/(2(1+nu)) is not finite and positive"),
        high: Limit::excluded(0.5, "at 1/2 and beyond the bulk modulus E/(3(1-2nu)) is not finite and positive"),
    }), "0.3")
        .of(&["isotropic"])
        .means("Poisson's ratio nu.")
        .also_called(&["nu", "ν", "poisson", "poissons", "poisson_ratio", "v"]),
    YOUNGS_MODULUS_1.in_table("material", &["orthotropic"], Presence::Required),
    YOUNGS_MODULUS_2.in_table("material", &["orthotropic"], Presence::Required),
    POISSONS_RATIO_12.in_table("material", &["orthotropic"], Presence::Required),
    SHEAR_MODULUS_12.in_table("material", &["orthotropic"], Presence::Required),
    YOUNGS_MODULUS_1.in_table("material", &["laminate"], OF_EACH_PLY),
    YOUNGS_MODULUS_2.in_table("material", &["laminate"], OF_EACH_PLY),
    POISSONS_RATIO_12.in_table("material", &["laminate"], OF_EACH_PLY),
    SHEAR_MODULUS_12.in_table("material", &["laminate"], OF_EACH_PLY),
    ANGLE.in_table("material", &["orthotropic"], Default("0.0")),
    material("thickness_mm", Kind::Number(Limits {
        low: Limit::excluded(0.0, "a shell without thickness has no stiffness"),
        high: SHELL_LENGTH.high,
    }), "0.1")
        .of(&["isotropic", "orthotropic"])
        .means("Shell thickness t; less than the radius.")
        .also_called(&["t", "h"]),
    material("density_kg_m3", Kind::Number(DENSITY), "7850.0")
        .means("Density rho, of all plies that have none of their own; only an [[action]] of kind \"gravity\" asks for it.")
        .or(Follows("none, and nothing weighs"))
        .also_called(&["rho", "ρ", "mass_density"]),
    material("offset_mm", Kind::Number(Limits {
        low: Limit::included(-SHELL_LENGTH.high.value, SHELL_LENGTH.high.reason),
        high: SHELL_LENGTH.high,
    }), "0.0")
        .means("Distance of the surface of the geometry from the middle of the thickness, along the normal: half the \
              thickness puts it on top, minus half of it at the bottom. At most the \
              thickness. Supports and actions act on that surface, weight too. On a curved shell results are off by about \
              3 offset/radius (the smallest radius of curvature), which is said from 0.1 % of the radius on, and more than \
              2 % of the radius is refused: draw the middle surface.")
        .or(Default("0.0"))
        .also_called(&["eccentricity"]),
    material("thermal_expansion_per_k", Kind::Number(Limits {
        low: Limit::excluded(-1e-3, "a strain per kelvin, such as 23.1e-6 for aluminium"),
        high: Limit::excluded(1e-3, "a strain per kelvin, such as 23.1e-6 for aluminium"),
    }), "23.1e-6")
        .of(&["isotropic"])
        .means("Strain of the free shell per kelvin.")
        .or(Follows("none; actions of kind \"temperature\" need it"))
        .also_called(&["cte", "expansion", "thermal_expansion", "expansion_per_k"]),
    THERMAL_EXPANSION_1.in_table("material", &["orthotropic", "laminate"], NO_EXPANSION),
    THERMAL_EXPANSION_2.in_table("material", &["orthotropic", "laminate"], NO_EXPANSION),
    TENSILE_STRENGTH_1.in_table("material", &["orthotropic", "laminate"], NO_STRENGTH),
    COMPRESSIVE_STRENGTH_1.in_table("material", &["orthotropic", "laminate"], NO_STRENGTH),
    TENSILE_STRENGTH_2.in_table("material", &["orthotropic", "laminate"], NO_STRENGTH),
    COMPRESSIVE_STRENGTH_2.in_table("material", &["orthotropic", "laminate"], NO_STRENGTH),
    SHEAR_STRENGTH_12.in_table("material", &["orthotropic", "laminate"], NO_STRENGTH),
];

pub(super) static PLY: &[Key] = &[
    ply(
        "thickness_mm",
        Kind::Number(Limits {
            low: Limit::excluded(0.0, "a ply without thickness has no stiffness"),
            high: SHELL_LENGTH.high,
        }),
        "0.05",
    )
    .means("Thickness of the ply.")
    .also_called(&["t", "h"]),
    ANGLE.in_table("ply", &[], Default("0.0")),
    YOUNGS_MODULUS_1.in_table("ply", &[], OF_MATERIAL),
    YOUNGS_MODULUS_2.in_table("ply", &[], OF_MATERIAL),
    POISSONS_RATIO_12.in_table("ply", &[], OF_MATERIAL),
    SHEAR_MODULUS_12.in_table("ply", &[], OF_MATERIAL),
    ply("density_kg_m3", Kind::Number(DENSITY), "1600.0").means("Density rho.").or(OF_MATERIAL).also_called(&[
        "rho",
        "ρ",
        "mass_density",
    ]),
    THERMAL_EXPANSION_1.in_table("ply", &[], OF_MATERIAL),
    THERMAL_EXPANSION_2.in_table("ply", &[], OF_MATERIAL),
    TENSILE_STRENGTH_1.in_table("ply", &[], OF_MATERIAL),
    COMPRESSIVE_STRENGTH_1.in_table("ply", &[], OF_MATERIAL),
    TENSILE_STRENGTH_2.in_table("ply", &[], OF_MATERIAL),
    COMPRESSIVE_STRENGTH_2.in_table("ply", &[], OF_MATERIAL),
    SHEAR_STRENGTH_12.in_table("ply", &[], OF_MATERIAL),
];

/// Of a ply that has none of its own.
const OF_MATERIAL: Presence = Follows("that of [material]");
/// Of a laminate whose plies have their own.
const OF_EACH_PLY: Presence = Follows("each [[ply]] has its own");
const NO_STRENGTH: Presence = Follows("none, and no failure fields; all five or none");
const NO_EXPANSION: Presence = Follows("none; actions of kind \"temperature\" need both");

// Keys of an orthotropic layer, whichever table gives them.
const YOUNGS_MODULUS_1: Key = ply("youngs_modulus_1_mpa", Kind::Number(MODULUS), "140000.0")
    .means("Young's modulus E1 along the fibres (material axis 1).")
    .also_called(&["e1", "e_1", "e11"]);
const YOUNGS_MODULUS_2: Key = ply("youngs_modulus_2_mpa", Kind::Number(MODULUS), "10000.0")
    .means("Young's modulus E2 across the fibres.")
    .also_called(&["e2", "e_2", "e22"]);
const POISSONS_RATIO_12: Key = ply(
    "poissons_ratio_12",
    Kind::Number(Limits { low: Limit::excluded(-10.0, RATIO), high: Limit::included(10.0, RATIO) }),
    "0.3",
)
.means("Poisson's ratio nu12: strain across is -nu12 times that along; nu12^2 < E1/E2.")
.also_called(&["nu12", "nu_12", "v12", "poisson_12"]);
const SHEAR_MODULUS_12: Key = ply("shear_modulus_12_mpa", Kind::Number(MODULUS), "5000.0")
    .means("Shear modulus G12.")
    .also_called(&["g12", "g_12", "shear_modulus"]);
const ANGLE: Key = ply("angle_deg", Kind::Number(Limits::ANY), "45.0")
    .means("Angle of material axis 1 from the u direction towards v.")
    .also_called(&["theta", "θ", "orientation", "orientation_deg", "fibre_angle_deg"]);
const THERMAL_EXPANSION_1: Key = ply("thermal_expansion_1_per_k", Kind::Number(EXPANSION), "0.02e-6")
    .means("Strain of the free layer along the fibres per kelvin.")
    .also_called(&["cte1", "cte_1", "alpha1", "alpha_1"]);
const THERMAL_EXPANSION_2: Key = ply("thermal_expansion_2_per_k", Kind::Number(EXPANSION), "22.5e-6")
    .means("The same across.")
    .also_called(&["cte2", "cte_2", "alpha2", "alpha_2"]);

const TENSILE_STRENGTH_1: Key = strength("tensile_strength_1_mpa", "1500.0")
    .means("Stress along the fibres at which the layer fails in tension, Xt: for the fields `failure_...` of exports and pictures. \
          Strengths change no state.")
    .also_called(&["xt", "x_t", "tensile_strength", "longitudinal_tensile_strength"]);
const COMPRESSIVE_STRENGTH_1: Key = strength("compressive_strength_1_mpa", "1200.0")
    .means("The same in compression, Xc; positive.")
    .also_called(&["xc", "x_c", "compressive_strength", "longitudinal_compressive_strength"]);
const TENSILE_STRENGTH_2: Key = strength("tensile_strength_2_mpa", "50.0")
    .means("The same across the fibres in tension, Yt.")
    .also_called(&["yt", "y_t", "transverse_tensile_strength"]);
const COMPRESSIVE_STRENGTH_2: Key = strength("compressive_strength_2_mpa", "200.0")
    .means("The same across the fibres in compression, Yc; positive.")
    .also_called(&["yc", "y_c", "transverse_compressive_strength"]);
const SHEAR_STRENGTH_12: Key = strength("shear_strength_12_mpa", "80.0")
    .means("The same in shear in the plane of the layer, S.")
    .also_called(&["s", "s12", "s_12", "sl", "shear_strength", "in_plane_shear_strength"]);

/// A key of what a layer bears.
const fn strength(name: &'static str, example: &'static str) -> Key {
    ply(name, Kind::Number(STRENGTH), example).reaches(Reach::Free)
}

const STRENGTH: Limits = Limits {
    low: Limit::excluded(
        0.0,
        "strengths are the sizes of stresses, in compression too; leave all five out where they are not known",
    ),
    high: Limit::included(1e13, "far stronger than anything"),
};
const MODULUS: Limits = Limits {
    low: Limit::excluded(0.0, "without stiffness there is no equilibrium to find"),
    high: Limit::included(1e13, "far stiffer than anything (diamond: 1.2e6 MPa)"),
};
const DENSITY: Limits = Limits {
    low: Limit::excluded(0.0, "a shell without mass has no weight; leave the key out"),
    high: Limit::included(1e12, "far denser than anything (osmium: 22590 kg/m3)"),
};
const EXPANSION: Limits =
    Limits { low: Limit::excluded(-1e-3, EXPANSION_REASON), high: Limit::included(1e-3, EXPANSION_REASON) };
const EXPANSION_REASON: &str = "a strain per kelvin, such as 22.5e-6 across the fibres of carbon in epoxy";
const RATIO: &str = "nu12 squared must be below E1/E2";
