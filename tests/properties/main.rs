//! Properties that hold for whatever is put in.

mod corpus;
mod fuzz;
mod journal;
#[path = "../crash/synthetic.rs"]
mod synthetic;
