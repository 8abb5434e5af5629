//! Axes: a range that shows all values and wastes little, with round numbers.

use plotters::chart::ChartContext;
use plotters::coord::cartesian::Cartesian2d;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::prelude::SVGBackend;
use plotters::style::WHITE;

use super::PlotError;
use super::style::{GRID, INK, PX, line, text};
use crate::printable::one_line;
use crate::view::ticks::{in_view, labelled_ticks};

/// Room beyond the outermost values, relative to the range.
const MARGIN: f64 = 0.04;
/// Round numbers wanted on an axis.
const MARKS: usize = 7;
/// Shortest range, relative to its values: below, they differ by rounding.
const SHORTEST: f64 = 1e-12;

/// A linear axis with its marks.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    low: f64,
    high: f64,
    marks: Vec<(f64, String)>,
}

pub(super) type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Axis, Axis>>;

impl Axis {
    /// An axis that shows all of these values.
    pub(super) fn showing(values: impl Iterator<Item = f64>) -> Self {
        let [least, largest] =
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
        let size = least.abs().max(largest.abs());
        let [low, high] = match largest - least > SHORTEST * size {
            true => in_view([least, largest]),
            false if size > 0.0 => [least - MARGIN * size, largest + MARGIN * size],
            false => [0.0, 1.0],
        };
        // No value is beyond an end at 0.
        let beyond = |end: f64| if end == 0.0 { 0.0 } else { MARGIN * (high - low) };
        let [low, high] = [low - beyond(low), high + beyond(high)];
        Self { low, high, marks: labelled_ticks([low, high], MARKS) }
    }

    /// An axis of logarithms to base 2, labelled at every power of two, or every second, third, …, so that they fit.
    pub(super) fn powers_of_two(low: f64, high: f64) -> Self {
        const MOST_LABELS: f64 = 5.0;
        let stride = ((high - low) / MOST_LABELS).ceil().max(1.0) as usize;
        let powers = (low as i32..=high as i32).step_by(stride).map(f64::from);
        Self { low, high, marks: powers.map(|power| (power, format!("{}", power.exp2()))).collect() }
    }

    pub(super) fn ends(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// The place of a value between the ends, from 0 to 1.
    pub(super) fn fraction(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    fn label(&self, value: f64) -> String {
        self.marks.iter().find(|mark| mark.0 == value).map(|mark| mark.1.clone()).unwrap_or_default()
    }
}

impl Ranged for Axis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        from + (self.fraction(*value) * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.marks.iter().map(|mark| mark.0).collect()
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.low..self.high
    }
}

/// Draws the axes with a grid; `along` labels the lower one, if anything does.
pub(super) fn draw_axes(
    chart: &mut Chart,
    [x, y]: [&Axis; 2],
    along: Option<&str>,
    upwards: &str,
) -> Result<(), PlotError> {
    let mut mesh = chart.configure_mesh();
    if let Some(along) = along {
        mesh.x_desc(one_line(along));
    }
    mesh.y_desc(one_line(upwards))
        .x_label_formatter(&|value| x.label(*value))
        .y_label_formatter(&|value| y.label(*value))
        .label_style(text(14))
        .axis_desc_style(text(15))
        .axis_style(line(INK, 1))
        .bold_line_style(line(GRID, 1))
        .set_all_tick_mark_size(5 * PX)
        .light_line_style(line(WHITE, 1))
        .draw()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(values: &[f64]) -> [f64; 2] {
        Axis::showing(values.iter().copied()).ends()
    }

    #[test]
    fn values_of_one_sign_have_zero_at_an_end() {
        assert_eq!(ends(&[0.3, 10.0])[0], 0.0);
        assert_eq!(ends(&[-37.0, -0.1])[1], 0.0);
        let [low, high] = ends(&[-1.0, 3.0]);
        assert!(low < -1.0 && high > 3.0);
    }

    #[test]
    fn no_value_is_cut_off_and_no_axis_is_half_empty() {
        for values in [[99.0, 100.0], [-1e-9, -0.9e-9], [5.0, 5.0], [0.0, 0.0], [-7.0, 1e12], [-1e25, 1e28]] {
            let [low, high] = ends(&values);
            let [least, largest] = values;
            assert!(low <= least && largest <= high && low < high, "{values:?}: {low} to {high}");
            if largest > least {
                assert!(largest - least >= 0.45 * (high - low), "{values:?}: {low} to {high}");
            }
        }
    }
}
