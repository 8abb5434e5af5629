//! A sampled surface: what pictures are drawn from, whatever made it.

use crate::spline::Grid;

/// Surfaces as grids of points with a value for each cell, and lines upon them.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceSamples {
    /// Number of points of each grid in each direction; points and cells of one grid follow those of the other.
    pub(super) grids: Vec<[usize; 2]>,
    pub(super) points: Vec<[f64; 3]>,
    pub(super) cell_values: Vec<f64>,
    pub(super) knot_lines: Vec<Vec<[f64; 3]>>,
    pub(super) quantity: String,
}

/// Why samples do not make a surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SamplesError {
    /// Fewer than 2 points one way.
    #[error("a surface needs 2 points each way, not {} × {}", counts[0], counts[1])]
    TooFewPoints {
        /// Number of points in each direction.
        counts: [usize; 2],
    },
    /// A buffer does not fit the counts.
    #[error("a surface of {} × {} points has {expected} {what}, not {found}", counts[0], counts[1])]
    Length {
        /// Name of the buffer.
        what: &'static str,
        /// Number of points in each direction.
        counts: [usize; 2],
        /// The length that fits the counts.
        expected: usize,
        /// The length of the buffer.
        found: usize,
    },
    /// A coordinate that is infinite or not a number.
    #[error("point {index} of the {what} is not finite")]
    NotFinite {
        /// Name of the quantity.
        what: &'static str,
        /// Index in its buffer.
        index: usize,
    },
}

impl SurfaceSamples {
    /// Number of points of a grid.
    pub fn points_len(counts: [usize; 2]) -> usize {
        Grid::new(counts).len()
    }

    /// Number of cells of a grid.
    pub fn cell_values_len(counts: [usize; 2]) -> usize {
        cells_of(counts).len()
    }

    /// Creates a surface of `counts` points in each direction, at least 2. `points` are in mm, the second direction
    /// fastest (index = i₁ · n₂ + i₂); `cell_values` likewise with n − 1 cells in each direction, and NaN where there
    /// is no value; `knot_lines` are polylines on the surface, mm. `quantity` names the values, with their unit.
    ///
    /// # Errors
    /// Where the lengths do not fit each other, or a coordinate is not finite.
    pub fn new(
        counts: [usize; 2],
        points: Vec<[f64; 3]>,
        cell_values: Vec<f64>,
        knot_lines: Vec<Vec<[f64; 3]>>,
        quantity: &str,
    ) -> Result<Self, SamplesError> {
        if counts[0] < 2 || counts[1] < 2 {
            return Err(SamplesError::TooFewPoints { counts });
        }
        let fits = |what, found, expected| {
            if found == expected { Ok(()) } else { Err(SamplesError::Length { what, counts, expected, found }) }
        };
        fits("points", points.len(), Self::points_len(counts))?;
        fits("cell values", cell_values.len(), Self::cell_values_len(counts))?;
        let broken = |point: &[f64; 3]| point.iter().any(|coordinate| !coordinate.is_finite());
        if let Some(index) = points.iter().position(broken) {
            return Err(SamplesError::NotFinite { what: "surface", index });
        }
        if let Some(index) = knot_lines.iter().flatten().position(broken) {
            return Err(SamplesError::NotFinite { what: "knot lines", index });
        }
        Ok(Self { grids: vec![counts], points, cell_values, knot_lines, quantity: quantity.to_string() })
    }

    /// Point indices of the corners of every cell, around it, in the order of the cell values.
    pub(super) fn cells(&self) -> impl Iterator<Item = [usize; 4]> {
        let mut first = 0;
        self.grids.iter().flat_map(move |counts| {
            let (points, cells) = (Grid::new(*counts), cells_of(*counts));
            let from = first;
            first += points.len();
            (0..cells.len()).map(move |cell| {
                let [i, j] = cells.place(cell);
                [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(|corner| from + points.index(corner))
            })
        })
    }

    /// Puts the surfaces of several shells together, which show the same quantity; `None` without any.
    pub(super) fn joined(parts: impl IntoIterator<Item = Self>) -> Option<Self> {
        parts.into_iter().reduce(|mut all, part| {
            all.grids.extend(part.grids);
            all.points.extend(part.points);
            all.cell_values.extend(part.cell_values);
            all.knot_lines.extend(part.knot_lines);
            all
        })
    }

    /// Least and largest value; `None` where there is none.
    pub(super) fn value_range(&self) -> Option<[f64; 2]> {
        let finite = || self.cell_values.iter().copied().filter(|value| value.is_finite());
        Some([finite().reduce(f64::min)?, finite().reduce(f64::max)?])
    }
}

/// The cells between the points of a grid.
pub(super) fn cells_of(counts: [usize; 2]) -> Grid {
    Grid::new(counts.map(|count| count.saturating_sub(1)))
}

/// Least and largest value, without those that are no numbers; 0 where there is none, as JSON has no number for that.
pub(super) fn number_range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = values.fold([f64::NAN; 2], |[low, high], value| [low.min(value), high.max(value)]);
    if low.is_nan() { [0.0; 2] } else { [low, high] }
}
