//! Why a plot could not be drawn.

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
