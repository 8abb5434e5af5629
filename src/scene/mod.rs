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
//! | `document` | TOML text and `--set` settings as one list of entries that know their place |
//! | `syntax` | text that is not TOML |
//! | `names`, `foreign_unit` | wrong names, and what was meant by them |
//! | `read` | one entry to one value, within the limits of its key |
//! | `table`, `general`, `actions` | tables whose keys depend on their kind: geometries, materials, supports, actions, probes |
//! | `nurbs` | surfaces of the user's own |
//! | `check`, `stage_order`, `nearness` | entries to a scene; what must hold between keys, between stages, between places |
//! | `error`, `explain`, `render` | what can be wrong, in words, and with the text underlined |
//! | `identity` | hash and differences of scenes |
//! | `write`, `help` | a scene as TOML; the help text |

mod actions;
mod check;
mod data;
mod document;
mod drive;
mod error;
mod explain;
mod foreign_unit;
mod general;
mod help;
mod identity;
mod key_table;
mod keys;
mod names;
mod nearness;
mod nurbs;
mod read;
mod render;
mod stage_order;
mod syntax;
mod table;
mod write;
mod write_general;

pub use check::{parse, parse_with_settings};
pub use data::{
    Action, ActionKind, Adapt, ArcLength, ArcLengthWord, Axis, Component, Edge, EndRotation, Expectation,
    ExpectedOutcome, ForceVector, FreeWord, Geometry, History, Hold, LengthLimit, Load, LoadSteps, LoadedArea,
    Material, MeshSpec, Motion, NurbsPatch, OrthotropicLaw, Output, ParametricDirection, Place, Ply, Probe, ProbeKind,
    Quadrature, Reaction, Scene, Seam, Sense, Solver, Stage, Support, SurfaceDirection, Symmetry, SyncPolicy,
};
pub use drive::{Drive, Parameter};
pub use error::{Direction, Problem, SceneError, StageOrderProblem, SyntaxSlip, ValueType};
pub use help::help_text;
pub use identity::{Difference, Reach, shown_values};
pub use key_table::{KEYS, SECTIONS};
pub use keys::{Choice, Key, Kind, Limit, Limits, Presence, Section, Unit};
pub use nurbs::SCENE_BYTES_LIMIT;
