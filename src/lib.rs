//! Thin-shell structures that fold, simulated on a mesh that refines itself, as a pipeline of restartable steps.

pub mod adapt;
#[cfg(feature = "cli")]
pub mod cli;
mod digest;
pub mod energy;
pub mod equilibrium;
pub mod history;
pub mod journal;
pub mod model;
pub mod pipeline;
mod printable;
pub mod scene;
pub mod shell;
pub mod spline;
pub mod state;
pub mod study;
mod units;
pub mod view;
mod whole_file;
