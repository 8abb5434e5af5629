//! Keys of `[load]`, `[adapt]`, `[solver]`, `[continuation]` and `[pipeline]`.

use super::shell::SHELL_LENGTH;
use crate::scene::keys::Presence::{Default, Follows, InsteadOf, Required};
use crate::scene::keys::Reach::{Everything, Free, Steps};
use crate::scene::keys::Unit::{Degree, Millimetre, None};
use crate::scene::keys::{Key, Kind, Limit, Limits, choice};

pub static LOAD_KIND: Key = Key {
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

pub static SENSE: Key = Key {
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

pub static ROTATION: Key = Key {
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

pub static INCREMENT: Key = Key {
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

pub static LONGEST_INCREMENT: Key = Key {
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

pub static THRESHOLD: Key = Key {
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

pub static LENGTH_LIMIT: Key = Key {
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

pub static LENGTH_LIMIT_MM: Key = Key {
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

pub static TOLERANCE: Key = Key {
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

pub static MAX_ITERATIONS: Key = Key {
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

pub static LEAST_INCREMENT: Key = Key {
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

pub static SNAP_TOLERANCE: Key = Key {
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

pub static CONTROL: Key = Key {
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

pub static LONGEST_STEP: Key = Key {
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

pub static SHORTEST_STEP: Key = Key {
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

pub static MOST_STEPS: Key = Key {
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

pub static STAGES: Key = Key {
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
