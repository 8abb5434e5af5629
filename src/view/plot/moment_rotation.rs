//! The moment–rotation curves of tape springs with Wuest's law, and the size of the mesh below them.

use plotters::chart::ChartBuilder;
use plotters::element::{Circle, Text};
use plotters::series::{DashedLineSeries, LineSeries};
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::{Axis, Chart, draw_axes};
use super::legend::{Sample, draw_legend, entries};
use super::line::{RunLine, line_points};
use super::run::PlottedPoint;
use super::style::{Area, LAW, PLATEAU, PX, Pen, SNAP, line, on_sheet, text};
use super::{PlotError, PlottedRun, quantity_named};
use crate::printable::one_line;
use crate::study::{TapeSpring, snaps};

const SIZE: (u32, u32) = (1000, 760);
const UPPER_HEIGHT: u32 = 500;
const MARGIN: u32 = 16;
const RIGHT: u32 = 28;
const LEFT: u32 = 70;
const LAW_DASHES: [u32; 2] = [7, 5];

/// Plots the curves of runs whose ends turn as SVG text: measured moments, the jumps; where all are of the same tape spring, Wuest's
/// law for uniform curvature (dashed) and the equal-energy plateau; below, elements of the models on a logarithmic axis. `title`
/// is printed on top.
///
/// # Errors
/// Where a run has no equilibrium yet, or no end that turns.
pub fn moment_rotation_plot(runs: &[PlottedRun], title: &str) -> Result<String, PlotError> {
    let paths = runs.iter().map(PlottedRun::points).collect::<Result<Vec<_>, _>>()?;
    let first = runs.first().ok_or(PlotError::NoEquilibrium)?;
    let [rotation, moment] = ["rotation", "moment"].map(|name| quantity_named(first.scene, name));
    let (rotation, moment) = rotation.zip(moment).ok_or(PlotError::NoMoment)?;
    let line = |(index, (run, path)): (usize, (&PlottedRun, &Vec<PlottedPoint>))| {
        let points = line_points(&run.name, path, &rotation, &moment)?;
        Ok(RunLine { name: run.name.clone(), pen: Pen::of(index, runs.len()), points })
    };
    let lines = runs.iter().zip(&paths).enumerate().map(line).collect::<Result<Vec<_>, PlotError>>()?;
    let rotations = Axis::showing(lines.iter().flat_map(|line| line.points.iter().map(|point| point.at.0)));
    let spring = TapeSpring::of_scene(first.scene);
    let spring = spring.filter(|_| runs.iter().all(|run| TapeSpring::of_scene(run.scene) == spring));
    on_sheet(SIZE, |area| {
        let (upper, lower) = area.split_vertically(UPPER_HEIGHT * PX);
        draw_moments(&upper, &rotations, &lines, spring.as_ref(), runs, title)?;
        draw_elements(&lower, &rotations, &lines, &paths)
    })
}

fn draw_moments(
    area: &Area,
    rotations: &Axis,
    lines: &[RunLine],
    spring: Option<&TapeSpring>,
    runs: &[PlottedRun],
    title: &str,
) -> Result<(), PlotError> {
    let [from, to] = rotations.ends();
    let at = |i: u32| from + f64::from(i) / 400.0 * (to - from);
    let law: Vec<(f64, f64)> = spring.map_or(vec![], |spring| {
        (0..=400).map(at).map(|rotation| (rotation, spring.moment_at_rotation(rotation))).collect()
    });
    let plateau = spring.and_then(TapeSpring::plateau).map(|plateau| plateau.moment_n_mm);
    let measured = lines.iter().flat_map(|line| line.points.iter().map(|point| point.at.1));
    let moments = Axis::showing(measured.chain(law.iter().map(|point| point.1)).chain(plateau));

    let mut builder = ChartBuilder::on(area);
    if !title.is_empty() {
        builder.caption(one_line(title), text(19));
    }
    let mut chart = builder
        .margin(MARGIN * PX)
        .margin_right(RIGHT * PX)
        .x_label_area_size(28 * PX)
        .y_label_area_size(LEFT * PX)
        .build_cartesian_2d(rotations.clone(), moments.clone())?;
    draw_axes(&mut chart, [rotations, &moments], None, "end moment M (N·mm)")?;

    let mut legend = Vec::new();
    if !law.is_empty() {
        let [dash, gap] = LAW_DASHES.map(|pixels| pixels * PX);
        chart.draw_series(DashedLineSeries::new(law.clone(), dash, gap, line(LAW, 2)))?;
        legend.push(("Wuest 1954, uniform curvature".to_owned(), Sample::Line(LAW, Some(LAW_DASHES), 2)));
    }
    if let Some(level) = plateau {
        chart.draw_series(LineSeries::new([(from, level), (to, level)], line(PLATEAU, 1)))?;
        legend.push((format!("equal-energy plateau, {level:.2} N·mm"), Sample::Line(PLATEAU, None, 1)));
    }
    lines.iter().try_for_each(|line| line.draw(&mut chart))?;
    if let [only] = runs {
        draw_snaps(&mut chart, only, rotations)?;
    }
    legend.extend(entries(lines, lines.len() > 1));
    let mut drawn: Vec<_> = lines.iter().map(|line| line.points.iter().map(|point| point.at).collect()).collect();
    drawn.push(law);
    drawn.extend(plateau.map(|level| vec![(from, level), (to, level)]));
    let size = [f64::from(SIZE.0 - LEFT - MARGIN - RIGHT), f64::from(UPPER_HEIGHT - 4 * MARGIN)];
    draw_legend(&mut chart, [rotations, &moments], size, &legend, &drawn)
}

/// Rings at the ends of jumps, and where they are in words.
fn draw_snaps(chart: &mut Chart, run: &PlottedRun, rotations: &Axis) -> Result<(), PlotError> {
    let [low, high] = rotations.ends();
    for snap in snaps(run.records) {
        let (from, to) = ((snap.before, snap.moment_before_n_mm), (snap.after, snap.moment_after_n_mm));
        chart.draw_series([from, to].map(|end| Circle::new(end, 4 * PX, line(SNAP, 2))))?;
        // On the side of the jump that has room.
        let (side, shift) = if rotations.fraction(from.0) > 0.6 { (HPos::Right, -0.012) } else { (HPos::Left, 0.012) };
        let style = text(14).color(&SNAP).pos(Pos::new(side, VPos::Center));
        let place = (from.0 + shift * (high - low), 0.5 * (from.1 + to.1));
        chart.draw_series([Text::new(format!("snap at {:.2}°", snap.after), place, style)])?;
    }
    Ok(())
}

fn draw_elements(
    area: &Area,
    rotations: &Axis,
    lines: &[RunLine],
    paths: &[Vec<PlottedPoint>],
) -> Result<(), PlotError> {
    let heights = || paths.iter().flatten().map(height);
    let (low, high) = heights().fold((f64::MAX, 0.0f64), |(low, high), n| (low.min(n), high.max(n)));
    let elements = Axis::powers_of_two((low - 0.6).floor(), (high + 1.0).ceil());
    let mut chart = ChartBuilder::on(area)
        .margin(MARGIN * PX)
        .margin_top(4 * PX)
        .margin_right(RIGHT * PX)
        .x_label_area_size(48 * PX)
        .y_label_area_size(LEFT * PX)
        .build_cartesian_2d(rotations.clone(), elements.clone())?;
    draw_axes(&mut chart, [rotations, &elements], Some("rotation of each end θ (degrees)"), "elements of the model")?;
    for (path, RunLine { pen, .. }) in paths.iter().zip(lines) {
        // The mesh stays as it is until the step that refines it.
        let mut stairs: Vec<(f64, f64)> = path.first().map(|first| (0.0, height(first))).into_iter().collect();
        for point in path {
            let before = stairs.last().map_or(height(point), |last| last.1);
            stairs.extend([(point.report.parameter, before), (point.report.parameter, height(point))]);
        }
        chart.draw_series(LineSeries::new(stairs, line(pen.colour, 2)))?;
    }
    match paths {
        [only] => draw_meshes(&mut chart, only, [rotations, &elements]),
        _ => Ok(()),
    }
}

/// The number of elements, as its logarithm to base 2.
fn height(point: &PlottedPoint) -> f64 {
    (point.report.elements.count() as f64).max(1.0).log2()
}

/// Every stair that is wide enough has its mesh written upon it.
fn draw_meshes(chart: &mut Chart, path: &[PlottedPoint], [x, y]: [&Axis; 2]) -> Result<(), PlotError> {
    let [bottom, top] = y.ends();
    let mut from_deg = 0.0;
    for (i, PlottedPoint { report, .. }) in path.iter().enumerate() {
        let next = path.get(i + 1).map(|next| next.report);
        if next.is_some_and(|next| next.elements == report.elements) {
            continue;
        }
        let to_deg = next.map_or(report.parameter, |next| next.parameter);
        if x.fraction(to_deg) - x.fraction(from_deg) > 0.09 {
            let style = text(13).pos(Pos::new(HPos::Center, VPos::Bottom));
            let place = (0.5 * (from_deg + to_deg), height(&path[i]) + 0.03 * (top - bottom));
            chart.draw_series([Text::new(report.elements.to_string(), place, style)])?;
        }
        from_deg = to_deg;
    }
    Ok(())
}
