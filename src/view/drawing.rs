//! A picture as shapes on a canvas, from back to front, and as SVG. Lengths are pixels; y points down.

use std::fmt::Write as _;

use super::colour::Colour;
use crate::printable::one_line;

/// A picture of a size.
#[derive(Clone, Debug, Default)]
pub(super) struct Drawing {
    pub(super) size: [f64; 2],
    pub(super) shapes: Vec<Shape>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    /// A filled polygon with an edge of its own colour, so that no light shines through the seams between two.
    Face { corners: Vec<[f64; 2]>, colour: Colour },
    /// Polylines.
    Lines { lines: Vec<Vec<[f64; 2]>>, stroke: Stroke },
    /// Words in ink, on this base line.
    Text { at: [f64; 2], anchor: Anchor, size: u32, words: String },
}

/// What lines are drawn with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stroke {
    pub(super) colour: Colour,
    pub(super) opacity: f64,
    pub(super) width: f64,
    /// Dash and gap.
    pub(super) dash: Option<[f64; 2]>,
}

/// The part of words that is at their place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
}

/// Width of the edges of faces.
pub(super) const SEAM: f64 = 1.0;

impl Stroke {
    pub(super) fn new(colour: Colour, width: f64) -> Self {
        Self { colour, opacity: 1.0, width, dash: None }
    }
}

impl Drawing {
    pub(super) fn face(&mut self, corners: impl Into<Vec<[f64; 2]>>, colour: Colour) {
        self.shapes.push(Shape::Face { corners: corners.into(), colour });
    }

    pub(super) fn lines(&mut self, lines: Vec<Vec<[f64; 2]>>, stroke: Stroke) {
        if !lines.is_empty() {
            self.shapes.push(Shape::Lines { lines, stroke });
        }
    }

    pub(super) fn text(&mut self, at: [f64; 2], anchor: Anchor, size: u32, words: &str) {
        if !words.is_empty() {
            self.shapes.push(Shape::Text { at, anchor, size, words: words.to_owned() });
        }
    }

    /// As SVG text.
    pub(super) fn svg(&self) -> String {
        let [width, height] = self.size;
        let ink = Colour::INK.hex();
        let mut svg = format!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height:.0}" viewBox="0 0 {width} {height:.0}" font-family="DejaVu Sans, Helvetica, Arial, sans-serif" fill="{ink}" stroke-width="{SEAM}" stroke-linejoin="round" stroke-linecap="round">
<rect width="100%" height="100%" fill="#ffffff"/>
"##
        );
        for shape in &self.shapes {
            // Writing to a string does not fail.
            let _ = match shape {
                Shape::Face { corners, colour } => {
                    let colour = colour.hex();
                    writeln!(svg, r#"<path fill="{colour}" stroke="{colour}" d="{}z"/>"#, path(corners))
                }
                Shape::Lines { lines, stroke } => {
                    let Stroke { colour, opacity, width, dash } = stroke;
                    let dash = dash.map_or(String::new(), |[dash, gap]| {
                        format!(r#" stroke-dasharray="{dash} {gap}" stroke-linecap="butt""#)
                    });
                    let d: String = lines.iter().map(|line| path(line)).collect();
                    let colour = colour.hex();
                    writeln!(
                        svg,
                        r#"<path fill="none" stroke="{colour}" stroke-opacity="{opacity}" stroke-width="{width}"{dash} d="{d}"/>"#
                    )
                }
                Shape::Text { at: [x, y], anchor, size, words } => {
                    let anchor = match anchor {
                        Anchor::Start => "start",
                        Anchor::Middle => "middle",
                    };
                    let words = escaped(words);
                    writeln!(
                        svg,
                        r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}" font-size="{size}">{words}</text>"#
                    )
                }
            };
        }
        svg.push_str("</svg>\n");
        svg
    }
}

fn path(points: &[[f64; 2]]) -> String {
    let mut d = String::new();
    for (index, [x, y]) in points.iter().enumerate() {
        let _ = write!(d, "{}{x:.1} {y:.1}", if index == 0 { 'M' } else { 'L' });
    }
    d
}

/// Text as XML.
pub(super) fn escaped(text: &str) -> String {
    one_line(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
