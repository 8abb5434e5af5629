//! A run is a function of its scene: the same chain of hashes however it is run, stopped, and continued.

mod bisect;
mod changed;
mod cost;
mod cuts;
mod numerics;
mod own_terms;
mod paths;
mod program;
mod reading;
mod replay;
mod studies;
mod sweeps;
mod thin;
mod threads;

#[path = "../verification/elastic_foundation.rs"]
mod elastic_foundation;
#[path = "../verification/support.rs"]
#[allow(dead_code, reason = "shared with the verification tests")]
mod support;
