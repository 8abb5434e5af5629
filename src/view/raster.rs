//! A drawing as pixels. Words are in Noto Sans Mono (SIL Open Font License 1.1), which comes as pixels too; letters that it lacks
//! are written in others.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke as PixelStroke, StrokeDash, Transform,
};

use super::colour::Colour;
use super::drawing::{Anchor, Drawing, SEAM, Shape, Stroke};
use crate::printable::one_line;

/// Pixels of a picture, red, green, blue and opacity, row by row.
pub(super) struct Raster {
    pub(super) size: [usize; 2],
    pub(super) pixels: Vec<u8>,
}

/// Draws; `None` where the picture has no pixel, or too many for memory.
pub(super) fn raster(drawing: &Drawing) -> Option<Raster> {
    let [width, height] = drawing.size.map(|length| length as u32);
    let mut sheet = Pixmap::new(width, height)?;
    sheet.fill(Color::WHITE);
    for shape in &drawing.shapes {
        match shape {
            Shape::Face { corners, colour } => {
                let Some(path) = path(std::iter::once(&corners[..]), true) else { continue };
                let seam = stroke_of(&Stroke::new(*colour, SEAM));
                sheet.fill_path(&path, &paint(*colour, 1.0), FillRule::Winding, Transform::identity(), None);
                sheet.stroke_path(&path, &paint(*colour, 1.0), &seam, Transform::identity(), None);
            }
            Shape::Lines { lines, stroke } => {
                let Some(path) = path(lines.iter().map(|line| &line[..]), false) else { continue };
                let paint = paint(stroke.colour, stroke.opacity);
                sheet.stroke_path(&path, &paint, &stroke_of(stroke), Transform::identity(), None);
            }
            Shape::Text { at, anchor, size, words } => write(&mut sheet, *at, *anchor, *size, words),
        }
    }
    Some(Raster { size: [width as usize, height as usize], pixels: sheet.take() })
}

fn path<'p>(lines: impl Iterator<Item = &'p [[f64; 2]]>, closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for line in lines {
        for (index, [x, y]) in line.iter().enumerate() {
            match index {
                0 => builder.move_to(*x as f32, *y as f32),
                _ => builder.line_to(*x as f32, *y as f32),
            }
        }
        if closed {
            builder.close();
        }
    }
    builder.finish()
}

fn paint(colour: Colour, opacity: f64) -> Paint<'static> {
    let [red, green, blue] = colour.bytes();
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(red, green, blue, (255.0 * opacity).round() as u8);
    paint
}

fn stroke_of(Stroke { width, dash, .. }: &Stroke) -> PixelStroke {
    PixelStroke {
        width: *width as f32,
        line_cap: if dash.is_some() { LineCap::Butt } else { LineCap::Round },
        line_join: LineJoin::Round,
        dash: dash.and_then(|[dash, gap]| StrokeDash::new(vec![dash as f32, gap as f32], 0.0)),
        ..PixelStroke::default()
    }
}

/// Writes words on a base line.
fn write(sheet: &mut Pixmap, [x, y]: [f64; 2], anchor: Anchor, size: u32, words: &str) {
    /// The share of a letter's height that is above the base line.
    const ASCENT: f64 = 0.78;
    // A raster is a line, of which letters take three quarters.
    let height = if size > 16 { RasterHeight::Size24 } else { RasterHeight::Size20 };
    let letters: Vec<char> = one_line(words).chars().flat_map(in_font).collect();
    let advance = get_raster_width(FontWeight::Regular, height);
    let left = match anchor {
        Anchor::Start => x,
        Anchor::Middle => x - 0.5 * (advance * letters.len()) as f64,
    };
    let top = (y - ASCENT * height.val() as f64).round() as i64;
    let ink = f64::from(Colour::INK.bytes()[0]);
    let [width, rows] = [sheet.width(), sheet.height()].map(i64::from);
    for (index, letter) in letters.into_iter().enumerate() {
        let Some(shape) = get_raster(letter, FontWeight::Regular, height) else { continue };
        let from = left.round() as i64 + (index * advance) as i64;
        for (row, line) in shape.rows().enumerate() {
            for (column, cover) in line.iter().enumerate() {
                let (right, down) = (from + column as i64, top + row as i64);
                if *cover == 0 || !(0..width).contains(&right) || !(0..rows).contains(&down) {
                    continue;
                }
                let at = 4 * (down * width + right) as usize;
                let share = f64::from(*cover) / 255.0;
                for channel in &mut sheet.data_mut()[at..at + 3] {
                    *channel = (f64::from(*channel) * (1.0 - share) + ink * share).round() as u8;
                }
            }
        }
    }
}

/// Letters that the font has, for one that it may lack.
fn in_font(letter: char) -> Vec<char> {
    let known: &str = match letter {
        '−' | '–' | '—' => "-",
        'θ' => "rotation",
        'κ' => "kappa",
        'ε' => "epsilon",
        'λ' => "lambda",
        'φ' => "phi",
        ' '..='~' | '\u{a1}'..='ÿ' => return vec![letter],
        _ => "?",
    };
    known.chars().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_lines_and_words_leave_ink_where_they_are() {
        let mut drawing = Drawing { size: [60.0, 40.0], shapes: Vec::new() };
        drawing.face([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]], Colour::LOAD);
        drawing.lines(vec![vec![[0.0, 20.0], [20.0, 20.0]]], Stroke::new(Colour::INK, 3.0));
        drawing.text([25.0, 35.0], Anchor::Start, 13, "θ°");
        let Raster { size, pixels } = raster(&drawing).unwrap();
        let at = |x: usize, y: usize| &pixels[4 * (y * size[0] + x)..][..3];
        assert_eq!(at(5, 5), Colour::LOAD.bytes());
        assert_eq!(at(10, 20), Colour::INK.bytes());
        assert_eq!(at(50, 5), [255; 3]);
        let inked = (25..60).flat_map(|x| (20..40).map(move |y| (x, y))).filter(|(x, y)| at(*x, *y)[0] < 100).count();
        assert!(inked > 50, "{inked} dark pixels of words");
    }
}
