//! Properties that hold for whatever is put in.

mod fuzz;
mod journal;
#[path = "../crash/synthetic.rs"]
mod synthetic;
