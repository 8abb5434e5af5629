//! Thin-shell structures that fold, simulated on a mesh that refines itself, as a pipeline of restartable steps.

pub mod cli;
pub mod pipeline;
pub mod scene;
pub mod state;
pub mod study;
mod units;
pub mod view;
