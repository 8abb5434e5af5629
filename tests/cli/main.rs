//! What a user sees, pinned by snapshots.

mod folded;
mod pictures;
mod progress;
mod stages;
mod summary;
mod synthetic;
