//! The scene: what the user wrote in TOML, checked, with every default filled in.
//!
//! A [`Scene`] is plain data. Reading one from text is [`parse`]; nothing below this folder
//! ever sees an unchecked value.
//!
//! | file | lives there |
//! |---|---|
//! | `data` | what a scene holds |
//! | `drive` | what drives a run: load or path, and what its parameter is |
//! | `keys`, `key_table` | every key of a scene file, described once, as data |
//! | `kinds` | kinds of tables whose keys that table does not hold, and arrays of tables |
//! | `document`, `entry`, `value` | TOML text and `--set` settings as one list of entries that know their place |
//! | `syntax` | text that is not TOML |
//! | `names` | wrong names |
//! | `meant`, `nearest`, `foreign_unit` | what was meant by a wrong name |
//! | `read` | one entry to one value, within the limits of its key |
//! | `table` | one table whose keys depend on its kind |
//! | `geometries`, `materials`, `load_steps` | tables of such kinds: shells other than tape springs, layers, steps of a load factor |
//! | `nurbs` | surfaces of the user's own |
//! | `supports`, `actions`, `probes`, `places` | arrays of tables, and where their items stand |
//! | `check`, `structure`, `stage_order`, `nearness` | entries to a scene; what must hold between keys, between supports and actions, between stages, between places |
//! | `problem`, `fault` | what can be wrong, and where it stands |
//! | `explain`, `render`, `error` | that in words, with the text underlined, as callers see it |
//! | `identity`, `difference` | hash and differences of scenes; how a difference is shown |
//! | `write`, `write_general` | a scene as TOML |
//! | `help` | the help text |

mod actions;
mod check;
mod data;
mod difference;
mod document;
mod drive;
mod entry;
mod error;
mod explain;
mod fault;
mod foreign_unit;
mod geometries;
mod help;
mod identity;
mod key_table;
mod keys;
mod kinds;
mod load_steps;
mod materials;
mod meant;
mod names;
mod nearest;
mod nearness;
mod nurbs;
mod places;
mod probes;
mod problem;
mod read;
mod render;
mod stage_order;
mod structure;
mod supports;
mod syntax;
mod table;
mod value;
mod write;
mod write_general;

pub use check::{parse, parse_with_settings};
pub use data::{
    Action, ActionKind, Adapt, ArcLength, ArcLengthWord, Axis, Component, Edge, EndRotation, Expectation,
    ExpectedOutcome, ForceVector, FreeWord, Geometry, History, Hold, LengthLimit, Load, LoadSteps, LoadedArea,
    Material, MeshSpec, Motion, NurbsPatch, OrthotropicLaw, Output, ParametricDirection, Place, Ply, Probe, ProbeKind,
    Quadrature, Reaction, Scene, Seam, Sense, Solver, Stage, Support, SurfaceDirection, Symmetry, SyncPolicy,
};
pub use difference::{Difference, shown_values};
pub use drive::{Drive, Parameter};
pub use error::SceneError;
pub use help::help_text;
pub use key_table::{KEYS, SECTIONS};
pub use keys::{Choice, Key, Kind, Limit, Limits, Presence, Reach, Section, Unit};
pub use nurbs::SCENE_BYTES_LIMIT;
pub use problem::{Direction, Problem, StageOrderProblem, SyntaxSlip, ValueType};
