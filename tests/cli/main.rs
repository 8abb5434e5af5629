//! What a user sees, pinned by snapshots.

mod binary;
mod folded;
mod pictures;
mod progress;
mod stages;
mod stress;
mod summary;
mod synthetic;
