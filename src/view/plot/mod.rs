//! Curves of runs as SVG: moment over rotation, or any quantity over any, of one run or of several.
//!
//! | file | what |
//! |---|---|
//! | `quantity` | what can be drawn of a run, with names and units |
//! | `run` | a run as it is drawn: the equilibria of its path, with what the run had spent by then |
//! | `style` | sizes, fonts, colours |
//! | `axis` | ranges and round numbers |
//! | `line` | a run as a line, with jumps, unstable stretches and critical points |
//! | `legend` | what the lines are, where it covers none of them |
//! | `curve` | any quantity over any |
//! | `moment_rotation` | moment over rotation, with closed-form laws and the size of the mesh |
//! | `error` | why a plot could not be drawn |

mod axis;
mod curve;
mod error;
mod legend;
mod line;
mod moment_rotation;
mod quantity;
mod run;
mod style;

pub use curve::{curve_plot, load_probe};
pub use error::PlotError;
pub use moment_rotation::moment_rotation_plot;
pub use quantity::{Quantity, quantities_of, quantity_named};
pub use run::PlottedRun;
