//! What a user sees, pinned by snapshots.

mod again;
mod before;
mod binary;
mod calibrate;
mod compare;
mod export;
mod extremes;
mod folded;
mod pictures;
mod plot;
mod progress;
mod pty;
mod report;
mod stability;
mod stages;
mod structures;
mod study;
mod summary;
mod sweep;
mod synthetic;
mod terminal;
mod widths;

#[path = "../restart/program.rs"]
#[allow(dead_code, reason = "shared with the tests of restarts")]
mod program;
