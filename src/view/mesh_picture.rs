//! The deformed mesh as a picture: faces from back to front coloured by their value, knot lines where they are seen,
//! supports, loads and the outline of the shell as it was, a colour bar, and a scale.

use super::camera::{Camera, DepthBuffer, Projected, ViewDirection};
use super::colour::Colour;
use super::drawing::{Anchor, Drawing, Stroke};
use super::glyphs::{draw_legend, draw_marks, draw_outline};
use super::marks::Marks;
use super::samples::SurfaceSamples;
use super::ticks::{in_view, labelled_ticks, ticks};
use crate::units::significant;

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
    /// Values at the ends of the colour bar; `None` takes the least and the largest, and 0 where that is not far away.
    pub value_range: Option<[f64; 2]>,
    /// Supports, loads and the outline of the shell as it was.
    pub marks: Marks,
}

impl Default for Picture {
    fn default() -> Self {
        Self {
            direction: ViewDirection::default(),
            title: String::new(),
            subtitle: String::new(),
            width: 1200,
            value_range: None,
            marks: Marks::default(),
        }
    }
}

const LEAST_WIDTH: u32 = 480;
const MARGIN: f64 = 40.0;
const TITLE_HEIGHT: f64 = 84.0;
const LEGEND_HEIGHT: f64 = 24.0;
const FOOT_HEIGHT: f64 = 118.0;
const BAR_LENGTH: f64 = 320.0;
const BAR_HEIGHT: f64 = 14.0;
/// Faces that the colour bar is made of.
const BAR_PARTS: u32 = 64;
/// Most height of the surface, over the width of the picture.
const MOST_ASPECT: f64 = 0.8;
/// A line on the surface is hidden where a face is nearer by more than this part of the picture's width, which is far
/// below the gap between the layers of a fold and above the facets' distance from the smooth surface.
const HIDDEN_BY: f64 = 0.004;

/// Where a surface is seen from, and the room that it takes on the canvas.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    camera: Camera,
    size: [f64; 2],
}

impl View {
    /// The view of these surfaces with their pictures, which have the settings of the first one in common.
    pub(super) fn of<'s>(shown: impl Iterator<Item = (&'s SurfaceSamples, &'s Picture)> + Clone) -> Self {
        let first = shown.clone().next().map(|(_, picture)| picture.clone()).unwrap_or_default();
        let width = f64::from(first.width.max(LEAST_WIDTH));
        let top = match (first.title.is_empty() && first.subtitle.is_empty(), first.marks == Marks::default()) {
            (true, true) => MARGIN,
            (_, true) => TITLE_HEIGHT,
            (_, false) => TITLE_HEIGHT + LEGEND_HEIGHT,
        };
        let frame = [MARGIN, top, width - 2.0 * MARGIN, MOST_ASPECT * width];
        let points = shown.flat_map(|(samples, picture)| samples.points.iter().copied().chain(picture.marks.points()));
        let (camera, surface_height) = Camera::fitted(first.direction, points, frame);
        Self { camera, size: [width, (top + surface_height + FOOT_HEIGHT).round()] }
    }
}

/// Draws a sampled surface as SVG text.
pub fn mesh_picture(samples: &SurfaceSamples, picture: &Picture) -> String {
    mesh_drawing(samples, picture, &View::of(std::iter::once((samples, picture)))).svg()
}

/// Draws a sampled surface.
pub(super) fn mesh_drawing(samples: &SurfaceSamples, picture: &Picture, View { camera, size }: &View) -> Drawing {
    let drawn = samples.value_range();
    let range = picture.value_range.or(drawn.map(in_view)).unwrap_or([0.0, 1.0]);
    let mut drawing = Drawing { size: *size, shapes: Vec::new() };
    let faces = Faces::new(samples, camera, range);
    let depths = faces.depths(*size);
    let tolerance = HIDDEN_BY * size[0] / camera.scale;
    faces.draw(&mut drawing);
    faces.draw_lines(&mut drawing, samples, camera, |middle| {
        depths.sees(middle, tolerance).then(|| depths.face(middle))
    });
    draw_outline(&mut drawing, &picture.marks, camera, |middle| depths.sees(middle, tolerance));
    draw_marks(&mut drawing, &picture.marks, camera);
    drawing.text([MARGIN, 42.0], Anchor::Start, 20, &picture.title);
    drawing.text([MARGIN, 66.0], Anchor::Start, 14, &picture.subtitle);
    draw_legend(&mut drawing, &picture.marks, [MARGIN, 90.0]);
    let foot = size[1] - FOOT_HEIGHT;
    draw_scale(&mut drawing, camera, [MARGIN, foot + 78.0]);
    draw_axes(&mut drawing, camera, [MARGIN + 280.0, foot + 78.0]);
    let bar = [size[0] - MARGIN - BAR_LENGTH, foot + 48.0];
    draw_colour_bar(&mut drawing, &samples.quantity, range, bar);
    if let Some([low, high]) = drawn.map(|ends| ends.map(|value| significant(value, 3))) {
        drawing.text([bar[0], bar[1] + 54.0], Anchor::Start, 13, &format!("drawn: {low} to {high}"));
    }
    drawing
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
        // The face in the best light has the colour of the bar.
        let brightest = faces.light.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        faces.light.iter_mut().for_each(|light| *light /= brightest);
        faces
    }

    /// From back to front.
    fn draw(&self, drawing: &mut Drawing) {
        let nearness = |face: &usize| self.corners[*face].iter().map(|corner| corner.near).sum::<f64>();
        let mut order: Vec<usize> = (0..self.corners.len()).collect();
        order.sort_by(|a, b| nearness(a).total_cmp(&nearness(b)).then(a.cmp(b)));
        for face in order {
            let corners = self.corners[face].map(|corner| [corner.x, corner.y]);
            drawing.face(corners, self.colours[face].lit(self.light[face]));
        }
    }

    /// For every pixel the nearest face.
    fn depths(&self, size: [f64; 2]) -> DepthBuffer {
        let mut buffer = DepthBuffer::new(size[0] as usize, size[1] as usize);
        for (face, &[a, b, c, d]) in self.corners.iter().enumerate() {
            buffer.triangle(face as u32, [a, b, c]);
            buffer.triangle(face as u32, [a, c, d]);
        }
        buffer
    }

    /// Knot lines where nothing hides them, light on dark faces and dark on light ones; `seen` gives the face below a point that
    /// is seen.
    fn draw_lines(
        &self,
        drawing: &mut Drawing,
        samples: &SurfaceSamples,
        camera: &Camera,
        seen: impl Fn(Projected) -> Option<Option<usize>>,
    ) {
        let mut of_ink: [Vec<Vec<[f64; 2]>>; 2] = Default::default();
        for line in &samples.knot_lines {
            let mut ink: Option<Ink> = None;
            let mut is_down = false;
            for pair in line.windows(2) {
                let [from, to] = [pair[0], pair[1]].map(|point| camera.project(point));
                let middle = from.middle(&to);
                let Some(face) = seen(middle) else {
                    is_down = false;
                    continue;
                };
                let lightness = face.map_or(0.0, |face| self.colours[face].lightness());
                let next = Ink::upon(lightness, ink);
                let lines = &mut of_ink[next as usize];
                match lines.last_mut().filter(|_| is_down && ink == Some(next)) {
                    Some(line) => line.push([to.x, to.y]),
                    None => lines.push(vec![[from.x, from.y], [to.x, to.y]]),
                }
                ink = Some(next);
                is_down = true;
            }
        }
        for (lines, (colour, opacity)) in of_ink.into_iter().zip([(Colour::WHITE, 0.75), (Colour::INK, 0.6)]) {
            drawing.lines(lines, Stroke { opacity, ..Stroke::new(colour, 0.9) });
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
fn draw_scale(drawing: &mut Drawing, camera: &Camera, [x, y]: [f64; 2]) {
    let (lengths, decimals) = ticks([0.0, 200.0 / camera.scale], 2);
    let Some(length) = lengths.last().copied().filter(|length| *length > 0.0) else { return };
    let end = x + length * camera.scale;
    let bar = [[[x, y - 4.0], [x, y + 4.0]], [[x, y], [end, y]], [[end, y - 4.0], [end, y + 4.0]]];
    drawing.lines(bar.map(Vec::from).to_vec(), Stroke::new(Colour::INK, 1.2));
    drawing.text([x, y + 22.0], Anchor::Start, 13, &format!("{length:.decimals$} mm"));
}

/// The directions x, y, z as short arrows.
fn draw_axes(drawing: &mut Drawing, camera: &Camera, [x, y]: [f64; 2]) {
    const LENGTH: f64 = 34.0;
    let origin = camera.project([0.0; 3]);
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let mut tip = [0.0; 3];
        tip[axis] = 1.0 / camera.scale;
        let tip = camera.project(tip);
        let (right, down) = (tip.x - origin.x, tip.y - origin.y);
        let end = [x + LENGTH * right, y + LENGTH * down];
        drawing.lines(vec![vec![[x, y], end]], Stroke::new(Colour::INK, 1.2));
        let shown = right.hypot(down);
        // An axis that points at the eye has its name beside its foot.
        let place = match shown {
            0.2.. => [x + (LENGTH + 10.0 / shown) * right, y + (LENGTH + 10.0 / shown) * down + 4.0],
            _ => [x - 10.0, y + 14.0],
        };
        drawing.text(place, Anchor::Middle, 13, name);
    }
}

fn draw_colour_bar(drawing: &mut Drawing, quantity: &str, range: [f64; 2], [x, y]: [f64; 2]) {
    let [low, high] = range;
    let below = y + BAR_HEIGHT;
    let at = |part: u32| x + BAR_LENGTH * f64::from(part) / f64::from(BAR_PARTS);
    for part in 0..BAR_PARTS {
        let colour = Colour::viridis((f64::from(part) + 0.5) / f64::from(BAR_PARTS));
        drawing.face([[at(part), y], [at(part + 1), y], [at(part + 1), below], [at(part), below]], colour);
    }
    drawing.text([x, y - 10.0], Anchor::Start, 14, quantity);
    for (value, label) in labelled_ticks(range, 4) {
        let place = if high > low { x + BAR_LENGTH * (value - low) / (high - low) } else { x };
        drawing.lines(vec![vec![[place, below], [place, below + 5.0]]], Stroke::new(Colour::INK, 1.0));
        drawing.text([place, below + 19.0], Anchor::Middle, 13, &label);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::drawing::Shape;

    /// A flat strip of four cells, seen from above.
    fn strip(values: [f64; 4]) -> (SurfaceSamples, Picture) {
        let points = (0..5).flat_map(|i| [0.0, 1.0].map(|y| [f64::from(i), y, 0.0])).collect();
        let direction = ViewDirection { azimuth_deg: -90.0, elevation_deg: 90.0 };
        let samples = SurfaceSamples::new([5, 2], points, values.to_vec(), vec![], "height (mm)").unwrap();
        (samples, Picture { direction, ..Picture::default() })
    }

    fn faces(drawing: &Drawing) -> Vec<Colour> {
        let colour = |shape: &Shape| if let Shape::Face { colour, .. } = shape { Some(*colour) } else { None };
        drawing.shapes.iter().filter_map(colour).collect()
    }

    #[test]
    fn the_bar_has_the_colours_and_the_values_of_the_faces() {
        let (samples, picture) = strip([1.0, 2.0, 3.0, 4.0]);
        let drawing = mesh_drawing(&samples, &picture, &View::of(std::iter::once((&samples, &picture))));
        let all = faces(&drawing);
        let (shown, bar) = all.split_at(4);
        // A quarter, a half, … of the bar, which begins at 0; a part of the bar is 1/64 wide.
        for (value, colour) in [1u32, 2, 3, 4].into_iter().zip(shown) {
            let beside = bar[(value * BAR_PARTS / 4 - 1) as usize];
            let off = (0..3).map(|c| (beside.0[c] - colour.0[c]).abs()).fold(0.0, f64::max);
            assert!(off < 0.02, "{value}: {colour:?} and {beside:?}");
        }
        let words = drawing.svg();
        assert!(words.contains("drawn: 1 to 4"), "{words}");
    }

    #[test]
    fn a_field_far_from_zero_takes_the_whole_bar() {
        let (samples, picture) = strip([7.0, 8.0, 7.5, 7.2]);
        let drawing = mesh_drawing(&samples, &picture, &View::of(std::iter::once((&samples, &picture))));
        let all = faces(&drawing);
        assert_eq!([all[0], all[1]], [Colour::viridis(0.0), Colour::viridis(1.0)]);
    }
}
