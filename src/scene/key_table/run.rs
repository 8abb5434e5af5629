//! Keys of `[load]`, `[solver]`, `[continuation]` and `[pipeline]`.

use crate::scene::keys::Presence::{Default, Follows};
use crate::scene::keys::Reach::{Free, Steps};
use crate::scene::keys::{Key, Kind, Limit, Limits, choice};

const fn load(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("load", name, kind, example)
}

const fn solver(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("solver", name, kind, example)
}

const fn continuation(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("continuation", name, kind, example)
}

const fn pipeline(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("pipeline", name, kind, example)
}

/// Load factors.
const FACTOR: Limits = Limits {
    low: Limit::excluded(0.0, "load factors grow from 0"),
    high: Limit::included(1e6, "beyond all sense: a load factor of 1 is the load as it is written"),
};

pub(super) static LOAD: &[Key] = &[
    load("kind", Kind::Word(&[
        choice("end-rotation", "the end sections of a tape spring turn by +theta and -theta"),
        choice("steps", "supports and actions of your own follow a load factor"),
    ]), "\"end-rotation\"")
        .means("What moves the shell.")
        .also_called(&["type"]),
    load("sense", Kind::Word(&[
        choice("opposite", "against the curvature of the cross-section, free edges in tension"),
        choice("equal", "with the curvature of the cross-section, free edges in compression"),
    ]), "\"opposite\"")
        .of(&["end-rotation"])
        .means("Sense of the bending.")
        .also_called(&["direction", "sign"]),
    load("rotation_deg", Kind::Number(Limits {
        low: Limit::excluded(0.0, "the sense of the bending is chosen with load.sense, not with a sign"),
        high: Limit::excluded(
            180.0,
            "each end turns by this much: at 90 degrees the two halves already face each other",
        ),
    }), "60.0")
        .of(&["end-rotation"])
        .means("Rotation of each end at which the run stops.")
        .reaches(Free)
        .also_called(&["target", "target_deg", "theta", "θ", "angle_deg", "end_rotation_deg"]),
    load("increment_deg", Kind::Number(Limits {
        low: Limit::excluded(0.0, "every load step goes forward; the sense of the bending is chosen with load.sense"),
        high: Limit::excluded(180.0, "one increment would go past every rotation that a run can reach"),
    }), "0.4")
        .of(&["end-rotation"])
        .means("Rotation increment of one load step; at most the rotation.")
        .reaches(Steps)
        .also_called(&["step", "step_deg", "increment_size", "rotation_step_deg", "rotation_increment_deg"]),
    load("longest_increment_deg", Kind::Number(Limits {
        low: Limit::excluded(0.0, "every load step goes forward; the sense of the bending is chosen with load.sense"),
        high: Limit::excluded(180.0, "one increment would go past every rotation that a run can reach"),
    }), "3.2")
        .of(&["end-rotation"])
        .means("Increments are doubled up to this while solves take three iterations or fewer, and halved again where one takes \
              more than six. Until one is cut, steps end at multiples of increment_deg.")
        .or(Follows("increment_deg, so that steps do not grow"))
        .reaches(Steps)
        .also_called(&["max_increment_deg", "maximum_increment_deg", "largest_increment_deg", "max_step_deg"]),
    load("increment", Kind::Number(FACTOR), "0.05")
        .of(&["steps"])
        .means("Load factor of one step; cut where a step fails. With control = \"arc-length\" in [continuation] only the first \
              step is an increment; the load factor then follows from the path, may fall and change its sign, and the run \
              ends at factor or at -factor.")
        .reaches(Steps)
        .also_called(&["step", "increment_size"]),
    load("longest_increment", Kind::Number(FACTOR), "0.4")
        .of(&["steps"])
        .means("Increments are doubled up to this while solves take three iterations or fewer, and halved again where one takes \
              more than six.")
        .or(Follows("increment, so that steps do not grow"))
        .reaches(Steps)
        .also_called(&["max_increment", "maximum_increment", "largest_increment", "max_step"]),
    load("factor", Kind::Number(FACTOR), "2.0")
        .of(&["steps"])
        .means("Load factor at which the run stops.")
        .or(Default("1.0"))
        .reaches(Free)
        .also_called(&["target", "load_factor", "lambda", "λ"]),
    load("least_increment", Kind::Number(FACTOR), "1e-6")
        .of(&["steps"])
        .means("Increments are not cut below this; then the run stops with all good steps kept.")
        .or(Default("1e-6"))
        .reaches(Steps)
        .also_called(&["min_increment", "minimum_increment", "smallest_increment", "min_step"]),
    load("snap_tolerance", Kind::Number(FACTOR), "0.001")
        .of(&["steps"])
        .means("A jump is located to this load factor; so are limit points and bifurcations.")
        .or(Default("0.001"))
        .reaches(Steps)
        .also_called(&["jump_tolerance"]),
];

pub(super) static SOLVER: &[Key] = &[
    solver("tolerance", Kind::Number(Limits {
        low: Limit::excluded(0.0, "rounding keeps every residual above zero"),
        high: Limit::included(
            1e-4,
            "beyond it moments and the rotation of a jump are off in the digits that are printed",
        ),
    }), "1e-7")
        .means("A state is in equilibrium when |residual| <= tolerance |forces|: the largest of reactions, loads and what heat or a \
              natural curvature pushes with, or a thousandth of the forces inside the shell, or of the largest of these met \
              before. Moments and reactions of tape \
              springs are then within 20 times the tolerance of their converged values, also next to limit points, and \
              within 100 times in a thin plate that is lifted and twisted; strain energies are far closer.")
        .or(Default("1e-7"))
        .reaches(Steps)
        .also_called(&["tol", "eps", "epsilon", "accuracy", "relative_tolerance"]),
    solver("max_iterations", Kind::Count(Limits {
        low: Limit::included(1.0, "without an iteration nothing is solved"),
        high: Limit::included(1e5, "a solve that has not converged by then will not"),
    }), "1000")
        .means("Newton iterations after which a solve has failed; a smooth step takes 3 to 5, a snap some tens.")
        .or(Default("1000"))
        .reaches(Steps)
        .also_called(&["iterations", "max_iter", "maxiter", "iteration_limit"]),
    solver("least_increment_deg", Kind::Number(Limits {
        low: Limit::excluded(0.0, "an increment that fails would be halved without end"),
        high: Limit::NONE,
    }), "1e-6")
        .means("Increments are not cut below this; then the run stops with all good steps kept.")
        .or(Default("1e-6"))
        .reaches(Steps)
        .also_called(&["min_increment_deg", "minimum_increment_deg", "smallest_increment_deg", "min_step_deg"]),
    solver("snap_tolerance_deg", Kind::Number(Limits {
        low: Limit::included(1e-9, "rotations of jumps are not resolved more finely"),
        high: Limit::NONE,
    }), "0.01")
        .means("A jump is located to this rotation before the run continues beyond it.")
        .or(Default("0.01"))
        .reaches(Steps)
        .also_called(&["jump_tolerance_deg"]),
];

pub(super) static CONTINUATION: &[Key] = &[
    continuation("control", Kind::Word(&[
        choice("load", "the usual way: each step moves the rotation or the load factor on by an increment"),
        choice(
            "arc-length",
            "for paths that turn: each step goes a length along the path, on which the rotation or the load factor may go back, past limit points, \
             through snap-through and snap-back, along unstable branches",
        ),
    ]), "\"arc-length\"")
        .means("What is prescribed in a load step. Under arc-length the first step is one increment; lengths are multiples of \
              its length, and the run ends where the rotation or the load factor reaches its target, on either side of 0. \
              Limit points and bifurcations on the way are located to the snap tolerance; at a bifurcation the path goes on \
              along the branch it came on, unless pipeline.stages has switch-branch.")
        .or(Default("\"load\""))
        .reaches(Steps)
        .also_called(&["kind", "type", "method", "riks", "crisfield"]),
    continuation("longest_step", Kind::Number(Limits {
        low: Limit::included(1.0, "the first step has length 1"),
        high: Limit::included(1e6, "no path is that long"),
    }), "2.0")
        .means("Steps are not longer than this many first steps.")
        .or(Default("2.0"))
        .reaches(Steps)
        .also_called(&["max_step", "longest", "maximum_step", "max_length"]),
    continuation("shortest_step", Kind::Number(Limits {
        low: Limit::excluded(0.0, "a step that fails would be halved without end"),
        high: Limit::included(1.0, "the first step has length 1"),
    }), "1e-6")
        .means("Steps are not cut below this many first steps; then the run stops with all good steps kept.")
        .or(Default("1e-6"))
        .reaches(Steps)
        .also_called(&["min_step", "shortest", "minimum_step", "min_length"]),
    continuation("most_steps", Kind::Count(Limits {
        low: Limit::included(1.0, "a path has at least one step"),
        high: Limit::included(1e6, "a path that has not ended by then will not"),
    }), "2000")
        .means("Load steps after which the run stops: a path may close in itself and never reach its target.")
        .or(Default("2000"))
        .reaches(Steps)
        .also_called(&["max_steps", "steps", "step_limit"]),
];

pub(super) static PIPELINE: &[Key] = &[
    pipeline("stages", Kind::Stages, "[\"solve\", \"evaluate-indicators\", \"refine-knots\", \"project-displacements\", \"re-equilibrate\"]")
        .means("The stages of one load step: solve alone, with evaluate-indicators to watch, or with refine-knots, \
              project-displacements and re-equilibrate to refine. coarsen-knots at the end takes knots out again where \
              adapt.tolerance allows. switch-branch after solve leaves an unstable equilibrium \
              along its soft mode, down to a stable one; by arc length only at bifurcations, since behind a limit point the \
              unstable path is what is followed.")
        .or(Follows("all five stages where the scene has [adapt], else [\"solve\"]"))
        .reaches(Steps)
        .also_called(&["steps", "stage"]),
];
