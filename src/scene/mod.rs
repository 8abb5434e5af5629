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
//! | `document`, `entry`, `value` | TOML text and `--set` settings as tables of entries that know their place |
//! | `syntax` | text that is not TOML |
//! | `names` | wrong names |
//! | `meant`, `nearest`, `foreign_unit` | what was meant by a wrong name |
//! | `read`, `regions` | one entry to one value, within the limits of its key |
//! | `table`, `tables` | one table, and all of them, with every default filled in |
//! | `shells`, `connections` | the shells of a structure, and what connects them |
//! | `imperfections`, `offset_grid` | where their surfaces differ from the perfect ones |
//! | `geometries`, `nurbs`, `profiles`, `materials`, `supports`, `actions`, `histories`, `probes` | tables to data, and what must hold between their keys |
//! | `sections` | springs and masses on rigid sections |
//! | `meshes` | the mesh that a run starts with, and how it is refined |
//! | `check`, `structure`, `stage_order`, `nearness` | tables to a scene; what must hold between tables, between supports and actions, between stages, between places |
//! | `problem`, `fault` | what can be wrong, and where |
//! | `explain`, `render`, `error` | that in words, with the text underlined, as callers see it |
//! | `refused` | a refusal of later steps, with the tables that it is about |
//! | `identity`, `difference` | hash and differences of scenes; how a difference is shown |
//! | `write` | a scene as TOML |
//! | `help`, `schema` | the help text; a schema for editors |
//! | `new_key` | a test: what follows from a key that is added |

mod actions;
mod check;
mod connections;
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
mod histories;
mod identity;
mod imperfections;
mod key_table;
mod keys;
mod materials;
mod meant;
mod meshes;
mod names;
mod nearest;
mod nearness;
#[cfg(test)]
mod new_key;
mod nurbs;
mod offset_grid;
mod probes;
mod problem;
mod profiles;
mod read;
mod refused;
mod regions;
mod render;
mod schema;
mod sections;
mod shells;
mod stage_order;
mod structure;
mod supports;
mod syntax;
mod table;
mod tables;
mod value;
mod write;

pub use check::{parse, parse_with_settings};
pub use data::{
    Action, ActionKind, Adapt, ArcLength, ArcLengthWord, Axis, Bond, Component, Edge, EndRotation, Expectation,
    ExpectedOutcome, ForceVector, FreeWord, Geometry, History, Hold, Imperfection, ImperfectionKind, Indicator, Joint,
    JointKind, LengthLimit, Load, LoadSteps, LoadedArea, Material, MeshSpec, Motion, NumbersIn, NurbsPatch, OffsetGrid,
    OrthotropicLaw, Output, ParametricDirection, Ply, PointMass, Pose, Probe, ProbeKind, ProfilePiece, Quadrature,
    Reaction, Region, Scene, Seam, SectionTurns, Sense, Shell, ShellEdge, Solver, Splitting, Spring, Stage, Strengths,
    Support, SurfaceDirection, Symmetry, SyncPolicy,
};
pub use difference::Difference;
pub(crate) use difference::shown_values;
pub use drive::{Drive, Parameter};
pub use error::SceneError;
pub use help::{help_on_topic, help_text, help_topics};
pub use key_table::{SECTIONS, all_keys};
pub use keys::{Choice, Form, Key, Kind, Length, Limit, Limits, Presence, Reach, Section, Unit};
pub use nurbs::SCENE_BYTES_LIMIT;
pub use problem::{Direction, Problem, StageOrderProblem, SyntaxSlip, ValueType};
pub use refused::tables_refused;
pub use schema::json_schema;
