//! Every key of a scene file. Nothing about a key is written down anywhere else.

use super::identity::Reach::{Everything, Free, Steps};
use super::keys::Presence::{Default, Follows, InsteadOf, Required};
use super::keys::Unit::{Degree, KilogramPerCubicMetre, Megapascal, Millimetre, None};
use super::keys::{Choice, Key, Kind, Limit, Limits, Section};

/// The tables of a scene file, in the order in which one would write them.
pub static SECTIONS: [Section; 11] = [
    section("geometry", true, "The undeformed mid-surface."),
    section("material", true, "Constitutive law and thickness."),
    section("mesh", true, "Spline space and quadrature that the run starts with."),
    section("symmetry", false, "Which part of the shell is modelled."),
    section("load", true, "What moves the shell."),
    section("adapt", false, "When and how far the mesh is refined."),
    section("solver", false, "Tolerances and limits of the equilibrium solver."),
    section("continuation", false, "How the path of equilibria is followed."),
    section("pipeline", false, "The stages of one load step."),
    section("output", false, "What is written beside the states; never changes a state."),
    section("expect", false, "How the run is to end; `foldline stress` alone looks at it."),
];

/// The keys of a scene file, table by table.
pub static KEYS: [&Key; 40] = [
    &GEOMETRY_KIND,
    &LENGTH,
    &RADIUS,
    &ARC,
    &MATERIAL_KIND,
    &YOUNGS_MODULUS,
    &POISSONS_RATIO,
    &THICKNESS,
    &DENSITY,
    &OFFSET,
    &THERMAL_EXPANSION,
    &DEGREE,
    &ELEMENTS,
    &QUADRATURE,
    &PART,
    &LOAD_KIND,
    &SENSE,
    &ROTATION,
    &INCREMENT,
    &LONGEST_INCREMENT,
    &THRESHOLD,
    &LENGTH_LIMIT,
    &LENGTH_LIMIT_MM,
    &TOLERANCE,
    &MAX_ITERATIONS,
    &LEAST_INCREMENT,
    &SNAP_TOLERANCE,
    &CONTROL,
    &LONGEST_STEP,
    &SHORTEST_STEP,
    &MOST_STEPS,
    &STAGES,
    &SYNC,
    &MESH_HISTORY,
    &OUTCOME,
    &SAME_AS,
    &LEAST_BITS,
    &PEAK,
    &LAST,
    &INEXACT,
];

const fn section(name: &'static str, required: bool, meaning: &'static str) -> Section {
    Section { name, required, meaning }
}

const fn choice(word: &'static str, meaning: &'static str) -> Choice {
    Choice { word, meaning }
}

/// A length of the shell: positive, and no more than a kilometre.
const SHELL_LENGTH: Limits = Limits {
    low: Limit::excluded(0.0, "a shell without extent has nothing to fold"),
    high: Limit::included(1e6, "more than a kilometre; the value is in mm"),
};

pub(super) static GEOMETRY_KIND: Key = Key {
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

pub(super) static LENGTH: Key = Key {
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

pub(super) static RADIUS: Key = Key {
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

pub(super) static ARC: Key = Key {
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

pub(super) static MATERIAL_KIND: Key = Key {
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

pub(super) static YOUNGS_MODULUS: Key = Key {
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

pub(super) static POISSONS_RATIO: Key = Key {
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

pub(super) static THICKNESS: Key = Key {
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

pub(super) static DENSITY: Key = Key {
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

pub(super) static OFFSET: Key = Key {
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

pub(super) static THERMAL_EXPANSION: Key = Key {
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

pub(super) static DEGREE: Key = Key {
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

pub(super) static ELEMENTS: Key = Key {
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

pub(super) static QUADRATURE: Key = Key {
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

pub(super) static PART: Key = Key {
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

pub(super) static LOAD_KIND: Key = Key {
    section: "load",
    name: "kind",
    unit: None,
    kind: Kind::Word(&[
        choice("end-rotation", "the end sections of a tape spring turn by +theta and -theta"),
        choice("steps", "supports and actions of your own follow a load factor; see OTHER SHELLS below"),
    ]),
    presence: Required,
    reach: Everything,
    meaning: "What moves the shell.",
    example: "\"end-rotation\"",
    aliases: &["type"],
};

pub(super) static SENSE: Key = Key {
    section: "load",
    name: "sense",
    unit: None,
    kind: Kind::Word(&[
        choice("opposite", "against the curvature of the cross-section, free edges in tension"),
        choice("equal", "with the curvature of the cross-section, free edges in compression"),
    ]),
    presence: Required,
    reach: Everything,
    meaning: "Sense of the bending.",
    example: "\"opposite\"",
    aliases: &["direction", "sign"],
};

pub(super) static ROTATION: Key = Key {
    section: "load",
    name: "rotation_deg",
    unit: Degree,
    kind: Kind::Number(Limits {
        low: Limit::excluded(0.0, "the sense of the bending is chosen with load.sense, not with a sign"),
        high: Limit::excluded(
            180.0,
            "each end turns by this much: at 90 degrees the two halves already face each other",
        ),
    }),
    presence: Required,
    reach: Free,
    meaning: "Rotation of each end at which the run stops.",
    example: "60.0",
    aliases: &["target", "target_deg", "theta", "θ", "angle_deg", "end_rotation_deg"],
};

pub(super) static INCREMENT: Key = Key {
    section: "load",
    name: "increment_deg",
    unit: Degree,
    kind: Kind::Number(Limits {
        low: Limit::excluded(0.0, "every load step goes forward; the sense of the bending is chosen with load.sense"),
        high: Limit::excluded(180.0, "one increment would go past every rotation that a run can reach"),
    }),
    presence: Required,
    reach: Steps,
    meaning: "Rotation increment of one load step; at most the rotation.",
    example: "0.4",
    aliases: &["step", "step_deg", "increment_size", "rotation_step_deg", "rotation_increment_deg"],
};

pub(super) static LONGEST_INCREMENT: Key = Key {
    section: "load",
    name: "longest_increment_deg",
    unit: Degree,
    kind: Kind::Number(Limits {
        low: Limit::excluded(0.0, "every load step goes forward; the sense of the bending is chosen with load.sense"),
        high: Limit::excluded(180.0, "one increment would go past every rotation that a run can reach"),
    }),
    presence: Follows("increment_deg, so that steps do not grow"),
    reach: Steps,
    meaning: "Increments are doubled up to this while solves take three iterations or fewer, and halved again where one takes \
              more than six. Until one is cut, steps end at multiples of increment_deg.",
    example: "3.2",
    aliases: &["max_increment_deg", "maximum_increment_deg", "largest_increment_deg", "max_step_deg"],
};

pub(super) static THRESHOLD: Key = Key {
    section: "adapt",
    name: "threshold",
    unit: None,
    kind: Kind::Number(Limits {
        low: Limit::excluded(0.0, "every knot span would be marked in every step"),
        high: Limit::NONE,
    }),
    presence: Default("0.019"),
    reach: Steps,
    meaning: "r0: a knot span is marked where max|kappa| h exceeds it (dimensionless).",
    example: "0.019",
    aliases: &["r0", "r_0"],
};

pub(super) static LENGTH_LIMIT: Key = Key {
    section: "adapt",
    name: "length_limit",
    unit: None,
    kind: Kind::Word(&[
        choice("sqrt-radius-thickness", "sqrt(R t), the decay length of bending in the cross-section"),
        choice("half-decay-length", "half of that, with the shorter side of the shell where it is less than R"),
    ]),
    presence: Follows("\"sqrt-radius-thickness\" for tape springs, \"half-decay-length\" for other shells"),
    reach: Steps,
    meaning: "Rule for the length below which elements are not halved.",
    example: "\"sqrt-radius-thickness\"",
    aliases: &["h_lim", "limit"],
};

pub(super) static LENGTH_LIMIT_MM: Key = Key {
    section: "adapt",
    name: "length_limit_mm",
    unit: Millimetre,
    kind: Kind::Number(Limits { low: Limit::excluded(0.0, "refinement would have no end"), high: SHELL_LENGTH.high }),
    presence: InsteadOf("length_limit"),
    reach: Steps,
    meaning: "Length below which elements are not halved.",
    example: "1.0",
    aliases: &["h_lim_mm", "limit_mm", "least_length_mm", "min_length_mm"],
};

pub(super) static TOLERANCE: Key = Key {
    section: "solver",
    name: "tolerance",
    unit: None,
    kind: Kind::Number(Limits {
        low: Limit::excluded(0.0, "rounding keeps every residual above zero"),
        high: Limit::included(
            1e-4,
            "beyond it moments and the rotation of a jump are off in the digits that are printed",
        ),
    }),
    presence: Default("1e-7"),
    reach: Steps,
    meaning: "A state is in equilibrium when |residual| <= tolerance |forces|: the largest of reactions, loads and what heat or a \
              natural curvature pushes with, or a thousandth of the forces inside the shell, or of the largest of these met \
              before. Moments and reactions of tape \
              springs are then within 20 times the tolerance of their converged values, also next to limit points, and \
              within 100 times in a thin plate that is lifted and twisted; strain energies are far closer.",
    example: "1e-7",
    aliases: &["tol", "eps", "epsilon", "accuracy", "relative_tolerance"],
};

pub(super) static MAX_ITERATIONS: Key = Key {
    section: "solver",
    name: "max_iterations",
    unit: None,
    kind: Kind::Count(Limits {
        low: Limit::included(1.0, "without an iteration nothing is solved"),
        high: Limit::included(1e5, "a solve that has not converged by then will not"),
    }),
    presence: Default("1000"),
    reach: Steps,
    meaning: "Newton iterations after which a solve has failed; a smooth step takes 3 to 5, a snap some tens.",
    example: "1000",
    aliases: &["iterations", "max_iter", "maxiter", "iteration_limit"],
};

pub(super) static LEAST_INCREMENT: Key = Key {
    section: "solver",
    name: "least_increment_deg",
    unit: Degree,
    kind: Kind::Number(Limits {
        low: Limit::excluded(0.0, "an increment that fails would be halved without end"),
        high: Limit::NONE,
    }),
    presence: Default("1e-6"),
    reach: Steps,
    meaning: "Increments are not cut below this; then the run stops with all good steps kept.",
    example: "1e-6",
    aliases: &["min_increment_deg", "minimum_increment_deg", "smallest_increment_deg", "min_step_deg"],
};

pub(super) static SNAP_TOLERANCE: Key = Key {
    section: "solver",
    name: "snap_tolerance_deg",
    unit: Degree,
    kind: Kind::Number(Limits {
        low: Limit::included(1e-9, "rotations of jumps are not resolved more finely"),
        high: Limit::NONE,
    }),
    presence: Default("0.01"),
    reach: Steps,
    meaning: "A jump is located to this rotation before the run goes on beyond it.",
    example: "0.01",
    aliases: &["jump_tolerance_deg"],
};

pub(super) static CONTROL: Key = Key {
    section: "continuation",
    name: "control",
    unit: None,
    kind: Kind::Word(&[
        choice("load", "the usual way: each step moves the rotation or the load factor on by an increment"),
        choice(
            "arc-length",
            "for paths that turn: each step goes a length along the path, on which the rotation or the load factor may go back, past limit points, \
             through snap-through and snap-back, along unstable branches",
        ),
    ]),
    presence: Default("\"load\""),
    reach: Steps,
    meaning: "What is prescribed in a load step. Under arc-length the first step is one increment; lengths are multiples of \
              its length, and the run ends where the rotation or the load factor reaches its target, on either side of 0. \
              Limit points and bifurcations on the way are located to the snap tolerance.",
    example: "\"arc-length\"",
    aliases: &["kind", "type", "method", "riks", "crisfield"],
};

pub(super) static LONGEST_STEP: Key = Key {
    section: "continuation",
    name: "longest_step",
    unit: None,
    kind: Kind::Number(Limits {
        low: Limit::included(1.0, "the first step has length 1"),
        high: Limit::included(1e6, "no path is that long"),
    }),
    presence: Default("2.0"),
    reach: Steps,
    meaning: "Steps are not longer than this many first steps.",
    example: "2.0",
    aliases: &["max_step", "longest", "maximum_step", "max_length"],
};

pub(super) static SHORTEST_STEP: Key = Key {
    section: "continuation",
    name: "shortest_step",
    unit: None,
    kind: Kind::Number(Limits {
        low: Limit::excluded(0.0, "a step that fails would be halved without end"),
        high: Limit::included(1.0, "the first step has length 1"),
    }),
    presence: Default("1e-6"),
    reach: Steps,
    meaning: "Steps are not cut below this many first steps; then the run stops with all good steps kept.",
    example: "1e-6",
    aliases: &["min_step", "shortest", "minimum_step", "min_length"],
};

pub(super) static MOST_STEPS: Key = Key {
    section: "continuation",
    name: "most_steps",
    unit: None,
    kind: Kind::Count(Limits {
        low: Limit::included(1.0, "a path has at least one step"),
        high: Limit::included(1e6, "a path that has not ended by then will not"),
    }),
    presence: Default("2000"),
    reach: Steps,
    meaning: "Load steps after which the run stops: a path may close in itself and never reach its target.",
    example: "2000",
    aliases: &["max_steps", "steps", "step_limit"],
};

pub(super) static STAGES: Key = Key {
    section: "pipeline",
    name: "stages",
    unit: None,
    kind: Kind::Stages,
    presence: Follows("all five stages where the scene has [adapt], else [\"solve\"]"),
    reach: Steps,
    meaning: "The stages of one load step: solve alone, with evaluate-indicators to watch, or with refine-knots, \
              project-displacements and re-equilibrate to refine. switch-branch after solve leaves an unstable equilibrium \
              along its soft mode, down to a stable one; by arc length only at bifurcations, since behind a limit point the \
              unstable path is what is followed.",
    example: "[\"solve\", \"evaluate-indicators\", \"refine-knots\", \"project-displacements\", \"re-equilibrate\"]",
    aliases: &["steps", "stage"],
};

pub(super) static SYNC: Key = Key {
    section: "output",
    name: "sync",
    unit: None,
    kind: Kind::Word(&[
        choice("each-stage", "after every stage"),
        choice("each-second", "at most once a second, and at the end"),
        choice("at-end", "at the end only"),
    ]),
    presence: Default("\"each-second\""),
    reach: Free,
    meaning: "When the log is forced to disk; a killed process loses nothing either way, a power cut may.",
    example: "\"each-second\"",
    aliases: &["fsync", "flush"],
};

pub(super) static MESH_HISTORY: Key = Key {
    section: "output",
    name: "mesh_history",
    unit: None,
    kind: Kind::Switch,
    presence: Default("false"),
    reach: Free,
    meaning: "Whether the deformed mesh is written for viewers after every stage that changes it.",
    example: "true",
    aliases: &["history", "meshes"],
};

pub(super) static OUTCOME: Key = Key {
    section: "expect",
    name: "outcome",
    unit: None,
    kind: Kind::Word(&[
        choice("finished", "at its target"),
        choice("refused", "before its first step: mesh, supports and loads do not go together"),
        choice("no-equilibrium", "where no increment, however small, leads to an equilibrium"),
        choice("jump-not-followed", "at a jump beyond which no equilibrium is found"),
        choice("not-re-equilibrated", "on a refined mesh that has no equilibrium"),
        choice("refined-too-far", "where refinement asks for more than memory holds"),
        choice("path-lost", "where a path by arc length cannot be followed, however short the step"),
        choice("path-too-long", "where a path by arc length has taken all the steps that it may"),
    ]),
    presence: Default("\"finished\""),
    reach: Free,
    meaning: "How the run ends.",
    example: "\"finished\"",
    aliases: &["end", "ending", "result"],
};

pub(super) static SAME_AS: Key = Key {
    section: "expect",
    name: "same_as",
    unit: None,
    kind: Kind::Text,
    presence: Follows("no other scene"),
    reach: Free,
    meaning: "A scene in the same folder that has the same curve but for units: M/(E t^3) over the rotation (of other \
              scenes the strain energy over E t^3) agrees at every equilibrium to 1e-9 of the largest.",
    example: "\"millimetres.toml\"",
    aliases: &["equals", "same"],
};

pub(super) static LEAST_BITS: Key = Key {
    section: "expect",
    name: "least_bits",
    unit: None,
    kind: Kind::Count(Limits {
        low: Limit::included(1.0, "a result of which nothing survives says nothing"),
        high: Limit::included(52.0, "numbers have no more"),
    }),
    presence: Default("10"),
    reach: Free,
    meaning: "Bits of the result that survive where an input changes in its last place; fewer than ten only where the \
              shell has several ways to fall and rounding decides between them.",
    example: "10",
    aliases: &["bits", "significant_bits"],
};

const ANY_NUMBER: Limits = Limits { low: Limit::excluded(f64::NEG_INFINITY, ""), high: Limit::NONE };

pub(super) static PEAK: Key = Key {
    section: "expect",
    name: "peak",
    unit: None,
    kind: Kind::Number(ANY_NUMBER),
    presence: Follows("nothing to be held against"),
    reach: Free,
    meaning: "The largest moment before the first jump (N mm; of other scenes the first probe, or else the strain energy), \
              from a closed form or a finer mesh.",
    example: "292.0",
    aliases: &["largest", "maximum"],
};

pub(super) static LAST: Key = Key {
    section: "expect",
    name: "last",
    unit: None,
    kind: Kind::Number(ANY_NUMBER),
    presence: Follows("nothing to be held against"),
    reach: Free,
    meaning: "The same at the last equilibrium.",
    example: "28.3",
    aliases: &["value", "reference"],
};

pub(super) static INEXACT: Key = Key {
    section: "expect",
    name: "inexact",
    unit: None,
    kind: Kind::Text,
    presence: Follows("right to 2 %"),
    reach: Free,
    meaning: "Why the run may be off `peak` or `last` by more than 2 %.",
    example: "\"elements of 75 mm hold no fold\"",
    aliases: &["because", "reason"],
};
