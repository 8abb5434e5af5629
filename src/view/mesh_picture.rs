//! The deformed mesh as a picture: faces from back to front coloured by their value, knot lines where they are seen,
//! a colour bar, and a scale.

use std::fmt::Write as _;

use super::camera::{Camera, DepthBuffer, Projected, ViewDirection};
use super::colour::Colour;
use super::samples::SurfaceSamples;
use super::ticks::ticks;
use crate::printable::one_line;

/// The settings of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Direction from which the surface is seen.
    pub direction: ViewDirection,
    /// First line of text; may be empty.
    pub title: String,
    /// Second line of text; may be empty.
    pub subtitle: String,
    /// Width in pixels, at least 480; the height follows from the surface.
    pub width: u32,
    /// Values at the ends of the colour bar; `None` takes 0 (or the least value, where that is less) and the largest.
    pub value_range: Option<[f64; 2]>,
}

impl Default for Picture {
    fn default() -> Self {
        Self {
            direction: ViewDirection::default(),
            title: String::new(),
            subtitle: String::new(),
            width: 1200,
            value_range: None,
        }
    }
}

const LEAST_WIDTH: u32 = 480;
const MARGIN: f64 = 40.0;
const TITLE_HEIGHT: f64 = 84.0;
const FOOT_HEIGHT: f64 = 118.0;
const BAR_LENGTH: f64 = 320.0;
const BAR_HEIGHT: f64 = 14.0;
/// Most height of the surface, over the width of the picture.
const MOST_ASPECT: f64 = 0.8;
/// A line on the surface is hidden where a face is nearer by more than this part of the picture's width, which is far
/// below the gap between the layers of a fold and above the facets' distance from the smooth surface.
const HIDDEN_BY: f64 = 0.004;

/// Draws a sampled surface as SVG text.
pub fn mesh_picture(samples: &SurfaceSamples, picture: &Picture) -> String {
    let width = f64::from(picture.width.max(LEAST_WIDTH));
    let top = if picture.title.is_empty() && picture.subtitle.is_empty() { MARGIN } else { TITLE_HEIGHT };
    let frame = [MARGIN, top, width - 2.0 * MARGIN, MOST_ASPECT * width];
    let (camera, surface_height) = Camera::fitted(picture.direction, &samples.points, frame);
    let height = top + surface_height + FOOT_HEIGHT;
    let range = picture.value_range.or_else(|| samples.value_range().map(|[low, high]| [low.min(0.0), high]));
    let range = range.unwrap_or([0.0, 1.0]);

    let mut svg = String::new();
    // Writing to a string does not fail.
    let _ = write!(
        svg,
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height:.0}" viewBox="0 0 {width} {height:.0}" font-family="DejaVu Sans, Helvetica, Arial, sans-serif" fill="#1a1a1a">
<rect width="100%" height="100%" fill="#ffffff"/>
"##
    );
    text(&mut svg, [MARGIN, 42.0], "start", 20, &picture.title);
    text(&mut svg, [MARGIN, 66.0], "start", 14, &picture.subtitle);
    let faces = Faces::new(samples, &camera, range);
    faces.draw(&mut svg);
    faces.draw_lines(&mut svg, samples, &camera, [width, height]);
    let foot = height - FOOT_HEIGHT;
    draw_scale(&mut svg, &camera, [MARGIN, foot + 78.0]);
    draw_axes(&mut svg, &camera, [MARGIN + 280.0, foot + 78.0]);
    draw_colour_bar(&mut svg, &samples.quantity, range, [width - MARGIN - BAR_LENGTH, foot + 62.0]);
    svg.push_str("</svg>\n");
    svg
}

/// The cells of the surface, on the canvas.
struct Faces {
    corners: Vec<[Projected; 4]>,
    colours: Vec<Colour>,
    light: Vec<f64>,
}

impl Faces {
    fn new(samples: &SurfaceSamples, camera: &Camera, [low, high]: [f64; 2]) -> Self {
        let span = if high > low { high - low } else { 1.0 };
        let mut faces = Self { corners: Vec::new(), colours: Vec::new(), light: Vec::new() };
        for (cell, value) in samples.cells().zip(&samples.cell_values) {
            let points = cell.map(|index| samples.points[index]);
            faces.corners.push(points.map(|point| camera.project(point)));
            faces.colours.push(Colour::viridis((value - low) / span));
            faces.light.push(camera.light(normal(points)));
        }
        faces
    }

    /// From back to front. Each face has an edge of its own colour, so that no light shines through the seams.
    fn draw(&self, svg: &mut String) {
        let nearness = |face: &usize| self.corners[*face].iter().map(|corner| corner.near).sum::<f64>();
        let mut order: Vec<usize> = (0..self.corners.len()).collect();
        order.sort_by(|a, b| nearness(a).total_cmp(&nearness(b)).then(a.cmp(b)));
        svg.push_str("<g stroke-width=\"0.6\" stroke-linejoin=\"round\">\n");
        for face in order {
            let colour = self.colours[face].lit(self.light[face]).hex();
            let _ = write!(svg, r#"<path fill="{colour}" stroke="{colour}" d="M"#);
            for corner in self.corners[face] {
                let _ = write!(svg, "{:.1} {:.1} ", corner.x, corner.y);
            }
            svg.push_str("z\"/>\n");
        }
        svg.push_str("</g>\n");
    }

    /// Knot lines where nothing hides them, light on dark faces and dark on light ones.
    fn draw_lines(&self, svg: &mut String, samples: &SurfaceSamples, camera: &Camera, size: [f64; 2]) {
        let mut buffer = DepthBuffer::new(size[0] as usize, size[1] as usize);
        for (face, &[a, b, c, d]) in self.corners.iter().enumerate() {
            buffer.triangle(face as u32, [a, b, c]);
            buffer.triangle(face as u32, [a, c, d]);
        }
        let tolerance = HIDDEN_BY * size[0] / camera.scale;
        let mut paths = [String::new(), String::new()];
        for line in &samples.knot_lines {
            let mut ink: Option<Ink> = None;
            let mut down = false;
            for pair in line.windows(2) {
                let [from, to] = [pair[0], pair[1]].map(|point| camera.project(point));
                let middle =
                    Projected { x: 0.5 * (from.x + to.x), y: 0.5 * (from.y + to.y), near: 0.5 * (from.near + to.near) };
                if !buffer.sees(middle, tolerance) {
                    down = false;
                    continue;
                }
                let lightness = buffer.face(middle).map_or(0.0, |face| self.colours[face].lightness());
                let next = Ink::upon(lightness, ink);
                let path = &mut paths[next as usize];
                if !down || ink != Some(next) {
                    let _ = write!(path, "M{:.1} {:.1} ", from.x, from.y);
                }
                let _ = write!(path, "L{:.1} {:.1} ", to.x, to.y);
                ink = Some(next);
                down = true;
            }
        }
        for (path, ink, opacity) in [(&paths[0], "#ffffff", 0.75), (&paths[1], "#101010", 0.6)] {
            if !path.is_empty() {
                let _ = writeln!(
                    svg,
                    r#"<path fill="none" stroke="{ink}" stroke-opacity="{opacity}" stroke-width="0.9" stroke-linecap="round" stroke-linejoin="round" d="{}"/>"#,
                    path.trim_end()
                );
            }
        }
    }
}

/// What lines are drawn with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ink {
    Light,
    Dark,
}

impl Ink {
    /// The ink that stands out; the one in use stays in use where both do, so that lines do not flicker.
    fn upon(lightness: f64, in_use: Option<Ink>) -> Self {
        match (in_use, lightness) {
            (Some(Ink::Light), ..0.58) => Ink::Light,
            (Some(Ink::Dark), 0.42..) => Ink::Dark,
            (_, ..0.5) => Ink::Light,
            _ => Ink::Dark,
        }
    }
}

/// Normal of a cell, from its diagonals.
fn normal([a, b, c, d]: [[f64; 3]; 4]) -> [f64; 3] {
    let [p, q] = [[a, c], [b, d]].map(|[from, to]| [0, 1, 2].map(|k| to[k] - from[k]));
    [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
}

/// A length in mm; along lines across the view only, as any scale in a parallel projection.
fn draw_scale(svg: &mut String, camera: &Camera, [x, y]: [f64; 2]) {
    let (lengths, decimals) = ticks([0.0, 200.0 / camera.scale], 2);
    let Some(length) = lengths.last().copied().filter(|length| *length > 0.0) else { return };
    let end = x + length * camera.scale;
    let _ = writeln!(
        svg,
        r##"<path fill="none" stroke="#1a1a1a" stroke-width="1.2" d="M{x:.1} {:.1}v8M{x:.1} {y:.1}H{end:.1}M{end:.1} {:.1}v8"/>"##,
        y - 4.0,
        y - 4.0
    );
    text(svg, [x, y + 22.0], "start", 13, &format!("{length:.decimals$} mm"));
}

/// The directions x, y, z as short arrows.
fn draw_axes(svg: &mut String, camera: &Camera, [x, y]: [f64; 2]) {
    const LENGTH: f64 = 34.0;
    let origin = camera.project([0.0; 3]);
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let mut tip = [0.0; 3];
        tip[axis] = 1.0 / camera.scale;
        let tip = camera.project(tip);
        let (right, down) = (tip.x - origin.x, tip.y - origin.y);
        let [end_x, end_y] = [x + LENGTH * right, y + LENGTH * down];
        let _ = writeln!(
            svg,
            r##"<path fill="none" stroke="#1a1a1a" stroke-width="1.2" d="M{x:.1} {y:.1}L{end_x:.1} {end_y:.1}"/>"##
        );
        let shown = right.hypot(down);
        // An axis that points at the eye has its name beside its foot.
        let place = match shown {
            0.2.. => [x + (LENGTH + 10.0 / shown) * right, y + (LENGTH + 10.0 / shown) * down + 4.0],
            _ => [x - 10.0, y + 14.0],
        };
        text(svg, place, "middle", 13, name);
    }
}

fn draw_colour_bar(svg: &mut String, quantity: &str, range: [f64; 2], [x, y]: [f64; 2]) {
    let [low, high] = range;
    svg.push_str("<defs><linearGradient id=\"values\">");
    for step in 0..=32 {
        let fraction = f64::from(step) / 32.0;
        let colour = Colour::viridis(fraction).hex();
        let _ = write!(svg, r#"<stop offset="{fraction:.4}" stop-color="{colour}"/>"#);
    }
    svg.push_str("</linearGradient></defs>\n");
    let _ = writeln!(
        svg,
        r#"<rect x="{x:.1}" y="{y:.1}" width="{BAR_LENGTH}" height="{BAR_HEIGHT}" fill="url(#values)"/>"#
    );
    text(svg, [x, y - 10.0], "start", 14, quantity);
    let (values, decimals) = ticks(range, 5);
    for value in values {
        let place = if high > low { x + BAR_LENGTH * (value - low) / (high - low) } else { x };
        let below = y + BAR_HEIGHT;
        let _ = writeln!(svg, r##"<path stroke="#1a1a1a" stroke-width="1" d="M{place:.1} {below:.1}v5"/>"##);
        text(svg, [place, below + 19.0], "middle", 13, &format!("{value:.decimals$}"));
    }
}

fn text(svg: &mut String, [x, y]: [f64; 2], anchor: &str, size: u32, words: &str) {
    if !words.is_empty() {
        let words = escaped(words);
        let _ =
            writeln!(svg, r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}" font-size="{size}">{words}</text>"#);
    }
}

/// Text as XML.
pub(super) fn escaped(text: &str) -> String {
    one_line(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
