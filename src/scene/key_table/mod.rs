//! Every key of a scene file. Nothing about a key is written down anywhere else.
//!
//! | file | tables |
//! |---|---|
//! | `shell` | what the shell is |
//! | `run` | what is done with it |
//! | `output` | what is written of it, and how it is to end |

mod output;
mod run;
mod shell;

pub(super) use output::*;
pub(super) use run::*;
pub(super) use shell::*;

use super::keys::{Key, Section};

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
    section("expect", false, "How the run is to end; `foldline extremes` alone looks at it."),
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
