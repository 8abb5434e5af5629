//! Keys of `[geometry]`, `[material]`, `[mesh]` and `[symmetry]`.

use crate::scene::keys::Presence::{Default, Follows, Required};
use crate::scene::keys::Reach::Everything;
use crate::scene::keys::Unit::{Degree, KilogramPerCubicMetre, Megapascal, Millimetre, None};
use crate::scene::keys::{Key, Kind, Limit, Limits, choice};

/// A length of the shell: positive, and no more than a kilometre.
pub const SHELL_LENGTH: Limits = Limits {
    low: Limit::excluded(0.0, "a shell without extent has nothing to fold"),
    high: Limit::included(1e6, "more than a kilometre; the value is in mm"),
};

pub static GEOMETRY_KIND: Key = Key {
    section: "geometry",
    name: "kind",
    unit: None,
    kind: Kind::Word(&[
        choice("tape-spring", "open circular cylinder"),
        choice("plate", "see OTHER SHELLS below, as for all that follow"),
        choice("cylinder-panel", "circular cylinder of any arc"),
        choice("annulus", "flat ring or a sector of it"),
        choice("sphere-zone", "part of a sphere between two latitudes"),
        choice("nurbs", "any smooth surface of one patch"),
    ]),
    presence: Required,
    reach: Everything,
    meaning: "Shape of the shell.",
    example: "\"tape-spring\"",
    aliases: &["type", "shape"],
};

pub static LENGTH: Key = Key {
    section: "geometry",
    name: "length_mm",
    unit: Millimetre,
    kind: Kind::Number(SHELL_LENGTH),
    presence: Required,
    reach: Everything,
    meaning: "Length along the axis.",
    example: "300.0",
    aliases: &["l"],
};

pub static RADIUS: Key = Key {
    section: "geometry",
    name: "radius_mm",
    unit: Millimetre,
    kind: Kind::Number(SHELL_LENGTH),
    presence: Required,
    reach: Everything,
    meaning: "Radius of the mid-surface of the cross-section.",
    example: "10.0",
    aliases: &["r"],
};

pub static ARC: Key = Key {
    section: "geometry",
    name: "arc_deg",
    unit: Degree,
    kind: Kind::Number(Limits {
        low: Limit::excluded(0.0, "without an arc there is no cross-section"),
        high: Limit::excluded(360.0, "at 360 degrees the cross-section closes, and the shell is open no more"),
    }),
    presence: Required,
    reach: Everything,
    meaning: "Angle that the whole cross-section subtends.",
    example: "110.0",
    aliases: &["alpha", "α", "angle", "angle_deg", "arc_angle", "arc_angle_deg", "subtended_angle_deg"],
};

pub static MATERIAL_KIND: Key = Key {
    section: "material",
    name: "kind",
    unit: None,
    kind: Kind::Word(&[
        choice("isotropic", "St. Venant-Kirchhoff, isotropic"),
        choice("orthotropic", "one orthotropic layer; see OTHER SHELLS below"),
        choice("laminate", "layers through the thickness; see OTHER SHELLS below"),
    ]),
    presence: Required,
    reach: Everything,
    meaning: "Constitutive law.",
    example: "\"isotropic\"",
    aliases: &["type", "law", "model"],
};

pub static YOUNGS_MODULUS: Key = Key {
    section: "material",
    name: "youngs_modulus_mpa",
    unit: Megapascal,
    kind: Kind::Number(Limits {
        low: Limit::excluded(0.0, "without stiffness there is no equilibrium to find"),
        high: Limit::included(1e13, "far stiffer than anything (diamond: 1.2e6 MPa)"),
    }),
    presence: Required,
    reach: Everything,
    meaning: "Young's modulus E.",
    example: "131000.0",
    aliases: &["e", "young", "youngs", "elastic_modulus", "modulus", "young_modulus", "elasticity"],
};

pub static POISSONS_RATIO: Key = Key {
    section: "material",
    name: "poissons_ratio",
    unit: None,
    kind: Kind::Number(Limits {
        low: Limit::excluded(-1.0, "at -1 and below the shear modulus E/(2(1+nu)) is not finite and positive"),
        high: Limit::excluded(0.5, "at 1/2 and beyond the bulk modulus E/(3(1-2nu)) is not finite and positive"),
    }),
    presence: Required,
    reach: Everything,
    meaning: "Poisson's ratio nu.",
    example: "0.3",
    aliases: &["nu", "ν", "poisson", "poissons", "poisson_ratio", "v"],
};

pub static THICKNESS: Key = Key {
    section: "material",
    name: "thickness_mm",
    unit: Millimetre,
    kind: Kind::Number(Limits {
        low: Limit::excluded(0.0, "a shell without thickness has no stiffness"),
        high: SHELL_LENGTH.high,
    }),
    presence: Required,
    reach: Everything,
    meaning: "Shell thickness t; less than the radius.",
    example: "0.1",
    aliases: &["t", "h"],
};

pub static DENSITY: Key = Key {
    section: "material",
    name: "density_kg_m3",
    unit: KilogramPerCubicMetre,
    kind: Kind::Number(Limits {
        low: Limit::excluded(0.0, "a shell without mass has no weight; leave the key out"),
        high: Limit::included(1e12, "far denser than anything (osmium: 22590 kg/m3)"),
    }),
    presence: Follows("none, and nothing weighs"),
    reach: Everything,
    meaning: "Density rho; only an [[action]] of kind \"gravity\" asks for it.",
    example: "7850.0",
    aliases: &["rho", "ρ", "mass_density"],
};

pub static OFFSET: Key = Key {
    section: "material",
    name: "offset_mm",
    unit: Millimetre,
    kind: Kind::Number(Limits {
        low: Limit::included(-SHELL_LENGTH.high.value, SHELL_LENGTH.high.reason),
        high: SHELL_LENGTH.high,
    }),
    presence: Default("0.0"),
    reach: Everything,
    meaning: "Distance of the surface of the geometry from the middle of the thickness, along the normal: half the \
              thickness puts it on top, minus half of it at the bottom. On a curved shell results are off by about \
              3 offset/radius, and more than 2 % of the radius is refused: draw the middle surface.",
    example: "0.0",
    aliases: &["eccentricity"],
};

pub static THERMAL_EXPANSION: Key = Key {
    section: "material",
    name: "thermal_expansion_per_k",
    unit: None,
    kind: Kind::Number(Limits {
        low: Limit::excluded(-1e-3, "a strain per kelvin, such as 23.1e-6 for aluminium"),
        high: Limit::excluded(1e-3, "a strain per kelvin, such as 23.1e-6 for aluminium"),
    }),
    presence: Follows("none; actions of kind \"temperature\" need it"),
    reach: Everything,
    meaning: "Strain of the free shell per kelvin.",
    example: "23.1e-6",
    aliases: &["cte", "expansion", "thermal_expansion", "expansion_per_k"],
};

pub static DEGREE: Key = Key {
    section: "mesh",
    name: "degree",
    unit: None,
    kind: Kind::Pair(Limits {
        low: Limit::included(
            2.0,
            "bending needs second derivatives, and a slope without jumps between elements: degree 1 has neither",
        ),
        high: Limit::included(5.0, "an element of degree p costs about (p+1)^6; degrees above 5 are not offered"),
    }),
    presence: Default("3"),
    reach: Everything,
    meaning: "Polynomial degree along the length and along the arc; degree 2 locks on coarse meshes with full quadrature.",
    example: "[3, 3]",
    aliases: &["p", "order", "degrees"],
};

pub static ELEMENTS: Key = Key {
    section: "mesh",
    name: "elements",
    unit: None,
    kind: Kind::Pair(Limits {
        low: Limit::included(1.0, "a mesh has at least one element each way"),
        high: Limit::included(
            4096.0,
            "so fine a mesh would not fit into memory; [adapt] puts small elements where they count",
        ),
    }),
    presence: Required,
    reach: Everything,
    meaning: "Elements along the length and along the arc, counted over the whole shell whatever the symmetry; \
              even in a direction that the symmetry cuts. Indicators see what the start mesh can show: two elements of \
              degree 2 across an arc cannot flatten, and are never refined.",
    example: "[4, 4]",
    aliases: &["n", "element_count", "number_of_elements", "spans"],
};

pub static QUADRATURE: Key = Key {
    section: "mesh",
    name: "quadrature",
    unit: None,
    kind: Kind::Word(&[
        choice(
            "balanced",
            "as patch, and for stretching as many more as leave constant membrane forces in balance on the mesh in hand",
        ),
        choice("full", "Gauss-Legendre with degree + 1 points each way"),
        choice("full-plus-one", "degree + 2 points each way, to judge others by"),
        choice("full-plus-two", "degree + 3 points each way"),
        choice("reduced", "Gauss-Legendre with degree points each way"),
        choice(
            "patch",
            "degree - 1 points each way (at least 2) where the spline is smooth, degree next to edges and repeated knots",
        ),
    ]),
    presence: Default("\"balanced\""),
    reach: Everything,
    meaning: "Integration rule on an element.",
    example: "\"balanced\"",
    aliases: &["integration", "rule"],
};

pub static PART: Key = Key {
    section: "symmetry",
    name: "part",
    unit: None,
    kind: Kind::Word(&[
        choice("none", "the whole shell"),
        choice("half-length", "one half, cut at mid-length"),
        choice("half-arc", "one half, cut along the apex line"),
        choice("quarter", "one quarter, cut both ways"),
    ]),
    presence: Default("\"none\""),
    reach: Everything,
    meaning: "The part that is modelled.",
    example: "\"quarter\"",
    aliases: &["symmetry", "model", "kind"],
};
