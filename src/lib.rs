//! Thin-shell structures that fold, simulated on a mesh that refines itself, as a pipeline of restartable steps.

pub mod journal;
pub mod pipeline;
pub mod scene;
pub mod state;
