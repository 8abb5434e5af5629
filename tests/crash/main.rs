//! What happens to processes, disks and files, done to logs on purpose.

mod findings;
mod flips;
mod golden;
mod memory;
mod power;
mod resume;
mod support;
mod synthetic;
mod truncation;
mod viewers;
