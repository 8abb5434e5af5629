//! Keys of `[mesh]`, `[symmetry]` and `[adapt]`.

use super::geometry::SHELL_LENGTH;
use crate::scene::keys::Presence::{Default, Follows, InsteadOf};
use crate::scene::keys::Reach::Steps;
use crate::scene::keys::{Key, Kind, Limit, Limits, choice};

const fn mesh(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("mesh", name, kind, example)
}

const fn symmetry(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("symmetry", name, kind, example)
}

const fn adapt(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("adapt", name, kind, example)
}

pub(super) static MESH: &[Key] = &[
    mesh("degree", Kind::Pair(Limits {
        low: Limit::included(
            2.0,
            "bending needs second derivatives, and a slope without jumps between elements: degree 1 has neither",
        ),
        high: Limit::included(5.0, "an element of degree p costs about (p+1)^6; degrees above 5 are not offered"),
    }), "[3, 3]")
        .means("Polynomial degree along the length and along the arc; degree 2 locks on coarse meshes with full quadrature.")
        .or(Follows("3; [3, 5] for a tape spring whose elements are left out"))
        .also_called(&["p", "order", "degrees"]),
    mesh("elements", Kind::Pair(Limits {
        low: Limit::included(1.0, "a mesh has at least one element each way"),
        high: Limit::included(
            4096.0,
            "so fine a mesh would not fit into memory; [adapt] puts small elements where they count",
        ),
    }), "[4, 4]")
        .means("Elements along the length and along the arc, counted over the whole shell whatever the symmetry; \
              even in a direction that the symmetry cuts. Indicators see what the start mesh can show: two elements of \
              degree 2 across an arc cannot flatten, and are never refined.")
        .or(Follows(
            "[4, 4], refined and coarsened so that the mesh causes an error of 1 % at most, as by [adapt] with tolerance = 0.01 and \
             by all stages",
        ))
        .also_called(&["n", "element_count", "number_of_elements", "spans"]),
    mesh("quadrature", Kind::Word(&[
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
    ]), "\"balanced\"")
        .means("Integration rule on an element.")
        .or(Default("\"balanced\""))
        .also_called(&["integration", "rule"]),
];

pub(super) static SYMMETRY: &[Key] = &[symmetry(
    "part",
    Kind::Word(&[
        choice("none", "the whole shell"),
        choice("half-length", "one half, cut at mid-length"),
        choice("half-arc", "one half, cut along the apex line"),
        choice("quarter", "one quarter, cut both ways"),
    ]),
    "\"quarter\"",
)
.means("The part that is modelled.")
.or(Default("\"none\""))
.also_called(&["symmetry", "model", "kind"])];

pub(super) static ADAPT: &[Key] = &[
    adapt(
        "threshold",
        Kind::NumberOrPair(Limits {
            low: Limit::excluded(0.0, "every knot span would be marked in every step"),
            high: Limit::NONE,
        }),
        "0.019",
    )
    .means("r0 of the bending-strain indicator: a knot span is marked where max|kappa| h exceeds it (dimensionless).")
    .or(Default("0.019"))
    .reaches(Steps)
    .also_called(&["r0", "r_0"]),
    adapt(
        "tolerance",
        Kind::Number(Limits {
            low: Limit::included(1e-6, "the equilibria themselves are not found better"),
            high: Limit::included(0.5, "a mesh that is off by more says nothing"),
        }),
        "0.01",
    )
    .means("Relative error of the moment of turning ends, or else of the first probe (of the strain energy where there is \
          none, or one that finer spans do not change), that the mesh may cause; next to a limit point, of the parameter. The run estimates it by halving the knot spans of one direction after the other, and \
          splits those that lower it most per unknown.")
    .or(InsteadOf("threshold"))
    .reaches(Steps)
    .also_called(&["error", "accuracy", "tol"]),
    adapt(
        "splitting",
        Kind::Word(&[
            choice("halves", "in two halves"),
            choice("parts", "in as many parts, up to 4 at once, as their indicator and the length limit ask for"),
        ]),
        "\"halves\"",
    )
    .means("How spans marked by their bending strain are split; those marked by an error are split in as many parts as that asks for.")
    .or(Default("\"halves\""))
    .reaches(Steps),
    adapt(
        "length_limit",
        Kind::Word(&[
            choice("sqrt-radius-thickness", "sqrt(R t), the decay length of bending in the cross-section"),
            choice("half-decay-length", "half of that, with the shorter side of the shell where it is less than R"),
            choice("thickness", "t: of shorter waves a shell theory knows nothing"),
        ]),
        "\"sqrt-radius-thickness\"",
    )
    .means("Rule for the length below which elements are not halved.")
    .or(Follows(
        "\"thickness\" with a tolerance; with a threshold \"sqrt-radius-thickness\" for tape springs, \"half-decay-length\" \
         for other shells",
    ))
    .reaches(Steps)
    .also_called(&["h_lim", "limit"]),
    adapt(
        "length_limit_mm",
        Kind::NumberOrPair(Limits {
            low: Limit::excluded(0.0, "refinement would have no end"),
            high: SHELL_LENGTH.high,
        }),
        "1.0",
    )
    .means("Length below which elements are not halved.")
    .or(InsteadOf("length_limit"))
    .reaches(Steps)
    .also_called(&["h_lim_mm", "limit_mm", "least_length_mm", "min_length_mm"]),
];
