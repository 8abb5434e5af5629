//! The command line: one file per subcommand, nothing but arguments and printing.

mod json_line;
mod load_step;
mod progress;
mod stage_table;

pub use json_line::json_line;
pub use progress::{Manner, Shown};
pub use stage_table::{stage_table, step_in_full};
