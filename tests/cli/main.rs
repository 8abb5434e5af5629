//! What a user sees, pinned by snapshots.

mod summary;
mod synthetic;
