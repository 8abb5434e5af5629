//! Any quantity of runs over any.

use plotters::chart::ChartBuilder;

use super::axis::{Axis, draw_axes};
use super::legend::{draw_legend, entries};
use super::line::{RunLine, line_points};
use super::run::PlottedPoint;
use super::style::{Area, PX, Pen, on_sheet, text};
use super::{PlotError, PlottedRun, Quantity, quantity_named};
use crate::printable::one_line;

const SIZE: (u32, u32) = (1000, 580);
const MARGIN: u32 = 16;
const RIGHT: u32 = 28;
/// Room for the names and numbers of the axes, pixels.
const LEFT: u32 = 84;
const BELOW: u32 = 48;

/// The load factor over the first probe of the first run, with the other sign where all of its readings are 0 or less; `None`
/// where the run has no probe.
pub fn load_probe(runs: &[PlottedRun]) -> Option<[Quantity; 2]> {
    let scene = runs.first()?.scene;
    let probe = Quantity::of_probe(&scene.probes.first()?.name);
    let name = probe.probe()?;
    let readings = || {
        let records = runs.iter().flat_map(|run| run.records);
        records.flat_map(|record| &record.report.probes).filter(|reading| reading.name == name)
    };
    let is_downward = readings().all(|reading| reading.value <= 0.0) && readings().any(|reading| reading.value < 0.0);
    Some([if is_downward { probe.negated() } else { probe }, quantity_named(scene, "load_factor")?])
}

/// Plots `y` over `x` along the paths of runs as SVG text: unstable equilibria dashed, jumps dotted, critical points marked.
/// `title` is printed on top.
///
/// # Errors
/// Where a run has no equilibrium yet, or none with both quantities.
pub fn curve_plot(runs: &[PlottedRun], x: &Quantity, y: &Quantity, title: &str) -> Result<String, PlotError> {
    let paths = runs.iter().map(PlottedRun::points).collect::<Result<Vec<_>, _>>()?;
    let title_of = |quantity: &Quantity| unit(quantity, &paths).map(|unit| quantity.title(unit));
    let (along, upwards) = (title_of(x)?, title_of(y)?);
    let line = |(index, (run, path)): (usize, (&PlottedRun, &Vec<PlottedPoint>))| {
        let points = line_points(&run.name, path, x, y)?;
        Ok(RunLine { name: run.name.clone(), pen: Pen::of(index, runs.len()), points })
    };
    let lines = runs.iter().zip(&paths).enumerate().map(line).collect::<Result<Vec<_>, PlotError>>()?;
    on_sheet(SIZE, |area| draw(area, &lines, [&along, &upwards], title))
}

/// The unit of a quantity, which all runs must have in common.
fn unit<'r>(quantity: &Quantity, paths: &[Vec<PlottedPoint<'r>>]) -> Result<&'r str, PlotError> {
    let mut units = paths.iter().filter_map(|path| path.iter().find_map(|point| quantity.unit(point)));
    let first = units.next().unwrap_or_default();
    match units.find(|unit| *unit != first) {
        Some(other) => {
            let units = [first, other].map(str::to_owned);
            Err(PlotError::Units { quantity: quantity.name.clone(), units })
        }
        None => Ok(first),
    }
}

fn draw(area: &Area, lines: &[RunLine], [along, upwards]: [&str; 2], title: &str) -> Result<(), PlotError> {
    let points = || lines.iter().flat_map(|line| &line.points);
    let [x, y] = [Axis::showing(points().map(|point| point.at.0)), Axis::showing(points().map(|point| point.at.1))];
    let mut builder = ChartBuilder::on(area);
    if !title.is_empty() {
        builder.caption(one_line(title), text(19));
    }
    let mut chart = builder
        .margin(MARGIN * PX)
        .margin_right(RIGHT * PX)
        .x_label_area_size(BELOW * PX)
        .y_label_area_size(LEFT * PX)
        .build_cartesian_2d(x.clone(), y.clone())?;
    draw_axes(&mut chart, [&x, &y], Some(along), upwards)?;
    lines.iter().try_for_each(|line| line.draw(&mut chart))?;
    let drawn: Vec<_> = lines.iter().map(|line| line.points.iter().map(|point| point.at).collect()).collect();
    let size = [f64::from(SIZE.0 - LEFT - MARGIN - RIGHT), f64::from(SIZE.1 - BELOW - 3 * MARGIN)];
    draw_legend(&mut chart, [&x, &y], size, &entries(lines, true), &drawn)
}
