//! Properties that hold for whatever is put in.

mod journal;
#[path = "../crash/synthetic.rs"]
mod synthetic;
