//! What happens to processes, disks and files, done to logs on purpose.

mod support;
mod synthetic;
mod truncation;
