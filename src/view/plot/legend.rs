//! What the lines of a chart are, where it covers the least of them.

use plotters::chart::SeriesLabelPosition;
use plotters::element::{Circle, Cross, DashedPathElement, PathElement};
use plotters::style::{Color, RGBColor, WHITE};

use super::PlotError;
use super::axis::{Axis, Chart};
use super::line::{GAP, JUMP, Joint, MARK, RunLine, UNSTABLE};
use super::style::{GRID, PX, line, text};
use crate::printable::one_line;

/// What a legend shows of an entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sample {
    /// A line, with the pixels of its dashes and gaps, and its width.
    Line(RGBColor, Option<[u32; 2]>, u32),
    Ring(RGBColor),
    Cross(RGBColor),
}

/// Length of a sample, pixels.
const LENGTH: i32 = 22;
/// Room that an entry takes, pixels: its height, and the width of a letter.
const HEIGHT: f64 = 18.0;
const LETTER: f64 = 8.0;
/// Room between frame, entries and the edge of the chart, pixels.
const ROOM: f64 = 30.0;

/// The entries for runs and for what stands on their lines.
pub(super) fn entries(lines: &[RunLine], with_jumps: bool) -> Vec<(String, Sample)> {
    let of_run = |run: &RunLine| {
        let name = if lines.len() == 1 { "this run".to_owned() } else { run.name.clone() };
        (name, Sample::Line(run.pen.colour, run.pen.dash.map(|dash| [dash, GAP]), run.pen.width))
    };
    let event = match lines {
        [only] => only.pen.event,
        _ => super::style::INK,
    };
    let has = |kind: Joint| lines.iter().any(|run| run.joints().contains(&kind));
    let passed = |limit_point: bool| lines.iter().any(|run| run.critical(limit_point).next().is_some());
    let events = [
        (has(Joint::Unstable), "unstable equilibria", Sample::Line(event, Some(UNSTABLE), 2)),
        (with_jumps && has(Joint::Jump), "jump", Sample::Line(event, Some(JUMP), 1)),
        (passed(true), "limit point", Sample::Ring(event)),
        (passed(false), "bifurcation", Sample::Cross(event)),
    ];
    let events = events.into_iter().filter(|(is_there, ..)| *is_there);
    lines.iter().map(of_run).chain(events.map(|(_, name, sample)| (name.to_owned(), sample))).collect()
}

/// Draws the entries where they cover the least of `drawn`, polylines in a chart of this size (pixels).
pub(super) fn draw_legend<'b: 'c, 'c>(
    chart: &mut Chart<'c, 'b>,
    axes: [&Axis; 2],
    size: [f64; 2],
    entries: &[(String, Sample)],
    drawn: &[Vec<(f64, f64)>],
) -> Result<(), PlotError> {
    for (name, sample) in entries {
        let px = PX as i32;
        let ends = move |(x, y): (i32, i32)| [(x, y), (x + LENGTH * px, y)];
        let middle = move |(x, y): (i32, i32)| (x + LENGTH * px / 2, y);
        let entry = chart.draw_series(std::iter::empty::<PathElement<(f64, f64)>>())?.label(one_line(name));
        match *sample {
            Sample::Line(colour, None, width) => {
                entry.legend(move |at| PathElement::new(ends(at), line(colour, width)))
            }
            Sample::Line(colour, Some([dash, gap]), width) => {
                entry.legend(move |at| DashedPathElement::new(ends(at), dash * PX, gap * PX, line(colour, width)))
            }
            Sample::Ring(colour) => entry.legend(move |at| Circle::new(middle(at), MARK * PX, line(colour, 2))),
            Sample::Cross(colour) => entry.legend(move |at| Cross::new(middle(at), MARK * PX, line(colour, 2))),
        };
    }
    let letters = entries.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    let box_size = [LETTER * letters as f64 + 34.0 + ROOM, HEIGHT * entries.len() as f64 + ROOM];
    let share = [0, 1].map(|k| (box_size[k] / size[k]).min(1.0));
    chart
        .configure_series_labels()
        .position(free_place(axes, share, drawn))
        .margin(12 * PX)
        .legend_area_size(34 * PX)
        .label_font(text(14))
        .background_style(WHITE.mix(0.9))
        .border_style(line(GRID, 1))
        .draw()?;
    Ok(())
}

/// The place where a box that takes this share of the chart each way covers the least of the lines; of equal ones, the first.
fn free_place([x, y]: [&Axis; 2], share: [f64; 2], drawn: &[Vec<(f64, f64)>]) -> SeriesLabelPosition {
    use SeriesLabelPosition as Place;
    /// Points that a stretch is sampled at.
    const SAMPLES: usize = 40;
    let places = [
        (Place::UpperRight, [1.0, 1.0]),
        (Place::UpperLeft, [0.0, 1.0]),
        (Place::LowerRight, [1.0, 0.0]),
        (Place::LowerLeft, [0.0, 0.0]),
        (Place::UpperMiddle, [0.5, 1.0]),
        (Place::LowerMiddle, [0.5, 0.0]),
        (Place::MiddleRight, [1.0, 0.5]),
        (Place::MiddleLeft, [0.0, 0.5]),
        (Place::MiddleMiddle, [0.5, 0.5]),
    ];
    let samples: Vec<[f64; 2]> = drawn
        .iter()
        .flat_map(|line| line.windows(2))
        .flat_map(|pair| {
            let [from, to] = [pair[0], pair[1]].map(|at| [x.fraction(at.0), y.fraction(at.1)]);
            (0..=SAMPLES).map(move |k| [0, 1].map(|c| from[c] + (to[c] - from[c]) * k as f64 / SAMPLES as f64))
        })
        .collect();
    let covered = |corner: [f64; 2]| {
        let is_inside = |at: &&[f64; 2]| {
            (0..2).all(|c| (corner[c] * (1.0 - share[c])..=corner[c] * (1.0 - share[c]) + share[c]).contains(&at[c]))
        };
        samples.iter().filter(is_inside).count()
    };
    let best = places.into_iter().min_by_key(|(_, corner)| covered(*corner));
    best.map_or(Place::UpperRight, |(place, _)| place)
}
