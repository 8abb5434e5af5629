//! Sizes, fonts and colours of charts.

use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, IntoDrawingArea};
use plotters::prelude::SVGBackend;
use plotters::style::{Color, IntoFont, RGBColor, ShapeStyle, TextStyle, WHITE};

use super::PlotError;

/// Units of the drawing in a pixel: it is drawn in whole ones, and a curve in whole pixels wobbles.
pub(super) const PX: u32 = 20;
const FONT: &str = "DejaVu Sans, Helvetica, Arial, sans-serif";

pub(super) const INK: RGBColor = RGBColor(0x1a, 0x1a, 0x1a);
pub(super) const GRID: RGBColor = RGBColor(0xe4, 0xe4, 0xe4);
pub(super) const LAW: RGBColor = RGBColor(0x8a, 0x8a, 0x8a);
pub(super) const PLATEAU: RGBColor = RGBColor(0x4d, 0x4d, 0x4d);
/// Jumps, unstable equilibria and critical points of the only run.
pub(super) const SNAP: RGBColor = RGBColor(0xb7, 0x37, 0x79);
/// The only run.
const MEASURED: RGBColor = RGBColor(0x31, 0x68, 0x8e);
/// Several runs: colours that the colour-blind tell apart too (M. Okabe and K. Ito, 2008), without black and yellow.
const SEVERAL: [RGBColor; 6] = [
    RGBColor(0x00, 0x72, 0xb2),
    RGBColor(0xd5, 0x5e, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
    RGBColor(0xcc, 0x79, 0xa7),
    RGBColor(0x56, 0xb4, 0xe9),
    RGBColor(0xe6, 0x9f, 0x00),
];

/// What a run is drawn with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pen {
    pub(super) colour: RGBColor,
    /// Colour of what is not a stable equilibrium.
    pub(super) event: RGBColor,
    /// Pixels of the dashes of stable stretches; `None` for a line without gaps.
    pub(super) dash: Option<u32>,
    /// Pixels.
    pub(super) width: u32,
}

impl Pen {
    /// The pen of a run among `count`. Beyond the number of colours, lines are dashed, each round longer. Earlier runs are drawn
    /// wider, so that they are seen below later ones that agree with them.
    pub(super) fn of(index: usize, count: usize) -> Self {
        if count == 1 {
            return Self { colour: MEASURED, event: SNAP, dash: None, width: 2 };
        }
        let (colour, round) = (SEVERAL[index % SEVERAL.len()], index / SEVERAL.len());
        let dash = (round > 0).then_some(10 + 8 * round as u32);
        Self { colour, event: colour, dash, width: 2 + 2 * (count - 1 - index).min(2) as u32 }
    }
}

pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Draws on a white sheet of this size, pixels, and gives the SVG text.
pub(super) fn on_sheet(
    size: (u32, u32),
    draw: impl FnOnce(&Area) -> Result<(), PlotError>,
) -> Result<String, PlotError> {
    let mut svg = String::new();
    let (width, height) = (size.0 * PX, size.1 * PX);
    {
        let root = SVGBackend::with_string(&mut svg, (width, height)).into_drawing_area();
        root.fill(&WHITE)?;
        draw(&root)?;
        root.present()?;
    }
    let drawn = format!("width=\"{width}\" height=\"{height}\"");
    Ok(svg.replacen(&drawn, &format!("width=\"{}\" height=\"{}\"", size.0, size.1), 1))
}

pub(super) fn text(size: u32) -> TextStyle<'static> {
    (FONT, size * PX).into_font().color(&INK)
}

pub(super) fn line(colour: RGBColor, width: u32) -> ShapeStyle {
    colour.stroke_width(width * PX)
}
