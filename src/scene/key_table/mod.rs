//! Every key of a scene file: its type, unit, limits, default, meaning and reach are given here alone, and parser, errors, hints,
//! help, schema and identity follow from them. What a value does is in the data of a scene, in `check` where it depends on other
//! keys, and in `write` where it is not written as it is read.
//!
//! | file | tables |
//! |---|---|
//! | `geometry`, `material` | what the shell is |
//! | `shells` | several shells, and what connects them |
//! | `sections` | springs and masses on rigid sections |
//! | `imperfections` | where the surfaces differ from the perfect ones |
//! | `structure` | what holds it, what acts on it, what is measured |
//! | `mesh`, `run` | how it is made discrete and solved |
//! | `output` | what is written of it, and how it is to end |

mod geometry;
mod imperfections;
mod material;
mod mesh;
mod output;
mod run;
mod sections;
mod shells;
mod structure;

use super::keys::{Key, Section};

/// The tables of a scene file, in the order in which they are usually written.
pub static SECTIONS: &[Section] = &[
    one("geometry", true, "The undeformed mid-surface.", geometry::GEOMETRY),
    one("material", true, "Constitutive law and thickness.", material::MATERIAL),
    many("ply", "A layer of a laminate, from bottom (the side that n points away from) to top.", material::PLY),
    one("mesh", false, "Spline space and quadrature that the run starts with.", mesh::MESH),
    many(
        "shell",
        "A shell of a structure of several. Its surface, material and mesh are tables below it: [shell.geometry], [shell.material], \
         [[shell.ply]], [shell.mesh], with the keys of [geometry] and so on; shells without a material or a mesh of their own \
         have those of [material], [[ply]] and [mesh].",
        shells::SHELL,
    ),
    many("joint", "What joins two shells of a structure along an edge of each.", shells::JOINT),
    many("bond", "What glues two shells of a structure together over an area.", shells::BOND),
    many(
        "imperfection",
        "Where the undeformed surfaces differ from the perfect ones that the scene describes; several add up. What else the scene \
         says is of the perfect ones.",
        imperfections::IMPERFECTION,
    ),
    one("symmetry", false, "Which part of the shell is modelled.", mesh::SYMMETRY),
    one("load", true, "What moves the shell.", run::LOAD),
    many("support", "What holds the shell, where [load] is of kind \"steps\"; at least one.", structure::SUPPORT),
    many(
        "spring",
        "A spring between a rigid section and the ground, free of force while the section is not moved.",
        sections::SPRING,
    ),
    many(
        "mass",
        "A point mass on a rigid section, which moves with it: it has weight where there is gravity.",
        sections::MASS,
    ),
    many(
        "action",
        "What acts, where [load] is of kind \"steps\", which needs an action or a support's motion that is not zero.",
        structure::ACTION,
    ),
    many(
        "probe",
        "A quantity that every equilibrium reports by name (foldline run, inspect, inspect --json).",
        structure::PROBE,
    ),
    one("adapt", false, "When and how far the mesh is refined.", mesh::ADAPT),
    one("solver", false, "Tolerances and limits of the equilibrium solver.", run::SOLVER),
    one("continuation", false, "How the path of equilibria is followed.", run::CONTINUATION),
    one("pipeline", false, "The stages of one load step.", run::PIPELINE),
    one("output", false, "Which outputs are written besides the states; they never change a state.", output::OUTPUT),
    one("expect", false, "How the run is to end; `foldline extremes` alone looks at it.", output::EXPECT),
];

/// The tables of a scene that each shell of a structure has of its own, or from the scene; they are the first of
/// [`SECTIONS`].
pub(super) static OF_A_SHELL: [&str; 4] = ["geometry", "material", "ply", "mesh"];

/// The keys of a scene file, table by table. A name occurs once for each kind of table that has its own key of that
/// name.
pub fn all_keys() -> impl Iterator<Item = &'static Key> + Clone {
    SECTIONS.iter().flat_map(|section| section.keys)
}

const fn one(name: &'static str, required: bool, meaning: &'static str, keys: &'static [Key]) -> Section {
    Section { name, many: false, required, meaning, keys }
}

const fn many(name: &'static str, meaning: &'static str, keys: &'static [Key]) -> Section {
    Section { name, many: true, required: false, meaning, keys }
}
