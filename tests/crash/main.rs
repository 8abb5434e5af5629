//! What happens to processes, disks and files, done to logs and to the running program on purpose.

mod bounds;
#[path = "../fuzz/crafted.rs"]
#[allow(dead_code, reason = "shared with the fuzzing")]
mod crafted;
mod disk;
mod findings;
mod flips;
mod golden;
mod keepers;
mod kill;
mod long;
mod memory;
mod mending;
mod portions;
mod power;
mod resume;
mod shim;
mod signals;
mod stretches;
mod support;
mod synthetic;
mod truncation;
mod viewers;

#[path = "../restart/program.rs"]
#[allow(dead_code, reason = "shared with the tests of restarts")]
mod program;
