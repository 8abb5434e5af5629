//! Thin-shell structures that fold, simulated on a mesh that refines itself, as a pipeline of restartable steps.
//!
//! [`guide`] has pages to read: a tutorial, the theory, the format of a log.
//!
//! # The pieces
//!
//! A [`scene`] describes what is simulated: a shell, its material, supports, loads and settings, as TOML. [`Stages`](pipeline::Stages) runs
//! one stage after another (solve, evaluate indicators, refine knots, project displacements, re-equilibrate), each from one
//! [`State`](state::State) to the next; a state is plain data, all that decides the future of the run. [`Run`](pipeline::Run) is the loop
//! around them, and hands every stage to a [`Sink`](record::Sink): in memory, or the [`journal`], an MCAP log that survives kills
//! and is continued to the same bits.
//!
//! | module | what |
//! |---|---|
//! | [`scene`] | scenes: parsed, checked, written again, compared |
//! | [`spline`], [`shell`], [`model`] | NURBS surfaces; the energy of a point; a scene made discrete |
//! | [`energy`] | energy terms (the shell, loads, one's own) and their balance |
//! | [`equilibrium`] | Newton's method, stability, paths by arc length |
//! | [`adapt`] | where the mesh is refined |
//! | [`pipeline`], [`record`], [`state`] | stages and the loop; what is kept of them, and sinks; what a checkpoint holds |
//! | [`journal`], [`history`] | logs; continuing, replaying and bisecting them |
//! | [`study`], [`sweep`], [`view`] | error against run time; tables over designs; pictures |
//!
//! # What stays
//!
//! Programs can rely on what the examples use: [`scene::parse`] and the data of a [`Scene`](scene::Scene),
//! [`Stages`](pipeline::Stages), [`Run`](pipeline::Run) and all of [`record`], [`State`](state::State), the logs of [`journal`], the
//! questions of [`history`], and the terms of [`energy`]. The numerics ([`spline`], [`shell`], [`model`], [`equilibrium`], [`adapt`]),
//! the suites ([`study`]) and the pictures ([`view`]) are public for the program and its tests, and may change with any version.
//!
//! # A scene in memory
//!
//! A strip that is clamped at one end bends under a force at the other, as a beam does: w = F L³ / (3 E I).
//!
//! ```
//! use foldline::pipeline::{Run, Stages};
//! use foldline::record::MemorySink;
//! use foldline::scene::parse;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let scene = r#"
//!     geometry = { kind = "plate", length_mm = 100.0, width_mm = 10.0 }
//!     material = { kind = "isotropic", youngs_modulus_mpa = 70e3, poissons_ratio = 0.0, thickness_mm = 1.0 }
//!     mesh = { elements = [8, 1] }
//!     load = { kind = "steps", increment = 1.0 }
//!     support = [{ on = "u-start", kind = "clamped" }]
//!     action = [{ kind = "line-force", on = "u-end", force_n_per_mm = [0.0, 0.0, 1e-3] }]
//!     probe = [{ name = "tip", kind = "displacement", on = [1.0, 0.5], component = "z" }]
//! "#;
//! let mut stages = Stages::new(parse(scene, "cantilever.toml")?);
//! let start = stages.start()?;
//! let mut sink = MemorySink::default();
//! Run::new(stages, start, None).to_end(None, &|| false, &mut sink)?;
//! let (_, record) = sink.stages.last().ok_or("no stage was run")?;
//! let deflection = 0.01 * 100_f64.powi(3) / (3.0 * 70e3 * 10.0 / 12.0);
//! assert!((record.report.probes[0].value / deflection - 1.0).abs() < 1e-3);
//! # Ok(())
//! # }
//! ```
//!
//! More examples are in `tests/examples/`: `run_scene`, `read_log`, `own_sink` (a sink of one's own) and `own_term` (an energy term of
//! one's own).
//!
//! # Features
//!
//! `cli`, on by default, is the program; `pictures`, a part of it, draws curves. Without them the library builds without clap,
//! indicatif and plotters:
//!
//! ```toml
//! foldline = { version = "0.1", default-features = false }
//! ```

pub mod adapt;
#[cfg(feature = "cli")]
pub mod cli;
mod digest;
pub mod energy;
pub mod equilibrium;
pub mod guide;
pub mod history;
pub mod journal;
pub mod model;
pub mod pipeline;
mod platform;
mod printable;
pub mod record;
pub mod scene;
pub mod shell;
pub mod spline;
pub mod state;
pub mod study;
pub mod sweep;
mod units;
pub mod view;
mod whole_file;
