//! The moment–rotation curve of a run with Wuest's law, with the size of the mesh below it.

use plotters::chart::{ChartBuilder, ChartContext, SeriesLabelPosition};
use plotters::coord::Shift;
use plotters::coord::cartesian::Cartesian2d;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::element::{Circle, Cross, DashedPathElement, PathElement, Text};
use plotters::prelude::SVGBackend;
use plotters::series::{DashedLineSeries, LineSeries};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, IntoFont, RGBColor, ShapeStyle, TextStyle, WHITE};

use crate::printable::one_line;
use crate::record::Record;
use crate::scene::Scene;
use crate::study::{PathPoint, TapeSpring, equilibrium_path, snaps};

/// Why a plot could not be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// The records hold no equilibrium yet.
    #[error("there is no equilibrium to plot: the run has not finished its first load step")]
    NoEquilibrium,
    /// No moment over rotation.
    #[error("only a tape spring whose ends turn has a moment to plot over a rotation")]
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
    /// The drawing library gave up.
    #[error("the plot could not be drawn: {0}")]
    Drawing(String),
}

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for PlotError {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        PlotError::Drawing(error.to_string())
    }
}

/// Largest number that is drawn, and shortest axis.
const LARGEST: f64 = 1e30;
const SHORTEST: f64 = 1e-12;

/// Units of the drawing in a pixel: it is drawn in whole ones, and a curve in whole pixels wobbles.
const PX: u32 = 20;
const SIZE: (u32, u32) = (1000 * PX, 760 * PX);
const UPPER_HEIGHT: u32 = 500 * PX;
const LEFT: u32 = 70 * PX;
const FONT: &str = "DejaVu Sans, Helvetica, Arial, sans-serif";

const INK: RGBColor = RGBColor(0x1a, 0x1a, 0x1a);
const GRID: RGBColor = RGBColor(0xe4, 0xe4, 0xe4);
const MEASURED: RGBColor = RGBColor(0x31, 0x68, 0x8e);
const LAW: RGBColor = RGBColor(0x8a, 0x8a, 0x8a);
const PLATEAU: RGBColor = RGBColor(0xd9, 0x7a, 0x1c);
const SNAP: RGBColor = RGBColor(0xb7, 0x37, 0x79);

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Plots the curve of `records`, a run of `scene`, as SVG text: measured moment, Wuest's law for uniform curvature
/// (dashed), the equal-energy plateau, the jumps; below, elements of the model on a logarithmic axis. `title` is
/// printed on top.
///
/// # Errors
/// Where there is no equilibrium yet.
pub fn moment_rotation_plot(scene: &Scene, records: &[Record], title: &str) -> Result<String, PlotError> {
    drawable(records)?;
    let path = equilibrium_path(records);
    let last = path.last().ok_or(PlotError::NoEquilibrium)?;
    let end_deg = path.iter().map(|point| point.parameter).fold(last.parameter, f64::max).max(SHORTEST) * 1.02;
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        let (upper, lower) = root.split_vertically(UPPER_HEIGHT);
        draw_moment(&upper, scene, records, &path, end_deg, title)?;
        draw_elements(&lower, &path, end_deg)?;
        root.present()?;
    }
    Ok(in_pixels(&svg, SIZE))
}

/// Refuses numbers that have no place on an axis.
fn drawable(records: &[Record]) -> Result<(), PlotError> {
    let numbers = records.iter().flat_map(|record| {
        let report = &record.report;
        let own = [report.parameter, report.attempted_parameter, report.moment_n_mm, report.strain_energy_n_mm];
        let probe = report.probes.first().map(|probe| probe.value);
        own.into_iter().chain(probe).map(|value| (report.step, value))
    });
    match numbers.into_iter().find(|(_, value)| value.is_nan() || value.abs() > LARGEST) {
        Some((step, value)) => Err(PlotError::NotDrawable { step, value }),
        None => Ok(()),
    }
}

fn draw_moment(
    area: &Area,
    scene: &Scene,
    records: &[Record],
    path: &[PathPoint],
    end_deg: f64,
    title: &str,
) -> Result<(), PlotError> {
    let spring = TapeSpring::of_scene(scene).ok_or(PlotError::NoMoment)?;
    let law: Vec<(f64, f64)> = (0..=400)
        .map(|i| f64::from(i) / 400.0 * end_deg)
        .map(|parameter| (parameter, spring.moment_at_rotation(parameter)))
        .collect();
    let measured = std::iter::once((0.0, 0.0)).chain(path.iter().map(|point| (point.parameter, point.moment_n_mm)));
    let measured: Vec<(f64, f64)> = measured.collect();
    let highest = measured.iter().chain(&law).map(|point| point.1).fold(SHORTEST, f64::max);
    let lowest = measured.iter().map(|point| point.1).fold(0.0, f64::min);

    let mut chart = ChartBuilder::on(area)
        .caption(one_line(title), text(19))
        .margin(16 * PX)
        .margin_right(28 * PX)
        .x_label_area_size(28 * PX)
        .y_label_area_size(LEFT)
        .build_cartesian_2d(0.0..end_deg, 1.08 * lowest..1.08 * highest)?;
    draw_axes(&mut chart, None, "end moment M (N·mm)")?;

    let dashes = DashedLineSeries::new(law.clone(), 7 * PX, 5 * PX, line(LAW, 2));
    chart
        .draw_series(dashes)?
        .label("Wuest 1954, uniform curvature")
        .legend(|(x, y)| DashedPathElement::new([(x, y), (x + 22 * PX as i32, y)], 7 * PX, 5 * PX, line(LAW, 2)));
    if let Some(plateau) = spring.plateau() {
        let level = plateau.moment_n_mm;
        chart
            .draw_series(LineSeries::new([(0.0, level), (end_deg, level)], line(PLATEAU, 2)))?
            .label(format!("equal-energy plateau, {level:.2} N·mm"))
            .legend(|(x, y)| PathElement::new(vec![(x, y), (x + 22 * PX as i32, y)], line(PLATEAU, 2)));
    }
    draw_path(&mut chart, path, &measured)?;
    for snap in snaps(records) {
        let (from, to) = ((snap.before, snap.moment_before_n_mm), (snap.after, snap.moment_after_n_mm));
        chart.draw_series(DashedLineSeries::new([from, to], 3 * PX, 4 * PX, line(SNAP, 1)))?;
        chart.draw_series([from, to].map(|end| Circle::new(end, 4 * PX, line(SNAP, 2))))?;
        // On the side of the jump that has room.
        let (side, shift) = if from.0 > 0.6 * end_deg { (HPos::Right, -0.012) } else { (HPos::Left, 0.012) };
        let style = text(14).color(&SNAP).pos(Pos::new(side, VPos::Center));
        let place = (from.0 + shift * end_deg, 0.5 * (from.1 + to.1));
        chart.draw_series([Text::new(format!("snap at {:.2}°", snap.after), place, style)])?;
    }
    let top = measured.iter().chain(&law).fold((0.0, 0.0), |top, point| if point.1 > top.1 { *point } else { top });
    let free_corner =
        if top.0 > 0.6 * end_deg { SeriesLabelPosition::UpperLeft } else { SeriesLabelPosition::UpperRight };
    chart
        .configure_series_labels()
        .position(free_corner)
        .margin(12 * PX)
        .legend_area_size(34 * PX)
        .label_font(text(14))
        .background_style(WHITE.mix(0.9))
        .border_style(line(GRID, 1))
        .draw()?;
    Ok(())
}

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Axes with a grid; `along` labels the lower one.
fn draw_axes(chart: &mut Chart, along: Option<String>, upwards: &str) -> Result<(), PlotError> {
    let mut axes = chart.configure_mesh();
    if let Some(along) = along {
        axes.x_desc(along);
    }
    axes.y_desc(upwards)
        .x_label_formatter(&|value| short(*value))
        .y_label_formatter(&|value| short(*value))
        .label_style(text(14))
        .axis_desc_style(text(15))
        .axis_style(line(INK, 1))
        .bold_line_style(line(GRID, 1))
        .set_all_tick_mark_size(5 * PX)
        .light_line_style(line(WHITE, 1))
        .draw()?;
    Ok(())
}

/// Draws points of a path, the first of which is the unloaded shell: stable stretches solid, unstable ones dashed, and
/// broken where the shell jumped, since a jump is not a path.
fn draw_path(chart: &mut Chart, path: &[PathPoint], points: &[(f64, f64)]) -> Result<(), PlotError> {
    let stable = |index: usize| index.checked_sub(1).is_none_or(|index| path[index].negative_pivots == 0);
    let joined = |index: usize| !path[index - 1].jumped;
    let mut told = [false; 2];
    let mut from = 0;
    while from + 1 < points.len() {
        if !joined(from + 1) {
            from += 1;
            continue;
        }
        // A stretch is unstable where either of its ends is.
        let kind = |index: usize| stable(index) && stable(index + 1);
        let mut to = from + 1;
        while to + 1 < points.len() && joined(to + 1) && kind(to) == kind(from) {
            to += 1;
        }
        let stretch = points[from..=to].to_vec();
        if kind(from) {
            let series = chart.draw_series(LineSeries::new(stretch, line(MEASURED, 2)))?;
            if !std::mem::replace(&mut told[0], true) {
                series
                    .label("this run")
                    .legend(|(x, y)| PathElement::new([(x, y), (x + 22 * PX as i32, y)], line(MEASURED, 2)));
            }
        } else {
            let series = chart.draw_series(DashedLineSeries::new(stretch, 5 * PX, 4 * PX, line(SNAP, 2)))?;
            if !std::mem::replace(&mut told[1], true) {
                series.label("unstable equilibria").legend(|(x, y)| {
                    DashedPathElement::new([(x, y), (x + 22 * PX as i32, y)], 5 * PX, 4 * PX, line(SNAP, 2))
                });
            }
        }
        from = to;
    }
    let dot = |(index, point): (usize, &(f64, f64))| {
        let colour = if stable(index) { MEASURED } else { SNAP };
        Circle::new(*point, 2 * PX, colour.filled())
    };
    chart.draw_series(points.iter().enumerate().skip(1).map(dot))?;
    let passed = |limit_point: bool| {
        let of_points = points.iter().skip(1).zip(path);
        of_points.filter_map(move |(point, of_path)| {
            of_path.passed.filter(|passed| passed.critical.limit_point == limit_point).map(|_| *point)
        })
    };
    if passed(true).next().is_some() {
        let ring = |at: (f64, f64)| Circle::new(at, 5 * PX, line(SNAP, 2));
        let legend = |(x, y): (i32, i32)| Circle::new((x + 11 * PX as i32, y), 5 * PX, line(SNAP, 2));
        chart.draw_series(passed(true).map(ring))?.label("limit point").legend(legend);
    }
    if passed(false).next().is_some() {
        let cross = |at: (f64, f64)| Cross::new(at, 5 * PX, line(SNAP, 2));
        let legend = |(x, y): (i32, i32)| Cross::new((x + 11 * PX as i32, y), 5 * PX, line(SNAP, 2));
        chart.draw_series(passed(false).map(cross))?.label("bifurcation").legend(legend);
    }
    Ok(())
}

/// Plots the load factor over the first probe of `records`, a run of `scene`, as SVG text: unstable equilibria dashed.
/// `None` where the scene has no probe. `title` is printed on top.
///
/// # Errors
/// Where there is no equilibrium yet.
pub fn load_probe_plot(scene: &Scene, records: &[Record], title: &str) -> Result<Option<String>, PlotError> {
    let Some(probe) = scene.probes.first() else { return Ok(None) };
    // Others may come before it, in stages that were run with them.
    let mut records = records.to_vec();
    records.iter_mut().for_each(|record| record.report.probes.retain(|reading| reading.name == probe.name));
    let records = &records[..];
    drawable(records)?;
    let path = equilibrium_path(records);
    let reading = records.iter().rev().find_map(|record| record.report.probes.first());
    let reading = reading.ok_or(PlotError::NoEquilibrium)?;
    let zero = (0.0, 0.0);
    let points: Vec<(f64, f64)> =
        std::iter::once(zero).chain(path.iter().filter_map(|point| Some((point.probe?, point.parameter)))).collect();
    if points.len() != path.len() + 1 {
        return Ok(None);
    }
    let span = |value: fn(&(f64, f64)) -> f64| {
        let [low, high] =
            points.iter().map(value).fold([0.0, 0.0], |[low, high]: [f64; 2], v| [low.min(v), high.max(v)]);
        let margin = 0.06 * (high - low).max(SHORTEST);
        low - margin..high + margin
    };
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (SIZE.0, UPPER_HEIGHT + 40 * PX)).into_drawing_area();
        root.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&root)
            .caption(one_line(title), text(19))
            .margin(16 * PX)
            .margin_right(28 * PX)
            .x_label_area_size(48 * PX)
            .y_label_area_size(LEFT)
            .build_cartesian_2d(span(|point| point.0), span(|point| point.1))?;
        let along = format!("{} ({})", probe.name, reading.unit);
        draw_axes(&mut chart, Some(one_line(&along).into_owned()), "load factor")?;
        draw_path(&mut chart, &path, &points)?;
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperMiddle)
            .margin(12 * PX)
            .legend_area_size(34 * PX)
            .label_font(text(14))
            .background_style(WHITE.mix(0.9))
            .border_style(line(GRID, 1))
            .draw()?;
        root.present()?;
    }
    Ok(Some(in_pixels(&svg, (SIZE.0, UPPER_HEIGHT + 40 * PX))))
}

fn draw_elements(area: &Area, path: &[PathPoint], end_deg: f64) -> Result<(), PlotError> {
    let height = |point: &PathPoint| point.elements.iter().map(|count| *count as f64).product::<f64>().max(1.0).log2();
    let (low, high) = path.iter().map(height).fold((f64::MAX, 0.0f64), |(low, high), n| (low.min(n), high.max(n)));
    let (bottom, top) = ((low - 0.6).floor(), (high + 1.0).ceil());
    let mut chart = ChartBuilder::on(area)
        .margin(16 * PX)
        .margin_top(4 * PX)
        .margin_right(28 * PX)
        .x_label_area_size(48 * PX)
        .y_label_area_size(LEFT)
        .build_cartesian_2d(0.0..end_deg, PowersOfTwo { bottom, top })?;
    chart
        .configure_mesh()
        .x_desc("rotation of each end θ (degrees)")
        .y_desc("elements of the model")
        .x_label_formatter(&|value| short(*value))
        .y_label_formatter(&|value| short(value.exp2()))
        .label_style(text(14))
        .axis_desc_style(text(15))
        .axis_style(line(INK, 1))
        .bold_line_style(line(GRID, 1))
        .set_all_tick_mark_size(5 * PX)
        .light_line_style(line(WHITE, 1))
        .draw()?;
    // The mesh stays as it is until the step that refines it.
    let mut stairs: Vec<(f64, f64)> = path.first().map(|first| (0.0, height(first))).into_iter().collect();
    for point in path {
        let before = stairs.last().map_or(height(point), |last| last.1);
        stairs.extend([(point.parameter, before), (point.parameter, height(point))]);
    }
    chart.draw_series(LineSeries::new(stairs, line(MEASURED, 2)))?;
    // Every stair that is wide enough has its mesh written upon it.
    let mut from_deg = 0.0;
    for (i, point) in path.iter().enumerate() {
        let next = path.get(i + 1);
        if next.is_some_and(|next| next.elements == point.elements) {
            continue;
        }
        let to_deg = next.map_or(point.parameter, |next| next.parameter);
        if to_deg - from_deg > 0.09 * end_deg {
            let [n1, n2] = point.elements;
            let style = text(13).pos(Pos::new(HPos::Center, VPos::Bottom));
            let place = (0.5 * (from_deg + to_deg), height(point) + 0.03 * (top - bottom));
            chart.draw_series([Text::new(format!("{n1} × {n2}"), place, style)])?;
        }
        from_deg = to_deg;
    }
    Ok(())
}

/// An axis of logarithms to base 2, labelled at every power of two, or every second, third, …, so that they fit.
struct PowersOfTwo {
    bottom: f64,
    top: f64,
}

impl Ranged for PowersOfTwo {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        from + ((value - self.bottom) / (self.top - self.bottom) * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        const MOST_LABELS: f64 = 5.0;
        let stride = ((self.top - self.bottom) / MOST_LABELS).ceil().max(1.0) as usize;
        (self.bottom as i32..=self.top as i32).step_by(stride).map(f64::from).collect()
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.bottom..self.top
    }
}

fn text(size: u32) -> TextStyle<'static> {
    (FONT, size * PX).into_font().color(&INK)
}

fn line(colour: RGBColor, width: u32) -> ShapeStyle {
    colour.stroke_width(width * PX)
}

/// A drawing with its size in pixels.
fn in_pixels(svg: &str, (width, height): (u32, u32)) -> String {
    let drawn = format!("width=\"{width}\" height=\"{height}\"");
    svg.replacen(&drawn, &format!("width=\"{}\" height=\"{}\"", width / PX, height / PX), 1)
}

/// A number at an axis.
fn short(value: f64) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').replace('-', "−")
}
