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

mod axis;
mod curve;
mod legend;
mod line;
mod moment_rotation;
mod quantity;
mod run;
mod style;

pub use curve::{curve_plot, load_probe};
pub use moment_rotation::moment_rotation_plot;
pub use quantity::{Quantity, quantities_of, quantity_named};
pub use run::PlottedRun;

use plotters::drawing::DrawingAreaErrorKind;

/// Why a plot could not be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// The records hold no equilibrium yet.
    #[error("there is no equilibrium to plot: the run has not finished its first load step")]
    NoEquilibrium,
    /// No moment over rotation.
    #[error("only a shell whose ends turn has a moment to plot over a rotation")]
    NoMoment,
    /// A number that no picture can show: axes would never be done with their marks.
    #[error(
        "{value} at load step {step} is too large to draw, or no number: `foldline verify` reports whether the log holds it"
    )]
    NotDrawable {
        /// Load step of the report.
        step: u64,
        /// The number.
        value: f64,
    },
    /// No equilibrium has both quantities.
    #[error("no equilibrium of {run} has both {x} and {y}: draw another quantity")]
    NothingInCommon {
        /// Name of the run.
        run: String,
        /// Name of the quantity to the right.
        x: String,
        /// Name of the quantity upwards.
        y: String,
    },
    /// Probes of one name that measure in different units.
    #[error("`{quantity}` is in {} in one run and in {} in another: draw them apart", units[0], units[1])]
    Units {
        /// Name of the quantity.
        quantity: String,
        /// Both units.
        units: [String; 2],
    },
    /// The drawing library gave up.
    #[error("the plot could not be drawn: {0}")]
    Drawing(String),
}

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for PlotError {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        PlotError::Drawing(error.to_string())
    }
}
