//! What a user sees, pinned by snapshots.

mod progress;
mod stages;
mod summary;
mod synthetic;
