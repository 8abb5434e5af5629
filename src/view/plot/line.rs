//! A run as a line: stable stretches without gaps, unstable ones dashed, jumps dotted, critical points marked.

use plotters::element::{Circle, Cross};
use plotters::series::{DashedLineSeries, LineSeries};
use plotters::style::Color;

use super::axis::Chart;
use super::run::PlottedPoint;
use super::style::{PX, Pen, line};
use super::{PlotError, Quantity};
use crate::record::CriticalPoint;

/// Pixels of dashes and gaps of unstable stretches, and of jumps.
pub(super) const UNSTABLE: [u32; 2] = [5, 4];
pub(super) const JUMP: [u32; 2] = [2, 4];
/// Radius of marks of critical points, pixels.
pub(super) const MARK: u32 = 5;
const DOT: u32 = 2;
/// Gap between the dashes of stable stretches, pixels.
pub(super) const GAP: u32 = 4;

/// Largest number that is drawn.
const LARGEST: f64 = 1e30;

/// A run in a chart.
#[derive(Clone, Debug)]
pub(super) struct RunLine {
    pub(super) name: String,
    pub(super) pen: Pen,
    pub(super) points: Vec<LinePoint>,
}

/// How two neighbouring points are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Joint {
    /// Both are stable.
    Stable,
    /// Either of them is not.
    Unstable,
    /// The shell jumped from one to the other: that is no path.
    Jump,
}

impl RunLine {
    /// How points are joined with the one before.
    pub(super) fn joints(&self) -> Vec<Joint> {
        let joint = |pair: &[LinePoint]| match pair[1].jumped {
            true => Joint::Jump,
            false if pair.iter().all(|point| point.is_stable) => Joint::Stable,
            false => Joint::Unstable,
        };
        self.points.windows(2).map(joint).collect()
    }

    /// Points of the critical points that it passed: limit points, or bifurcations.
    pub(super) fn critical(&self, limit_point: bool) -> impl Iterator<Item = (f64, f64)> + '_ {
        let is_such = move |point: &&LinePoint| point.passed.is_some_and(|passed| passed.limit_point == limit_point);
        self.points.iter().filter(is_such).map(|point| point.at)
    }

    pub(super) fn draw(&self, chart: &mut Chart) -> Result<(), PlotError> {
        let joints = self.joints();
        let mut from = 0;
        while from < joints.len() {
            let kind = joints[from];
            let alike = joints[from..].iter().take_while(|joint| **joint == kind).count();
            // A jump ends where it lands; another may begin there.
            let to = from + if kind == Joint::Jump { 1 } else { alike };
            self.draw_stretch(chart, kind, self.points[from..=to].iter().map(|point| point.at).collect())?;
            from = to;
        }
        let Pen { colour, event, .. } = self.pen;
        let dot =
            |point: &LinePoint| Circle::new(point.at, DOT * PX, if point.is_stable { colour } else { event }.filled());
        chart.draw_series(self.points.iter().filter(|point| !point.is_start).map(dot))?;
        chart.draw_series(self.critical(true).map(|at| Circle::new(at, MARK * PX, line(event, 2))))?;
        chart.draw_series(self.critical(false).map(|at| Cross::new(at, MARK * PX, line(event, 2))))?;
        Ok(())
    }

    fn draw_stretch(&self, chart: &mut Chart, kind: Joint, points: Vec<(f64, f64)>) -> Result<(), PlotError> {
        let Pen { colour, event, dash, width } = self.pen;
        let ([dash, gap], style) = match (kind, dash) {
            (Joint::Stable, None) => {
                chart.draw_series(LineSeries::new(points, line(colour, width)))?;
                return Ok(());
            }
            (Joint::Stable, Some(dash)) => ([dash, GAP], line(colour, width)),
            (Joint::Unstable, _) => (UNSTABLE, line(event, width)),
            (Joint::Jump, _) => (JUMP, line(event, 1)),
        };
        chart.draw_series(DashedLineSeries::new(points, dash * PX, gap * PX, style))?;
        Ok(())
    }
}

/// A point of a line in a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LinePoint {
    pub(super) at: (f64, f64),
    /// Whether it is the unloaded shell, which is no equilibrium that was computed.
    pub(super) is_start: bool,
    pub(super) is_stable: bool,
    /// Whether the shell jumped to get here.
    pub(super) jumped: bool,
    pub(super) passed: Option<CriticalPoint>,
}

/// One quantity over another at the equilibria that have both, from the unloaded shell on where both are known there.
///
/// # Errors
/// Where no equilibrium has both, or a value cannot be drawn.
pub(super) fn line_points(
    run: &str,
    points: &[PlottedPoint],
    x: &Quantity,
    y: &Quantity,
) -> Result<Vec<LinePoint>, PlotError> {
    let start = x.at_rest().zip(y.at_rest()).map(|at| LinePoint {
        at,
        is_start: true,
        is_stable: true,
        jumped: false,
        passed: None,
    });
    let mut line: Vec<LinePoint> = start.into_iter().collect();
    for point in points {
        let Some(at) = x.value(point).zip(y.value(point)) else { continue };
        if let Some(value) = [at.0, at.1].into_iter().find(|value| value.is_nan() || value.abs() > LARGEST) {
            return Err(PlotError::NotDrawable { step: point.report.step, value });
        }
        let is_stable = point.report.negative_pivots == 0;
        line.push(LinePoint { at, is_start: false, is_stable, jumped: point.jumped, passed: point.passed });
    }
    match line.iter().all(|point| point.is_start) {
        true => Err(PlotError::NothingInCommon { run: run.to_owned(), x: x.name.clone(), y: y.name.clone() }),
        false => Ok(line),
    }
}
